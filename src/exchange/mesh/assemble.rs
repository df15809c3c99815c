//! Vertices and polygons as the readers find them, made into a mesh of triangles.

use std::collections::HashMap;

use tiling::Mesh;
use tiling::polygon::{self, PolygonFault};

/// What is wrong with a mesh file other than OBJ; texts of the file are cut to 40 characters and escaped.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssemblyFault {
    /// A line that is not what the format wants there.
    #[error("line {line}: expected {expected}, not `{found}`")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What should stand there.
        expected: &'static str,
        /// What does.
        found: String,
    },
    /// The file ends before all that it announces.
    #[error("the file ends where {expected} should follow")]
    Short {
        /// What is missing.
        expected: &'static str,
    },
    /// A coordinate that is not finite, or missing.
    #[error("vertex {}: coordinates must be finite numbers", vertex + 1)]
    Coordinate {
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A facet that names a vertex that does not exist.
    #[error("facet {} of the file names vertex {index}, but there are {vertices}", facet + 1)]
    MissingVertex {
        /// The facet, from 0.
        facet: usize,
        /// The vertex it names, as the file counts.
        index: i64,
        /// Vertices there are.
        vertices: usize,
    },
    /// A facet with one or two corners.
    #[error("facet {} of the file has {corners} corners and needs at least 3", facet + 1)]
    Corners {
        /// The facet, from 0.
        facet: usize,
        /// Its corners.
        corners: usize,
    },
    /// A facet that bounds no area.
    #[error("facet {} of the file: {fault}", facet + 1)]
    Polygon {
        /// The facet, from 0.
        facet: usize,
        /// What is wrong with it.
        fault: PolygonFault,
    },
    /// What the library that reads PLY says.
    #[error("{0}")]
    Ply(String),
    /// A variant of the format that is not read.
    #[error("{0} is not read; convert to OBJ with MeshLab or Blender")]
    Variant(&'static str),
}

/// Vertices and polygons on their way into a mesh.
#[derive(Debug, Default)]
pub(super) struct Assembly {
    mesh: Mesh,
    /// Polygons added.
    polygons: usize,
}

impl Assembly {
    /// With these vertices.
    ///
    /// # Errors
    /// [`AssemblyFault::Coordinate`].
    pub fn new(vertices: Vec<[f64; 3]>) -> Result<Self, AssemblyFault> {
        match vertices.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
            Some(vertex) => Err(AssemblyFault::Coordinate { vertex }),
            None => Ok(Self { mesh: Mesh { vertices, facets: Vec::new() }, polygons: 0 }),
        }
    }

    /// Adds a polygon whose corners are counted from `first`.
    ///
    /// # Errors
    /// A corner that does not exist, or an outline without area.
    pub fn polygon(&mut self, corners: &[i64], first: i64) -> Result<(), AssemblyFault> {
        let (facet, vertices) = (self.polygons, self.mesh.vertices.len());
        if corners.len() < 3 {
            return Err(AssemblyFault::Corners { facet, corners: corners.len() });
        }
        let vertex = |index: &i64| {
            let place =
                index.checked_sub(first).and_then(|i| u32::try_from(i).ok()).filter(|i| (*i as usize) < vertices);
            place.ok_or(AssemblyFault::MissingVertex { facet, index: *index, vertices })
        };
        let corners = corners.iter().map(vertex).collect::<Result<Vec<u32>, _>>()?;
        let before = self.mesh.facets.len();
        polygon::fan(&corners, &mut self.mesh.facets);
        polygon::mend_fan(&self.mesh.vertices, &mut self.mesh.facets[before..])
            .map_err(|fault| AssemblyFault::Polygon { facet, fault })?;
        self.polygons += 1;
        Ok(())
    }

    /// The mesh.
    pub fn finish(self) -> Mesh {
        self.mesh
    }
}

/// The mesh with vertices of equal coordinates made one, the first of them.
pub(super) fn welded(mesh: &Mesh) -> Mesh {
    let mut places: HashMap<[u64; 3], u32> = HashMap::with_capacity(mesh.vertices.len());
    let mut vertices = Vec::new();
    let mut numbers = Vec::with_capacity(mesh.vertices.len());
    for v in &mesh.vertices {
        // Adding zero turns -0 into 0, which is the same place.
        let number = *places.entry(v.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
            vertices.push(*v);
            (vertices.len() - 1) as u32
        });
        numbers.push(number);
    }
    let facets = mesh.facets.iter().map(|f| f.map(|v| numbers[v as usize])).collect();
    Mesh { vertices, facets }
}

/// The lines of a text that say something, without comments after `#`, as words, with their numbers from 1.
pub(super) struct TextLines<'a> {
    text: &'a [u8],
    number: usize,
}

impl<'a> TextLines<'a> {
    pub fn new(text: &'a [u8]) -> Self {
        Self { text: text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text), number: 0 }
    }

    /// The next line's number and words.
    ///
    /// # Errors
    /// [`AssemblyFault::Short`] at the end of the text.
    pub fn next(&mut self, expected: &'static str) -> Result<Line<'a>, AssemblyFault> {
        while !self.text.is_empty() {
            let end = self.text.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.text.len());
            let (line, rest) = self.text.split_at(end);
            self.text = rest.strip_prefix(b"\r\n").or(rest.get(1..)).unwrap_or_default();
            self.number += 1;
            let line = line.split(|b| *b == b'#').next().unwrap_or_default();
            // Tables may separate by commas.
            let words: Vec<&[u8]> =
                line.split(|b| b.is_ascii_whitespace() || *b == b',').filter(|w| !w.is_empty()).collect();
            if !words.is_empty() {
                return Ok(Line { number: self.number, words });
            }
        }
        Err(AssemblyFault::Short { expected })
    }
}

/// A line of a text.
pub(super) struct Line<'a> {
    pub number: usize,
    pub words: Vec<&'a [u8]>,
}

impl Line<'_> {
    /// The number at a place.
    pub fn number<T: std::str::FromStr>(&self, place: usize, expected: &'static str) -> Result<T, AssemblyFault> {
        let word = self.words.get(place).copied();
        let parsed = word.and_then(|w| std::str::from_utf8(w).ok()).and_then(|w| w.parse().ok());
        parsed.ok_or_else(|| self.fault(expected))
    }

    /// Three coordinates from a place on.
    pub fn point(&self, from: usize) -> Result<[f64; 3], AssemblyFault> {
        let at = |k: usize| self.number(from + k, "three coordinates");
        Ok([at(0)?, at(1)?, at(2)?])
    }

    /// A line that is not what was expected.
    pub fn fault(&self, expected: &'static str) -> AssemblyFault {
        const LONGEST: usize = 40;
        let text: Vec<String> = self.words.iter().take(8).map(|w| String::from_utf8_lossy(w).into_owned()).collect();
        let found = text.join(" ").chars().take(LONGEST).flat_map(char::escape_debug).collect();
        AssemblyFault::Line { line: self.number, expected, found }
    }
}
