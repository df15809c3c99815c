//! Which spheres moved between two configurations of an aggregate, apart from a rigid motion of the whole.
//!
//! Source: Cotto-Figueroa et al. (2015), ApJ 803, 25, section 2.4.2: spheres displaced by more than a quarter of their
//! radius after the best superposition are excluded and the superposition repeated, fitted by Levenberg-Marquardt on
//! three angles and three displacements. Their literal rule flags *every* sphere as soon as a fraction f of the body
//! moves together by D with f D above the threshold, because the first fit is dragged along; the robust rule, the
//! default here, starts from the better half of the spheres and finds exactly the ones that moved. SI units.

mod superpose;

use pkd::rigid_fit::RigidMotion;

pub use crate::scene::MovementRule;
pub use superpose::superposition;

/// Centres as one slice per coordinate, m, each `N` long.
pub type Coordinates<'a> = [&'a [f64]; 3];

/// Fits after which spheres are no longer taken back in, so that the robust rule ends in any case.
const FREE_FITS: usize = 50;

/// What the comparison of two configurations found.
#[derive(Debug, Clone, PartialEq)]
pub struct Movement {
    /// The rigid motion of the spheres that did not move: `after = rotation before + translation`.
    pub motion: RigidMotion,
    /// Whether each sphere moved, `N` long.
    pub moved: Vec<bool>,
    /// Distance of each sphere from where the rigid motion takes it, m, `N` long.
    pub residual_m: Vec<f64>,
    /// Superpositions fitted by the rule in force.
    pub fits: usize,
    /// Number of moved spheres by the robust rule.
    pub robust_count: usize,
    /// Number of moved spheres by the literal rule.
    pub literal_count: usize,
    /// Fewer than three spheres, or only spheres on a line, stayed in place: no frame is left, all count as moved and
    /// the motion is the superposition of all.
    pub fully_rearranged: bool,
}

impl Movement {
    /// Number of spheres that moved by the rule in force.
    pub fn count(&self) -> usize {
        self.moved.iter().filter(|m| **m).count()
    }
}

/// Compares two configurations of the same spheres: a sphere moved if it lies further than `radius_fraction` \[0.25\] of
/// its own radius from where the rigid motion of the unmoved ones takes it.
///
/// # Panics
/// If the arrays differ in length.
///
/// # Examples
/// ```
/// use yorp::evolve::movement::{MovementRule, detect_movement};
/// let x = [0.0, 10.0, 0.0, 0.0, 10.0];
/// let y = [0.0, 0.0, 10.0, 0.0, 10.0];
/// let z = [0.0, 0.0, 0.0, 10.0, 0.0];
/// let shifted: Vec<f64> = z.iter().map(|z| z + 3.0).collect();
/// let mut lifted = shifted.clone();
/// lifted[3] += 2.0;
/// let radius = [5.0; 5];
/// let found = detect_movement([&x, &y, &z], [&x, &y, &lifted], &radius, 0.25, MovementRule::Robust);
/// assert_eq!(found.moved, [false, false, false, true, false]);
/// ```
pub fn detect_movement(
    before: Coordinates,
    after: Coordinates,
    radius_m: &[f64],
    radius_fraction: f64,
    rule: MovementRule,
) -> Movement {
    let tolerance: Vec<f64> = radius_m.iter().map(|r| radius_fraction * r).collect();
    // Most comparisons find nothing; the first fit is common to both rules and settles those.
    let first = Fitted::new(before, after, &vec![true; radius_m.len()]);
    let robust = exclude(before, after, &tolerance, &first, MovementRule::Robust);
    let literal = exclude(before, after, &tolerance, &first, MovementRule::Literal);
    let (robust_count, literal_count) = (robust.moved(), literal.moved());
    let chosen = match rule {
        MovementRule::Robust => robust,
        MovementRule::Literal => literal,
    };
    Movement {
        motion: chosen.fitted.motion,
        moved: chosen.kept.iter().map(|k| !k).collect(),
        residual_m: chosen.fitted.residual_m,
        fits: chosen.fits,
        robust_count,
        literal_count,
        fully_rearranged: chosen.fully_rearranged,
    }
}

/// A superposition and what it leaves.
#[derive(Debug, Clone)]
struct Fitted {
    motion: RigidMotion,
    residual_m: Vec<f64>,
    /// Whether the points determine the motion.
    determined: bool,
}

impl Fitted {
    fn new(before: Coordinates, after: Coordinates, used: &[bool]) -> Self {
        let (motion, determined) = superposition(before, after, used);
        let mut residual_m = Vec::with_capacity(used.len());
        motion.residuals(before, after, &mut residual_m);
        Self { motion, residual_m, determined }
    }
}

/// End of the iterated exclusion by one rule.
struct Excluded {
    fitted: Fitted,
    kept: Vec<bool>,
    fits: usize,
    fully_rearranged: bool,
}

impl Excluded {
    fn moved(&self) -> usize {
        self.kept.iter().filter(|k| !**k).count()
    }
}

/// Fits and excludes until the set of unmoved spheres no longer changes.
fn exclude(
    before: Coordinates,
    after: Coordinates,
    tolerance_m: &[f64],
    first: &Fitted,
    rule: MovementRule,
) -> Excluded {
    let n = tolerance_m.len();
    let mut fitted = first.clone();
    let mut kept = vec![true; n];
    let mut fits = 1;
    // Residuals count in units of each sphere's own threshold, tau is at least 1 of them.
    let mut tau = f64::INFINITY;
    loop {
        let excess: Vec<f64> = fitted.residual_m.iter().zip(tolerance_m).map(|(e, t)| e / t).collect();
        tau = match rule {
            MovementRule::Robust => tau.min(median(&excess)).max(1.0),
            MovementRule::Literal => 1.0,
        };
        let may_return = rule == MovementRule::Robust && fits < FREE_FITS;
        let next = loop {
            let within = |i: usize| (kept[i] || may_return) && excess[i] <= tau;
            let next: Vec<bool> = (0..n).map(within).collect();
            if next != kept || tau <= 1.0 {
                break next;
            }
            tau = (0.9 * tau).max(1.0);
        };
        if next == kept {
            return Excluded { fitted, kept, fits, fully_rearranged: false };
        }
        let remaining = Fitted::new(before, after, &next);
        fits += 1;
        if !remaining.determined {
            return Excluded { fitted: first.clone(), kept: vec![false; n], fits, fully_rearranged: true };
        }
        (fitted, kept) = (remaining, next);
    }
}

/// Middle value; of an even number the lower middle one, so that half of the spheres lie within it.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
