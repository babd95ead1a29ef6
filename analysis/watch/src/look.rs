//! What a look at the records shows.

use crate::blocks::{blocks, time_column};
use crate::watch::{Alarm, FEWEST_BLOCKS, Watch};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use toolroom_gap::{NominalModel, diagnose_parts};
use toolroom_records::Records;

const DAY: f64 = 86400.0;
const YEAR: f64 = 365.25 * DAY;
/// Streams of which the statistic is shown.
const SHOWN: usize = 5;

/// What a look has shown.
#[derive(Clone, Debug)]
pub struct Look {
    /// Alarms, with what a diagnosis of the rows since the change says.
    pub alarms: Vec<(Alarm, String)>,
    /// Blocks that were new.
    new: usize,
    /// Threshold, blocks.
    threshold: f64,
    /// False alarms a year that are promised.
    per_year: f64,
    /// The watch after it.
    watch: Watch,
}

impl Watch {
    /// Looks at all records of a shop so far, of which those that were seen change nothing: blocks are made by the column
    /// `group`, if given, and `per_year` (above 0) false alarms a year are promised for all streams together. `None` where
    /// no block is complete.
    pub fn look_at(
        &mut self,
        model: &NominalModel,
        records: &Records,
        group: Option<&str>,
        per_year: f64,
    ) -> Option<Look> {
        let blocks = blocks(model, records, group);
        let times = blocks.iter().map(|block| block.time);
        let (first, last) = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), time| (a.min(time), b.max(time)));
        if blocks.is_empty() {
            return None;
        }
        let readings = blocks.iter().map(|block| block.readings.len()).sum::<usize>() as f64;
        // Readings of all streams within a year; of a log shorter than a day those of a day.
        let threshold = Self::threshold(1, readings / ((last - first).max(DAY) / YEAR), per_year);
        let before = self.blocks();
        let alarms = self.look(&blocks, threshold);
        // One cause moves several streams, often from one block on: what followed is diagnosed once.
        let mut known: BTreeMap<u64, String> = BTreeMap::new();
        let alarms = alarms.into_iter().map(|alarm| {
            let since = known.entry(alarm.change.to_bits());
            let since = since.or_insert_with(|| since_change(model, records, group, &alarm)).clone();
            (alarm, since)
        });
        let alarms = alarms.collect();
        Some(Look { alarms, new: self.blocks() - before, threshold, per_year, watch: self.clone() })
    }
}

/// What a diagnosis of the rows after a change says.
fn since_change(model: &NominalModel, records: &Records, group: Option<&str>, alarm: &Alarm) -> String {
    let Some(times) = records.numbers(time_column(records)) else {
        return "the records have no times: rows after the change cannot be told".to_owned();
    };
    let rows: Vec<usize> = (0..records.len()).filter(|row| times[*row] >= alarm.change).collect();
    let asked = model.asked(&records.select(&rows), group, |_, _| false);
    if asked.parts.iter().all(|part| part.frame().measured.fitted_groups().count() < 2) {
        return "too few groups since then for a diagnosis".to_owned();
    }
    let diagnosis = diagnose_parts(&asked.parts, 1);
    let names: Vec<String> = diagnosis.effects.iter().map(|effect| effect.id.to_string()).collect();
    match &names[..] {
        [] => format!("the rows since then are `{}` by themselves", diagnosis.verdict.name()),
        names => format!("the rows since then show {}", names.join(" and ")),
    }
}

impl Look {
    /// A few lines for the terminal.
    pub fn text(&self) -> String {
        let (streams, learning) = self.watch.streams();
        let mut text = format!(
            "blocks   {} new, {} in all; {streams} streams, threshold {:.0} blocks\n",
            self.new,
            self.watch.blocks(),
            self.threshold
        );
        if learning > 0 {
            let _ = writeln!(
                text,
                "learning {learning} of {streams} streams have fewer than {FEWEST_BLOCKS} blocks: no alarm is possible there"
            );
        }
        for (alarm, after) in &self.alarms {
            let [first, last] = alarm.span;
            let _ = writeln!(
                text,
                "alarm    {}: changed at day {:.1} (90 %: day {:.1} … {:.1}) by {:+.1} standard deviations of a block, seen on day {:.1}",
                alarm.stream,
                alarm.change / DAY,
                first / DAY,
                last / DAY,
                alarm.shift,
                alarm.time / DAY
            );
            let _ = writeln!(text, "  {after}");
        }
        if self.alarms.is_empty() {
            let highest = self.watch.highest();
            let all: Vec<String> =
                highest.iter().take(SHOWN).map(|(name, statistic)| format!("{name} {statistic:.1}")).collect();
            let _ = writeln!(text, "no alarm; highest: {}", all.join(", "));
        }
        let years = self.watch.watched() / YEAR;
        let _ = writeln!(
            text,
            "promised {} false alarms a year; {} alarms in {:.2} years so far",
            self.per_year,
            self.watch.alarms.len(),
            years
        );
        if self.watch.late_rows > 0 {
            let _ = writeln!(
                text,
                "note     {} rows came after their block was taken in; they are not used",
                self.watch.late_rows
            );
        }
        text.trim_end().to_owned()
    }

    /// The same as JSON; times are s from the start of the records.
    pub fn json(&self) -> Value {
        let (streams, learning) = self.watch.streams();
        let alarm = |(alarm, after): &(Alarm, String)| {
            json!({
                "stream": alarm.stream, "time": alarm.time, "statistic": alarm.statistic, "change": alarm.change,
                "span90": alarm.span, "shift": alarm.shift, "since": after,
            })
        };
        let highest = self.watch.highest();
        json!({
            "schema": 1, "new_blocks": self.new, "blocks": self.watch.blocks(), "streams": streams,
            "learning": learning, "threshold": self.threshold,
            "alarms": self.alarms.iter().map(alarm).collect::<Vec<_>>(),
            "promised_per_year": self.per_year, "alarms_so_far": self.watch.alarms.len(),
            "years": self.watch.watched() / YEAR, "late_rows": self.watch.late_rows,
            "highest": highest.iter().take(SHOWN)
                .map(|(name, statistic)| json!({ "stream": name, "statistic": statistic })).collect::<Vec<_>>(),
        })
    }
}
