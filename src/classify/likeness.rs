//! Whether a body returns to a shape that it had before.
//!
//! Two shapes are alike as far as their spheres lie in the same places, within the movement limit, after the best
//! superposition of those that do (section 2.4.2 of Cotto-Figueroa et al. 2015 and its robust form).

use std::collections::BTreeMap;

use crate::evolve::movement::{MovementRule, detect_movement};
use crate::store::ConfigurationRecord;

/// Compares the shapes of a run, each pair once.
pub struct Likeness<'a> {
    configurations: &'a [ConfigurationRecord],
    radius_m: &'a [f64],
    radius_fraction: f64,
    known: BTreeMap<(u32, u32), f64>,
}

impl<'a> Likeness<'a> {
    /// For the shapes of a run, by number; `radius_m` of a sphere by its number, `radius_fraction` of it the movement
    /// limit.
    pub fn new(configurations: &'a [ConfigurationRecord], radius_m: &'a [f64], radius_fraction: f64) -> Self {
        Self { configurations, radius_m, radius_fraction, known: BTreeMap::new() }
    }

    /// Share of the spheres that two shapes have in the same places; spheres that only one of them has are not. Zero for
    /// a shape that is not on record.
    pub fn of(&mut self, a: u32, b: u32) -> f64 {
        if let Some(share) = self.known.get(&(a, b)) {
            return *share;
        }
        let shape = |number: u32| self.configurations.get(number as usize);
        let share = shape(a).zip(shape(b)).map_or(0.0, |(a, b)| self.compare(a, b));
        self.known.insert((a, b), share);
        share
    }

    fn compare(&self, a: &ConfigurationRecord, b: &ConfigurationRecord) -> f64 {
        let (mut before, mut after): ([Vec<f64>; 3], [Vec<f64>; 3]) = Default::default();
        let mut radius = Vec::new();
        let mut others = b.sphere_ids.iter().zip(&b.positions).peekable();
        for (id, position) in a.sphere_ids.iter().zip(&a.positions) {
            // Both lists ascend.
            while others.next_if(|(other, _)| *other < id).is_some() {}
            let Some((_, other)) = others.next_if(|(other, _)| *other == id) else { continue };
            for axis in 0..3 {
                before[axis].push(position[axis]);
                after[axis].push(other[axis]);
            }
            radius.push(self.radius_m[*id as usize]);
        }
        let ([x, y, z], [u, v, w]) = (&before, &after);
        let movement = detect_movement([x, y, z], [u, v, w], &radius, self.radius_fraction, MovementRule::Robust);
        let all = a.sphere_ids.len().max(b.sphere_ids.len());
        (radius.len() - movement.robust_count) as f64 / all as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::TorqueRecord;

    const N: u32 = 40;

    /// A helix of spheres without those in `gone`, of which those in `shifted` lie 20 m beside their place, and the whole
    /// turned and shifted.
    fn shape(number: u32, shifted: &[u32], gone: &[u32], turn: f64) -> ConfigurationRecord {
        let place = |id: u32| {
            let (t, k) = (f64::from(id), if shifted.contains(&id) { 20.0 } else { 0.0 });
            let [x, y, z] = [300.0 * (0.7 * t).cos() + k, 200.0 * (0.7 * t).sin(), 10.0 * t];
            [x * turn.cos() - y * turn.sin() + turn, x * turn.sin() + y * turn.cos(), z - 5.0 * turn]
        };
        let sphere_ids: Vec<u32> = (0..N).filter(|id| !gone.contains(id)).collect();
        ConfigurationRecord {
            configuration: number,
            after_leg: None,
            t_s: 0.0,
            mass_kg: 1.0,
            positions: sphere_ids.iter().map(|id| place(*id)).collect(),
            sphere_ids,
            body_axes: [[0.0; 3]; 3],
            centre_of_mass: [0.0; 3],
            moments_kg_m2: [1.0; 3],
            b1_axes_m: [1.0; 3],
            b2_axes_m: [1.0; 3],
            densities_kg_m3: [1.0; 4],
            vertices: Vec::new(),
            vertices_kept: 0,
            vertices_flagged: 0,
            facets_folded: 0,
            torque: TorqueRecord {
                obliquity: Vec::new(),
                spin_rate: Vec::new(),
                spin_torque: Vec::new(),
                obliquity_torque: Vec::new(),
                spin_torque_error: 0.0,
                obliquity_torque_error: 0.0,
            },
        }
    }

    #[test]
    fn a_shape_that_comes_back_turned_is_alike_and_moved_or_lost_spheres_are_not() {
        let shapes = [
            shape(0, &[], &[], 0.0),
            shape(1, &[3, 17, 20, 31], &[], 0.1),
            shape(2, &[], &[], 0.4),
            shape(3, &[3], &[8, 9], 0.2),
        ];
        let radius = [50.0; N as usize];
        let mut likeness = Likeness::new(&shapes, &radius, 0.25);
        assert_eq!((likeness.of(0, 2), likeness.of(2, 0)), (1.0, 1.0));
        assert_eq!((likeness.of(0, 1), likeness.of(1, 2)), (0.9, 0.9));
        assert_eq!(likeness.of(0, 3), 37.0 / 40.0);
        assert_eq!(likeness.of(0, 4), 0.0);
        // A limit above the shift sees no difference.
        assert_eq!(Likeness::new(&shapes, &radius, 0.5).of(0, 1), 1.0);
    }
}
