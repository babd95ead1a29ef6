//! One case, diagnosed and held against what was hidden.

use super::shrunk::Shrunk;
use crate::failure::Failure;
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_analysis::gap::{Forward, GapVerdict, Method, NamedEffect, NominalModel, diagnose_by, identifiability};
use toolroom_analysis::records::{Records, parse_csv};
use toolroom_truth::Case;

/// Seed of every diagnosis; what is random about a case is the case.
const SEED: u64 = 1;

/// How right an answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// Every hidden cause is named, itself or in the class of a named one, and nothing else.
    Exact,
    /// Some of the hidden causes are named, and nothing else.
    Partly,
    /// Something is named that was not hidden.
    Wrong,
    /// "Something is there, nothing of the catalogue."
    Unknown,
    /// "Something may be there, such data cannot show it."
    Masked,
    /// No gap was seen.
    NoGap,
}

impl Mark {
    pub const ALL: [Self; 6] = [Self::Exact, Self::Partly, Self::Wrong, Self::Unknown, Self::Masked, Self::NoGap];

    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Partly => "partly",
            Self::Wrong => "wrong",
            Self::Unknown => "unknown",
            Self::Masked => "masked",
            Self::NoGap => "no gap",
        }
    }
}

/// A case with its answer.
pub struct Judged {
    pub case: Case,
    pub verdict: GapVerdict,
    pub mark: Mark,
    pub named: Vec<NamedEffect>,
    /// Score that the design of the records promised for the hidden cause of its size; of several,
    /// the least. `None` where nothing of the catalogue is hidden.
    pub promised: Option<f64>,
    /// How far the gap shrinks, where one hidden cause was answered with a name.
    pub shrunk: Option<Shrunk>,
    pub notes: Vec<String>,
}

impl Judged {
    /// Diagnoses the records of `case` with `model`.
    pub fn of(case: &Case, model: &NominalModel, method: Method) -> Result<Self, Failure> {
        let records = recorded(case, model)?;
        let (forward, _) = model.over(&records, None, |_, _| false);
        let diagnosis = diagnose_by(forward.as_ref(), method, SEED).diagnosis;
        let whole = method == Method::default();
        let promised = if whole { promised(case, forward.as_ref()) } else { None };
        let mark = mark(case, diagnosis.verdict, &diagnosis.effects);
        let shrunk = match case.hidden.as_slice() {
            [hidden] if whole && promised.is_some() && !diagnosis.effects.is_empty() => {
                Shrunk::of(hidden.id, &diagnosis, &records, &recorded(&case.on_new_edges(), model)?, model)
            }
            _ => None,
        };
        let (verdict, named, notes) = (diagnosis.verdict, diagnosis.effects, diagnosis.notes);
        Ok(Self { case: case.clone(), verdict, mark, named, promised, shrunk, notes })
    }

    fn hidden(&self) -> String {
        let each = |hidden: &toolroom_truth::Hidden| format!("{} x{}", hidden.id, hidden.strength);
        self.case.hidden.iter().map(each).collect::<Vec<_>>().join(" + ")
    }

    pub fn json(&self) -> Value {
        let named = |effect: &NamedEffect| {
            json!({
                "id": effect.id, "shape": effect.shape, "size": effect.size, "unit": effect.unit, "ci90": effect.ci90,
                "probability": effect.probability, "z": effect.z, "class": effect.class,
            })
        };
        json!({
            "process": self.case.process, "set": self.case.set.name(), "seed": self.case.seed, "hidden": self.hidden(),
            "promised_z": self.promised, "verdict": self.verdict.name(), "mark": self.mark.name(),
            "closure": self.shrunk.as_ref().map(Shrunk::json),
            "named": self.named.iter().map(named).collect::<Vec<_>>(), "notes": self.notes,
        })
    }
}

fn recorded(case: &Case, model: &NominalModel) -> Result<Records, Failure> {
    let text = case.records();
    let read = parse_csv(case.process, text.as_bytes(), model.kind());
    read.map(|(records, _)| records)
        .map_err(|error| Failure::Work { message: format!("records of {} {}: {error}", case.process, case.seed) })
}

fn mark(case: &Case, verdict: GapVerdict, named: &[NamedEffect]) -> Mark {
    match verdict {
        GapVerdict::Unknown => return Mark::Unknown,
        GapVerdict::Masked => return Mark::Masked,
        GapVerdict::NoGap => return Mark::NoGap,
        GapVerdict::Effect => {}
    }
    let hidden = |effect: &NamedEffect| case.hidden.iter().any(|hidden| effect.class.contains(&hidden.id));
    if !named.iter().all(hidden) {
        return Mark::Wrong;
    }
    let found = |id: &str| named.iter().any(|effect| effect.class.contains(&id));
    if case.hidden.iter().all(|hidden| found(hidden.id)) { Mark::Exact } else { Mark::Partly }
}

/// Score that the design of the records promises for the hidden causes.
fn promised(case: &Case, forward: &dyn Forward) -> Option<f64> {
    let known = case.hidden.iter().any(|hidden| case.size(hidden.id).is_some());
    let list = if known { identifiability(forward) } else { Vec::new() };
    let score = |hidden: &toolroom_truth::Hidden| {
        let size = case.size(hidden.id)?;
        // Where a cause acts is not known beforehand: of its shapes the one that shows least counts.
        let rows = list.iter().filter(|row| row.id == hidden.id);
        Some(rows.map(|row| row.score(size)).min_by(f64::total_cmp).unwrap_or(0.0))
    };
    case.hidden.iter().filter_map(score).min_by(f64::total_cmp)
}

/// Every case as CSV.
pub fn table(judged: &[Judged]) -> String {
    let mut text = String::from(
        "process,set,seed,hidden,promised_z,verdict,mark,named,class,size,probability,z,\
         closed,closed_low,closed_high,closed_on_new_edges,closed_by_hidden_effect\n",
    );
    for row in judged {
        let join = |value: &dyn Fn(&NamedEffect) -> String| row.named.iter().map(value).collect::<Vec<_>>().join(" + ");
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{},{}",
            row.case.process,
            quoted(row.case.set.name()),
            row.case.seed,
            row.hidden(),
            row.promised.map_or_else(String::new, |z| format!("{z:.2}")),
            row.verdict.name(),
            row.mark.name(),
            join(&|effect| effect.id.to_owned()),
            join(&|effect| effect.class.join(" ")),
            join(&|effect| format!("{:.4} {}", effect.size, effect.unit)),
            join(&|effect| format!("{:.3}", effect.probability)),
            join(&|effect| format!("{:.2}", effect.z)),
            row.shrunk.as_ref().map_or_else(|| ",,,,".to_owned(), Shrunk::csv),
        );
    }
    text
}

fn quoted(text: &str) -> String {
    if text.contains(',') { format!("\"{text}\"") } else { text.to_owned() }
}
