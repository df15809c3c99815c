//! Prints the synthetic top shape that ships as `scenarios/shapes/top.obj`:
//! `cargo run --release -p yorp-tiling --example top > scenarios/shapes/top.obj`.

use tiling::obj;
use tiling::top::TopShape;

fn main() -> Result<(), tiling::TilingError> {
    let top = TopShape::new(300.0);
    let mesh = top.mesh(1002)?;
    let centre = mesh.solid().centre_of_mass;
    // Micrometres: shorter to read, far below the facets' size.
    let mesh = mesh.translated(centre.map(|c| -c));
    let rounded = tiling::Mesh {
        vertices: mesh.vertices.iter().map(|v| v.map(|c| (c * 1e6).round() / 1e6)).collect(),
        facets: mesh.facets,
    };
    let TopShape { radius_m, flattening, ridge_height, ridge_width_rad } = top;
    let comment = format!(
        "Synthetic top-shaped asteroid, no measured body. Unit: m. z = spin axis, origin = centre of mass.\n\
         r(latitude) = R (1 - f sin^2(latitude) + h exp(-|latitude| / w)) on 1002 Fibonacci points,\n\
         R = {radius_m} m, f = {flattening}, h = {ridge_height}, w = {ridge_width_rad} rad. Volume {:.6e} m^3.\n\
         Made by: cargo run --release -p yorp-tiling --example top",
        rounded.volume()
    );
    print!("{}", obj::write(&rounded, &comment));
    Ok(())
}
