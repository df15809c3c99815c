//! The two-body path of a sphere that left, as a line to draw.
//!
//! A conic about the body as a point mass: r = p / (1 + e cos f), sampled in equal steps of the true anomaly f. It shows
//! where the sphere is heading; its fate is that of the full integration, where the scene asks for one.

use nalgebra::Vector3;

/// Points on a path.
const POINTS: usize = 48;

/// Points (m) from `position` (m) onwards with `velocity` (m/s) about `gm` (m^3/s^2): until farther than `limit` (m) from
/// the centre, back at less than `inner` (m), or once around.
pub fn two_body_path(gm: f64, [position, velocity]: [[f64; 3]; 2], [inner, limit]: [f64; 2]) -> Vec<[f64; 3]> {
    let (r, v) = (Vector3::from(position), Vector3::from(velocity));
    let h = r.cross(&v);
    // Straight up or down, or no motion at all, there is no plane: the line to the limit.
    if !(gm > 0.0 && h.norm() > 1e-9 * r.norm() * v.norm() && v.norm() > 0.0) {
        let end = if v.norm() > 0.0 { r + v * (limit / v.norm()) } else { r };
        return vec![position, end.into()];
    }
    let eccentricity = v.cross(&h) / gm - r / r.norm();
    let e = eccentricity.norm();
    let parameter = h.norm_squared() / gm;
    // Axes in the plane: to the pericentre (anywhere on a circle), and a quarter turn on.
    let towards = if e > 1e-9 { eccentricity / e } else { r / r.norm() };
    let across = h.cross(&towards) / h.norm();
    let start = r.dot(&across).atan2(r.dot(&towards));
    // A hyperbola ends where 1 + e cos f vanishes.
    let furthest = if e >= 1.0 { (-1.0 / e).acos() } else { start + std::f64::consts::TAU };
    let distance = |f: f64| parameter / (1.0 + e * f.cos());
    let out = |f: f64| distance(f) > limit || (distance(f) < inner && f.sin() < 0.0);
    // Where it first goes beyond a limit, found on a fine grid and then by halving, so that the points are well spread.
    let grid: Vec<f64> = (1..=720).map(|i| start + (furthest - start) * f64::from(i) / 720.0).collect();
    let end = match grid.iter().position(|f| out(*f) || *f >= furthest - 1e-9 && e >= 1.0) {
        None => furthest,
        Some(first) => {
            let (mut low, mut high) = (if first == 0 { start } else { grid[first - 1] }, grid[first]);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if out(middle) { high = middle } else { low = middle }
            }
            low
        }
    };
    let place = |f: f64| (towards * f.cos() + across * f.sin()) * distance(f);
    (0..POINTS).map(|i| place(start + (end - start) * i as f64 / (POINTS - 1) as f64).into()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GM: f64 = 200.0;

    fn norm(p: &[f64; 3]) -> f64 {
        Vector3::from(*p).norm()
    }

    /// Circular speed: a circle, closed.
    #[test]
    fn circular_speed_gives_a_closed_circle() {
        let speed = (GM / 1000.0_f64).sqrt();
        let path = two_body_path(GM, [[0.0, 1000.0, 0.0], [-speed, 0.0, 0.0]], [500.0, 5000.0]);
        assert!(path.iter().all(|p| (norm(p) - 1000.0).abs() < 1e-6 && p[2] == 0.0));
        let gap = Vector3::from(path[0]) - Vector3::from(path[POINTS - 1]);
        assert!(gap.norm() < 1e-6);
    }

    /// Above the escape speed it begins where the sphere is, heads where it moves, and ends at the limit.
    #[test]
    fn escaping_path_starts_along_the_velocity_and_ends_at_the_limit() {
        let (position, velocity) = ([800.0, -300.0, 100.0], [0.4, 0.9, -0.2]);
        let path = two_body_path(GM, [position, velocity], [500.0, 5000.0]);
        assert!((Vector3::from(path[0]) - Vector3::from(position)).norm() < 1e-6);
        let first = Vector3::from(path[1]) - Vector3::from(path[0]);
        let v = Vector3::from(velocity);
        assert!(first.dot(&v) / (first.norm() * v.norm()) > 0.95);
        assert!((norm(&path[POINTS - 1]) / 5000.0 - 1.0).abs() < 1e-6);
    }

    /// Below the circular speed it falls back: the path ends at the inner limit.
    #[test]
    fn falling_path_ends_at_the_body() {
        let speed = 0.6 * (GM / 1000.0_f64).sqrt();
        let path = two_body_path(GM, [[1000.0, 0.0, 0.0], [0.0, speed, 0.0]], [500.0, 5000.0]);
        assert!((norm(&path[POINTS - 1]) / 500.0 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn degenerate_motion_gives_a_finite_line() {
        for velocity in [[0.0; 3], [1.0, 0.0, 0.0]] {
            let path = two_body_path(GM, [[900.0, 0.0, 0.0], velocity], [500.0, 5000.0]);
            assert!(path.len() == 2 && path.iter().flatten().all(|c| c.is_finite()));
        }
    }
}
