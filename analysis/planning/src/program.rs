//! The nominal cycle time of a part program, by tool and by block.

use crate::tables::table;
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_contour::{Block, Drives, Program};
use toolroom_process::table::Cell;

/// A part program with the time of each of its blocks.
#[derive(Clone, Debug)]
pub struct CycleTime {
    program: Program,
    drives: Drives,
    /// s, by block.
    times: Vec<f64>,
    shares: Vec<Share>,
}

/// Time of the blocks that one tool runs, s.
#[derive(Clone, Debug, Default)]
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

impl CycleTime {
    /// Times every block of a program on a machine with `drives`.
    pub fn new(program: Program, drives: Drives) -> Self {
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
        Self { program, drives, times, shares }
    }

    /// Lines of blocks that move axes from places that only the machine knows.
    pub fn unknown(&self) -> &[usize] {
        &self.program.unknown
    }

    fn total(&self) -> f64 {
        self.times.iter().sum()
    }

    /// Times by tool for programs.
    pub fn json(&self) -> Value {
        let rows: Vec<Value> = self.shares.iter().map(Share::json).collect();
        json!({
            "schema": 1, "cycle_time [s]": self.total(), "blocks": self.program.blocks.len(),
            "blocks_from_unknown_places": self.program.unknown, "tools": rows,
        })
    }

    /// Times by tool for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:>6} {:>8} {:>10} {:>10} {:>9} {:>8} {:>6} {:>11}",
            "tool", "blocks", "feed [s]", "rapid [s]", "dwell [s]", "changes", "holes", "total [s]"
        );
        for share in &self.shares {
            let tool = share.tool.map_or("–".to_owned(), |tool| format!("T{tool}"));
            let _ = write!(
                text,
                "\n{tool:>6} {:>8} {:>10.1} {:>10.1} {:>9.1} {:>8} {:>6} {:>11.1}",
                share.blocks, share.feed, share.rapid, share.dwell, share.changes, share.holes, share.total
            );
        }
        let _ = write!(text, "\n{:>6} {:>8} {:>58.1}", "all", self.program.blocks.len(), self.total());
        text
    }

    /// Times by block as CSV.
    pub fn table(&self) -> String {
        let Self { program, drives, times, .. } = self;
        let columns =
            ["line", "tool", "feed_time [s]", "rapid_time [s]", "dwell [s]", "tool_change", "holes", "time [s]"];
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
        table(columns, program.blocks.iter().zip(times).map(row))
    }
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
