//! How often a single hidden effect is found: where the records promised to show it, and effect by effect.

use crate::method::WHOLE;
use crate::row::{Mark, Row};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_statistics::clopper_pearson;
use toolroom_truth::Set;

/// Score from which the records of a design promise to show an effect. Source: the gate of the benchmark.
const PROMISED: f64 = 5.0;
/// Strength of an effect of ordinary size.
const ORDINARY: f64 = 1.0;

/// Shops that hide one effect of the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Power {
    /// The process.
    pub process: String,
    /// The effect; all of them, if empty.
    pub effect: String,
    /// Its size over the ordinary one.
    pub strength: f64,
    /// Whether its score was promised to reach 5; `None` where promised and unpromised ones count together.
    pub promised: Option<bool>,
    /// Shops.
    pub shops: usize,
    /// Shops of which it was named, itself or in the class of what was named, and nothing else.
    pub found: usize,
}

impl Power {
    /// Exact 95 % bounds of the share that is found.
    pub fn bounds(&self) -> [f64; 2] {
        clopper_pearson(self.found, self.shops, 0.95)
    }
}

/// A shop that hides one effect: its row, the effect, its strength.
fn single(row: &Row) -> Option<(&Row, &str, f64)> {
    let alone = row.method == WHOLE && row.set == Set::Effect.name() && row.times == 1 && row.form == 0.0;
    let (effect, strength) = row.hidden.split_once(" x")?;
    Some((row, effect, strength.parse().ok()?)).filter(|_| alone)
}

/// Effects together, by process, strength and whether their score was promised; then each effect of ordinary size.
pub fn power(rows: &[Row]) -> [Vec<Power>; 2] {
    // Strengths are above zero, so that their bits are in order; those of two signs count by their size.
    let mut together: BTreeMap<(&str, u64, bool), Vec<&Row>> = BTreeMap::new();
    let mut ordinary: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for (row, effect, strength) in rows.iter().filter_map(single) {
        let promised = row.promised_z.is_some_and(|score| score >= PROMISED);
        together.entry((&row.process, strength.abs().to_bits(), promised)).or_default().push(row);
        if strength.abs() == ORDINARY {
            ordinary.entry((&row.process, effect)).or_default().push(row);
        }
    }
    let counted = |process: &str, effect: &str, strength: f64, promised: Option<bool>, rows: &[&Row]| Power {
        process: process.to_owned(),
        effect: effect.to_owned(),
        strength,
        promised,
        shops: rows.len(),
        found: rows.iter().filter(|row| row.mark == Mark::Exact).count(),
    };
    let together = together.iter().map(|((process, strength, promised), rows)| {
        counted(process, "", f64::from_bits(*strength), Some(*promised), rows)
    });
    let ordinary = ordinary.iter().map(|((process, effect), rows)| counted(process, effect, ORDINARY, None, rows));
    [together.collect(), ordinary.collect()]
}

/// Both as Markdown.
pub(crate) fn tables(text: &mut String, rows: &[Row]) {
    let [together, ordinary] = power(rows);
    if together.is_empty() {
        return;
    }
    let share = |own: &Power| {
        let [low, high] = own.bounds().map(|bound| 100.0 * bound);
        format!("{} of {} | {low:.1} to {high:.1} %", own.found, own.shops)
    };
    let _ = writeln!(
        text,
        "\n## Single effects that were found\n\n| process | size over ordinary | promised score | exact | exact 95 % bounds |\n|---|---|---|---|---|"
    );
    for own in &together {
        let promised = if own.promised == Some(true) { "5 and more" } else { "less" };
        let _ = writeln!(text, "| {} | {} | {promised} | {} |", own.process, own.strength, share(own));
    }
    if ordinary.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\nOf ordinary size, one by one:\n\n| process | effect | exact | exact 95 % bounds |\n|---|---|---|---|"
    );
    for own in &ordinary {
        let _ = writeln!(text, "| {} | `{}` | {} |", own.process, own.effect, share(own));
    }
}

/// Both for programs, in one list: the second ones have an effect.
pub(crate) fn json(rows: &[Row]) -> Value {
    let one = |own: &Power| {
        json!({
            "process": own.process, "effect": own.effect, "strength": own.strength, "promised": own.promised,
            "shops": own.shops, "found": own.found, "ci95": own.bounds(),
        })
    };
    power(rows).iter().flatten().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(set: &str, hidden: &str, promised: &str, mark: &str) -> Row {
        let line = format!("whole,milling,{set},1,{hidden},,{promised},{mark},,,,,,,,,,,,,,,,,,1,0");
        let header = "method,process,set,seed,hidden,hidden_size,promised_z,mark,named,class,shape,size,size_low,size_high,\
                      unit,size_on_new_edges,probability,z,closed,closed_low,closed_high,closed_on_new_edges,\
                      closed_by_named,closed_by_hidden,notes,times,form";
        let text = format!("{header}\n{line}\n");
        csv::Reader::from_reader(text.as_bytes()).deserialize().next().expect("a line").expect("a row")
    }

    #[test]
    fn what_was_promised_counts_apart_from_what_was_not_and_every_effect_of_ordinary_size_by_itself() {
        let rows = [
            row("effect", "runout x2", "8.1", "exact"),
            row("effect", "wear_force x2", "4.9", "exact"),
            row("effect", "wear_acceleration x2", "1.9", "no_gap"),
            row("effect", "wear_force x1", "2.5", "exact"),
            row("effect", "wear_force x1", "2.6", "wrong"),
            row("pair", "runout x1 + wear_force x1", "2", "exact"),
            row("stress world", "runout x1", "7", "unknown"),
            row("null", "", "", "no_gap"),
        ];
        let [together, ordinary] = power(&rows);
        let counts = |list: &[Power]| list.iter().map(|own| (own.found, own.shops)).collect::<Vec<_>>();
        assert_eq!(counts(&together), [(1, 2), (1, 2), (1, 1)]);
        assert_eq!(together[2].promised, Some(true));
        assert_eq!(counts(&ordinary), [(1, 2)]);
        assert_eq!(ordinary[0].effect, "wear_force");
        let mut text = String::new();
        tables(&mut text, &rows);
        assert!(text.contains("| milling | 2 | 5 and more | 1 of 1 | 2.5 to 100.0 % |"), "{text}");
        assert!(text.contains("| milling | `wear_force` | 1 of 2 |"), "{text}");
    }
}
