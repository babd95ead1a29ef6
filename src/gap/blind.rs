//! `toolroom gap blind`: the withheld-effect benchmark.

use crate::args::{BlindArgs, BlindCases};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use std::path::PathBuf;
use std::time::Instant;
use toolroom_blind::{Benchmark, BlindError, NAMES, Row, Selection, diagnose, gather};
use toolroom_output::{OutputDir, provenance};
use toolroom_study::study::Progress;
use toolroom_truth::Extent;

pub fn run(args: &BlindArgs, voice: &Voice) -> Result<(), Failure> {
    let tables: Vec<PathBuf> = args.from.iter().map(|directory| directory.join("cases.csv")).collect();
    let inputs = || tables.iter().map(PathBuf::as_path);
    let out = args.out.as_deref().map(|target| OutputDir::create(target, NAMES, inputs(), voice.force)).transpose()?;
    let start = Instant::now();
    let rows = if args.from.is_empty() { diagnosed(args, voice) } else { gather(&args.from) };
    let benchmark = Benchmark::new(rows.map_err(refused)?);
    if let Some(out) = out {
        out.put_all(&benchmark.files())?;
        let seed = args.from.is_empty().then_some(args.seed);
        out.record(&provenance("gap blind", &[], args.typed(), seed), start.elapsed())?;
        voice.say(format_args!("wrote {}", out.publish()?.join("cases.csv").display()));
    }
    if voice.json {
        let mut summary = benchmark.summary();
        summary["cases"] = serde_json::to_value(&benchmark.rows).map_err(Failure::Json)?;
        return voice.json(&summary);
    }
    benchmark.tallies.iter().try_for_each(|tally| voice.data(tally))?;
    benchmark.ablations.iter().try_for_each(|ablation| voice.data(ablation))
}

fn diagnosed(args: &BlindArgs, voice: &Voice) -> Result<Vec<Row>, BlindError> {
    let full = args.cases == BlindCases::Full;
    let extent = if full { Extent::Full } else { Extent::Smoke };
    let selection = Selection {
        seed: args.seed,
        extent,
        process: args.process.clone(),
        only: args.only.clone(),
        times: args.times,
        form: args.form,
        part: args.part,
    };
    let cases = selection.cases()?;
    let bar = Bar::new(voice);
    let rows = diagnose(&cases, full && !args.no_ablations, &|done, total| bar.at(Progress { done, total }));
    bar.finish();
    rows
}

fn refused(error: BlindError) -> Failure {
    match &error {
        BlindError::UnknownProcess { known, .. } | BlindError::UnknownSet { known, .. } => {
            let help = format!("one of: {}", known.join(", "));
            Failure::argument(error, help)
        }
        BlindError::Unreadable { .. } => {
            Failure::argument(error, "give directories that `toolroom gap blind --out` wrote")
        }
        BlindError::Twice { .. } => Failure::argument(error, "give runs of other seeds, processes or parts"),
        BlindError::Model { .. } | BlindError::Records { .. } => Failure::work_error(&error),
    }
}
