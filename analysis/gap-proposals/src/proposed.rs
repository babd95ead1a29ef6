//! What describes the gap of a process of which no cause was named.

use crate::library::{CLASSES, Class, Function, definition, functions, level};
use crate::seen::{VaryingQuantity, seen};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use toolroom_apply::{Applied, applied_to, scope_json};
use toolroom_effects::{Definition, parse_definitions};
use toolroom_gap::{
    Candidate, Diagnosis, EffectId, Forward, GapVerdict, Library, ModelFileError, NominalModel, ProcessData, Proposal,
    ProposedTerm, propose,
};
use toolroom_records::Records;

/// Parts of the groups that are left out of the choice one after the other (count). Assumption: two thirds of the groups
/// choose nearly what all of them would, and each choice costs as much as a diagnosis.
const PARTS: usize = 3;
/// Cells of the map whose channels are described (count). Assumption: weaker structure follows from stronger.
const CELLS: usize = 3;
/// Terms that are listed as equally good beside a term at most (count). Assumption: nobody reads a longer list.
const AS_GOOD: usize = 8;

/// Said wherever a term is printed.
const NO_CAUSE: &str = "empirical, not a cause";

/// A process whose gap is to be described.
#[derive(Clone, Copy)]
pub struct DescriptionRequest<'a> {
    /// Its word.
    pub process: &'a str,
    /// What was found of it.
    pub diagnosis: &'a Diagnosis,
    /// Its nominal model.
    pub model: &'a NominalModel,
    /// The file of the model, for messages.
    pub path: &'a Path,
    /// What was recorded.
    pub records: &'a Records,
    /// Column whose levels are groups; edges where there is none.
    pub group: Option<&'a str>,
    /// Whether a group, by name, is kept out of the diagnosis.
    pub held: &'a (dyn Fn(&str) -> bool + Sync),
    /// The file of terms, by name.
    pub file: &'a str,
    /// Seed of what is drawn.
    pub seed: u64,
}

/// What describes the gap of a process.
pub struct Proposed {
    /// The file of terms.
    pub text: String,
    /// The entry of `proposals` in `diagnosis.json`, without what is applied.
    pub entry: Value,
    /// A line for people.
    pub note: String,
    /// The point with the terms that an application writes.
    pub applied: Applied,
}

/// Why nothing was proposed where something was looked for; for people.
pub const NOTHING: &str =
    "nothing is proposed: no term of the library describes the gap of groups that had no part in its choice";

/// Whether a cause is wanting of a process that has a library: nothing is named, or something is left beside what is named.
pub fn is_open(process: &str, diagnosis: &Diagnosis) -> bool {
    let read = CLASSES.iter().any(|class| class.processes.contains(&process));
    read && (diagnosis.verdict == GapVerdict::Unknown || diagnosis.remaining().is_some())
}

/// What describes the gap of a process for which no cause is known.
///
/// # Errors
/// [`ModelFileError::Defined`]: the model defines an effect by the id of a term.
pub fn proposed(asking: &DescriptionRequest<'_>) -> Result<Option<Proposed>, ModelFileError> {
    if !is_open(asking.process, asking.diagnosis) {
        return Ok(None);
    }
    let seen = seen(asking.process, asking.records);
    let read = |class: &&Class| class.processes.contains(&asking.process);
    let classes: Vec<&Class> =
        CLASSES.iter().filter(read).filter(|class| is_structured(asking.diagnosis, class)).collect();
    let shelf = Shelf::new(asking, &seen, &classes);
    let model = shelf.model(asking)?;
    let asked = model.asked(asking.records, asking.group, |_, name| (asking.held)(name));
    let [whole] = &asked.parts[..] else { return Ok(None) };
    let without = without(asking, &model, whole.as_ref());
    let without: Vec<&dyn Forward> = without.iter().filter_map(|own| Some(own.parts.first()?.as_ref())).collect();
    let named = named(asking.diagnosis, whole.as_ref());
    let (Some(named), PARTS) = (named, without.len()) else { return Ok(None) };
    let offered = (0..whole.frame().candidates.len()).filter(|index| shelf.offers(whole.as_ref(), *index));
    let (mut terms, products): (Vec<usize>, Vec<usize>) =
        offered.partition(|index| shelf.is_simple(whole.as_ref(), *index));
    let simple = terms.len();
    terms.extend(products);
    let library = Library { model: whole.as_ref(), named: &named, terms: &terms, simple };
    let Some(found) = propose(&library, &without, asking.seed) else { return Ok(None) };
    Ok(Some(told(asking, &shelf, &library, &found)))
}

/// Whether the map shows structure in a channel of the class, or the test rejects one.
fn is_structured(diagnosis: &Diagnosis, class: &Class) -> bool {
    let cells = diagnosis.cells.iter().take(CELLS).map(|cell| cell.channel.as_str());
    let tested = diagnosis.fit.iter().chain(&diagnosis.fit_with_effects);
    let rejected = tested.filter(|fit| !fit.passed()).filter_map(|fit| fit.parts.first()).map(|part| part.what);
    let mut all = cells.chain(rejected);
    all.any(|words| words.split(" + ").any(|word| class.channels.contains(&word)))
}

/// The library of a process.
struct Shelf<'a> {
    seen: &'a [VaryingQuantity],
    /// Class and function of each definition.
    rows: Vec<(&'static str, Function)>,
    definitions: Vec<&'static Definition>,
    /// Ids of the terms that say where and nothing else.
    levels: Vec<EffectId>,
}

impl<'a> Shelf<'a> {
    fn new(asking: &DescriptionRequest<'_>, seen: &'a [VaryingQuantity], classes: &[&Class]) -> Self {
        let functions = [functions(seen), vec![level()]].concat();
        let (mut rows, mut definitions, mut levels) = (Vec::new(), Vec::new(), Vec::new());
        for class in classes {
            for function in &functions {
                let ranges: Vec<String> = function.reads.iter().map(|place| seen[*place].words()).collect();
                let seen_in =
                    if ranges.is_empty() { String::new() } else { format!("; seen in {}", ranges.join(", ")) };
                let source = format!("proposed by gap diagnose from {} operations{seen_in}", asking.records.len());
                let text = definition(asking.process, class, function, &source);
                // A library of our own: what cannot be written is no term.
                let read = parse_definitions(asking.file, &text).unwrap_or_default();
                for own in read {
                    if function.reads.is_empty() {
                        levels.push(EffectId::from(own));
                    }
                    rows.push((class.name, function.clone()));
                    definitions.push(own);
                }
            }
        }
        Self { seen, rows, definitions, levels }
    }

    /// The model with the library, whose levels are tried on every part of the records, as named effects are.
    fn model(&self, asking: &DescriptionRequest<'_>) -> Result<NominalModel, ModelFileError> {
        let levels = self.levels.iter().map(|id| (*id, String::new()));
        let effects = asking.diagnosis.effects.iter();
        let named = effects.flat_map(|own| [(own.id, String::new()), (own.id, own.shape.clone())]);
        let split: Vec<(EffectId, String)> = named.chain(levels).collect();
        Ok(asking.model.clone().with_effects(asking.path, &self.definitions)?.splitting(split, Vec::new()))
    }

    /// Whether a candidate is a term: a level of all records is a constant, which calibration has.
    fn offers(&self, model: &dyn Forward, candidate: usize) -> bool {
        let id = model.frame().candidates[candidate].id;
        let own = self.definition(id).is_some();
        own && (!self.levels.contains(&id) || !model.written(candidate).scope.is_everywhere())
    }

    /// Whether a term reads one quantity at most.
    fn is_simple(&self, model: &dyn Forward, candidate: usize) -> bool {
        let reads = self.definition(model.frame().candidates[candidate].id).map(|(_, function)| function.reads.len());
        reads.is_none_or(|count| count < 2)
    }

    fn definition(&self, id: EffectId) -> Option<(&'static Definition, &Function)> {
        let place = self.definitions.iter().position(|own| EffectId::from(*own) == id)?;
        Some((self.definitions[place], &self.rows[place].1))
    }

    /// The ranges in which a term was seen.
    fn ranges(&self, id: EffectId) -> String {
        let reads = self.definition(id).map_or(&[][..], |(_, function)| &function.reads);
        reads.iter().map(|place| self.seen[*place].words()).collect::<Vec<_>>().join(", ")
    }
}

/// The same model, each time without another part of its fitted groups.
fn without(asking: &DescriptionRequest<'_>, model: &NominalModel, whole: &dyn Forward) -> Vec<ProcessData> {
    let measured = &whole.frame().measured;
    let mut groups: Vec<&str> = measured.fitted_groups().map(|group| measured.groups[group].as_str()).collect();
    // Edges alternate between machines: every so many of them would be those of one.
    groups.shuffle(&mut ChaCha8Rng::seed_from_u64(asking.seed));
    let part = |part: usize| {
        let out = |name: &str| groups.iter().position(|own| *own == name).is_some_and(|place| place % PARTS == part);
        model.asked(asking.records, asking.group, |_, name| (asking.held)(name) || out(name))
    };
    (0..PARTS).map(part).collect()
}

/// The candidates of the effects that were named; `None` where one of them is not among the candidates.
fn named(diagnosis: &Diagnosis, model: &dyn Forward) -> Option<Vec<usize>> {
    let candidates = &model.frame().candidates;
    let place = |own: &toolroom_gap::NamedEffect| {
        candidates.iter().position(|other: &Candidate| other.id == own.id && other.shape == own.shape)
    };
    diagnosis.effects.iter().map(place).collect()
}

/// What is said of a proposal.
fn told(asking: &DescriptionRequest<'_>, shelf: &Shelf<'_>, library: &Library<'_>, proposal: &Proposal) -> Proposed {
    let Library { model, named, .. } = *library;
    let candidates = &model.frame().candidates;
    let active: Vec<usize> = named.iter().copied().chain(proposal.terms.iter().map(|term| term.candidate)).collect();
    let [without, with] = &proposal.points;
    let applied = applied_to(model, model, &[], &proposal.basis, &active, Some([without, with]));
    let words = |index: usize| {
        let where_to = model.written(index).scope.words();
        let id = candidates[index].id;
        if where_to.is_empty() { id.to_string() } else { format!("{id} ({where_to})") }
    };
    let as_good =
        |term: &ProposedTerm| term.as_good.iter().take(AS_GOOD).map(|index| words(*index)).collect::<Vec<String>>();
    let unit = |id: EffectId| shelf.definition(id).map_or("1", |(own, _)| own.entry().size.unit);
    let with_unit = |term: &ProposedTerm| match unit(candidates[term.candidate].id) {
        "1" => format!("{:.3}", term.size),
        unit => format!("{:.3} {unit}", term.size),
    };
    let [low, high] = proposal.closure.ci90.map(|end| 100.0 * end);
    let closed = format!(
        "closes {:.0} % ({low:.0} … {high:.0}) of the gap on groups that had no part in the choice",
        100.0 * proposal.closure.closed
    );
    let mut text = format!(
        "# Terms that describe the gap of {}: {NO_CAUSE}. Together they {}.\n\
         # Each holds its value at the ends of the range in which it was seen. To try them on other records:\n\
         # toolroom gap diagnose --model MODEL --data DATA --effects {}\n\
         # To take them into the model: toolroom gap apply --model MODEL --diagnosis DIR/diagnosis.json --accept-empirical --out MODEL2\n\
         schema = 1\n",
        asking.process,
        closed.replacen("closes", "close", 1),
        asking.file
    );
    let mut written: Vec<EffectId> = Vec::new();
    for term in &proposal.terms {
        let own = words(term.candidate);
        let _ = writeln!(text, "\n# {own}: size {} ± {:.3}", with_unit(term), term.standard_error);
        let alike = as_good(term);
        if !alike.is_empty() {
            let _ = writeln!(text, "# as good: {}", alike.join(", "));
        }
        let id = candidates[term.candidate].id;
        if let (Some((definition, _)), false) = (shelf.definition(id), written.contains(&id)) {
            text += definition.text();
            written.push(id);
        }
    }
    let term = |term: &ProposedTerm| {
        let index = term.candidate;
        let id = candidates[index].id;
        json!({
            "id": id.word(), "scope": scope_json(&model.written(index).scope), "seen": shelf.ranges(id),
            "title": shelf.definition(id).map(|(own, _)| own.entry().title),
            "size": { "value": term.size, "unit": unit(id), "se": term.standard_error }, "as_good": as_good(term),
        })
    };
    let sizes = proposal.terms.iter().map(|term| format!("{} {}", words(term.candidate), with_unit(term)));
    let note = format!("proposed ({NO_CAUSE}): {}; {closed}", sizes.collect::<Vec<_>>().join(" and "));
    let entry = json!({
        "kind": "empirical", "process": asking.process, "effect": asking.file,
        "terms": proposal.terms.iter().map(term).collect::<Vec<_>>(),
        "closure": { "closed": proposal.closure.closed, "ci90": proposal.closure.ci90, "before": proposal.closure.before,
                     "after": proposal.closure.after },
        "left_out": proposal.left_out, "note": NO_CAUSE,
    });
    Proposed { text, entry, note, applied }
}
