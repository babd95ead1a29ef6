//! Pictures of a page.

use crate::minutes::Minutes;
use crate::readings::Readings;
use crate::sentence::words;
use crate::{DAY, WEEK};
use std::collections::{BTreeMap, BTreeSet};
use toolroom_chart::page::Figure;
use toolroom_chart::{Axis, ColourMap, HeatMap, Plot, Style, Waterfall};
use toolroom_gap::NINETY;

/// Points of one cloud.
const CLOUD: usize = 1500;
/// Steps of time of a residual's course.
const STEPS: usize = 60;
/// Scores of the map beyond this have the same colour.
const FARTHEST: f64 = 8.0;

/// Measured against predicted values of a channel, before and after, with the line of equality and the band that holds
/// 90 % of what is left.
pub fn equality(readings: &Readings, channel: usize) -> Option<Figure> {
    let about = &readings.channels[channel];
    let last = readings.stages.len();
    let all: Vec<_> = readings.of(channel).collect();
    let step = all.len().div_ceil(CLOUD).max(1);
    let cloud = |stage: usize| -> Vec<(f64, f64)> {
        let shown = |value: f64| about.shown(value);
        all.iter().step_by(step).map(|reading| (shown(reading.stages[stage]), shown(reading.measured))).collect()
    };
    let (before, after) = (cloud(0), cloud(last));
    let values = before.iter().chain(&after).flat_map(|(x, y)| [*x, *y]);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
    if all.len() < 2 || high <= low {
        return None;
    }
    let [mean, rms] = readings.residuals(channel, last);
    let half = NINETY * (rms * rms - mean * mean).max(0.0).sqrt();
    let band = |x: f64| {
        let wide = about.difference_shown(half);
        if about.relative { (x, x * (-half).exp(), x * half.exp()) } else { (x, x - wide, x + wide) }
    };
    let name = words(&about.name);
    let title = format!("{name}, measured against predicted");
    let plot = Plot::new(
        title,
        Axis::linear(format!("Predicted {name}"), about.label()),
        Axis::linear(format!("Measured {name}"), about.label()),
    )
    .describe("Points on the line of equality are predicted exactly.")
    .band("90 % of what is left", [band(low), band(high)], Style::nth(2))
    .line("equality", [(low, low), (high, high)], Style::IDLE)
    .scatter("model as its file stands", before, Style::nth(1))
    .scatter("with what was found", after, Style::nth(0));
    let caption =
        format!("{} values{}.", all.len(), if step > 1 { format!(", every {step}th drawn") } else { String::new() });
    Some(Figure::new(&plot, caption))
}

/// The course of the residuals of a channel over time, before and after.
pub fn course(readings: &Readings, channel: usize) -> Option<Figure> {
    let about = &readings.channels[channel];
    let last = readings.stages.len();
    let timed: Vec<_> = readings.of(channel).filter(|reading| reading.place.time.is_finite()).collect();
    let times = timed.iter().map(|reading| reading.place.time);
    let (from, to) = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), time| (a.min(time), b.max(time)));
    if timed.len() < 4 || to <= from {
        return None;
    }
    // A log of weeks by days, a short one by so many parts.
    let width =
        if to - from > 10.0 * DAY { DAY * ((to - from) / DAY / STEPS as f64).ceil() } else { (to - from) / 30.0 };
    let mean = |stage: usize| -> Vec<(f64, f64)> {
        let mut parts: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
        for reading in &timed {
            let part = parts.entry((reading.place.time / width).floor() as i64).or_default();
            *part = (part.0 + reading.residual(stage, about.relative), part.1 + 1.0);
        }
        let middle = |part: i64| (part as f64 + 0.5) * width / DAY;
        parts.iter().map(|(part, (sum, count))| (middle(*part), about.residual_shown(sum / count))).collect()
    };
    let name = words(&about.name);
    let plot = Plot::new(
        format!("{name}: measured less predicted"),
        Axis::linear("Time", "day"),
        Axis::linear("Residual", about.residual_unit()),
    )
    .describe("Mean residual over time; zero is where the model is right.")
    .horizontal(0.0, "no gap")
    .marked_line("model as its file stands", mean(0), Style::nth(1))
    .marked_line("with what was found", mean(last), Style::nth(0));
    Some(Figure::new(&plot, format!("Means over {} h.", (width / 3600.0 * 10.0).round() / 10.0)))
}

/// A cell of the map: channel, machine, week, mean score, values.
pub type MapCell = (String, String, i64, f64, usize);

/// Mean score of what the file's own model leaves, by channel, machine and week: in standard errors of as many values of
/// the channel as there are, whose scatter is that of what is left after all that was found.
pub fn map_cells(readings: &Readings) -> Vec<MapCell> {
    let mut cells: BTreeMap<(usize, &str, i64), (f64, usize)> = BTreeMap::new();
    for channel in 0..readings.channels.len() {
        for reading in readings.of(channel).filter(|reading| reading.place.time.is_finite()) {
            let week = (reading.place.time / WEEK).floor() as i64;
            let cell = cells.entry((channel, reading.place.machine.as_str(), week)).or_default();
            *cell = (cell.0 + reading.residual(0, readings.channels[channel].relative), cell.1 + 1);
        }
    }
    let score = |((channel, machine, week), (sum, count)): ((usize, &str, i64), (f64, usize))| {
        let [mean, rms] = readings.residuals(channel, readings.stages.len());
        let deviation = (rms * rms - mean * mean).max(0.0).sqrt();
        let score = sum / (count as f64).sqrt() / deviation;
        (readings.channels[channel].name.clone(), machine.to_owned(), week, score, count)
    };
    cells.into_iter().map(score).filter(|cell| cell.3.is_finite()).collect()
}

/// The map of [`map_cells`].
pub fn map(readings: &Readings) -> Option<Figure> {
    let cells = map_cells(readings);
    let rows: BTreeSet<(&str, &str)> = cells.iter().map(|cell| (cell.0.as_str(), cell.1.as_str())).collect();
    let rows: Vec<(&str, &str)> = rows.into_iter().rev().collect();
    let (first, last) = cells.iter().fold((i64::MAX, i64::MIN), |(a, b), cell| (a.min(cell.2), b.max(cell.2)));
    if rows.is_empty() {
        return None;
    }
    let weeks: Vec<i64> = (first..=last).collect();
    let mut values = vec![f64::NAN; rows.len() * weeks.len()];
    for (channel, machine, week, score, _) in &cells {
        let row = rows.iter().position(|row| *row == (channel.as_str(), machine.as_str()));
        if let Some(row) = row {
            values[row * weeks.len() + (week - first) as usize] = score.clamp(-FARTHEST, FARTHEST);
        }
    }
    let label = |(channel, machine): &(&str, &str)| format!("{} {machine}", words(channel)).trim_end().to_owned();
    let ticks: Vec<(f64, String)> = rows.iter().enumerate().map(|(i, row)| (i as f64, label(row))).collect();
    let columns: Vec<(f64, String)> = weeks.iter().map(|week| (*week as f64 + 1.0, format!("{}", week + 1))).collect();
    let axes = [
        Axis::linear("Week", "").ticks(columns.clone()),
        Axis::linear("Channel and machine", "").ticks(ticks),
        Axis::linear("Mean score", "").range(-FARTHEST, FARTHEST),
    ];
    let map = HeatMap::new(
        "Where and when the model is off",
        axes,
        columns.iter().map(|(week, _)| *week),
        (0..rows.len()).map(|row| row as f64),
        values,
    )
    .colours(ColourMap::Diverging)
    .missing("no data")
    .describe("Mean residual of the model as its file stands, in standard errors, by channel, machine and week.");
    Some(Figure::new(
        &map,
        "Blue: measured below the model; vermillion: above. Hatched: no data. Beyond ±8 the colour stays.",
    ))
}

/// The waterfall of minutes a week.
pub fn waterfall(minutes: &Minutes) -> Figure {
    let mut chart = Waterfall::new("Machine time a week", Axis::linear("Time", "min/week")).describe(
        "From the model as its file stands to the records: constants, then effects, then what nothing explains.",
    );
    let last = minutes.steps.len() - 1;
    for (index, step) in minutes.steps.iter().enumerate() {
        chart = if index == 0 || index == last {
            chart.total(step.label.clone(), step.minutes)
        } else {
            chart.change(step.label.clone(), step.minutes)
        };
    }
    Figure::new(&chart, "Recorded operations by their predictions; the steps add up to what was recorded.")
}
