//! Whether a run may go on with a scene: the first key in which two scenes differ.

use serde_json::Value;

use super::Scene;

/// A key in which two scenes differ.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Path of the key.
    pub path: String,
    /// Its value in the scene of the run, as JSON; "absent" if there is none.
    pub stored: String,
    /// Its value in the scene given now.
    pub given: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "`{}` is {} in the run and {} in the scene", self.path, self.stored, self.given)
    }
}

/// The first difference between the scene of a run and one given to resume it, defaults filled in, in the order of the
/// format. `evolution.duration_myr` may grow, going on for longer is no other run, and `settling.allow_reshaping` may
/// be set where a body was refused.
pub fn first_difference(stored: &Scene, given: &Scene) -> Option<Difference> {
    let mut given_tree = tree(given);
    if given.evolution.duration_myr > stored.evolution.duration_myr {
        given_tree["evolution"]["duration_myr"] = stored.evolution.duration_myr.into();
    }
    // What has been refused may be allowed; what has been allowed stays so.
    if given.settling.allow_reshaping {
        given_tree["settling"]["allow_reshaping"] = stored.settling.allow_reshaping.into();
    }
    differing(&tree(stored), &given_tree, &mut String::new())
}

fn tree(scene: &Scene) -> Value {
    serde_json::to_value(scene).expect("a scene is plain data with string keys")
}

/// Depth first in the order of the stored scene's keys, then whatever only the other has; scenes hold no arrays.
fn differing(stored: &Value, given: &Value, path: &mut String) -> Option<Difference> {
    let (Some(left), Some(right)) = (stored.as_object(), given.as_object()) else {
        let difference = || Difference { path: path.clone(), stored: stored.to_string(), given: given.to_string() };
        return (stored != given).then(difference);
    };
    let only_right = right.keys().filter(|key| !left.contains_key(*key));
    for key in left.keys().chain(only_right) {
        let length = path.len();
        if !path.is_empty() {
            path.push('.');
        }
        path.push_str(key);
        let found = match (left.get(key), right.get(key)) {
            (Some(left), Some(right)) => differing(left, right, path),
            (left, right) => {
                let show = |value: Option<&Value>| value.map_or("absent".to_owned(), Value::to_string);
                Some(Difference { path: path.clone(), stored: show(left), given: show(right) })
            }
        };
        if found.is_some() {
            return found;
        }
        path.truncate(length);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Body, FileBody, LambertReflectance, Reflectance};

    fn scene() -> Scene {
        Scene::from_body(Body::File(FileBody { path: "a.csv".into() }))
    }

    #[test]
    fn equal_scenes_do_not_differ() {
        assert_eq!(first_difference(&scene(), &scene()), None);
    }

    #[test]
    fn the_first_differing_path_is_named_with_both_values() {
        let mut given = scene();
        given.tiling.facets = 3184;
        given.spin.period_h = 7.0;
        let found = first_difference(&scene(), &given).unwrap();
        assert_eq!(found.to_string(), "`spin.period_h` is 6.0 in the run and 7.0 in the scene");
    }

    #[test]
    fn another_variant_differs_at_its_own_key() {
        let mut given = scene();
        given.surface.reflectance = Reflectance::Lambert(LambertReflectance::default());
        let found = first_difference(&scene(), &given).unwrap();
        assert_eq!((found.path.as_str(), found.given.as_str()), ("surface.reflectance.hapke", "absent"));
    }

    #[test]
    fn the_duration_may_grow_but_not_shrink() {
        let mut given = scene();
        given.evolution.duration_myr = 30.0;
        assert_eq!(first_difference(&scene(), &given), None);
        given.evolution.duration_myr = 3.0;
        assert_eq!(first_difference(&scene(), &given).unwrap().path, "evolution.duration_myr");
    }
}
