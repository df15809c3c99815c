//! The JSON Schema of a scene, from the same types and the same table of limits that read it.

use std::sync::LazyLock;

use serde_json::{Value, json};

use super::Scene;
use super::limits::{LIMITS, Limit};

/// JSON Schema (2020-12) of a scene.
pub fn json_schema() -> Value {
    SCHEMA.clone()
}

/// The same, made once.
pub(super) static SCHEMA: LazyLock<Value> = LazyLock::new(make);

/// Names the format wherever it lies; nothing has to be found there.
const ID: &str = "urn:yorp:scene:1";

fn make() -> Value {
    // Inlined, because a limit belongs to a path, and the same type may stand at several.
    let settings =
        schemars::generate::SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<Scene>().to_value();
    for limit in LIMITS {
        let path: Vec<&str> = limit.path.split('.').collect();
        let node = descend(&mut schema, &path).expect("every limit names a key of the scene");
        constrain(node, limit);
    }
    schema["$id"] = json!(ID);
    schema["title"] = json!("Scene of yorp");
    // As large as the number that takes it.
    schema["properties"]["seed"]["maximum"] = json!(u64::MAX);
    schema
}

/// The subschema at a path: through `properties`, and through the variants of an enumeration.
fn descend<'a>(node: &'a mut Value, path: &[&str]) -> Option<&'a mut Value> {
    let Some((key, rest)) = path.split_first() else { return Some(node) };
    let node = node.as_object_mut()?;
    if node.get("properties").is_some_and(|properties| properties.get(key).is_some()) {
        return descend(&mut node["properties"][key], rest);
    }
    let variants = node.get_mut("oneOf")?.as_array_mut()?;
    variants.iter_mut().find_map(|variant| descend(variant, path))
}

fn constrain(node: &mut Value, limit: &Limit) {
    let (low, high) = (
        if limit.above { "exclusiveMinimum" } else { "minimum" },
        if limit.below { "exclusiveMaximum" } else { "maximum" },
    );
    // The minimum that the Rust type implies is weaker than ours.
    node.as_object_mut().expect("a number's schema is an object").remove("minimum");
    node[low] = json!(limit.low);
    node[high] = json!(limit.high);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_limit_is_in_the_schema() {
        let mut schema = json_schema();
        let node = descend(&mut schema, &["surface", "reflectance", "hapke", "roughness_deg"]).unwrap();
        assert_eq!((&node["minimum"], &node["exclusiveMaximum"]), (&json!(0.0), &json!(60.0)));
        assert!(node["description"].as_str().unwrap().contains("deg"));
    }

    #[test]
    fn the_schema_says_what_it_is() {
        let schema = json_schema();
        assert_eq!((&schema["$id"], &schema["title"]), (&json!("urn:yorp:scene:1"), &json!("Scene of yorp")));
        assert_eq!(schema["$schema"], json!("https://json-schema.org/draft/2020-12/schema"));
        assert_eq!(schema["properties"]["$schema"]["type"], json!("string"));
    }

    #[test]
    fn unknown_keys_are_refused_and_only_the_body_is_required() {
        let schema = json_schema();
        assert_eq!(schema["additionalProperties"], json!(false));
        assert_eq!(schema["required"], json!(["body"]));
    }
}
