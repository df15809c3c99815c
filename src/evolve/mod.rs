//! Evolution of spin and shape: the spin equations, the detection of movement, and the frames between objects.

pub mod movement;
pub mod orientation;
pub mod rigid;
pub mod spin;
