//! OFF files of Geomview, as text: counts, vertices, polygons.

use tiling::Mesh;

use super::assemble::{Assembly, AssemblyFault, TextLines};

/// Whether a word is the header of an OFF file, with colours, normals or texture coordinates or without.
pub(super) fn is_header(word: &[u8]) -> bool {
    word.ends_with(b"OFF") && word.len() <= 6
}

/// Reads the text of an OFF file.
///
/// # Errors
/// The line that is not understood.
pub(super) fn read(text: &[u8]) -> Result<Mesh, AssemblyFault> {
    let mut lines = TextLines::new(text);
    let mut counts = lines.next("the header OFF")?;
    let header = counts.words[0];
    if !is_header(header) {
        return Err(counts.fault("the header OFF"));
    }
    if header.contains(&b'4') || header.contains(&b'n') {
        return Err(AssemblyFault::Variant("an OFF file of more than three dimensions"));
    }
    counts.words.remove(0);
    if counts.words.first().is_some_and(|word| word.eq_ignore_ascii_case(b"binary")) {
        return Err(AssemblyFault::Variant("a binary OFF file"));
    }
    if counts.words.is_empty() {
        counts = lines.next("the numbers of vertices and facets")?;
    }
    let count = |place| counts.number::<usize>(place, "the numbers of vertices and facets");
    let (vertex_count, facet_count) = (count(0)?, count(1)?);
    // Nothing is reserved: the counts are only what the file claims.
    let mut vertices = Vec::new();
    for _ in 0..vertex_count {
        vertices.push(lines.next("a vertex")?.point(0)?);
    }
    let mut mesh = Assembly::new(vertices)?;
    let mut corners = Vec::new();
    for _ in 0..facet_count {
        let line = lines.next("a facet")?;
        let expected = "a facet: the number of its corners and the corners, from 0";
        let n: usize = line.number(0, expected)?;
        corners.clear();
        for place in 1..=n.min(line.words.len()) {
            corners.push(line.number(place, expected)?);
        }
        if corners.len() != n {
            return Err(line.fault(expected));
        }
        mesh.polygon(&corners, 0)?;
    }
    Ok(mesh.finish())
}
