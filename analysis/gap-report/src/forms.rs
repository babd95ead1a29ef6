//! The three forms of the report.

use crate::minutes::{Minutes, Rates};
use crate::pictures::{course, equality, map, map_cells, waterfall};
use crate::readings::{ReadChannel, Readings};
use crate::sentence::{sentence, words};
use serde_json::{Value, json};
use std::fmt::Write as _;
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_chart::{Cell, Table, number};
use toolroom_gap::{Closure, Diagnosis, GapVerdict};

/// Channels that are drawn one by one; the others are in the tables.
const DRAWN: usize = 6;

/// A process with what is said of it.
#[derive(Clone, Debug)]
pub struct Page {
    /// Process.
    pub process: &'static str,
    /// Diagnosis.
    pub diagnosis: Diagnosis,
    /// Readings.
    pub readings: Readings,
    /// Rates of machines.
    pub rates: Rates,
}

impl Page {
    /// A process of which too little was measured.
    pub fn without_readings(process: &'static str, diagnosis: Diagnosis) -> Self {
        Self { process, diagnosis, readings: Readings::default(), rates: Rates::default() }
    }

    fn minutes(&self) -> Option<Minutes> {
        Minutes::from_readings(&self.readings, &self.rates)
    }

    fn sentence(&self) -> String {
        sentence(&self.diagnosis, &self.readings, self.minutes().as_ref())
    }

    /// Channels, those that are furthest off first.
    fn order(&self) -> Vec<usize> {
        let off = |channel: usize| {
            let [mean, _] = self.readings.residuals(channel, 0);
            let [left, rms] = self.readings.residuals(channel, self.readings.stages.len());
            let score = mean.abs() / (rms * rms - left * left).max(0.0).sqrt();
            if score.is_finite() { score } else { 0.0 }
        };
        let mut order: Vec<usize> = (0..self.readings.channels.len()).collect();
        order.retain(|channel| self.readings.of(*channel).next().is_some());
        order.sort_by(|a, b| off(*b).total_cmp(&off(*a)));
        order
    }

    /// Mean and root mean square residual of every channel, before and after.
    fn residuals(&self) -> Table {
        let mut table =
            Table::new(["channel", "unit", "values", "mean before", "mean after", "rms before", "rms after"]);
        for channel in self.order() {
            let about = &self.readings.channels[channel];
            let [before, after] = [0, self.readings.stages.len()].map(|stage| self.readings.residuals(channel, stage));
            table.push([
                words(&about.name).into(),
                about.residual_unit().into(),
                (self.readings.of(channel).count() as f64).into(),
                about.residual_shown(before[0]).into(),
                about.residual_shown(after[0]).into(),
                about.residual_shown(before[1]).into(),
                about.residual_shown(after[1]).into(),
            ]);
        }
        table
    }

    fn facts(&self) -> Table {
        let mut table = Table::new(["fact", "where", "seen", "recorded", "90 % from", "to", "model", "p", "finding"]);
        for (index, fact) in self.diagnosis.facts.iter().enumerate() {
            let value = |value: f64| fact.quantity.with_unit(value, fact.model);
            let found = self.diagnosis.findings.iter().any(|finding| finding.fact == index);
            table.push([
                fact.quantity.words().into(),
                fact.shown_place().into(),
                (fact.count as f64).into(),
                value(fact.estimate).into(),
                value(fact.ci90[0]).into(),
                value(fact.ci90[1]).into(),
                value(fact.model).into(),
                fact.p.into(),
                Cell::from(if found { "yes" } else { "" }),
            ]);
        }
        table
    }

    fn steps(&self, minutes: &Minutes) -> Table {
        let money =
            if minutes.currency.is_empty() { "money".to_owned() } else { format!("{} a week", minutes.currency) };
        let mut table = Table::new(["step".to_owned(), "min a week".to_owned(), money]);
        for step in &minutes.steps {
            let cost: Cell = if minutes.currency.is_empty() { "no rate".into() } else { step.money.into() };
            table.push([step.label.clone().into(), step.minutes.into(), cost]);
        }
        table
    }

    /// Every channel and the sum of all, with what is read of the channel and its closure.
    fn closed(&self) -> impl Iterator<Item = (&str, Option<&ReadChannel>, &Closure)> {
        let channels = self.diagnosis.channels.iter().map(|(name, closure)| (name.word(), closure));
        let about = |name: &str| self.readings.channels.iter().find(|about| about.name == name);
        let all = channels.chain([("all, in units of noise", &self.diagnosis.total)]);
        all.map(move |(name, closure)| (name, about(name), closure))
    }

    /// The table of [`closures`](Self::closures) as numbers for programs, shares in per cent.
    fn closure_numbers(&self) -> Vec<Value> {
        let row = |(name, about, closure): (&str, Option<&ReadChannel>, &Closure)| {
            let shown = |value: f64| about.map_or(value, |about| about.residual_shown(value));
            let percent = |share: f64| Some(100.0 * share).filter(|value| value.is_finite());
            json!({
                "channel": words(name), "unit": about.map_or("", |about| about.residual_unit()),
                "before": shown(closure.before), "after": shown(closure.after), "closed, %": percent(closure.closed),
                "90 % from": percent(closure.ci90[0]), "to": percent(closure.ci90[1]),
                "of as many new groups, 90 % from": percent(closure.pi90[0]),
                "of as many new groups, to": percent(closure.pi90[1]), "of closable, %": percent(closure.of_closable),
                "of the mean, %": percent(closure.measures.mean),
                "without what stands apart, %": percent(closure.measures.mean_without_apart),
                "of the rms, %": percent(closure.measures.rms), "robust, %": percent(closure.measures.robust),
            })
        };
        self.closed().map(row).collect()
    }

    fn closures(&self) -> Table {
        let mut table = Table::new([
            "channel",
            "unit",
            "before",
            "after",
            "closed, %",
            "90 % interval",
            "as many new groups",
            "of closable, %",
            "mean, %",
            "without apart, %",
            "rms, %",
            "robust, %",
        ]);
        for (name, about, closure) in self.closed() {
            let shown = |value: f64| Cell::from(about.map_or(value, |about| about.residual_shown(value)));
            // A tenth of a per cent is more than any closure is known to.
            let rounded = |share: f64| (1000.0 * share).round() / 10.0 + 0.0;
            let percent = |share: f64| Cell::from(rounded(share));
            let interval = |[low, high]: [f64; 2]| match low.is_finite() && high.is_finite() {
                true => format!("{} … {}", rounded(low), rounded(high)).into(),
                false => Cell::from(""),
            };
            table.push([
                words(name).into(),
                about.map_or("", |about| about.residual_unit()).into(),
                shown(closure.before),
                shown(closure.after),
                percent(closure.closed),
                interval(closure.ci90),
                interval(closure.pi90),
                percent(closure.of_closable),
                percent(closure.measures.mean),
                percent(closure.measures.mean_without_apart),
                percent(closure.measures.rms),
                percent(closure.measures.robust),
            ]);
        }
        table
    }

    /// What could not have been seen: effects, then facts.
    fn hidden(&self) -> Table {
        let mut table = Table::new(["what", "least size that would have been seen", "what would show it"]);
        for row in &self.diagnosis.masked {
            let least = row.minimal_detectable;
            let unit = if row.unit == "1" { "" } else { row.unit };
            let size = if least.is_finite() { format!("{} {unit}", number(least, 3)) } else { "none".to_owned() };
            let size = size.trim_end().to_owned();
            table.push([row.id.word().into(), size.into(), row.separating_test.into()]);
        }
        for fact in &self.diagnosis.facts {
            let [low, high] = fact.least_seen.map(|factor| number(factor, 3));
            let what = format!("{} of {}", fact.quantity.words(), fact.place);
            let (least, by) = if fact.least_seen.iter().all(|factor| factor.is_nan()) {
                ("not worked out".to_owned(), "more cuts near the limit")
            } else {
                (format!("a factor below {low} or above {high}"), "a longer log")
            };
            table.push([what.into(), least.into(), by.into()]);
        }
        table
    }

    fn next(&self) -> String {
        let next = &self.diagnosis.next;
        if next.design.is_empty() {
            return "Nothing is open that a planned run would decide.".to_owned();
        }
        let decides: Vec<String> = next.separates.iter().map(|pair| pair.join(" from ")).collect();
        let decides = if decides.is_empty() { String::new() } else { format!(" It tells {}.", decides.join(", ")) };
        format!("{}: {:.0} min of machine time.{decides}", next.design, next.minutes)
    }

    fn sections(&self, of: &str) -> Vec<Section> {
        let heading =
            |text: &str| if of.is_empty() { text.to_owned() } else { format!("{of}: {}", text.to_lowercase()) };
        let order = self.order();
        let drawn = |draw: &dyn Fn(&Readings, usize) -> Option<Figure>| -> Vec<(String, Figure)> {
            let channels = order.iter().take(DRAWN);
            let name = |channel: usize| words(&self.readings.channels[channel].name);
            channels.filter_map(|channel| Some((name(*channel), draw(&self.readings, *channel)?))).collect()
        };
        let measured = pictures(Section::new(heading("Measured against predicted")), drawn(&equality));
        let over_time = pictures(Section::new(heading("Over time")), drawn(&course));
        let mut sections = vec![measured.table("Measured less predicted", self.residuals()), over_time];
        sections.extend(map(&self.readings).map(|figure| Section::new(heading("Where and when")).figure(figure)));
        if !self.diagnosis.facts.is_empty() {
            let facts = Section::new(heading("Facts"))
                .paragraph("What the log counts and no channel predicts, against the distributions of the file.");
            sections.push(facts.table("Facts and their tests", self.facts()));
        }
        if let Some(minutes) = self.minutes() {
            let section = Section::new(heading("Minutes and money")).figure(waterfall(&minutes));
            sections.push(section.table("Machine time and cost of the recorded operations", self.steps(&minutes)));
        }
        sections.push(
            Section::new(heading("How far the gap closes"))
                .paragraph(
                    "Share of the gap that the named effects close, channel by channel, with its 90 % interval and that for as many \
                     new groups as were measured; what it is of the part that can be closed at all; and the same of the mean, of \
                     the mean without readings that stand apart, of the root mean square, and of Huber's loss, which heeds outliers \
                     less.",
                )
                .table("On groups that the fit has not seen", self.closures()),
        );
        sections.push(Section::new(heading("What could not be seen")).table("Least sizes", self.hidden()));
        sections.push(Section::new(heading("Next action")).paragraph(self.next()).list(self.diagnosis.notes.clone()));
        sections
    }
}

/// Figures beside each other, or one after the other where there are more than two: a page of
/// a shop would be longer than anybody reads.
fn pictures(section: Section, figures: Vec<(String, Figure)>) -> Section {
    if figures.len() > 2 {
        return section.choice(figures);
    }
    figures.into_iter().map(|(_, figure)| figure).fold(section, Section::figure)
}

/// The report as one HTML file without scripts and network; `details` say how the answer came about.
pub fn html(pages: &[Page], details: Vec<Section>, provenance: Provenance) -> String {
    let mut report = Report::new("Where the shop and its model differ");
    for page in pages {
        report = report.lead(page.sentence());
    }
    for page in pages {
        let note = match &page.diagnosis.effects[..] {
            [] if page.diagnosis.verdict == GapVerdict::CannotTell => "too little was measured".to_owned(),
            [] => format!("{} findings among {} facts", page.diagnosis.findings.len(), page.diagnosis.facts.len()),
            effects => effects.iter().map(|effect| effect.id.word()).collect::<Vec<_>>().join(", "),
        };
        report = report.tile(Tile::new(page.process, page.diagnosis.verdict.name(), note));
        if let Some(minutes) = page.minutes() {
            let gap = minutes.steps[minutes.steps.len() - 1].minutes - minutes.steps[0].minutes;
            let note = "measured less the model as its file stands";
            report = report.tile(Tile::new("machine time", format!("{gap:+.0} min a week"), note));
        }
    }
    for page in pages {
        let of = if pages.len() > 1 { page.process } else { "" };
        report = page.sections(of).into_iter().fold(report, Report::section);
    }
    details.into_iter().fold(report, Report::section).provenance(provenance).html()
}

/// The report as Markdown, for a mail or a ticket: the same figures without pictures.
pub fn markdown(pages: &[Page]) -> String {
    let mut text = "# Where the shop and its model differ\n".to_owned();
    for page in pages {
        let _ = write!(text, "\n## {}: {}\n\n{}\n", page.process, page.diagnosis.verdict.name(), page.sentence());
        let mut add = |heading: &str, table: &Table| {
            if !table.rows().is_empty() {
                let _ = write!(text, "\n### {heading}\n\n{}", rows(table));
            }
        };
        add("Measured less predicted", &page.residuals());
        add("Facts", &page.facts());
        if let Some(minutes) = page.minutes() {
            add("Minutes and money", &page.steps(&minutes));
        }
        add("How far the gap closes", &page.closures());
        add("What could not be seen", &page.hidden());
        let _ = write!(text, "\n### Next action\n\n{}\n", page.next());
        for note in &page.diagnosis.notes {
            let _ = writeln!(text, "- {}", note.replace('\n', " "));
        }
    }
    text
}

/// A table of Markdown.
fn rows(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let text = |cell: &Cell| match cell {
        Cell::Text(text) => text.replace('|', "\\|").replace('\n', " "),
        Cell::Number(value) => number(*value, 4),
    };
    let mut all = line(table.columns().to_vec());
    all += &line(vec!["---".to_owned(); table.columns().len()]);
    table.rows().iter().for_each(|row| all += &line(row.iter().map(text).collect()));
    all
}

/// All figures of the report.
pub fn json(pages: &[Page]) -> Value {
    json!({ "schema": 1, "processes": pages.iter().map(of_page).collect::<Vec<_>>() })
}

fn of_page(page: &Page) -> Value {
    let cell = |cell: &Cell| match cell {
        Cell::Text(text) => json!(text),
        Cell::Number(value) if value.is_finite() => json!(value),
        Cell::Number(_) => Value::Null,
    };
    let records = |table: Table| -> Vec<Value> {
        let row = |row: &Vec<Cell>| {
            table.columns().iter().cloned().zip(row.iter().map(cell)).collect::<serde_json::Map<_, _>>().into()
        };
        table.rows().iter().map(row).collect()
    };
    let map: Vec<Value> = map_cells(&page.readings)
        .into_iter()
        .map(|(channel, machine, week, score, values)| {
            json!({ "channel": channel, "machine": machine, "week": week + 1, "score": score, "values": values })
        })
        .collect();
    let minutes = page.minutes();
    json!({
        "process": page.process, "verdict": page.diagnosis.verdict.name(), "sentence": page.sentence(),
        "residuals": records(page.residuals()), "map": map, "facts": records(page.facts()),
        "minutes": minutes.map(|minutes| json!({
            "currency": minutes.currency, "weeks": minutes.weeks,
            "steps": minutes.steps.iter().map(|step| json!({
                "step": step.label, "minutes_per_week": step.minutes, "money_per_week": step.money,
            })).collect::<Vec<_>>(),
        })),
        "closure": page.closure_numbers(), "hidden": records(page.hidden()), "next": page.next(),
    })
}
