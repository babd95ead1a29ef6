//! On which part of the records an effect acts: a second diagnosis tries what the first one found on parts as well.

use crate::GapRequest;
use crate::known::RecordedModel;
use toolroom_effects::Definition;
use toolroom_gap::{Answers, Diagnosis, EffectId, GATE, GapVerdict, NominalModel, ProcessData};
use toolroom_records::Records;

/// The models of turning, milling and grinding in which what was found, or what the data ask for where nothing was named, is
/// tried on parts of the records as well; nothing where there is no such effect.
pub(crate) fn split(
    answers: &Answers,
    tables: &[Option<(NominalModel, Records)>],
    stated: &[RecordedModel],
    asked: &[ProcessData],
    request: &GapRequest<'_>,
) -> Option<Vec<ProcessData>> {
    let mut any = false;
    let mut all = Vec::new();
    for (i, (process, diagnosis)) in answers.processes.iter().enumerate() {
        let own = &asked[i];
        let Some((model, records)) = &tables[i] else {
            let (notes, impossible) = (own.notes.clone(), own.impossible);
            all.push(ProcessData { process, parts: Vec::new(), notes, impossible });
            continue;
        };
        // Records that the model has seen are held against what it was before them, which has no parts.
        let aside = stated[i].is_set_aside();
        let mut effects = if aside { Vec::new() } else { asked_for(process, diagnosis) };
        effects.extend(described(process, request, &effects).into_iter().filter(|_| !aside));
        let places = if aside { Vec::new() } else { places(process, diagnosis) };
        any |= !effects.is_empty() || !places.is_empty();
        let held = |_: usize, name: &str| !fitted(own, name);
        all.push(model.clone().splitting(effects, places).asked(records, request.group, held));
    }
    any.then_some(all)
}

/// Effects of a diagnosis, by id and shape, of which it is asked where they act.
fn asked_for(process: &str, diagnosis: &Diagnosis) -> Vec<(EffectId, String)> {
    if !SPLIT.contains(&process) {
        return Vec::new();
    }
    let named = || diagnosis.effects.iter().map(|own| (own.id, own.shape.clone()));
    let likely = || {
        let told = matches!(diagnosis.verdict, GapVerdict::Unknown | GapVerdict::Small | GapVerdict::Masked);
        let asked = diagnosis.ranking.iter().filter(move |own| told && own.gain > GATE);
        asked.map(|own| (own.id, own.shape.clone())).take(MOST_SPLIT)
    };
    if diagnosis.effects.is_empty() { likely().collect() } else { named().take(MOST_SPLIT).collect() }
}

/// Effects of the request that describe and are no cause, by id and shape, but for those in `known`: a term that was proposed
/// may say nothing but where it acts.
fn described(process: &str, request: &GapRequest<'_>, known: &[(EffectId, String)]) -> Vec<(EffectId, String)> {
    let acts = |own: &&&'static Definition| own.is_empirical() && own.entry().search(process).is_some();
    let all = request.defined.iter().filter(acts).map(|own| (EffectId::from(*own), String::new()));
    all.filter(|own| SPLIT.contains(&process) && !known.contains(own)).collect()
}

/// Levels of columns that the strongest structure follows, where it has no cause: every effect is tried there.
fn places(process: &str, diagnosis: &Diagnosis) -> Vec<(String, String)> {
    if !SPLIT.contains(&process) {
        return Vec::new();
    }
    let mut list: Vec<(String, String)> = Vec::new();
    if follows_a_date(diagnosis) {
        // No level of a column: what is tried there is tried from dates on.
        list.push(("start_time".to_owned(), String::new()));
    }
    if !matches!(diagnosis.verdict, GapVerdict::Unknown | GapVerdict::Effect) {
        return list;
    }
    let dates = list.len();
    let levels =
        diagnosis.cells.iter().flat_map(|cell| [&cell.group, &cell.regime]).filter_map(|own| own.split_once('='));
    for (column, name) in levels {
        let own = (column.to_owned(), name.to_owned());
        if !list.contains(&own) && list.len() < MOST_SPLIT + dates {
            list.push(own);
        }
    }
    list
}

/// Whether what the test finds follows the calendar, and is neither explained nor small.
fn follows_a_date(diagnosis: &Diagnosis) -> bool {
    let open = matches!(diagnosis.verdict, GapVerdict::Unknown | GapVerdict::Masked | GapVerdict::Constant);
    let Some(fit) = diagnosis.fit.as_ref().filter(|fit| open && !fit.passed()) else { return false };
    fit.parts.iter().any(|part| part.p <= fit.level && part.follows.starts_with("calendar"))
}

/// Processes whose effects are tried on parts of the records in a second run: the model of a shop has those parts from the
/// first on, and stretches of programs and power laws have none.
const SPLIT: [&str; 3] = ["turning", "milling", "grinding"];
/// Effects that are tried on parts of the records at a time (assumption): each brings a candidate for every part.
const MOST_SPLIT: usize = 2;

/// Whether a diagnosis `now`, in which effects are tried on parts of the records, answers better where they act than the `first`
/// one: it names an effect on a part; or it names none, since the part on which the records ask most for an effect that the
/// first one named everywhere does not stand. The records contradict "everywhere" then, too.
pub(crate) fn finds_a_part(first: &Answers, now: &Answers, before: &[ProcessData], split: &[ProcessData]) -> bool {
    let knows = |asked: &ProcessData, id: EffectId, shape: &str| {
        let candidates = asked.parts.iter().flat_map(|part| &part.frame().candidates);
        candidates.into_iter().any(|own| own.id == id && own.shape == shape)
    };
    let asked = before.iter().zip(split);
    let processes = first.processes.iter().zip(&now.processes).zip(asked);
    processes.into_iter().any(|(((_, first), (_, now)), (before, split))| {
        let is_part = |id: EffectId, shape: &str| knows(split, id, shape) && !knows(before, id, shape);
        let contradicted = || {
            let [best, ..] = &now.ranking[..] else { return false };
            let refused = now.effects.is_empty() && now.verdict == GapVerdict::Unknown;
            refused && first.effects.iter().any(|own| own.id == best.id) && is_part(best.id, &best.shape)
        };
        now.effects.iter().any(|own| is_part(own.id, &own.shape)) || contradicted()
    })
}

/// Whether a group is part of the fit.
pub(crate) fn fitted(asked: &ProcessData, name: &str) -> bool {
    let measured = asked.parts.iter().map(|part| &part.frame().measured);
    measured.flat_map(|own| own.groups.iter().zip(&own.fitted)).any(|(group, fitted)| group == name && *fitted)
}
