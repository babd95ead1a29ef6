//! An edge (milling cutter, grinding wheel) in a machine.

use crate::ports::{Ports, write};
use crate::workpiece::Blank;
use toolroom_kernel::{Entity, Purpose, SimTime, Streams};
use toolroom_runlog::runlog::{ChangeReason, EdgeRow};
use toolroom_scenario::policies::{Observer, WheelEstimate};
use toolroom_wear::{EdgeScatter, PairScatter, Scatter};

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

/// Owners of what an edge draws, parts of its own name.
pub mod owner {
    /// Sensor noise, numbered by sample.
    pub const SENSORS: u64 = 0;
    /// Wear readings, numbered by pass.
    pub const READINGS: u64 = 1;
    /// Wear noise within the life, numbered by pass.
    pub const WEAR_NOISE: u64 = 2;
    /// Readings of a chatter frequency, numbered by pass.
    pub const CHATTER: u64 = 3;
    /// Life of an edge of which nothing else is known.
    pub const LIFE: u64 = 4;
    /// Noise of the normal force in grinding, numbered by revolution; owned by the operation.
    pub const NORMAL_FORCE: u64 = 3;
}

impl Edge {
    /// Moves the wear noise of the edge to its next pass.
    pub fn draw_noise(&mut self, scatter: &Scatter, streams: &Streams) {
        if scatter.life_noise == 0.0 {
            return; // it stays 0
        }
        let pass = u64::from(self.row.passes);
        let mut stream = streams.at(self.entity.part(owner::WEAR_NOISE), Purpose::Tool, pass);
        self.noise = if pass == 0 {
            scatter.sample_noise(&mut stream)
        } else {
            scatter.next_noise(self.noise, self.row.cutting_time - self.noise_time, &mut stream)
        };
        self.noise_time = self.row.cutting_time;
    }

    /// Writes what is special about edge and work into the input of the process. A process that
    /// does not tell mechanical from thermal wear gets the common factor.
    pub fn write_scatter(&self, scatter: &Scatter, pair: &PairScatter, blank: Blank, ports: &Ports, input: &mut [f64]) {
        let EdgeScatter { wear_factor, mechanical_factor, thermal_factor, chipping_resistance, .. } = self.scatter;
        let noise = scatter.noise_factor(self.noise);
        let common = if ports.mechanical_wear_factor.is_some() { noise } else { noise * wear_factor };
        write(input, ports.mechanical_wear_factor, wear_factor * mechanical_factor);
        write(input, ports.thermal_wear_factor, wear_factor * thermal_factor);
        write(input, ports.wear_rate_factor, common);
        write(input, ports.chipping_resistance, chipping_resistance);
        write(input, ports.flank_shear_factor, pair.flank_shear_factor);
        write(input, ports.flank_pressure_factor, pair.flank_pressure_factor);
        write(input, ports.hardness_ratio, blank.hardness);
        write(input, ports.process_stiffness_factor, blank.hardness);
        write(input, ports.lot_deviation, blank.lot_deviation);
    }
}
