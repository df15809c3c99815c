//! The body through time for ParaView: spheres and tiling of each configuration as `.vtp`, and a `.pvd` for each of the two
//! that gives the files their times in Myr.
//!
//! All in the original frame, so that what has not moved stands still from file to file.

use std::fmt::Write as _;

use crate::evolve::driver::MYR_S;
use crate::exchange::vtk::{PointArray, mesh_vtp, points_vtp};
use crate::report::RunData;
use crate::store::ConfigurationRecord;
use tiling::Mesh;

/// Spheres of a configuration as points with radius, mass, number and displacement in the movement that made it.
pub fn spheres(run: &RunData, c: &ConfigurationRecord) -> Vec<u8> {
    let of = |table: &[f64]| c.sphere_ids.iter().map(|s| table[*s as usize]).collect();
    let mut displacement = vec![0.0; c.sphere_ids.len()];
    for movement in run.movements.get(c.configuration as usize).into_iter().flatten() {
        if let Ok(row) = c.sphere_ids.binary_search(&movement.sphere) {
            displacement[row] = movement.displacement_m;
        }
    }
    let arrays = [
        PointArray::Numbers("radius_m", of(&run.sphere_radius_m)),
        PointArray::Numbers("mass_kg", of(&run.sphere_mass_kg)),
        PointArray::Numbers("displacement_m", displacement),
        PointArray::Whole("sphere", c.sphere_ids.iter().map(|s| i64::from(*s)).collect()),
    ];
    points_vtp(&c.positions, &arrays)
}

/// The tiling of a configuration.
pub fn tiling(run: &RunData, c: &ConfigurationRecord) -> Vec<u8> {
    let facets = run.tiling.as_ref().map_or(Vec::new(), |t| t.facets.clone());
    mesh_vtp(&Mesh { vertices: c.vertices.clone(), facets })
}

/// Times (Myr) of the files `name` makes of the configurations' numbers.
pub fn collection(run: &RunData, name: impl Fn(u32) -> String) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n".to_owned();
    for c in &run.configurations {
        let (time, file) = (c.t_s / MYR_S, name(c.configuration));
        writeln!(text, "<DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>")
            .expect("writing to a string cannot fail");
    }
    text + "</Collection>\n</VTKFile>\n"
}
