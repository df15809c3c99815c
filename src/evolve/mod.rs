//! The coupled evolution of spin and shape: the hand-off loop and its parts.
//!
//! [`driver::run`] hands the body back and forth between radiation and dynamics; the other modules are what it is made of.

pub mod aggregate;
pub mod alignment;
mod blame;
pub mod block;
pub mod build;
pub mod check;
pub mod configuration;
pub mod driver;
pub mod engine;
mod error;
pub mod fate;
pub mod movement;
mod observer;
pub mod relax;
pub mod reshaping;
pub mod rigid;
pub mod settling;
pub mod shedding;
pub mod spin;

pub use error::EvolveError;
pub use observer::{Observer, Progress, Silent};
