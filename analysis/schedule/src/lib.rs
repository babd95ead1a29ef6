//! `schedule.html`: what every machine does over the whole run, to zoom and search in a browser.
//!
//! It is a page of its own: the report needs no script. Bars are 14 bytes each: start and length in tenths of a second,
//! machine and state, and whose work it is. Without script the page shows the share of each week in which machines are busy.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

use serde_json::json;
use std::fmt::Write as _;
use std::io;
use toolroom_chart::escape;
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::{MachineState, RunLog, StateRow};

/// Name of the page.
pub const FILE: &str = "schedule.html";

/// Most bars on a page: 1.9 MB of text. What comes later is left out, and said.
const MOST_BARS: usize = 100_000;

/// Machines that 12 bits tell apart.
const MOST_MACHINES: usize = 4096;

const PAGE: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("script.js");

/// Whose work it is: nobody's.
const NOBODY: u32 = u32::MAX;
/// A part without order, with its index.
const PART: u32 = 1 << 31;

const WEEK: f64 = 7.0 * 86_400.0;

/// Words and colour of a state.
fn style(state: MachineState) -> (&'static str, &'static str) {
    match state {
        MachineState::Cutting => ("cutting", "#00795c"),
        MachineState::Working => ("plain work", "#3a7d44"),
        MachineState::Handling => ("loading, unloading", "#56b4e9"),
        MachineState::Setup => ("setup", "#b0478a"),
        MachineState::ToolChange => ("tool change", "#e69f00"),
        MachineState::Dressing => ("dressing", "#0072b2"),
        MachineState::Starved => ("kept for an order", "#9ecae1"),
        MachineState::Blocked => ("blocked", "#8c6d31"),
        MachineState::WaitingOperator => ("waiting for operators", "#e3c800"),
        MachineState::WaitingFixture => ("waiting for fixtures", "#c9a0dc"),
        MachineState::WaitingTool => ("waiting for tools", "#f4a6a0"),
        MachineState::Maintenance => ("maintenance", "#6a51a3"),
        MachineState::Down => ("down", "#d55e00"),
        MachineState::Idle => ("idle", "#ffffff"),
        MachineState::OffShift => ("off shift", "#dfe3e8"),
    }
}

/// Writes the page of a run.
///
/// # Errors
/// What the file system says.
pub fn write(scenario: &Scenario, policy: &str, log: &RunLog, out: &mut impl io::Write) -> io::Result<()> {
    let shown = |row: &&StateRow| row.state != MachineState::Idle && (row.machine as usize) < MOST_MACHINES;
    let mut bars: Vec<&StateRow> = log.states.iter().filter(shown).collect();
    bars.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.machine.cmp(&b.machine)));
    let left_out = bars.len().saturating_sub(MOST_BARS);
    bars.truncate(MOST_BARS);
    let end = if left_out > 0 { bars.last().map_or(log.horizon, |row| row.end) } else { log.horizon };
    let mut what = format!("First replication under {policy}.");
    if left_out > 0 {
        let _ = write!(what, " The last {left_out} stays of machines are left out: a page has at most {MOST_BARS}.");
    }
    let data = serde_json::to_string(&data(scenario, log, &bars, end))?.replace('<', "\\u003c");
    let mut rest = PAGE;
    for (mark, text) in [
        ("{{title}}", escape(&scenario.title)),
        ("{{title}}", escape(&scenario.title)),
        ("{{what}}", escape(&what)),
        ("{{weeks}}", weeks(scenario, log)),
        ("{{data}}", data),
        ("{{script}}", SCRIPT.to_owned()),
    ] {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        out.write_all(before.as_bytes())?;
        out.write_all(text.as_bytes())?;
        rest = after;
    }
    out.write_all(rest.as_bytes())
}

/// What the script reads.
fn data(scenario: &Scenario, log: &RunLog, bars: &[&StateRow], end: f64) -> serde_json::Value {
    let states = MachineState::of(scenario).map(|state| {
        let (name, colour) = style(state);
        let job = state.is_busy() || matches!(state, MachineState::WaitingOperator | MachineState::Blocked);
        let used = bars.iter().any(|row| row.state == state);
        let off = state == MachineState::OffShift;
        json!({ "name": name, "colour": colour, "job": job, "busy": state.is_busy(), "off": off, "used": used })
    });
    let states: Vec<_> = states.collect();
    let machines = scenario.machines.iter().take(MOST_MACHINES);
    let machines: Vec<_> = machines.map(|own| json!({ "name": own.name, "group": own.location })).collect();
    let mut finishes = vec![0.0f64; scenario.orders.len()];
    for job in &log.jobs {
        if let Some(order) = job.order {
            let last = &mut finishes[order as usize];
            // One job that is in process leaves the order unfinished.
            *last = if job.finish.is_nan() || last.is_nan() { f64::NAN } else { last.max(job.finish) };
        }
    }
    let released = |order: usize| log.jobs.iter().any(|job| job.order == Some(order as u32));
    let orders = scenario.orders.iter().zip(&finishes).enumerate();
    let orders: Vec<_> = orders
        .map(|(index, (own, finish))| {
            let finish = Some(*finish).filter(|finish| finish.is_finite() && released(index));
            let late = finish.map(|finish| finish - own.due);
            json!({ "id": own.id, "part": own.part, "customer": own.customer, "due": own.due, "finish": finish, "late": late })
        })
        .collect();
    json!({
        "start": scenario.start,
        "from": scenario.warm_up,
        "horizon": end,
        "states": states,
        "machines": machines,
        "parts": scenario.parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>(),
        "orders": orders,
        "bars": base64(&packed(log, bars)),
    })
}

/// Bars as bytes, the least significant first.
fn packed(log: &RunLog, bars: &[&StateRow]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(14 * bars.len());
    for row in bars {
        // Tenths of a second: both ends are rounded, so that bars that touch still do.
        let [start, end] = [row.start, row.end].map(|time| (10.0 * time).round() as u32);
        let who = row
            .job
            .and_then(|job| log.jobs.get(job as usize))
            .map_or(NOBODY, |job| job.order.unwrap_or(PART | job.part));
        bytes.extend(start.to_le_bytes());
        bytes.extend((end - start).to_le_bytes());
        bytes.extend((((row.state as u32) << 12 | row.machine) as u16).to_le_bytes());
        bytes.extend(who.to_le_bytes());
    }
    bytes
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let three = chunk.iter().fold(0u32, |sum, byte| sum << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        for place in 0..4 {
            let letter = LETTERS[(three >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= chunk.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// Share of its time in shift in which every machine is busy, a column for each week from the start.
fn weeks(scenario: &Scenario, log: &RunLog) -> String {
    let count = (log.horizon / WEEK).ceil().max(1.0) as usize;
    let mut times = vec![vec![[0.0f64; 2]; count]; scenario.machines.len()];
    for row in log.states.iter().filter(|row| row.in_shift) {
        let (first, last) = ((row.start / WEEK) as usize, ((row.end / WEEK) as usize).min(count - 1));
        for (week, seconds) in times[row.machine as usize].iter_mut().enumerate().take(last + 1).skip(first) {
            let inside = row.end.min((week + 1) as f64 * WEEK) - row.start.max(week as f64 * WEEK);
            seconds[0] += if row.state.is_busy() { inside } else { 0.0 };
            seconds[1] += inside;
        }
    }
    let mut text = "<table><tr><th>machine</th>".to_owned();
    for week in 1..=count {
        let _ = write!(text, "<th>week {week}</th>");
    }
    text.push_str("</tr>");
    for (machine, weeks) in scenario.machines.iter().zip(&times) {
        let _ = write!(text, "<tr><th>{}</th>", escape(&machine.name));
        for [busy, shift] in weeks {
            let share = if *shift > 0.0 { 100.0 * busy / shift } else { 0.0 };
            let _ = write!(text, "<td style=\"background: rgb(76 120 168 / {share:.0}%)\">{share:.0} %</td>");
        }
        text.push_str("</tr>");
    }
    text + "</table>"
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn bytes_become_letters() {
        // The examples of RFC 4648, section 10.
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn every_stay_is_on_the_page() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/shop/orders.toml");
        let mut scenario = toolroom_scenario_file::read(&file, &[]).expect("a scenario").scenario;
        scenario.title = "<script>alert(1)</script>".to_owned();
        scenario.orders[0].customer = "</script>".to_owned();
        let log = toolroom_shop::run(&scenario, 0, 0).expect("it runs");
        let bars: Vec<&StateRow> = log.states.iter().filter(|row| row.state != MachineState::Idle).collect();
        let bytes = packed(&log, &bars);
        assert_eq!(bytes.len(), 14 * bars.len());
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
        for (bar, row) in bars.iter().enumerate() {
            let offset = 14 * bar;
            assert!((f64::from(word(offset)) - 10.0 * row.start).abs() <= 0.5);
            assert!((f64::from(word(offset) + word(offset + 4)) - 10.0 * row.end).abs() <= 0.5);
            let packed = u32::from(u16::from_le_bytes([bytes[offset + 8], bytes[offset + 9]]));
            assert_eq!((packed & 4095, packed >> 12), (row.machine, row.state as u32));
        }
        let mut page = Vec::new();
        write(&scenario, "programmed", &log, &mut page).expect("written");
        let page = String::from_utf8(page).expect("text");
        assert!(!page.contains("{{") && !page.contains("<script>alert"), "names are no markup");
        assert_eq!(page.matches("</script>").count(), 2, "nothing ends the data early");
        assert!(page.contains("\"late\":"), "orders have their lateness");
    }
}
