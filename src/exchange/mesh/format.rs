//! Which format a mesh file has, by its content and the ending of its name.

use std::path::Path;

/// What is read, for those who have something else.
pub(super) const READ: &str = "read are OBJ, PLY, STL, OFF and plate tables (PDS .tab, ICQ); MeshLab, ParaView or Blender \
                               convert to OBJ";

/// Formats of polygon meshes that are known by name and not read: ending, and name.
const NOT_READ: [(&str, &str); 22] = [
    ("3ds", "3D Studio"),
    ("blend", "Blender"),
    ("bds", "a SPICE shape kernel (DSK)"),
    ("dsk", "a SPICE shape kernel (DSK)"),
    ("dae", "COLLADA"),
    ("fbx", "FBX"),
    ("glb", "glTF"),
    ("gltf", "glTF"),
    ("iges", "IGES"),
    ("igs", "IGES"),
    ("img", "a PDS image"),
    ("fits", "FITS"),
    ("3mf", "3MF"),
    ("amf", "AMF"),
    ("msh", "Gmsh"),
    ("step", "STEP"),
    ("stp", "STEP"),
    ("vtk", "VTK"),
    ("vtp", "VTK"),
    ("vtu", "VTK"),
    ("wrl", "VRML"),
    ("x3d", "X3D"),
];

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFileFormat {
    /// Wavefront.
    Obj,
    /// Polygon File Format of Stanford, as text or binary.
    Ply,
    /// Stereolithography, as text or binary.
    Stl,
    /// Object File Format of Geomview, as text.
    Off,
    /// Numbers only: vertices and plates, or vertices in the order of a cube's faces (ICQ).
    Plates,
}

impl std::fmt::Display for MeshFileFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Obj => "Wavefront OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Off => "OFF",
            Self::Plates => "a table of vertices and plates",
        })
    }
}

impl MeshFileFormat {
    /// The format of a file with this name and content, or why there is none.
    pub(super) fn of(file: &Path, bytes: &[u8]) -> Result<Self, String> {
        let ending = file.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        if let Some(format) = Self::by_mark(bytes) {
            return Ok(format);
        }
        if let Some((_, name)) = NOT_READ.iter().find(|(known, _)| *known == ending) {
            return Err(format!("{name} (.{ending}) is not read"));
        }
        match ending.as_str() {
            // What is wrong with a file of that name is then told line by line.
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "stl" => Ok(Self::Stl),
            "off" => Ok(Self::Off),
            _ => Self::by_first_word(bytes).ok_or_else(|| match ending.as_str() {
                "" => "its name has no ending and its content is no mesh that is known".to_owned(),
                _ => format!("the ending .{ending} is unknown and the content is no mesh that is known"),
            }),
        }
    }

    /// Formats that begin with a mark of their own.
    fn by_mark(bytes: &[u8]) -> Option<Self> {
        let is_solid = bytes.trim_ascii_start().starts_with(b"solid");
        match () {
            () if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") => Some(Self::Ply),
            () if super::stl::is_binary(bytes) => Some(Self::Stl),
            () if is_solid && has_word(bytes, b"facet") => Some(Self::Stl),
            () if super::off::is_header(first_words(bytes).next().unwrap_or_default()) => Some(Self::Off),
            () => None,
        }
    }

    /// Formats that are told by what their first line says.
    fn by_first_word(bytes: &[u8]) -> Option<Self> {
        let mut words = first_words(bytes);
        let (word, next) = (words.next()?, words.next());
        let is_number = |word: &[u8]| std::str::from_utf8(word).is_ok_and(|w| w.parse::<f64>().is_ok());
        match word {
            b"v" | b"vn" | b"vt" | b"f" | b"o" | b"g" | b"mtllib" | b"s" if next.is_some() => Some(Self::Obj),
            _ if is_number(word) => Some(Self::Plates),
            _ => None,
        }
    }
}

/// The words of a text from its first line on that is no comment, as far as a few kilobytes reach.
fn first_words(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    const FAR: usize = 1 << 14;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let lines = bytes[..bytes.len().min(FAR)].split(|b| matches!(b, b'\n' | b'\r'));
    lines
        .map(<[u8]>::trim_ascii)
        .filter(|line| !line.is_empty() && !line.starts_with(b"#"))
        .flat_map(|line| line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()))
}

fn has_word(bytes: &[u8], word: &[u8]) -> bool {
    const FAR: usize = 1 << 14;
    bytes[..bytes.len().min(FAR)].split(u8::is_ascii_whitespace).any(|w| w == word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides_and_the_name_where_that_leaves_a_choice() {
        let of = |name: &str, text: &str| MeshFileFormat::of(Path::new(name), text.as_bytes());
        assert_eq!(of("a.obj", "ply\nformat ascii 1.0\n"), Ok(MeshFileFormat::Ply));
        assert_eq!(of("a.obj", "solid x\n facet normal 0 0 1\n"), Ok(MeshFileFormat::Stl));
        assert_eq!(of("a", "# made by\nOFF 4 4 6\n"), Ok(MeshFileFormat::Off));
        assert_eq!(of("a.txt", "# made by\n\nv 0 0 0\n"), Ok(MeshFileFormat::Obj));
        assert_eq!(of("a.tab", "v 0 0 0\n"), Ok(MeshFileFormat::Obj));
        assert_eq!(of("a.TAB", " 4 4\n 0 0 0\n"), Ok(MeshFileFormat::Plates));
        assert_eq!(of("a.OBJ", "nonsense"), Ok(MeshFileFormat::Obj));
        assert_eq!(of("a.glb", "glTF..."), Err("glTF (.glb) is not read".to_owned()));
        assert!(of("a.xyz", "nonsense").unwrap_err().contains("the ending .xyz is unknown"));
        assert!(of("a", "").unwrap_err().contains("no ending"));
    }
}
