//! The warm-up of a shop that goes on, found before its figures are counted.

use crate::args::StudyArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::request_in;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use toolroom_output::signals as stop;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::ScenarioFile;
use toolroom_steady::{SteadyError, WarmUp, WarmUpSearch, find};
use toolroom_study::variants::VariantShop;

/// Finds the warm-up of a scenario that wants it, one for all of its policies and variants, and writes it into all of them.
/// A study that goes on has it already. `None` where the scenario gives a time.
pub fn settle(
    file: &mut ScenarioFile,
    variants: &mut [VariantShop],
    policies: &[usize],
    args: &StudyArgs,
    target: &Path,
    voice: &Voice,
) -> Result<Option<Arc<WarmUp>>, Failure> {
    if !file.scenario.seeks_warm_up {
        return Ok(None);
    }
    let earlier = if args.resume { request_in(target).and_then(|earlier| earlier.warm_up()) } else { None };
    let found = match earlier {
        Some(found) => found,
        None => Arc::new(sought(file, variants, policies, args.threads, voice)?),
    };
    let write = |scenario: &mut Scenario| (scenario.warm_up, scenario.seeks_warm_up) = (found.time, false);
    write(&mut file.scenario);
    variants.iter_mut().for_each(|variant| write(Arc::make_mut(&mut variant.scenario)));
    Ok(Some(found))
}

fn sought(
    file: &ScenarioFile,
    variants: &[VariantShop],
    policies: &[usize],
    threads: usize,
    voice: &Voice,
) -> Result<WarmUp, Failure> {
    let base = WarmUpSearch { name: "", scenario: &file.scenario };
    let others = variants.iter().map(|variant| WarmUpSearch { name: &variant.name, scenario: &variant.scenario });
    let shops: Vec<WarmUpSearch<'_>> = std::iter::once(base).chain(others).collect();
    let interrupted = Arc::new(AtomicBool::new(false));
    let _gentle = stop::gently(&interrupted);
    voice.detail(format_args!("finding the warm-up"));
    let found = find(&shops, policies, file.scenario.replications, threads, &interrupted);
    found.map_err(|error| match error {
        SteadyError::Stopped => Failure::Interrupted { message: error.to_string(), help: error.fix().to_owned() },
        SteadyError::TooShort { .. } => Failure::argument(&error, error.fix()),
        SteadyError::Shop { .. } | SteadyError::Threads { .. } => Failure::work_error(&error),
    })
}
