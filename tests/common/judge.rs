//! A judge of JSON documents by a JSON Schema, of as much of the standard as `yorp schema` uses.

use serde_json::{Map, Value};

/// Keywords that say something about a schema and nothing about a document.
const ANNOTATIONS: [&str; 7] = ["$schema", "$id", "title", "description", "default", "format", "writeOnly"];

/// Whether `value` is valid under `schema`.
pub fn conforms(value: &Value, schema: &Value) -> bool {
    schema.as_object().unwrap().iter().all(|(keyword, rule)| obeys(value, keyword, rule, schema))
}

fn obeys(value: &Value, keyword: &str, rule: &Value, schema: &Value) -> bool {
    let number = value.as_f64();
    let bound = rule.as_f64();
    let valid_under = || rule.as_array().unwrap().iter().filter(|schema| conforms(value, schema)).count();
    match keyword {
        "type" => match rule {
            Value::Array(kinds) => kinds.iter().any(|kind| is_a(value, kind.as_str().unwrap())),
            kind => is_a(value, kind.as_str().unwrap()),
        },
        "const" => value == rule,
        "enum" => rule.as_array().unwrap().contains(value),
        "oneOf" => valid_under() == 1,
        "anyOf" => valid_under() > 0,
        "minimum" => number.is_none_or(|number| number >= bound.unwrap()),
        "exclusiveMinimum" => number.is_none_or(|number| number > bound.unwrap()),
        // Above 2^53 two integers may be one f64.
        "maximum" if rule == &Value::from(u64::MAX) => {
            number.is_none_or(|number| value.is_u64() || number < u64::MAX as f64)
        }
        "maximum" => number.is_none_or(|number| number <= bound.unwrap()),
        "exclusiveMaximum" => number.is_none_or(|number| number < bound.unwrap()),
        "required" => value
            .as_object()
            .is_none_or(|object| rule.as_array().unwrap().iter().all(|key| object.contains_key(key.as_str().unwrap()))),
        "properties" => value.as_object().is_none_or(|object| {
            object.iter().all(|(key, value)| rule.get(key).is_none_or(|schema| conforms(value, schema)))
        }),
        "additionalProperties" => {
            assert_eq!(rule, &Value::Bool(false));
            let known = schema["properties"].as_object().cloned().unwrap_or_else(Map::new);
            value.as_object().is_none_or(|object| object.keys().all(|key| known.contains_key(key)))
        }
        other => {
            assert!(ANNOTATIONS.contains(&other), "the judge does not know {other}");
            true
        }
    }
}

/// A number without a fraction is an integer, however it is written.
fn is_a(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        other => panic!("the judge does not know the type {other}"),
    }
}
