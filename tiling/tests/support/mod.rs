//! A compact random packing for tests and benches: spheres pulled to the middle of an ellipsoid, overlaps pushed apart.

/// Centres (m) of `count` spheres of radius `radius` (m), packed about the origin to a body whose axes along x, y, z are in
/// the ratio of `axes`. Remaining overlaps are below a thousandth of the radius.
pub fn packing(count: usize, radius: f64, axes: [f64; 3]) -> [Vec<f64>; 3] {
    let mut state = 1u64;
    let mut uniform = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    // Twice the volume of a random close packing to begin with.
    let mean_axis = axes.iter().product::<f64>().cbrt();
    let extent = axes.map(|a| a / mean_axis * radius * (count as f64 / 0.3).cbrt());
    let mut points: Vec<[f64; 3]> = Vec::new();
    while points.len() < count {
        let u = [uniform(), uniform(), uniform()];
        if u.iter().map(|c| c * c).sum::<f64>() < 1.0 {
            points.push([0, 1, 2].map(|k| u[k] * extent[k]));
        }
    }
    let steps = 600;
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for step in 0..steps {
        let pull = 0.02 * (1.0 - f64::from(step) / f64::from(steps)).powi(2);
        for p in &mut points {
            *p = [0, 1, 2].map(|k| p[k] * (1.0 - pull * (mean_axis / axes[k]).powi(2)));
        }
        let apart = |points: &[[f64; 3]], i: usize, j: usize| [0, 1, 2].map(|k| points[i][k] - points[j][k]);
        let square = |d: [f64; 3]| d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if step % 10 == 0 {
            // Nobody comes nearer by a whole radius within ten steps.
            let near = |i: usize, j: usize| square(apart(&points, i, j)) < 9.0 * radius * radius;
            pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j))).filter(|(i, j)| near(*i, *j)).collect();
        }
        for &(i, j) in &pairs {
            let d = apart(&points, i, j);
            if square(d) < 4.0 * radius * radius {
                let push = 0.5 * (2.0 * radius / square(d).sqrt() - 1.0);
                for k in 0..3 {
                    points[i][k] += push * d[k];
                    points[j][k] -= push * d[k];
                }
            }
        }
    }
    [0, 1, 2].map(|k| points.iter().map(|p| p[k]).collect())
}
