//! Follows shed bodies step by step and decides what became of them.

use super::budget::Budget;
use super::forces::{AU_M, Field, GM_SUN};
use super::mascons::{cross, minus, norm};
use super::orbit::{Elements, elements, leaves_for_good, specific_energy};
use super::rebound::Simulation;
use super::{Fate, Primary, ShedBody, ShedError, TrackOptions, Tracks};

/// Overlap at the start that is round-off, over the radius of the smaller sphere.
const TOUCHING: f64 = 1e-6;
/// An escaped body is beyond this many radii of the primary, and beyond this share of its Hill radius.
const ESCAPE_RADII: f64 = 20.0;
const ESCAPE_HILL_RADII: f64 = 0.5;
/// A body is near within this many radii of the primary.
const NEAR_RADII: f64 = 3.0;
/// Contact is looked for each time a body has moved by this share of the sum of the smallest radii.
const LOOK_EVERY_RADII: f64 = 0.1;
/// Most looks within one step.
const MAX_LOOKS: f64 = 1e5;
/// Halvings of the interval in which two bodies come into contact.
const HALVINGS: usize = 50;
/// Steps in a rotation of the primary, at least: far out, IAS15 chooses its step from the smooth part of the attraction
/// and would jump over the turning part.
const STEPS_PER_ROTATION: f64 = 4.0;
/// A step shorter than this share of the first one means that time stands still.
const SHORTEST_STEP: f64 = 1e-9;

/// A body on its way.
#[derive(Debug, Clone)]
struct Traveller {
    index: usize,
    body: ShedBody,
    /// How many of the given bodies it consists of.
    members: usize,
    bound_s: f64,
    near_s: f64,
    /// Integrals over the bound time of a, e and i.
    sums: [f64; 3],
    /// Jacobi constant at the start, and what its change is compared with.
    jacobi: [f64; 2],
}

/// What ends a stretch of integration.
#[derive(Debug, Clone, Copy)]
enum Event {
    Reimpact { traveller: usize },
    Meeting { pair: [usize; 2] },
}

/// Follows `shed` around `primary` until each has met its fate.
///
/// The result does not depend on the number of threads, and an empty list has an empty result.
///
/// # Errors
/// [`ShedError`]: options out of range, a body that is not finite or inside the primary, or a numerical failure.
pub fn follow(primary: &Primary, shed: &[ShedBody], options: &TrackOptions) -> Result<Tracks, ShedError> {
    options.validate()?;
    validate(shed)?;
    let mut run = Run {
        field: Field::new(primary, options)?,
        options,
        t_s: 0.0,
        dt_s: 0.0,
        travellers: Vec::new(),
        fates: vec![None; shed.len()],
        angular_momentum: vec![None; shed.len()],
        jacobi_drift: vec![None; shed.len()],
        budget: Budget::default(),
        steps: 0,
        unconverged: 0,
    };
    for (index, body) in shed.iter().enumerate() {
        let (gap, sphere) = run.field.mascons.clearance(run.field.to_body(0.0, body.position), body.radius);
        if gap < -TOUCHING * body.radius.min(run.field.mascons.smallest_radius_m()) {
            return Err(ShedError::InsidePrimary { body: index, sphere, overlap_m: -gap });
        }
        run.budget.shed.add(body, 1);
        let jacobi =
            [run.field.jacobi_constant(0.0, body.position, body.velocity), run.field.mascons.gm / norm(body.position)];
        let body = *body;
        run.travellers.push(Traveller { index, body, members: 1, bound_s: 0.0, near_s: 0.0, sums: [0.0; 3], jacobi });
    }
    run.travel()?;
    run.budget.close();
    // Every traveller was given a fate when it was taken off the list.
    let fates = run.fates.into_iter().flatten().collect();
    Ok(Tracks {
        fates,
        angular_momentum: run.angular_momentum,
        jacobi_drift: run.jacobi_drift,
        budget: run.budget,
        steps: run.steps,
        unconverged_steps: run.unconverged,
        evaluations: run.field.evaluations,
        multipole_switch_radius_m: run.field.switch_radius_m(),
    })
}

fn validate(shed: &[ShedBody]) -> Result<(), ShedError> {
    for (body, b) in shed.iter().enumerate() {
        let vectors = [("position", b.position), ("velocity", b.velocity), ("spin", b.spin)];
        for (quantity, value) in vectors.into_iter().flat_map(|(name, v)| v.map(|c| (name, c))) {
            if !value.is_finite() {
                return Err(ShedError::BadBody { body, quantity, value, more: "" });
            }
        }
        for (quantity, value) in [("mass", b.mass), ("radius", b.radius)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ShedError::BadBody { body, quantity, value, more: " and more than 0" });
            }
        }
    }
    Ok(())
}

struct Run<'a> {
    field: Field,
    options: &'a TrackOptions,
    t_s: f64,
    /// Last step that was tried, s; 0 before the first.
    dt_s: f64,
    travellers: Vec<Traveller>,
    fates: Vec<Option<Fate>>,
    angular_momentum: Vec<Option<[f64; 3]>>,
    jacobi_drift: Vec<Option<f64>>,
    budget: Budget,
    steps: u64,
    unconverged: u64,
}

impl Run<'_> {
    /// Integrates from event to event.
    fn travel(&mut self) -> Result<(), ShedError> {
        self.merge_touching();
        while !self.travellers.is_empty() && self.t_s < self.options.t_max_s {
            let bodies: Vec<ShedBody> = self.travellers.iter().map(|t| t.body).collect();
            let first_dt = 1e-3 * self.shortest_orbit_s();
            let dt = if self.dt_s > 0.0 { self.dt_s } else { first_dt };
            let mut simulation = Simulation::new(&bodies, self.options.ias15_tolerance, self.t_s, dt)?;
            while self.t_s < self.options.t_max_s && !self.step(&mut simulation, first_dt)? {}
            self.unconverged += simulation.unconverged();
        }
        let t_s = self.t_s;
        while let Some(traveller) = self.travellers.pop() {
            let fate = traveller.bound_fate(t_s);
            self.end(&traveller, fate);
        }
        Ok(())
    }

    /// One step; whether the list of travellers changed, so that the integrator must start anew.
    fn step(&mut self, simulation: &mut Simulation, first_dt: f64) -> Result<bool, ShedError> {
        let rotation_s = std::f64::consts::TAU / self.field.spin_rate.abs();
        simulation.limit_dt((self.options.t_max_s - self.t_s).min(rotation_s / STEPS_PER_ROTATION));
        simulation.step(&mut self.field);
        self.steps += 1;
        let (t0, t1) = (self.t_s, simulation.t());
        if t1 - t0 < SHORTEST_STEP * first_dt && t1 < self.options.t_max_s {
            return Err(ShedError::StepVanished { t_s: t0, dt_s: t1 - t0 });
        }
        self.dt_s = simulation.dt();
        let before: Vec<ShedBody> = self.travellers.iter().map(|t| t.body).collect();
        for (traveller, (position, velocity)) in self.travellers.iter_mut().zip(simulation.states()) {
            if position.iter().chain(&velocity).any(|c| !c.is_finite()) {
                return Err(ShedError::BecameNonFinite { body: traveller.index, t_s: t0 });
            }
            (traveller.body.position, traveller.body.velocity) = (position, velocity);
        }
        let event = self.first_event(&before, t0, t1);
        let end = event.map_or(t1, |(t, _)| t);
        if let Some((t, _)) = event {
            self.go_to(&before, t0, t)?;
        }
        self.t_s = end;
        let (gm, near) = (self.field.mascons.gm, NEAR_RADII * self.field.mascons.bounding_radius_m);
        for (traveller, before) in self.travellers.iter_mut().zip(&before) {
            traveller.spend(end - t0, before, gm, near);
        }
        if let Some((t, event)) = event {
            self.resolve(t, event);
            return Ok(true);
        }
        Ok(self.let_escape())
    }

    /// Takes the bodies from where they were at `t0` to `t` by the integrator; the path only told when.
    fn go_to(&mut self, before: &[ShedBody], t0: f64, t: f64) -> Result<(), ShedError> {
        let mut simulation = Simulation::new(before, self.options.ias15_tolerance, t0, t - t0)?;
        while simulation.t() < t {
            simulation.limit_dt(t - simulation.t());
            let last = simulation.t();
            simulation.step(&mut self.field);
            self.steps += 1;
            if simulation.t() <= last {
                break;
            }
        }
        for (traveller, (position, velocity)) in self.travellers.iter_mut().zip(simulation.states()) {
            (traveller.body.position, traveller.body.velocity) = (position, velocity);
        }
        Ok(())
    }

    /// The earliest contact between two times.
    fn first_event(&mut self, before: &[ShedBody], t0: f64, t1: f64) -> Option<(f64, Event)> {
        let mut first: Option<(f64, Event)> = None;
        let mut found = |t: Option<f64>, event| {
            if let Some(t) = t
                && first.is_none_or(|(earliest, _)| t < earliest)
            {
                first = Some((t, event));
            }
        };
        let smallest = self.field.mascons.smallest_radius_m();
        let bound = self.field.mascons.bounding_radius_m;
        for (k, a) in before.iter().enumerate() {
            let b = self.travellers[k].body;
            let radius = b.radius;
            let speed = norm(a.velocity).max(norm(b.velocity));
            let surface = self.field.spin_rate * norm(a.position).max(norm(b.position));
            let reach = norm(a.position).min(norm(b.position)) - speed * (t1 - t0);
            if reach > bound + radius {
                continue;
            }
            let path = self.path(a, k, t0, t1);
            let looks = (speed + surface) * (t1 - t0) / (LOOK_EVERY_RADII * (radius + smallest));
            let field = &self.field;
            let gap = |t: f64| {
                let at = path.at(t).0;
                let far = norm(at) - bound - radius;
                if far > 0.0 { far } else { field.mascons.clearance(field.to_body(t, at), radius).0 }
            };
            found(first_contact(gap, [t0, t1], looks, speed + surface), Event::Reimpact { traveller: k });
        }
        for i in 0..self.travellers.len() {
            for j in i + 1..self.travellers.len() {
                let (a, b) = (self.travellers[i].body, self.travellers[j].body);
                let radii = a.radius + b.radius;
                let speed =
                    norm(minus(a.velocity, b.velocity)).max(norm(minus(before[i].velocity, before[j].velocity)));
                let nearest =
                    norm(minus(a.position, b.position)).min(norm(minus(before[i].position, before[j].position)));
                // Their mutual attraction may speed them up on the way.
                let pull = pkd::constants::G * (a.mass + b.mass) / radii;
                let speed = (speed * speed + 2.0 * pull).sqrt();
                if nearest - speed * (t1 - t0) > radii {
                    continue;
                }
                let (path_a, path_b) = (self.path(&before[i], i, t0, t1), self.path(&before[j], j, t0, t1));
                let looks = speed * (t1 - t0) / (LOOK_EVERY_RADII * radii);
                let gap = |t: f64| norm(minus(path_a.at(t).0, path_b.at(t).0)) - radii;
                found(first_contact(gap, [t0, t1], looks, speed), Event::Meeting { pair: [i, j] });
            }
        }
        first
    }

    /// The path of traveller `k` between two times, from its state before to its present one.
    fn path(&mut self, before: &ShedBody, k: usize, t0: f64, t1: f64) -> Path {
        let after = self.travellers[k].body;
        let (a0, a1) = (self.field.attraction(t0, before.position), self.field.attraction(t1, after.position));
        Path::new(t0, t1, (before.position, before.velocity, a0), (after.position, after.velocity, a1))
    }

    fn resolve(&mut self, t_s: f64, event: Event) {
        match event {
            Event::Reimpact { traveller } => {
                let gone = self.travellers.remove(traveller);
                let ShedBody { position, velocity, radius, .. } = gone.body;
                let at = self.field.to_body(t_s, position);
                let relative = minus(velocity, cross([0.0, 0.0, self.field.spin_rate], position));
                let fate = Fate::Reimpact {
                    t_s,
                    speed_m_s: norm(relative),
                    position_m: at,
                    velocity_m_s: self.field.to_body(t_s, relative),
                    sphere: self.field.mascons.clearance(at, radius).1,
                };
                self.end(&gone, fate);
            }
            Event::Meeting { pair: [i, j] } => self.merge(t_s, i, j),
        }
    }

    /// The lighter of two travellers (the later one, if they are equal) becomes part of the other.
    fn merge(&mut self, t_s: f64, i: usize, j: usize) {
        let lighter = if self.travellers[j].body.mass <= self.travellers[i].body.mass { j } else { i };
        let gone = self.travellers.remove(lighter);
        let kept = i + j - lighter;
        let kept = &mut self.travellers[if lighter < kept { kept - 1 } else { kept }];
        let speed_m_s = norm(minus(gone.body.velocity, kept.body.velocity));
        kept.body = merged(&kept.body, &gone.body);
        kept.members += gone.members;
        let fate = Fate::Merged { t_s, speed_m_s, into: kept.index };
        self.end(&gone, fate);
    }

    /// Bodies that touch at the start are one body.
    fn merge_touching(&mut self) {
        let mut i = 0;
        while i < self.travellers.len() {
            let a = self.travellers[i].body;
            let touches = |b: &ShedBody| norm(minus(a.position, b.position)) < (1.0 + TOUCHING) * (a.radius + b.radius);
            match (i + 1..self.travellers.len()).find(|j| touches(&self.travellers[*j].body)) {
                // The merged body is larger: look again from the first.
                Some(j) => {
                    self.merge(0.0, i, j);
                    i = 0;
                }
                None => i += 1,
            }
        }
    }

    /// Takes those that escaped off the list; whether there were any.
    fn let_escape(&mut self) -> bool {
        let gm = self.field.mascons.gm;
        let hill = self.options.semimajor_axis_au * AU_M * (gm / (3.0 * GM_SUN)).cbrt();
        let far = (ESCAPE_RADII * self.field.mascons.bounding_radius_m).max(ESCAPE_HILL_RADII * hill);
        let t_s = self.t_s;
        let energy = |b: &ShedBody| specific_energy(gm, b.position, b.velocity);
        let leaves = |t: &Traveller| leaves_for_good(gm, far, t.body.position, t.body.velocity);
        let mut any = false;
        // One after the other, so that each is seen against all that is still there.
        while let Some(k) = self.travellers.iter().position(leaves) {
            let gone = self.travellers.remove(k);
            self.end(&gone, Fate::Escape { t_s, speed_m_s: (2.0 * energy(&gone.body)).sqrt() });
            any = true;
        }
        any
    }

    fn end(&mut self, traveller: &Traveller, fate: Fate) {
        self.budget.enter(&fate, &traveller.body, traveller.members);
        if traveller.members == 1 && !matches!(fate, Fate::Merged { .. }) {
            let ShedBody { position, velocity, .. } = traveller.body;
            let [start, scale] = traveller.jacobi;
            let end = self.field.jacobi_constant(self.t_s, position, velocity);
            self.jacobi_drift[traveller.index] = Some((end - start).abs() / scale);
        }
        if !matches!(fate, Fate::Merged { .. }) {
            self.angular_momentum[traveller.index] = Some(self.taken_by(&traveller.body));
        }
        self.fates[traveller.index] = Some(fate);
    }

    /// What `body` takes out of the angular momentum of the primary and those that are still on the way.
    fn taken_by(&self, body: &ShedBody) -> [f64; 3] {
        let others = self.travellers.iter().map(|t| &t.body);
        let rest: f64 = self.field.mascons.gm / pkd::constants::G + others.clone().map(|b| b.mass).sum::<f64>();
        // The primary stands at the origin.
        let mean = |of: fn(&ShedBody) -> [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| others.clone().map(|b| b.mass * of(b)[k]).sum::<f64>() / rest)
        };
        let (centre, drift) = (mean(|b| b.position), mean(|b| b.velocity));
        let orbital = cross(minus(body.position, centre), minus(body.velocity, drift));
        let (reduced, inertia) = (body.mass * rest / (body.mass + rest), 0.4 * body.mass * body.radius * body.radius);
        std::array::from_fn(|k| reduced * orbital[k] + inertia * body.spin[k])
    }

    /// Period of a circular orbit at the innermost body, or at the surface where one is among the primary's spheres, s.
    fn shortest_orbit_s(&self) -> f64 {
        let nearest = self.travellers.iter().map(|t| norm(t.body.position)).fold(f64::INFINITY, f64::min);
        let nearest = nearest.max(self.field.mascons.bounding_radius_m);
        std::f64::consts::TAU * (nearest.powi(3) / self.field.mascons.gm).sqrt()
    }
}

impl Traveller {
    /// Books the time of a step by the states at its ends.
    fn spend(&mut self, duration: f64, before: &ShedBody, gm: f64, near: f64) {
        for body in [before, &self.body] {
            let half = 0.5 * duration;
            if norm(body.position) < near {
                self.near_s += half;
            }
            let orbit = elements(gm, body.position, body.velocity);
            if orbit.semimajor_axis_m > 0.0 {
                self.bound_s += half;
                let parts = [orbit.semimajor_axis_m, orbit.eccentricity, orbit.inclination];
                self.sums.iter_mut().zip(parts).for_each(|(sum, x)| *sum += half * x);
            }
        }
    }

    fn bound_fate(&self, t_s: f64) -> Fate {
        let [semimajor_axis_m, eccentricity, inclination] = self.sums.map(|sum| sum / self.bound_s);
        let mean = (self.bound_s > 0.0).then_some(Elements { semimajor_axis_m, eccentricity, inclination });
        let within_3_radii = if t_s > 0.0 { self.near_s / t_s } else { 0.0 };
        Fate::Bound { t_s, mean, within_3_radii }
    }
}

/// One body of both: mass, momentum, angular momentum and volume are kept.
fn merged(a: &ShedBody, b: &ShedBody) -> ShedBody {
    let mass = a.mass + b.mass;
    let mean = |x: [f64; 3], y: [f64; 3]| std::array::from_fn(|k| (a.mass * x[k] + b.mass * y[k]) / mass);
    let (position, velocity) = (mean(a.position, b.position), mean(a.velocity, b.velocity));
    let radius = (a.radius.powi(3) + b.radius.powi(3)).cbrt();
    let inertia = |m: f64, r: f64| 0.4 * m * r * r;
    let orbital = cross(minus(a.position, b.position), minus(a.velocity, b.velocity));
    let spin = std::array::from_fn(|k| {
        let spins = inertia(a.mass, a.radius) * a.spin[k] + inertia(b.mass, b.radius) * b.spin[k];
        (a.mass * b.mass / mass * orbital[k] + spins) / inertia(mass, radius)
    });
    ShedBody { position, velocity, spin, mass, radius }
}

/// The quintic through position, velocity and acceleration at both ends of a step.
struct Path {
    t0: f64,
    length: f64,
    /// Coefficients in powers of the time since `t0` over `length`.
    powers: [[f64; 3]; 6],
}

impl Path {
    fn new(
        t0: f64,
        t1: f64,
        (x0, v0, a0): ([f64; 3], [f64; 3], [f64; 3]),
        (x1, v1, a1): ([f64; 3], [f64; 3], [f64; 3]),
    ) -> Self {
        let h = t1 - t0;
        let mut powers = [[0.0; 3]; 6];
        for k in 0..3 {
            let (v0, v1, a0, a1) = (h * v0[k], h * v1[k], 0.5 * h * h * a0[k], 0.5 * h * h * a1[k]);
            let dx = x1[k] - x0[k] - v0 - a0;
            let dv = v1 - v0 - 2.0 * a0;
            let da = a1 - a0;
            let quintic =
                [x0[k], v0, a0, 10.0 * dx - 4.0 * dv + da, -15.0 * dx + 7.0 * dv - 2.0 * da, 6.0 * dx - 3.0 * dv + da];
            powers.iter_mut().zip(quintic).for_each(|(power, c)| power[k] = c);
        }
        Self { t0, length: h, powers }
    }

    /// Position and velocity at `t`.
    fn at(&self, t: f64) -> ([f64; 3], [f64; 3]) {
        let s = (t - self.t0) / self.length;
        let mut position = [0.0; 3];
        let mut velocity = [0.0; 3];
        for (n, power) in self.powers.iter().enumerate().rev() {
            for k in 0..3 {
                position[k] = position[k] * s + power[k];
                if n > 0 {
                    velocity[k] = velocity[k] * s + n as f64 * power[k] / self.length;
                }
            }
        }
        (position, velocity)
    }
}

/// The first time at which a gap closes, looked for at evenly spaced times and, where it may have closed and opened again
/// between two of them, at its minimum: the gap changes at `speed` (m/s) at most.
///
/// A gap that is closed at the start counts only where it shrinks: bodies that part while they touch are let go.
fn first_contact(gap: impl Fn(f64) -> f64, [t0, t1]: [f64; 2], looks: f64, speed: f64) -> Option<f64> {
    let looks = looks.clamp(1.0, MAX_LOOKS).ceil();
    let (mut last_t, mut last_gap) = (t0, gap(t0));
    for k in 1..=looks as u32 {
        let t = t0 + (t1 - t0) * f64::from(k) / looks;
        let now = gap(t);
        if now < 0.0 && now < last_gap {
            return Some(closing(&gap, last_t, t));
        }
        if now >= 0.0 && last_gap >= 0.0 && now + last_gap < speed * (t - last_t) {
            let lowest = minimum(&gap, last_t, t);
            if gap(lowest) < 0.0 {
                return Some(closing(&gap, last_t, lowest));
            }
        }
        (last_t, last_gap) = (t, now);
    }
    None
}

/// When a gap closes between `open` and `closed`.
fn closing(gap: &impl Fn(f64) -> f64, mut open: f64, mut closed: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (open + closed);
        if gap(middle) < 0.0 {
            closed = middle;
        } else {
            open = middle;
        }
    }
    closed
}

/// Where a gap is smallest between two times, by golden section (Kiefer 1953).
fn minimum(gap: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut left, mut right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut at_left, mut at_right) = (gap(left), gap(right));
    for _ in 0..HALVINGS {
        // A gap that is closed is found.
        if at_left < 0.0 || at_right < 0.0 {
            break;
        }
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - GOLDEN * (high - low);
            at_left = gap(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + GOLDEN * (high - low);
            at_right = gap(right);
        }
    }
    if at_left < at_right { left } else { right }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight pass at distances around that of contact, seen at one, two or ten times.
    #[test]
    fn a_grazing_contact_between_two_looks_is_found_and_a_miss_is_none() {
        for looks in [1.0, 2.0, 10.0, 333.0] {
            for (distance, meets) in
                [(99.0, true), (99.999, true), (99.999_999, true), (100.000_001, false), (101.0, false)]
            {
                let gap = |t: f64| (distance * distance + (1000.0 * (t - 3.3)).powi(2)).sqrt() - 100.0;
                let found = first_contact(gap, [0.0, 10.0], looks, 1000.0);
                assert_eq!(found.is_some(), meets, "{looks} {distance}");
                if let Some(t) = found {
                    assert!(gap(t).abs() < 1e-9 && t <= 3.3, "{t}");
                }
            }
        }
    }
}
