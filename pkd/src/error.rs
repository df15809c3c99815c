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
}
