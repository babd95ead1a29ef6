//! A cycle in the search for the fastest one, and what that is sought for.

use super::CycleLimits;
use super::surface::Roughness;
use crate::{Infeed, Input, State};

/// Revolutions beyond which no cycle is sought.
pub(super) const LONGEST: u32 = 100_000;

/// A cycle in the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub rough_infeed: f64,
    pub finish_infeed: f64,
    pub rough: u32,
    pub finish: u32,
    pub spark_out: u32,
    pub last_depth: f64,
}

impl Candidate {
    /// Revolutions of all phases.
    pub fn revolutions(&self) -> u32 {
        self.rough + self.finish + self.spark_out
    }
}

/// What a cycle is sought for.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub grinding: &'a Infeed,
    pub wheel: &'a State,
    pub input: &'a Input,
    pub limits: &'a CycleLimits,
    pub roughness: Option<&'a Roughness>,
}

impl Task<'_> {
    /// Roughness under infeed at a depth of cut, m; nothing where no roughness is known.
    pub fn roughness_under(&self, depth: f64) -> f64 {
        let p = &self.grinding.parameters;
        let removal_rate = 0.5 * self.input.work_rotation_speed * p.work_diameter * depth;
        self.roughness.map_or(0.0, |roughness| roughness.under_infeed(removal_rate, p.wheel_speed))
    }
}
