//! Meshes for the tests.
#![allow(dead_code)]

use std::f64::consts::{PI, TAU};
use taco::{Obliquities, Orbit, Reflectance, Sampling, Surface, TorqueTable, torque_table_of_facets};
use tiling::Mesh;

/// Body of longitude-latitude rings: `radius(longitude, latitude)` along each direction, then stretched. Symmetric about
/// the three coordinate planes to the last bit wherever `radius` is.
pub fn rings(rows: usize, columns: usize, axes: [f64; 3], radius: impl Fn(f64, f64) -> f64) -> Mesh {
    assert!(rows.is_multiple_of(2) && columns.is_multiple_of(4));
    let mut vertices = vec![[0.0, 0.0, axes[2] * radius(0.0, PI / 2.0)], [0.0, 0.0, -axes[2] * radius(0.0, -PI / 2.0)]];
    for i in 1..rows {
        for j in 0..columns {
            let (latitude, longitude) = (PI / 2.0 - PI * i as f64 / rows as f64, TAU * j as f64 / columns as f64);
            // Folded into the first octant, so that mirror images are exact.
            let fold = |k: usize, quarter: usize| match k / quarter {
                0 => (k, 1.0, 1.0),
                1 => (2 * quarter - k, -1.0, 1.0),
                2 => (k - 2 * quarter, -1.0, -1.0),
                _ => (4 * quarter - k, 1.0, -1.0),
            };
            let (jf, sx, sy) = fold(j, columns / 4);
            let (sin_lon, cos_lon) = (TAU * jf as f64 / columns as f64).sin_cos();
            let north = if 2 * i <= rows { 1.0 } else { -1.0 };
            let up = PI / 2.0 - PI * i.min(rows - i) as f64 / rows as f64;
            let (sin_lat, cos_lat) = if 2 * i == rows { (0.0, 1.0) } else { up.sin_cos() };
            let r = radius(longitude, latitude);
            let x = if jf * 4 == columns { 0.0 } else { cos_lat * cos_lon };
            let y = if jf == 0 { 0.0 } else { cos_lat * sin_lon };
            vertices.push([axes[0] * r * sx * x, axes[1] * r * sy * y, axes[2] * r * north * sin_lat]);
        }
    }
    let at = |i: usize, j: usize| (2 + (i - 1) * columns + j % columns) as u32;
    let mut facets = Vec::new();
    for j in 0..columns {
        facets.push([0, at(1, j), at(1, j + 1)]);
        facets.push([1, at(rows - 1, j + 1), at(rows - 1, j)]);
        for i in 1..rows - 1 {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            // The diagonals of the octants are mirror images of each other as well.
            let flip = (2 * i < rows) ^ (4 * j / columns).is_multiple_of(2);
            facets.extend(if flip { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    Mesh { vertices, facets }
}

/// A body without symmetry, with bays that shade one another: a stretched Fibonacci sphere with waves, about 1 m across,
/// its centre of mass at the origin.
pub fn bumpy(vertices: usize) -> Mesh {
    let mut mesh = tiling::fibonacci::unit_sphere(vertices).expect("enough vertices");
    for v in &mut mesh.vertices {
        let [x, y, z] = *v;
        let r = 1.0
            + 0.10 * (3.0 * x + 1.0).sin() * (4.0 * y).cos()
            + 0.08 * (5.0 * z + 2.0 * x).sin()
            + 0.06 * (7.0 * x * y).sin();
        *v = [1.2 * r * x, r * y, 0.85 * r * z];
    }
    centred(mesh)
}

/// The mesh with its centre of mass at the origin.
pub fn centred(mesh: Mesh) -> Mesh {
    let centre = mesh.solid().centre_of_mass;
    mesh.translated(centre.map(|c| -c))
}

/// The 37-obliquity table at 1 au with default sampling.
pub fn table(mesh: &Mesh, surface: &Surface) -> TorqueTable {
    torque_table_of_facets(mesh, surface, &Orbit::default(), &Sampling::default()).expect("a valid mesh")
}

/// Lambert scattering, no sky blockage.
pub fn lambert(bond_albedo: f64) -> Surface {
    Surface { reflectance: Reflectance::Lambert { bond_albedo }, sky_blockage: false, ..Surface::default() }
}

/// Sampling at these obliquities.
pub fn at_obliquities(degrees: &[f64]) -> Sampling {
    Sampling { obliquities: Obliquities::ListDeg(degrees.to_vec()), ..Sampling::default() }
}

/// Largest absolute value.
pub fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Largest difference.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Distances of the spin and of the obliquity torque between two tables, over the larger of the first one's peaks.
pub fn off(a: &TorqueTable, b: &TorqueTable) -> f64 {
    let (spin, tilt) = (&a.spin_torque_n_m[0], &a.obliquity_torque_n_m[0]);
    let worst = distance(spin, &b.spin_torque_n_m[0]).max(distance(tilt, &b.obliquity_torque_n_m[0]));
    worst / peak(spin).max(peak(tilt))
}
