//! Coupled spin and shape evolution of rubble-pile asteroids.
//!
//! The orchestrator: what the user asked for ([`scene`]) and the verbs that carry it out.
//! SI units and `f64` inside; a name that is not SI carries its unit.
#![warn(missing_docs)]

/// Version of this build with the commit of its source: `0.1.0 (commit 0123456789)`.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (commit ", env!("YORP_COMMIT"), ")");

pub mod accuracy;
pub mod classify;
pub mod cli;
pub mod evolve;
pub mod exchange;
pub mod export;
pub mod report;
pub mod scene;
pub mod shed;
pub mod store;
