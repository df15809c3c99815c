//! The user guide keeps up with the program: every key of a scene is in it, and its example runs.

use std::process::Command;

use serde_json::Value;

fn guide() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/guide.md")).unwrap()
}

fn yorp(arguments: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_yorp")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// Names of all properties, and of all choices, anywhere in a schema.
fn names(schema: &Value, found: &mut Vec<String>) {
    match schema {
        Value::Object(fields) => {
            if let Some(Value::Object(properties)) = fields.get("properties") {
                found.extend(properties.keys().cloned());
            }
            if let Some(Value::String(choice)) = fields.get("const") {
                found.push(choice.clone());
            }
            fields.values().for_each(|value| names(value, found));
        }
        Value::Array(values) => values.iter().for_each(|value| names(value, found)),
        _ => {}
    }
}

#[test]
fn every_key_and_choice_of_a_scene_is_in_the_guide() {
    let schema: Value = serde_json::from_slice(&yorp(&["schema"])).unwrap();
    let mut all = Vec::new();
    names(&schema, &mut all);
    assert!(all.len() > 60, "{all:?}");
    let guide = guide();
    let named = |name: &str| guide.contains(&format!("`{name}`")) || guide.contains(&format!("\"{name}\""));
    let missing: Vec<_> = all.iter().filter(|name| !named(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn the_example_scene_of_the_guide_is_one() {
    let guide = guide();
    let scene = guide.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, scene).unwrap();
    yorp(&["plan", file.to_str().unwrap()]);
}
