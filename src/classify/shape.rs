//! How the body's proportions change, in the plane of triaxiality and c/a.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 3.4 and Figure 16. The paper does not define its axes; its
//! Table 1 fits half extents (B2) best, which a single sphere at a tip can change, so that the dynamically equivalent
//! ellipsoid (B1) stands beside them.

use super::sequences::{JacobiSequence, triaxiality};
use crate::evolve::driver::MYR_S;
use crate::store::ConfigurationRecord;

/// Axis ratios of a body.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Proportions {
    /// Middle over long axis.
    pub b_over_a: f64,
    /// Short over long axis.
    pub c_over_a: f64,
    /// Triaxiality; `None` of a sphere.
    pub triaxiality: Option<f64>,
}

impl Proportions {
    /// Of three axes, long to short.
    pub fn new([a, b, c]: [f64; 3]) -> Self {
        let (b_over_a, c_over_a) = (b / a, c / a);
        Self { b_over_a, c_over_a, triaxiality: triaxiality(b_over_a, c_over_a) }
    }

    /// By the half extents (B2).
    pub fn of_half_extents(configuration: &ConfigurationRecord) -> Self {
        Self::new(configuration.b2_axes_m)
    }

    /// By the dynamically equivalent ellipsoid (B1).
    pub fn of_equivalent_ellipsoid(configuration: &ConfigurationRecord) -> Self {
        Self::new(configuration.b1_axes_m)
    }
}

/// The body at one time.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ShapeState {
    /// When this shape came about, Myr.
    pub t_myr: f64,
    /// By the half extents (B2).
    pub half_extents: Proportions,
    /// By the dynamically equivalent ellipsoid (B1).
    pub equivalent_ellipsoid: Proportions,
    /// c/a (B2) over that of the Jacobi ellipsoid of the same triaxiality: below 1 the body is below the sequence;
    /// `None` of a sphere.
    pub over_jacobi: Option<f64>,
    /// Bulk density by the hull of the spheres (B3), kg/m^3.
    pub density_kg_m3: f64,
}

/// How the body's shape evolved.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ShapeHistory {
    /// Object 0; `None` before it exists.
    pub start: Option<ShapeState>,
    /// The present shape.
    pub end: Option<ShapeState>,
    /// Smallest c/a (B2) over that of the Jacobi ellipsoid of the same triaxiality of all shapes.
    pub lowest_over_jacobi: Option<f64>,
}

impl ShapeHistory {
    /// Of a run's configurations in order of time.
    pub fn of(configurations: &[ConfigurationRecord], jacobi: &JacobiSequence) -> Self {
        let over_jacobi = |p: Proportions| p.triaxiality.map(|t| p.c_over_a / jacobi.c_over_a(t));
        let state = |c: &ConfigurationRecord| ShapeState {
            t_myr: c.t_s / MYR_S,
            half_extents: Proportions::of_half_extents(c),
            equivalent_ellipsoid: Proportions::of_equivalent_ellipsoid(c),
            over_jacobi: over_jacobi(Proportions::of_half_extents(c)),
            density_kg_m3: c.densities_kg_m3[2],
        };
        let all = configurations.iter().filter_map(|c| over_jacobi(Proportions::of_half_extents(c)));
        Self {
            start: configurations.first().map(state),
            end: configurations.last().map(state),
            lowest_over_jacobi: all.min_by(f64::total_cmp),
        }
    }
}
