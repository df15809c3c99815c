//! What an impact of two solid spheres does to their velocities and spins.
//!
//! Source: Richardson 1994 (MNRAS 269, 493) and 1995 (Icarus 115, 320): the impulse leaves `-restitution_normal` times the
//! normal and `restitution_tangential` times the tangential velocity of the two surfaces relative to each other. For
//! solid uniform spheres, `I = 2/5 m R²`, the tangential part of the reduced mass is 2/7 whatever the masses and radii.

use super::ball::Ball;
use nalgebra::Vector3;

/// Restitution of one impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Restitution {
    /// Along the line of centres, 0..=1.
    pub normal: f64,
    /// Across it, -1..=1.
    pub tangential: f64,
}

impl Restitution {
    /// No loss, no friction.
    pub const ELASTIC: Self = Self { normal: 1.0, tangential: 1.0 };
}

/// Changes of velocity (m/s) and spin (rad/s) of two spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    /// Of the velocities.
    pub velocity: [Vector3<f64>; 2],
    /// Of the spins; nothing without spins.
    pub spin: [Vector3<f64>; 2],
}

/// Velocity of the second surface relative to the first at the contact, m/s; `normal` points from the first to the second.
#[inline(always)]
pub(super) fn surface_velocity(balls: [&Ball; 2], spins: [Vector3<f64>; 2], normal: Vector3<f64>) -> Vector3<f64> {
    let [one, two] = balls;
    // s2 - s1 = -(R2 w2 + R1 w1) x n
    two.velocity() - one.velocity() - (spins[0] * one.radius() + spins[1] * two.radius()).cross(&normal)
}

/// The impulse on two touching spheres, or nothing when they do not approach.
///
/// `normal` is the unit vector from the first to the second centre. Without `SPIN` the spheres are taken as perfectly
/// smooth: `restitution.tangential` and the spins are not looked at.
#[inline(always)]
pub(super) fn impact<const SPIN: bool>(
    balls: [&Ball; 2],
    spins: [Vector3<f64>; 2],
    normal: Vector3<f64>,
    restitution: Restitution,
) -> Option<Change> {
    let [one, two] = balls;
    let centres = two.velocity() - one.velocity();
    let closing = centres.dot(&normal);
    if closing >= 0.0 {
        return None;
    }
    let share = 1.0 / (one.mass() + two.mass());
    let (share_one, share_two) = (two.mass() * share, one.mass() * share);
    let along = normal * ((1.0 + restitution.normal) * closing);
    if !SPIN {
        return Some(Change { velocity: [along * share_one, along * -share_two], spin: [Vector3::zeros(); 2] });
    }
    let surfaces = surface_velocity(balls, spins, normal);
    let lost = (2.0 / 7.0) * (1.0 - restitution.tangential);
    let across = (surfaces - normal * closing) * lost;
    let impulse = along + across;
    // R/I = 5/(2 m R), and mu / m1 = m2/(m1 + m2)
    let torque = normal.cross(&surfaces) * (2.5 * lost);
    Some(Change {
        velocity: [impulse * share_one, impulse * -share_two],
        spin: [torque * (share_one / one.radius()), torque * (share_two / two.radius())],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Two spheres in contact with their spins.
    #[derive(Debug)]
    struct Pair {
        balls: [Ball; 2],
        spins: [Vector3<f64>; 2],
    }

    impl Pair {
        fn normal(&self) -> Vector3<f64> {
            (self.balls[1].origin() - self.balls[0].origin()).normalize()
        }

        fn surfaces(&self) -> Vector3<f64> {
            surface_velocity([&self.balls[0], &self.balls[1]], self.spins, self.normal())
        }

        fn hit(&mut self, restitution: Restitution) -> bool {
            let normal = self.normal();
            let [one, two] = &self.balls;
            let Some(change) = impact::<true>([one, two], self.spins, normal, restitution) else { return false };
            for k in 0..2 {
                self.balls[k].deflect(change.velocity[k], 0.0);
                self.spins[k] += change.spin[k];
            }
            true
        }

        fn momentum(&self) -> Vector3<f64> {
            self.balls.iter().map(|b| b.velocity() * b.mass()).sum()
        }

        fn angular_momentum(&self) -> Vector3<f64> {
            let inertia = |b: &Ball| 0.4 * b.mass() * b.radius() * b.radius();
            let one = |k: usize| {
                let b = &self.balls[k];
                b.origin().cross(&b.velocity()) * b.mass() + self.spins[k] * inertia(b)
            };
            one(0) + one(1)
        }

        fn kinetic_energy(&self) -> f64 {
            let one = |k: usize| {
                let b = &self.balls[k];
                let inertia = 0.4 * b.mass() * b.radius() * b.radius();
                0.5 * (b.mass() * b.velocity().norm_squared() + inertia * self.spins[k].norm_squared())
            };
            one(0) + one(1)
        }
    }

    fn vector() -> impl Strategy<Value = Vector3<f64>> {
        (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z): (f64, f64, f64)| Vector3::new(x, y, z))
    }

    /// Touching spheres with masses, radii, speeds and spins of order 1.
    fn pair() -> impl Strategy<Value = Pair> {
        (
            (0.5..2.0, 0.5..2.0, 0.5..2.0, 0.5..2.0),
            vector().prop_filter("a direction", |v| v.norm() > 0.1),
            (vector(), vector(), vector(), vector()),
        )
            .prop_map(|((m1, m2, r1, r2), n, (v1, v2, w1, w2)): ((f64, f64, f64, f64), _, _)| {
                let place = n.normalize() * (r1 + r2);
                let one = Ball::new([0.0; 3], r1, v1.into(), m1);
                let two = Ball::new(place.into(), r2, v2.into(), m2);
                Pair { balls: [one, two], spins: [w1, w2] }
            })
    }

    #[test]
    fn oblique_impact_of_unit_spheres_has_the_known_outcome() {
        let at = |x: f64, v: [f64; 3]| Ball::new([x, 0.0, 0.0], 1.0, v, 1.0);
        let mut pair = Pair { balls: [at(0.0, [1.0, 0.5, 0.0]), at(2.0, [0.0; 3])], spins: [Vector3::zeros(); 2] };
        assert!(pair.hit(Restitution { normal: 0.2, tangential: 0.5 }));
        let close = |found: Vector3<f64>, x: f64, y: f64, z: f64| {
            assert!((found - Vector3::new(x, y, z)).norm() < 1e-15, "{found:?}");
        };
        close(pair.balls[0].velocity(), 0.4, 0.5 - 1.0 / 28.0, 0.0);
        close(pair.balls[1].velocity(), 0.6, 1.0 / 28.0, 0.0);
        close(pair.spins[0], 0.0, 0.0, -0.625 / 7.0);
        close(pair.spins[1], 0.0, 0.0, -0.625 / 7.0);
    }

    proptest! {
        #[test]
        fn prop_impact_conserves_momenta_and_loses_the_energy_of_the_formula(
            mut pair in pair(), normal in 0.0f64..1.0, tangential in -1.0f64..1.0,
        ) {
            let (p, l, e, u) = (pair.momentum(), pair.angular_momentum(), pair.kinetic_energy(), pair.surfaces());
            let n = pair.normal();
            let (u_n, u_t) = (u.dot(&n), u - n * u.dot(&n));
            prop_assume!(u_n < -1e-6);
            let restitution = Restitution { normal, tangential };
            prop_assert!(pair.hit(restitution));
            prop_assert!((pair.momentum() - p).norm() < 1e-14);
            prop_assert!((pair.angular_momentum() - l).norm() < 1e-13);
            let [m1, m2] = pair.balls.map(|b| b.mass());
            let mu = m1 * m2 / (m1 + m2);
            let loss = 0.5 * mu * ((1.0 - normal * normal) * u_n * u_n
                + 2.0 / 7.0 * (1.0 - tangential * tangential) * u_t.norm_squared());
            prop_assert!((e - pair.kinetic_energy() - loss).abs() < 1e-14 * e.max(1.0));
            let after = pair.surfaces();
            let (a_n, a_t) = (after.dot(&n), after - n * after.dot(&n));
            prop_assert!((a_n + normal * u_n).abs() < 1e-14 && (a_t - u_t * tangential).norm() < 1e-14);
        }

        #[test]
        fn prop_elastic_impact_conserves_energy_and_spins(mut pair in pair()) {
            let (e, spins) = (pair.kinetic_energy(), pair.spins);
            pair.hit(Restitution::ELASTIC);
            prop_assert!((pair.kinetic_energy() - e).abs() <= 1e-14 * e);
            prop_assert_eq!(pair.spins, spins);
        }

        #[test]
        fn prop_receding_spheres_are_left_alone(mut pair in pair()) {
            let n = pair.normal();
            let closing = (pair.balls[1].velocity() - pair.balls[0].velocity()).dot(&n);
            prop_assert_eq!(pair.hit(Restitution { normal: 0.2, tangential: 0.5 }), closing < 0.0);
        }

        #[test]
        fn prop_smooth_spheres_need_no_spins(pair in pair(), normal in 0.0f64..1.0) {
            let [one, two] = &pair.balls;
            let restitution = Restitution { normal, tangential: 1.0 };
            let with = impact::<true>([one, two], pair.spins, pair.normal(), restitution);
            let without = impact::<false>([one, two], pair.spins, pair.normal(), restitution);
            prop_assert_eq!(with.map(|c| c.velocity), without.map(|c| c.velocity));
        }
    }
}
