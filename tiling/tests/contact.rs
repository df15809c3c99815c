//! Self-contact of random surfaces: found wherever a vertex has been pulled through the body, nowhere else.

use proptest::prelude::*;
use tiling::{Mesh, TilingError};

/// A star-shaped body with hills: no two of its facets can meet.
fn hills(vertices: usize, waves: [f64; 3], height: f64) -> Mesh {
    let mut mesh = tiling::fibonacci::unit_sphere(vertices).expect("enough vertices");
    for v in &mut mesh.vertices {
        let r = 1.0 + height * (waves[0] * v[0]).sin() * (waves[1] * v[1]).cos() * (waves[2] * v[2] + 1.0).sin();
        *v = v.map(|c| 300.0 * r * c);
    }
    mesh
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_star_shaped_bodies_do_not_touch_themselves(
        vertices in 4usize..600, waves in prop::array::uniform3(0.0f64..12.0), height in 0.0f64..0.9,
    ) {
        let mesh = hills(vertices, waves, height);
        prop_assert_eq!(mesh.check_contact(), Ok(()));
    }

    #[test]
    fn prop_spike_through_the_body_is_found_where_it_comes_out(
        vertices in 50usize..400, waves in prop::array::uniform3(0.0f64..6.0), picked in any::<prop::sample::Index>(),
    ) {
        let mut mesh = hills(vertices, waves, 0.2);
        let spike = picked.index(vertices);
        mesh.vertices[spike] = mesh.vertices[spike].map(|c| -2.0 * c);
        match mesh.check_contact() {
            Err(TilingError::SelfContact { facets, .. }) => {
                let of_spike = |f: &usize| mesh.facets[*f].contains(&(spike as u32));
                prop_assert!(facets.iter().any(of_spike) && !facets.iter().all(of_spike), "{:?}", facets);
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }
}
