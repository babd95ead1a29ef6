//! Baselines, plans, front, conditions and scatter of every pass.

use super::input::Task;
use crate::args::ContourArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_contour::{
    ConditionScatter, ContourError, EdgeLife, Objective, Pass, Plan, PlannedSection, Planner, Sensitivity, Warning,
};
use toolroom_planning::contour::{Condition, OBJECTIVES, conditions};
use toolroom_process::unit;

/// Sections beyond which conditions and scatter are not studied: each of their plans is as long
/// as the plan itself.
const STUDIED: usize = 1000;

/// States kept of the edge's life where the feed is a state too: seconds for twenty sections.
const JOINT_LEVELS: usize = 64;

/// Sections beyond which that is said.
const JOINT_SECTIONS: usize = 40;

/// One pass worked out.
pub struct PassStudy<'a> {
    pub name: &'a str,
    pub pass: &'a Pass,
    pub planner: Planner<'a>,
    /// Regimes to compare with; the first is the one that gains are told against.
    pub baselines: Vec<Baseline>,
    /// One for each of [`OBJECTIVES`].
    pub plans: [Plan; 2],
    /// Plans on the front of time and cost, fastest first.
    pub front: Vec<Plan>,
    pub conditions: Vec<Condition>,
    pub scatter: Vec<Scattered>,
}

/// A regime to compare with.
pub struct Baseline {
    pub name: &'static str,
    pub plan: Result<Plan, ContourError>,
}

/// Gains over draws of the conditions, one for each of [`OBJECTIVES`].
pub struct Scattered {
    pub name: String,
    pub by_objective: [Sensitivity; 2],
}

impl PassStudy<'_> {
    /// The handbook regime, where there is one.
    pub fn handbook(&self) -> Option<&Plan> {
        self.baselines.first().and_then(|baseline| baseline.plan.as_ref().ok())
    }

    /// Warnings of both plans, each once.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings: Vec<Warning> = Vec::new();
        for warning in self.plans.iter().flat_map(|plan| &plan.warnings) {
            let same = |known: &Warning| std::mem::discriminant(known) == std::mem::discriminant(warning);
            if !warnings.iter().any(same) {
                warnings.push(*warning);
            }
        }
        warnings
    }
}

/// What restricts the plans themselves.
struct Demands {
    ramps: bool,
    edge: Option<EdgeLife>,
}

impl Demands {
    fn of(args: &ContourArgs) -> Result<Self, Failure> {
        let edge = args.edge.as_ref().map(|text| {
            let refuse = |reason: String| {
                Failure::argument(
                    format_args!("--edge {text}: {reason}"),
                    "write for example --edge 0.3 or --edge \"30 %\"",
                )
            };
            let remaining = unit::quantity(text, "1").map_err(|error| refuse(error.to_string()))?;
            if !(0.0..=1.0).contains(&remaining) {
                return Err(refuse("a share from 0 to 1 is due".to_owned()));
            }
            Ok(EdgeLife { remaining, ..EdgeLife::default() })
        });
        Ok(Self { ramps: args.ramps, edge: edge.transpose()? })
    }

    fn plan(&self, planner: &Planner<'_>, objective: Objective) -> Result<Plan, ContourError> {
        match (self.ramps, self.edge) {
            (false, None) => planner.optimal(objective),
            (true, None) => planner.optimal_with_ramps(objective),
            (false, Some(edge)) => planner.optimal_with_edge(objective, edge),
            (true, Some(edge)) => {
                planner.optimal_with_ramps_and_edge(objective, EdgeLife { levels: JOINT_LEVELS, ..edge })
            }
        }
    }
}

pub fn studies<'a>(task: &'a Task, args: &ContourArgs, voice: &Voice) -> Result<Vec<PassStudy<'a>>, Failure> {
    let demands = Demands::of(args)?;
    let wanted = |name: &str| args.pass.is_empty() || args.pass.iter().any(|pass| pass == name);
    let passes = task.file.passes.iter().filter(|(name, _)| wanted(name));
    passes.map(|(name, pass)| study(task, name, pass, &demands, args, voice)).collect()
}

fn study<'a>(
    task: &'a Task,
    name: &'a str,
    pass: &'a Pass,
    demands: &Demands,
    args: &ContourArgs,
    voice: &Voice,
) -> Result<PassStudy<'a>, Failure> {
    let file = &task.file;
    let refuse = |error: ContourError| task.refused(name, &error);
    let planner = Planner::new(&file.contour, &file.parameters, pass, &file.models).map_err(refuse)?;
    let sections = file.contour.sections.len();
    if demands.ramps && demands.edge.is_some() && sections > JOINT_SECTIONS {
        voice.say(format_args!("ramps and edge life together over {sections} sections may take minutes"));
    }
    let plans = [
        demands.plan(&planner, Objective::Time).map_err(refuse)?,
        demands.plan(&planner, Objective::Cost).map_err(refuse)?,
    ];
    let front = planner.pareto().map_err(refuse)?;
    let baselines = vec![
        Baseline { name: "handbook", plan: planner.handbook() },
        Baseline { name: "handbook by section", plan: planner.handbook_by_section() },
        Baseline { name: "best constant, time", plan: planner.best_constant(Objective::Time) },
        Baseline { name: "best constant, cost", plan: planner.best_constant(Objective::Cost) },
    ];
    let few = sections <= STUDIED;
    if !few {
        voice.say(format_args!("more than {STUDIED} sections: conditions and scatter are not studied"));
    }
    let conditions = if few { conditions(file, pass) } else { Vec::new() };
    let scatter = if few { scattered(&planner, &file.scatter, args).map_err(refuse)? } else { Vec::new() };
    Ok(PassStudy { name, pass, planner, baselines, plans, front, conditions, scatter })
}

/// The study of scatter: each condition alone, then all together.
fn scattered(
    planner: &Planner<'_>,
    scatter: &ConditionScatter,
    args: &ContourArgs,
) -> Result<Vec<Scattered>, ContourError> {
    if args.draws == 0 {
        return Ok(Vec::new());
    }
    let none = ConditionScatter { allowance: 0.0, hardness: 0.0, table_feed: 0.0 };
    let percent = |share: f64| format!("{} %", toolroom_form::significant(100.0 * share));
    let cases = [
        (
            format!("allowance ± {}", percent(scatter.allowance)),
            ConditionScatter { allowance: scatter.allowance, ..none },
        ),
        (format!("hardness ± {}", percent(scatter.hardness)), ConditionScatter { hardness: scatter.hardness, ..none }),
        (
            format!("table feed ± {}", percent(scatter.table_feed)),
            ConditionScatter { table_feed: scatter.table_feed, ..none },
        ),
        ("all together".to_owned(), *scatter),
    ];
    let study = |(name, scatter): (String, ConditionScatter)| {
        let by = |objective| planner.sensitivity(objective, &scatter, args.draws, args.seed);
        Ok(Scattered { name, by_objective: [by(Objective::Time)?, by(Objective::Cost)?] })
    };
    cases.into_iter().map(study).collect()
}

/// A regime over all passes.
pub struct Total {
    pub name: String,
    /// s.
    pub time: f64,
    pub cost: f64,
}

/// Sums over all passes of the regimes that every pass has; nothing for a single pass.
pub fn totals(studies: &[PassStudy<'_>]) -> Vec<Total> {
    if studies.len() < 2 {
        return Vec::new();
    }
    let sum = |name: String, plan: &dyn Fn(&PassStudy<'_>) -> Option<(f64, f64)>| {
        let plans: Option<Vec<(f64, f64)>> = studies.iter().map(plan).collect();
        let (time, cost) = plans?.into_iter().fold((0.0, 0.0), |sum, plan| (sum.0 + plan.0, sum.1 + plan.1));
        Some(Total { name, time, cost })
    };
    let both = |plan: &Plan| (plan.time, plan.cost);
    let baselines = (0..studies[0].baselines.len()).filter_map(|i| {
        sum(studies[0].baselines[i].name.to_owned(), &|study| study.baselines[i].plan.as_ref().ok().map(both))
    });
    let plans = OBJECTIVES
        .iter()
        .enumerate()
        .filter_map(|(i, (name, _))| sum(format!("least {name}"), &|study| Some(both(&study.plans[i]))));
    baselines.chain(plans).collect()
}

/// Runs of sections with one setting and one active constraint: first and last index.
pub fn runs(plan: &Plan) -> Vec<(usize, usize)> {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs();
    let alike = |a: &PlannedSection, b: &PlannedSection| {
        let same_wall = near(a.evaluation.engagement.immersion, b.evaluation.engagement.immersion);
        a.setting == b.setting && a.active == b.active && same_wall
    };
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (i, section) in plan.sections.iter().enumerate() {
        match runs.last_mut() {
            Some((_, last)) if alike(&plan.sections[*last], section) => *last = i,
            _ => runs.push((i, i)),
        }
    }
    runs
}
