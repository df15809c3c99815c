//! Coupled spin and shape evolution of rubble-pile asteroids.
