//! What can go wrong with an aggregate.

/// Why an aggregate was refused or its integration stopped.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PkdError {
    /// No sphere at all.
    #[error("an aggregate needs at least one sphere")]
    Empty,
    /// A value that is not finite, or a mass or radius that is not positive.
    #[error("sphere {sphere}: {column} is {value}, which must be finite{}", if matches!(*column, "mass" | "radius") { " and positive" } else { "" })]
    BadValue {
        /// Row of the sphere, from 0.
        sphere: usize,
        /// Which quantity.
        column: &'static str,
        /// The value found.
        value: f64,
    },
    /// A parameter outside its allowed range.
    #[error("{name} is {value}, allowed: {allowed}")]
    BadParameter {
        /// Which parameter.
        name: &'static str,
        /// The value found.
        value: f64,
        /// What would be accepted, in words.
        allowed: &'static str,
    },
    /// A derived quantity that left the range of `f64`.
    #[error("the {quantity} of the aggregate is not finite: coordinates or masses are out of range")]
    NotFinite {
        /// Which quantity.
        quantity: &'static str,
    },
    /// Spheres that reach into each other.
    #[error("spheres {first} and {second} overlap by {fraction:e} of the smaller radius at {time_s} s")]
    Overlap {
        /// One of them.
        first: usize,
        /// The other.
        second: usize,
        /// Depth over the smaller radius.
        fraction: f64,
        /// Time since the start of the call, s.
        time_s: f64,
    },
    /// Two spheres at the same place: no direction to push them apart in.
    #[error("spheres {first} and {second} have the same centre")]
    Coincident {
        /// One of them.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A time step that does not resolve the contacts of soft spheres.
    #[error("a step of {step_s} s is too long for the stiffness of the contacts: at most {limit_s} s")]
    StepTooLarge {
        /// The step asked for, s.
        step_s: f64,
        /// The longest that would be accepted, s.
        limit_s: f64,
    },
    /// Soft spheres pressed into each other deeper than allowed.
    #[error(
        "spheres {first} and {second} overlap by {fraction:.4} of the smaller radius at {time_s} s, more than {limit}: \
         the contacts are too soft; raise the expected speed or the normal stiffness, or allow deeper overlaps"
    )]
    TooSoft {
        /// One of them.
        first: usize,
        /// The other.
        second: usize,
        /// Depth over the smaller radius.
        fraction: f64,
        /// Deepest allowed.
        limit: f64,
        /// Time since the start of the call, s.
        time_s: f64,
    },
    /// Contacts that do not belong to the spheres they are used with.
    #[error("contact of spheres {first} and {second}: {reason}")]
    BadContact {
        /// One of them.
        first: usize,
        /// The other.
        second: usize,
        /// What is wrong, in words.
        reason: &'static str,
    },
    /// An integration that left the range of `f64`.
    #[error("sphere {sphere}: {quantity} is no longer finite at {time_s} s")]
    BecameNonFinite {
        /// Row of the sphere, from 0.
        sphere: usize,
        /// Which quantity.
        quantity: &'static str,
        /// Time since the start of the call, s.
        time_s: f64,
    },
    /// Collisions that do not end.
    #[error("sphere {sphere} has collided {collisions} times within one step at {time_s} s")]
    CollisionRunaway {
        /// Row of the sphere, from 0.
        sphere: usize,
        /// Its collisions in the step.
        collisions: u32,
        /// Time since the start of the call, s.
        time_s: f64,
    },
    /// Random spheres that could not be freed of their overlaps in the space given to them.
    #[error("{spheres} spheres do not fit their container without overlaps: lower the packing fraction")]
    PackingTooDense {
        /// How many spheres.
        spheres: usize,
    },
    /// The caller asked to stop.
    #[error("stopped on request")]
    Stopped,
}
