//! Bodies and rays for the tests of this crate.

use tiling::Mesh;

/// Closed box between two corners.
pub(crate) fn cuboid(mesh: &mut Mesh, low: [f64; 3], high: [f64; 3]) {
    let first = mesh.vertices.len() as u32;
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { low[k] } else { high[k] });
    mesh.vertices.extend((0..8).map(corner));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
    mesh.facets.extend(triangles.map(|t| t.map(|v| v + first)));
}

/// A sphere with hills and valleys and a slab that hovers over its top.
pub(crate) fn rugged(vertices: usize) -> Mesh {
    let mut mesh = tiling::fibonacci::unit_sphere(vertices).unwrap();
    for v in &mut mesh.vertices {
        let r = 1.0 + 0.15 * (5.0 * v[0]).sin() * (6.0 * v[1]).cos() + 0.1 * (9.0 * v[2]).sin();
        *v = v.map(|c| c * r);
    }
    cuboid(&mut mesh, [-0.4, -0.5, 1.5], [0.4, 0.5, 1.6]);
    mesh
}

/// Whether a ray from `point` towards `direction` meets a facet other than `own`.
pub(crate) fn blocked(mesh: &Mesh, point: [f64; 3], direction: [f64; 3], own: usize) -> bool {
    first_hit(mesh, point, direction, own).is_some()
}

/// The facet other than `own` that a ray from `point` towards `direction` meets first.
pub(crate) fn first_hit(mesh: &Mesh, point: [f64; 3], direction: [f64; 3], own: usize) -> Option<usize> {
    let (p, d) = (nalgebra::Vector3::from(point), nalgebra::Vector3::from(direction));
    let distance = |f: usize| {
        let [a, b, c] = mesh.corners(f);
        let (e1, e2, t) = (b - a, c - a, p - a);
        let (q, r) = (d.cross(&e2), t.cross(&e1));
        let det = e1.dot(&q);
        let (u, v, along) = (t.dot(&q) / det, d.dot(&r) / det, e2.dot(&r) / det);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && along > 0.0).then_some((along, f))
    };
    let hits = (0..mesh.facets.len()).filter(|f| *f != own).filter_map(distance);
    hits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, f)| f)
}
