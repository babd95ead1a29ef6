//! The report of a part program: its path coloured by load, loads over time, and where the time goes.

use super::course::{Course, Leg};
use super::{ProgramOnMachine, ProgramStudy};
use crate::feeds::Feeds;
use crate::plane::in_proportion;
use std::f64::consts::PI;
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_chart::{Axis, Colour, Dash, Plot, StackedBars, Style, Table};
use toolroom_drives::Part;
use toolroom_stock::{FeedLimit, FeedLimits, FeedPlan, FollowError, Load};

/// The report of a program named `name`. Its pictures show the planned feeds where there are some, else those of the program.
///
/// # Errors
/// [`FollowError`]: the program is refused, or cuts with a tool that the setup does not have.
pub fn report(name: &str, study: &ProgramStudy, provenance: Provenance) -> Result<Report, FollowError> {
    let as_programmed = FeedPlan::default();
    let plan = study.feeds.as_ref().map_or(&as_programmed, Feeds::plan);
    let ProgramOnMachine { source, control, drives, setup } = &study.of;
    let course = Course::new(source, control, drives, setup.as_ref(), plan)?;
    let title = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let mut report = Report::new(title).lead(lead(study, &course));
    for tile in tiles(study) {
        report = report.tile(tile);
    }
    let mut path = Section::new("Path");
    for warning in warnings(study) {
        path = path.warning(warning);
    }
    if course.joined {
        path = path.note("The program has more motions than a picture can show: neighbours are drawn as one, with the greatest load of them.");
    }
    let views = views(&course);
    path = match views.len() {
        1 => views.into_iter().fold(path, |path, (_, figure)| path.figure(figure)),
        _ => path.choice(views),
    };
    report = report.section(path);
    let mut over_time = Section::new("Over time");
    for figure in courses(study, &course) {
        over_time = over_time.figure(figure);
    }
    report = report.section(over_time);
    let mut section =
        Section::new("Where the time goes").figure(parts(&course)).table("Seconds by tool", seconds(&course));
    if let Some(feeds) = &study.feeds {
        section = section.table("Use of the limits: 1 is all that is allowed", feeds.limits_table());
    }
    let notes: Vec<String> = study.cycle.notes().iter().map(|(line, text)| format!("line {line}: {text}")).collect();
    if !notes.is_empty() {
        section = section.paragraph("What the reader noticed:").list(notes);
    }
    Ok(report.section(section).provenance(provenance))
}

fn lead(study: &ProgramStudy, course: &Course) -> String {
    let (dialect, reason) = study.cycle.dialect();
    let read = format!("Read as a program for {dialect}: {reason}.");
    let planned = study.feeds.as_ref().and_then(Feeds::planned_times).map(|(before, after)| {
        format!(" With planned feeds it takes {after:.1} s on this machine, as programmed {before:.1} s; the pictures show the plan.")
    });
    read + &planned.unwrap_or_else(|| format!(" It takes {:.1} s on this machine.", course.total))
}

fn tiles(study: &ProgramStudy) -> Vec<Tile> {
    let time = study.cycle.sum(|share| share.total);
    let changes: u32 = study.cycle.shares.iter().map(|share| share.changes).sum();
    let mut tiles = vec![match study.feeds.as_ref().and_then(Feeds::planned_times) {
        Some((before, after)) => {
            let gain = 100.0 * (after / before - 1.0);
            Tile::new("planned time", format!("{after:.1} s"), format!("{gain:+.1} % against {before:.1} s"))
        }
        None => Tile::new("cycle time", format!("{time:.1} s"), format!("{changes} tool changes")),
    }];
    if let Some(engagement) = &study.engagement {
        let (cutting, air) = engagement.times();
        let share = 100.0 * air / (cutting + air).max(f64::MIN_POSITIVE);
        tiles.push(Tile::new("in air at feed", format!("{air:.1} s"), format!("{share:.0} % of the time at feed")));
        let (angle, line) = engagement.bound();
        tiles.push(Tile::new("greatest engagement", format!("{:.1} deg", angle.to_degrees()), format!("line {line}")));
        let place = |line: usize| match study.feeds.as_ref().and_then(Feeds::planned_times) {
            Some(_) => format!("as programmed, line {line}"),
            None => format!("line {line}"),
        };
        if let Some((power, line)) = engagement.power() {
            tiles.push(Tile::new("greatest power", format!("{:.2} kW", power * 1e-3), place(line)));
        }
        if let Some((deflection, line)) = engagement.deflection().filter(|(deflection, _)| *deflection > 0.0) {
            tiles.push(Tile::new("greatest deflection", format!("{:.0} um", deflection * 1e6), place(line)));
        }
    }
    tiles
}

fn warnings(study: &ProgramStudy) -> Vec<String> {
    let mut list = Vec::new();
    if let Some(engagement) = &study.engagement {
        for (lines, what) in [
            (engagement.crashes(), "rapid motions meet material"),
            (engagement.holders(), "blocks in which the holder of the tool meets material"),
        ] {
            if let [first, ..] = lines {
                list.push(format!("{} {what}; the first in line {first}.", lines.len()));
            }
        }
    }
    for (limit, ratio, line) in study.feeds.as_ref().map(Feeds::broken).unwrap_or_default() {
        list.push(format!("{} is {ratio:.2} times what is allowed, in line {line}.", limit.word()));
    }
    list
}

/// What colours the path.
#[derive(Clone, Copy, PartialEq)]
enum Shown {
    Power,
    Angle,
    Feed,
}

impl Shown {
    fn of(course: &Course) -> Self {
        let legs = || course.legs.iter().filter(|leg| !leg.rapid);
        if legs().any(|leg| leg.load.is_some_and(|load| load.power > 0.0)) {
            Self::Power
        } else if legs().any(|leg| leg.angle > 0.0) {
            Self::Angle
        } else {
            Self::Feed
        }
    }

    fn value(self, leg: &Leg) -> f64 {
        match self {
            Self::Power => leg.load.map_or(0.0, |load| load.power * 1e-3),
            Self::Angle => leg.angle.to_degrees(),
            Self::Feed => commanded(leg),
        }
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Power => ("cutting power", "kW"),
            Self::Angle => ("engagement", "deg"),
            Self::Feed => ("feed", "mm/min"),
        }
    }
}

/// Commanded feed, mm/min; 0 for rapid motions.
fn commanded(leg: &Leg) -> f64 {
    if leg.rapid || leg.commanded <= 0.0 { 0.0 } else { 60.0 * leg.length / leg.commanded }
}

/// Colours from light to dark: what is heavier is darker, whatever the eye sees of hues.
const RAMP: [Colour; 4] = [Colour::Sky, Colour::Green, Colour::Vermillion, Colour::Ink];

/// The path seen along every axis in which it has an extent, in true proportion.
fn views(course: &Course) -> Vec<(String, Figure)> {
    let shown = Shown::of(course);
    let (word, unit) = shown.words();
    let peak = course.legs.iter().filter(|leg| !leg.rapid).map(|leg| shown.value(leg)).fold(0.0, f64::max);
    let class = |leg: &Leg| -> usize {
        let value = shown.value(leg);
        if leg.rapid {
            0
        } else if value <= 0.0 {
            1
        } else {
            2 + ((4.0 * value / peak).ceil() as usize).clamp(1, 4) - 1
        }
    };
    let styles: Vec<(String, Style)> = [
        ("rapid".to_owned(), Style::IDLE),
        ("at feed in air".to_owned(), Style::IDLE.dash(Dash::Dashed).colour(Colour::Blue)),
    ]
    .into_iter()
    .chain(RAMP.iter().enumerate().map(|(i, colour)| {
        let to = toolroom_chart::number(0.25 * (i + 1) as f64 * peak, 3);
        (format!("{word} to {to} {unit}"), Style::nth(i).colour(*colour).dash(Dash::Solid))
    }))
    .collect();
    let names = ["X", "Y", "Z"];
    let mut list = Vec::new();
    for (across, up, view) in [(0, 1, "from above"), (0, 2, "from the front"), (1, 2, "from the side")] {
        let extent = |axis: usize| {
            let places = course.legs.iter().filter(|leg| !leg.rapid).flat_map(|leg| [leg.from[axis], leg.to[axis]]);
            let finite = places.filter(|place| place.is_finite());
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
        };
        let ((left, right), (low, high)) = (extent(across), extent(up));
        if !(left <= right && low <= high) || (!list.is_empty() && high - low <= 0.0) {
            continue;
        }
        let axis = |i: usize| Axis::linear(names[i], "mm");
        let (x, y, height) = in_proportion((axis(across), left, right), (axis(up), low, high));
        let mut plot = Plot::new(format!("Path {view}, coloured by {word}"), x, y)
            .height(height)
            .describe(format!("The path of the tool {view}; what is darker has more {word}."));
        for (i, (label, style)) in styles.iter().enumerate() {
            let mut points: Vec<(f64, f64)> = Vec::new();
            for leg in course.legs.iter().filter(|leg| class(leg) == i) {
                let (from, to) = ((leg.from[across], leg.from[up]), (leg.to[across], leg.to[up]));
                if points.last() != Some(&from) {
                    points.extend([(f64::NAN, f64::NAN), from]);
                }
                points.push(to);
            }
            if points.iter().any(|(x, y)| x.is_finite() && y.is_finite()) {
                plot = plot.path(label.as_str(), points, *style);
            }
        }
        let caption = "Rapid motions go on beyond the picture, which ends a little outside the motions at feed.";
        list.push((view.to_owned(), Figure::new(&plot, caption)));
    }
    list
}

/// Feed, power, force, deflection and engagement over time.
fn courses(study: &ProgramStudy, course: &Course) -> Vec<Figure> {
    let planned = study.feeds.as_ref().and_then(Feeds::planned_times).is_some();
    let end = course.total;
    let over = |value: &dyn Fn(&Leg) -> f64| -> Vec<(f64, f64)> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        let mut at = 0.0;
        let mut push = |time: f64, value: f64| {
            if points.last().is_none_or(|last| last.1 != value) {
                points.push((time, value));
            }
        };
        for leg in &course.legs {
            // The tool stands between: tool changes, dwells, waiting.
            if leg.start > at + 1e-9 {
                push(at, 0.0);
            }
            push(leg.start, value(leg));
            at = leg.start + leg.time;
        }
        push(at, 0.0);
        points.push((end, 0.0));
        points
    };
    let plot = |title: &str, label: &str, unit: &str, describe: &str| {
        let time = Axis::linear("Time", "s").range(0.0, end.max(f64::MIN_POSITIVE));
        let plot = Plot::new(title, time, Axis::linear(label, unit).include(0.0)).height(200.0).describe(describe);
        if course.tools.len() > 1 { tools_strip(plot, course) } else { plot }
    };
    let machine = |leg: &Leg| if leg.rapid || leg.time <= 0.0 { 0.0 } else { 60.0 * leg.length / leg.time };
    let mut feed = plot("Feed", "Feed", "mm/min", "Feed over time, as commanded and on the machine.")
        .step(if planned { "planned" } else { "programmed" }, over(&commanded), Style::nth(0).dash(Dash::Solid))
        .step("mean of the block on the machine", over(&machine), Style::nth(1).dash(Dash::Dotted));
    if planned {
        feed = limits_strip(feed, course);
    }
    let mut figures = vec![Figure::new(&feed, "0 where the tool moves at rapid speed or stands.")];
    let loaded = course.legs.iter().any(|leg| leg.load.is_some());
    let allowed = |of: fn(&FeedLimits) -> Option<f64>| -> Option<f64> {
        // One line for all tools, or none.
        let mut limits = study.of.setup.as_ref()?.limits.values().map(of);
        let first = limits.next()??;
        limits.all(|limit| limit == Some(first)).then_some(first)
    };
    let limits = study.feeds.is_some();
    type Row = (&'static str, &'static str, f64, fn(&Load) -> f64, fn(&FeedLimits) -> Option<f64>);
    let rows: [Row; 3] = [
        ("Cutting power", "kW", 1e-3, |load| load.power, |limits| limits.power),
        ("Force across the path", "N", 1.0, |load| load.normal_force, |_| None),
        ("Deflection of the tip", "um", 1e6, |load| load.deflection, |limits| limits.deflection),
    ];
    for (title, unit, scale, value, limit) in rows.into_iter().filter(|_| loaded) {
        let at = |leg: &Leg| if leg.rapid { 0.0 } else { leg.load.as_ref().map_or(0.0, |load| scale * value(load)) };
        let mut picture = plot(title, title, unit, "At the bound of the engagement, averaged over a revolution.").step(
            title.to_lowercase(),
            over(&at),
            Style::nth(0).dash(Dash::Solid),
        );
        if let Some(limit) = allowed(limit).filter(|_| limits) {
            picture = picture.horizontal(scale * limit, "limit");
        }
        figures.push(Figure::new(&picture, "Mean over a revolution at the bound of the engagement between samples."));
    }
    if study.of.setup.is_some() {
        let at = |leg: &Leg| if leg.rapid { 0.0 } else { leg.angle.min(PI).to_degrees() };
        let picture = plot("Engagement", "Engagement angle", "deg", "Engaged angle of the rim over time.").step(
            "bound between samples",
            over(&at),
            Style::nth(0).dash(Dash::Solid),
        );
        figures.push(Figure::new(&picture, "Half of the rim is 180 degrees: a slot."));
    }
    figures
}

/// Runs of equal neighbours over time.
fn strip<T: PartialEq>(course: &Course, of: impl Fn(&Leg) -> Option<T>) -> Vec<(f64, f64, T)> {
    let mut runs: Vec<(f64, f64, T)> = Vec::new();
    for leg in &course.legs {
        let Some(value) = of(leg) else { continue };
        let end = leg.start + leg.time;
        match runs.last_mut() {
            Some(last) if last.2 == value && leg.start - last.1 < 1e-9 => last.1 = end,
            _ => runs.push((leg.start, end, value)),
        }
    }
    runs
}

fn tools_strip(plot: Plot, course: &Course) -> Plot {
    let mut numbers: Vec<Option<u32>> = course.tools.iter().map(|(tool, _)| *tool).collect();
    numbers.dedup();
    let kinds = numbers.iter().enumerate().map(|(i, number)| (tool_name(*number), Style::nth(i))).collect::<Vec<_>>();
    let runs = strip(course, |leg| numbers.iter().position(|number| *number == leg.tool));
    plot.strip("tool", kinds, runs)
}

fn limits_strip(plot: Plot, course: &Course) -> Plot {
    let binding = |limit: &FeedLimit| course.legs.iter().any(|leg| leg.limit == Some(*limit));
    let found: Vec<FeedLimit> = FeedLimit::ALL.into_iter().filter(binding).collect();
    let kind = |(i, limit): (usize, &FeedLimit)| (limit.word().replace('_', " "), Style::nth(i + course.tools.len()));
    let kinds: Vec<(String, Style)> = found.iter().enumerate().map(kind).collect();
    plot.strip("limit", kinds, strip(course, |leg| found.iter().position(|limit| leg.limit == Some(*limit))))
}

fn tool_name(number: Option<u32>) -> String {
    number.map_or_else(|| "no tool".to_owned(), |number| format!("T{number}"))
}

fn parts(course: &Course) -> Figure {
    let mut bars = StackedBars::new("Time by tool", Axis::linear("Time", "s"))
        .describe("Time of every tool, divided into feed, rapid motions, settling, dwells, changes and waiting.");
    for (i, part) in Part::ALL.iter().enumerate() {
        bars = bars.kind(part.word(), Style::nth(i));
    }
    for (tool, spent) in &course.tools {
        bars = bars.row(tool_name(*tool), *spent);
    }
    Figure::new(&bars, "Change is the tool changer, spindle the time that blocks wait for it.")
}

fn seconds(course: &Course) -> Table {
    let columns = ["tool"].into_iter().chain(Part::ALL.iter().map(|part| part.word())).chain(["all"]);
    let mut table = Table::new(columns);
    for (tool, spent) in &course.tools {
        let cells = spent.iter().map(|seconds| (*seconds).into());
        let all = spent.iter().sum::<f64>();
        table.push([tool_name(*tool).into()].into_iter().chain(cells).chain([all.into()]));
    }
    table
}
