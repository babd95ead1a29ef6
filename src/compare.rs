//! `toolroom compare FILE`: every policy on common random numbers.

use crate::args::{Changes, CompareArgs, StudyArgs};
use crate::failure::Failure;
use crate::plan::leave;
use crate::progress::Bar;
use crate::snapshot::{from_snapshot, origin};
use crate::speak::Voice;
use crate::study::{Place, RESUME, Request, default_out, perform, request_in, statistics};
use crate::warm_up::settle;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use toolroom_output::Files;
use toolroom_output::signals as stop;
use toolroom_scenario::TuneRequest;
use toolroom_scenario_file::{ScenarioFile, read};
use toolroom_shards::{Journal, Plan};
use toolroom_snapshot::Snapshot;
use toolroom_study::planned::{self, Axis, PlannedComparison, PlannedError};
use toolroom_study::request::StudyRequest;
use toolroom_study::study::StudyOptions;
use toolroom_study::tune::{GuardlessVerdict, TriedRun, TuneError, Tuning, guardless, tune_from, tuning_head};
use toolroom_study::variants::{self, VariantError, Wanted};

pub fn run(args: &CompareArgs, voice: &Voice) -> Result<(), Failure> {
    if let Some(from) = &args.scenario.from {
        let (args, snapshot) = from_snapshot(args, from)?;
        return compared(&args, Some(&snapshot), voice);
    }
    compared(args, None, voice)
}

/// Compares policies and variants; from the instant of a snapshot on, where there is one.
fn compared(args: &CompareArgs, snapshot: Option<&Snapshot>, voice: &Voice) -> Result<(), Failure> {
    let mut file = read(args.scenario.path(), &args.scenario.changes.overrides())?;
    let (policies, mut variants) = planned::compared(&file, &args.study.policy, args.axis)?;
    if let Some(Snapshot { at, .. }) = snapshot {
        // What is to change later than that still does.
        variants.iter_mut().for_each(|variant| variant.from = Some(variant.from.map_or(*at, |from| from.max(*at))));
    }
    if policies.len() < 2 && variants.is_empty() {
        let help = "add a [[policy]] or a [[variant]] to the scenario, or use toolroom run";
        return Err(Failure::argument("there is only one policy and no variant of the shop, nothing to compare", help));
    }
    let input = args.scenario.path().display().to_string();
    let wanted = tuning_wanted(args, &file);
    if let Some(target) = &args.plan {
        if wanted.is_some() {
            let help =
                "tune first with --tune, then plan with the settings that it prints given by --set, and --no-tune";
            return Err(Failure::argument("a plan does not tune its policies", help));
        }
        if file.scenario.seeks_warm_up {
            let help = "find it with toolroom run, then plan with the time that it prints: --set shop.warm_up=…";
            return Err(Failure::argument("a plan does not find its warm-up", help));
        }
        return plan(args, &file, target, voice);
    }
    let out = default_out(&file.scenario.name);
    let mut variants = variants::shops(&input, &file.text, &args.scenario.changes.overrides(), &variants)?;
    file.files.extend(variants.iter().flat_map(|variant| variant.files.iter().cloned()));
    if let Some(snapshot) = snapshot {
        // The shop as it was; who comes in the very instant of a branch is no part of it.
        snapshot.verify(&file.scenario, &policies)?;
    }
    let statistics = statistics(&file, &args.study)?;
    let select = args.select.as_deref().map(|text| Wanted::parse(&file.scenario, text)).transpose();
    let select = select.map_err(|error| Failure::argument(error, "see `toolroom compare --help`"))?;
    let typed_select = select.is_some();
    // What the file asks for needs variants; without them there is only one shop.
    let select = select.or(statistics.select.filter(|_| !variants.is_empty()));
    if select.is_some() && variants.is_empty() {
        let help = "add a [[variant]] to the scenario";
        return Err(Failure::argument("there is only one shop, nothing to select", help));
    }
    let target = args.study.out.as_deref().unwrap_or(&out);
    let warm_up = settle(&mut file, &mut variants, &policies, &args.study, target, voice)?;
    let mut changes = args.scenario.changes.overrides();
    changes.extend(warm_up.iter().map(|found| found.change()));
    let ((file, tuning), place) = match wanted {
        Some(wanted) => tuned_in_place((args, changes), &input, file, (&policies, &wanted), &out, voice)?,
        None => ((file, None), None),
    };
    let chosen = select
        .as_ref()
        .filter(|_| typed_select)
        .map_or_else(String::new, |select| format!(" --select \"{}\"", select.text()));
    let (start, typed) = match &args.scenario.from {
        Some(from) => (origin(from, args.scenario.horizon.as_deref()), Vec::new()),
        None => (input.clone(), args.scenario.changes.overrides()),
    };
    let request = Request {
        command: format!("compare {start}{}{chosen}", typed_axis(args.axis)),
        input,
        changes: &args.scenario.changes,
        typed,
        args: &args.study,
        policies,
        logged: 1,
        out,
        file,
        known: Arc::default(),
        tuning,
        variants,
        select,
        until: statistics.until,
        primary: statistics.primary,
        warm_up,
    };
    perform(&request, place, voice)
}

/// The option that says what is compared, where it was given.
fn typed_axis(axis: Option<Axis>) -> String {
    axis.map_or_else(String::new, |axis| format!(" --axis {}", axis.word()))
}

impl From<VariantError> for Failure {
    fn from(error: VariantError) -> Self {
        let help = error.fix();
        Self::argument(error, help)
    }
}

/// A scenario with its policies at their best settings, and how these were found.
type TunedScenario = (ScenarioFile, Option<Arc<Tuning>>);

/// The scenario tuned, with the journal of an earlier search and of this one in the place of the results; without any
/// search where an earlier run was tuned.
fn tuned_in_place(
    (args, mut changes): (&CompareArgs, Vec<String>),
    input: &str,
    file: ScenarioFile,
    (policies, wanted): (&[usize], &TuneRequest),
    folder: &Path,
    voice: &Voice,
) -> Result<(TunedScenario, Option<Place>), Failure> {
    let target = args.study.out.as_deref().unwrap_or(folder);
    let earlier = if args.study.resume { request_in(target) } else { None };
    if let Some(found) = earlier.and_then(|earlier| earlier.tuning()) {
        changes.extend(found.changes());
        return Ok(((read(args.scenario.path(), &changes)?, Some(found)), None));
    }
    let place = Place::take(input, &file, &args.study, target, voice)?;
    let options = StudyOptions { policies: policies.to_vec(), ..StudyOptions::of(&file.scenario) };
    let version = env!("CARGO_PKG_VERSION");
    let study = StudyRequest::new(version, "tune".to_owned(), input, &file, changes.clone(), &options, None);
    let head = tuning_head(&study.head().map_err(Failure::Json)?, wanted);
    let path = place.journal.join("tuning");
    let (journal, tried) = Journal::open(&path, &head)?;
    if !tried.is_empty() {
        voice.say(format_args!("going on after {} runs in {}", tried.len(), path.display()));
    }
    let interrupted = Arc::new(AtomicBool::new(false));
    let _gentle = stop::gently(&interrupted);
    let found = tuned(args, changes, &file, (policies, wanted), voice, &interrupted, Some((&journal, tried)));
    let kept = |failure| {
        if matches!(failure, Failure::Interrupted { .. }) && path.exists() {
            let message = format!("interrupted while tuning; finished runs are kept in {}", target.display());
            Failure::Interrupted { message, help: RESUME.to_owned() }
        } else {
            failure
        }
    };
    Ok((found.map_err(kept)?, Some(place)))
}

/// How the policies are tuned; `None` where they are compared as the file sets them.
pub fn tuning_wanted(args: &CompareArgs, file: &ScenarioFile) -> Option<TuneRequest> {
    let of_file = || file.tune.clone().filter(|_| !args.no_tune);
    if args.tune { Some(file.tune.clone().unwrap_or_default()) } else { of_file() }
}

/// The scenario of `file`, which was read with `changes`, with its policies at their best settings.
pub fn tuned(
    args: &CompareArgs,
    mut changes: Vec<String>,
    file: &ScenarioFile,
    (policies, wanted): (&[usize], &TuneRequest),
    voice: &Voice,
    interrupted: &AtomicBool,
    journal: Option<(&Journal<TriedRun>, Vec<TriedRun>)>,
) -> Result<TunedScenario, Failure> {
    let bar = Bar::new(voice);
    let found = tune_from(&file.scenario, policies, wanted, args.study.threads, &|at| bar.at(at), interrupted, journal);
    bar.finish();
    let mut found = found?;
    let freed = found.freed_of_guard();
    let verdict = freed.map(|freed| without_guard(args, &changes, freed, policies, voice, interrupted));
    found.without_guard = verdict.transpose()?;
    changes.extend(found.changes());
    Ok((read(args.scenario.path(), &changes)?, Some(Arc::new(found))))
}

/// The verdict where the settings that the guard excludes are rivals, too, on the random numbers that judge the others.
fn without_guard(
    args: &CompareArgs,
    changes: &[String],
    freed: Tuning,
    policies: &[usize],
    voice: &Voice,
    interrupted: &AtomicBool,
) -> Result<GuardlessVerdict, Failure> {
    let changes: Vec<String> = changes.iter().cloned().chain(freed.changes()).collect();
    let file = read(args.scenario.path(), &changes)?;
    let bar = Bar::new(voice);
    let verdict = guardless(&file.scenario, freed, policies, args.study.threads, &|at| bar.at(at), interrupted);
    bar.finish();
    let verdict = verdict.map_err(|error| Failure::work_error(&error))?;
    verdict.ok_or_else(|| TuneError::Stopped.into())
}

impl From<TuneError> for Failure {
    fn from(error: TuneError) -> Self {
        let help = error.fix();
        match error {
            TuneError::Stopped => Self::Interrupted { message: error.to_string(), help },
            TuneError::Shop { .. } | TuneError::Threads { .. } => Self::work_error_with(&error, help),
            TuneError::Objective { .. }
            | TuneError::Seed { .. }
            | TuneError::Budget { .. }
            | TuneError::Nothing { .. }
            | TuneError::Policy(_) => Self::argument(error, help),
        }
    }
}

/// `--plan FILE`: the replications cut into shards.
fn plan(args: &CompareArgs, file: &ScenarioFile, target: &Path, voice: &Voice) -> Result<(), Failure> {
    if !args.study.until.is_empty() || !file.statistics.until.is_empty() {
        let help = "give the number with --replications; a precision needs all replications at hand";
        return Err(Failure::argument("--until cannot be planned in shards", help));
    }
    let name = args.scenario.path().display().to_string();
    let changes = args.scenario.changes.overrides();
    let version = env!("CARGO_PKG_VERSION");
    let plan = planned::plan(version, (&name, file), changes, (&args.study.policy, args.axis), args.shards)?;
    let inputs = plan.files.iter().map(|(path, _)| Path::new(path)).chain([args.scenario.path()]);
    leave(&plan, target, &Files::new(inputs, voice.force))?;
    let shown = target.display();
    voice.say(format_args!("wrote {shown}: {} shards   next: toolroom shard {shown} 0 --out parts", plan.shards));
    Ok(())
}

impl From<PlannedError> for Failure {
    fn from(error: PlannedError) -> Self {
        match error {
            PlannedError::Scenario(error) => error.into(),
            PlannedError::Policy(error) => error.into(),
            PlannedError::Variant(error) => error.into(),
            PlannedError::Shard(error) => error.into(),
            PlannedError::Study(error) => Self::work_error(&error),
        }
    }
}

/// Merges the parts of a planned comparison: the same files and digest as without a plan.
pub fn merge(plan: &Plan, parts: &Path, out: Option<&Path>, voice: &Voice) -> Result<(), Failure> {
    let comparison = PlannedComparison::read(plan)?;
    let known = comparison.known_runs(plan, parts)?;
    let PlannedComparison { file, policies, variants } = comparison;
    let changes = Changes { set: plan.overrides.clone(), ..Changes::default() };
    let args = StudyArgs { policy: plan.policies.clone(), out: out.map(Path::to_owned), ..StudyArgs::default() };
    let statistics = statistics(&file, &args)?;
    let request = Request {
        command: format!("compare {}{}", plan.file, typed_axis(plan.axis)),
        input: plan.file.clone(),
        typed: changes.overrides(),
        changes: &changes,
        args: &args,
        policies,
        logged: 1,
        out: default_out(&file.scenario.name),
        file,
        known: Arc::new(known),
        tuning: None,
        select: statistics.select.filter(|_| !variants.is_empty()),
        variants,
        until: Vec::new(),
        primary: statistics.primary,
        warm_up: None,
    };
    perform(&request, None, voice)
}
