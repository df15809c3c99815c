//! Time to follow a hundred spheres that leave the ends of an elongated body of a thousand, for a year or to their end.
//!
//! `cargo bench --bench shed`.

use std::f64::consts::TAU;

use divan::Bencher;
use pkd::Spheres;
use yorp::shed::{Primary, ShedBody, TrackOptions, follow};

fn main() {
    divan::main();
}

/// A prolate pile of `n` spheres, 750 m long, on nested shells, turning once in 4.3 h.
fn prolate(n: usize) -> Primary {
    let mut spheres = Spheres::default();
    for k in 0..n {
        let z = 1.0 - 2.0 * ((k as f64 * 0.754_877_666) % 1.0);
        let azimuth = TAU * ((k as f64 * 0.569_840_29) % 1.0);
        let (r, level) = (((k as f64 + 0.5) / n as f64).cbrt(), (1.0 - z * z).sqrt());
        let at = [750.0 * r * level * azimuth.cos(), 350.0 * r * level * azimuth.sin(), 350.0 * r * z];
        spheres.push(at, [0.0; 3], [0.0; 3], 1.5685e12 / n as f64, 45.0);
    }
    Primary { spheres, spin_rate: TAU / (4.3 * 3600.0) }
}

/// Lifted off near both ends with up to a tenth more than the speed of the surface.
fn lifted(count: usize, spin_rate: f64) -> Vec<ShedBody> {
    let lift = |k: usize| {
        let share = k as f64 / count as f64;
        let side = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let (sin, cos) = (0.3 * (share - 0.5)).sin_cos();
        let r = 810.0 + 60.0 * ((k * 7 % 13) as f64 / 13.0);
        let speed = side * spin_rate * r * (1.0 + 0.1 * ((k * 5 % 11) as f64 / 11.0));
        ShedBody {
            position: [side * r * cos, side * r * sin, 12.0 * (k as f64 - 50.0) + 60.0 * (share - 0.5)],
            velocity: [-speed * sin, speed * cos, 0.01 * (share - 0.5)],
            spin: [0.0; 3],
            mass: 1e6,
            radius: 5.0,
        }
    };
    (0..count).map(lift).collect()
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn a_hundred_spheres_for_a_year(bencher: Bencher) {
    let primary = prolate(1000);
    let shed = lifted(100, primary.spin_rate);
    bencher.bench(|| follow(&primary, &shed, &TrackOptions::default()));
}
