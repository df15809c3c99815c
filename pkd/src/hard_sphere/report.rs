//! What an integration of hard spheres reports: how often which rule decided a collision, and how much work it was.

/// Collisions by the rule that chose their restitution, and the work done to find them.
///
/// The first group adds up: `collisions = nominal + slide + collapse + capped`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CollisionCounts {
    /// Collisions resolved.
    pub collisions: u64,
    /// Resolved with the nominal restitution.
    pub nominal: u64,
    /// Resolved without loss by the slide limit.
    pub slide: u64,
    /// Resolved without loss by the limit on inelastic collapse.
    pub collapse: u64,
    /// Resolved without loss because a sphere had used up its collisions of the step.
    pub capped: u64,
    /// Those of them that turned out to recede: grazes at round-off, nothing was changed.
    pub grazes: u64,
    /// Predictions repeated because the partner had collided with another sphere in the meantime.
    pub repredictions: u64,
    /// Times the neighbour lists were made, at least once a step.
    pub list_rebuilds: u64,
}

impl CollisionCounts {
    /// Adds the counts of another stretch of the run.
    pub fn add(&mut self, other: &Self) {
        self.collisions += other.collisions;
        self.nominal += other.nominal;
        self.slide += other.slide;
        self.collapse += other.collapse;
        self.capped += other.capped;
        self.grazes += other.grazes;
        self.repredictions += other.repredictions;
        self.list_rebuilds += other.list_rebuilds;
    }
}

/// What happened in one or several steps.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Report {
    /// Steps taken.
    pub steps: u64,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Collisions and work.
    pub counts: CollisionCounts,
    /// Deepest overlap seen, as a fraction of the smaller radius of the pair; round-off in a healthy run.
    pub max_overlap_over_radius: f64,
}

impl Report {
    /// Adds a later stretch of the same run.
    pub fn add(&mut self, later: &Self) {
        self.steps += later.steps;
        self.duration_s += later.duration_s;
        self.counts.add(&later.counts);
        self.max_overlap_over_radius = self.max_overlap_over_radius.max(later.max_overlap_over_radius);
    }
}
