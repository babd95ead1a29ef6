//! What chance decides about edges and work, keyed so that it is the same under every policy.

use super::edge::Edge;
use super::job::Job;
use super::ports::{Ports, write};
use rand::RngExt;
use rand_distr::{Distribution as _, StandardNormal};
use toolroom_kernel::{Entity, Purpose, Stream, Streams};
use toolroom_scenario::{Operation, Part, Scenario, StructureScatter, Work};
use toolroom_wear::{EdgeScatter, PairScatter, Scatter};

/// Owners of what an edge draws, parts of its own name.
pub(super) mod owner {
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

/// Owner of the pieces of an order, part of the order's own name: apart from the parts by which its
/// operations are numbered.
pub(super) const PIECES: u64 = 1 << 41;

/// Streams of the ranks of a source: one for every operation of its part with plain work. They belong to
/// the names of part and operation and to the place of the source among those of the part, so that other
/// parts and sources change nothing.
pub(super) fn ranks(scenario: &Scenario, streams: &Streams, source: usize) -> Vec<(usize, usize, Stream)> {
    let parts = scenario.arrivals[source].parts.iter();
    parts.flat_map(|(part, _)| ranks_of(scenario, streams, source, *part)).collect()
}

fn ranks_of(scenario: &Scenario, streams: &Streams, source: usize, part: usize) -> Vec<(usize, usize, Stream)> {
    let number = part;
    let place = scenario.arrivals[..source].iter().filter(|other| other.brings(part)).count() as u64;
    let part = &scenario.parts[part];
    let stream = |operation: &Operation| {
        let owner = Entity::named(&format!("{}/{}", part.name, operation.name)).part(place);
        streams.open(owner, Purpose::Processing)
    };
    let plain = part.operations.iter().enumerate().filter(|(_, operation)| matches!(operation.work, Work::Plain(_)));
    plain.map(|(index, operation)| (number, index, stream(operation))).collect()
}

/// Owners of what is drawn for a job of a source when it comes, parts of its own name: its part, its pieces, its due date.
pub(super) const PART: u64 = 1 << 44;
pub(super) const QUANTITY: u64 = PART + 1;
pub(super) const DUE: u64 = PART + 2;

/// Owner of the order in which a job goes through its operations, part of its own name.
const ROUTE: u64 = 1 << 43;

/// The order in which a job goes through the operations of a part without fixed routing: every one is as likely.
pub(super) fn route(streams: &Streams, entity: Entity, operations: usize) -> Box<[u16]> {
    let mut stream = streams.open(entity.part(ROUTE), Purpose::Arrival);
    let mut route: Vec<u16> = (0..operations as u16).collect();
    for place in (1..operations).rev() {
        let rank: f64 = stream.random();
        route.swap(place, (rank * (place + 1) as f64) as usize);
    }
    route.into_boxed_slice()
}

/// An edge as it comes out of the box.
pub(super) fn edge(scatter: &Scatter, streams: &Streams, entity: Entity) -> EdgeScatter {
    scatter.sample_edge(&mut streams.open(entity, Purpose::Tool))
}

/// How the land's stresses of a tool differ from its parameter set.
pub(super) fn pair(scatter: &Scatter, streams: &Streams, tool: &str) -> PairScatter {
    scatter.sample_pair(&mut streams.open(Entity::named(tool), Purpose::Tool))
}

/// A workpiece as it came.
#[derive(Clone, Copy, Debug)]
pub struct Blank {
    /// Hardness against nominal: that of its lot and its own.
    pub hardness: f64,
    /// 1 in the lot that deviates, else 0.
    pub lot_deviation: f64,
}

/// A workpiece of `job`, hardness drawn for its lot and for itself.
pub(super) fn blank(scatter: &Scatter, streams: &Streams, job: &Job, part: &Part) -> Blank {
    let lot = scatter.sample_batch_hardness(&mut streams.at(job.lot_owner, Purpose::Workpiece, job.lot));
    let hardness = scatter.sample_piece_hardness(lot, &mut streams.open(job.entity, Purpose::Workpiece));
    Blank { hardness, lot_deviation: part.lot_deviation(job.row.lot) }
}

/// Depth of cut of a pass with its allowance; `operation` is a part of the job's name.
pub(super) fn depth(scatter: &Scatter, streams: &Streams, operation: Entity, pass: u32, nominal: f64) -> f64 {
    if scatter.allowance == 0.0 {
        return nominal;
    }
    scatter.sample_depth(nominal, &mut streams.at(operation, Purpose::Workpiece, u64::from(pass)))
}

/// Factors of a machine on the natural frequencies and damping ratios of its structure about
/// `tool`; lognormal.
pub(super) fn structure(scatter: &StructureScatter, streams: &Streams, machine: Entity, tool: usize) -> (f64, f64) {
    let mut stream = streams.open(machine.part(1 << 33 | tool as u64), Purpose::Tool);
    let mut factor = |deviation: f64| {
        let z: f64 = StandardNormal.sample(&mut stream);
        let sigma = deviation.mul_add(deviation, 1.0).ln().sqrt();
        (sigma * z - 0.5 * sigma * sigma).exp()
    };
    (factor(scatter.natural_frequency), factor(scatter.damping_ratio).clamp(0.1, 10.0))
}

impl Edge {
    /// Moves the wear noise of the edge to its next pass.
    pub(super) fn draw_noise(&mut self, scatter: &Scatter, streams: &Streams) {
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
    pub(super) fn write_scatter(
        &self,
        scatter: &Scatter,
        pair: &PairScatter,
        blank: Blank,
        ports: &Ports,
        input: &mut [f64],
    ) {
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
