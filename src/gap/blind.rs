//! `toolroom gap blind`: the withheld-effect benchmark.
//!
//! Every case is a shop of `toolroom-truth`, whose equations, integrator and noise are none of the
//! models'. It is diagnosed with the shipped nominal model of its process; what was hidden is
//! looked at only afterwards.

mod judged;
mod shrunk;
mod tally;

use crate::args::{BlindArgs, BlindCases};
use crate::failure::Failure;
use crate::output::{OutputDir, provenance};
use crate::progress::Bar;
use crate::speak::Voice;
use judged::Judged;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;
use tally::{Ablation, Tally};
use toolroom_analysis::gap::{Method, NominalModel};
use toolroom_analysis::study::Progress;
use toolroom_truth::{Case, Extent, GENERATORS, Set, suite};

/// Shipped nominal models, by process.
const MODELS: &[(&str, &str)] = &[
    ("turning", include_str!("../../scenarios/gap/turning.toml")),
    ("milling", include_str!("../../scenarios/gap/milling.toml")),
    ("grinding", include_str!("../../scenarios/gap/grinding.toml")),
    ("program", include_str!("../../scenarios/gap/program.toml")),
    ("shop", include_str!("../../scenarios/gap/shop.toml")),
];

/// What is left of the method without its parts.
const ABLATIONS: [(&str, Method); 4] = [
    (
        "without form tolerance",
        Method { allowance: true, abstention: true, tolerance: false, memory: true, processes: 1 },
    ),
    ("without abstention", Method { allowance: true, abstention: false, tolerance: true, memory: true, processes: 1 }),
    (
        "without form allowance",
        Method { allowance: false, abstention: true, tolerance: true, memory: true, processes: 1 },
    ),
    (
        "naive: no allowance, tolerance or abstention, white noise",
        Method { allowance: false, abstention: false, tolerance: false, memory: false, processes: 1 },
    ),
];

/// Cases on which the ablations are tried: a third of the effects at their ordinary strength and of
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
    let out = args.out.as_deref().map(OutputDir::create).transpose()?;
    let start = Instant::now();
    let cases = chosen(args)?;
    let processes: BTreeSet<&str> = cases.iter().map(|case| case.process).collect();
    let models = processes.into_iter().map(|process| Ok((process, nominal(process)?)));
    let models = models.collect::<Result<BTreeMap<&str, NominalModel>, Failure>>()?;
    let bar = Bar::new(voice);
    let done = AtomicU32::new(0);
    let methods: &[(&'static str, Method)] = if args.cases == BlindCases::Full { &ABLATIONS } else { &[] };
    let reduced: Vec<Case> = cases.iter().filter(|case| in_ablation(case)).cloned().collect();
    let total = (cases.len() + methods.len() * reduced.len()) as u32;
    let judge = |case: &Case, method: Method| {
        let judged = Judged::of(case, &models[case.process], method);
        bar.at(Progress { done: done.fetch_add(1, Ordering::Relaxed) + 1, total });
        judged
    };
    let all = |cases: &[Case], method: Method| -> Result<Vec<Judged>, Failure> {
        cases.par_iter().map(|case| judge(case, method)).collect()
    };
    let judged = all(&cases, Method::default())?;
    let mut ablations: Vec<Ablation> = Vec::new();
    for (name, method) in methods {
        ablations.extend(Ablation::of_processes(name, &all(&reduced, *method)?));
    }
    if !ablations.is_empty() {
        ablations.extend(Ablation::of_processes(
            "the whole method, same cases",
            judged.iter().filter(|judged| in_ablation(&judged.case)),
        ));
    }
    bar.finish();
    let tallies: Vec<Tally> = GENERATORS
        .iter()
        .map(|generator| Tally::new(generator.process, &judged))
        .filter(|tally| tally.cases > 0)
        .collect();
    if let Some(out) = out {
        out.put("cases.csv", &judged::table(&judged))?;
        out.put_json("blind.json", &tally::json(&tallies, &ablations, &judged))?;
        let arguments = [format!("--seed {} --cases {}", args.seed, args.cases.name())];
        out.record(&provenance("gap blind", &[], arguments, Some(args.seed)), start.elapsed())?;
        voice.say(format_args!("wrote {}", out.publish()?.join("cases.csv").display()));
    }
    if voice.json {
        voice.json(&tally::json(&tallies, &ablations, &judged))
    } else {
        tallies.iter().try_for_each(|tally| voice.data(tally))?;
        ablations.iter().try_for_each(|ablation| voice.data(ablation))
    }
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
    Ok(cases)
}

fn nominal(process: &str) -> Result<NominalModel, Failure> {
    let text = MODELS.iter().find(|(name, _)| *name == process).map_or("", |(_, text)| text);
    NominalModel::parse(&format!("{process}.toml"), text, &[])
        .map_err(|error| Failure::Work { message: format!("the shipped nominal model of {process}: {error}") })
}
