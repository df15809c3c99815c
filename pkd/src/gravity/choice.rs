//! The fastest way to gravity of a given accuracy.

use super::{Accelerations, DirectGravity, TreeGravity};
use crate::PkdError;

/// Method of summing gravity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GravityMethod {
    /// The direct sum for small bodies, the tree for large ones, whichever was measured to be faster (default).
    #[default]
    Auto,
    /// Every pair, exact to round-off.
    Direct,
    /// The tree, whatever the size.
    Tree,
}

/// How gravity is summed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GravityOptions {
    /// The method \[auto\].
    pub method: GravityMethod,
    /// Error that the tree may make, > 0 \[1e-3, enough for contacts; spin limits want 1e-4\]: rms of the error of the
    /// acceleration over its rms, over all spheres. The direct sum makes none. A tenth of it about doubles the cost.
    pub force_error: f64,
}

impl Default for GravityOptions {
    fn default() -> Self {
        Self { method: GravityMethod::Auto, force_error: 1e-3 }
    }
}

impl GravityOptions {
    /// For energies and other things that are computed once and compared.
    pub(crate) const PRECISE: Self = Self { method: GravityMethod::Auto, force_error: 1e-6 };

    /// Checks the values against their ranges.
    ///
    /// # Errors
    /// [`PkdError::BadParameter`] for an error that is not above 0 and finite.
    pub fn validate(&self) -> Result<(), PkdError> {
        if self.force_error > 0.0 && self.force_error.is_finite() {
            Ok(())
        } else {
            Err(PkdError::BadParameter { name: "force_error", value: self.force_error, allowed: "more than 0" })
        }
    }

    /// Whether the direct sum is used for `count` spheres.
    pub fn is_direct(&self, count: usize) -> bool {
        match self.method {
            GravityMethod::Auto => count < crossover(self.force_error),
            GravityMethod::Direct => true,
            GravityMethod::Tree => false,
        }
    }
}

/// Number of spheres from which the tree is faster, measured on one thread.
fn crossover(force_error: f64) -> usize {
    match force_error {
        error if error >= 1e-3 => 2000,
        error if error >= 1e-4 => 4000,
        error if error >= 1e-6 => 10_000,
        _ => 40_000,
    }
}

/// Gravity with its scratch memory; holds no state, a new one gives the same bytes.
///
/// # Examples
/// ```
/// use pkd::gravity::{Accelerations, Gravity, GravityOptions};
/// let mut out = Accelerations::default();
/// let mut gravity = Gravity::new(GravityOptions::default());
/// gravity.accelerations(&[0.0, 1000.0], &[0.0; 2], &[0.0; 2], &[1e12, 1e12], &mut out);
/// assert!((out.x[0] - 6.6743e-5).abs() < 1e-12 && out.x[1] == -out.x[0]);
/// assert_eq!(gravity.last_error_estimate(), 0.0);
/// ```
#[derive(Debug)]
pub struct Gravity {
    options: GravityOptions,
    direct: DirectGravity,
    tree: TreeGravity,
    error: f64,
}

impl Default for Gravity {
    fn default() -> Self {
        Self::new(GravityOptions::default())
    }
}

impl Gravity {
    /// Gravity as `options` want it; an invalid error is treated as none allowed.
    pub fn new(options: GravityOptions) -> Self {
        Self { options, direct: DirectGravity::default(), tree: TreeGravity::new(options.force_error), error: 0.0 }
    }

    /// The options.
    pub fn options(&self) -> GravityOptions {
        self.options
    }

    /// Accelerations (m/s²) of spheres at `x`, `y`, `z` (m) with `mass` (kg), written to `out`.
    ///
    /// Runs on the threads of the current `rayon` pool; the bytes do not depend on their number.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn accelerations(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Accelerations) {
        if self.options.is_direct(mass.len()) {
            self.direct.accelerations(x, y, z, mass, out);
            self.error = 0.0;
        } else {
            self.tree.accelerations(x, y, z, mass, out);
            self.error = self.tree.last_error_estimate();
        }
    }

    /// Potential at each centre due to all other spheres, m²/s², negative, written to `out`.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn potentials(&mut self, x: &[f64], y: &[f64], z: &[f64], mass: &[f64], out: &mut Vec<f64>) {
        if self.options.is_direct(mass.len()) {
            self.direct.potentials(x, y, z, mass, out);
            self.error = 0.0;
        } else {
            self.tree.potentials(x, y, z, mass, out);
            self.error = self.tree.last_error_estimate();
        }
    }

    /// Error of the last result: 0 from the direct sum, else [`TreeGravity::last_error_estimate`].
    pub fn last_error_estimate(&self) -> f64 {
        self.error
    }
}
