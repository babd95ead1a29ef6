//! Machines, tools, working time, breakdowns.

use super::{
    Batch, Calibration, Cut, DispatchRule, Distribution, EdgeLife, LifeOnly, Posterior, Spreads, StructureScatter,
    Target, Variants,
};
use std::fmt;
use std::sync::Arc;
use toolroom_calendar::Interruption;
use toolroom_cutting::{Milling, MillingInput, Turning};
use toolroom_form::vocabulary;
use toolroom_infeed::Infeed;
use toolroom_process::{MachineProcess, Process};
use toolroom_wear::{Pair, Scatter, check_tilt};

/// A machine tool.
#[derive(Clone, Debug)]
pub struct MachineType {
    /// Name, unique.
    pub name: String,
    /// Process it can run beside plain work, by [`ProcessModel::name`]; [`PLAIN`](Self::PLAIN) for none.
    pub process: String,
    /// Cost of an hour of machine and operator, currency per second.
    pub rate: f64,
    /// Fastening a part, s.
    pub load_time: Distribution,
    /// Taking it off, s.
    pub unload_time: Distribution,
    /// Changing a worn edge for a new one, s.
    pub tool_change_time: f64,
    /// Change over when the setup group changes, s, unless the operation gives its own.
    pub setup_time: f64,
    /// Index into [`Scenario::setup_matrices`](super::Scenario::setup_matrices): goes before the setup times.
    pub setup_matrix: Option<usize>,
    /// Setup group for which it stands ready at the start, empty for none; `None`: for whatever comes first.
    pub setup_at_start: Option<String>,
    /// Tools, by index, whose edge is worn at the start, and its flank wear, m.
    pub edges_at_start: Vec<(usize, f64)>,
    /// Edges in the magazine before an operator has to refill it. It is full at the start and
    /// gives the first edge of every tool, which is mounted beforehand and costs no time.
    pub magazine: u32,
    /// Refilling the magazine, s.
    pub refill_time: f64,
    /// Least and greatest cutting speed of spindle and program, m/s.
    pub speed_range: (f64, f64),
    /// Power of spindle without cut, W.
    pub idle_power: f64,
    /// When the coolant is changed for another, s; fresh from then on, and `coolant_change` acts.
    pub coolant_change: Option<f64>,
    /// Index into [`Scenario::calendars`](super::Scenario::calendars).
    pub calendar: Option<usize>,
    /// Index into [`Scenario::buffers`](super::Scenario::buffers) of the places before it; `None`: without limit.
    pub input_buffer: Option<usize>,
    /// The same of those behind it; `None`: none, a part stays on the machine until it can move on.
    pub output_buffer: Option<usize>,
    /// Where it stands, for vehicles.
    pub location: String,
    /// How it works on several jobs at once; `None`: on one after the other.
    pub batch: Option<Batch>,
    /// Rules of its queue; `None`: those of the shop.
    pub rules: Option<Vec<DispatchRule>>,
}

impl MachineType {
    /// The word of a machine that runs no process, only plain work.
    pub const PLAIN: &'static str = "plain";

    /// Age of the coolant at `time` of the run, s, and whether it is another than at first.
    pub fn coolant(&self, time: f64) -> (f64, bool) {
        let filled = self.coolant_change.filter(|filled| time >= *filled);
        (time - filled.unwrap_or(0.0), filled.is_some())
    }
}

/// Name of a station: of its machines in the order of the file, runs of three and more that are numbered on as `L1 … L3`.
///
/// # Examples
/// ```
/// let station = |names: &[&str]| toolroom_scenario::station_name(names.iter().copied());
/// assert_eq!(station(&["L1", "L2"]), "L1 + L2");
/// assert_eq!(station(&["saw", "L1", "L2", "L3", "L5"]), "saw + L1 … L3 + L5");
/// ```
pub fn station_name<'a>(machines: impl Iterator<Item = &'a str>) -> String {
    let mut runs: Vec<Vec<&str>> = Vec::new();
    for name in machines {
        let follows = |run: &Vec<&str>| {
            let ((before, last), (prefix, number)) = (numbered(run[run.len() - 1]), numbered(name));
            before == prefix && last.zip(number).is_some_and(|(last, number)| number == last + 1)
        };
        match runs.last_mut().filter(|run| follows(run)) {
            Some(run) => run.push(name),
            None => runs.push(vec![name]),
        }
    }
    let words = |run: &Vec<&str>| match run.as_slice() {
        [first, _, .., last] => format!("{first} … {last}"),
        few => few.join(" + "),
    };
    runs.iter().map(words).collect::<Vec<_>>().join(" + ")
}

/// A name without its number, and that number.
fn numbered(name: &str) -> (&str, Option<u64>) {
    let prefix = name.trim_end_matches(|digit: char| digit.is_ascii_digit());
    (prefix, name[prefix.len()..].parse().ok())
}

/// The process of a tool: parameters and effects of the true world.
#[derive(Clone)]
pub enum ProcessModel {
    /// Turning with this tool and work material.
    Turning(Arc<Turning>),
    /// Milling with this cutter.
    Milling(Arc<Milling>),
    /// Plunge grinding with this wheel.
    Infeed(Arc<Infeed>),
    /// An imported unit in the place of a native process. It takes the inputs that it knows by name
    /// (`cutting_speed`, `feed_per_rev` …); a pass lasts path over cutting speed.
    Other(Arc<dyn MachineProcess>),
}

impl fmt::Debug for ProcessModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("ProcessModel").field(&self.name()).finish()
    }
}

impl ProcessModel {
    /// Name in files: `turning`, `milling`, `infeed`.
    pub fn name(&self) -> &str {
        self.machine_process().name()
    }

    /// Tool and work material of turning.
    pub fn pair(&self) -> Option<&Pair> {
        match self {
            Self::Turning(process) => Some(&process.pair),
            Self::Milling(_) | Self::Infeed(_) | Self::Other(_) => None,
        }
    }

    /// Whether policies choose its cutting speed; grinding runs as programmed, and so does milling beside a lathe
    /// ([`Scenario::commands_speed_of`](crate::Scenario::commands_speed_of)).
    pub fn takes_speed_commands(&self) -> bool {
        match self {
            Self::Turning(_) => true,
            Self::Other(process) => !["milling", LifeOnly::NAME].contains(&process.name()),
            Self::Milling(_) | Self::Infeed(_) => false,
        }
    }

    /// Flank wear at which an edge is spent, m; infinite where the process has no such limit.
    pub fn wear_limit(&self) -> f64 {
        match self {
            Self::Turning(process) => process.pair.limits.wear_limit,
            Self::Milling(process) => process.life.wear_limit,
            Self::Infeed(_) | Self::Other(_) => f64::INFINITY,
        }
    }

    /// How long a new edge without scatter is in cut at the programmed cut until it is spent, s; `None` where the process has
    /// no such life or the edge does not wear out.
    pub fn nominal_life(&self, cut: &Cut) -> Option<f64> {
        let time = match self {
            Self::Turning(process) => {
                let nominal = toolroom_wear::Cut::nominal(cut.cutting_speed, cut.feed, cut.depth_of_cut);
                process.pair.life(&nominal).cutting_time
            }
            Self::Milling(process) => {
                let nominal = MillingInput {
                    cutting_speed: cut.cutting_speed,
                    feed_per_tooth: cut.feed,
                    depth_of_cut: cut.depth_of_cut,
                    width_of_cut: cut.width_of_cut,
                    ..MillingInput::default()
                };
                process.life(&nominal).ok()?.0.cutting_time
            }
            Self::Infeed(_) | Self::Other(_) => return None,
        };
        Some(time).filter(|time| time.is_finite() && *time > 0.0)
    }

    /// Whether it judges the stability of its cuts.
    pub fn has_structure(&self) -> bool {
        match self {
            Self::Turning(process) => process.structure.is_some(),
            Self::Milling(process) => process.structure.is_some(),
            Self::Infeed(_) | Self::Other(_) => false,
        }
    }

    /// The process as the shop drives it, by element index.
    pub fn machine_process(&self) -> &dyn MachineProcess {
        match self {
            Self::Turning(process) => process.as_ref(),
            Self::Milling(process) => process.as_ref(),
            Self::Infeed(process) => process.as_ref(),
            Self::Other(process) => process.as_ref(),
        }
    }
}

/// A kind of tool with its process model.
#[derive(Clone, Debug)]
pub struct ToolType {
    /// Name, unique.
    pub name: String,
    /// True physics where nothing acts that has a scope.
    pub process: ProcessModel,
    /// What it is made of, and its processes where something with a scope acts.
    pub variants: Variants,
    /// Name of the parameter set, for logs.
    pub parameter_set: String,
    /// Cost of one cutting edge (of one dressing for a wheel), currency.
    pub edge_cost: f64,
    /// Dressing time, s; wheels only.
    pub dressing_time: f64,
    /// Scatter of edges, of workpieces and of sensors.
    pub scatter: Scatter,
    /// How the structures of the machines around it differ from its own.
    pub structure_scatter: StructureScatter,
    /// Draws from which each replication takes its parameters; `None`: those of the set.
    pub posterior: Option<Arc<Posterior>>,
    /// How well its parameters are known before records of its own: by the draws, else by `[prior]` of the set.
    pub spreads: Spreads,
    /// How long its edges last in plain work, s of work, where nothing else is known of it ([`LifeOnly`]).
    pub life: Option<EdgeLife>,
}

impl ToolType {
    /// True physics where a set of entries with a scope acts ([`Variants::acting`]).
    pub fn process_of(&self, acting: u32) -> &ProcessModel {
        self.variants.process(acting).unwrap_or(&self.process)
    }

    /// The tool with the parameters of draw number `number` of a study of this seed: the draw takes the place of the set's
    /// values, `parameters` of the file and then calibrations act on it. Without draws the tool itself.
    ///
    /// # Errors
    /// In words: values that contradict each other, a calibration that moves one out of its range.
    pub fn drawn(&self, seed: u64, number: u32, calibrations: &[Calibration]) -> Result<Self, String> {
        let mut tool = self.clone();
        let Some(posterior) = &self.posterior else { return Ok(tool) };
        let mut bare = self.bare().clone();
        posterior.put(posterior.draw(seed, &self.name, number), &mut bare, &mut tool.scatter);
        let checked = match &bare {
            ProcessModel::Turning(process) => process.pair.law.check(),
            ProcessModel::Milling(process) => check_tilt(process.life.stage_contrast, process.life.stage_tilt),
            ProcessModel::Infeed(_) | ProcessModel::Other(_) => Ok(()),
        };
        checked.map_err(|reason| reason.to_string())?;
        let of_tool = |calibration: &&Calibration| {
            calibration.target == Target::Tool(self.name.clone()) && calibration.constant().is_some()
        };
        let constants: Vec<&Calibration> = calibrations.iter().filter(of_tool).collect();
        if constants.is_empty() && self.variants.effects.is_empty() {
            tool.process = bare;
        } else {
            (tool.process, tool.variants) =
                Variants::from_process_model(&bare, self.variants.effects.clone(), &constants)?;
        }
        Ok(tool)
    }

    /// The process of the parameter set, without effects and calibration.
    pub fn bare(&self) -> &ProcessModel {
        self.variants.bare.as_ref().unwrap_or(&self.process)
    }
}

/// A way for a machine to break down.
#[derive(Clone, Debug)]
pub struct FailureMode {
    /// Name, owner of its random numbers; `None`: they belong to its place among those of the machine without a name, by
    /// their mean times.
    pub name: Option<String>,
    /// Index of the machine.
    pub machine: usize,
    /// Time to failure on its clock.
    pub time_between: Distribution,
    /// Time to repair.
    pub time_to_repair: Distribution,
    /// Clock that runs towards the failure.
    pub clock: FailureClock,
    /// Crew that repairs it, by index; `None`: somebody at once.
    pub crew: Option<usize>,
    /// What becomes of the part in the machine.
    pub part: Interruption,
}

vocabulary! {
    /// The clock of a failure mode.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FailureClock {
        /// Only time in which the machine works on a part.
        Busy = "busy",
        /// All time counts.
        Calendar = "calendar",
    }
}
