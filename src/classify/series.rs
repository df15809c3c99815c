//! A run as a series of stretches of evolution, each with one shape.

use crate::evolve::rigid::REV_PER_DAY;

/// Evolution of spin and obliquity over some time with one shape: a leg, or all legs between two movements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Start and end, s.
    pub t_s: [f64; 2],
    /// Spin rate at start and end, rad/s.
    pub omega: [f64; 2],
    /// Obliquity at start and end, rad.
    pub obliquity: [f64; 2],
    /// Number of the shape.
    pub configuration: u32,
}

impl Segment {
    /// Its length, s.
    pub fn duration_s(&self) -> f64 {
        self.t_s[1] - self.t_s[0]
    }
}

/// Joins segments that follow each other with the same shape into the intervals between two movements.
///
/// # Examples
/// ```
/// use yorp::classify::{Segment, intervals};
/// let leg = |t: f64, configuration| Segment { t_s: [t, t + 1.0], omega: [t, t + 1.0], obliquity: [0.1; 2], configuration };
/// let joined = intervals(&[leg(0.0, 0), leg(1.0, 0), leg(2.0, 1)]);
/// assert_eq!((joined.len(), joined[0].t_s, joined[0].omega), (2, [0.0, 2.0], [0.0, 2.0]));
/// ```
pub fn intervals(segments: &[Segment]) -> Vec<Segment> {
    let same = |a: &Segment, b: &Segment| a.configuration == b.configuration;
    let join = |run: &[Segment]| {
        let (first, last) = (run[0], run[run.len() - 1]);
        Segment {
            t_s: [first.t_s[0], last.t_s[1]],
            omega: [first.omega[0], last.omega[1]],
            obliquity: [first.obliquity[0], last.obliquity[1]],
            configuration: first.configuration,
        }
    };
    segments.chunk_by(same).map(join).collect()
}

/// One of the two numbers that are classified apart from each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Spin rate, in revolutions a day where it is shown.
    Spin,
    /// Obliquity, in degrees where it is shown.
    Obliquity,
}

impl Quantity {
    /// Its values at a segment's start and end: revolutions a day, or degrees.
    pub fn of(self, segment: &Segment) -> [f64; 2] {
        match self {
            Self::Spin => segment.omega.map(|omega| omega / REV_PER_DAY),
            Self::Obliquity => segment.obliquity.map(f64::to_degrees),
        }
    }
}
