//! One case, diagnosed and held against what was hidden.

use crate::BlindError;
use crate::row::{Mark, Row};
use crate::shrunk::Shrunk;
use toolroom_gap::{EffectId, Forward, GapVerdict, Method, NamedEffect, NominalModel, diagnose_by, identifiability};
use toolroom_records::{Records, parse_csv};
use toolroom_truth::{Case, Hidden};

/// Seed of every diagnosis; what is random about a case is the case.
const SEED: u64 = 1;

/// Diagnoses the records of `case` with `model` by a method called `name`.
pub(crate) fn judged(case: &Case, model: &NominalModel, name: &str, method: Method) -> Result<Row, BlindError> {
    let records = recorded(case, model)?;
    let (forward, _) = model.over(&records, None, |_, _| false);
    let diagnosis = diagnose_by(forward.as_ref(), method, SEED).diagnosis;
    let whole = method == Method::default();
    let promised = if whole { promised(case, forward.as_ref()) } else { None };
    let hidden_size = match &case.hidden[..] {
        [hidden] => case.size(hidden.id),
        _ => None,
    };
    let shrunk = match &case.hidden[..] {
        [hidden] if whole && hidden_size.is_some() && !diagnosis.effects.is_empty() => {
            Shrunk::from_text(hidden.id, &diagnosis, &records, recorded(&case.on_new_edges(), model)?, model)
        }
        _ => None,
    };
    let named = &diagnosis.effects;
    let join = |value: &dyn Fn(&NamedEffect) -> String| named.iter().map(value).collect::<Vec<_>>().join(" + ");
    let single = if let [effect] = &named[..] { Some(effect) } else { None };
    let hidden = |hidden: &Hidden| format!("{} x{}", hidden.id, hidden.strength);
    let closure = &diagnosis.total;
    let last = diagnosis.not_named.last();
    let closed = |value: f64| shrunk.as_ref().and_then(|_| rounded(value));
    let measured = |value: &dyn Fn(&Shrunk) -> f64| shrunk.as_ref().and_then(|shrunk| rounded(value(shrunk)));
    Ok(Row {
        method: name.to_owned(),
        process: case.process.to_owned(),
        set: case.set.name().to_owned(),
        seed: case.seed,
        hidden: case.hidden.iter().map(hidden).collect::<Vec<_>>().join(" + "),
        hidden_size: hidden_size.and_then(rounded),
        promised_z: promised.and_then(rounded),
        mark: mark(case, diagnosis.verdict, named),
        named: join(&|effect| effect.id.to_string()),
        class: join(&|effect| EffectId::words(&effect.class).join(" ")),
        shape: join(&|effect| effect.shape.clone()),
        size: single.and_then(|effect| rounded(effect.size)),
        size_low: single.and_then(|effect| rounded(effect.ci90[0])),
        size_high: single.and_then(|effect| rounded(effect.ci90[1])),
        unit: join(&|effect| effect.unit.to_owned()),
        size_on_new_edges: shrunk.as_ref().and_then(|shrunk| shrunk.size).and_then(rounded),
        probability: join(&|effect| format!("{:.3}", effect.probability)),
        z: join(&|effect| format!("{:.2}", effect.z)),
        closed: closed(closure.closed),
        closed_low: closed(closure.ci90[0]),
        closed_high: closed(closure.ci90[1]),
        closed_on_new_edges: measured(&|shrunk| shrunk.closed),
        closed_by_named: measured(&|shrunk| shrunk.by_named),
        closed_by_hidden: measured(&|shrunk| shrunk.by_hidden),
        notes: diagnosis.notes.join("; "),
        times: case.times,
        form: case.form,
        not_named: last.map_or_else(String::new, |last| EffectId::words(&last.effects).join(" + ")),
        rules: last
            .map_or_else(String::new, |last| last.rules.iter().map(|found| found.rule).collect::<Vec<_>>().join(" ")),
    })
}

/// Five digits; nothing where it is no number.
fn rounded(value: f64) -> Option<f64> {
    value.is_finite().then(|| format!("{value:.4e}").parse().unwrap_or(value))
}

fn recorded(case: &Case, model: &NominalModel) -> Result<Records, BlindError> {
    let text = case.records();
    let read = parse_csv(case.process, text.as_bytes(), model.kind());
    read.map(|(records, _)| records).map_err(|source| BlindError::Records {
        process: case.process.to_owned(),
        seed: case.seed,
        source: Box::new(source),
    })
}

fn mark(case: &Case, verdict: GapVerdict, named: &[NamedEffect]) -> Mark {
    match verdict {
        GapVerdict::Unknown | GapVerdict::Constant => return Mark::Unknown,
        GapVerdict::Masked | GapVerdict::CannotTell => return Mark::Masked,
        GapVerdict::NoGap | GapVerdict::Small => return Mark::NoGap,
        GapVerdict::Effect => {}
    }
    let in_class = |effect: &NamedEffect, id: &str| effect.class.iter().any(|own| own.word() == id);
    let hidden = |effect: &NamedEffect| case.hidden.iter().any(|hidden| in_class(effect, hidden.id));
    if !named.iter().all(hidden) {
        return Mark::Wrong;
    }
    let found = |id: &str| named.iter().any(|effect| in_class(effect, id));
    if case.hidden.iter().all(|hidden| found(hidden.id)) { Mark::Exact } else { Mark::Partly }
}

/// Score that the design of the records promises for the hidden causes.
fn promised(case: &Case, forward: &dyn Forward) -> Option<f64> {
    let known = case.hidden.iter().any(|hidden| case.size(hidden.id).is_some());
    let list = if known { identifiability(forward) } else { Vec::new() };
    let score = |hidden: &Hidden| {
        let size = case.size(hidden.id)?;
        // Where a cause acts is not known beforehand: of its shapes the one that shows least counts.
        let rows = list.iter().filter(|row| row.id.word() == hidden.id);
        Some(rows.map(|row| row.score(size)).min_by(f64::total_cmp).unwrap_or(0.0))
    };
    case.hidden.iter().filter_map(score).min_by(f64::total_cmp)
}
