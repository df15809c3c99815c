//! Tangential YORP: the eastward push of stones whose west sides are warmer than their east sides (Golubov & Krugly 2012,
//! ApJ 752, L11), by a model of walls.
//!
//! A wall runs north-south on level ground: a slab of thickness `L` with an east and a west face, which conduct heat to each
//! other but not to the ground and see the Sun while it is above the local horizon. Split into the faces' mean and half their
//! difference, the slab takes up the harmonics `Gamma sqrt(i n omega) tanh z` and `coth z`, `z = sqrt(i n) l / 2`, with
//! `l = Gamma sqrt(omega) L / kappa` the thickness over the thermal length; a steady difference drives `kappa / L`. Both
//! faces receive the same, but emission grows with the fourth power of temperature: the face that meets the afternoon emits
//! more on average, and its recoil pushes eastwards, on either sense of rotation.
//!
//! The pressure is that on one wall of unit area. How much wall stands on a unit of ground is the caller's; the published
//! fits of the size distribution are not built in.

use crate::arc::half_day;
use crate::declination::Declinations;
use crate::facets::Facet;
use crate::heat::balance::{Balance, Conductor};
use crate::heat::cubic_weights;
use crate::heat::filter::{Filter, divide_by, half_derivative};
use crate::heat::insolation::Cells;
use crate::recoil::RecoilKernel;
use crate::surface::Wall;
use rayon::prelude::*;
use realfft::num_complex::Complex;
use std::f64::consts::{FRAC_PI_2, PI};

/// Root mean square of what is left of the energy balance; the pressure is of the order of a hundredth of the flux.
const TOLERANCE: f64 = 1e-6;
/// Latitudes of the table, from pole to pole.
const LATITUDES: usize = 37;

/// Eastward pressure on the walls at every latitude and declination.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Walls {
    /// Per unit pressure of the beam, `[latitude][declination]`.
    pressure: Vec<Vec<f64>>,
}

/// The slab as a [`Conductor`]: east face, then west face.
struct Slab {
    filter: Filter,
    cells: usize,
    admittance: [Vec<Complex<f64>>; 2],
    divisor: [Vec<Complex<f64>>; 2],
    part: [Vec<f64>; 2],
}

impl Slab {
    /// For a thickness of `lengths` thermal lengths.
    fn new(cells: usize, lengths: f64) -> Self {
        let root = half_derivative(cells);
        let len = cells as f64;
        let mut even = root.clone();
        let mut odd = root;
        for (n, (even, odd)) in even.iter_mut().zip(&mut odd).enumerate().skip(1) {
            let root = Complex::from_polar((n as f64).sqrt(), 0.25 * PI);
            // tanh z of a positive real part, without overflow.
            let shrunk = (-lengths * root).exp();
            let tanh = (1.0 - shrunk) / (1.0 + shrunk);
            *even = root * tanh / len;
            *odd = root / tanh / len;
            if 2 * n == cells {
                (even.im, odd.im) = (0.0, 0.0);
            }
        }
        odd[0] = Complex::new(2.0 / lengths / len, 0.0);
        let part = [vec![0.0; cells], vec![0.0; cells]];
        Self { filter: Filter::new(cells), cells, divisor: [even.clone(), odd.clone()], admittance: [even, odd], part }
    }

    fn apply<const DIVIDE: bool>(&mut self, x: &[f64], out: &mut [f64]) {
        let (east, west) = x.split_at(self.cells);
        let factors = if DIVIDE { &self.divisor } else { &self.admittance };
        let both = || east.iter().zip(west);
        self.filter.apply(both().map(|(e, w)| 0.5 * (e + w)), &factors[0], &mut self.part[0]);
        self.filter.apply(both().map(|(e, w)| 0.5 * (e - w)), &factors[1], &mut self.part[1]);
        let (east, west) = out.split_at_mut(self.cells);
        for (k, (east, west)) in east.iter_mut().zip(west).enumerate() {
            (*east, *west) = (self.part[0][k] + self.part[1][k], self.part[0][k] - self.part[1][k]);
        }
    }
}

impl Conductor for Slab {
    fn conduct(&mut self, x: &[f64], out: &mut [f64]) {
        self.apply::<false>(x, out);
    }

    fn prepare(&mut self, c: f64, theta: f64) {
        for (admittance, divisor) in self.admittance.iter().zip(&mut self.divisor) {
            divide_by(c, theta, admittance, divisor);
        }
    }

    fn divide(&mut self, x: &[f64], out: &mut [f64]) {
        self.apply::<true>(x, out);
    }
}

/// Solves for the two faces of a wall; one per thread.
struct Worker {
    slab: Slab,
    balance: Balance,
    east: Cells,
    west: Cells,
    sunlight: Vec<f64>,
    unused: Vec<f64>,
    temperature: Vec<f64>,
    flux: Vec<f64>,
}

impl Worker {
    fn new(cells: usize, lengths: f64) -> Self {
        let zero = || vec![0.0; 2 * cells];
        Self {
            slab: Slab::new(cells, lengths),
            balance: Balance::new(2 * cells),
            // The cosine of incidence on the east face, cos dec sin H, is largest a quarter turn from the meridian.
            east: Cells::starting_at(cells, PI - FRAC_PI_2),
            west: Cells::starting_at(cells, PI + FRAC_PI_2),
            sunlight: zero(),
            unused: zero(),
            temperature: zero(),
            flux: zero(),
        }
    }

    /// Eastward pressure per pressure of the beam, given `(sin, cos)` of latitude and declination.
    fn pressure<K: RecoilKernel>(&mut self, kernel: &K, theta: f64, lat: (f64, f64), dec: (f64, f64)) -> f64 {
        let Self { slab, balance, east, west, sunlight, unused, temperature, flux } = self;
        let n = slab.cells;
        let half = half_day(lat.0 * dec.0, lat.1 * dec.1);
        sunlight.fill(0.0);
        let (on_east, on_west) = sunlight.split_at_mut(n);
        for (cells, from, turn, sunlight) in [(east, 0.0, -FRAC_PI_2, on_east), (west, -half, FRAC_PI_2, on_west)] {
            let arc = [from + turn, from + half + turn];
            cells.add(kernel, [0.0, dec.1], arc, sunlight, &mut unused[..n]);
        }
        let mean = sunlight.iter().sum::<f64>() / (2 * n) as f64;
        if mean <= 0.0 {
            return 0.0;
        }
        sunlight.iter_mut().for_each(|f| *f /= mean);
        let theta = theta / mean.powf(0.75);
        if temperature[0] == 0.0 {
            temperature.iter_mut().zip(&*sunlight).for_each(|(t, f)| *t = ((f + theta) / (1.0 + theta)).powf(0.25));
        }
        balance.solve(slab, theta, sunlight, TOLERANCE, temperature, flux);
        // Both faces receive the same; what one takes up the other gives off.
        let means = flux.chunks_exact(n).map(|q| q.iter().sum::<f64>() / n as f64).collect::<Vec<_>>();
        2.0 / 3.0 * mean * (means[0] - means[1])
    }
}

impl Walls {
    /// For walls with the thermal parameter `theta` and a thickness of `lengths` thermal lengths, both positive.
    pub fn new<K: RecoilKernel>(
        kernel: &K,
        declinations: &Declinations,
        theta: f64,
        lengths: f64,
        cells: usize,
    ) -> Self {
        let m = declinations.len();
        let pressure = (0..LATITUDES)
            .into_par_iter()
            .map_init(
                || Worker::new(cells, lengths),
                |worker, k| {
                    let lat = (PI * (k as f64 / (LATITUDES - 1) as f64 - 0.5)).sin_cos();
                    worker.temperature.fill(0.0);
                    let dec = |j: usize| (declinations.sin[j], declinations.cos[j]);
                    (0..m).map(|j| worker.pressure(kernel, theta, lat, dec(j))).collect()
                },
            )
            .collect();
        Self { pressure }
    }

    /// Adds the facet's torque along the spin axis at each declination, N m per pressure of the beam, with `coverage` of
    /// wall per ground.
    pub fn add(&self, facet: &Facet, coverage: f64, out: &mut [f64]) {
        let (first, weights) = cubic_weights(facet.latitude(), LATITUDES);
        let lever = coverage * facet.area * facet.local_point()[0];
        for (j, out) in out.iter_mut().enumerate() {
            let pressure: f64 = (0..4).map(|k| weights[k] * self.pressure[first + k][j]).sum();
            *out += lever * pressure;
        }
    }
}

/// Thermal parameter (for unit flux units of [`crate::heat::flux::unit_thermal_parameter`]) and thickness in thermal
/// lengths of a wall at a spin rate.
pub(crate) fn parameters(wall: &Wall, omega: f64, unit_thermal_parameter: f64) -> [f64; 2] {
    let admittance = wall.thermal_inertia * omega.sqrt();
    [admittance * unit_thermal_parameter, admittance * wall.thickness_m / wall.conductivity_w_m_k]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recoil::LambertRecoil;

    /// On the equator at obliquity 0, `size` in units of `kappa T_* / J`.
    fn equator(theta: f64, size: f64, cells: usize) -> f64 {
        Worker::new(cells, theta * size).pressure(&LambertRecoil { albedo: 0.0 }, theta, (0.0, 1.0), (0.0, 1.0))
    }

    /// Against finite differences in depth and time of the same model (24 layers, 720 steps: good to 1e-4).
    #[test]
    fn equatorial_walls_match_finite_differences() {
        for (theta, size, pressure) in
            [(0.5, 0.25, 0.00040), (0.5, 1.0, 0.00221), (1.0, 1.0, 0.00607), (2.0, 1.0, 0.00499)]
        {
            let got = equator(theta, size, 512);
            println!("{theta} {size}: {got:.6} {pressure}, {:.6} with 64 cells", equator(theta, size, 64));
            assert!((got - pressure).abs() < 1e-4, "{theta} {size}: {got} {pressure}");
            assert!((equator(theta, size, 64) - got).abs() < 2e-4);
        }
    }

    #[test]
    fn walls_of_medium_size_are_pushed_eastwards_thin_and_thick_ones_not_at_all() {
        for theta in [0.3, 1.0, 3.0] {
            let peak = equator(theta, 1.4 / theta, 128);
            assert!(peak > 0.0);
            for size in [1e-4, 1e3] {
                let got = equator(theta, size, 128);
                assert!(got.abs() < 0.01 * peak, "{theta} {size}: {got} {peak}");
            }
        }
    }
}
