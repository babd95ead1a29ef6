//! `toolroom modes FRF`: vibration modes from a tap test; `toolroom swap BASE`: of another tool on the same spindle.

use crate::args::{ImportFrfArgs, ModesArgs, ModesUpdateArgs, SwapArgs};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use std::path::{Path, PathBuf};
use std::time::Instant;
use toolroom_chart::page::Provenance;
use toolroom_dynamics::{Fit, FitOptions, Measurement, Scatter, TapOptions};
use toolroom_lobes::read_structure;
use toolroom_modes::{
    Comparison, CutsError, ModesStudy, ModesUpdate, NAMES, Request, RequestError, SpeedStudy, Spindle, SwapError,
    TappedBlank, UpdateOptions, blank, range, read_cuts, read_tool, scatter, summary,
};
use toolroom_output::{Files, OutputDir, provenance};
use toolroom_planning::lobes::Measured;

/// Where the files and the words of a fault are described.
const GUIDE: &str = "see docs/dynamics.md";

pub fn run(args: &ModesArgs, voice: &Voice) -> Result<(), Failure> {
    if let Some(update_args) = args.update() {
        return update(&update_args, voice);
    }
    let target = Target::new(args.out.as_deref(), args.report.as_deref(), args.accept_refused);
    let ModesArgs { averages, modes, .. } = *args;
    let (direction, (estimator, highest, scales)) = (args.direction.as_deref(), args.taps.parts());
    let request = Request { averages, direction, modes, picks: &args.pick, estimator, highest, scales };
    let taps = request.taps()?;
    let bytes = bytes(args.file())?;
    let name = args.file().display().to_string();
    let inputs = [(name.clone(), bytes.as_slice())];
    let provenance = provenance("modes", &inputs, request.arguments().into_iter().chain(args.typed()), None);
    let refused = |error| Failure::located(error, GUIDE);
    if let Some(measured) = toolroom_dynamics::measure_by_speed(&name, &bytes).map_err(refused)? {
        return by_speed(args, measured, (&request.options()?, &provenance), &target, voice);
    }
    let measured = with_coherence(args.file(), &bytes, &taps, args.coherence.as_deref())?;
    if args.read {
        return voice.data(summary(&measured) + "\n");
    }
    let (options, scatter) = (request.options()?, scatter(&args.scatter)?);
    let files = target.files([Some(args.file()), args.coherence.as_deref()].into_iter().flatten(), voice)?;
    let study = ModesStudy::new(target.name(args.file()), measured, &options, scatter);
    target.write(&study.map_err(|error| Failure::argument(error, GUIDE))?, &files, &provenance, voice)
}

/// `toolroom import frf FILE`: what a tap test holds, as one table where `--out` says so.
pub fn import(args: &ImportFrfArgs, voice: &Voice) -> Result<(), Failure> {
    let (estimator, highest, scales) = args.taps.parts();
    let request = Request { estimator, highest, scales, ..Request::default() };
    let measured = with_coherence(&args.file, &bytes(&args.file)?, &request.taps()?, args.coherence.as_deref())?;
    if voice.json {
        voice.json(&toolroom_modes::json(&measured))?;
    } else {
        voice.data(summary(&measured))?;
    }
    let Some(out) = &args.out else { return Ok(()) };
    let inputs = [Some(args.file.as_path()), args.coherence.as_deref()].into_iter().flatten();
    let table = toolroom_modes::table(&measured).map_err(|error| Failure::argument(error, GUIDE))?;
    Files::new(inputs, voice.force).put(out, table.as_bytes())?;
    voice.say(format_args!("wrote {}", out.display()));
    Ok(())
}

/// The responses of a file, with the coherence of another one where it is given.
fn with_coherence(
    path: &Path,
    content: &[u8],
    taps: &TapOptions,
    coherence: Option<&Path>,
) -> Result<Measurement, Failure> {
    let refused = |error| Failure::located(error, GUIDE);
    let measured = toolroom_dynamics::measure(&path.display().to_string(), content, taps).map_err(refused)?;
    let Some(path) = coherence else { return Ok(measured) };
    let table = toolroom_dynamics::read_coherence(&path.display().to_string(), &bytes(path)?).map_err(refused)?;
    measured.with_coherence(&table).map_err(refused)
}

/// Responses at several spindle speeds (rad/s): modes of each, and a structure file with all of them.
fn by_speed(
    args: &ModesArgs,
    measured: Vec<(f64, Measurement)>,
    (options, provenance): (&FitOptions, &Provenance),
    target: &Target<'_>,
    voice: &Voice,
) -> Result<(), Failure> {
    if args.read {
        let lines: Vec<String> = measured.iter().map(|(_, measured)| summary(measured)).collect();
        return voice.data(lines.join("\n") + "\n");
    }
    if args.report.is_some() || args.coherence.is_some() {
        let flag = if args.report.is_some() { "--report" } else { "--coherence" };
        let message = format!("{flag}: it is that of one tap, and this table holds taps at several spindle speeds");
        return Err(Failure::argument(message, "give a table of one speed, without the column spindle_speed"));
    }
    let files = target.files([args.file()], voice)?;
    let study = SpeedStudy::new(&target.name(args.file()), measured, options, scatter(&args.scatter)?)
        .map_err(|error| Failure::argument(error, GUIDE))?;
    if voice.json {
        voice.json(&study.json())?
    } else {
        voice.data(study.text())?
    }
    for (_, fit) in study.fits() {
        target.accepted(&fit.fit)?;
    }
    let Some(out) = &args.out else { return Ok(()) };
    let text = study.structure(provenance).map_err(|error| Failure::argument(error, GUIDE))?;
    target.put(out, &text, &files, voice)
}

/// `toolroom modes update STRUCTURE`: a structure file brought up to date by cuts of the shop.
fn update(args: &ModesUpdateArgs, voice: &Voice) -> Result<(), Failure> {
    let (cuts, lobes) = (args.cuts.as_path(), args.lobes.as_path());
    let (structure, file) = (read_structure(&args.file, &[])?, toolroom_lobes::read(lobes, &[])?);
    let files = Files::new([args.file.as_path(), cuts, lobes], voice.force);
    if let Some(out) = &args.out {
        files.check(out)?;
    }
    if !(0.0..1.0).contains(&args.coefficients) {
        let message = format!("--coefficients: {} is not within 0 … 1", args.coefficients);
        return Err(Failure::argument(message, "write for example --coefficients 0.15"));
    }
    let records = bytes(cuts)?;
    let found = read_cuts(&cuts.display().to_string(), &records, &file.content, args.machine.as_deref());
    let found = found.map_err(|error| {
        let fix = if matches!(error, CutsError::NamesNoMachine) { "leave it out" } else { GUIDE };
        Failure::located(error, fix)
    })?;
    if let Some(words) = found.words() {
        voice.say(words);
    }
    let options = UpdateOptions {
        particles: args.particles as usize,
        coefficients: args.coefficients,
        ..UpdateOptions::default()
    };
    let bar = Bar::of(voice, "parts");
    let progress = |done, total| bar.part(done, total);
    let update = ModesUpdate::new(&structure.content, &file.content, &found.cuts, &options, &progress);
    bar.finish();
    let update = update.map_err(|error| Failure::argument(error, GUIDE))?;
    if voice.json {
        voice.json(&update.json())?;
    } else {
        voice.data(update.text())?;
    }
    let Some(out) = &args.out else { return Ok(()) };
    let inputs = [
        (&args.file, structure.text.as_bytes()),
        (&cuts.to_owned(), &records),
        (&lobes.to_owned(), file.text.as_bytes()),
    ]
    .map(|(path, bytes)| (path.display().to_string(), bytes));
    let made = provenance("modes update", &inputs, args.typed(), None);
    files.put(out, update.structure(&made).as_bytes())?;
    voice.say(format_args!("wrote {}; a lobes file takes it by structure = \"…\"", out.display()));
    Ok(())
}

/// The frequency responses of a file, at rest or at several spindle speeds.
pub fn responses(path: &Path) -> Result<Measured, Failure> {
    let bytes = bytes(path)?;
    let name = path.display().to_string();
    let refused = |error| Failure::located(error, GUIDE);
    Ok(match toolroom_dynamics::measure_by_speed(&name, &bytes).map_err(refused)? {
        Some(measured) => {
            let study = SpeedStudy::new(&name, measured, &FitOptions::default(), Scatter::NONE);
            Measured::BySpeed(study.map_err(|error| Failure::argument(error, GUIDE))?)
        }
        None => Measured::AtRest(toolroom_dynamics::measure(&name, &bytes, &TapOptions::default()).map_err(refused)?),
    })
}

/// The bytes of a measured file.
pub fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| Failure::unreadable(path, error, "see docs/dynamics.md for the files"))
}

/// `toolroom swap BASE --tool TOOL`.
pub fn swap(args: &SwapArgs, voice: &Voice) -> Result<(), Failure> {
    let target = Target::new(args.out.as_deref(), args.report.as_deref(), args.accept_refused);
    let mut tool = read_tool(&args.tool, &args.set)?;
    let (spindle, bytes_of_base) = spindle(args)?;
    let range = range(&args.range)?;
    let refused = |error: SwapError| Failure::argument(error, GUIDE);
    let given = args.measured.as_deref().map(|path| Ok::<_, Failure>((path, bytes(path)?))).transpose()?;
    let mut comparison = None;
    if let Some((path, bytes)) = &given {
        let name = path.display().to_string();
        let unread = |error| Failure::located(error, GUIDE);
        let measured = toolroom_dynamics::measure(&name, bytes, &TapOptions::default()).map_err(unread)?;
        let tip = spindle.tip_at(&measured.frequencies, &tool.content, range).map_err(refused)?;
        let found = Comparison::new(&tip, tool.content.joint.as_ref(), &measured, args.fit_joint).map_err(refused)?;
        if let Some(fitted) = &found.joint {
            tool.content.joint = Some(fitted.joint);
        }
        comparison = Some(found);
    }
    let (measured, direction) = spindle.tip(&tool.content, range).map_err(refused)?;
    let read = [Some(&args.base), Some(&args.tool), args.measured.as_ref()].into_iter().flatten();
    let files = target.files(read.map(PathBuf::as_path), voice)?;
    let inputs = [(&args.base, bytes_of_base.as_slice()), (&args.tool, tool.text.as_bytes())];
    let given = args.measured.as_ref().zip(given.as_ref().map(|(_, bytes)| bytes.as_slice()));
    let inputs = inputs.into_iter().chain(given).map(|(path, bytes)| (path.display().to_string(), bytes));
    let inputs: Vec<(String, &[u8])> = inputs.collect();
    let provenance = provenance("swap", &inputs, args.typed(), None);
    let options = FitOptions { direction: Some(direction), ..FitOptions::default() };
    let study = ModesStudy::new(target.name(&args.tool), measured, &options, Scatter::ASSUMED);
    let mut study = study.map_err(|error| Failure::argument(error, GUIDE))?;
    study.comparison = comparison;
    target.write(&study, &files, &provenance, voice)
}

/// The spindle of a command, and the bytes of its file.
fn spindle(args: &SwapArgs) -> Result<(Spindle, Vec<u8>), Failure> {
    let (Some(text), Some(second)) = (&args.blank, &args.second) else {
        let base = read_structure(&args.base, &[])?;
        return Ok((Spindle::Modes(Box::new(base.content)), base.text.into_bytes()));
    };
    let blank = blank(text, second).map_err(|error| Failure::argument(error, GUIDE))?;
    let request = Request { averages: args.averages, direction: args.direction.as_deref(), ..Request::default() };
    let FitOptions { averages, direction, .. } = request.options()?;
    let (name, bytes) = (args.base.display().to_string(), bytes(&args.base)?);
    let measured = toolroom_dynamics::measure(&name, &bytes, &TapOptions::default());
    let measured = measured.map_err(|error| Failure::located(error, GUIDE))?;
    let direction = direction.unwrap_or([1.0, 0.0]);
    Ok((Spindle::Tapped(Box::new(TappedBlank { measured, averages, blank, direction })), bytes))
}

/// Where modes are written.
struct Target<'a> {
    out: Option<&'a Path>,
    report: Option<&'a Path>,
    accept_refused: bool,
    start: Instant,
}

impl<'a> Target<'a> {
    fn new(out: Option<&'a Path>, report: Option<&'a Path>, accept_refused: bool) -> Self {
        Self { out, report, accept_refused, start: Instant::now() }
    }

    /// The files of a command that reads `inputs`; a structure file that must not be written is refused now.
    fn files<'b>(&self, inputs: impl IntoIterator<Item = &'b Path>, voice: &Voice) -> Result<Files, Failure> {
        let files = Files::new(inputs, voice.force);
        self.out.map_or(Ok(()), |out| files.check(out))?;
        Ok(files)
    }

    /// Name of the structure: that of its file, or of the file that it is made of.
    fn name(&self, input: &Path) -> String {
        let name = self.out.unwrap_or(input).file_stem();
        name.map_or_else(|| "structure".to_owned(), |stem| stem.to_string_lossy().into_owned())
    }

    /// Prints the modes, and writes the report and the structure file.
    fn write(&self, study: &ModesStudy, files: &Files, provenance: &Provenance, voice: &Voice) -> Result<(), Failure> {
        if let Some(folder) = self.report {
            let output_dir = OutputDir::create(folder, NAMES, [], voice.force)?;
            output_dir.put_all(&study.files(provenance.clone()))?;
            output_dir.record(provenance, self.start.elapsed())?;
            voice.say(format_args!("wrote {}", output_dir.publish()?.join("report.html").display()));
        }
        if voice.json {
            voice.json(&study.json())?
        } else {
            voice.data(study.text())?
        }
        voice.detail(format_args!("{:.2} s", self.start.elapsed().as_secs_f64()));
        self.accepted(&study.fit)?;
        let Some(output_dir) = self.out else { return Ok(()) };
        self.put(output_dir, &study.structure(provenance), files, voice)
    }

    /// Refuses a fit that must not be used.
    fn accepted(&self, fit: &Fit) -> Result<(), Failure> {
        match fit.quality.refusals.first().filter(|_| !self.accept_refused) {
            Some(refusal) => {
                let message = format!("refused ({}): {refusal}; {}", refusal.code(), refusal.fix());
                Err(Failure::work(message))
            }
            None => Ok(()),
        }
    }

    /// Writes the structure file.
    fn put(&self, out: &Path, text: &str, files: &Files, voice: &Voice) -> Result<(), Failure> {
        if let Some(folder) = out.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|source| Failure::Unwritable { path: folder.to_owned(), source })?;
        }
        files.put(out, text.as_bytes())?;
        voice.say(format_args!("wrote {}; a lobes file takes it by structure = \"…\"", out.display()));
        Ok(())
    }
}

impl From<RequestError> for Failure {
    fn from(error: RequestError) -> Self {
        Self::argument(&error, error.fix)
    }
}
