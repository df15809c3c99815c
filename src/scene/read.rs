//! Reads a scene file: text, then types, then values, each refusal with its place.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_path_to_error::Segment;

use super::limits::{first_violation, limit};
use super::position::{Step, find, line_column, offset};
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
        self.file.parent().unwrap_or(Path::new("")).join(path)
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
        let mut parser = serde_json::Deserializer::from_str(text);
        let parsed = serde_path_to_error::deserialize(&mut parser);
        // A missing brace makes keys look unknown, so broken JSON is reported before anything that may follow from it.
        if let Err(broken) = serde_json::from_str::<serde::de::IgnoredAny>(text) {
            let reached =
                parsed.err().filter(|error: &serde_path_to_error::Error<serde_json::Error>| !error.inner().is_data());
            let path = reached.map_or(".".to_owned(), |error| error.path().to_string());
            return Err(syntax_error(text, file, path, &broken));
        }
        let scene: Self = parsed.map_err(|error| parse_error(text, file, &error))?;
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

fn parse_error(text: &str, file: &Path, error: &serde_path_to_error::Error<serde_json::Error>) -> SceneError {
    let (path, json) = (error.path().to_string(), error.inner());
    if !json.is_data() {
        return syntax_error(text, file, path, json);
    }
    let steps: Vec<Step> = error.path().iter().filter_map(step).collect();
    let message = plain_words(&bare_message(json));
    // A key that stands twice is found at its first place by a search, at its second by the parser.
    let at = if message.starts_with("duplicate") { None } else { Some(steps.as_slice()) };
    let on_key = message.starts_with("unknown field");
    let at = at.and_then(|steps| find(text, steps)).map(|found| if on_key { found.key } else { found.value });
    let at = at.unwrap_or_else(|| offset(text, json.line(), json.column()));
    let allowed = limit(&path).map(|limit| format!("; allowed: {limit}")).unwrap_or_default();
    SceneError::Structure { at: location(text, file, at), path, message: message + &allowed }
}

fn syntax_error(text: &str, file: &Path, path: String, error: &serde_json::Error) -> SceneError {
    let at = location(text, file, offset(text, error.line(), error.column()));
    SceneError::Syntax { at, path, message: bare_message(error) }
}

/// The parser's message without its own line and column.
fn bare_message(error: &serde_json::Error) -> String {
    let full = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    full.strip_suffix(&place).unwrap_or(&full).to_owned()
}

/// The names of Rust's types in words that a user of JSON knows.
fn plain_words(message: &str) -> String {
    let Some((found, expected)) = message.rsplit_once(", expected ") else { return message.to_owned() };
    let expected = match expected {
        "f64" => "a number",
        "u32" | "u64" => "a whole number that is not negative",
        "a boolean" => "true or false",
        other if other.starts_with("struct ") => "an object",
        other if other.contains(" enum ") || other.starts_with("enum ") => "one of the variants in the schema",
        other => other,
    };
    let found = found.replace("invalid type: ", "found ").replace("invalid value: ", "found ");
    format!("{found}, expected {expected}")
}

fn step(segment: &Segment) -> Option<Step> {
    match segment {
        Segment::Seq { index } => Some(Step::Index(*index)),
        Segment::Map { key } => Some(Step::Key(key.clone())),
        Segment::Enum { variant } => Some(Step::Key(variant.clone())),
        Segment::Unknown => None,
    }
}

fn keys(path: &str) -> Vec<Step> {
    path.split('.').map(|key| Step::Key(key.to_owned())).collect()
}

/// The place of the value at `path`, or of its nearest ancestor in the text when it was left to its default.
fn locate(text: &str, file: &Path, path: &[Step]) -> Box<Location> {
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
