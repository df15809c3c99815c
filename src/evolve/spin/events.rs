//! Where inside a step something happens: bisection on the course of the state within it.

/// Smallest fraction in `[0, hi]` at which `happened` holds, to 1e-12; it must hold at `hi`.
pub(super) fn locate(happened: impl Fn(f64) -> bool, hi: f64) -> f64 {
    let (mut lo, mut hi) = (0.0, hi);
    while hi - lo > 1e-12 {
        let middle = 0.5 * (lo + hi);
        if happened(middle) { hi = middle } else { lo = middle }
    }
    hi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bisection_finds_the_edge_to_1e_minus_12() {
        assert!((locate(|x| x >= 0.3, 1.0) - 0.3).abs() < 1e-12);
        assert!(locate(|_| true, 1.0) < 1e-11);
    }
}
