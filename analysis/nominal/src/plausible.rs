//! Channels whose numbers no cut gives, for models that have no nominal value to compare with.

use super::ChannelId;
use super::constants::{ODD, ODD_NEAR, POWER, SPECIFIC_FORCE, SPECIFIC_PRESS};
use toolroom_records::{ColumnKind, RecordColumn, Records};
use toolroom_statistics::median;

/// Ratios that slips leave: prefixes, inches, minutes, kilogram-force.
const SLIPS: [(f64, &str); 5] = [
    (1000.0, "a prefix"),
    (60.0, "minutes for seconds"),
    (25.4, "inch for mm"),
    (9.81, "kgf for N"),
    (4.448, "lbf for N"),
];

/// Columns that cannot be what they say, with what to say about them.
pub fn suspicious(records: &Records) -> Vec<(ChannelId, String)> {
    let mut list = Vec::new();
    let area = product(records, &["feed_per_rev", "depth_of_cut"])
        .or_else(|| product(records, &["feed_per_tooth", "depth_of_cut"]));
    if let Some(area) = area {
        for (channel, range) in [
            (ChannelId::CuttingForce, SPECIFIC_FORCE),
            (ChannelId::FeedForce, SPECIFIC_PRESS),
            (ChannelId::PassiveForce, SPECIFIC_PRESS),
        ] {
            let Some(ratio) = ratio(records, channel, &area) else { continue };
            if outside(ratio, range) {
                let value = ratio * 1e-6;
                let note = format!("{channel} over the chip cross-section is {value:.3} MPa, which no material has");
                list.push((channel, with_slip(note, ratio, range)));
            }
        }
    }
    if let Some(work) = product(records, &["cutting_force", "cutting_speed"])
        && let Some(ratio) = ratio(records, ChannelId::SpindlePower, &work)
        && outside(ratio, POWER)
        && list.is_empty()
    {
        let note = format!("spindle_power is {ratio:.3} times cutting force × speed");
        list.push((ChannelId::SpindlePower, with_slip(note, ratio, POWER)));
    }
    let columns = records.kind.columns().iter().filter(|column| column.kind == ColumnKind::Channel);
    for (column, id) in columns.filter_map(|column| Some((column, ChannelId::from_record_column(column)?))) {
        if list.iter().all(|(channel, _)| *channel != id)
            && let Some(note) = beyond(records, column).or_else(|| odd_groups(records, column.name))
        {
            list.push((id, note));
        }
    }
    list
}

fn product(records: &Records, names: &[&str]) -> Option<Vec<f64>> {
    let mut product = vec![1.0; records.len()];
    for name in names {
        let values = records.numbers(name)?;
        product.iter_mut().zip(values).for_each(|(product, value)| *product *= value);
    }
    Some(product)
}

/// Median of a channel over `by`.
fn ratio(records: &Records, channel: ChannelId, by: &[f64]) -> Option<f64> {
    let values = records.numbers(channel.word())?;
    let ratios = values.iter().zip(by).map(|(value, by)| value / by).filter(|ratio| ratio.is_finite() && *ratio > 0.0);
    let mut ratios: Vec<f64> = ratios.collect();
    (!ratios.is_empty()).then(|| median(&mut ratios))
}

fn outside(ratio: f64, [least, greatest]: [f64; 2]) -> bool {
    ratio < least || ratio > greatest
}

/// The note with the slip that brings the ratio back into its range; the first that does.
fn with_slip(note: String, ratio: f64, range: [f64; 2]) -> String {
    let slip = SLIPS.iter().find(|(factor, _)| {
        let mended = if ratio > range[1] { ratio / factor } else { ratio * factor };
        !outside(mended, range)
    });
    let likely = slip.map_or_else(String::new, |(factor, what)| {
        format!("; is it {what} ({}{factor})?", if ratio > range[1] { "×" } else { "÷" })
    });
    format!("{note}: left out, check its unit and those of the conditions{likely}")
}

/// A channel of which most values are greater than any in practice.
fn beyond(records: &Records, column: &RecordColumn) -> Option<String> {
    let values = records.numbers(column.name)?.iter().copied().filter(|value| value.is_finite());
    let middle = median(&mut values.collect::<Vec<f64>>()) / column.scale();
    let (name, display) = (column.name, column.display);
    (middle.abs() > column.greatest).then(|| {
        format!("{name} is {middle:.4} {display} in the middle, beyond any in practice: left out, check its unit")
    })
}

/// Groups of a channel that lie by a slip of units off all others.
fn odd_groups(records: &Records, channel: &str) -> Option<String> {
    let values = records.numbers(channel)?;
    let (names, of_row) = records.levels("tool_id")?;
    let mut medians: Vec<(f64, &str)> = Vec::new();
    for (group, name) in names.iter().enumerate() {
        let own = values.iter().zip(&of_row).filter(|(value, of_row)| **of_row == group && **value > 0.0);
        let mut own: Vec<f64> = own.map(|(value, _)| *value).collect();
        if !own.is_empty() {
            medians.push((median(&mut own), name));
        }
    }
    let middle = median(&mut medians.iter().map(|(value, _)| *value).collect::<Vec<f64>>());
    let odd: Vec<&str> = medians
        .iter()
        .filter(|(value, _)| {
            let ratio = if *value > middle { value / middle } else { middle / value };
            ratio > ODD && SLIPS.iter().any(|(factor, _)| (ratio / factor).ln().abs() < ODD_NEAR)
        })
        .map(|(_, name)| *name)
        .collect();
    (!odd.is_empty() && 2 * odd.len() < medians.len()).then(|| {
        format!("{channel} of {} differs from all other groups as by a unit: left out, check its unit", odd.join(", "))
    })
}
