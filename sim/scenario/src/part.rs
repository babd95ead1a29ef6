//! Parts, routings, arrivals.

use super::{
    Attendance, Component, ContourWork, CycleWork, Distribution, DrawUnit, DueRule, Inspection, MachineChoice, Pegging,
    PieceTimes, ProgramWork, Replenish, WorkPer, WornTool,
};
use std::sync::Arc;

/// A part and its routing.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name, unique.
    pub name: String,
    /// Cost of the blank, lost when the part is scrapped, currency.
    pub material_cost: f64,
    /// Time from arrival to due date, s.
    pub flow_allowance: f64,
    /// Workpieces of one hardness batch; the batch factor is drawn anew after each.
    pub batch_size: u32,
    /// Number, from 1, of the batch from each source on which the effect `lot_hardness` acts.
    pub deviating_lot: Option<u32>,
    /// What goes into one of it, from the stock of finished parts.
    pub components: Vec<Component>,
    /// Which pieces of those it may take.
    pub pegging: Pegging,
    /// What is done about pieces of an order that are lost.
    pub replenish: Replenish,
    /// Whether every job has an order of its own of the operations, drawn when it comes.
    pub random_routing: bool,
    /// Operations in order.
    pub operations: Vec<Operation>,
}

/// Name of a lot of a part in records and scopes: `shaft-2`.
pub fn lot_name(part: &str, lot: u32) -> String {
    format!("{part}-{lot}")
}

impl Part {
    /// 1 for work of the lot that deviates, else 0.
    pub fn lot_deviation(&self, lot: u32) -> f64 {
        f64::from(u8::from(self.deviating_lot == Some(lot)))
    }
}

/// One operation of a routing.
#[derive(Clone, Debug)]
pub struct Operation {
    /// Name, unique within the part.
    pub name: String,
    /// Machines that may do it, by index.
    pub machines: Vec<usize>,
    /// Which of several idle machines takes it; `None`: as everywhere in the shop.
    pub machine_choice: Option<MachineChoice>,
    /// Machines, by index, on which plain work takes another time.
    pub time_on: Vec<(usize, MachineTime)>,
    /// Tool, by index, of a part program the first; `None` for plain work, which has none.
    pub tool: Option<usize>,
    /// Tool of which an edge wears in plain work; `None`: none does.
    pub worn_tool: Option<WornTool>,
    /// Name of the fixture and program family; a change of it costs a setup.
    pub setup_group: String,
    /// Setup time, s; `None`: the machine's.
    pub setup_time: Option<f64>,
    /// The same where it is random; `setup_time` is its mean.
    pub setup_spread: Option<Distribution>,
    /// Skills that it needs.
    pub attendance: Attendance,
    /// What is done.
    pub work: Work,
    /// What takes the time of plain work once.
    pub work_per: WorkPer,
    /// For what its random time is drawn.
    pub draw: DrawUnit,
    /// What may happen when it is done.
    pub inspection: Inspection,
    /// Whether a job of better priority may interrupt it.
    pub preemptible: bool,
    /// Whether it begins only when the components of its part are there, and takes them.
    pub assembles: bool,
    /// Greatest size error of a good part, m. Infinite where it is not looked at.
    pub size_tolerance: f64,
    /// Greatest roughness Ra of a good part, m: of its surface after the last pass. Infinite where
    /// it is not looked at.
    pub roughness_limit: f64,
    /// Share of parts that a broken edge spoils.
    pub scrap_on_tool_failure: f64,
}

impl Operation {
    /// Factor of a machine on the time of plain work.
    pub fn pace_on(&self, machine: usize) -> f64 {
        match self.time_on.iter().find(|(own, _)| *own == machine) {
            Some((_, MachineTime::Factor(factor))) => *factor,
            Some((_, MachineTime::Own(_))) | None => 1.0,
        }
    }

    /// The time of plain work on a machine that has one of its own, s.
    pub fn own_time_on(&self, machine: usize) -> Option<&Distribution> {
        self.time_on.iter().find(|(own, _)| *own == machine).and_then(|(_, time)| match time {
            MachineTime::Own(time) => Some(time),
            MachineTime::Factor(_) => None,
        })
    }

    /// Whether any machine has a time of its own for plain work.
    pub fn has_own_times(&self) -> bool {
        self.time_on.iter().any(|(_, time)| matches!(time, MachineTime::Own(_)))
    }

    /// Mean time of plain work on a machine, s, of a piece, a lot or a batch.
    pub fn mean_time_on(&self, machine: usize) -> f64 {
        self.own_time_on(machine).map_or_else(|| self.work.plain_time() * self.pace_on(machine), Distribution::mean)
    }

    /// What the pieces of a job have to do with its time.
    pub fn piece_times(&self) -> PieceTimes {
        let plain = matches!(self.work, Work::Plain(_));
        match (self.work_per, self.draw) {
            (WorkPer::Lot, _) if plain => PieceTimes::Together,
            (WorkPer::Batch, _) if plain => PieceTimes::OfBatch,
            (WorkPer::Part, DrawUnit::Part) if plain => PieceTimes::Own,
            (WorkPer::Part | WorkPer::Lot | WorkPer::Batch, _) if self.inspection.passes_by() => PieceTimes::Own,
            (WorkPer::Part | WorkPer::Lot | WorkPer::Batch, _) => PieceTimes::Alike,
        }
    }

    /// Tool of a pass, by index: every pass of a part program has its own. Beyond the last pass it is that of the last.
    pub fn tool_of_pass(&self, pass: usize) -> Option<usize> {
        match &self.work {
            Work::Program(work) => work.calls.get(pass).or(work.calls.last()).map(|call| call.tool),
            Work::Plain(_) | Work::Cutting(_) | Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_) => self.tool,
        }
    }
}

/// The time of plain work on a machine on which it is not that of the operation.
#[derive(Clone, Debug, PartialEq)]
pub enum MachineTime {
    /// A factor on the time of the operation.
    Factor(f64),
    /// A time of its own: the rank that was drawn for a job is turned into a time by it.
    Own(Distribution),
}

/// The work of an operation.
#[derive(Clone, Debug)]
pub enum Work {
    /// Nothing that is cut: an operation of which no more is known than its time.
    Plain(Distribution),
    /// Turning or milling passes.
    Cutting(Vec<Cut>),
    /// A plunge grinding cycle.
    Grinding {
        /// Work rotation speed, rad/s.
        work_rotation_speed: f64,
        /// Infeed phases in order; spark-out is a phase of infeed zero.
        phases: Vec<GrindingPhase>,
    },
    /// A plunge grinding cycle designed to limits.
    Cycle(Arc<CycleWork>),
    /// Passes of a mill around a contour.
    Contour(Arc<ContourWork>),
    /// A part program of a mill: its passes are tool calls.
    Program(Arc<ProgramWork>),
}

impl Work {
    /// Expected time of plain work, s; 0 for work that is cut.
    pub fn plain_time(&self) -> f64 {
        match self {
            Self::Plain(time) => time.mean(),
            Self::Cutting(_) | Self::Grinding { .. } | Self::Cycle(_) | Self::Contour(_) | Self::Program(_) => 0.0,
        }
    }

    /// Number of passes or phases; plain work has none.
    pub fn passes(&self) -> usize {
        match self {
            Self::Plain(_) => 0,
            Self::Cutting(cuts) => cuts.len(),
            Self::Grinding { phases, .. } => phases.len(),
            Self::Cycle(_) => CycleWork::PHASES,
            Self::Contour(work) => work.passes.len(),
            Self::Program(work) => work.calls.len(),
        }
    }
}

/// One pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cut {
    /// Programmed cutting speed, m/s.
    pub cutting_speed: f64,
    /// Feed per revolution (turning) or per tooth (milling), m.
    pub feed: f64,
    /// Depth of cut a_p, m.
    pub depth_of_cut: f64,
    /// Width of cut a_e (milling), m; unused in turning.
    pub width_of_cut: f64,
    /// Cutting path of the edge through the material (turning: π·d·l/f) or path of the
    /// cutter axis (milling), m.
    pub path_length: f64,
    /// Diameter of the work (turning), m; 0 where only the path is given.
    pub diameter: f64,
    /// Place of the tool from the jaws at the start (turning), m; it moves towards them. 0 where the
    /// structure's own counts.
    pub position: f64,
}

/// Revolutions at one infeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrindingPhase {
    /// Infeed per revolution, m.
    pub infeed_per_rev: f64,
    /// Whole revolutions.
    pub revolutions: u32,
}

/// A source of jobs.
#[derive(Clone, Debug)]
pub struct Arrival {
    /// Its own name, by which it draws; `None`: it draws by its place among the sources without one.
    pub name: Option<String>,
    /// Its parts, by index, each with its share of the jobs; the shares add up to 1.
    pub parts: Vec<(usize, f64)>,
    /// Pieces of a job, drawn for each and rounded to a whole number from 1 on.
    pub quantity: Distribution,
    /// The smaller, the more urgent.
    pub priority: u32,
    /// Weight of their lateness in weighted rules, 1.
    pub weight: f64,
    /// When they are due.
    pub due: DueRule,
    /// When they come.
    pub pattern: ArrivalPattern,
}

impl Arrival {
    /// A source of single pieces of one part, due by its allowance.
    pub fn from_part(part: usize, pattern: ArrivalPattern) -> Self {
        let (quantity, due) = (Distribution::Constant(1.0), DueRule::Allowance);
        Self { name: None, parts: vec![(part, 1.0)], quantity, priority: 0, weight: 1.0, due, pattern }
    }

    /// Names of its parts, `ring + shaft`.
    pub fn parts_named(&self, parts: &[Part]) -> String {
        self.parts.iter().map(|(part, _)| parts[*part].name.as_str()).collect::<Vec<_>>().join(" + ")
    }

    /// Whether jobs of a part come from it.
    pub fn brings(&self, part: usize) -> bool {
        self.parts.iter().any(|(own, _)| *own == part)
    }
}

/// When jobs come.
#[derive(Clone, Debug)]
pub enum ArrivalPattern {
    /// At these times, s, so many each.
    Schedule(Vec<(f64, u32)>),
    /// One after the other, the times between them drawn independently; the first comes after one of them.
    Renewal(Distribution),
    /// Poisson process.
    Poisson {
        /// Jobs per second.
        rate: f64,
    },
    /// Lots at a fixed interval, the first at time zero.
    Batch {
        /// Time between lots, s.
        interval: f64,
        /// Jobs in a lot.
        size: u32,
    },
    /// So many jobs kept in the shop: a new one enters when one leaves.
    ConstantWork {
        /// Jobs in the shop.
        jobs: u32,
    },
}
