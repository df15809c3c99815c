//! Tables of numbers: vertices and plates as the Planetary Data System and DAMIT have them, and ICQ (implicitly connected
//! quadrilaterals, Gaskell's format).
//!
//! Vertices and plates: either one line with both counts, or each count before its rows. Rows have three numbers, or four,
//! the first of which is the row's own number. ICQ: a line with `q`, then the `6 (q + 1)^2` vertices of the faces of a cube,
//! whose shared edges are there twice with equal coordinates.

use tiling::Mesh;

use super::assemble::{Assembly, AssemblyFault, Line, TextLines, welded};

/// Reads a table of vertices and plates, or an ICQ file.
///
/// # Errors
/// The line that is not understood.
pub(super) fn read(text: &[u8]) -> Result<Mesh, AssemblyFault> {
    let counts_are = "the number of vertices, or of vertices and plates, or the q of an ICQ file";
    let mut lines = TextLines::new(text);
    let counts = lines.next(counts_are)?;
    let first: usize = counts.number(0, counts_are)?;
    let mut rows = Vec::new();
    while let Ok(line) = lines.next("a row") {
        rows.push(line);
    }
    match counts.words.len() {
        2 => plates(&rows, first, Some(counts.number(1, counts_are)?)),
        1 if icq_vertices(first) == Some(rows.len()) => icq(&rows, first),
        1 => plates(&rows, first, None),
        _ => Err(counts.fault(counts_are)),
    }
}

/// Where the three numbers of a row begin: it may carry its own number.
fn offset(row: &Line, expected: &'static str) -> Result<usize, AssemblyFault> {
    match row.words.len() {
        3 => Ok(0),
        4 => Ok(1),
        _ => Err(row.fault(expected)),
    }
}

fn plates(rows: &[Line], vertices: usize, plates: Option<usize>) -> Result<Mesh, AssemblyFault> {
    let vertex = "a vertex: three coordinates, its own number before them or not";
    let plate = "a plate: three vertices, its own number before them or not";
    let short = |expected| AssemblyFault::Short { expected };
    let (points, rest) = rows.split_at_checked(vertices).ok_or(short("a vertex"))?;
    let points = points.iter().map(|row| row.point(offset(row, vertex)?)).collect::<Result<Vec<_>, _>>()?;
    let (plates, rest) = match (plates, rest) {
        (Some(plates), rest) => (plates, rest),
        (None, [count, rest @ ..]) => (count.number(0, "the number of plates")?, rest),
        (None, []) => return Err(short("the number of plates")),
    };
    let rest = rest.get(..plates).ok_or(short("a plate"))?;
    let mut corners = Vec::with_capacity(rest.len());
    for row in rest {
        let from = offset(row, plate)?;
        let at = |k: usize| row.number::<i64>(from + k, plate);
        corners.push([at(0)?, at(1)?, at(2)?]);
    }
    // Most count from 1; a zero says otherwise.
    let first = if corners.iter().flatten().any(|v| *v == 0) { 0 } else { 1 };
    let mut mesh = Assembly::new(points)?;
    for plate in &corners {
        mesh.polygon(plate, first)?;
    }
    Ok(mesh.finish())
}

fn icq_vertices(q: usize) -> Option<usize> {
    q.checked_add(1)?.checked_pow(2)?.checked_mul(6).filter(|_| q > 0)
}

fn icq(rows: &[Line], q: usize) -> Result<Mesh, AssemblyFault> {
    let points = rows.iter().map(|row| row.point(0)).collect::<Result<Vec<_>, _>>()?;
    let at = |face: usize, j: usize, i: usize| ((face * (q + 1) + j) * (q + 1) + i) as i64;
    let mut mesh = Assembly::new(points)?;
    for face in 0..6 {
        for j in 0..q {
            for i in 0..q {
                mesh.polygon(&[at(face, j, i), at(face, j, i + 1), at(face, j + 1, i + 1), at(face, j + 1, i)], 0)?;
            }
        }
    }
    let mut mesh = welded(&mesh.finish());
    // The faces of the cube are numbered in a left-handed or a right-handed way.
    if mesh.volume() < 0.0 {
        mesh.facets.iter_mut().for_each(|f| f.swap(1, 2));
    }
    Ok(mesh)
}
