//! `toolroom calibrate --data`: a parameter set with uncertainty from measured edges.

use super::decision;
use crate::args::{CalibrationData, CalibrationStart};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use std::path::{Path, PathBuf};
use toolroom_calibrate::{CalibrationStudy, Clock, DrawnTable, EdgeStart, Process, Verdict};
use toolroom_output::{Files, codes, provenance};

pub fn run(
    args: &CalibrationData,
    process: Process,
    data: &Path,
    out: &Path,
    limit: Option<&str>,
    voice: &Voice,
) -> Result<(), Failure> {
    let study = CalibrationStudy {
        process,
        data: data.to_owned(),
        map: args.map.clone(),
        model: args.model.clone().unwrap_or_default(),
        limit: limit.map(str::to_owned),
        laws: args.law.clone(),
        shapes: args.shape.clone(),
        by: args.by.clone(),
        fixed: args.fix.clone(),
        prior: args.prior.clone(),
        holdout: args.holdout.clone(),
        start: match args.start {
            CalibrationStart::Auto => EdgeStart::Auto,
            CalibrationStart::New => EdgeStart::New,
            CalibrationStart::Unknown => EdgeStart::Unknown,
        },
        life_noise: args.life_noise,
        profile: args.profile,
        draws: args.draws,
        seed: args.seed,
    };
    let stem = out.file_stem().map_or_else(|| "my".into(), |stem| stem.to_string_lossy().into_owned());
    let beside = |ending: &str| out.with_file_name(format!("{stem}{ending}"));
    let places = [out.to_owned(), beside("-posterior.parquet"), beside("-calibration.json"), beside("-report.html")];
    let inputs = study.inputs();
    let files = Files::new(inputs.iter().map(PathBuf::as_path), voice.force);
    places.iter().try_for_each(|place| files.check(place))?;
    let bar = Bar::of(voice, "parts");
    let result = study.run(&toolroom_parquet::read_cells, &|done, total| bar.part(done, total));
    bar.finish();
    let result = result.map_err(|refusal| {
        let code = if refusal.is_unreadable { codes::UNREADABLE } else { codes::ARGUMENT };
        Failure::argument_of(code, &refusal.reason, &refusal.fix).at(refusal.at)
    })?;
    let calibration = &result.calibration;
    voice.say(result.read.to_string().trim_end());
    let advice = args.decision.as_deref().map(|path| decision::advise(path, calibration)).transpose()?;
    if let Some(folder) = out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|source| Failure::Unwritable { path: folder.to_owned(), source })?;
    }
    // A set holds minutes: lives in operations enter none.
    let timed = calibration.measured.clock == Clock::Minutes;
    if timed {
        files.put(&places[0], calibration.set_file(&stem, &result.based_on).as_bytes())?;
        write_draws(&files, &places[1], &result.drawn())?;
    }
    let model = &calibration.carried().model;
    let mut json = calibration.json();
    if let Some(advice) = &advice {
        json["decision"] = advice.json(model);
    }
    let text = serde_json::to_string_pretty(&json).map_err(Failure::Json)? + "\n";
    files.put(&places[2], text.as_bytes())?;
    let bytes = std::fs::read(data).unwrap_or_default();
    let words = ["--model".to_owned(), study.model.clone()];
    let origin = provenance(
        &format!("calibrate {} --data", process.name()),
        &[(data.display().to_string(), &bytes)],
        words,
        Some(args.seed),
    );
    let mut report = calibration.report();
    if let Some(advice) = &advice {
        report = report.section(advice.section(model));
    }
    files.put(&places[3], report.provenance(origin).html().as_bytes())?;
    if voice.json {
        voice.json(&json)?;
    } else {
        voice.data(calibration.text().trim_end())?;
        if let Some(advice) = &advice {
            voice.data(advice.text(model).trim_end())?;
        }
    }
    let written = if timed { &places[..] } else { &places[2..] };
    written.iter().for_each(|place| voice.say(format_args!("wrote {}", place.display())));
    if !timed {
        voice.say(format_args!("no parameter set: its lives are minutes, and the records have no cutting_time"));
    }
    if args.strict && calibration.undetermined() {
        let what = match calibration.choice.verdict {
            Verdict::CannotTell => "the law",
            Verdict::Chosen | Verdict::Given => "a parameter",
        };
        return Err(Failure::work(format_args!("--strict: {what} is not determined by these data")));
    }
    Ok(())
}

/// Writes a table of draws.
pub fn write_draws(files: &Files, place: &Path, table: &DrawnTable) -> Result<(), Failure> {
    let begun = files.begin(place)?;
    let file = begun.file.try_clone().map_err(|source| Failure::Unwritable { path: place.to_owned(), source })?;
    let written = table.write(file, &toolroom_parquet::create);
    written.map_err(|error| Failure::work(format_args!("{}: {error}", place.display())))?;
    Ok(files.end(begun)?)
}
