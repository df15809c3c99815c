//! Whether a JSON tree has the structure that the schema gives it, told in the words of somebody who writes JSON.
//!
//! The schema is the first judge of a scene, the types come after it. Without it the parser would take more than the
//! schema promises (an array in the place of an object, `{"none": null}` for `"none"`) and less (a whole number written
//! `20.0` or `2e1`), and would speak of structs and variants.

use serde_json::{Map, Value};

/// The first place where a tree differs from the schema.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Misfit {
    /// The keys that lead there.
    pub path: Vec<String>,
    /// What is the matter.
    pub fault: Fault,
}

/// How a tree differs from the schema.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Fault {
    /// A key that there is not, and those that there are.
    Unknown(Vec<String>),
    /// A key that is needed.
    Lacks(String),
    /// A value of another kind: what was found, and what is expected.
    Kind(String, &'static str),
    /// None of the alternatives: what may stand there, and what was found.
    Alternative(String, String),
}

/// Compares `value` with `schema`, and writes whole numbers as such where the schema asks for them.
///
/// # Errors
/// The first [`Misfit`], in the order of the text.
pub(super) fn fit(value: &mut Value, schema: &Value) -> Result<(), Misfit> {
    walk(value, schema, &mut Vec::new())
}

fn walk(value: &mut Value, schema: &Value, path: &mut Vec<String>) -> Result<(), Misfit> {
    if let Some(either) = schema["anyOf"].as_array() {
        // Something, or null.
        let something = either.iter().find(|schema| schema["type"] != "null").filter(|_| !value.is_null());
        return something.map_or(Ok(()), |schema| walk(value, schema, path));
    }
    if let Some(alternatives) = schema["oneOf"].as_array() {
        return choose(value, alternatives, path);
    }
    let kinds = &schema["type"];
    let admits = |kind: &str| kinds == kind || kinds.as_array().is_some_and(|kinds| kinds.iter().any(|k| k == kind));
    let expected = match value {
        Value::Null if admits("null") => return Ok(()),
        Value::Bool(_) if admits("boolean") => return Ok(()),
        Value::String(_) if admits("string") => return Ok(()),
        Value::Number(_) if admits("number") => return Ok(()),
        Value::Object(keys) if admits("object") => return walk_object(keys, schema, path),
        _ if admits("integer") => match whole(value, schema) {
            Some(number) => {
                *value = number.into();
                return Ok(());
            }
            None => "a whole number that is not negative",
        },
        _ if admits("number") => "a number",
        _ if admits("object") => "an object",
        _ if admits("string") => "a string",
        _ => "true or false",
    };
    Err(Misfit { path: path.clone(), fault: Fault::Kind(describe(value), expected) })
}

fn walk_object(keys: &mut Map<String, Value>, schema: &Value, path: &mut Vec<String>) -> Result<(), Misfit> {
    let properties = schema["properties"].as_object();
    let known = |key: &str| properties.and_then(|properties| properties.get(key));
    for (key, value) in keys.iter_mut() {
        path.push(key.clone());
        let Some(schema) = known(key) else {
            let known = properties.map_or(Vec::new(), |properties| properties.keys().cloned().collect());
            return Err(Misfit { path: path.clone(), fault: Fault::Unknown(known) });
        };
        walk(value, schema, path)?;
        path.pop();
    }
    let mut needed = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
    match needed.find(|key| !keys.contains_key(*key)) {
        Some(key) => Err(Misfit { path: path.clone(), fault: Fault::Lacks(key.to_owned()) }),
        None => Ok(()),
    }
}

/// One of several words, or an object whose only key says what it is.
fn choose(value: &mut Value, alternatives: &[Value], path: &mut Vec<String>) -> Result<(), Misfit> {
    if alternatives.iter().any(|schema| is_word(schema, value)) {
        return Ok(());
    }
    let chosen = match value.as_object_mut() {
        Some(keys) if keys.len() == 1 => keys.iter_mut().next().and_then(|(key, value)| {
            let schema = alternatives.iter().find_map(|schema| schema["properties"].get(key))?;
            Some((key.clone(), value, schema))
        }),
        _ => None,
    };
    match chosen {
        Some((key, value, schema)) => {
            path.push(key);
            walk(value, schema, path)?;
            path.pop();
            Ok(())
        }
        None => {
            let takes = alternatives.iter().flat_map(names).collect::<Vec<_>>();
            Err(Misfit { path: path.clone(), fault: Fault::Alternative(listed(&takes), outline(value)) })
        }
    }
}

fn is_word(schema: &Value, value: &Value) -> bool {
    value.is_string()
        && (schema.get("const") == Some(value) || schema["enum"].as_array().is_some_and(|all| all.contains(value)))
}

/// An alternative as it would stand in a scene.
fn names(schema: &Value) -> Vec<String> {
    let words = schema.get("const").into_iter().chain(schema["enum"].as_array().into_iter().flatten());
    let objects =
        schema["properties"].as_object().into_iter().flat_map(Map::keys).map(|key| format!("{{\"{key}\": {{..}}}}"));
    words.map(Value::to_string).chain(objects).collect()
}

/// `a, b or c`.
fn listed(words: &[String]) -> String {
    match words {
        [rest @ .., last] if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => words.concat(),
    }
}

/// The number as an integer of the schema's size, if it is one.
fn whole(value: &Value, schema: &Value) -> Option<u64> {
    let largest = if schema["format"] == "uint32" { u64::from(u32::MAX) } else { u64::MAX };
    let number = value.as_u64().or_else(|| {
        // 2^64 is the first that does not fit; everything below it is exact.
        value.as_f64().filter(|x| x.fract() == 0.0 && (0.0..18_446_744_073_709_551_616.0).contains(x)).map(|x| x as u64)
    });
    number.filter(|number| *number <= largest)
}

/// A value in a sentence.
fn describe(value: &Value) -> String {
    match value {
        Value::String(text) => format!("string {}", shortened(text)),
        Value::Number(number) => format!("`{number}`"),
        Value::Array(_) => "an array".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        Value::Null | Value::Bool(_) => value.to_string(),
    }
}

/// A value as it stands in a scene, its inside left out.
fn outline(value: &Value) -> String {
    match value {
        Value::String(text) => shortened(text),
        Value::Object(keys) => {
            let inside = |value: &Value| if value.is_object() { "{..}" } else { ".." };
            let shown = keys.iter().take(3).map(|(key, value)| format!("{}: {}", shortened(key), inside(value)));
            let more = if keys.len() > 3 { ", .." } else { "" };
            format!("{{{}{more}}}", shown.collect::<Vec<_>>().join(", "))
        }
        other => describe(other),
    }
}

/// A text in quotes, its first forty characters.
fn shortened(text: &str) -> String {
    let mut characters = text.chars();
    let first: String = characters.by_ref().take(40).collect();
    if characters.next().is_some() { format!("{:?}", format!("{first}..")) } else { format!("{first:?}") }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::scene::json_schema;

    fn misfit(mut scene: Value) -> (String, Fault) {
        let misfit = fit(&mut scene, &json_schema()).unwrap_err();
        (misfit.path.join("."), misfit.fault)
    }

    #[test]
    fn whole_numbers_are_whole_however_they_are_written() {
        for text in ["7", "7.0", "70e-1", "0.7e1"] {
            let mut scene: Value =
                serde_json::from_str(&format!(r#"{{"seed": {text}, "body": {{"file": {{"path": "a"}}}}}}"#)).unwrap();
            fit(&mut scene, &json_schema()).unwrap();
            assert_eq!(scene["seed"], json!(7));
        }
        for number in [json!(7.5), json!(-7), json!(1.8446744073709552e19), json!("7"), json!([7]), json!(null)] {
            let (path, fault) = misfit(json!({"seed": number}));
            assert!(path == "seed" && matches!(fault, Fault::Kind(..)), "{path} {fault:?}");
        }
        assert_eq!(misfit(json!({"tiling": {"facets": 4_294_967_296_u64}})).0, "tiling.facets");
    }

    #[test]
    fn alternatives_are_listed_as_they_would_stand_there() {
        let takes = |value: Value| match misfit(value) {
            (path, Fault::Alternative(takes, found)) => format!("{path} takes {takes}, found {found}"),
            other => panic!("{other:?}"),
        };
        let either = r#"{"hard_sphere": {..}} or {"soft_sphere": {..}}"#;
        assert_eq!(takes(json!({"contact": "soft_sphere"})), format!("contact takes {either}, found \"soft_sphere\""));
        assert_eq!(
            takes(json!({"contact": {"soft": {}}})),
            format!("contact takes {either}, found {{\"soft\": {{..}}}}")
        );
        assert_eq!(takes(json!({"contact": {}})), format!("contact takes {either}, found {{}}"));
        assert_eq!(takes(json!({"contact": [1]})), format!("contact takes {either}, found an array"));
        let none = takes(json!({"surface": {"reflectance": {"none": null}}}));
        assert_eq!(
            none,
            r#"surface.reflectance takes {"hapke": {..}}, {"lambert": {..}} or "none", found {"none": ..}"#
        );
    }
}
