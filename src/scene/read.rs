//! Reads a scene file: text, then structure, then values, each refusal with its place.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use crate::exchange::expand_home;

use super::limits::{first_violation, limit};
use super::position::{find, line_column, offset};
use super::schema::SCHEMA;
use super::structure::{Fault, Misfit, fit};
use super::{Body, Location, Scene, SceneError};

/// Largest scene file, bytes; a complete scene takes two thousand.
pub const MAX_SCENE_BYTES: u64 = 1 << 20;

/// A valid scene with the file it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// The file, as the caller named it.
    pub file: PathBuf,
}

impl SceneFile {
    /// Reads and validates the scene in `file`, and looks whether the files it names can be opened.
    ///
    /// # Errors
    /// [`SceneError`] with the place in the file, what was found and what is allowed.
    pub fn read(file: &Path) -> Result<Self, SceneError> {
        let (scene, text) = Self::read_alone(file)?;
        scene.look_for_files(&text)?;
        Ok(scene)
    }

    /// Reads and validates the scene in `file`, but not whether the files it names are there: a run whose body has been
    /// made goes on without them. With the text.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_alone(file: &Path) -> Result<(Self, String), SceneError> {
        let unreadable = |source| SceneError::Read { file: file.to_owned(), source };
        let mut bytes = Vec::new();
        // One byte beyond the limit tells a file that is too large, also when it is a pipe without a length.
        let open = std::fs::File::open(file).map_err(unreadable)?;
        open.take(MAX_SCENE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > MAX_SCENE_BYTES {
            return Err(SceneError::TooLarge { file: file.to_owned(), limit: MAX_SCENE_BYTES });
        }
        let text = String::from_utf8(bytes).map_err(|error| SceneError::NotText {
            file: file.to_owned(),
            valid_up_to: error.utf8_error().valid_up_to(),
        })?;
        Ok((Self { scene: Scene::parse(&text, file)?, file: file.to_owned() }, text))
    }

    /// The files that the scene is made of: itself, and the one that its body comes from.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let body = match &self.scene.body {
            Body::PackedEllipsoid(_) => None,
            Body::File(body) => Some(self.resolve(&body.path)),
            Body::CarvedMesh(body) => Some(self.resolve(&body.path)),
        };
        std::iter::once(self.file.clone()).chain(body).collect()
    }

    /// A path of the scene, which is relative to the folder of the scene, as a path of this process.
    pub fn resolve(&self, path: &str) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(expand_home(Path::new(path)))
    }

    /// Whether the files that the scene names can be opened; `text` is its own.
    ///
    /// # Errors
    /// [`SceneError::Missing`].
    pub fn look_for_files(&self, text: &str) -> Result<(), SceneError> {
        let (path, name) = match &self.scene.body {
            Body::PackedEllipsoid(_) => return Ok(()),
            Body::File(body) => ("body.file.path", &body.path),
            Body::CarvedMesh(body) => ("body.carved_mesh.path", &body.path),
        };
        let Err(source) = std::fs::File::open(self.resolve(name)) else { return Ok(()) };
        let at = locate(text, &self.file, &keys(path));
        Err(SceneError::Missing { at, path: path.to_owned(), found: format!("{name:?}"), source })
    }
}

impl Scene {
    /// Parses and validates the text of a scene; `file` only names it in errors.
    ///
    /// # Errors
    /// [`SceneError::Syntax`], [`SceneError::Structure`] or [`SceneError::Value`].
    /// # Examples
    /// ```
    /// # use yorp::scene::Scene;
    /// let text = r#"{"body": {"packed_ellipsoid":
    ///     {"spheres": 1000, "radius_m": 50.2, "grain_density_kg_m3": 2960, "b_over_a": 0.7, "c_over_a": 0.8}}}"#;
    /// let refused = Scene::parse(text, "scene.json".as_ref()).unwrap_err();
    /// assert_eq!(
    ///     refused.to_string(),
    ///     "scene.json:2:99: `body.packed_ellipsoid.c_over_a` is 0.8; allowed: at least 0.1, at most b_over_a = 0.7"
    /// );
    /// ```
    pub fn parse(text: &str, file: &Path) -> Result<Self, SceneError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut parser = serde_json::Deserializer::from_str(text);
        let parsed = serde_path_to_error::deserialize(&mut parser);
        // A missing brace makes keys look doubled, so broken JSON is reported before anything that may follow from it.
        if let Err(broken) = serde_json::from_str::<serde::de::IgnoredAny>(text) {
            let reached =
                parsed.err().filter(|error: &serde_path_to_error::Error<serde_json::Error>| !error.inner().is_data());
            let path = reached.map_or(".".to_owned(), |error| error.path().to_string());
            return Err(syntax_error(text, file, path, &broken));
        }
        let Tree(mut tree) = parsed.map_err(|error| tree_error(text, file, &error))?;
        fit(&mut tree, &SCHEMA).map_err(|misfit| misfit_error(text, file, misfit))?;
        let scene: Self = serde_path_to_error::deserialize(tree).map_err(|error| type_error(text, file, &error))?;
        match first_violation(&scene) {
            None => Ok(scene),
            Some(violation) => {
                let at = locate(text, file, &keys(&violation.path));
                let found = number_at(text, at.offset).unwrap_or(&violation.found).to_owned();
                Err(SceneError::Value { at, path: violation.path, found, allowed: violation.allowed })
            }
        }
    }
}

/// A JSON text as a tree in which no key stands twice.
struct Tree(Value);

impl<'de> Deserialize<'de> for Tree {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TreeVisitor).map(Self)
    }
}

struct TreeVisitor;

impl<'de> Visitor<'de> for TreeVisitor {
    type Value = Value;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut access: A) -> Result<Value, A::Error> {
        let mut array = Vec::new();
        while let Some(Tree(value)) = access.next_element()? {
            array.push(value);
        }
        Ok(Value::Array(array))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut access: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(key) = access.next_key::<String>()? {
            if object.contains_key(&key) {
                return Err(Error::custom(format_args!("duplicate field `{key}`")));
            }
            let Tree(value) = access.next_value()?;
            object.insert(key, value);
        }
        Ok(Value::Object(object))
    }
}

/// A number that no computer number holds, or a key that stands twice: the parser stands there.
fn tree_error(text: &str, file: &Path, error: &serde_path_to_error::Error<serde_json::Error>) -> SceneError {
    let (path, json) = (error.path().to_string(), error.inner());
    if !json.is_data() {
        return syntax_error(text, file, path, json);
    }
    let at = location(text, file, offset(text, json.line(), json.column()));
    SceneError::Structure { at, path, message: bare_message(json) }
}

fn misfit_error(text: &str, file: &Path, Misfit { path, fault }: Misfit) -> SceneError {
    let found = find(text, &path);
    let (last, path) = (path.last().cloned().unwrap_or_default(), path.join("."));
    let path = if path.is_empty() { ".".to_owned() } else { path };
    let place =
        |on_key: bool| location(text, file, found.map_or(0, |found| if on_key { found.key } else { found.value }));
    let structure = |on_key, message| SceneError::Structure { at: place(on_key), path: path.clone(), message };
    match fault {
        Fault::Alternative(takes, found) => SceneError::Alternative { at: place(false), path, takes, found },
        Fault::Lacks(key) => structure(false, format!("missing field `{key}`")),
        Fault::Unknown(known) => {
            let known: Vec<String> = known.iter().map(|key| format!("`{key}`")).collect();
            structure(true, format!("unknown field `{last}`, expected one of {}", known.join(", ")))
        }
        Fault::Kind(found, expected) => {
            let allowed = limit(&path).map(|limit| format!("; allowed: {limit}")).unwrap_or_default();
            structure(false, format!("found {found}, expected {expected}{allowed}"))
        }
    }
}

/// What the schema lets through and the types refuse.
fn type_error(text: &str, file: &Path, error: &serde_path_to_error::Error<serde_json::Error>) -> SceneError {
    let path = error.path().to_string();
    SceneError::Structure { at: locate(text, file, &keys(&path)), path, message: error.inner().to_string() }
}

fn syntax_error(text: &str, file: &Path, path: String, error: &serde_json::Error) -> SceneError {
    let at = location(text, file, offset(text, error.line(), error.column()));
    let message = bare_message(error);
    let hint = beyond_json(text, at.offset, &message).map(|hint| format!("; {hint}")).unwrap_or_default();
    SceneError::Syntax { at, path, message: message + &hint }
}

/// The parser's message without its own line and column.
fn bare_message(error: &serde_json::Error) -> String {
    let full = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    full.strip_suffix(&place).unwrap_or(&full).to_owned()
}

/// What the text at `offset` tries that JSON does not have.
fn beyond_json(text: &str, offset: usize, message: &str) -> Option<&'static str> {
    let rest = &text[offset..];
    let before = text[..offset].trim_end();
    let starts = |words: &[&str]| words.iter().any(|word| rest.starts_with(word));
    if starts(&["//", "/*", "#", "/"]) {
        Some("JSON has no comments")
    } else if message.starts_with("trailing comma") || (starts(&["}", "]"]) && before.ends_with(',')) {
        Some("JSON has no comma after the last entry")
    } else if starts(&["'"]) {
        Some("JSON puts texts in double quotes")
    } else if starts(&["NaN", "nan", "Infinity", "inf", "-Infinity", "-inf"]) {
        Some("JSON has finite numbers only")
    } else if starts(&["True", "False", "None", "TRUE", "FALSE", "NULL", "Null"]) {
        Some("JSON writes true, false and null")
    } else if message.starts_with("key must be a string") {
        Some("JSON puts keys in double quotes")
    } else {
        None
    }
}

fn keys(path: &str) -> Vec<String> {
    path.split('.').map(str::to_owned).collect()
}

/// The place of the value at `path`, or of its nearest ancestor in the text when it was left to its default.
fn locate(text: &str, file: &Path, path: &[String]) -> Box<Location> {
    let nearest = (0..=path.len()).rev().find_map(|length| find(text, &path[..length]));
    location(text, file, nearest.map_or(0, |found| found.value))
}

/// The number that begins at `offset`, as the user wrote it.
fn number_at(text: &str, offset: usize) -> Option<&str> {
    let rest = &text[offset..];
    let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c))).unwrap_or(rest.len());
    rest.starts_with(|c: char| c == '-' || c.is_ascii_digit()).then(|| &rest[..end])
}

fn location(text: &str, file: &Path, offset: usize) -> Box<Location> {
    let (line, column) = line_column(text, offset);
    Box::new(Location { file: file.to_owned(), line, column, offset, text: Arc::from(text) })
}
