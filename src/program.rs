//! `toolroom program`: the nominal cycle time of a part program.

use crate::args::ProgramArgs;
use crate::failure::Failure;
use crate::output::{Files, no_table};
use crate::speak::Voice;
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use toolroom_contour::{Block, Drives, Program, Units};
use toolroom_process::table::{Cell, csv_text};
use toolroom_process::{AnyRecord, Record, unit};

/// What a refused program is about.
pub const REFUSED: &str = "a word that is not followed could move an axis or take time, so none is passed over";

/// Time of the blocks that one tool runs.
#[derive(Default)]
struct Share {
    tool: Option<u32>,
    blocks: usize,
    feed: f64,
    rapid: f64,
    dwell: f64,
    changes: u32,
    holes: u32,
    total: f64,
}

pub fn run(args: &ProgramArgs, voice: &Voice) -> Result<(), Failure> {
    let name = args.file.display().to_string();
    let text = fs::read_to_string(&args.file)
        .map_err(|error| Failure::argument(format!("{name}: {error}"), "check the path"))?;
    let files = Files::new([args.file.as_path()], voice.force);
    args.blocks.as_ref().map_or(Ok(()), |path| files.check(path))?;
    let drives = drives(&args.set)?;
    let program = Program::read_in(&text, args.units.as_deref().and_then(Units::named))
        .map_err(|error| Failure::argument(format!("{name}: {error}"), REFUSED))?;
    let times = program.times(&drives);
    let mut shares: Vec<Share> = Vec::new();
    for (block, time) in program.blocks.iter().zip(&times) {
        // Blocks before the first tool go with it.
        if shares.last().is_none_or(|share| share.tool.is_some() && share.tool != block.tool) {
            shares.push(Share::default());
        }
        if let Some(share) = shares.last_mut() {
            share.tool = share.tool.or(block.tool);
            share.take(block, *time, &drives);
        }
    }
    if let Some(path) = &args.blocks {
        files.put(path, table(&program, &times, &drives)?.as_bytes())?;
        voice.say(format_args!("wrote {}", path.display()));
    }
    if !program.unknown.is_empty() {
        let first = program.unknown[0];
        let count = program.unknown.len();
        voice.say(format_args!(
            "{count} blocks move axes from places that only the machine knows (first: line {first}); those axes count as standing"
        ));
    }
    let total: f64 = times.iter().sum();
    if voice.json {
        let rows: Vec<Value> = shares.iter().map(Share::json).collect();
        return voice.json(&json!({
            "schema": 1, "cycle_time [s]": total, "blocks": program.blocks.len(),
            "blocks_from_unknown_places": program.unknown, "tools": rows,
        }));
    }
    let mut text = format!(
        "{:>6} {:>8} {:>10} {:>10} {:>9} {:>8} {:>6} {:>11}",
        "tool", "blocks", "feed [s]", "rapid [s]", "dwell [s]", "changes", "holes", "total [s]"
    );
    for share in &shares {
        let tool = share.tool.map_or("–".to_owned(), |tool| format!("T{tool}"));
        let _ = write!(
            text,
            "\n{tool:>6} {:>8} {:>10.1} {:>10.1} {:>9.1} {:>8} {:>6} {:>11.1}",
            share.blocks, share.feed, share.rapid, share.dwell, share.changes, share.holes, share.total
        );
    }
    let _ = write!(text, "\n{:>6} {:>8} {:>58.1}", "all", program.blocks.len(), total);
    voice.data(text)
}

impl Share {
    fn take(&mut self, block: &Block, time: f64, drives: &Drives) {
        self.blocks += 1;
        self.feed += block.feed_time();
        self.rapid += block.nominal(drives.rapid_speed) - block.feed_time() - block.dwell;
        self.dwell += block.dwell;
        self.changes += u32::from(block.tool_change);
        self.holes += block.holes;
        self.total += time;
    }

    fn json(&self) -> Value {
        json!({
            "tool": self.tool, "blocks": self.blocks, "feed_time [s]": self.feed, "rapid_time [s]": self.rapid,
            "dwell [s]": self.dwell, "tool_changes": self.changes, "holes": self.holes, "cycle_time [s]": self.total,
        })
    }
}

/// Drives with the values of `--set`.
fn drives(set: &[String]) -> Result<Drives, Failure> {
    let mut drives = Drives::<f64>::default();
    let names = || Drives::<f64>::FIELDS.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
    for text in set {
        let (key, value) = text.split_once('=').unwrap_or((text, ""));
        let index = Drives::<f64>::index_of(key).ok_or_else(|| {
            Failure::argument(format!("--set {text}: no value `{key}`"), format!("there are {}", names()))
        })?;
        let field = &Drives::<f64>::FIELDS[index];
        let number = unit::quantity(value, field.unit).map_err(|error| {
            Failure::argument(format!("--set {text}: {error}"), format!("write {key}=\"1 {}\"", field.display))
        })?;
        drives.set_value(index, number);
    }
    drives.check().map_err(|error| Failure::argument(error, "see the ranges in the documentation of Drives"))?;
    Ok(drives)
}

fn table(program: &Program, times: &[f64], drives: &Drives) -> Result<String, Failure> {
    let columns = ["line", "tool", "feed_time [s]", "rapid_time [s]", "dwell [s]", "tool_change", "holes", "time [s]"];
    let row = |(block, time): (&Block, &f64)| -> [Cell<'_>; 8] {
        let rapid = block.nominal(drives.rapid_speed) - block.feed_time() - block.dwell;
        [
            block.line.into(),
            block.tool.into(),
            Cell::Fixed(block.feed_time(), 6),
            Cell::Fixed(rapid, 6),
            Cell::Fixed(block.dwell, 3),
            u32::from(block.tool_change).into(),
            block.holes.into(),
            Cell::Fixed(*time, 6),
        ]
    };
    csv_text(columns, program.blocks.iter().zip(times).map(row))
        .map_err(|error| no_table("the table of blocks", &error))
}
