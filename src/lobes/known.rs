//! How well the cutting force of a chart is known, by the draws of a calibration.

use crate::failure::Failure;
use std::path::Path;
use std::sync::Arc;
use toolroom_chatter::Scatter;
use toolroom_cutting::Turning;
use toolroom_planning::lobes::{Cut, LobesFile};
use toolroom_scenario::{DrawTable, Posterior, ProcessModel};
use toolroom_wear::{Pair, ParameterSet, TURNING_SETS};

/// Puts the spread of the cutting force over `draws` of the parameters of `set` in place of what the file says of its
/// coefficients: at the feed of the chart, and the speed and depth of the set.
///
/// # Errors
/// A chart of no turning cut, a set or a table that cannot be read, draws without force or of a force that is all but unknown.
pub fn settle(file: &mut LobesFile, set: &str, draws: &Path) -> Result<(), Failure> {
    let refuse = |reason: String, fix: &str| Failure::of_file(draws, reason, fix);
    if !matches!(file.cut, Cut::Turning(..)) {
        let reason = "forces are calibrated in turning, and the chart is of another process".to_owned();
        return Err(refuse(reason, "state `coefficients` of [scatter]"));
    }
    let fix = "--parameter-set names the set that the calibration wrote";
    let set = ParameterSet::load(set, Path::new(""), &TURNING_SETS)
        .map_err(|error| Failure::located(error.told_apart("turning", toolroom_cutting::process_of_set), fix))?;
    let pair = Pair::of_set(&set).map_err(|error| Failure::argument(error, fix))?;
    let read = toolroom_parquet::read_cells(draws).map_err(|error| {
        refuse(error.to_string(), "--parameters-from takes the draws that toolroom calibrate writes")
    })?;
    let table = DrawTable { header: read.header, rows: read.rows.into_iter().map(|(_, cells)| cells).collect() };
    let process = ProcessModel::Turning(Arc::new(Turning { pair: pair.clone(), ..Turning::default() }));
    let posterior = Posterior::of(&table, &process, true)
        .map_err(|reason| refuse(reason, "the draws and --parameter-set belong together"))?;
    let mut cut = pair.reference_cut();
    cut.feed_per_rev = file.feed.unwrap_or(cut.feed_per_rev);
    let drawn = posterior.pairs(0, "lobes", &pair, &toolroom_wear::Scatter::none());
    let forces: Vec<f64> = drawn.iter().map(|(pair, _)| pair.force.load(&cut).sharp.ln()).collect();
    let count = forces.len() as f64;
    let mean = forces.iter().sum::<f64>() / count;
    let variance = forces.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let coefficients = variance.sqrt();
    if !(coefficients > 0.0 && coefficients <= 1.0) {
        let reason =
            if coefficients > 1.0 { "the cutting force is all but unknown" } else { "it holds no cutting force" };
        return Err(refuse(reason.to_owned(), "calibrate on records with cutting_force"));
    }
    let scatter = file.scatter.unwrap_or(Scatter { natural_frequency: 0.0, damping_ratio: 0.0, coefficients });
    file.scatter = Some(Scatter { coefficients, ..scatter });
    Ok(())
}
