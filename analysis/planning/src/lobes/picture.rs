//! The chart as a picture and the report around it.

use super::best::BEST_NOTE;
use super::cut::with_unit;
use super::load::Limited;
use super::robust::robust_table;
use super::{ChartStudy, Curve, Judged, LobesFile, Quantity, word};
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_chart::{
    Axis, Chart, Colour, ColourMap, Dash, HeatMap, Plot, PointStability, StabilityLobes, Style, Table,
};
use toolroom_form::Echo;

/// Growth beyond which colours do not tell points apart; a factor of e a period is far from the
/// boundary (assumption).
const MOST: f64 = 1.0;

/// The chart: spectral radius as colour where it was computed, boundaries, operating points.
pub fn picture(study: &ChartStudy<'_>) -> Box<dyn Chart> {
    let file = study.file;
    let axes = file.cut.axes();
    let (speed, depth) = (axes.speed, axes.depth);
    let title = file.title.clone();
    let description =
        format!("{} over {}: stability boundary and operating points.", depth.label, speed.label.to_lowercase());
    let lobes = lobes(study);
    let lines = limit_lines(study);
    // Without a single verdict there is nothing to colour.
    if let Some(grid) = study.grid.as_ref().filter(|grid| grid.verdicts.iter().any(Option::is_some)) {
        let rows = grid.depth.len();
        let growth = |row: usize, column: usize| {
            grid.at(column, row).map_or(f64::NAN, |verdict| verdict.spectral_radius.ln().clamp(-MOST, MOST))
        };
        let values = (0..rows).flat_map(|row| (0..grid.speed.len()).map(move |column| growth(row, column)));
        let value = Axis::linear("Growth a period, ln(spectral radius)", "");
        let columns: Vec<f64> = grid.speed.iter().map(|value| speed.shown(*value)).collect();
        let depths: Vec<f64> = grid.depth.iter().map(|value| depth.shown(*value)).collect();
        let map = HeatMap::new(title, [axis(speed), axis(depth), value], columns, depths, values);
        let map = map.colours(ColourMap::Diverging).missing("no verdict").describe(description).lobes(&lobes);
        return Box::new(lines.into_iter().fold(map, |map, (label, points, style)| map.line(label, points, style)));
    }
    let chart = &file.chart;
    let range = |quantity: Quantity, axis_of: &toolroom_chatter::Axis| {
        axis(quantity).range(quantity.shown(axis_of.start), quantity.shown(axis_of.end))
    };
    let plot = Plot::new(title, range(speed, &chart.speed), range(depth, &chart.depth)).height(320.0);
    let plot = plot.describe(description).lobes(&lobes);
    Box::new(lines.into_iter().fold(plot, |plot, (label, points, style)| plot.line(label, points, style)))
}

/// Stretches of a line of two points and more between the points that are no numbers.
pub(super) fn stretches(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let points: Vec<(f64, f64)> = points.into_iter().collect();
    let whole = points.split(|(_, depth)| !depth.is_finite()).filter(|stretch| stretch.len() > 1);
    whole.map(<[_]>::to_vec).collect()
}

pub(super) fn axis(quantity: Quantity) -> Axis {
    Axis::linear(quantity.label, if quantity.unit == "1" { "" } else { quantity.unit })
}

/// Boundaries, operating points and the best point of a study.
pub(super) fn lobes(study: &ChartStudy<'_>) -> StabilityLobes {
    let (curves, judgements) = (&study.curves, &study.judgements);
    let axes = study.file.cut.axes();
    let (x, y) = (axes.speed, axes.depth);
    let shown = |point: &(f64, f64)| (x.shown(point.0), y.shown(point.1));
    let mut lobes = StabilityLobes::default();
    for curve in curves {
        lobes = if curve.pieces.is_empty() {
            let limit = lobes.boundary(curve.label.as_str(), curve.limit.iter().map(shown));
            limit.places("islands and pockets", curve.further.iter().map(shown))
        } else {
            // One line with a gap between the curves.
            let points = curve.pieces.iter().flat_map(|piece| {
                let points = piece.points.iter().map(|[speed, depth, _]| (*speed, *depth));
                points.chain([(f64::NAN, f64::NAN)])
            });
            lobes.boundary(curve.label.as_str(), points.map(|point| shown(&point)))
        };
    }
    if let Some(measured) = &study.measured {
        lobes = lobes.boundary("limit of the measured response", measured.limits.iter().map(shown));
    }
    for judgement in judgements.iter().flatten() {
        let standing = PointStability::from_stable(judgement.verdict.stable, judgement.margin());
        lobes = lobes.point("", shown(&(judgement.speed, judgement.depth)), standing);
    }
    if let Some(best) = &study.best {
        // It is stable with the probability that was requested.
        lobes = lobes.point("best", shown(&(best.speed, best.depth)), PointStability::Stable);
    }
    lobes
}

/// The report of a chart.
pub(super) fn report(study: &ChartStudy<'_>, echo: &[Echo], provenance: Provenance) -> Report {
    let file = study.file;
    let axes = file.cut.axes();
    let chart = picture(study);
    let mut report = Report::new(file.title.as_str()).lead(lead(&study.judgements));
    if let Some(grid) = &study.grid {
        if grid.holes.len() < grid.verdicts.len() {
            let share = format!("{:.1} %", 100.0 * grid.stable_share());
            let size = format!("{} × {} points", grid.speed.len(), grid.depth.len());
            report = report.tile(Tile::new("stable", share, size));
        }
        if !grid.holes.is_empty() {
            let of = format!("of {} points, hatched", grid.verdicts.len());
            report = report.tile(Tile::new("no verdict", grid.holes.len().to_string(), of));
        }
    }
    let finite = |curve: &Curve| {
        curve.limit.iter().copied().filter(|(_, depth)| depth.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))
    };
    for curve in &study.curves {
        let Some((speed, depth)) = finite(curve) else { continue };
        let note = format!("at {} {}", axes.speed.label.to_lowercase(), with_unit(&axes.speed, speed));
        report = report.tile(Tile::new(format!("least {}", curve.label), with_unit(&axes.depth, depth), note));
    }
    let mut section = Section::new("Stability chart");
    if study.grid.is_some() {
        section = section.paragraph(format!(
            "Colour is the growth of a disturbance over {}: below zero (blue) it dies out, above zero (red) it grows \
             until something else limits it. Beyond ±{MOST} the colour does not change.",
            file.cut.period()
        ));
    }
    let caption = "The line is the boundary: from depth zero up to it every cut is stable; inside an island that it encloses a cut is \
             unstable, above it stable again.";
    section = section.figure(Figure::new(chart.as_ref(), caption).data_in("lobes.csv"));
    for lack in study.holes() {
        section = section.paragraph(format!("Missing: {lack}."));
    }
    if let Some(words) = study.beside_measured() {
        section = section.paragraph(format!("Measured response: {words}."));
    }
    report = report.section(section);
    if let Some(best) = &study.best {
        report = report.section(Section::new("Best point").paragraph(best.text(file)).note(BEST_NOTE));
    }
    if !study.robust.is_empty() {
        let section = Section::new("Robust speeds").table("The most probable speeds first", robust_table(study));
        report = report.section(section);
    }
    if !study.maps.is_empty() {
        let mut maps = Section::new("Maps").paragraph(
            "Each over the same speeds and depths as the chart, with the stability limit and the limits of the file.",
        );
        for map in &study.maps {
            let chart = map.picture(study);
            maps = maps.figure(Figure::new(&chart, "").data_in(format!("{}.csv", map.kind.word())));
        }
        report = report.section(maps);
    }
    if !study.judgements.is_empty() {
        report = report.section(points_section(file, &study.judgements));
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

fn lead(judgements: &[Judged]) -> String {
    let all = judgements.len();
    let unstable = judgements.iter().flatten().filter(|judgement| !judgement.verdict.stable).count();
    let failed = judgements.iter().filter(|judged| judged.is_err()).count();
    let summary = match unstable {
        _ if all == 0 => "No operating point is given.".to_owned(),
        0 if failed == 0 => format!("All {all} operating points are stable."),
        unstable => format!("{unstable} of {all} operating points are unstable."),
    };
    if failed == 0 { summary } else { format!("{summary} For {failed} of them no verdict was found.") }
}

fn points_section(file: &LobesFile, judgements: &[Judged]) -> Section {
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
    for (point, judged) in file.points.iter().zip(judgements) {
        let Ok(judgement) = judged else {
            let none = || f64::NAN.into();
            table.push([
                point.name.as_str().into(),
                axes.speed.shown(point.speed).into(),
                axes.depth.shown(point.depth).into(),
                "no verdict".into(),
                none(),
                none(),
                none(),
                none(),
            ]);
            continue;
        };
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

/// A stretch of a line: label, points in shown units and style.
pub(super) type Stretch = (String, Vec<(f64, f64)>, Style);

/// The limits of the file over the chart.
pub(super) fn limit_lines(study: &ChartStudy<'_>) -> Vec<Stretch> {
    let file = study.file;
    let axes = file.cut.axes();
    let greatest = file.chart.depth.end;
    let mut lines = Vec::new();
    for (limited, depths) in &study.limits {
        let (colour, dash) = match limited {
            Limited::Power => (Colour::Vermillion, Dash::Dashed),
            Limited::Torque => (Colour::Green, Dash::Dashed),
            Limited::Force => (Colour::Purple, Dash::DashDot),
            Limited::Tolerance => (Colour::Orange, Dash::Solid),
        };
        let points = study.speeds.iter().zip(depths).map(|(speed, depth)| {
            let depth = if *depth <= greatest { axes.depth.shown(*depth) } else { f64::NAN };
            (axes.speed.shown(*speed), depth)
        });
        let mut label = limited.of(&file.limits).map_or_else(String::new, |limit| limited.label(limit));
        for stretch in stretches(points) {
            lines.push((std::mem::take(&mut label), stretch, Style::nth(0).colour(colour).dash(dash)));
        }
    }
    lines
}
