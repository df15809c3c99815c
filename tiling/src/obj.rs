//! Wavefront OBJ files to and from meshes.
//!
//! Coordinates are read as `f64` in the file's unit and order. Polygons are cut into triangles ([`crate::polygon`]). Texture
//! coordinates, normals, groups, materials, lines, points and how to display a surface are skipped; free-form curves and
//! surfaces are refused. Memory is bounded by a few times the size of the text, whatever it says.
//!
//! Lines end in LF, CR LF or CR. A comment runs to the end of its line, even if that is a backslash: paths of Windows stand
//! there. Elsewhere a backslash at the end joins the next line, unless that one is a statement of its own, because the name
//! of a material or a group may end in one too.
//!
//! Reading does not judge the shape: see [`Mesh::check`].

use crate::polygon::{self, PolygonFault};
use crate::{Mesh, TilingError};
use std::fmt::Write;

/// Statements that say nothing about the shape of a polygon mesh.
const SKIPPED: [&str; 21] = [
    "vt",
    "vn",
    "vp",
    "g",
    "o",
    "s",
    "mg",
    "l",
    "p",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "lod",
    "shadow_obj",
    "trace_obj",
    "bevel",
    "c_interp",
    "d_interp",
    "ctech",
    "stech",
];

/// Statements of free-form curves and surfaces, those of older versions included.
const FREE_FORM: [&str; 22] = [
    "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con",
    "bsp", "bzp", "cdc", "cdp", "res", "csh", "call", "scmp",
];

/// What is wrong in a line of an OBJ file; texts from the file are cut to 40 characters and escaped.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObjFault {
    /// Not a number.
    #[error("`{found}` is not a number")]
    NotANumber {
        /// The text in its place.
        found: String,
    },
    /// A coordinate that is NaN, infinite or beyond the range of `f64`.
    #[error("coordinate `{found}` must be finite")]
    NonFinite {
        /// The text in its place.
        found: String,
    },
    /// A vertex with too few or too many numbers.
    #[error("a vertex has 3 coordinates (or 4 with a weight, 6 or 7 with a colour), not {found} numbers")]
    CoordinateCount {
        /// Numbers in the line.
        found: usize,
    },
    /// A facet with one or two corners.
    #[error("a facet needs at least 3 corners, not {found}")]
    CornerCount {
        /// Corners in the line.
        found: usize,
    },
    /// A facet's corner that is not `v`, `v/vt`, `v//vn` or `v/vt/vn` with non-zero integers.
    #[error("`{found}` is not a facet corner (v, v/vt, v//vn or v/vt/vn, counted from 1, or from the end with -1)")]
    Corner {
        /// The text in its place.
        found: String,
    },
    /// A facet's corner that names a vertex the file does not have.
    #[error("there is no vertex {index}: the file has {vertices}")]
    MissingVertex {
        /// The number in the file.
        index: i64,
        /// Vertices in the file; before this line if the number is negative.
        vertices: usize,
    },
    /// A statement that is not OBJ.
    #[error("`{found}` is not a statement of a polygon mesh")]
    Statement {
        /// The statement's first word.
        found: String,
    },
    /// A statement that describes something else than polygons.
    #[error(
        "`{found}` belongs to a free-form curve or surface; only polygons are read: export the shape as a polygon mesh"
    )]
    FreeForm {
        /// The statement's first word.
        found: String,
    },
    /// A facet that bounds no area.
    #[error(transparent)]
    Polygon(#[from] PolygonFault),
    /// Text of two bytes a character.
    #[error("the text is UTF-16; save it as UTF-8")]
    Utf16,
    /// More vertices than 32-bit indices can name.
    #[error("more than {} vertices", u32::MAX)]
    TooManyVertices,
}

/// Reads a mesh from the bytes of an OBJ file, in the file's unit.
///
/// # Errors
/// [`TilingError::Obj`] with the first line (from 1) that is not understood, [`TilingError::Empty`] if there is no
/// vertex or no facet.
/// # Examples
/// ```
/// let mesh = tiling::obj::read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")?;
/// assert_eq!(mesh.facets, [[0, 1, 2]]);
/// # Ok::<(), tiling::TilingError>(())
/// ```
pub fn read(text: &[u8]) -> Result<Mesh, TilingError> {
    if text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff") {
        return Err(TilingError::Obj { line: 1, fault: ObjFault::Utf16 });
    }
    let mut reader = Reader::default();
    let mut lines = Lines { rest: text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text), number: 0 }.peekable();
    let mut joined = Vec::new();
    while let Some((number, line)) = lines.next() {
        let mut line = statement_of(line);
        joined.clear();
        while let Some(start) = line.strip_suffix(b"\\") {
            let Some((_, next)) = lines.next_if(|(_, next)| continues(next)) else {
                line = start;
                break;
            };
            joined.extend_from_slice(start);
            joined.push(b' ');
            line = statement_of(next);
        }
        let statement = if joined.is_empty() {
            line
        } else {
            joined.extend_from_slice(line);
            &joined
        };
        reader.statement(statement, number).map_err(|fault| TilingError::Obj { line: number, fault })?;
    }
    reader.finish()
}

/// The lines of a text with their numbers from 1; they end in LF, CR LF or CR.
struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest.strip_prefix(b"\r\n").or(rest.get(1..)).unwrap_or_default();
        self.number += 1;
        Some((self.number, line))
    }
}

/// A line without its comment and the blanks before that.
fn statement_of(line: &[u8]) -> &[u8] {
    line.split(|b| *b == b'#').next().unwrap_or_default().trim_ascii_end()
}

/// Whether a line can be the continuation of the one before: it says something and is no statement of its own.
fn continues(line: &[u8]) -> bool {
    let first = words(statement_of(line)).next();
    first.is_some_and(|word| {
        !matches!(word, b"v" | b"f" | b"fo") && !is_one_of(word, &SKIPPED) && !is_one_of(word, &FREE_FORM)
    })
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
}

fn is_one_of(word: &[u8], list: &[&str]) -> bool {
    list.iter().any(|name| name.as_bytes() == word)
}

/// The text of an OBJ file: each line of `comment` after a `#`, then vertices and facets in order.
///
/// Coordinates are the shortest decimals that read back as the same `f64`.
pub fn write(mesh: &Mesh, comment: &str) -> String {
    let mut text = String::with_capacity(64 * mesh.vertices.len() + 24 * mesh.facets.len());
    for line in comment.lines() {
        text.push_str(format!("# {line}").trim_end());
        text.push('\n');
    }
    let infallible = "writing to a string cannot fail";
    for [x, y, z] in &mesh.vertices {
        writeln!(text, "v {x:?} {y:?} {z:?}").expect(infallible);
    }
    for f in &mesh.facets {
        let [a, b, c] = f.map(|v| u64::from(v) + 1);
        writeln!(text, "f {a} {b} {c}").expect(infallible);
    }
    text
}

#[derive(Default)]
struct Reader {
    mesh: Mesh,
    /// Largest vertex number named so far and the line of its first use: a facet may name a vertex of a later line.
    largest: (u32, usize),
    /// Corners of the facet being read.
    corners: Vec<u32>,
    /// Facets with more than three corners, as long as all vertices are not known: the line, and their triangles.
    polygons: Vec<(usize, std::ops::Range<usize>)>,
}

impl Reader {
    fn statement(&mut self, line: &[u8], number: usize) -> Result<(), ObjFault> {
        let mut words = words(line);
        match words.next() {
            None => Ok(()),
            Some(b"v") => self.vertex(words),
            // `fo` is what facets were called in an older version.
            Some(b"f" | b"fo") => self.facet(words, number),
            Some(word) if is_one_of(word, &SKIPPED) => Ok(()),
            Some(word) if is_one_of(word, &FREE_FORM) => Err(ObjFault::FreeForm { found: shown(word) }),
            Some(word) => Err(ObjFault::Statement { found: shown(word) }),
        }
    }

    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) -> Result<(), ObjFault> {
        let mut coordinates = [0.0; 3];
        let mut found = 0;
        for word in words {
            let value: f64 = parsed(word).ok_or_else(|| ObjFault::NotANumber { found: shown(word) })?;
            if !value.is_finite() {
                return Err(ObjFault::NonFinite { found: shown(word) });
            }
            if let Some(coordinate) = coordinates.get_mut(found) {
                *coordinate = value;
            }
            found += 1;
        }
        if !matches!(found, 3 | 4 | 6 | 7) {
            return Err(ObjFault::CoordinateCount { found });
        }
        if self.mesh.vertices.len() >= u32::MAX as usize {
            return Err(ObjFault::TooManyVertices);
        }
        self.mesh.vertices.push(coordinates);
        Ok(())
    }

    fn facet<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>, line: usize) -> Result<(), ObjFault> {
        self.corners.clear();
        for word in words {
            let corner = self.corner(word)?;
            if corner > self.largest.0 || self.largest.1 == 0 {
                self.largest = (corner, line);
            }
            self.corners.push(corner);
        }
        if self.corners.len() < 3 {
            return Err(ObjFault::CornerCount { found: self.corners.len() });
        }
        let before = self.mesh.facets.len();
        polygon::fan(&self.corners, &mut self.mesh.facets);
        if self.mesh.facets.len() > before + 1 {
            self.polygons.push((line, before..self.mesh.facets.len()));
        }
        Ok(())
    }

    /// Index from 0 of the vertex that `word` names.
    fn corner(&self, word: &[u8]) -> Result<u32, ObjFault> {
        let malformed = || ObjFault::Corner { found: shown(word) };
        let mut parts = word.split(|b| *b == b'/');
        let index: i64 = parts.next().and_then(parsed).ok_or_else(malformed)?;
        let rest_is_sound = parts.clone().count() <= 2 && parts.all(|p| p.is_empty() || parsed::<i64>(p).is_some());
        if index == 0 || !rest_is_sound {
            return Err(malformed());
        }
        let vertices = self.mesh.vertices.len();
        let missing = ObjFault::MissingVertex { index, vertices };
        if index > 0 {
            // Vertices may follow: only numbers beyond any file are refused here.
            u32::try_from(index - 1).map_err(|_| missing)
        } else {
            // Fewer vertices than 2^32 are admitted, so the sum fits.
            u32::try_from(index.saturating_add(vertices as i64)).map_err(|_| missing)
        }
    }

    fn finish(mut self) -> Result<Mesh, TilingError> {
        let (vertices, facets) = (self.mesh.vertices.len(), self.mesh.facets.len());
        if vertices == 0 || facets == 0 {
            return Err(TilingError::Empty { vertices, facets });
        }
        let (largest, line) = self.largest;
        if largest as usize >= vertices {
            let fault = ObjFault::MissingVertex { index: i64::from(largest) + 1, vertices };
            return Err(TilingError::Obj { line, fault });
        }
        for (line, facets) in self.polygons {
            polygon::mend_fan(&self.mesh.vertices, &mut self.mesh.facets[facets])
                .map_err(|fault| TilingError::Obj { line, fault: fault.into() })?;
        }
        Ok(self.mesh)
    }
}

fn parsed<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let head = &word[..word.len().min(4 * LONGEST)];
    let mut text: String = String::from_utf8_lossy(head).chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if word.len() > head.len() || text.chars().count() > LONGEST {
        text.push_str("...");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fault_of(text: &str) -> (usize, ObjFault) {
        match read(text.as_bytes()) {
            Err(TilingError::Obj { line, fault }) => (line, fault),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn all_corner_forms_polygons_and_continued_lines_are_read() {
        let text = "# tetrahedron and a quad\r\nmtllib a.mtl\no body\nv 0 0 0\r\nv 1 0 0 1.0\nv 0 1e0 0 0.5 0.5 0.5\n\
                    v 0 \\\n 0 \\\r\n 1 # apex\nvt 0 0\nvn 0 0 1\ns off\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\n\
                    f 1/1/1 2/1/1 3/1/1\nf -4 -3 -2 -1\n";
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(mesh.vertices, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(mesh.facets, [[0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 2, 3]]);
    }

    /// A backslash at the end of a comment or of a name is none that continues a line.
    #[test]
    fn comments_and_names_that_end_in_a_backslash_swallow_nothing() {
        let want = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        for text in [
            "# C:\\tmp\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "v 0 0 0 # C:\\\nv 1 0 0\nv 0 1 0\nf 1 2 3 #\\",
            "mtllib C:\\tmp\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng part\\\nf 1 2 3\n",
            "o a \\  \r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nusemtl stone\\\r\nf 1 2 3\r\n",
            "g a \\\n b c\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 3 # \\\n",
            "v 0 0 0 \\\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "v 0 0 0 \\\n\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\",
        ] {
            assert_eq!(read(text.as_bytes()).as_ref(), Ok(&want), "{text}");
        }
        assert_eq!(fault_of("v 0 0 \\\n# 0\n"), (1, ObjFault::CoordinateCount { found: 2 }));
    }

    #[test]
    fn all_line_ends_and_a_byte_order_mark_are_read() {
        let lines = ["v 0 0 0", "# comment", "v 1 0 \\", "0", "", "v 0 1 0", "f 1 2 3"];
        let want = read(lines.join("\n").as_bytes()).unwrap();
        for end in ["\n", "\r\n", "\r"] {
            for (mark, last) in [("", ""), ("\u{feff}", end)] {
                let text = format!("{mark}{}{last}", lines.join(end));
                assert_eq!(read(text.as_bytes()).as_ref(), Ok(&want), "{text:?}");
            }
        }
        assert_eq!(fault_of("v 0 0 0\rv 1 nan 2\r").0, 2);
        let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain("v 0".encode_utf16().flat_map(u16::to_le_bytes)).collect();
        assert_eq!(read(&utf16), Err(TilingError::Obj { line: 1, fault: ObjFault::Utf16 }));
    }

    #[test]
    fn statements_of_display_are_skipped_and_free_forms_refused() {
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nfo 1 2 3\n";
        for skipped in SKIPPED {
            assert_eq!(read(format!("{skipped} off\n{triangle}").as_bytes()).unwrap().facets, [[0, 1, 2]]);
        }
        let (line, fault) = fault_of(&format!("{triangle}cstype bezier\n"));
        assert_eq!((line, fault), (5, ObjFault::FreeForm { found: "cstype".to_owned() }));
    }

    #[test]
    fn concave_polygons_are_cut_inside_and_crossed_ones_refused_with_their_line() {
        let l = "v 0 0 0\nv 30 0 0\nv 30 10 0\nv 10 10 0\nv 10 30 0\nv 0 30 0\n";
        for first in 0..6 {
            let corners: Vec<String> = (0..6).map(|k| ((first + k) % 6 + 1).to_string()).collect();
            let mesh = read(format!("{l}f {}\n", corners.join(" ")).as_bytes()).unwrap();
            assert!((mesh.surface_area() - 500.0).abs() < 1e-9, "{:?}", mesh.facets);
        }
        let crossed = fault_of("f 1 2 3 4\nv 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1.5 0\n");
        assert_eq!(crossed, (1, ObjFault::Polygon(PolygonFault::NotSimple { corners: 4 })));
        // Some programs write triangles as quadrangles.
        assert_eq!(read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 3\n").unwrap().facets, [[0, 1, 2]]);
    }

    #[test]
    fn facets_may_come_before_their_vertices() {
        assert_eq!(read(b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0").unwrap().facets, [[0, 1, 2]]);
    }

    #[test]
    fn faults_carry_their_line_and_what_was_found() {
        let found = |s: &str| s.to_string();
        assert_eq!(fault_of("v 0 0 0\nv 1 NaN 2\n"), (2, ObjFault::NonFinite { found: found("NaN") }));
        assert_eq!(fault_of("v 0 0 -inf\n"), (1, ObjFault::NonFinite { found: found("-inf") }));
        assert_eq!(fault_of("v 0 0 1e400\n"), (1, ObjFault::NonFinite { found: found("1e400") }));
        assert_eq!(fault_of("\n\nv 0 0 zero\n"), (3, ObjFault::NotANumber { found: found("zero") }));
        assert_eq!(fault_of("v 0 0\n"), (1, ObjFault::CoordinateCount { found: 2 }));
        assert_eq!(fault_of("v 0 0 0\nf 1 1\n"), (2, ObjFault::CornerCount { found: 2 }));
        assert_eq!(fault_of("v 0 0 0\nf\n"), (2, ObjFault::CornerCount { found: 0 }));
        assert_eq!(fault_of("v 0 0 0\nf 0 1 1\n"), (2, ObjFault::Corner { found: found("0") }));
        assert_eq!(fault_of("v 0 0 0\nf 1 1/x 1\n"), (2, ObjFault::Corner { found: found("1/x") }));
        assert_eq!(fault_of("v 0 0 0\nf 1 1/1/1/1 1\n"), (2, ObjFault::Corner { found: found("1/1/1/1") }));
        assert_eq!(fault_of("v 0 0 0\nf 1 1 2\n"), (2, ObjFault::MissingVertex { index: 2, vertices: 1 }));
        assert_eq!(fault_of("v 0 0 0\nf 1 1 -2\n"), (2, ObjFault::MissingVertex { index: -2, vertices: 1 }));
        assert_eq!(fault_of("v 0 0 \\\n 0\nf 1 \\\n 1 9\n"), (3, ObjFault::MissingVertex { index: 9, vertices: 1 }));
        let beyond = ObjFault::MissingVertex { index: 4294967297, vertices: 0 };
        assert_eq!(fault_of("f 1 1 4294967297\n"), (1, beyond));
        assert_eq!(fault_of("solid stl\n"), (1, ObjFault::Statement { found: found("solid") }));
        assert_eq!(read(b""), Err(TilingError::Empty { vertices: 0, facets: 0 }));
        let fault = read(b"v 0 0 0\nv 1 nan 2\n").unwrap_err();
        assert_eq!(fault.to_string(), "line 2: coordinate `nan` must be finite");
    }

    #[test]
    fn long_or_binary_words_are_cut_and_escaped() {
        let (_, fault) = fault_of(&format!("v 0 0 {}\n", "\u{1b}".repeat(1000)));
        assert!(matches!(&fault, ObjFault::NotANumber { found } if found.len() < 400 && found.starts_with("\\u{1b}")));
    }

    #[test]
    fn comment_and_numbers_are_written_plainly() {
        let mesh = Mesh { vertices: vec![[1.0, -0.5, 1e-300]; 3], facets: vec![[0, 1, 2]] };
        let text = write(&mesh, "two\nlines");
        assert_eq!(text, "# two\n# lines\nv 1.0 -0.5 1e-300\nv 1.0 -0.5 1e-300\nv 1.0 -0.5 1e-300\nf 1 2 3\n");
    }

    proptest! {
        #[test]
        fn prop_any_bytes_are_read_or_refused(text in prop::collection::vec(any::<u8>(), 0..400)) {
            let _ = read(&text);
        }

        #[test]
        fn prop_any_obj_like_text_is_read_or_refused(
            text in "([vf#l\\\\]|vn|[ \t]|\r?\n|-?[0-9]{1,20}|/|[0-9]e[0-9]{1,3}|nan){0,120}",
        ) {
            if let Ok(mesh) = read(text.as_bytes()) {
                let _ = mesh.check();
                prop_assert!(mesh.facets.len() <= text.len());
            }
        }

        #[test]
        fn prop_written_meshes_read_back_bit_for_bit(
            vertices in prop::collection::vec(prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL
                | prop::num::f64::ZERO), 1..20),
            corners in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..20),
        ) {
            let facets = corners.iter().map(|f| f.map(|i| i.index(vertices.len()) as u32)).collect();
            let mesh = Mesh { vertices, facets };
            let back = read(write(&mesh, "").as_bytes()).unwrap();
            let bits = |m: &Mesh| m.vertices.iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&back), bits(&mesh));
            prop_assert_eq!(back.facets, mesh.facets);
        }
    }
}
