//! `toolroom life --fit DATA.csv`: laws of measured lives.

use super::request;
use crate::args::LifeArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_chart::page::Provenance;
use toolroom_life::measured::{Layout, read};
use toolroom_life::measured_study::{MeasuredStudy, MeasuredStudyError};
use toolroom_output::OutputDir;
use toolroom_shards::fingerprint;

pub fn run(args: &LifeArgs, csv: &Path, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let request = request(&args.statistics, None)?;
    let file = csv.display().to_string();
    let bytes = std::fs::read(csv).map_err(|error| Failure::unreadable(csv, error, "give a CSV file"))?;
    let measured = read(&file, &bytes, &layout(args)?, &args.regress)
        .map_err(|error| Failure::located(error, "toolroom life --help shows the columns"))?;
    for note in &measured.notes {
        voice.say(format_args!("note: {note}"));
    }
    let target = args.out.clone().unwrap_or_else(|| {
        let stem = csv.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        default_out(&format!("life-{stem}"))
    });
    let output_dir = OutputDir::create(&target, &["summary.json", "report.html"], [csv], voice.force)?;
    let study = MeasuredStudy::new(&measured, &args.regress, &request).map_err(refused)?;
    let provenance = Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: std::env::args().collect::<Vec<_>>().join(" "),
        seed: Some(request.seed),
        inputs: vec![(file.clone(), fingerprint(&bytes))],
    };
    let summary = study.summary(&file);
    let report = study.report(&file).provenance(provenance.clone());
    let wall = start.elapsed();
    output_dir.put_json("summary.json", &summary)?;
    output_dir.put("report.html", &report.html())?;
    output_dir.record(&provenance, wall)?;
    let target = output_dir.publish()?;
    if voice.json {
        voice.json(&summary)?;
    } else {
        voice.data(study.text().trim_end())?;
    }
    voice.detail(format_args!("{:.2} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

fn layout(args: &LifeArgs) -> Result<Layout, Failure> {
    let readings = &args.readings;
    let (Some(wear), Some(limit), Some(age)) = (&readings.wear, readings.limit, &readings.age) else {
        return Ok(Layout::Lives);
    };
    if !(limit > 0.0 && limit.is_finite()) {
        return Err(Failure::argument(format_args!("--limit {limit} is no wear"), "write for example --limit 0.3"));
    }
    Ok(Layout::Readings {
        edge: readings.edge.clone(),
        age: age.clone(),
        wear: wear.clone(),
        limit,
        group: readings.group.clone(),
        interpolate: !readings.between,
    })
}

fn refused(error: MeasuredStudyError) -> Failure {
    let help = match &error {
        MeasuredStudyError::Sample(_) => "a life is a positive number; an edge that was still good has censored = 1",
        MeasuredStudyError::TooFew(_) => "observe edges until some of them end",
        MeasuredStudyError::Regression(_) => "choose other columns with --regress",
    };
    Failure::argument(error, help)
}
