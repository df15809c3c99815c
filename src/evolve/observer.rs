//! How a run tells the outside world where it stands, and how the outside world asks it to stop.

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// The aggregate is being constructed.
    Building {
        /// Stretches of compaction done, over all attempts.
        stretches: u32,
    },
    /// One rotation of settling is done.
    Settling {
        /// Rotations done.
        rotations: f64,
    },
    /// A leg is done, or one rotation within its check.
    Evolving {
        /// Evolution time, s.
        t_s: f64,
        /// Time at which this run ends, s.
        end_s: f64,
        /// Spin rate, rad/s.
        omega: f64,
        /// Obliquity, rad.
        obliquity: f64,
        /// Legs done.
        legs: u32,
        /// Movements among them.
        movements: u32,
    },
}

/// Receives progress and may ask for an early end.
pub trait Observer {
    /// Called after each rotation of dynamics and each leg.
    fn progress(&mut self, progress: Progress);
    /// Asked after each rotation of dynamics; `true` ends the run with [`super::EvolveError::Interrupted`].
    fn interrupted(&self) -> bool;
    /// Something the user should know, that is no error.
    fn warn(&mut self, message: &str);
}

/// An observer that neither listens nor stops.
#[derive(Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn progress(&mut self, _: Progress) {}
    fn interrupted(&self) -> bool {
        false
    }
    fn warn(&mut self, _: &str) {}
}
