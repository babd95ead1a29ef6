//! Whether a printed probability is what it says, and whether blame grows with the amount of data.

use crate::method::WHOLE;
use crate::row::{Mark, Row};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_statistics::clopper_pearson;

/// Lower ends of the bins of printed probabilities. Source: the gate of the reliability diagram.
const BINS: [f64; 5] = [0.0, 0.5, 0.8, 0.95, 0.99];

/// Names whose printed probability lies in one bin.
#[derive(Clone, Debug, PartialEq)]
pub struct Bin {
    /// Lower end; the bin ends where the next one begins.
    pub from: f64,
    /// Names.
    pub names: usize,
    /// Names that are a hidden effect, or cannot be told from one.
    pub right: usize,
    /// Mean printed probability.
    pub printed: f64,
}

impl Bin {
    /// Exact 95 % bounds of the share that is right.
    pub fn bounds(&self) -> [f64; 2] {
        clopper_pearson(self.right, self.names, 0.95)
    }
}

/// Every name that the whole method gave: printed probability, and whether it is right.
fn names(rows: &[Row]) -> Vec<(f64, bool)> {
    let of_row = |row: &Row| {
        let hidden: Vec<&str> = row.hidden.split(" + ").filter_map(|cause| cause.split(' ').next()).collect();
        let right = |class: &str| class.split(' ').any(|id| hidden.contains(&id));
        let both = row.class.split(" + ").zip(row.probability.split(" + "));
        both.filter_map(|(class, printed)| Some((printed.parse().ok()?, right(class)))).collect::<Vec<(f64, bool)>>()
    };
    rows.iter().filter(|row| row.method == WHOLE).flat_map(of_row).collect()
}

/// Bins of printed probabilities that hold names.
pub fn reliability(rows: &[Row]) -> Vec<Bin> {
    let names = names(rows);
    let bin = |(i, from): (usize, &f64)| {
        let end = BINS.get(i + 1).copied().unwrap_or(f64::INFINITY);
        let inside: Vec<&(f64, bool)> = names.iter().filter(|(printed, _)| (*from..end).contains(printed)).collect();
        let count = inside.len();
        let printed = inside.iter().map(|(printed, _)| printed).sum::<f64>() / count as f64;
        Bin { from: *from, names: count, right: inside.iter().filter(|(_, right)| *right).count(), printed }
    };
    BINS.iter().enumerate().map(bin).filter(|bin| bin.names > 0).collect()
}

/// Expected calibration error: mean distance of printed probability and share that is right, weighted by names.
pub fn calibration_error(bins: &[Bin]) -> f64 {
    let all: usize = bins.iter().map(|bin| bin.names).sum();
    let off = |bin: &Bin| (bin.printed * bin.names as f64 - bin.right as f64).abs();
    bins.iter().map(off).sum::<f64>() / all as f64
}

/// Shops of one process that hide nothing, with so many times the usual groups and equations that are off by so much.
#[derive(Clone, Debug, PartialEq)]
pub struct Blamed {
    /// The process.
    pub process: String,
    /// Groups over their usual number.
    pub times: usize,
    /// How far the equations of the shops are off, as a share.
    pub form: f64,
    /// Shops.
    pub shops: usize,
    /// Shops that were given a name.
    pub blamed: usize,
    /// Shops that were answered `unknown`.
    pub unknown: usize,
    /// Greatest printed probability of a false name; zero where there is none.
    pub printed: f64,
}

impl Blamed {
    /// Exact 95 % bounds of the share that is blamed.
    pub fn bounds(&self) -> [f64; 2] {
        clopper_pearson(self.blamed, self.shops, 0.95)
    }
}

/// Shops that hide nothing, by process, amount of data and form error.
pub fn blamed(rows: &[Row]) -> Vec<Blamed> {
    let mut all: BTreeMap<(&str, usize, u64), Vec<&Row>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.method == WHOLE && row.hidden.is_empty()) {
        // Shares are not negative, so that their bits are in order.
        all.entry((&row.process, row.times, row.form.to_bits())).or_default().push(row);
    }
    let one = |((process, times, form), rows): ((&str, usize, u64), Vec<&Row>)| {
        let count = |mark: Mark| rows.iter().filter(|row| row.mark == mark).count();
        let printed =
            rows.iter().flat_map(|row| row.probability.split(" + ")).filter_map(|own| own.parse::<f64>().ok());
        Blamed {
            process: process.to_owned(),
            times,
            form: f64::from_bits(form),
            shops: rows.len(),
            blamed: count(Mark::Wrong),
            unknown: count(Mark::Unknown),
            printed: printed.fold(0.0, f64::max),
        }
    };
    all.into_iter().map(one).collect()
}

/// Both as Markdown.
pub(crate) fn tables(text: &mut String, rows: &[Row]) {
    let bins = reliability(rows);
    if !bins.is_empty() {
        let _ = writeln!(
            text,
            "\n## Printed probabilities\n\n| printed | names | mean printed | right | exact 95 % bounds |\n|---|---|---|---|---|"
        );
        for (i, bin) in bins.iter().enumerate() {
            let end = bins.get(i + 1).map_or(1.0, |next| next.from);
            let [low, high] = bin.bounds().map(|bound| 100.0 * bound);
            let share = 100.0 * bin.right as f64 / bin.names as f64;
            let _ = writeln!(
                text,
                "| {} to {end} | {} | {:.3} | {} ({share:.1} %) | {low:.1} to {high:.1} % |",
                bin.from, bin.names, bin.printed, bin.right
            );
        }
        let _ = writeln!(text, "\nExpected calibration error {:.3} (gate 0.05).", calibration_error(&bins));
    }
    let nulls = blamed(rows);
    if !nulls.is_empty() {
        let _ = writeln!(
            text,
            "\n## Shops that hide nothing, by amount of data\n\n| process | groups over usual | equations off by | shops | blamed | exact 95 % bounds | unknown | greatest printed probability |\n|---|---|---|---|---|---|---|---|"
        );
        for own in &nulls {
            let [low, high] = own.bounds().map(|bound| 100.0 * bound);
            let _ = writeln!(
                text,
                "| {} | {} | {:.0} % | {} | {} | {low:.1} to {high:.1} % | {} | {:.2} |",
                own.process,
                own.times,
                100.0 * own.form,
                own.shops,
                own.blamed,
                own.unknown,
                own.printed
            );
        }
    }
}

/// Both for programs.
pub(crate) fn json(rows: &[Row]) -> [Value; 2] {
    let bins = reliability(rows);
    let bin = |bin: &Bin| json!({ "from": bin.from, "names": bin.names, "right": bin.right, "printed": bin.printed, "ci95": bin.bounds() });
    let null = |own: &Blamed| {
        json!({
            "process": own.process, "times": own.times, "form": own.form, "shops": own.shops, "blamed": own.blamed,
            "ci95": own.bounds(), "unknown": own.unknown, "printed": own.printed,
        })
    };
    let error = calibration_error(&bins);
    let diagram = json!({
        "bins": bins.iter().map(bin).collect::<Vec<_>>(),
        "expected_calibration_error": if error.is_finite() { json!(error) } else { Value::Null },
    });
    [diagram, json!(blamed(rows).iter().map(null).collect::<Vec<_>>())]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(hidden: &str, class: &str, probability: &str) -> Row {
        let line = format!("whole,turning,effect,1,{hidden},,,{},,{class},,,,,,,{probability},,,,,,,,,1,0", {
            if class.is_empty() { "no_gap" } else { "wrong" }
        });
        let header = "method,process,set,seed,hidden,hidden_size,promised_z,mark,named,class,shape,size,size_low,size_high,\
                      unit,size_on_new_edges,probability,z,closed,closed_low,closed_high,closed_on_new_edges,\
                      closed_by_named,closed_by_hidden,notes,times,form";
        let text = format!("{header}\n{line}\n");
        csv::Reader::from_reader(text.as_bytes()).deserialize().next().expect("a line").expect("a row")
    }

    #[test]
    fn names_are_counted_in_the_bin_of_their_printed_probability_and_right_by_their_class() {
        let rows = [
            row("wear_force x1", "wear_force", "0.99"),
            row("wear_force x1 + run_in x2", "chipping run_in + lot_hardness", "0.93 + 0.85"),
            row("", "servo_lag", "0.4"),
            row("", "", ""),
        ];
        let bins = reliability(&rows);
        let counts: Vec<(f64, usize, usize)> = bins.iter().map(|bin| (bin.from, bin.names, bin.right)).collect();
        assert_eq!(counts, [(0.0, 1, 0), (0.8, 2, 1), (0.99, 1, 1)]);
        // |0.4 − 0| + |1.78 − 1| + |0.99 − 1| over four names.
        assert!((calibration_error(&bins) - (0.4 + 0.78 + 0.01) / 4.0).abs() < 1e-12);
        let nulls = blamed(&rows);
        assert_eq!((nulls.len(), nulls[0].shops, nulls[0].blamed, nulls[0].printed), (1, 2, 1, 0.4));
    }
}
