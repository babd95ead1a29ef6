//! `schedule.html`: what every machine and everybody does over the whole run, to zoom and search in a browser.
//!
//! It is a page of its own: the report needs no script. Bars are 14 bytes each: start and length in tenths of a second,
//! machine and state, and whose work it is. Without script the page shows the share of each week in which machines are busy.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod people;

pub use people::{Attended, attended};

use people::{lanes, off_shift};
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

/// What a person does who is on the way to a machine: after the states of machines.
const ON_THE_WAY: u32 = MachineState::ALL.len() as u32;

/// A bar of the page.
#[derive(Clone, Copy, Debug)]
struct Bar {
    /// Row of the page: a machine, or behind them a person.
    row: u32,
    /// Number among the states of the page.
    state: u32,
    start: f64,
    end: f64,
    /// Job, by number.
    job: Option<u32>,
}

/// The bars of a run, and the names of the rows behind those of the machines.
fn bars_of(scenario: &Scenario, log: &RunLog) -> (Vec<Bar>, Vec<String>) {
    let machine = |row: &StateRow| Bar {
        row: row.machine,
        state: row.state as u32,
        start: row.start,
        end: row.end,
        job: row.job,
    };
    let shown = |row: &&StateRow| row.state != MachineState::Idle;
    let mut bars: Vec<Bar> = log.states.iter().filter(shown).map(machine).collect();
    let lanes = lanes(log);
    let mut names = Vec::new();
    for (operator, person) in scenario.operators.iter().enumerate() {
        let own = lanes.iter().filter(|(own, _)| *own as usize == operator).map(|(_, stays)| stays.as_slice());
        // Somebody who never works has a row, too.
        let own: Vec<_> = own.collect();
        let nothing: &[Attended] = &[];
        for (place, stays) in own.iter().chain(std::iter::once(&nothing).filter(|_| own.is_empty())).enumerate() {
            let row = (scenario.machines.len() + names.len()) as u32;
            names.push(if place == 0 { person.name.clone() } else { format!("{} ({})", person.name, place + 1) });
            for stay in *stays {
                let on_the_way = stay.state == MachineState::WaitingOperator;
                let state = if on_the_way { ON_THE_WAY } else { stay.state as u32 };
                bars.push(Bar { row, state, start: stay.start, end: stay.end, job: Some(stay.job) });
            }
            for (start, end) in off_shift(scenario, operator, log.horizon) {
                bars.push(Bar { row, state: MachineState::OffShift as u32, start, end, job: None });
            }
        }
    }
    bars.retain(|bar| (bar.row as usize) < MOST_MACHINES);
    bars.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.row.cmp(&b.row)));
    (bars, names)
}

/// Writes the page of a run; `run` says which one it is.
///
/// # Errors
/// What the file system says.
pub fn write(scenario: &Scenario, run: &str, log: &RunLog, out: &mut impl io::Write) -> io::Result<()> {
    let (mut bars, people) = bars_of(scenario, log);
    let left_out = bars.len().saturating_sub(MOST_BARS);
    bars.truncate(MOST_BARS);
    let end = if left_out > 0 { bars.last().map_or(log.horizon, |row| row.end) } else { log.horizon };
    let mut what = format!("{run}.");
    if left_out > 0 {
        let _ = write!(what, " The last {left_out} stays of machines are left out: a page has at most {MOST_BARS}.");
    }
    let data = serde_json::to_string(&data(scenario, log, (&bars, &people), end))?.replace('<', "\\u003c");
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
fn data(scenario: &Scenario, log: &RunLog, (bars, people): (&[Bar], &[String]), end: f64) -> serde_json::Value {
    let used = |state: u32| bars.iter().any(|bar| bar.state == state);
    let states = MachineState::ALL.into_iter().map(|state| {
        let (name, colour) = style(state);
        let job = state.is_busy() || matches!(state, MachineState::WaitingOperator | MachineState::Blocked);
        let off = state == MachineState::OffShift;
        let used = used(state as u32);
        json!({ "name": name, "colour": colour, "job": job, "busy": state.is_busy(), "off": off, "used": used })
    });
    let mut states: Vec<_> = states.collect();
    let (name, colour, used) = ("on the way to a machine", "#b8a9c9", used(ON_THE_WAY));
    states.push(json!({ "name": name, "colour": colour, "job": true, "busy": true, "off": false, "used": used }));
    let machines = scenario.machines.iter().map(|own| json!({ "name": own.name, "group": own.location }));
    let people = people.iter().map(|name| json!({ "name": name, "group": "people" }));
    let machines: Vec<_> = machines.chain(people).take(MOST_MACHINES).collect();
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
fn packed(log: &RunLog, bars: &[Bar]) -> Vec<u8> {
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
        bytes.extend((((row.state) << 12 | row.row) as u16).to_le_bytes());
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
    let mut times = vec![vec![[0.0f64; 2]; count]; scenario.machines.len() + scenario.operators.len()];
    let stretches = |start: f64, end: f64| {
        let (first, last) = ((start / WEEK) as usize, ((end / WEEK) as usize).min(count - 1));
        (first..=last).map(move |week| (week, end.min((week + 1) as f64 * WEEK) - start.max(week as f64 * WEEK)))
    };
    for row in log.states.iter().filter(|row| row.in_shift) {
        for (week, inside) in stretches(row.start, row.end) {
            let seconds = &mut times[row.machine as usize][week];
            seconds[0] += if row.state.is_busy() { inside } else { 0.0 };
            seconds[1] += inside;
        }
    }
    for stay in attended(log) {
        for (week, inside) in stretches(stay.start, stay.end) {
            times[scenario.machines.len() + stay.operator as usize][week][0] += stay.share * inside;
        }
    }
    for (operator, own) in scenario.operators.iter().zip(&mut times[scenario.machines.len()..]) {
        let calendar = operator.calendar.map(|index| &scenario.calendars[index]);
        for (week, seconds) in own.iter_mut().enumerate() {
            let (from, to) = (week as f64 * WEEK, ((week + 1) as f64 * WEEK).min(log.horizon));
            seconds[1] = calendar.map_or(to - from, |calendar| calendar.working_time(from, to));
        }
    }
    let mut text = "<table><tr><th>machine, person</th>".to_owned();
    for week in 1..=count {
        let _ = write!(text, "<th>week {week}</th>");
    }
    text.push_str("</tr>");
    let people = scenario.operators.iter().map(|operator| &operator.name);
    for (name, weeks) in scenario.machines.iter().map(|machine| &machine.name).chain(people).zip(&times) {
        let _ = write!(text, "<tr><th>{}</th>", escape(name));
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
        let (bars, people) = bars_of(&scenario, &log);
        assert!(people.is_empty());
        assert_eq!(bars.len(), log.states.iter().filter(|row| row.state != MachineState::Idle).count());
        let bytes = packed(&log, &bars);
        assert_eq!(bytes.len(), 14 * bars.len());
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
        for (bar, row) in bars.iter().enumerate() {
            let offset = 14 * bar;
            assert!((f64::from(word(offset)) - 10.0 * row.start).abs() <= 0.5);
            assert!((f64::from(word(offset) + word(offset + 4)) - 10.0 * row.end).abs() <= 0.5);
            let packed = u32::from(u16::from_le_bytes([bytes[offset + 8], bytes[offset + 9]]));
            assert_eq!((packed & 4095, packed >> 12), (row.row, row.state));
        }
        for bar in &bars {
            let same =
                |row: &&StateRow| row.machine == bar.row && row.start == bar.start && row.state as u32 == bar.state;
            assert!(log.states.iter().any(|row| same(&row) && row.end == bar.end));
        }
        let mut page = Vec::new();
        write(&scenario, "programmed", &log, &mut page).expect("written");
        let page = String::from_utf8(page).expect("text");
        assert!(!page.contains("{{") && !page.contains("<script>alert"), "names are no markup");
        assert_eq!(page.matches("</script>").count(), 2, "nothing ends the data early");
        assert!(page.contains("\"late\":"), "orders have their lateness");
    }

    #[test]
    fn everybody_has_a_row_with_what_the_machine_does_that_they_attend_to() {
        let text = "schema = 1\n[shop]\nname = \"people\"\nhorizon = \"2 h\"\n\
            [[calendar]]\nname = \"c\"\nshift = [{ start = \"0 min\", end = \"90 min\" }]\n\
            [[machine]]\nname = \"M\"\ncount = 2\nprocess = \"plain\"\nlocation = \"hall\"\nsetup_at_start = \"\"\n\
            [[operator]]\nname = \"tender\"\nskills = [\"set\", \"tend\"]\ncalendar = \"c\"\n\
            walk = { locations = [\"hall\"], times = [[\"2 min\"]] }\n[[operator]]\nname = \"idler\"\nskills = [\"none\"]\n\
            [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"do\"\nmachines = \"M\"\nwork = \"20 min\"\nsetup_time = \"10 min\"\n\
            operator = { setup = \"set\", run = { skill = \"tend\", share = 0.5 } }\n\
            [[order]]\nid = \"a\"\npart = \"p\"\n[[order]]\nid = \"b\"\npart = \"p\"\n";
        let scenario = toolroom_scenario_file::parse("people.toml", text, &[]).expect("a scenario").scenario;
        let log = toolroom_shop::run(&scenario, 0, 0).expect("it runs");
        let minutes: Vec<_> = attended(&log)
            .iter()
            .map(|stay| (stay.operator, stay.state.name(), stay.start / 60.0, stay.end / 60.0, stay.share))
            .collect();
        // Two minutes to the first machine, its setup of ten; half of the person stays. Setting up the other one takes all of
        // the person, so that it waits until 32; then the same.
        assert_eq!(
            minutes,
            [
                (0, "waiting_operator", 0.0, 2.0, 1.0),
                (0, "setup", 2.0, 12.0, 1.0),
                (0, "working", 12.0, 32.0, 0.5),
                (0, "waiting_operator", 32.0, 34.0, 1.0),
                (0, "setup", 34.0, 44.0, 1.0),
                (0, "working", 44.0, 64.0, 0.5),
            ]
        );
        let (bars, people) = bars_of(&scenario, &log);
        assert_eq!(people, ["tender", "idler"]);
        let of_tender: Vec<_> = bars.iter().filter(|bar| bar.row == 2).map(|bar| (bar.state, bar.end / 60.0)).collect();
        let off = MachineState::OffShift as u32;
        assert_eq!((of_tender[0], of_tender.last()), ((ON_THE_WAY, 2.0), Some(&(off, 120.0))));
        let table = weeks(&scenario, &log);
        // 44 of 90 minutes.
        assert!(table.contains("<th>tender</th><td style=\"background: rgb(76 120 168 / 49%)\">49 %"), "{table}");
    }
}
