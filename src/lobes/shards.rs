//! Charts in shards: the columns of the grid are cut into parts. Boundaries, which are traced from
//! column to column, and operating points cost a tenth of the grid and are worked out at the merge.

use super::{Origin, finish, refused};
use crate::args::LobesArgs;
use crate::failure::Failure;
use crate::plan::leave;
use crate::progress::Bar;
use crate::speak::Voice;
use crate::study::{RESUME, default_out};
use std::fs;
use std::path::Path;
use std::time::Instant;
use toolroom_chatter::Lobes;
use toolroom_form::FormFile;
use toolroom_output::signals::{Begun, keeps, partials, tidy};
use toolroom_output::{Files, OutputDir};
use toolroom_planning::lobes::{self, Columns, LobesFile, NAMES};
use toolroom_shards::{Computed, Plan, ShardError, at};
use toolroom_study::study::Progress;

/// `--plan FILE`: the columns of the grid cut into shards.
pub fn plan(
    input: &str,
    file: &FormFile<LobesFile>,
    args: &LobesArgs,
    target: &Path,
    voice: &Voice,
) -> Result<(), Failure> {
    if file.content.chart.boundary_only {
        let help = "a boundary is traced from column to column and takes no grid; plan it with --set chart.boundary_only=false, or run it here";
        return Err(Failure::argument("a boundary alone cannot be cut into shards", help));
    }
    let version = env!("CARGO_PKG_VERSION");
    let plan = lobes::plan(version, input, file, args.set.clone(), args.shards)?;
    let inputs = file.files.iter().map(AsRef::as_ref).chain([Path::new(input)]);
    leave(&plan, target, &Files::new(inputs, voice.force))?;
    let (shown, shards, columns) = (target.display(), plan.shards, plan.pieces);
    voice.say(format_args!(
        "wrote {shown}: {shards} shards of {columns} columns   next: toolroom lobes --run {shown} --shard 0 --out parts"
    ));
    Ok(())
}

/// Columns that are kept together while a chart is judged (assumption: some seconds of work in the shipped charts).
const KEPT: u64 = 8;

/// The grid of a chart, judged some columns at a time, each of which is kept for going on.
pub fn grid(
    input: &str,
    file: &FormFile<LobesFile>,
    args: &LobesArgs,
    output_dir: &OutputDir,
    voice: &Voice,
) -> Result<Lobes, Failure> {
    let columns = file.content.chart.speed.points as u64;
    let version = env!("CARGO_PKG_VERSION");
    let shards = Some(columns.div_ceil(KEPT).max(1));
    let plan = lobes::plan(version, input, file, args.set.clone(), shards)?;
    let parts = output_dir.journal(args.resume)?;
    partials(&parts).try_for_each(fs::remove_file).map_err(at(&parts))?;
    // A part is there as a whole or not at all: a signal ends the program at once.
    let _tidy = tidy(Begun::Partials(parts.clone()));
    let bar = Bar::new(voice);
    for number in 0..plan.shards {
        shard_of(&file.content, &plan, number, &parts)?;
        let message = format!("interrupted: {} of {} parts of the chart are kept", number + 1, plan.shards);
        keeps(message, RESUME.to_owned());
        bar.at(Progress { done: number as u32 + 1, total: plan.shards as u32 });
    }
    bar.finish();
    whole(&file.content, &plan, &parts)
}

/// The grid from its parts.
fn whole(file: &LobesFile, plan: &Plan, parts: &Path) -> Result<Lobes, Failure> {
    let checked = |columns: &Columns, (from, to): (u64, u64)| columns.checked(&file.chart, to - from);
    let parts = toolroom_shards::parts(plan, parts, checked)?;
    Columns::merged(&file.chart, parts).map_err(refused)
}

/// One shard of a planned chart.
pub fn shard(plan: &Plan, number: u64, folder: &Path) -> Result<(), Failure> {
    shard_of(&lobes::chart(plan)?.content, plan, number, folder)
}

fn shard_of(file: &LobesFile, plan: &Plan, number: u64, folder: &Path) -> Result<(), Failure> {
    let mut refusal = None;
    let ran = toolroom_shards::run(plan, number, folder, |(from, to), _| {
        let content = match Columns::new(file, from, to) {
            Ok(columns) => columns,
            Err(error) => {
                refusal = Some(refused(error));
                let source = std::io::Error::other("the chart was refused");
                return Err(ShardError::File { path: folder.to_owned(), source });
            }
        };
        let digest = content.digest();
        Ok(Computed { content, digest, rows: false })
    });
    match refusal {
        Some(refusal) => Err(refusal),
        None => ran.map_err(Failure::from),
    }
}

/// Merges the parts of a planned chart: the same files and digest as without a plan.
pub fn merge(plan: &Plan, parts: &Path, out: Option<&Path>, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let file = lobes::chart(plan)?;
    let out = out.map_or_else(|| default_out(&plan.name), Path::to_owned);
    let out = OutputDir::create(&out, NAMES, file.files.iter().map(AsRef::as_ref), voice.force)?;
    let grid = whole(&file.content, plan, parts)?;
    let origin = Origin { file: &plan.file, changes: &plan.overrides, start };
    finish(&file, Some(grid), &origin, None, out, voice)
}
