//! An edge (milling cutter, grinding wheel) in a machine.

use crate::runlog::{ChangeReason, EdgeRow};
use toolroom_kernel::{Entity, SimTime};
use toolroom_scenario::policies::{Observer, WheelEstimate};
use toolroom_wear::EdgeScatter;

/// One cutting edge with its process state.
#[derive(Clone, Debug)]
pub struct Edge {
    /// Number in the order of mounting; row of the log.
    pub number: u32,
    /// Who draws for it: machine, tool and how many edges of it came before; the same under
    /// every policy.
    pub entity: Entity,
    /// What the log will say.
    pub row: EdgeRow,
    /// State of the process at `clock`.
    pub state: Vec<f64>,
    /// Time to which `state` belongs.
    pub clock: SimTime,
    /// How it differs from nominal.
    pub scatter: EdgeScatter,
    /// Its wear noise at present, 0 on average.
    pub noise: f64,
    /// Cutting time on the edge when the noise was drawn, s.
    pub noise_time: f64,
    /// Why it has to leave, once that is known.
    pub change_reason: Option<ChangeReason>,
    /// What the controller knows about it.
    pub observer: Option<Observer>,
    /// What the force told about a wheel since it was dressed.
    pub wheel: WheelEstimate,
    /// Sensor samples taken: index of the next noise.
    pub samples: u64,
    /// Whether it had cut before the run began.
    pub worn_at_start: bool,
    /// Speed at the end of its last pass, m/s.
    pub last_speed: Option<f64>,
    /// Plain work that it still does, s; infinite where a process says how it wears.
    pub life_left: f64,
    /// Whether the crib has it back already, although no other is mounted yet.
    pub given_back: bool,
}
