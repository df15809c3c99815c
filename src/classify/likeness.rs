//! Whether a body returns to a shape that it had before.
//!
//! Two shapes are alike as far as their spheres lie in the same places, within the movement limit, after the best
//! superposition of those that do (section 2.4.2 of Cotto-Figueroa et al. 2015 and its robust form).

use std::collections::BTreeMap;

use crate::evolve::movement::{MovementRule, detect_movement};
use crate::report::RunData;
use crate::store::ConfigurationRecord;

/// Compares the shapes of a run, each pair once.
pub struct Likeness<'a> {
    run: &'a RunData,
    known: BTreeMap<(u32, u32), f64>,
}

impl<'a> Likeness<'a> {
    /// For the shapes of `run`.
    pub fn new(run: &'a RunData) -> Self {
        Self { run, known: BTreeMap::new() }
    }

    /// Share of the spheres that two shapes have in the same places; spheres that only one of them has are not. Zero for
    /// a shape that is not on record.
    pub fn of(&mut self, a: u32, b: u32) -> f64 {
        if let Some(share) = self.known.get(&(a, b)) {
            return *share;
        }
        let shape = |number: u32| self.run.configurations.get(number as usize);
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
            radius.push(self.run.sphere_radius_m[*id as usize]);
        }
        let ([x, y, z], [u, v, w]) = (&before, &after);
        let fraction = self.run.scene.evolution.movement_radius_fraction;
        let movement = detect_movement([x, y, z], [u, v, w], &radius, fraction, MovementRule::Robust);
        let all = a.sphere_ids.len().max(b.sphere_ids.len());
        (radius.len() - movement.robust_count) as f64 / all as f64
    }
}
