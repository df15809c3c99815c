//! Heat that the ground stores from day to night: conduction, and what it does to torque and force.

#![allow(dead_code)]

pub(crate) mod balance;
pub(crate) mod conduction;
pub(crate) mod insolation;
