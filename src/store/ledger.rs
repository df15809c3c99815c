//! Where the time of a session goes: wall and CPU seconds and a count for each part of the loop.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

/// A part of a run whose cost is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Construction of the aggregate.
    Build,
    /// Settling of object 0.
    Settle,
    /// Dynamics after a change of spin, no sphere moved.
    Check,
    /// Dynamics after a change of spin, spheres moved.
    Movement,
    /// Torque tables.
    Torque,
    /// Tiling and re-tiling.
    Tiling,
    /// Integration of spin and obliquity.
    Spin,
    /// Transactions.
    Store,
}

impl Part {
    /// All parts in the order of the loop.
    pub const ALL: [Self; 8] =
        [Self::Build, Self::Settle, Self::Check, Self::Movement, Self::Torque, Self::Tiling, Self::Spin, Self::Store];

    /// Name in the database and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Build => "build",
            Self::Settle => "settle",
            Self::Check => "check",
            Self::Movement => "movement",
            Self::Torque => "torque",
            Self::Tiling => "tiling",
            Self::Spin => "spin",
            Self::Store => "store",
        }
    }
}

/// Accumulated cost of one part.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PartTotal {
    /// Wall time, s.
    pub seconds: f64,
    /// CPU time of the process, s.
    pub cpu_seconds: f64,
    /// How often it ran.
    pub count: u64,
}

/// Times the parts of one session.
#[derive(Debug)]
pub struct Ledger {
    start: (Instant, ProcessTime),
    parts: BTreeMap<Part, PartTotal>,
}

/// A running measurement; ends at [`Ledger::stop`].
#[derive(Debug)]
pub struct Stopwatch(Instant, ProcessTime);

impl Stopwatch {
    /// Starts measuring.
    pub fn start() -> Self {
        Self(Instant::now(), ProcessTime::now())
    }
}

impl Default for Ledger {
    fn default() -> Self {
        Self { start: (Instant::now(), ProcessTime::now()), parts: BTreeMap::new() }
    }
}

impl Ledger {
    /// Books the time since `watch` was started to `part`.
    pub fn stop(&mut self, part: Part, watch: Stopwatch) {
        self.add(part, watch.0.elapsed(), watch.1.elapsed());
    }

    /// Runs `work` and books its time to `part`.
    pub fn time<T>(&mut self, part: Part, work: impl FnOnce() -> T) -> T {
        let watch = Stopwatch::start();
        let result = work();
        self.stop(part, watch);
        result
    }

    fn add(&mut self, part: Part, wall: Duration, cpu: Duration) {
        let total = self.parts.entry(part).or_default();
        total.seconds += wall.as_secs_f64();
        total.cpu_seconds += cpu.as_secs_f64();
        total.count += 1;
    }

    /// Wall and CPU seconds since the session began.
    pub fn elapsed(&self) -> (f64, f64) {
        (self.start.0.elapsed().as_secs_f64(), self.start.1.elapsed().as_secs_f64())
    }

    /// Cost of the parts that ran, in the order of the loop.
    pub fn parts(&self) -> impl Iterator<Item = (Part, PartTotal)> {
        self.parts.iter().map(|(part, total)| (*part, *total))
    }
}
