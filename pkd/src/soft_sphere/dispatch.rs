//! The compiled versions of the kernels: one for each model and processor, chosen once for a run.

use super::coefficients::Coefficients;
use super::kernel::contacts;
use super::lanes::{Plain, Quad, Wide};
use super::motion::{FROZEN, Frames, GIVEN, Moved, NONE, advance};
use super::pairs::Chunk;
use super::parameters::SoftSphereParameters;
use crate::simd::Level;

use super::record::{DIRECTIONAL, FRICTIONLESS, FULL, SLIDING, model};

/// [`contacts`] for one model.
///
/// # Safety
/// As there, but for the processor, which has been looked at.
pub(super) type Contacts = unsafe fn(&Coefficients, f64, &[Quad], &mut Chunk);

/// [`advance`] for one model.
///
/// # Safety
/// As there, but for the processor, which has been looked at.
pub(super) type Advance = unsafe fn(f64, &Frames, &mut [Quad], &[[f64; 2]], &mut [Quad], &[Quad]) -> Moved;

/// The kernels of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kernels {
    pub contacts: Contacts,
    pub advance: Advance,
}

impl Kernels {
    /// The kernels for these parameters and kind of field.
    ///
    /// # Panics
    /// If the present processor cannot run them.
    pub fn new(level: Level, parameters: &SoftSphereParameters, field: u8) -> Self {
        assert!(level <= Level::present(), "kernels that can run here");
        let model = model(&parameters.friction);
        let contacts = choose_contacts(level, model, parameters.cohesion_pa > 0.0, parameters.ledger);
        Self { contacts, advance: choose_advance(level, model, field) }
    }
}

fn choose_contacts(level: Level, model: u8, cohesive: bool, ledger: bool) -> Contacts {
    match model {
        FRICTIONLESS => contacts_of::<FRICTIONLESS>(level, cohesive, ledger),
        SLIDING => contacts_of::<SLIDING>(level, cohesive, ledger),
        FULL => contacts_of::<FULL>(level, cohesive, ledger),
        _ => contacts_of::<DIRECTIONAL>(level, cohesive, ledger),
    }
}

fn contacts_of<const MODEL: u8>(level: Level, cohesive: bool, ledger: bool) -> Contacts {
    match (cohesive, ledger) {
        (false, false) => contacts_on::<MODEL, false, false>(level),
        (false, true) => contacts_on::<MODEL, false, true>(level),
        (true, false) => contacts_on::<MODEL, true, false>(level),
        (true, true) => contacts_on::<MODEL, true, true>(level),
    }
}

fn contacts_on<const MODEL: u8, const COHESIVE: bool, const LEDGER: bool>(level: Level) -> Contacts {
    match level {
        Level::Scalar => contacts::<Wide<Plain>, MODEL, COHESIVE, LEDGER>,
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => x86::contacts::<MODEL, COHESIVE, LEDGER>,
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => x86::contacts_512::<MODEL, COHESIVE, LEDGER>,
    }
}

fn choose_advance(level: Level, model: u8, field: u8) -> Advance {
    match (model == FRICTIONLESS, field) {
        (true, NONE) => advance_on::<FRICTIONLESS, NONE>(level),
        (true, GIVEN) => advance_on::<FRICTIONLESS, GIVEN>(level),
        (true, _) => advance_on::<FRICTIONLESS, FROZEN>(level),
        // To move spheres that spin is the same whatever makes them.
        (false, NONE) => advance_on::<SLIDING, NONE>(level),
        (false, GIVEN) => advance_on::<SLIDING, GIVEN>(level),
        (false, _) => advance_on::<SLIDING, FROZEN>(level),
    }
}

fn advance_on<const MODEL: u8, const FIELD: u8>(level: Level) -> Advance {
    match level {
        Level::Scalar => advance::<Plain, MODEL, FIELD>,
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => x86::advance::<MODEL, FIELD>,
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => x86::advance_512::<MODEL, FIELD>,
    }
}

/// The same, compiled for AVX2 and AVX-512.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::super::lanes::{Avx2, Avx512, Wide};
    use super::{Chunk, Coefficients, Frames, Moved, Quad};

    #[target_feature(enable = "avx2")]
    pub(super) unsafe fn contacts<const MODEL: u8, const COHESIVE: bool, const LEDGER: bool>(
        law: &Coefficients,
        step: f64,
        records: &[Quad],
        chunk: &mut Chunk,
    ) {
        unsafe { super::contacts::<Wide<Avx2>, MODEL, COHESIVE, LEDGER>(law, step, records, chunk) }
    }

    #[target_feature(enable = "avx2,avx512f,avx512vl,avx512dq")]
    pub(super) unsafe fn contacts_512<const MODEL: u8, const COHESIVE: bool, const LEDGER: bool>(
        law: &Coefficients,
        step: f64,
        records: &[Quad],
        chunk: &mut Chunk,
    ) {
        unsafe { super::contacts::<Avx512, MODEL, COHESIVE, LEDGER>(law, step, records, chunk) }
    }

    #[target_feature(enable = "avx2")]
    pub(super) unsafe fn advance<const MODEL: u8, const FIELD: u8>(
        step: f64,
        frames: &Frames,
        records: &mut [Quad],
        inverses: &[[f64; 2]],
        guides: &mut [Quad],
        sums: &[Quad],
    ) -> Moved {
        unsafe { super::advance::<Avx2, MODEL, FIELD>(step, frames, records, inverses, guides, sums) }
    }

    /// Fours too, but with twice as many registers to keep the frames in.
    #[target_feature(enable = "avx2,avx512f,avx512vl,avx512dq")]
    pub(super) unsafe fn advance_512<const MODEL: u8, const FIELD: u8>(
        step: f64,
        frames: &Frames,
        records: &mut [Quad],
        inverses: &[[f64; 2]],
        guides: &mut [Quad],
        sums: &[Quad],
    ) -> Moved {
        unsafe { super::advance::<Avx2, MODEL, FIELD>(step, frames, records, inverses, guides, sums) }
    }
}
