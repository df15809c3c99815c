//! `yorp schema` and the program judge the same documents alike: every key with another kind of value, every alternative in
//! other clothes, every whole number in other digits.

use std::path::Path;

use common::judge::conforms;
use serde_json::{Map, Value, json};
use yorp::scene::{Scene, SceneError, json_schema};

mod common;

/// A value that the schema admits and that goes with the defaults of everything else.
fn sample(key: &str, schema: &Value) -> Value {
    if let Some(alternatives) = schema.get("oneOf").and_then(Value::as_array) {
        return alternative(&alternatives[0]);
    }
    if schema.get("properties").is_some() {
        return object(schema);
    }
    let known = [
        ("spheres", json!(20)),
        ("radius_m", json!(50)),
        ("grain_density_kg_m3", json!(2960)),
        ("b_over_a", json!(0.8)),
        ("c_over_a", json!(0.7)),
        ("path", json!("a.csv")),
        ("$schema", json!("scene.schema.json")),
        ("coverage", json!(0.1)),
        ("thickness_m", json!(0.05)),
        ("conductivity_w_m_k", json!(1)),
        ("thermal_inertia", json!(1500)),
    ];
    let named = || known.into_iter().find(|(name, _)| *name == key).map(|(_, value)| value);
    schema.get("default").cloned().or_else(named).unwrap_or_else(|| panic!("no sample for {key}"))
}

fn object(schema: &Value) -> Value {
    let properties = schema["properties"].as_object().unwrap();
    properties.iter().map(|(key, schema)| (key.clone(), sample(key, schema))).collect::<Map<_, _>>().into()
}

fn alternative(schema: &Value) -> Value {
    schema.get("const").cloned().unwrap_or_else(|| object(schema))
}

/// Calls `visit` with every node of the schema and the path of its value.
fn every_node(schema: &Value, path: &mut Vec<String>, visit: &mut dyn FnMut(&[String], &Value)) {
    visit(path, schema);
    for alternative in ["oneOf", "anyOf"].iter().filter_map(|key| schema.get(key)?.as_array()).flatten() {
        every_node(alternative, path, visit);
    }
    for (key, schema) in schema.get("properties").and_then(Value::as_object).into_iter().flatten() {
        path.push(key.clone());
        every_node(schema, path, visit);
        path.pop();
    }
}

/// `document` with the value at `path` replaced, its alternatives on the way there chosen so that there is such a path.
fn with(document: &Value, schema: &Value, path: &[String], value: &Value) -> Value {
    let Some((key, rest)) = path.split_first() else { return value.clone() };
    let either = schema.get("oneOf").or(schema.get("anyOf")).and_then(Value::as_array).into_iter().flatten();
    let chosen = std::iter::once(schema).chain(either).find(|schema| schema["properties"].get(key).is_some()).unwrap();
    let mut object = if document.get(key).is_some() { document.clone() } else { object(chosen) };
    object[key] = with(&object[key], &chosen["properties"][key], rest, value);
    object
}

/// Texts that may or may not stand where the schema has this node.
fn variants(path: &[String], schema: &Value) -> Vec<String> {
    let value = sample_of_node(path, schema);
    let mut texts: Vec<String> =
        ["null", "true", "[]", "{}", "\"\"", "\"x\"", "0", "-0", "-1", "1", "2.5", "[1, 2]", "{\"x\": 1}", "1e300"]
            .map(String::from)
            .into();
    if let Some(number) = value.as_f64() {
        texts.extend([format!("{number}"), format!("{number:?}"), format!("{number:e}"), format!("{}00e-2", value)]);
        texts.extend([format!("[{number}]"), format!("\"{number}\""), format!("{}", number + 0.5)]);
    }
    if let Some(word) = value.as_str() {
        texts.extend([format!("{{\"{word}\": null}}"), format!("{{\"{word}\": {{}}}}"), format!("[\"{word}\"]")]);
    }
    if let Some(keys) = value.as_object() {
        texts.push(Value::Array(keys.values().cloned().collect()).to_string());
        for (key, inner) in keys {
            texts.extend([format!("\"{key}\""), format!("{{\"{key}\": null}}"), format!("{{\"{key}\": [{inner}]}}")]);
            texts.extend([format!("{{\"{key}\": {inner}, \"x\": 1}}"), format!("{{\"{key}\": {inner}}}")]);
        }
    }
    texts.push(value.to_string());
    texts
}

fn sample_of_node(path: &[String], schema: &Value) -> Value {
    if let Some(word) = schema.get("const") {
        return word.clone();
    }
    let schema = schema.get("anyOf").map_or(schema, |either| &either[0]);
    let fallback = json!({"default": null});
    let known = ["oneOf", "properties", "default"].iter().any(|key| schema.get(key).is_some());
    let key = path.last().map_or("", String::as_str);
    if known || schema["type"] != "null" { sample(key, schema) } else { sample(key, &fallback) }
}

#[test]
fn the_program_and_its_schema_agree_on_every_kind_of_value_for_every_key() {
    let schema = json_schema();
    let base = object(&schema);
    assert!(conforms(&base, &schema) && Scene::parse(&base.to_string(), Path::new("s.json")).is_ok());
    let (mut judged, mut accepted) = (0, 0);
    every_node(&schema, &mut Vec::new(), &mut |path, node| {
        for text in variants(path, node) {
            let document = with(&base, &schema, path, &json!("@here@")).to_string().replace("\"@here@\"", &text);
            let by_schema = serde_json::from_str(&document).is_ok_and(|value| conforms(&value, &schema));
            let by_program = match Scene::parse(&document, Path::new("s.json")) {
                Ok(_) => true,
                // Rules between two keys, and those that no schema states: even, a divisor of 180, a name without control characters.
                Err(SceneError::Value { .. }) => by_schema,
                Err(_) => false,
            };
            assert_eq!(by_program, by_schema, "{} = {text}\n{document}", path.join("."));
            judged += 1;
            accepted += usize::from(by_program);
        }
    });
    assert!(judged > 2000 && accepted > 300 && accepted < judged / 2, "{accepted} of {judged}");
}

#[test]
fn whole_numbers_with_a_point_or_an_exponent_are_the_same_scene() {
    let text = |number: &str| {
        format!(
            r#"{{"seed": 7, "body": {{"packed_ellipsoid": {{"spheres": {number}, "radius_m": 50, "grain_density_kg_m3": 2960,
               "b_over_a": 0.8, "c_over_a": 0.7}}}}}}"#
        )
    };
    let parse = |number: &str| Scene::parse(&text(number), Path::new("s.json"));
    for same in ["20.0", "2e1", "2.0E+1", "200e-1"] {
        assert_eq!(parse(same).unwrap(), parse("20").unwrap(), "{same}");
    }
    assert!(parse("20.5").is_err() && parse("2e-1").is_err());
}

#[test]
fn arrays_do_not_pass_for_objects() {
    let body = r#""body": {"packed_ellipsoid": {"spheres": 20, "radius_m": 50, "grain_density_kg_m3": 2960, "b_over_a": 0.8, "c_over_a": 0.7}}"#;
    for (key, array) in
        [("spin", "[5.5, 30]"), ("gravity", "[\"auto\", 1e-3]"), ("shed", "[\"none\"]"), ("orbit", "[]")]
    {
        let refused = Scene::parse(&format!("{{{body}, \"{key}\": {array}}}"), Path::new("s.json")).unwrap_err();
        assert!(refused.to_string().contains(&format!("`{key}`: found an array, expected an object")), "{refused}");
    }
}
