//! Several processes of one data set: each is diagnosed with its own model, and all are answered
//! for together.
//!
//! Nothing is shared between the models: what a machine's gain is in one table it need not be in
//! another, since other sensors read there. A name pays for having been chosen among all of
//! them: beside the logarithm of the size of its catalogue its gain has to cover that of the number
//! of processes, and the null of the localisation map is taken at the level divided by it, so that
//! something is named without cause in the whole data set as seldom as in a single table
//! (Bonferroni).

use super::channels::{diagnose_among, mean_budget};
use super::diagnose::DiagnosisWithBasis;
use super::pooled::pooled;
use super::summary::{named, named_effect, percent, rounded, verdict, with_unit};
use super::{ChannelId, Closure, Diagnosis, EffectId, Forward, GapVerdict, ProcessData, Untried};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Estimate, Intervals, Table};

/// Lines of the terminal's summary.
const LINES: usize = 10;
/// Lists of a diagnosis whose entries say of which process they are.
const LISTS: [&str; 10] =
    ["effects", "where", "masked", "calibration", "ranking", "tried", "not_named", "facts", "dynamics_drift", "apart"];

/// What is said of every process of a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers {
    /// Processes and what is said of each, in the order in which they were asked.
    pub processes: Vec<(&'static str, Diagnosis)>,
    /// Closure over all of them, in units of noise: of a process with a name the channels that its
    /// effects touch, of another all.
    pub total: Closure,
    /// Effects that were not tried, each with its process.
    pub untried: Vec<(&'static str, Untried)>,
}

/// Diagnoses every process of a data set; one alone is diagnosed as by
/// [`diagnose_parts`](super::diagnose_parts()).
///
/// # Panics
/// Without processes.
pub fn diagnose_processes(asked: &[ProcessData], seed: u64) -> Answers {
    diagnosed_processes(asked, seed).0
}

/// [`diagnose_processes`] with what each part of each process rests on.
///
/// # Panics
/// Without processes.
pub fn diagnosed_processes(asked: &[ProcessData], seed: u64) -> (Answers, Vec<Vec<DiagnosisWithBasis>>) {
    let all: Vec<(Diagnosis, Vec<DiagnosisWithBasis>)> =
        asked.iter().map(|own| answered(own, asked.len(), seed)).collect();
    let total = match &all[..] {
        [(only, _)] => only.total.clone(),
        _ => {
            let mut pool: Vec<(usize, &dyn Forward, &DiagnosisWithBasis)> = Vec::new();
            for (process, (own, (_, diagnosed))) in asked.iter().zip(&all).enumerate() {
                pool.extend(own.parts.iter().zip(diagnosed).map(|(part, each)| (process, part.as_ref(), each)));
            }
            if pool.is_empty() { Closure::UNKNOWN } else { pooled(&pool, seed) }
        }
    };
    let (diagnoses, diagnosed): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let processes = asked.iter().zip(diagnoses).map(|(own, diagnosis)| (own.process, diagnosis)).collect();
    let mut untried: Vec<(&'static str, Untried)> = Vec::new();
    for (asked_process, part) in
        asked.iter().flat_map(|asked_process| asked_process.parts.iter().map(move |part| (asked_process, part)))
    {
        // Parts of a power law leave out the same.
        let new =
            part.frame().untried.iter().filter(|each| !untried.contains(&(asked_process.process, (*each).clone())));
        let new: Vec<_> = new.map(|each| (asked_process.process, each.clone())).collect();
        untried.extend(new);
    }
    (Answers { processes, total, untried }, diagnosed)
}

fn answered(asked: &ProcessData, processes: usize, seed: u64) -> (Diagnosis, Vec<DiagnosisWithBasis>) {
    let (mut diagnosis, mut diagnosed) = diagnose_among(&asked.parts, processes, seed);
    // A condition in a wrong unit bends every channel; those that still look possible prove nothing.
    if asked.impossible > 1 && !diagnosis.effects.is_empty() {
        for one in diagnosed.iter_mut().map(|each| &mut each.diagnosis).chain([&mut diagnosis]) {
            one.effects.clear();
            one.verdict = GapVerdict::Unknown;
        }
        diagnosis.notes.push("several channels are impossible at once: no effect is named".to_owned());
    }
    diagnosis.notes.extend(asked.notes.iter().cloned());
    (diagnosis, diagnosed)
}

impl Answers {
    /// The answer in one word: that of the process where most is found; no gap is answered only where
    /// every process could be told.
    pub fn verdict(&self) -> GapVerdict {
        GapVerdict::of_all(self.processes.iter().map(|(_, own)| own.verdict))
    }

    /// The document `diagnosis.json`: that of a single process, with the key `process` in every entry
    /// of a list. Several processes are put together in it, and `processes` holds the whole document
    /// of each.
    pub fn json(&self) -> Value {
        let documents: Vec<(&str, Value)> =
            self.processes.iter().map(|(process, answer)| (*process, answer.json())).collect();
        if let [(process, document)] = &documents[..] {
            let mut document = document.clone();
            LISTS.iter().for_each(|list| document[*list] = tagged(&document, list, process).into());
            document["untried"] = self.untried_json();
            return document;
        }
        let list = |name: &str| -> Vec<Value> {
            documents.iter().flat_map(|(process, document)| tagged(document, name, process)).collect()
        };
        let mut places = list("where");
        let score = |place: &Value| place["score"].as_f64().unwrap_or(0.0).abs();
        places.sort_by(|a, b| score(b).total_cmp(&score(a)));
        let mut total = self.total.json(None);
        let groups = self
            .processes
            .iter()
            .flat_map(|(process, answer)| answer.held_out.iter().map(move |group| format!("{process}: {group}")));
        total["heldout_groups"] = groups.collect::<Vec<_>>().into();
        let budget = mean_budget(self.processes.iter().map(|(_, answer)| answer));
        let notes: Vec<String> = self.notes().collect();
        let mut next = json!({ "design": "", "minutes": 0.0, "separates": [] });
        if let Some((process, document)) =
            documents.iter().find(|(_, document)| document["next_experiment"]["design"] != "")
        {
            next = document["next_experiment"].clone();
            next["process"] = (*process).into();
        }
        json!({
            "schema": 1, "verdict": self.verdict().name(), "effects": list("effects"), "where": places,
            "closure": { "total": total, "channels": self.channels() },
            "budget": budget.json(), "masked": list("masked"), "next_experiment": next,
            "calibration": list("calibration"), "ranking": list("ranking"), "tried": list("tried"),
            "not_named": list("not_named"), "untried": self.untried_json(), "notes": notes, "facts": list("facts"),
            "dynamics_drift": list("dynamics_drift"), "apart": list("apart"),
            "processes": documents.into_iter().map(|(process, document)| (process.to_owned(), document)).collect::<Map<_, _>>(),
        })
    }

    /// Closures by channel: `process.channel` where two processes have a channel of one name.
    fn channels(&self) -> Map<String, Value> {
        let mut times: BTreeMap<ChannelId, usize> = BTreeMap::new();
        for (name, _) in self.processes.iter().flat_map(|(_, own)| &own.channels) {
            *times.entry(*name).or_default() += 1;
        }
        let mut channels = Map::new();
        for (process, answer) in &self.processes {
            for (name, closure) in &answer.channels {
                let key = if times[name] > 1 { format!("{process}.{name}") } else { name.to_string() };
                channels.insert(key, closure.json(None));
            }
        }
        channels
    }

    fn notes(&self) -> impl Iterator<Item = String> {
        self.processes.iter().flat_map(|(process, own)| own.notes.iter().map(move |note| format!("{process}: {note}")))
    }

    fn untried_json(&self) -> Value {
        let entry = |(process, untried): &(&str, Untried)| json!({ "process": process, "id": untried.id.word(), "reason": untried.reason });
        self.untried.iter().map(entry).collect()
    }

    /// Names of the effects that were not tried, process by process; the reasons stand in the report.
    fn untried_line(&self) -> String {
        let several = self.processes.len() > 1;
        let mut lines: Vec<String> = Vec::new();
        for (process, _) in &self.processes {
            let names = self.untried.iter().filter(|(own, _)| own == process).map(|(_, untried)| untried.id.word());
            let names = names.collect::<Vec<_>>().join(", ");
            if !names.is_empty() {
                lines.push(if several { format!("{process}: {names}") } else { names });
            }
        }
        if lines.is_empty() {
            return String::new();
        }
        format!("\nuntried  {}; --out says why", lines.join("; "))
    }

    /// About ten lines that say what was found and what to do.
    pub fn terminal(&self) -> String {
        if let [(_, only)] = &self.processes[..] {
            return only.terminal() + &self.untried_line();
        }
        let mut text = String::new();
        for (process, answer) in &self.processes {
            let _ = writeln!(text, "{process:8} {}", verdict(answer));
            for effect in &answer.effects {
                let _ = writeln!(
                    text,
                    "  {}  {} (90 %: {} … {}), probability {:.2}{}",
                    named_effect(effect),
                    with_unit(effect.size, effect.unit),
                    rounded(effect.ci90[0]),
                    rounded(effect.ci90[1]),
                    effect.probability,
                    match &effect.class[1..] {
                        [] => String::new(),
                        others => format!(", not distinguished from {}", EffectId::words(others).join(", ")),
                    }
                );
            }
        }
        let cells = self.processes.iter().flat_map(|(process, own)| own.cells.iter().map(move |cell| (process, cell)));
        if let Some((process, cell)) = cells.max_by(|a, b| a.1.score.abs().total_cmp(&b.1.score.abs())) {
            let place = if cell.group == "all" { &cell.regime } else { &cell.group };
            let _ = writeln!(text, "where    {process}: {} follows {place} (score {:.1})", cell.channel, cell.score);
        }
        if self.verdict() == GapVerdict::Effect {
            let line_of = |name: &str, closure: &Closure| {
                let [low, high] = closure.ci90.map(percent);
                format!("{name} {} (90 %: {low} … {high})", percent(closure.closed))
            };
            let found = self.processes.iter().filter(|(_, own)| !own.effects.is_empty());
            let shown: Vec<String> = found.map(|(process, answer)| line_of(process, &answer.total)).collect();
            let _ =
                writeln!(text, "closed   on groups left out: {}; {}", shown.join(", "), line_of("in all", &self.total));
        }
        let budget = |(process, own): &(&str, Diagnosis)| {
            format!(
                "{process} {} effects, {} unexplained",
                percent(own.budget.effects),
                percent(own.budget.unexplained)
            )
        };
        let _ = writeln!(text, "budget   {}", self.processes.iter().map(budget).collect::<Vec<_>>().join("; "));
        let hidden = self.processes.iter().flat_map(|(process, own)| {
            let seen = own.masked.iter().filter(|masked| masked.minimal_detectable.is_finite());
            seen.take(2).map(move |masked| {
                format!("{process} {} below {}", masked.id, with_unit(masked.minimal_detectable, masked.unit))
            })
        });
        let hidden: Vec<String> = hidden.collect();
        if !hidden.is_empty() {
            let _ = writeln!(text, "hidden   {}", hidden.join(", "));
        }
        if let Some((process, answer)) = self.processes.iter().find(|(_, answer)| !answer.next.design.is_empty()) {
            let _ = writeln!(text, "next     {process}: {}", answer.next.design);
        }
        let notes: Vec<String> = self.notes().collect();
        let room = LINES.saturating_sub(text.lines().count() + 1);
        for note in notes.iter().take(room) {
            let _ = writeln!(text, "note     {note}");
        }
        if notes.len() > room {
            let _ = writeln!(text, "note     {} more in diagnosis.json", notes.len() - room);
        }
        text.trim_end().to_owned() + &self.untried_line()
    }

    /// Sections of a report: all processes beside each other, then how the answer of each came about, then what was not
    /// tried.
    pub fn sections(&self) -> Vec<Section> {
        let mut sections = Vec::new();
        if let [(_, only)] = &self.processes[..] {
            sections.extend(only.sections(""));
        } else {
            sections.push(self.overview());
            sections.extend(self.processes.iter().flat_map(|(process, own)| own.sections(process)));
        }
        sections.extend(self.untried_section());
        sections
    }

    fn untried_section(&self) -> Option<Section> {
        let mut table = Table::new(["process", "effect", "why it was not tried"]);
        for (process, untried) in &self.untried {
            table.push([(*process).into(), untried.id.word().into(), untried.reason.clone().into()]);
        }
        (!self.untried.is_empty()).then(|| {
            Section::new("What was not tried")
                .paragraph("Effects that act on the process and that these records and models cannot show.")
                .table("Effects that were not tried", table)
        })
    }

    fn overview(&self) -> Section {
        let mut chart = Intervals::new("How far the gap shrinks", Axis::linear("Closed on groups left out", "%"))
            .describe("Share of the root mean square gap that the named effects close, with its 90 % interval.")
            .reference(0.0, "nothing");
        let mut table = Table::new(["process", "verdict", "effects", "closed, %", "90 % from", "to", "groups scored"]);
        let all = self.processes.iter().map(|(process, own)| (*process, Some(own), &own.total));
        for (process, answer, closure) in all.chain([("in all", None, &self.total)]) {
            let [closed, low, high] = [closure.closed, closure.ci90[0], closure.ci90[1]].map(|share| 100.0 * share);
            if closed.is_finite() {
                chart = chart.row(process, Estimate::new(closed, low, high));
            }
            let effects = |answer: &Diagnosis| {
                answer.effects.iter().map(|effect| named(effect.id, &effect.shape)).collect::<Vec<_>>().join(", ")
            };
            table.push([
                process.into(),
                answer.map_or_else(|| self.verdict(), |answer| answer.verdict).name().into(),
                answer.map_or_else(String::new, effects).into(),
                closed.into(),
                low.into(),
                high.into(),
                answer.map_or_else(String::new, |answer| answer.held_out.len().to_string()).into(),
            ]);
        }
        Section::new("All processes")
            .paragraph(
                "Every process is held against its own model; nothing is shared between them. A name has to pay \
                 for the choice among all of them.",
            )
            .figure(Figure::new(&chart, "Process by process, and over all of them in units of noise."))
            .table("What was found", table)
    }
}

/// The entries of a list, each with its process.
fn tagged(document: &Value, list: &str, process: &str) -> Vec<Value> {
    let mut entries = document[list].as_array().cloned().unwrap_or_default();
    entries.iter_mut().for_each(|entry| entry["process"] = process.into());
    entries
}
