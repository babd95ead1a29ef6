//! Quantities of the context as records hold them.

use std::collections::BTreeMap;
use toolroom_effects::vocabulary;
use toolroom_gap::features;
use toolroom_process::unit;
use toolroom_records::Records;
use toolroom_statistics::median;

/// Ratio of the ends of a range below which a quantity counts as constant (1). Assumption: five per cent describe nothing.
const VARIES: f64 = 1.05;

/// A quantity of the context that varies, in its unit for people.
#[derive(Clone, Debug, PartialEq)]
pub struct VaryingQuantity {
    /// Its name in formulas.
    pub name: &'static str,
    /// Unit for people.
    pub unit: &'static str,
    /// Least value.
    pub least: f64,
    /// Median.
    pub middle: f64,
    /// Greatest value.
    pub greatest: f64,
}

/// Three significant digits, which is what a reader wants of the ends of a range.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

impl VaryingQuantity {
    /// The quantity called `name` with these values, SI; `None` where it does not vary.
    fn from_name(name: &str, values: &[f64]) -> Option<Self> {
        let field = vocabulary().find(|own| own.factor.is_none() && own.field.name == name)?.field;
        let shown = |value: &f64| unit::convert(*value, field.unit, field.display);
        let mut known: Vec<f64> =
            values.iter().filter(|value| value.is_finite() && **value >= 0.0).map(shown).collect();
        known.sort_by(f64::total_cmp);
        let (least, greatest) = (rounded(*known.first()?), rounded(*known.last()?));
        let middle = rounded(median(&mut known));
        let varies = middle > 0.0 && greatest > VARIES * least;
        varies.then_some(Self { name: field.name, unit: field.display, least, middle, greatest })
    }

    /// Least and greatest value over the median.
    pub fn ends(&self) -> [f64; 2] {
        [self.least / self.middle, self.greatest / self.middle]
    }

    /// The quantity, held at the ends of what was seen.
    pub fn held(&self) -> String {
        let Self { name, unit, least, greatest, .. } = self;
        // No quantity is negative.
        let above = if *least > 0.0 { format!("max({name}, {least} {unit})") } else { (*name).to_owned() };
        format!("min({above}, {greatest} {unit})")
    }

    /// The same over its median.
    pub fn ratio(&self) -> String {
        format!("({} / {} {})", self.held(), self.middle, self.unit)
    }

    /// The range in words.
    pub fn words(&self) -> String {
        format!("{} {} … {} {}", self.name, self.least, self.greatest, self.unit)
    }
}

/// Quantities of the context that vary in records of `process`.
pub fn seen(process: &str, records: &Records) -> Vec<VaryingQuantity> {
    let column = |name: &str| records.numbers(name).map(<[f64]>::to_vec);
    let feed = if process == "milling" { "feed_per_tooth" } else { "feed_per_rev" };
    let quantities = [
        ("cutting_speed", column("cutting_speed")),
        ("feed", column(feed)),
        ("depth_of_cut", column("depth_of_cut")),
        ("width_of_cut", column("width_of_cut").filter(|_| process == "milling")),
        ("flank_wear", column("flank_wear")),
        ("cutting_time", ages(records)),
        ("coolant_age", column("coolant_age").filter(|_| process == "turning")),
        // The sensor is as old as the records.
        ("sensor_time", features::elapsed(records)),
    ];
    quantities.iter().filter_map(|(name, values)| VaryingQuantity::from_name(name, values.as_ref()?)).collect()
}

/// Time in cut of the edge of each row before it ends, s.
fn ages(records: &Records) -> Option<Vec<f64>> {
    let (times, edges) = (records.numbers("cutting_time")?, records.texts("tool_id")?);
    let mut rows: Vec<usize> = (0..records.len()).collect();
    if let Some(order) = records.numbers("sequence") {
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
