//! STL files, text or binary: triangles with corners of their own, which are joined where their coordinates are equal.

use tiling::Mesh;

use super::assemble::{Assembly, AssemblyFault, TextLines, welded};

/// Bytes before the triangles of a binary file, and bytes of a triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Whether the length of a file is what the number of triangles in its header says.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    triangle_count(bytes).is_some_and(|n| n > 0 && bytes.len() == HEADER + TRIANGLE * n)
}

fn triangle_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(count) as usize)
}

/// Reads an STL file. Normals are ignored: the order of the corners says what is outside.
///
/// # Errors
/// The line that is not understood, or a coordinate that is not finite.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, AssemblyFault> {
    let corners = if bytes.trim_ascii_start().starts_with(b"solid") && !is_binary(bytes) {
        text_corners(bytes)?
    } else {
        binary_corners(bytes)?
    };
    let facets = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let mesh = Assembly::new(corners)?.finish();
    Ok(welded(&Mesh { facets, ..mesh }))
}

fn text_corners(text: &[u8]) -> Result<Vec<[f64; 3]>, AssemblyFault> {
    let mut lines = TextLines::new(text);
    let mut corners: Vec<[f64; 3]> = Vec::new();
    // Corners of the facet that is being read.
    let mut own = 0;
    while let Ok(line) = lines.next("endsolid") {
        match line.words[0] {
            b"vertex" => {
                corners.push(line.point(1)?);
                own += 1;
            }
            b"endfacet" if own != 3 => return Err(line.fault("three lines `vertex` in a facet")),
            b"endfacet" => own = 0,
            b"solid" | b"facet" | b"outer" | b"endloop" | b"endsolid" => {}
            _ => return Err(line.fault("a statement of STL text")),
        }
    }
    if own != 0 {
        return Err(AssemblyFault::Short { expected: "endfacet" });
    }
    Ok(corners)
}

fn binary_corners(bytes: &[u8]) -> Result<Vec<[f64; 3]>, AssemblyFault> {
    let short = AssemblyFault::Short { expected: "the triangles that the header announces" };
    let count = triangle_count(bytes).ok_or_else(|| short.clone())?;
    let triangles = bytes.get(HEADER..).and_then(|rest| rest.get(..TRIANGLE.checked_mul(count)?)).ok_or(short)?;
    let mut corners = Vec::with_capacity(3 * count);
    for triangle in triangles.chunks_exact(TRIANGLE) {
        let float = |k: usize| {
            let four = [triangle[k], triangle[k + 1], triangle[k + 2], triangle[k + 3]];
            f64::from(f32::from_le_bytes(four))
        };
        // Twelve bytes of normal come first.
        corners.extend([12, 24, 36].map(|k| [float(k), float(k + 4), float(k + 8)]));
    }
    Ok(corners)
}
