//! What chance decides about edges and work, keyed so that it is the same under every policy.

use super::job::Job;
use super::layout::Layout;
use rand::RngExt;
use rand_distr::{Distribution as _, StandardNormal};
use toolroom_cuts::workpiece::Blank;
use toolroom_kernel::{Entity, Purpose, Stream, Streams};
use toolroom_scenario::{Arrival, Operation, Part, Scenario, StructureScatter, Work};
use toolroom_wear::{EdgeScatter, PairScatter, Scatter};

/// Owner of the pieces of an order, part of the order's own name: apart from the parts by which its
/// operations are numbered.
pub(super) const PIECES: u64 = 1 << 41;

/// Times of plain work of the jobs of a source that are of one part. They are drawn for some jobs at once: an operation has a stream of its own, so
/// that it makes no difference when it draws, and the streams of a large shop do not fit into the nearest memory together.
#[derive(Clone, Debug)]
pub(super) struct Ranks {
    /// The part.
    pub part: usize,
    /// Operations with plain work in which the pieces of a job or the laws of machines differ, and their streams.
    pub apart: Vec<(usize, Stream)>,
    /// The other operations with plain work; apart from their streams, which are large.
    together: Vec<usize>,
    /// Streams of these.
    streams: Vec<Stream>,
    /// Times of the jobs to come, s, those of a job together.
    times: Vec<f64>,
    /// Jobs of them that have come.
    used: usize,
    /// Jobs for which times are drawn the next time.
    jobs: usize,
}

/// Most jobs for which times are drawn at once. The first few times it is fewer, so that no source draws for more than twice
/// the jobs that it has.
const MOST_JOBS: usize = 16;

impl Ranks {
    /// One stream for every operation with plain work of every part of a source. They belong to the names of part and operation
    /// and to the name of the source or, without one, its place among those of the part, so that other parts and sources change
    /// nothing.
    pub fn from_scenario(scenario: &Scenario, layout: &Layout, streams: &Streams, source: usize) -> Vec<Self> {
        let of_part = |&(number, _): &(usize, f64)| {
            let unnamed = |other: &&Arrival| other.name.is_none() && other.brings(number);
            let place = scenario.arrivals[..source].iter().filter(unnamed).count() as u64;
            let part = &scenario.parts[number];
            let stream = |operation: &Operation| {
                let work = format!("{}/{}", part.name, operation.name);
                let owner = match &scenario.arrivals[source].name {
                    Some(name) => Entity::named(&format!("{work} of {name}")),
                    None => Entity::named(&work).part(place),
                };
                streams.open(owner, Purpose::Processing)
            };
            let plain =
                part.operations.iter().enumerate().filter(|(_, operation)| matches!(operation.work, Work::Plain(_)));
            let (apart, others): (Vec<_>, Vec<_>) =
                plain.map(|(index, operation)| (index, stream(operation))).partition(|(index, _)| {
                    let plan = &layout.operations[number][*index];
                    plan.apart || plan.own_times
                });
            let (together, streams) = others.into_iter().unzip();
            Self { part: number, apart, together, streams, times: Vec::new(), used: 0, jobs: 1 }
        };
        scenario.arrivals[source].parts.iter().map(of_part).collect()
    }

    /// Times of the next job for operations with plain work alike for all its pieces, s, into `drawn`, which has a place for
    /// every operation; `operations` are those of its part.
    #[inline]
    pub fn next(&mut self, operations: &[Operation], drawn: &mut [f64]) {
        let count = self.streams.len();
        if self.used * count == self.times.len() && count > 0 {
            self.draw(operations);
        }
        let first = self.used * count;
        self.used += 1;
        let times = &self.times[first..first + count];
        if self.together.last().is_none_or(|last| last + 1 == count) {
            drawn[..count].copy_from_slice(times); // all operations from the first on
        } else {
            self.together.iter().zip(times).for_each(|(operation, time)| drawn[*operation] = *time);
        }
    }

    fn draw(&mut self, operations: &[Operation]) {
        let (count, jobs) = (self.streams.len(), self.jobs);
        self.times.resize(jobs * count, 0.0);
        for (place, (operation, stream)) in self.together.iter().zip(&mut self.streams).enumerate() {
            if let Work::Plain(time) = &operations[*operation].work {
                self.times.iter_mut().skip(place).step_by(count).for_each(|drawn| *drawn = time.sample(stream));
            }
        }
        (self.used, self.jobs) = (0, (2 * jobs).min(MOST_JOBS));
    }
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

/// Owner of the structure about a tool, part of the name of machine and tool: apart from the edges, which are numbered.
const STRUCTURE: u64 = 1 << 45;

/// An edge as it comes out of the box.
pub(super) fn edge(scatter: &Scatter, streams: &Streams, entity: Entity) -> EdgeScatter {
    scatter.sample_edge(&mut streams.open(entity, Purpose::Tool))
}

/// How the land's stresses of a tool differ from its parameter set.
pub(super) fn pair(scatter: &Scatter, streams: &Streams, tool: &str) -> PairScatter {
    scatter.sample_pair(&mut streams.open(Entity::named(tool), Purpose::Tool))
}

/// A workpiece of `job`, hardness drawn for its lot and for itself.
pub(super) fn blank(scatter: &Scatter, streams: &Streams, job: &Job, part: &Part) -> Blank {
    let lot_deviation = part.lot_deviation(job.row.lot);
    if scatter.batch_hardness == 0.0 && scatter.piece_hardness == 0.0 {
        return Blank { hardness: 1.0, lot_deviation }; // what is drawn would change nothing
    }
    let lot = scatter.sample_batch_hardness(&mut streams.at(job.lot_owner, Purpose::Workpiece, job.lot));
    let hardness = scatter.sample_piece_hardness(lot, &mut streams.open(job.entity, Purpose::Workpiece));
    Blank { hardness, lot_deviation }
}

/// Depth of cut of a pass with its allowance; `operation` is a part of the job's name.
pub(super) fn depth(scatter: &Scatter, streams: &Streams, operation: Entity, pass: u32, nominal: f64) -> f64 {
    if scatter.allowance == 0.0 {
        return nominal;
    }
    scatter.sample_depth(nominal, &mut streams.at(operation, Purpose::Workpiece, u64::from(pass)))
}

/// Factors of a machine on the natural frequencies and damping ratios of its structure about a
/// tool; lognormal. Both together are the owner.
pub(super) fn structure(scatter: &StructureScatter, streams: &Streams, owner: Entity) -> (f64, f64) {
    let mut stream = streams.open(owner.part(STRUCTURE), Purpose::Tool);
    let mut factor = |deviation: f64| {
        let z: f64 = StandardNormal.sample(&mut stream);
        let sigma = deviation.mul_add(deviation, 1.0).ln().sqrt();
        (sigma * z - 0.5 * sigma * sigma).exp()
    };
    (factor(scatter.natural_frequency), factor(scatter.damping_ratio).clamp(0.1, 10.0))
}
