//! `toolroom gap blind`: the withheld-effect benchmark.
//!
//! Every case is a shop of `toolroom-truth`, whose equations, integrator and noise are none of the
//! models'. It is diagnosed with the shipped nominal model of its process; what was hidden is
//! looked at only afterwards.

mod judged;
mod markdown;
mod row;
mod shrunk;
mod tally;

use crate::args::{BlindArgs, BlindCases};
use crate::failure::Failure;
use crate::output::{OutputDir, provenance};
use crate::progress::Bar;
use crate::speak::Voice;
use judged::judged;
use rayon::prelude::*;
use row::Row;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;
use tally::{Ablation, Tally};
use toolroom_gap::{Method, NominalModel};
use toolroom_study::study::Progress;
use toolroom_truth::{Case, Extent, GENERATORS, Set, suite};

/// Shipped nominal models, by process.
const MODELS: &[(&str, &str)] = &[
    ("turning", include_str!("../../scenarios/gap/turning.toml")),
    ("milling", include_str!("../../scenarios/gap/milling.toml")),
    ("grinding", include_str!("../../scenarios/gap/grinding.toml")),
    ("program", include_str!("../../scenarios/gap/program.toml")),
    ("shop", include_str!("../../scenarios/gap/shop.toml")),
];

/// The method with nothing left out.
const WHOLE: &str = "whole";

/// The whole method, to leave parts of it out.
const ALL: Method =
    Method { allowance: true, abstention: true, tolerance: true, scatter: true, memory: true, processes: 1 };

/// What is left of the method without its parts.
const PARTS: [(&str, Method); 5] = [
    ("without form tolerance", Method { tolerance: false, ..ALL }),
    ("without abstention", Method { abstention: false, ..ALL }),
    ("without factors of edges", Method { scatter: false, ..ALL }),
    ("without form allowance", Method { allowance: false, ..ALL }),
    (
        "naive: no allowance, tolerance or abstention, white noise",
        Method { allowance: false, abstention: false, tolerance: false, memory: false, ..ALL },
    ),
];

/// Cases on which the parts are left out: a third of the effects at their ordinary strength and of
/// the nulls, half of the causes outside the catalogue.
fn in_ablation(case: &Case) -> bool {
    match case.set {
        Set::Effect => case.hidden.iter().all(|hidden| hidden.strength == 1.0) && case.seed.is_multiple_of(3),
        Set::Null => case.seed.is_multiple_of(3),
        Set::Outside => case.seed.is_multiple_of(2),
        _ => false,
    }
}

pub fn run(args: &BlindArgs, voice: &Voice) -> Result<(), Failure> {
    let names = &["cases.csv", "rates.md", "blind.json"];
    let gathered_from: Vec<PathBuf> = args.from.iter().map(|directory| directory.join("cases.csv")).collect();
    let inputs = || gathered_from.iter().map(PathBuf::as_path);
    let out = args.out.as_deref().map(|target| OutputDir::create(target, names, inputs(), voice.force)).transpose()?;
    let start = Instant::now();
    let rows = if args.from.is_empty() { diagnosed(args, voice)? } else { gathered(args)? };
    let (tallies, ablations) = (Tally::of_processes(&rows), Ablation::of_processes(&rows));
    let mut summary = tally::json(&tallies, &ablations);
    if let Some(out) = out {
        out.put("cases.csv", &row::csv(&rows)?)?;
        out.put("rates.md", &markdown::tables(&tallies, &ablations, &rows))?;
        out.put_json("blind.json", &summary)?;
        let seed = args.from.is_empty().then_some(args.seed);
        out.record(&provenance("gap blind", &[], arguments(args), seed), start.elapsed())?;
        voice.say(format_args!("wrote {}", out.publish()?.join("cases.csv").display()));
    }
    if voice.json {
        summary["cases"] = serde_json::to_value(&rows).map_err(Failure::Json)?;
        return voice.json(&summary);
    }
    tallies.iter().try_for_each(|tally| voice.data(tally))?;
    ablations.iter().try_for_each(|ablation| voice.data(ablation))
}

/// The arguments as they have to be typed.
fn arguments(args: &BlindArgs) -> Vec<String> {
    if !args.from.is_empty() {
        return args.from.iter().flat_map(|from| ["--from".to_owned(), from.display().to_string()]).collect();
    }
    let mut list = vec!["--seed".to_owned(), args.seed.to_string(), "--cases".to_owned(), args.cases.name().to_owned()];
    args.process.iter().for_each(|process| list.extend(["--process".to_owned(), process.clone()]));
    args.part.iter().for_each(|(k, n)| list.extend(["--part".to_owned(), format!("{k}/{n}")]));
    args.only.iter().for_each(|only| list.extend(["--only".to_owned(), only.clone()]));
    if args.times > 1 {
        list.extend(["--times".to_owned(), args.times.to_string()]);
    }
    if args.form > 0.0 {
        list.extend(["--form".to_owned(), args.form.to_string()]);
    }
    if args.no_ablations {
        list.push("--no-ablations".to_owned());
    }
    list
}

/// Cases of finished runs, each once.
fn gathered(args: &BlindArgs) -> Result<Vec<Row>, Failure> {
    let mut rows: Vec<Row> = Vec::new();
    for directory in &args.from {
        rows.extend(row::read(directory)?);
    }
    let key = |row: &Row| (row.seed, row.process.clone(), row.method.clone());
    rows.sort_by_key(|row| (row.method != WHOLE, key(row)));
    if let Some(twice) = rows.windows(2).find(|pair| key(&pair[0]) == key(&pair[1])) {
        let message = format!("the case {} of {} stands in two of the runs", twice[0].seed, twice[0].process);
        return Err(Failure::argument(message, "give runs of other seeds, processes or parts"));
    }
    Ok(rows)
}

/// Every chosen case with its answer, first by the whole method, then by those without its parts.
fn diagnosed(args: &BlindArgs, voice: &Voice) -> Result<Vec<Row>, Failure> {
    let cases = chosen(args)?;
    let processes: BTreeSet<&str> = cases.iter().map(|case| case.process).collect();
    let models = processes.into_iter().map(|process| Ok((process, nominal(process)?)));
    let models = models.collect::<Result<BTreeMap<&str, NominalModel>, Failure>>()?;
    let ablations = args.cases == BlindCases::Full && !args.no_ablations;
    let parts: &[(&str, Method)] = if ablations { &PARTS } else { &[] };
    let reduced = || cases.iter().filter(|case| in_ablation(case));
    let mut work: Vec<(&Case, &str, Method)> = cases.iter().map(|case| (case, WHOLE, ALL)).collect();
    work.extend(parts.iter().flat_map(|(name, method)| reduced().map(move |case| (case, *name, *method))));
    let bar = Bar::new(voice);
    let done = AtomicU32::new(0);
    let total = work.len() as u32;
    let judge = |(case, name, method): &(&Case, &str, Method)| {
        let row = judged(case, &models[case.process], name, *method);
        bar.at(Progress { done: done.fetch_add(1, Ordering::Relaxed) + 1, total });
        row
    };
    let rows = work.par_iter().map(judge).collect();
    bar.finish();
    rows
}

fn chosen(args: &BlindArgs) -> Result<Vec<Case>, Failure> {
    let mut cases = suite(args.seed, if args.cases == BlindCases::Full { Extent::Full } else { Extent::Smoke });
    if let Some(process) = &args.process {
        cases.retain(|case| case.process == process);
        if cases.is_empty() {
            let known: Vec<&str> = GENERATORS.iter().map(|generator| generator.process).collect();
            let message = format!("no hidden effects are known for the process `{process}`");
            return Err(Failure::argument(message, format_args!("one of: {}", known.join(", "))));
        }
    }
    if let Some(only) = &args.only {
        cases.retain(|case| case.set.name() == only || (only == "outside" && case.set == Set::Outside));
        if cases.is_empty() {
            let message = format!("no cases of the set `{only}`");
            return Err(Failure::argument(message, "one of: null, effect, pair, outside, stress world"));
        }
    }
    for case in &mut cases {
        (case.times, case.form) = (args.times, args.form);
    }
    if let Some((k, n)) = args.part {
        let mut at = 0;
        cases.retain(|_| {
            at += 1;
            at % n == k % n
        });
    }
    Ok(cases)
}

fn nominal(process: &str) -> Result<NominalModel, Failure> {
    let text = MODELS.iter().find(|(name, _)| *name == process).map_or("", |(_, text)| text);
    NominalModel::parse(&format!("{process}.toml"), text, &[])
        .map_err(|error| Failure::Work { message: format!("the shipped nominal model of {process}: {error}") })
}
