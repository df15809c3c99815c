//! Multiplication of the harmonics of a periodic series by given factors.

use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// Transforms of one length with their buffers.
pub(crate) struct Filter {
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    input: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl Filter {
    /// For series of `len` numbers (even).
    pub fn new(len: usize) -> Self {
        let mut planner = RealFftPlanner::new();
        let (forward, inverse) = (planner.plan_fft_forward(len), planner.plan_fft_inverse(len));
        let scratch = forward.get_scratch_len().max(inverse.get_scratch_len());
        Self {
            input: forward.make_input_vec(),
            spectrum: forward.make_output_vec(),
            scratch: vec![Complex::default(); scratch],
            forward,
            inverse,
        }
    }

    /// `out` = `x` with its harmonics 0 to half the length multiplied by `factors`, times the length.
    pub fn apply(&mut self, x: impl Iterator<Item = f64>, factors: &[Complex<f64>], out: &mut [f64]) {
        self.input.iter_mut().zip(x).for_each(|(i, x)| *i = x);
        let fits = "lengths are those of the plan";
        self.forward.process_with_scratch(&mut self.input, &mut self.spectrum, &mut self.scratch).expect(fits);
        self.spectrum.iter_mut().zip(factors).for_each(|(s, f)| *s *= f);
        // Both are real up to round-off, which the inverse refuses.
        self.spectrum[0].im = 0.0;
        self.spectrum[out.len() / 2].im = 0.0;
        self.inverse.process_with_scratch(&mut self.spectrum, out, &mut self.scratch).expect(fits);
    }
}

/// `sqrt(i n) / len` for the harmonics 0 to `len / 2`, the root of the derivative over the rotation; the highest, which has
/// no phase in a real series, is real.
pub(crate) fn half_derivative(len: usize) -> Vec<Complex<f64>> {
    let root = |n: usize| (0.5 * n as f64).sqrt() / len as f64;
    (0..=len / 2).map(|n| Complex::new(root(n), if 2 * n == len { 0.0 } else { root(n) })).collect()
}

/// `divisor = 1 / (c + theta admittance)`, both over the length.
pub(crate) fn divide_by(c: f64, theta: f64, admittance: &[Complex<f64>], divisor: &mut [Complex<f64>]) {
    let len = 2.0 * (admittance.len() - 1) as f64;
    for (divisor, admittance) in divisor.iter_mut().zip(admittance) {
        *divisor = (c * len + theta * len * len * admittance).inv();
    }
}
