//! Terms of the context that may describe a gap of which no cause is known, as effects of a user.

use crate::{GapRequest, GapStudyError};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use toolroom_effects::{Definition, parse_definitions};
use toolroom_gap::{Diagnosis, GapVerdict, NominalModel, Proposal, propose};
use toolroom_records::Records;
use toolroom_statistics::median;

/// Powers of a quantity over its median that are tried (source: the catalogue of laws in machining is one of powers;
/// which ones is an assumption).
const POWERS: [f64; 5] = [-2.0, -1.0, 0.5, 1.0, 2.0];
/// Times, as shares of the greatest age of an edge, over which a term dies away (assumption).
const DECAYS: [f64; 3] = [0.03, 0.1, 0.3];
/// Logarithm of the greatest factor of a term at size 1 over the range that was seen (1). Assumption: sizes then are shares.
const RANGE: f64 = 2.0;
/// Every which group has no part in the choice of terms (count). Derivation: half of them, so that both halves see the same.
const EVERY: usize = 2;

/// Terms whose changes are tried together, with the channels that follow them, by process.
const CLASSES: [(&str, &[&str], &[&str]); 5] = [
    ("force", &["cutting_force", "feed_force"], &["cutting_force", "feed_force", "spindle_power"]),
    ("cutting_force", &["cutting_force"], &["cutting_force", "spindle_power"]),
    ("feed_force", &["feed_force"], &["feed_force"]),
    ("temperature", &["temperature_rise"], &["temperature", "thermo_emf"]),
    ("wear", &["wear_rate"], &["flank_wear"]),
];

/// What is proposed of a process, for its document and as a file.
pub struct Proposed {
    /// Entries of `proposals`.
    pub entries: Vec<Value>,
    /// A file of effects.
    pub text: String,
    /// A line for people.
    pub note: String,
}

/// A quantity of the context as records hold it, SI.
struct Seen {
    name: &'static str,
    unit: &'static str,
    least: f64,
    middle: f64,
    greatest: f64,
}

impl Seen {
    fn of(name: &'static str, unit: &'static str, values: &[f64]) -> Option<Self> {
        let mut known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite() && *value >= 0.0).collect();
        known.sort_by(f64::total_cmp);
        let (least, greatest) = (known.first().copied()?, known.last().copied()?);
        let middle = median(&mut known);
        // What hardly varies describes nothing.
        (middle > 0.0 && greatest > 1.05 * least).then_some(Self { name, unit, least, middle, greatest })
    }

    /// The quantity over its median, held at the ends of what was seen.
    fn ratio(&self) -> String {
        let Self { name, unit, least, middle, greatest } = self;
        format!("(min(max({name}, {least:e} {unit}), {greatest:e} {unit}) / {middle:e} {unit})")
    }

    fn words(&self) -> String {
        format!("{} {:.4e} … {:.4e} {}", self.name, self.least, self.greatest, self.unit)
    }
}

/// Quantities of the context that the records of a process hold.
fn seen(process: &str, records: &Records) -> Vec<Seen> {
    let feed = if process == "milling" { "feed_per_tooth" } else { "feed_per_rev" };
    let column = |name: &str| records.numbers(name).map(<[f64]>::to_vec);
    let mut all: Vec<Seen> = Vec::new();
    let mut add = |name: &'static str, unit: &'static str, values: Option<Vec<f64>>| {
        all.extend(values.and_then(|values| Seen::of(name, unit, &values)));
    };
    add("cutting_speed", "m/s", column("cutting_speed"));
    add("feed", "m", column(feed));
    add("depth_of_cut", "m", column("depth_of_cut"));
    add("flank_wear", "m", column("flank_wear"));
    add("cutting_time", "s", ages(records));
    if process == "milling" {
        add("width_of_cut", "m", column("width_of_cut"));
    } else {
        add("coolant_age", "s", column("coolant_age"));
    }
    all
}

/// Time in cut of the edge of each row before it ends, s.
fn ages(records: &Records) -> Option<Vec<f64>> {
    let (times, edges) = (records.numbers("cutting_time")?, records.texts("tool_id")?);
    let order = records.numbers("sequence");
    let mut rows: Vec<usize> = (0..records.len()).collect();
    if let Some(order) = order {
        rows.sort_by(|a, b| order[*a].total_cmp(&order[*b]));
    }
    let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
    let mut ages = vec![f64::NAN; records.len()];
    for row in rows {
        let sum = sums.entry(&edges[row]).or_default();
        *sum += times[row];
        ages[row] = *sum;
    }
    Some(ages)
}

/// Functions of the context, each with a word for ids and one for people.
fn functions(seen: &[Seen]) -> Vec<(String, String, String)> {
    let mut all = Vec::new();
    for own in seen {
        let zero = own.least <= 0.0;
        for power in POWERS.iter().filter(|power| **power > 0.0 || !zero) {
            let word = power.to_string().replace('-', "m").replace('.', "p");
            let formula = format!("{}^{power} - 1", own.ratio());
            all.push((format!("{}_{word}", own.name), format!("{}^{power}", own.name), formula));
        }
        if own.name == "cutting_time" {
            for (place, share) in DECAYS.iter().enumerate() {
                let decay = share * own.greatest;
                let formula = format!("exp(-min({}, {:e} s) / {decay:e} s)", own.name, own.greatest);
                all.push((format!("early_{place}"), format!("exp(-cutting_time / {decay:.3} s)"), formula));
            }
        }
    }
    for (i, one) in seen.iter().enumerate() {
        for other in &seen[i + 1..] {
            let formula = format!("{} * {} - 1", one.ratio(), other.ratio());
            let word = format!("{}_x_{}", one.name, other.name);
            all.push((word, format!("{} × {}", one.name, other.name), formula));
        }
    }
    all
}

/// The definition of a term of one class.
fn definition(
    process: &str,
    class: &(&str, &[&str], &[&str]),
    function: &(String, String, String),
    of: &str,
) -> String {
    let (name, terms, _) = class;
    let (word, people, formula) = function;
    let change = |term: &&str| format!("{{ term = \"{term}\", factor = \"exp(size * ({formula}))\" }}");
    let changes = terms.iter().map(change).collect::<Vec<_>>().join(", ");
    format!(
        "[[effect]]\nid = \"proposed.{name}_{word}\"\ntitle = \"{name} follows {people}: empirical, not a cause\"\n\
         kind = \"empirical\"\nprocess = [\"{process}\"]\nsize = {{ unit = \"1\", ordinary = 0.1, range = [-{RANGE}, {RANGE}] }}\n\
         changes = [{changes}]\nsource = \"{of}\"\n\n"
    )
}

/// What describes the gap of a process for which no cause was named.
///
/// # Errors
/// [`GapStudyError`]: the model cannot be held over its records.
pub fn proposed(
    process: &str,
    diagnosis: &Diagnosis,
    (model, records): (&NominalModel, &Records),
    path: &Path,
    request: &GapRequest<'_>,
) -> Result<Option<Proposed>, GapStudyError> {
    let open = diagnosis.verdict == GapVerdict::Unknown && diagnosis.effects.is_empty();
    if !open || !matches!(process, "turning" | "milling") {
        return Ok(None);
    }
    let seen = seen(process, records);
    let ranges = seen.iter().map(Seen::words).collect::<Vec<_>>().join("; ");
    let of = format!("proposed by gap diagnose from {} rows; seen: {ranges}", records.len());
    // Only channels that hold structure are described.
    let structured = |class: &&(&str, &[&str], &[&str])| {
        let mut cells = diagnosis.cells.iter().take(CELLS);
        // Milling has no temperature.
        let is_read = class.0 != "temperature" || process == "turning";
        is_read && cells.any(|cell| class.2.iter().any(|channel| cell.channel.contains(channel)))
    };
    let classes: Vec<_> = CLASSES.iter().filter(structured).collect();
    let texts: BTreeMap<String, String> = classes
        .iter()
        .flat_map(|class| functions(&seen).into_iter().map(move |function| (class, function)))
        .map(|(class, function)| {
            (format!("proposed.{}_{}", class.0, function.0), definition(process, class, &function, &of))
        })
        .collect();
    let library = format!("schema = 1\n{}", texts.values().cloned().collect::<String>());
    let defined: Vec<&'static Definition> = parse_definitions("proposed.toml", &library)
        .map_err(|error| GapStudyError::Work(format!("the library of terms: {error}")))?;
    let held = |index: usize, _: &str| index % EVERY == EVERY - 1;
    let asked = model.clone().with_effects(path, &defined)?.asked(records, request.group, held);
    let [part] = &asked.parts[..] else { return Ok(None) };
    let is_term = |id: &str| texts.contains_key(id);
    let Some(found) = propose(part.as_ref(), &is_term, request.seed) else { return Ok(None) };
    Ok(Some(told(process, &found, &texts)))
}

/// Cells of the map whose channels are described (count). Assumption: weaker structure follows from stronger.
const CELLS: usize = 3;

fn told(process: &str, found: &Proposal, texts: &BTreeMap<String, String>) -> Proposed {
    let mut text = "# Terms that describe a gap: empirical, not a cause. Each holds its value at the ends of the range in which\n\
                    # it was seen. `toolroom gap diagnose --effects proposed.toml`, then `gap apply --accept-empirical`.\n\
                    schema = 1\n\n"
        .to_owned();
    found.terms.iter().filter_map(|term| texts.get(term.id)).for_each(|own| text += own);
    let [low, high] = found.closure.ci90.map(|end| 100.0 * end);
    let ids = found.terms.iter().map(|term| format!("{} {:.3}", term.id, term.size)).collect::<Vec<_>>().join(" and ");
    let mut note = format!(
        "proposed (empirical, not a cause): {ids}; closes {:.0} % ({low:.0} … {high:.0}) of the gap on groups that had no \
         part in the choice",
        100.0 * found.closure.closed
    );
    let alike: Vec<&str> = found.terms.iter().flat_map(|term| term.as_good.iter().copied()).collect();
    if !alike.is_empty() {
        let _ = write!(note, "; as good: {}", alike.join(", "));
    }
    let entry = |term: &toolroom_gap::ProposedTerm| {
        json!({
            "kind": "empirical", "process": process, "effect": "proposed.toml", "id": term.id,
            "size": { "value": term.size, "unit": "1", "se": term.standard_error }, "as_good": term.as_good,
            "closure": { "closed": found.closure.closed, "ci90": found.closure.ci90 },
            "note": "empirical, not a cause",
        })
    };
    Proposed { entries: found.terms.iter().map(entry).collect(), text, note }
}
