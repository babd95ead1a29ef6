//! Baselines, plans, front, conditions and scatter of every pass.

use super::journal::Keeper;
use super::{Condition, DrawJournal, OBJECTIVES, conditions};
use std::sync::atomic::{AtomicU32, Ordering};
use toolroom_contour::{
    ConditionScatter, ContourError, ContourFile, EdgeLife, Objective, Pass, Plan, PlannedSection, Planner, Sensitivity,
    Warning,
};
use toolroom_form::significant;
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
    /// Name of the pass.
    pub name: &'a str,
    /// Allowance, tolerance and hardness of the pass.
    pub pass: &'a Pass,
    /// The planner of the pass.
    pub planner: Planner<'a>,
    /// Regimes to compare with; the first is the one that gains are reported against.
    pub baselines: Vec<Baseline>,
    /// One for each of [`OBJECTIVES`].
    pub plans: [Plan; 2],
    /// Plans on the front of time and cost, fastest first.
    pub front: Vec<Plan>,
    /// Gains under changed conditions; none for a contour of very many sections.
    pub conditions: Vec<Condition>,
    /// Gains under scattering conditions: each alone, then all together; none without draws.
    pub scatter: Vec<Scattered>,
}

/// A regime to compare with.
pub struct Baseline {
    /// Name of the regime.
    pub name: &'static str,
    /// The plan, or why the regime is not admissible.
    pub plan: Result<Plan, ContourError>,
}

/// Gains over draws of the conditions, one for each of [`OBJECTIVES`].
pub struct Scattered {
    /// The condition that scatters, with its width.
    pub name: String,
    /// One for each of [`OBJECTIVES`].
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

/// The edge that starts a contour with this share of its life left: `0.3`, `30 %`.
///
/// # Errors
/// What is wrong with the text.
pub fn edge_life(share: &str) -> Result<EdgeLife, String> {
    let remaining = unit::quantity(share, "1").map_err(|error| error.to_string())?;
    if (0.0..=1.0).contains(&remaining) {
        Ok(EdgeLife { remaining, ..EdgeLife::default() })
    } else {
        Err("a share from 0 to 1 is due".to_owned())
    }
}

/// Distance of ends of a drawing that are one point, m: `10 um`, a millimetre at most, beyond which they are not meant to be one
/// (assumption).
///
/// # Errors
/// What is wrong with the text.
pub fn join_length(text: &str) -> Result<f64, String> {
    let length = unit::quantity(text, "m").map_err(|error| error.to_string())?;
    if length > 0.0 && length <= 1e-3 { Ok(length) } else { Err("a length above 0 and up to 1 mm is due".to_owned()) }
}

/// What is studied of a contour file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyOptions {
    /// Names of the passes; all of them where there is no name.
    pub passes: Vec<String>,
    /// Whether the feed changes within the limits of acceleration between sections.
    pub ramps: bool,
    /// The edge that starts the contour, where its remaining life restricts the plan.
    pub edge: Option<EdgeLife>,
    /// Draws of the conditions in the study of scatter; 0 for none.
    pub draws: u32,
    /// Seed of the draws.
    pub seed: u64,
}

impl StudyOptions {
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

/// A pass for which there is no plan.
#[derive(Debug, thiserror::Error)]
#[error("pass `{pass}`: {error}")]
pub struct RefusedPass {
    /// Name of the pass.
    pub pass: String,
    /// What the planner says.
    #[source]
    pub error: Box<ContourError>,
}

impl RefusedPass {
    pub(super) fn new(pass: &str, error: ContourError) -> Self {
        Self { pass: pass.to_owned(), error: Box::new(error) }
    }
}

/// Works out the passes of `file` one after the other. `note` receives a sentence wherever the work takes long or a
/// part of it is left out, `progress` how many parts of the work are done, of how many: plans, conditions and draws. Draws that the
/// `journal` holds are not worked out again; the others go into it as they end.
///
/// # Errors
/// [`RefusedPass`]: the first pass for which there is no plan.
pub fn studies<'a>(
    file: &'a ContourFile,
    options: &StudyOptions,
    note: &dyn Fn(&str),
    progress: &(dyn Fn(u32, u32) + Sync),
    journal: Option<&DrawJournal>,
) -> Result<Vec<PassStudy<'a>>, RefusedPass> {
    let wanted = |name: &str| options.passes.is_empty() || options.passes.iter().any(|pass| pass == name);
    let passes: Vec<_> = file.passes.iter().filter(|(name, _)| wanted(name)).collect();
    let each = if file.contour.sections.len() <= STUDIED { PLANNED + DRAWN * options.draws } else { PLANNED };
    let (total, done) = (each.saturating_mul(passes.len() as u32), AtomicU32::new(0));
    let part = || progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
    let study = |(name, pass): &'a (String, Pass)| {
        study(file, name, pass, options, note, &Ended { part: &part, journal })
            .map_err(|error| RefusedPass::new(name, error))
    };
    passes.into_iter().map(study).collect()
}

/// Parts of the work of a pass that [`studies`] counts beside its draws: its plans, and the conditions.
const PLANNED: u32 = 2;
/// Studies of scatter of a pass: each of three conditions alone and all together, for each objective.
const DRAWN: u32 = 8;

fn study<'a>(
    file: &'a ContourFile,
    name: &'a str,
    pass: &'a Pass,
    options: &StudyOptions,
    note: &dyn Fn(&str),
    ended: &Ended<'_>,
) -> Result<PassStudy<'a>, ContourError> {
    file.contour.clears(file.parameters.cutter.radius(), pass.gouge())?;
    let planner = Planner::new(&file.contour, &file.parameters, pass, &file.models)?;
    let sections = file.contour.sections.len();
    if options.ramps && options.edge.is_some() && sections > JOINT_SECTIONS {
        note(&format!("ramps and edge life together over {sections} sections may take minutes"));
    }
    let plans = [options.plan(&planner, Objective::Time)?, options.plan(&planner, Objective::Cost)?];
    let front = planner.pareto()?;
    let baselines = vec![
        Baseline { name: "handbook", plan: planner.handbook() },
        Baseline { name: "handbook by section", plan: planner.handbook_by_section() },
        Baseline { name: "best constant, time", plan: planner.best_constant(Objective::Time) },
        Baseline { name: "best constant, cost", plan: planner.best_constant(Objective::Cost) },
    ];
    (ended.part)();
    let few = sections <= STUDIED;
    if !few {
        note(&format!("more than {STUDIED} sections: conditions and scatter are not studied"));
    }
    let conditions = if few { conditions(file, pass) } else { Vec::new() };
    (ended.part)();
    let scatter = if few { scattered((name, &planner), &file.scatter, options, ended)? } else { Vec::new() };
    Ok(PassStudy { name, pass, planner, baselines, plans, front, conditions, scatter })
}

/// What is done where a part of the work ends.
struct Ended<'a> {
    part: &'a (dyn Fn() + Sync),
    journal: Option<&'a DrawJournal>,
}

/// The study of scatter: each condition alone, then all together.
fn scattered(
    (pass, planner): (&str, &Planner<'_>),
    scatter: &ConditionScatter,
    options: &StudyOptions,
    ended: &Ended<'_>,
) -> Result<Vec<Scattered>, ContourError> {
    if options.draws == 0 {
        return Ok(Vec::new());
    }
    let none = ConditionScatter { allowance: 0.0, hardness: 0.0, table_feed: 0.0 };
    let percent = |share: f64| format!("{} %", significant(100.0 * share));
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
        let by = |(word, objective)| {
            let keeper = Keeper { study: format!("{pass}, {name}, {word}"), journal: ended.journal, done: ended.part };
            planner.sensitivity(objective, &scatter, options.draws, options.seed, &keeper)
        };
        let [time, cost] = OBJECTIVES.map(by);
        Ok(Scattered { name, by_objective: [time?, cost?] })
    };
    cases.into_iter().map(study).collect()
}

/// A regime over all passes.
pub(super) struct Total {
    pub name: String,
    /// s.
    pub time: f64,
    pub cost: f64,
}

/// Sums over all passes of the regimes that every pass has; nothing for a single pass.
pub(super) fn totals(studies: &[PassStudy<'_>]) -> Vec<Total> {
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
pub(super) fn runs(plan: &Plan) -> Vec<(usize, usize)> {
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
