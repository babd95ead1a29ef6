//! What a controller is made of, for whoever builds the same one elsewhere.

use super::observer::{LAND_ERROR, noise};
use super::{ChangeRule, Controller, Speed};
use crate::{Knowledge, SensorSheet};
use std::sync::Arc;
use toolroom_wear::{Cut, ObserverNoise, Pair, SpeedLaw};

/// How a controller finds its speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpeedSetting {
    /// One speed, m/s.
    Fixed(f64),
    /// Speed against the path that the edge has cut.
    Schedule,
    /// A law of speed against wear, times a factor.
    Law(SpeedLaw, f64),
    /// The wear left shared out over the path left of so many metres an edge; and a factor on the speed.
    PathPerEdge(f64, f64),
}

/// The controller of one cut on one machine, worked out.
#[derive(Clone, Debug)]
pub struct Settings<'a> {
    /// How it finds its speed.
    pub speed: SpeedSetting,
    /// When it changes an edge.
    pub change: ChangeRule,
    /// Limits that no command leaves, m/s.
    pub range: (f64, f64),
    /// What it is shown of the edge.
    pub knows: Knowledge,
    /// What it believes of tool and work, its speed limits narrowed to the machine's, and the cut as programmed.
    pub believed: Option<(&'a Pair, &'a Cut)>,
    /// Path of a pass as programmed, m; 0 where it believes nothing.
    pub path: f64,
    /// What the filter of a new edge reckons with; `None` where wear is not estimated.
    pub noise: Option<ObserverNoise>,
    /// Error of a flank wear reading that the filter reckons with, m.
    pub reading_error: f64,
    /// Whether it does something about chatter.
    pub acts_on_chatter: bool,
    /// Its sensors.
    pub sensors: &'a SensorSheet,
}

impl Controller {
    /// What this controller is made of.
    pub fn settings(&self) -> Settings<'_> {
        let read = self.reading_limit().is_some();
        let watching = self.believed.as_ref().filter(|_| self.observes);
        Settings {
            speed: match &self.speed {
                Speed::Fixed(speed) => SpeedSetting::Fixed(*speed),
                Speed::Schedule(_) => SpeedSetting::Schedule,
                Speed::Planned(planned) => SpeedSetting::Law(planned.law, planned.factor),
                Speed::SetIncrement(set) => SpeedSetting::PathPerEdge(set.path_per_edge, set.factor),
            },
            change: self.change,
            range: self.range,
            knows: self.knows,
            believed: self.believed.as_ref().map(|believed| (Arc::as_ref(&believed.pair), &believed.cut)),
            path: self.believed.as_ref().map_or(0.0, |believed| believed.path),
            noise: watching.map(|believed| noise(believed, &self.sensors, read)),
            reading_error: self.sensors.flank_wear.hypot(LAND_ERROR),
            acts_on_chatter: self.stability.is_some(),
            sensors: &self.sensors,
        }
    }
}
