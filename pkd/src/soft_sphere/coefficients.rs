//! The constants of the contact law, free of the size of the spheres: stiffnesses, dashpots and limits.
//!
//! Schwartz et al. 2012 (Granular Matter 14, 363), eq. 15 for the dashpots, section 2.6 for the meaning of the tangential
//! restitution; Zhang et al. 2017 (Icarus 294, 98), eqs 4-12 for rolling and twisting. A dashpot is to be multiplied by the
//! square root of the reduced mass of the pair, a rolling or twisting one also by (beta R_eff)².

use std::f64::consts::PI;

use super::parameters::{Friction, SlidingCap, SoftSphereParameters, TangentialDamping};

/// Tangential over normal stiffness: both oscillations of a contact then take equally long.
const TANGENTIAL_OVER_NORMAL: f64 = 2.0 / 7.0;

/// Symbols as in the papers; `q` = beta R_eff, `mu` the reduced mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Coefficients {
    /// k_n, N/m.
    pub k_n: f64,
    /// C_n / sqrt(mu).
    pub c_n: f64,
    /// k_t, N/m.
    pub k_t: f64,
    /// C_t / sqrt(mu).
    pub c_t: f64,
    /// mu_S.
    pub mu_s: f64,
    /// What a contact does that slips.
    pub cap: SlidingCap,
    /// k_R / q², N/m.
    pub k_r: f64,
    /// C_R / (q² sqrt(mu)).
    pub c_r: f64,
    /// M_R,max / |F_N|, over q, or over the lever arm in the directional model.
    pub m_r: f64,
    /// k_T / q², N/m.
    pub k_w: f64,
    /// C_T / (q² sqrt(mu)).
    pub c_w: f64,
    /// M_T,max / |F_N|, over q, or over the radius of the contact circle in the directional model.
    pub m_w: f64,
    /// Cohesive force / q², Pa.
    pub cohesion: f64,
    /// beta.
    pub shape: f64,
    /// Contact time / sqrt(mu): the age at which directional torques set in.
    pub contact_time: f64,
    /// Time step, s.
    pub step_s: f64,
}

impl Coefficients {
    pub fn new(parameters: &SoftSphereParameters, k_n: f64, step_s: f64) -> Self {
        let k_t = TANGENTIAL_OVER_NORMAL * k_n;
        let mut law = Self {
            k_n,
            c_n: damping(parameters.restitution) * k_n.sqrt(),
            cohesion: 4.0 * parameters.cohesion_pa,
            shape: parameters.shape,
            contact_time: PI / k_n.sqrt(),
            step_s,
            ..Self::default()
        };
        if let Some(sliding) = parameters.friction.sliding() {
            let ratio = match sliding.damping {
                TangentialDamping::Pkdgrav => damping(sliding.restitution),
                TangentialDamping::Exact => exact_tangential_damping(parameters.restitution, sliding.restitution),
            };
            (law.k_t, law.c_t, law.mu_s) = (k_t, ratio * k_t.sqrt(), sliding.coefficient);
            law.cap = sliding.cap;
        }
        match parameters.friction {
            Friction::RollingAndTwisting { rolling, twisting, .. } => {
                (law.k_r, law.c_r, law.m_r) = (k_n, law.c_n, rolling);
                (law.k_w, law.c_w, law.m_w) = (2.0 * k_t, 2.0 * law.c_t, twisting * law.mu_s);
            }
            Friction::Directional { rolling, twisting, .. } => (law.m_r, law.m_w) = (rolling, twisting),
            Friction::None | Friction::Sliding(_) => {}
        }
        law
    }
}

/// C / sqrt(k mu) of a spring and dashpot that give this restitution when they part at zero overlap: 2 at 0, 0 at 1.
pub(super) fn damping(restitution: f64) -> f64 {
    if restitution == 0.0 {
        return 2.0;
    }
    let ln = restitution.ln();
    -2.0 * ln / (PI * PI + ln * ln).sqrt()
}

/// C_t / sqrt(k_t mu) with which tangential motion that sticks is minus `tangential` times the initial one at the end of
/// the contact, whose length the `normal` restitution sets.
fn exact_tangential_damping(normal: f64, tangential: f64) -> f64 {
    // The ratio falls from its value without a dashpot towards 0: bisection on a = alpha / w_t.
    let (mut low, mut high) = (0.0, 64.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if -tangential_ratio(normal, middle) > tangential { low = middle } else { high = middle }
    }
    // alpha = 7/4 C_t / mu and w_t² = 7/2 k_t / mu.
    4.0 / 7.0 * 3.5_f64.sqrt() * 0.5 * (low + high)
}

/// Final over initial tangential velocity of a contact that sticks, for alpha = a w_t (Schwartz et al. 2012, section 2.6,
/// continued to strong damping).
pub(super) fn tangential_ratio(normal: f64, a: f64) -> f64 {
    // In units of 1/w_t = 1/w_n: the two frequencies agree.
    let xi = 0.5 * damping(normal);
    // With no restitution at all the contact would last for ever.
    let time = PI / (1.0 - xi * xi).max(1e-6).sqrt();
    let w2 = 1.0 - a * a;
    let w = w2.abs().sqrt() * time;
    let t = a * time;
    if w2 > 1e-12 {
        (-t).exp() * (w.cos() - t / w * w.sin())
    } else if w2 < -1e-12 {
        // e^-t cosh w and e^-t sinh w without overflow.
        let (slow, fast) = ((w - t).exp(), (-w - t).exp());
        0.5 * ((slow + fast) - t / w * (slow - fast))
    } else {
        (-t).exp() * (1.0 - t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// C_n / sqrt(k_n mu) and contact time / sqrt(mu / k_n) of Schwartz et al. 2012, eq. 15.
    #[test]
    fn paper_dashpots_of_four_restitutions() {
        for (restitution, c, time) in
            [(0.2, 0.911900, 3.52986), (0.5, 0.430908, 3.21715), (0.55, 0.373885, 3.19797), (0.95, 0.0326500, 3.14201)]
        {
            let got = damping(restitution);
            assert!((got - c).abs() < 5e-7, "{restitution}: {got}");
            assert!((PI / (1.0 - 0.25 * got * got).sqrt() - time).abs() < 5e-6);
        }
        assert_eq!((damping(1.0), damping(0.0)), (0.0, 2.0));
    }

    /// What sticking contacts really do with pkdgrav's dashpot, in the equal-time approximation (no normal damping).
    #[test]
    fn tangential_restitution_is_reversed_and_smaller_than_nominal_unless_exact() {
        for (nominal, ratio) in [(0.5, -0.25065), (0.55, -0.30950), (0.95, -0.90847)] {
            // alpha / w_t = sqrt(7/2) / 2 times C_t / sqrt(k_t mu).
            let a = 0.5 * 3.5_f64.sqrt() * damping(nominal);
            // Equal times: the tangential half period stands for the length of the contact.
            let equal_time = -(-a * PI / (1.0 - a * a).sqrt()).exp();
            assert!((equal_time - ratio).abs() < 5e-6, "{nominal}: {equal_time}");
            let exact = exact_tangential_damping(0.55, nominal) * 0.5 * 3.5_f64.sqrt();
            let got = -tangential_ratio(0.55, exact);
            // Without a dashpot 0.9985 is left: a contact damped along the normal lasts longer.
            assert!((got - nominal).abs() < 1e-9, "{nominal}: {got}");
        }
    }

    /// R = 10 m, beta = 0.5, k_n = 1e6 N/m, mu_S = 1: Zhang et al. 2017, eqs 5-12.
    #[test]
    fn paper_rolling_and_twisting_constants() {
        let law = Coefficients::new(&SoftSphereParameters { cohesion_pa: 100.0, ..Default::default() }, 1e6, 1.0);
        let q = law.shape * 5.0;
        assert!((law.k_r * q * q - 6.25e6).abs() < 1e-6);
        assert!((law.k_w * q * q - 3.571429e6).abs() < 1.0);
        assert!((law.m_r * q - 2.625).abs() < 1e-12 && (law.m_w * q - 3.25).abs() < 1e-12);
        assert!((law.cohesion * q * q - 2500.0).abs() < 1e-9);
    }
}
