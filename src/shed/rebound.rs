//! REBOUND's IAS15 (Rein & Spiegel 2015, MNRAS 446, 1424) one step at a time, with a force of ours.

use std::any::Any;
use std::ffi::{c_double, c_uint, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use librebound_sys::Simulation as Bindings;
use librebound_sys::ffi::{reb_particle, reb_simulation};
use pkd::constants::G;

use super::{ShedBody, ShedError};

type ForceOfC = unsafe extern "C" fn(*mut c_void, c_double, *mut reb_particle, c_uint);

unsafe extern "C" {
    fn yorp_shed_set_up(r: *mut reb_simulation, g: c_double, epsilon: c_double, t: c_double, dt: c_double);
    fn yorp_shed_step(r: *mut reb_simulation, force: ForceOfC, context: *mut c_void);
}

/// Bodies that attract each other, with an additional force.
pub(super) struct Simulation {
    bindings: Bindings,
}

/// What adds to the accelerations of the particles (m/s^2) at a time (s).
pub(super) trait Force {
    fn add(&mut self, t_s: f64, particles: &mut [reb_particle]);
}

impl Simulation {
    /// The bodies at `t_s`; the first step tried is `dt_s`.
    pub fn new(bodies: &[ShedBody], epsilon: f64, t_s: f64, dt_s: f64) -> Result<Self, ShedError> {
        let mut bindings = Bindings::new().map_err(|error| ShedError::Rebound { message: error.to_string() })?;
        // SAFETY: the pointer is that of a live simulation.
        unsafe { yorp_shed_set_up(bindings.as_mut_ptr(), G, epsilon, t_s, dt_s) };
        for ShedBody { position: [x, y, z], velocity: [vx, vy, vz], mass, radius, .. } in bodies {
            let (x, y, z, vx, vy, vz) = (*x, *y, *z, *vx, *vy, *vz);
            bindings.add_particle(reb_particle { x, y, z, vx, vy, vz, m: *mass, r: *radius, ..Default::default() });
        }
        Ok(Self { bindings })
    }

    /// Time, s.
    pub fn t(&self) -> f64 {
        self.bindings.t()
    }

    /// The step that will be tried next, s.
    pub fn dt(&self) -> f64 {
        self.bindings.dt()
    }

    /// Tries no longer step than this next, s.
    pub fn limit_dt(&mut self, longest_s: f64) {
        self.bindings.set_dt(self.bindings.dt().min(longest_s));
    }

    /// Steps whose implicit equations did not converge.
    pub fn unconverged(&self) -> u64 {
        self.bindings.ias15_iterations_max_exceeded()
    }

    /// Position (m) and velocity (m/s) of every body, in the order of [`Self::new`].
    pub fn states(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        self.bindings.particles().iter().map(|p| ([p.x, p.y, p.z], [p.vx, p.vy, p.vz]))
    }

    /// One step of a length that IAS15 chooses.
    pub fn step<F: Force>(&mut self, force: &mut F) {
        let mut call = Call { force, panic: None };
        // SAFETY: the simulation is alive; `forward::<F>` gets back the pointer to `call`, which outlives the step.
        unsafe { yorp_shed_step(self.bindings.as_mut_ptr(), forward::<F>, (&raw mut call).cast()) };
        if let Some(panic) = call.panic {
            resume_unwind(panic);
        }
    }
}

/// A force on its way through C, which no panic may cross.
struct Call<'a, F> {
    force: &'a mut F,
    panic: Option<Box<dyn Any + Send>>,
}

unsafe extern "C" fn forward<F: Force>(context: *mut c_void, t: c_double, particles: *mut reb_particle, n: c_uint) {
    // SAFETY: `Simulation::step` passes a `Call<F>` that nothing else uses meanwhile, REBOUND its array of n particles.
    let (call, particles) =
        unsafe { (&mut *context.cast::<Call<F>>(), std::slice::from_raw_parts_mut(particles, n as usize)) };
    if call.panic.is_none() {
        let force = &mut *call.force;
        call.panic = catch_unwind(AssertUnwindSafe(|| force.add(t, particles))).err();
    }
}
