//! The comparison on a terminal: plain aligned text.

use crate::compare::{Comparison, Difference, PolicyResult};
use crate::figure::{decimals, factor, label, plain, shown, signed};
use crate::kpi::{Better, Kpi};
use crate::planner::{late_orders, plan_line};
use crate::study::Study;
use crate::summary::cutting_share;
use crate::tune::tuning_text;
use crate::variants;
use std::fmt::Write;
use std::time::Duration;
use toolroom_scenario::Scenario;
use toolroom_statistics::Interval;

/// How to print.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Style {
    /// Green for better and red for worse where the interval excludes zero.
    pub colour: bool,
    /// Wall time to show in the first line.
    pub wall: Option<Duration>,
    /// Columns into which tables have to fit, by leaving out their last columns and shortening names; any number, if none.
    pub width: Option<usize>,
}

/// Figures in the order of the table; those of chatter only where stability is judged.
const ROWS: [&str; 13] = [
    "parts_per_shift",
    "cost_per_part",
    "edges_per_100_parts",
    "scrap_from_tool_failure",
    "chatter_share",
    "scrap_from_chatter",
    "chatter_onsets_per_shift",
    "oee",
    "tool_life",
    "path_per_edge",
    "mean_cutting_speed",
    "lead_time",
    "wip",
];

/// Figures of the table of more than two policies, with titles short enough for one line; the first
/// [`MOST_COLUMNS`] that say something in this study.
const COLUMNS: [(&str, &str); 15] = [
    ("parts_per_shift", "parts / shift"),
    ("cost_per_part", "cost / part"),
    ("edges_per_100_parts", "edges / 100 parts"),
    ("scrap_from_tool_failure", "tool scrap, %"),
    ("chatter_share", "in chatter, %"),
    ("scrap_from_chatter", "chatter scrap, %"),
    ("chatter_onsets_per_shift", "onsets / shift"),
    ("oee", "OEE"),
    ("tool_life", "life, min"),
    ("path_per_edge", "path, m"),
    ("dressings_per_100_parts", "dressings / 100 parts"),
    ("scrap_out_of_tolerance", "size scrap, %"),
    ("scrap_burnt", "burnt, %"),
    ("grinding_time", "grinding, s"),
    ("lead_time", "lead time, min"),
];

/// Columns that fit a line.
const MOST_COLUMNS: usize = 7;

/// The table, the gains and the decision.
pub fn table(scenario: &Scenario, study: &Study, comparison: &Comparison, style: Style) -> String {
    let mut out = heading(scenario, study, style);
    match comparison.policies.len() {
        1 => alone(scenario, study, comparison, style, &mut out),
        2 => pair(scenario, study, comparison, style, &mut out),
        _ => many(scenario, study, comparison, style, &mut out),
    }
    if let Some(difference) = comparison.headline.map(|index| &comparison.differences[index]) {
        let _ = writeln!(out, "{}", gains(study, comparison, difference));
        let _ = writeln!(out, "{}", comparison.decision.line);
        for note in &comparison.decision.notes {
            let _ = writeln!(out, "  {note}");
        }
        for price in comparison.turning_prices() {
            let _ = writeln!(out, "  {}", price.describe());
        }
        if let Some(tuning) = &study.tuning {
            out.push_str(&tuning_text(tuning, study, comparison));
        }
    }
    if let Some(text) = study.sequential_text() {
        let _ = writeln!(out, "{text}");
    }
    out.push_str(&late_orders(scenario, study));
    out.push_str(&plan_line(scenario, study));
    out.push_str(&steady_text(scenario, study));
    varied(scenario, study, &mut out);
    if !study.complete {
        let _ = writeln!(out, "stopped early: {} replications are complete", study.replications);
    }
    out
}

/// How the warm-up was found, and how well the only run of a shop that goes on is known; empty where neither was asked.
pub(crate) fn steady_text(scenario: &Scenario, study: &Study) -> String {
    let mut text = study.warm_up.as_ref().map_or_else(String::new, |found| found.text());
    for (policy, found) in study.policies.iter().zip(&study.one_run) {
        let name = (study.policies.len() > 1).then_some(scenario.policies[*policy].name.as_str());
        text.push_str(&found.map_or_else(String::new, |found| found.text(name)));
    }
    text
}

/// Cell gain, shop gain and what lies between them, in one line.
pub fn gains(study: &Study, comparison: &Comparison, difference: &Difference) -> String {
    let bottleneck = comparison.bottleneck().map_or("–", |station| station.name.as_str());
    let who = match comparison.policies.as_slice() {
        [_, _] => String::new(),
        policies => format!("{} against {}; ", policies[difference.policy].name, policies[0].name),
    };
    let beyond = difference.beyond.map_or_else(String::new, |reason| format!(", the rest by {reason}"));
    format!(
        "cell gain {} → shop gain {} ({who}bottleneck {bottleneck}; cutting is {} % of the shift; at most {} by capacity \
         alone{beyond})",
        factor(difference.cell_gain.mean),
        factor(difference.shop_gain.mean),
        plain(100.0 * cutting_share(study, comparison), 0),
        factor(difference.amdahl_limit),
    )
}

fn heading(scenario: &Scenario, study: &Study, style: Style) -> String {
    let plural = if study.replications == 1 { "" } else { "s" };
    let mut line = format!("{} · {} replication{plural}", scenario.title, study.replications);
    if study.policies.len() > 1 {
        line.push_str(" · common random numbers");
    }
    let _ = write!(line, " · seed {}", scenario.seed);
    if let Some(wall) = style.wall {
        let _ = write!(line, "        {:.1} s", wall.as_secs_f64());
    }
    line.push('\n');
    line
}

/// A cell of a table and whether it is good or bad news.
#[derive(Clone, Default)]
struct Cell {
    text: String,
    news: Option<bool>,
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, news: None }
    }
}

/// Shortest name of a policy or figure that is still told apart.
const SHORTEST: usize = 14;

/// Between two columns.
const GAP: usize = 2;

/// Widths of the columns of a table.
fn widths(rows: &[Vec<Cell>]) -> Vec<usize> {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.text.chars().count()).max().unwrap_or(0)
    };
    (0..count).map(width).collect()
}

/// Makes a table fit: the columns of `optional` go, the last of them first, then the first column is shortened.
/// How many columns went.
fn fit(rows: &mut [Vec<Cell>], optional: &[usize], style: Style) -> usize {
    let Some(most) = style.width else { return 0 };
    let whole = |rows: &[Vec<Cell>]| {
        let widths = widths(rows);
        widths.iter().sum::<usize>() + GAP * widths.len().saturating_sub(1)
    };
    let mut gone = 0;
    for &column in optional.iter().rev() {
        if whole(rows) <= most {
            break;
        }
        for row in rows.iter_mut().filter(|row| row.len() > column) {
            row.remove(column);
        }
        gone += 1;
    }
    let over = whole(rows).saturating_sub(most);
    let longest = widths(rows).first().copied().unwrap_or(0).saturating_sub(over).max(SHORTEST);
    for cell in rows.iter_mut().filter_map(|row| row.first_mut()) {
        if cell.text.chars().count() > longest {
            cell.text = cell.text.chars().take(longest - 1).chain(['…']).collect();
        }
    }
    gone
}

/// Says that columns were left out.
fn left_out(count: usize, text: &mut String) {
    if count > 0 {
        let plural = if count == 1 { "" } else { "s" };
        let _ = writeln!(text, "({count} more column{plural} with --wide)");
    }
}

/// First column to the left, the others to the right, unless `left` says otherwise.
fn align(rows: &[Vec<Cell>], left: &[usize], style: Style, out: &mut String) {
    let widths = widths(rows);
    for row in rows {
        let mut line = String::new();
        for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            let pad = " ".repeat(width - cell.text.chars().count());
            let gap = if column == 0 { "" } else { "  " };
            let text = match cell.news.filter(|_| style.colour) {
                Some(true) => format!("\u{1b}[32m{}\u{1b}[0m", cell.text),
                Some(false) => format!("\u{1b}[31m{}\u{1b}[0m", cell.text),
                None => cell.text.clone(),
            };
            if left.contains(&column) {
                let _ = write!(line, "{gap}{text}{pad}");
            } else {
                let _ = write!(line, "{gap}{pad}{text}");
            }
        }
        let _ = writeln!(out, "{}", line.trim_end());
    }
}

fn figures<'a>(study: &'a Study, ids: &[&str]) -> Vec<(usize, &'a Kpi)> {
    ids.iter().filter_map(|id| study.index(id)).map(|index| (index, &study.kpis[index])).collect()
}

/// Those of [`ROWS`] that have a value under some policy: a shop without edges is told nothing of them, and one without
/// rates nothing of costs.
fn told<'a>(study: &'a Study, comparison: &Comparison) -> impl Iterator<Item = (usize, &'a Kpi)> {
    let says = |index: usize, free: bool| {
        let mut means = comparison.policies.iter().map(|policy| policy.kpis[index].mean);
        means.any(|mean| !(mean.is_nan() || free && mean == 0.0))
    };
    let free = |kpi: &Kpi| kpi.definition.id == "cost_per_part";
    figures(study, &ROWS).into_iter().filter(move |(index, kpi)| says(*index, free(kpi)))
}

fn per_cent(kpi: &Kpi) -> &'static str {
    if kpi.definition.display == "%" { " %" } else { "" }
}

/// `+17.4`, good or bad news where the interval excludes zero.
fn change(kpi: &Kpi, difference: &Interval, decimals: usize) -> Cell {
    let news = match kpi.definition.better {
        _ if !difference.excludes(0.0) => None,
        Better::More => Some(difference.mean > 0.0),
        Better::Less => Some(difference.mean < 0.0),
        Better::Neither => None,
    };
    Cell { text: signed(difference.mean, decimals), news }
}

fn title(scenario: &Scenario, kpi: &Kpi) -> Cell {
    // The per cent sign stands with the number.
    if kpi.definition.display == "%" { kpi.definition.title.to_owned().into() } else { label(scenario, kpi).into() }
}

fn alone(scenario: &Scenario, study: &Study, comparison: &Comparison, style: Style, text: &mut String) {
    let policy = &comparison.policies[0];
    let mut rows = vec![vec![Cell::default(), policy.name.clone().into(), study.interval_name().to_owned().into()]];
    for (index, kpi) in told(study, comparison) {
        let value = shown(kpi, &policy.kpis[index]);
        let digits = decimals(value.mean, value.half_width);
        let mut row = vec![title(scenario, kpi), format!("{}{}", plain(value.mean, digits), per_cent(kpi)).into()];
        if value.half_width.is_finite() {
            row.push(format!("({} … {})", plain(value.low(), digits), plain(value.high(), digits)).into());
        }
        rows.push(row);
    }
    fit(&mut rows, &[], style);
    align(&rows, &[0, 2], Style::default(), text);
}

fn pair(scenario: &Scenario, study: &Study, comparison: &Comparison, style: Style, text: &mut String) {
    let (baseline, other) = (&comparison.policies[0], &comparison.policies[1]);
    let head = format!("difference ({})", study.interval_name());
    let mut rows = vec![vec![Cell::default(), baseline.name.clone().into(), other.name.clone().into(), head.into()]];
    for (index, kpi) in told(study, comparison) {
        let difference = shown(kpi, &comparison.differences[0].kpis[index].difference);
        let values = [baseline, other].map(|policy| shown(kpi, &policy.kpis[index]).mean);
        let digits = decimals(values[0], difference.half_width);
        let mut cell = change(kpi, &difference, digits);
        if difference.half_width.is_finite() {
            let _ =
                write!(cell.text, "  ({} … {})", signed(difference.low(), digits), signed(difference.high(), digits));
        }
        let value = |value: f64| Cell::from(format!("{}{}", plain(value, digits), per_cent(kpi)));
        rows.push(vec![title(scenario, kpi), value(values[0]), value(values[1]), cell]);
    }
    fit(&mut rows, &[], style);
    align(&rows, &[0, 3], style, text);
}

fn many(scenario: &Scenario, study: &Study, comparison: &Comparison, style: Style, out: &mut String) {
    // What is nought or not defined under every policy says nothing.
    let says = |index: usize| {
        let mean = |policy: &PolicyResult| policy.kpis[index].mean;
        comparison.policies.iter().map(mean).any(|mean| mean.is_finite() && mean != 0.0)
    };
    let titled: Vec<_> =
        COLUMNS.iter().filter(|(id, _)| study.index(id).is_some_and(says)).take(MOST_COLUMNS).collect();
    let columns = figures(study, &titled.iter().map(|(id, _)| *id).collect::<Vec<_>>());
    let head = titled.iter().map(|(id, title)| match *id {
        "cost_per_part" => format!("{title}, {}", scenario.currency).into(),
        _ => (*title).to_owned().into(),
    });
    let mut rows: Vec<Vec<Cell>> = vec![std::iter::once(Cell::default()).chain(head).collect()];
    for policy in &comparison.policies {
        let values = columns.iter().map(|&(index, kpi)| {
            let widths = comparison.policies.iter().map(|policy| shown(kpi, &policy.kpis[index]).half_width);
            // What never varies under some policy says nothing about the digits.
            let narrowest = widths.filter(|width| *width > 0.0);
            let value = shown(kpi, &policy.kpis[index]);
            plain(value.mean, decimals(value.mean, narrowest.fold(f64::NAN, f64::min))).into()
        });
        rows.push(std::iter::once(policy.name.clone().into()).chain(values).collect());
    }
    // The heads stand over the differences, too.
    let heads: Vec<Cell> = rows[0].clone();
    let optional: Vec<usize> = (3..heads.len()).collect();
    let gone = fit(&mut rows, &optional, style);
    align(&rows, &[0], style, out);
    left_out(gone, out);

    let _ = writeln!(out, "difference to {} ({})", comparison.policies[0].name, study.interval_name());
    let gains = ["cell gain", "shop gain", "by capacity"].map(|text| Cell::from(text.to_owned()));
    let shown_differences = columns.len().min(3);
    let head = heads[1..=shown_differences].iter().cloned().chain(gains);
    let mut rows: Vec<Vec<Cell>> = vec![std::iter::once(Cell::default()).chain(head).collect()];
    for difference in &comparison.differences {
        let mut row = vec![comparison.policies[difference.policy].name.clone().into()];
        for &(index, kpi) in &columns[..shown_differences] {
            let interval = shown(kpi, &difference.kpis[index].difference);
            let digits = decimals(interval.mean, interval.half_width);
            let mut cell = change(kpi, &interval, digits);
            if interval.half_width.is_finite() {
                let _ = write!(cell.text, " ±{}", plain(interval.half_width, digits));
            }
            row.push(cell);
        }
        let factors = [difference.cell_gain.mean, difference.shop_gain.mean, difference.amdahl_limit];
        row.extend(factors.map(|value| Cell::from(factor(value))));
        rows.push(row);
    }
    // What is left at last: one difference, cell gain and shop gain.
    let optional: Vec<usize> = (2..=shown_differences).chain([shown_differences + 3]).collect();
    let gone = fit(&mut rows, &optional, style);
    align(&rows, &[0], style, out);
    left_out(gone, out);
}

/// Variants of the shop.
fn varied(scenario: &Scenario, study: &Study, text: &mut String) {
    for table in variants::tables(scenario, study) {
        let under = table.policy.map_or_else(String::new, |policy| format!(" under {policy}"));
        let _ = writeln!(text, "variants{under}");
        let cells = |row: Vec<String>| row.into_iter().map(Cell::from).collect::<Vec<_>>();
        let rows: Vec<Vec<Cell>> = std::iter::once(table.head).chain(table.rows).map(cells).collect();
        align(&rows, &[0], Style::default(), text);
    }
    if !study.variants.is_empty() {
        for line in variants::MEANING {
            let _ = writeln!(text, "  {line}");
        }
    }
    if let Some(selection) = &study.selection {
        for line in selection.sentences() {
            let _ = writeln!(text, "{line}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use crate::study::{StudyOptions, study_with};
    use std::sync::atomic::AtomicBool;

    fn print(policies: usize, replications: u32, style: Style) -> String {
        let mut scenario = fixture::scenario();
        scenario.title = "constant vs adaptive speed".to_owned();
        let mut extra = scenario.policies[1].clone();
        extra.name = "third".to_owned();
        scenario.policies.push(extra);
        let simulate = |policy: usize, replication: u32| {
            let mut log = fixture::log();
            log.jobs[0].finish += 60.0 * (policy as f64 + 1.0) * f64::from(1 + replication % 2);
            Ok(log)
        };
        let mut options = StudyOptions { replications, ..StudyOptions::of(&scenario) };
        options.policies.truncate(policies);
        let study =
            study_with(&scenario, &options, None, &|_| {}, &AtomicBool::new(false), &simulate).expect("a study");
        table(&scenario, &study, &Comparison::new(&scenario, &study), style)
    }

    #[test]
    fn two_policies_stand_side_by_side_with_their_difference() {
        let text = print(2, 4, Style { colour: false, wall: Some(Duration::from_millis(3140)), width: None });
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0],
            "constant vs adaptive speed · 4 replications · common random numbers · seed 42        3.1 s"
        );
        let lead = lines.iter().find(|line| line.starts_with("lead time, min")).expect("a row");
        // 10.5 and 12 min; the difference alternates between 1 and 2 min.
        assert!(lead.contains("10.5  ") && lead.contains("12.0  ") && lead.contains("+1.5  (+0.6 … +2.4)"), "{lead}");
        let scrap = lines.iter().find(|line| line.starts_with("scrap from tool failure")).expect("a row");
        assert!(scrap.contains("50 %      50 %  0  (0 … 0)"), "{scrap}");
        assert!(text.contains("cell gain ×1.00 → shop gain ×1.00 (bottleneck L1 + L2; cutting is 5 % of the shift"));
        assert!(!text.contains('\u{1b}'));
    }

    #[test]
    fn tables_fit_the_terminal_and_say_what_they_leave_out() {
        let whole = print(3, 4, Style::default());
        let longest = |text: &str| {
            let rows = text.lines().skip(2).take_while(|line| !line.starts_with("cell gain"));
            rows.map(|line| line.chars().count()).max().unwrap_or(0)
        };
        assert!(longest(&whole) > 60 && !whole.contains("--wide"), "{whole}");
        let narrow = print(3, 4, Style { width: Some(60), ..Style::default() });
        assert!(longest(&narrow) <= 60 && narrow.contains("with --wide)"), "{narrow}");
        assert!(narrow.contains("parts / shift") && narrow.contains("cell gain"), "{narrow}");
        let narrow = print(2, 4, Style { width: Some(60), ..Style::default() });
        assert!(narrow.contains('…'), "{narrow}");
    }

    #[test]
    fn columns_line_up() {
        let text = print(2, 4, Style::default());
        let column = text.lines().find_map(|line| line.find("difference (95 %")).expect("a head");
        let rows = text.lines().skip(2).take_while(|line| !line.starts_with("cell gain"));
        assert_eq!(rows.clone().count(), ROWS.len() - 3, "without chatter");
        for line in rows {
            let before: String = line.chars().take(column).collect();
            assert!(before.ends_with("  ") && line.chars().nth(column).is_some_and(|c| c != ' '), "{line}");
        }
        let text = print(3, 4, Style::default());
        let row = |start: &str| text.lines().find(|line| line.starts_with(start)).expect("a row").chars().count();
        assert_eq!(row("constant  "), row("adaptive  "), "{text}");
        assert!(text.contains("(adaptive against constant; bottleneck"), "{text}");
        assert!(text.contains("difference to constant (95 % CI)") && text.contains(" ±"), "{text}");
    }

    #[test]
    fn colour_is_used_only_when_asked_for_and_news_is_certain() {
        let text = print(2, 4, Style { colour: true, wall: None, width: None });
        let lead = text.lines().find(|line| line.starts_with("lead time")).expect("a row");
        assert!(lead.contains("\u{1b}[31m+1.5"), "longer lead time is bad news: {lead:?}");
        assert!(!text.lines().any(|line| line.starts_with("OEE") && line.contains('\u{1b}')));
    }

    #[test]
    fn one_replication_has_no_interval() {
        let text = print(2, 1, Style::default());
        assert!(text.contains("1 replication ·") && !text.contains('…') && !text.contains("NaN"), "{text}");
    }
}
