//! Features of recorded rows: standardised conditions, levels, covariates.

use super::Covariate;
use std::collections::BTreeMap;
use toolroom_records::Records;

/// Spread below which a column counts as constant, relative.
const CONSTANT: f64 = 1e-6;

/// Values less their mean over their standard deviation; `None` where they do not vary. Missing
/// values count as the mean.
pub fn standardised(values: &[f64]) -> Option<Vec<f64>> {
    let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    let spread = (known.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / known.len() as f64).sqrt();
    let varies = known.len() > 1 && spread > CONSTANT * (1.0 + mean.abs());
    varies.then(|| values.iter().map(|value| if value.is_finite() { (value - mean) / spread } else { 0.0 }).collect())
}

/// Logarithms of a column, standardised.
pub fn logarithm(records: &Records, name: &str) -> Option<Vec<f64>> {
    let values = records.numbers(name)?;
    let logarithms: Vec<f64> = values.iter().map(|value| if *value > 0.0 { value.ln() } else { f64::NAN }).collect();
    standardised(&logarithms)
}

/// A polynomial of second degree in standardised logarithms: linear terms first, then squares and
/// products, each standardised. The flag says whether a term is linear.
pub fn surface(records: &Records, names: &[&str]) -> Vec<(String, Vec<f64>, bool)> {
    let linear: Vec<(String, Vec<f64>)> =
        names.iter().filter_map(|name| Some((format!("ln {name}"), logarithm(records, name)?))).collect();
    let mut terms: Vec<(String, Vec<f64>, bool)> =
        linear.iter().map(|(name, values)| (name.clone(), values.clone(), true)).collect();
    for (i, (name, a)) in linear.iter().enumerate() {
        for (other, b) in &linear[i..] {
            let product: Vec<f64> = a.iter().zip(b).map(|(a, b)| a * b).collect();
            if let Some(product) = standardised(&product) {
                terms.push((format!("{name} × {other}"), product, false));
            }
        }
    }
    terms
}

/// Columns whose levels may matter.
pub const LEVELS: [&str; 8] =
    ["machine", "lot", "material", "part_type", "operator", "shift", "coolant_id", "wheel_id"];

/// Indicators of the levels of the text columns, where there are at least two.
pub fn indicators(records: &Records, columns: &[&str]) -> Vec<(String, String, Vec<f64>)> {
    let mut indicators = Vec::new();
    for column in columns {
        let Some((names, of_row)) = records.levels(column) else { continue };
        if names.len() < 2 {
            continue;
        }
        for (level, name) in names.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            let values = of_row.iter().map(|of_row| f64::from(u8::from(*of_row == level))).collect();
            indicators.push(((*column).to_owned(), name.clone(), values));
        }
    }
    indicators
}

/// Time in cut of each edge before an operation ends, s, rows being in sequence within a group.
pub fn age(groups: &[usize], durations: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; groups.iter().max().map_or(0, |last| last + 1)];
    let mut ages = Vec::with_capacity(groups.len());
    for (group, duration) in groups.iter().zip(durations) {
        sums[*group] += if duration.is_finite() { *duration } else { 0.0 };
        ages.push(sums[*group]);
    }
    ages
}

/// Whether a row is the first of its group.
pub fn first_of_group(groups: &[usize]) -> Vec<f64> {
    let mut seen = vec![false; groups.iter().max().map_or(0, |last| last + 1)];
    groups.iter().map(|group| if std::mem::replace(&mut seen[*group], true) { 0.0 } else { 1.0 }).collect()
}

/// Seconds since the first operation, where start times are recorded.
pub fn elapsed(records: &Records) -> Option<Vec<f64>> {
    let times = records.numbers("start_time")?;
    let first = times.iter().copied().filter(|time| time.is_finite()).fold(f64::INFINITY, f64::min);
    let elapsed: Vec<f64> = times.iter().map(|time| if time.is_finite() { time - first } else { f64::NAN }).collect();
    standardised(&elapsed).map(|_| elapsed)
}

/// Levels beyond this number are not asked one by one (assumption): each takes its share of the
/// evidence that chance provides.
const MOST_LEVELS: usize = 12;

/// Covariates of the generic dictionary.
pub fn covariates(records: &Records, groups: &[usize], conditions: &[&str], wear: Option<&[f64]>) -> Vec<Covariate> {
    let mut covariates: Vec<Covariate> = Vec::new();
    let mut add = |name: String, values: Option<Vec<f64>>| {
        if let Some(values) = values {
            covariates.push(Covariate { name, values });
        }
    };
    for (name, values, _) in surface(records, conditions) {
        add(name, Some(values));
    }
    for name in ["cutting_time", "wait_time", "part_in_cycle", "revolutions"] {
        if !conditions.contains(&name) {
            add(format!("ln {name}"), logarithm(records, name));
        }
    }
    add("coolant_age".to_owned(), records.numbers("coolant_age").and_then(standardised));
    add("feed_override".to_owned(), records.numbers("feed_override").and_then(standardised));
    if let Some(elapsed) = elapsed(records) {
        let square = standardised(&elapsed).map(|z| z.iter().map(|z| z * z).collect::<Vec<f64>>());
        add("calendar".to_owned(), standardised(&elapsed));
        add("calendar²".to_owned(), square.as_deref().and_then(standardised));
        let day = |phase: fn(f64) -> f64| elapsed.iter().map(|t| phase(t / 86400.0 * std::f64::consts::TAU)).collect();
        let (sine, cosine): (Vec<f64>, Vec<f64>) = (day(f64::sin), day(f64::cos));
        add("time of day (sin)".to_owned(), standardised(&sine));
        add("time of day (cos)".to_owned(), standardised(&cosine));
    }
    if let Some(wear) = wear {
        let square: Vec<f64> = wear.iter().map(|wear| wear * wear).collect();
        add("flank_wear".to_owned(), standardised(wear));
        add("flank_wear²".to_owned(), standardised(&square));
    }
    if let Some(durations) = records.numbers("cutting_time") {
        let age = age(groups, durations);
        let early: Vec<f64> = age.iter().map(|age| (-age / 240.0).exp()).collect();
        add("age of the edge".to_owned(), standardised(&age));
        add("early life".to_owned(), standardised(&early));
    }
    add("first operation".to_owned(), standardised(&first_of_group(groups)));
    for column in LEVELS {
        let levels = indicators(records, &[column]);
        if levels.len() <= MOST_LEVELS {
            for (column, name, values) in levels {
                add(format!("{column}={name}"), standardised(&values));
            }
        }
    }
    covariates
}

/// Lots by the column `lot`; without it, pieces of a part in the order of time, as many to a lot as the scenario says.
pub(super) fn lots(records: &Records, sizes: &[(String, u32)]) -> Vec<usize> {
    if let Some((names, of_row)) = records.levels("lot")
        && names.len() > 1
    {
        return of_row;
    }
    let mut order: Vec<usize> = (0..records.len()).collect();
    if let Some(times) = records.numbers("start_time") {
        order.sort_by(|a, b| times[*a].total_cmp(&times[*b]));
    }
    let (names, of_row) = records.levels("part_type").unwrap_or_else(|| (Vec::new(), vec![0; records.len()]));
    let size = |part: usize| {
        let named = sizes.iter().find(|(name, _)| names.get(part) == Some(name)).or(sizes.first());
        named.map_or(1, |(_, size)| (*size).max(1) as usize)
    };
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    let mut numbers: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut lots = vec![0; records.len()];
    for row in order {
        let count = counts.entry(of_row[row]).or_default();
        let key = (of_row[row], *count / size(of_row[row]));
        *count += 1;
        let next = numbers.len();
        lots[row] = *numbers.entry(key).or_insert(next);
    }
    lots
}
