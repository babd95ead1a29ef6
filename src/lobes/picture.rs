//! The chart as a picture and the report around it.

use super::Computed;
use super::cut::{Curve, Cut, Judgement, Quantity, word};
use super::file::LobesFile;
use toolroom_analysis::chart::{Axis, Chart, Colour, ColourMap, Dash, HeatMap, Marker, Plot, Style, Table};
use toolroom_analysis::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_sim::scenario::file::{Echo, significant};

/// Growth beyond which colours do not tell points apart; a factor of e a period is far from the
/// boundary (assumption).
const MOST: f64 = 1.0;
/// Margin below which a stable point is called close: the constants of a cut are rarely known
/// better (assumption).
const CLOSE: f64 = 0.1;

/// The chart: spectral radius as colour where it was computed, boundaries, operating points.
pub fn picture(file: &LobesFile, computed: &Computed) -> Box<dyn Chart> {
    let axes = file.cut.axes();
    let (speed, depth) = (axes.speed, axes.depth);
    let title = file.title.clone();
    let description =
        format!("{} over {}: stability boundary and operating points.", depth.label, speed.label.to_lowercase());
    let further = |curve: &Curve| scaled(&curve.further, speed, depth);
    let points = by_margin(&computed.judgements);
    let spot = |judgement: &&Judgement| (speed.shown(judgement.speed), depth.shown(judgement.depth));
    let small = Style::nth(0).colour(Colour::Ink).marker(Marker::Plus);
    if let Some(grid) = &computed.grid {
        let rows = grid.depth.len();
        let growth = |row: usize, column: usize| {
            grid.at(column, row).map_or(f64::NAN, |verdict| verdict.spectral_radius.ln().clamp(-MOST, MOST))
        };
        let values = (0..rows).flat_map(|row| (0..grid.speed.len()).map(move |column| growth(row, column)));
        let value = Axis::linear("Growth a period, ln(spectral radius)", "");
        let columns: Vec<f64> = grid.speed.iter().map(|value| speed.shown(*value)).collect();
        let depths: Vec<f64> = grid.depth.iter().map(|value| depth.shown(*value)).collect();
        let mut map = HeatMap::new(title, [axis(speed), axis(depth), value], columns, depths, values)
            .colours(ColourMap::Diverging)
            .describe(description);
        for (i, curve) in computed.curves.iter().enumerate() {
            for (label, line) in runs(curve, speed, depth) {
                map = map.line(label, line, line_style(i));
            }
            if !curve.further.is_empty() {
                map = map.scatter("islands and pockets", further(curve), small);
            }
        }
        for (label, style, group) in points {
            map = map.scatter(label, group.iter().map(spot), style);
        }
        return Box::new(map);
    }
    let chart = &file.chart;
    let range = |quantity: Quantity, axis_of: &toolroom_chatter::Axis| {
        axis(quantity).range(quantity.shown(axis_of.start), quantity.shown(axis_of.end))
    };
    let mut plot =
        Plot::new(title, range(speed, &chart.speed), range(depth, &chart.depth)).height(320.0).describe(description);
    for (i, curve) in computed.curves.iter().enumerate() {
        for (label, line) in runs(curve, speed, depth) {
            plot = plot.line(label, line, line_style(i));
        }
        if !curve.further.is_empty() {
            plot = plot.scatter("islands and pockets", further(curve), small);
        }
    }
    for (label, style, group) in points {
        plot = plot.scatter(label, group.iter().map(spot), style);
    }
    Box::new(plot)
}

fn axis(quantity: Quantity) -> Axis {
    Axis::linear(quantity.label, if quantity.unit == "1" { "" } else { quantity.unit })
}

fn line_style(i: usize) -> Style {
    const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDot];
    Style::nth(0).colour(Colour::Ink).dash(DASHES[i % DASHES.len()])
}

/// The stretches of a curve without a gap; the first carries the label. A single point is no line.
fn runs(curve: &Curve, x: Quantity, y: Quantity) -> Vec<(&str, Vec<(f64, f64)>)> {
    let stretches = curve.limit.split(|(_, depth)| !depth.is_finite()).filter(|stretch| stretch.len() > 1);
    let label = |i| if i == 0 { curve.label.as_str() } else { "" };
    stretches.enumerate().map(|(i, stretch)| (label(i), scaled(stretch, x, y))).collect()
}

fn scaled(points: &[(f64, f64)], x: Quantity, y: Quantity) -> Vec<(f64, f64)> {
    points.iter().map(|point| (x.shown(point.0), y.shown(point.1))).collect()
}

/// The operating points that there are of each class, with its colour and marker.
fn by_margin(judgements: &[Judgement]) -> Vec<(&'static str, Style, Vec<&Judgement>)> {
    let style = |colour, marker| Style::nth(0).colour(colour).marker(marker);
    let class = |judgement: &Judgement| match (judgement.verdict.stable, judgement.margin()) {
        (false, _) => 2,
        (true, Some(margin)) if margin < CLOSE => 1,
        (true, _) => 0,
    };
    let classes = [
        ("stable", style(Colour::Green, Marker::Circle)),
        ("stable, margin below 10 %", style(Colour::Orange, Marker::Triangle)),
        ("unstable", style(Colour::Purple, Marker::Square)),
    ];
    let groups = classes.into_iter().enumerate().map(|(i, (label, style))| {
        (label, style, judgements.iter().filter(|judgement| class(judgement) == i).collect::<Vec<_>>())
    });
    groups.filter(|(.., group)| !group.is_empty()).collect()
}

/// The report of a chart.
pub fn report(file: &LobesFile, echo: &[Echo], computed: &Computed, provenance: Provenance) -> Report {
    let axes = file.cut.axes();
    let chart = picture(file, computed);
    let mut report = Report::new(file.title.as_str()).lead(lead(&computed.judgements));
    if let Some(grid) = &computed.grid {
        let share = format!("{:.1} %", 100.0 * grid.stable_share());
        let size = format!("{} × {} points", grid.speed.len(), grid.depth.len());
        report = report.tile(Tile::new("stable", share, size));
    }
    let finite = |curve: &Curve| {
        curve.limit.iter().copied().filter(|(_, depth)| depth.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
    };
    for curve in &computed.curves {
        let Some((speed, depth)) = finite(curve) else { continue };
        let shown = |quantity: Quantity, value| {
            let number = significant((quantity.shown(value) * 1e4).round() / 1e4);
            if quantity.unit == "1" { number } else { format!("{number} {}", quantity.unit) }
        };
        let note = format!("at {} {}", axes.speed.label.to_lowercase(), shown(axes.speed, speed));
        report = report.tile(Tile::new(format!("least {}", curve.label), shown(axes.depth, depth), note));
    }
    let mut section = Section::new("Stability chart");
    if computed.grid.is_some() {
        section = section.paragraph(format!(
            "Colour is the growth of a disturbance over {}: below zero (blue) it dies out, above zero (red) it grows \
             until something else limits it. Beyond ±{MOST} the colour does not change.",
            period(&file.cut)
        ));
    }
    let caption = "Below the line every cut is stable; marks beyond it are where a cut becomes stable again.";
    section = section.figure(Figure::new(chart.as_ref(), caption).data_in("lobes.csv"));
    report = report.section(section);
    if !computed.judgements.is_empty() {
        report = report.section(points_section(file, &computed.judgements));
    }
    let mut inputs = Table::new(["section", "key", "value"]);
    for value in echo {
        let mark = if value.default { " (default)" } else { "" };
        inputs.push([
            value.section.as_str().into(),
            value.key.as_str().into(),
            format!("{}{mark}", value.value).into(),
        ]);
    }
    report.section(Section::new("Inputs").table("Every value as it was understood", inputs)).provenance(provenance)
}

/// Time over which the spectral radius counts.
fn period(cut: &Cut) -> &'static str {
    match cut {
        Cut::Milling(cut) if cut.cutter.runout == 0.0 && cut.cutter.pitch.is_empty() => "a tooth period",
        Cut::Milling(_) | Cut::Turning(_) => "a revolution",
        Cut::Chuck(_) => "a period of the modulation, a third of a revolution",
    }
}

fn lead(judgements: &[Judgement]) -> String {
    let unstable = judgements.iter().filter(|judgement| !judgement.verdict.stable).count();
    match (judgements.len(), unstable) {
        (0, _) => "No operating point is given.".to_owned(),
        (all, 0) => format!("All {all} operating points are stable."),
        (all, unstable) => format!("{unstable} of {all} operating points are unstable."),
    }
}

fn points_section(file: &LobesFile, judgements: &[Judgement]) -> Section {
    let axes = file.cut.axes();
    let unit = |quantity: Quantity| axis(quantity).caption();
    let mut table = Table::new([
        "point".to_owned(),
        unit(axes.speed),
        unit(axes.depth),
        "verdict".to_owned(),
        "spectral radius".to_owned(),
        if axes.depth.unit == "1" { "limit".to_owned() } else { format!("limit [{}]", axes.depth.unit) },
        "margin [%]".to_owned(),
        "chatter frequency [Hz]".to_owned(),
    ]);
    for (point, judgement) in file.points.iter().zip(judgements) {
        let verdict = &judgement.verdict;
        table.push([
            point.name.as_str().into(),
            axes.speed.shown(point.speed).into(),
            axes.depth.shown(point.depth).into(),
            word(verdict.kind).into(),
            verdict.spectral_radius.into(),
            judgement.limit.map_or(f64::NAN, |limit| axes.depth.shown(limit)).into(),
            judgement.margin().map_or(f64::NAN, |margin| 100.0 * margin).into(),
            file.cut.chatter_frequency(verdict).into(),
        ]);
    }
    Section::new("Operating points")
        .table("Verdicts; margin is 1 − depth/limit, – where no limit was found", table)
        .note("Force is linear in the chip and the constants are taken as exact: a margin below 10 % is uncertain.")
}
