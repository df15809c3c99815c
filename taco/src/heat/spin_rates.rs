//! Spin rates at which torques with heat are tabulated.

/// Thermal parameter beyond which nodes spread in proportion to it; the torque turns over at about 1.
const TURN: f64 = 0.7;

/// `nodes` (at least 2) spin rates from 0 to `max_rad_s`, both included, on which torques are smooth: evenly spaced in
/// `ln(1 + Theta / 0.7)`, `Theta ~ sqrt(omega)` the thermal parameter, `theta_at_max` at the last.
///
/// At the spin rate 0 the torque is that of a body that stores no heat.
pub(crate) fn graded(max_rad_s: f64, theta_at_max: f64, nodes: usize) -> Vec<f64> {
    let largest = theta_at_max / TURN;
    let node = |k: usize| {
        // expm1 and ln_1p: evenly spaced in sqrt(omega) in the limit of weak heat.
        let share = k as f64 / (nodes - 1) as f64;
        let root = (share * largest.ln_1p()).exp_m1() / largest;
        max_rad_s * root * root
    };
    (0..nodes).map(|k| if k + 1 == nodes { max_rad_s } else { node(k) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_ascends_from_zero_and_is_even_in_the_root_for_weak_heat() {
        for theta in [1e-9, 0.5, 20.0, 1e3] {
            let grid = graded(1e-3, theta, 9);
            assert_eq!((grid[0], grid[8]), (0.0, 1e-3));
            assert!(grid.windows(2).all(|w| w[0] < w[1]), "{grid:?}");
        }
        assert!((graded(1e-3, 1e-9, 9)[4] - 0.25e-3).abs() < 1e-9);
    }
}
