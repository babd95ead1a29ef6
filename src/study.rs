//! Running a scenario's policies and writing the results: what run, compare and demo share.

use crate::args::{Changes, LogFormat, ReportArgs, StudyArgs};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::report;
use crate::speak::Voice;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, OnceLock};
use toolroom_gap_study::{GapStudyError, RECORDED, recorded};
use toolroom_output::signals as stop;
use toolroom_output::{Files, OutputDir, quoted};
use toolroom_records::{RecordKind, write_csv};
use toolroom_scenario::Scenario;
use toolroom_scenario_file::ScenarioFile;
use toolroom_shards::Journal;
use toolroom_shop::RunLog;
use toolroom_steady::WarmUp;
use toolroom_study::StatisticsWanted;
use toolroom_study::logs::{Format, LogWriter};
use toolroom_study::request::StudyRequest;
use toolroom_study::results::{self, FinishedRun, STOPPED, record};
use toolroom_study::study::{KnownRuns, Precision, StoppedShop, StudyOptions, known_of};
use toolroom_study::terminal::{Style, table};
use toolroom_study::trace::window;
use toolroom_study::tune::Tuning;
use toolroom_study::variants::{VariantShop, Wanted};

/// A study about to be run.
pub struct Request<'a> {
    /// Verb and scenario, as typed: `compare shop.toml`.
    pub command: String,
    /// Name of the scenario file.
    pub input: String,
    pub file: ScenarioFile,
    pub changes: &'a Changes,
    /// Those of them that were typed; a snapshot holds the others.
    pub typed: Vec<String>,
    pub args: &'a StudyArgs,
    /// Policies by index.
    pub policies: Vec<usize>,
    /// Replications with full logs, unless the arguments say otherwise.
    pub logged: u32,
    /// Output directory, unless the arguments say otherwise.
    pub out: PathBuf,
    /// Runs made elsewhere.
    pub known: Arc<KnownRuns>,
    /// How the settings of the policies in `file` were found.
    pub tuning: Option<Arc<Tuning>>,
    /// Variants of the shop that are run beside it.
    pub variants: Vec<VariantShop>,
    /// By what the best of them is selected.
    pub select: Option<Wanted>,
    /// When the study stops.
    pub until: Vec<Precision>,
    /// The figure that matters most.
    pub primary: Option<String>,
    /// How the warm-up of `file` was found.
    pub warm_up: Option<Arc<WarmUp>>,
}

/// The place of the results, taken before any work, and the folder of the journals.
pub struct Place {
    pub out: OutputDir,
    pub journal: PathBuf,
}

impl Place {
    /// Takes the place of a study of `file`, which was read as `input`.
    pub fn take(
        input: &str,
        file: &ScenarioFile,
        args: &StudyArgs,
        target: &Path,
        voice: &Voice,
    ) -> Result<Self, Failure> {
        let tables = format(file, args).map_or(Vec::new(), LogWriter::names);
        let names: Vec<&str> = results::NAMES.iter().copied().chain(tables.iter().map(String::as_str)).collect();
        let output_dir = OutputDir::create(target, &names, inputs(input, file), voice.force)?;
        let journal = output_dir.journal(args.resume)?;
        Ok(Self { out: output_dir, journal })
    }
}

/// What `[statistics]` of a scenario wants; what it says wrongly is told with the line of the section.
pub fn section(file: &ScenarioFile) -> Result<StatisticsWanted, Failure> {
    StatisticsWanted::from_scenario(&file.scenario, &file.statistics).map_err(|error| {
        let line = file.text.lines().position(|line| line.trim_start().starts_with("[statistics]"));
        let place = line.map_or_else(String::new, |line| format!("line {}: ", line + 1));
        Failure::argument(format!("{place}{error}"), error.fix())
    })
}

/// What `[statistics]` of a scenario wants, with what the command line says in its place.
pub fn statistics(file: &ScenarioFile, args: &StudyArgs) -> Result<StatisticsWanted, Failure> {
    let wanted = section(file)?;
    let until = if args.until.is_empty() { wanted.until } else { args.until.clone() };
    Ok(StatisticsWanted { until, ..wanted })
}

/// The files that are read.
fn inputs<'a>(input: &'a str, file: &'a ScenarioFile) -> impl Iterator<Item = &'a Path> {
    file.files.iter().map(AsRef::as_ref).chain([Path::new(input)])
}

/// Runs, writes, prints; into `place` where that is taken already.
pub fn perform(request: &Request<'_>, place: Option<Place>, voice: &Voice) -> Result<(), Failure> {
    let Request { file, args, .. } = request;
    let scenario = &file.scenario;
    let mut options = StudyOptions {
        policies: request.policies.clone(),
        threads: args.threads,
        until: request.until.clone(),
        replications: file.replications(!request.until.is_empty() && request.changes.replications.is_none()),
        primary: request.primary.clone(),
        // Records are those of the first replication.
        logged: args.logged.unwrap_or(request.logged).max(u32::from(args.records.is_some())),
        known: Arc::clone(&request.known),
        stop_after: args.stop_after,
        tuning: request.tuning.clone(),
        variants: request.variants.clone(),
        select: request.select.clone(),
        warm_up: request.warm_up.clone(),
        ..StudyOptions::of(scenario)
    };
    let target = args.out.as_deref().unwrap_or(&request.out);
    let format = format(file, args);
    let version = env!("CARGO_PKG_VERSION");
    let tuned = request.tuning.iter().flat_map(|tuning| tuning.changes());
    let settled = request.warm_up.iter().map(|found| found.change());
    let changes = request.changes.overrides().into_iter().chain(settled).chain(tuned).collect();
    let requested = StudyRequest::new(version, reproduce(request), &request.input, file, changes, &options, format);
    let shown = window(scenario, &args.trace).map_err(|error| Failure::argument(&error, error.fix()))?;
    let requested = requested.traced(shown);
    if args.resume && target.join("run.json").exists() {
        let earlier = FinishedRun::read(target)?;
        if earlier.complete() {
            requested.refuse_another(target, &earlier.run)?;
            voice.say(format_args!("{} is complete: nothing is left to do", target.display()));
            return report::run(&ReportArgs { dir: target.to_owned(), open: false }, voice);
        }
        let finished = requested.earlier(target, &earlier.run)?;
        if finished.replications > 0 {
            voice.say(format_args!("going on after {} replications", finished.replications));
            options.earlier = Some(finished);
        }
    }
    let files = Files::new(inputs(&request.input, file), voice.force);
    if let Some(dir) = &args.records {
        refuse_records(&files, dir, target)?;
    }
    let bound = voice.max_memory;
    for warning in toolroom_kinds::overloads(scenario, bound, options.logged > 0) {
        voice.say(format_args!("warning[{}]: {}", warning.code, warning.message));
    }
    let command = std::env::args().map(|argument| quoted(&argument)).collect::<Vec<_>>().join(" ");
    let information = requested.information(command).map_err(Failure::Json)?;
    let Place { out, journal } = place.map_or_else(|| Place::take(&request.input, file, args, target, voice), Ok)?;
    let runs = journal.join("runs");
    let (journal, finished) = Journal::open(&runs, &requested.head().map_err(Failure::Json)?)?;
    if !finished.is_empty() {
        voice.say(format_args!("going on after {} runs in {}", finished.len(), runs.display()));
        let shops: Vec<&Scenario> =
            std::iter::once(scenario).chain(options.variants.iter().map(|own| own.scenario.as_ref())).collect();
        let mut known = known_of(&shops, &options.policies, finished);
        known.extend(request.known.iter().map(|(run, known)| (*run, known.clone())));
        options.known = Arc::new(known);
    }
    if options.earlier.is_some() || !options.known.is_empty() {
        let message = format!("interrupted: {} is as it was", target.display());
        stop::keeps(message, RESUME.to_owned());
    }
    let journal = Arc::new(journal);
    options.journal = Some(Arc::clone(&journal));
    let interrupted = Arc::new(AtomicBool::new(false));
    // Before the first run is finished there is nothing to keep, and a signal ends the program at once.
    let gentle = OnceLock::new();
    let bar = Bar::new(voice);
    let progress = |at| {
        gentle.get_or_init(|| stop::gently(&interrupted));
        bar.at(at);
    };
    let recorded = record(out.draft(), scenario, &options, format, &information, &progress, &interrupted);
    bar.finish();
    if let Some(failure) = journal.failure() {
        voice.say(format_args!("warning: runs could not be kept while the study went on: {failure}"));
    }
    let recorded = match recorded {
        Ok(recorded) => recorded,
        Err(error) if error.path().is_some() => {
            // What is readable stays, under a name that nobody takes for a result.
            let kept = out.keep();
            let message = format!("{error}; what was written stays in {} and is not complete", kept.display());
            return Err(Failure::work(message));
        }
        Err(error) => {
            let unbegun = error.unbegun().map(|stopped| never_begun(stopped, request));
            return Err(unbegun.unwrap_or_else(|| Failure::work_error(&error)));
        }
    };
    let study = &recorded.study;
    if let Some(stopped) = recorded.stopped.iter().find(|_| study.replications == 0)
        && stopped.source.is_of_the_scenario()
    {
        return Err(never_begun(stopped, request));
    }
    if study.replications == 0 && recorded.stopped.is_none() && runs.exists() {
        let message = format!("interrupted: finished runs are kept in {}", target.display());
        return Err(Failure::Interrupted { message, help: RESUME.to_owned() });
    }
    if study.replications == 0 && recorded.stopped.is_none() {
        return Err(Failure::Interrupted {
            message: "interrupted before the first replication; nothing was written".to_owned(),
            help: "the same command starts anew".to_owned(),
        });
    }
    let target = out.publish()?;
    let events: u64 = study.first_logs.iter().map(|log| log.calendar_events).sum();
    voice.detail(format_args!(
        "{} replications of {} policies in {:.2} s, {events} calendar events in the first, digest {:016x}",
        study.replications,
        study.policies.len(),
        recorded.wall.as_secs_f64(),
        study.digest,
    ));
    if study.replications == 0 {
        // There is no figure to tell.
    } else if voice.json {
        voice.raw(&recorded.summary)?;
    } else {
        let style = Style { colour: voice.colour, wall: Some(recorded.wall), width: voice.width };
        voice.data(table(scenario, study, &recorded.comparison, style).trim_end())?;
    }
    scenario.notes().iter().for_each(|note| voice.say(note));
    if let Some(dir) = &args.records {
        record_first(request, study.first_logs.first(), dir, &files, voice)?;
    }
    if let Some(stopped) = &recorded.stopped {
        return Err(stopped_short(stopped, study.replications, &target));
    }
    let report = target.join("report.html");
    voice.say(format_args!("wrote {}   next: toolroom report --open {}", report.display(), target.display()));
    if study.complete {
        return Ok(());
    }
    let plural = if study.replications == 1 { " is" } else { "s are" };
    let message =
        format!("interrupted: {} replication{plural} complete and written to {}", study.replications, target.display());
    Err(Failure::Interrupted { message, help: RESUME.to_owned() })
}

/// The way on after an interruption.
pub const RESUME: &str = "the same command with --resume goes on";

/// Where the records of a kind go.
fn records_file(dir: &Path, kind: RecordKind) -> PathBuf {
    dir.join(kind.file_stem()).with_extension("csv")
}

/// Refuses a place for records before any work.
fn refuse_records(files: &Files, dir: &Path, target: &Path) -> Result<(), Failure> {
    // Both have a table of operations, each with other columns.
    if let (Ok(records), Ok(results)) = (std::path::absolute(dir), std::path::absolute(target))
        && records == results
    {
        let message = format!("{} is the place of the results", dir.display());
        return Err(Failure::argument(message, "give --records a folder of its own"));
    }
    Ok(RECORDED.iter().try_for_each(|kind| files.check(&records_file(dir, *kind)))?)
}

/// Writes what would have been measured of the first run of the first policy.
fn record_first(
    request: &Request<'_>,
    log: Option<&RunLog>,
    dir: &Path,
    files: &Files,
    voice: &Voice,
) -> Result<(), Failure> {
    let Some(log) = log else { return Ok(()) };
    let measured = recorded(&request.input, &request.file, log).map_err(|error| {
        let GapStudyError::Model(sensor) = error else { return error.into() };
        Failure::argument(sensor, "give the sensor in the unit of its channel")
    })?;
    std::fs::create_dir_all(dir).map_err(|source| Failure::Unwritable { path: dir.to_owned(), source })?;
    let mut names = Vec::new();
    for records in measured {
        let path = records_file(dir, records.kind);
        let mut csv = Vec::new();
        write_csv(&records, &mut csv).map_err(|error| Failure::work_error(&error))?;
        files.put(&path, &csv)?;
        names.push(path.display().to_string());
    }
    voice.say(format_args!("recorded {}", names.join(", ")));
    Ok(())
}

/// A shop of which no run would begin: the scenario is at fault, as `check` says, and nothing is written.
fn never_begun(stopped: &StoppedShop, request: &Request<'_>) -> Failure {
    let help = format!("toolroom check {}, with the same --set, shows the place", quoted(&request.input));
    Failure::argument(format_args!("no run of policy `{}` would begin: {}", stopped.name, stopped.source), help)
}

/// A shop that stopped by itself: why, and what is there all the same.
fn stopped_short(stopped: &StoppedShop, replications: u32, target: &Path) -> Failure {
    let complete = match replications {
        0 => "no replication is complete".to_owned(),
        1 => "1 replication is complete".to_owned(),
        many => format!("{many} replications are complete"),
    };
    let before = target.join(STOPPED);
    let tables = if before.is_dir() {
        format!("; what happened in the one that stopped is in {}", before.display())
    } else {
        String::new()
    };
    let help = format!("{complete}: toolroom report {}{tables}", quoted(&target.display().to_string()));
    Failure::stopped(stopped, help)
}

/// The request of the study in a folder, complete or not, where there is one.
pub fn request_in(target: &Path) -> Option<StudyRequest> {
    StudyRequest::read(&FinishedRun::read(target).ok()?.run)
}

fn format(file: &ScenarioFile, args: &StudyArgs) -> Option<Format> {
    let csv = args.format.map_or(file.output.csv, |format| format == LogFormat::Csv);
    let format = if csv { Format::Csv } else { Format::Parquet };
    (file.output.logs && args.logged != Some(0)).then_some(format)
}

/// The command line without what does not change the report.
fn reproduce(request: &Request<'_>) -> String {
    let mut reproduce = format!("toolroom {}", request.command);
    for change in &request.typed {
        reproduce.push_str(&format!(" --set {}", quoted(change)));
    }
    if request.tuning.is_some() {
        reproduce.push_str(" --tune");
    }
    for name in &request.args.policy {
        reproduce.push_str(&format!(" --policy {}", quoted(name)));
    }
    for precision in &request.args.until {
        reproduce.push_str(&format!(" --until \"{precision}\""));
    }
    if !request.args.trace.is_empty() {
        reproduce.push_str(" --trace");
        request.args.trace.iter().for_each(|time| reproduce.push_str(&format!(" {}", quoted(time))));
    }
    reproduce
}

/// `out/NAME`, the name of a scenario made fit for a directory.
pub fn default_out(name: &str) -> PathBuf {
    let fit = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '-' };
    Path::new("out").join(name.chars().map(fit).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_leave_the_output_directory() {
        assert_eq!(default_out("../../etc"), Path::new("out/------etc"));
    }

    #[test]
    fn arguments_are_quoted_where_the_shell_needs_it() {
        assert_eq!(quoted("--set"), "--set");
        assert_eq!(quoted("tool_change_time=1 min"), "\"tool_change_time=1 min\"");
    }
}
