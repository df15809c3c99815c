//! The integrator of the spheres that a scene's contacts ask for: hard or soft, behind one call.
//!
//! An engine holds parameters and scratch memory only. The state of a run is in the spheres and, for soft ones, in what
//! their contacts remember; both come in and go out with every call, so a call is a pure function of them.

use std::cmp::Ordering;

use pkd::hard_sphere::{self, CollisionCounts, HardSphere, HardSphereParameters, RepairReport, repair_overlaps};
use pkd::soft_sphere::{self, ContactHistory, Gravity, SoftSphere, SoftSphereParameters, Stiffness};
use pkd::{PkdError, Spheres};

use crate::scene::{Contact, Scene};

/// How spheres touch, and attract each other in between.
#[derive(Debug, Clone, PartialEq)]
pub enum ContactLaw {
    /// Impulses at the exact times of impacts.
    Hard(HardSphereParameters),
    /// Springs, dashpots and sliders.
    Soft(SoftSphereParameters),
}

impl ContactLaw {
    /// That of a scene.
    pub fn of(scene: &Scene) -> Self {
        match &scene.contact {
            Contact::HardSphere(contact) => Self::Hard(contact.to_pkd(&scene.gravity)),
            Contact::SoftSphere(contact) => Self::Soft(contact.to_pkd(&scene.gravity)),
        }
    }

    /// Stiffness and step of soft contacts between these spheres; `None` for hard ones.
    ///
    /// # Errors
    /// As [`Stiffness::of`].
    pub fn stiffness(&self, spheres: &Spheres) -> Result<Option<Stiffness>, PkdError> {
        match self {
            Self::Hard(_) => Ok(None),
            Self::Soft(parameters) => Stiffness::of(parameters, spheres).map(Some),
        }
    }

    /// The engine, with the normal stiffness (N/m) that [`Self::stiffness`] found for the body at the start of its run:
    /// one found anew for a later state would change the strength of springs that are loaded.
    pub fn engine(&self, normal_stiffness_n_m: Option<f64>) -> Engine {
        match self.clone() {
            Self::Hard(parameters) => Engine::Hard(Box::new(HardSphere::new(parameters))),
            Self::Soft(parameters) => Engine::Soft(Box::new(SoftSphere::new(SoftSphereParameters {
                normal_stiffness_n_m: normal_stiffness_n_m.or(parameters.normal_stiffness_n_m),
                ..parameters
            }))),
        }
    }

    /// Pushes spheres apart, where any overlap deeper than these contacts can stand; says what was done.
    ///
    /// Hard spheres must not overlap at all. Soft ones are pressed into each other by their weight, and are left so if
    /// that is within their limit.
    ///
    /// # Errors
    /// As [`repair_overlaps`]; [`PkdError::Coincident`] for soft spheres at the same place.
    pub fn part_overlaps(&self, spheres: &mut Spheres) -> Result<Option<RepairReport>, PkdError> {
        let (parameters, allowed) = match self {
            Self::Hard(parameters) => (parameters.clone(), 0.0),
            Self::Soft(parameters) => {
                refuse_coincident(spheres)?;
                (HardSphereParameters::default(), parameters.max_overlap)
            }
        };
        let mut parted = spheres.clone();
        let report = repair_overlaps(&mut parted, &parameters)?;
        let needed = report.max_overlap_over_radius > allowed;
        if needed {
            *spheres = parted;
        }
        Ok(needed.then_some(report))
    }

    /// Whether the spheres attract each other.
    pub fn has_gravity(&self) -> bool {
        match self {
            Self::Hard(parameters) => parameters.gravity.is_some(),
            Self::Soft(parameters) => parameters.gravity != Gravity::Off,
        }
    }
}

/// Refuses spheres at the same place.
fn refuse_coincident(spheres: &Spheres) -> Result<(), PkdError> {
    let mut rows: Vec<usize> = (0..spheres.len()).collect();
    rows.sort_by(|a, b| {
        spheres.position(*a).partial_cmp(&spheres.position(*b)).unwrap_or(Ordering::Equal).then(a.cmp(b))
    });
    match rows.windows(2).find(|pair| spheres.position(pair[0]) == spheres.position(pair[1])) {
        Some(pair) => Err(PkdError::Coincident { first: pair[0], second: pair[1] }),
        None => Ok(()),
    }
}

/// An integrator of spheres.
#[derive(Debug)]
pub enum Engine {
    /// Of hard spheres.
    Hard(Box<HardSphere>),
    /// Of soft spheres.
    Soft(Box<SoftSphere>),
}

impl Engine {
    /// Work to which that of calls is added.
    pub fn no_work(&self) -> Work {
        match self {
            Self::Hard(_) => Work::Hard(hard_sphere::Report::default()),
            Self::Soft(_) => Work::Soft(Box::default()),
        }
    }

    /// Integrates for `duration_s` (s, >= 0). Soft spheres are asked after each step whether to `go_on`, hard ones not:
    /// their calls are short.
    ///
    /// `contacts` is what the contacts of the spheres remember; hard ones remember nothing. A soft run that is to be
    /// repeatable must be cut at the same times: one call of twice the length is not two calls.
    ///
    /// # Errors
    /// As [`HardSphere::evolve`] and [`SoftSphere::evolve_while`].
    pub fn evolve(
        &mut self,
        spheres: &mut Spheres,
        contacts: &mut ContactHistory,
        duration_s: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Work, PkdError> {
        match self {
            Self::Hard(engine) => engine.evolve(spheres, duration_s).map(Work::Hard),
            Self::Soft(engine) => {
                engine.set_history(std::mem::take(contacts));
                let work = engine.evolve_while(spheres, duration_s, go_on);
                *contacts = engine.take_history();
                work.map(|report| Work::Soft(Box::new(report)))
            }
        }
    }
}

/// What an engine did in one or several calls.
#[derive(Debug, Clone, PartialEq)]
pub enum Work {
    /// Of hard spheres.
    Hard(hard_sphere::Report),
    /// Of soft spheres.
    Soft(Box<soft_sphere::Report>),
}

impl Work {
    /// Adds a later stretch of the same run.
    ///
    /// # Panics
    /// If it was done by an engine of the other kind.
    pub fn add(&mut self, later: &Self) {
        match (self, later) {
            (Self::Hard(sum), Self::Hard(later)) => sum.add(later),
            (Self::Soft(sum), Self::Soft(later)) => sum.add(later),
            _ => unreachable!("one engine does all the work of a run"),
        }
    }

    /// Steps taken.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Hard(report) => report.steps,
            Self::Soft(report) => report.steps,
        }
    }

    /// Simulated time, s.
    pub fn duration_s(&self) -> f64 {
        match self {
            Self::Hard(report) => report.duration_s,
            Self::Soft(report) => report.duration_s,
        }
    }

    /// Collisions by rule; none of soft spheres, whose contacts last.
    pub fn collisions(&self) -> CollisionCounts {
        match self {
            Self::Hard(report) => report.counts,
            Self::Soft(_) => CollisionCounts::default(),
        }
    }

    /// Deepest overlap seen, over the smaller radius of the pair.
    pub fn max_overlap_over_radius(&self) -> f64 {
        match self {
            Self::Hard(report) => report.max_overlap_over_radius,
            Self::Soft(report) => report.max_overlap_over_radius,
        }
    }
}
