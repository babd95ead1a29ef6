//! The files of a chart.

use super::picture::{picture, report};
use super::{ChartMap, ChartStudy, word};
use crate::tables::table;
use serde_json::{Value, json};
use toolroom_chart::page::Provenance;
use toolroom_chart::{Chart, ResultFiles, png};
use toolroom_chatter::{BoundaryCurve, Hole, Lobes};
use toolroom_form::Echo;
use toolroom_process::table::Cell;
use toolroom_shards::fingerprint;

/// Width of the PNG: sharp over a column of print.
const PIXELS: u32 = 1600;

/// The files of a chart.
pub const NAMES: &[&str] = &[
    "lobes.svg",
    "lobes.png",
    "lobes.csv",
    "lobes.json",
    "report.html",
    "margin.svg",
    "margin.png",
    "margin.csv",
    "p_stable.svg",
    "p_stable.png",
    "p_stable.csv",
    "sle.svg",
    "sle.png",
    "sle.csv",
    "ra.svg",
    "ra.png",
    "ra.csv",
    "force.svg",
    "force.png",
    "force.csv",
    "torque.svg",
    "torque.png",
    "torque.csv",
    "power.svg",
    "power.png",
    "power.csv",
    "mrr.svg",
    "mrr.png",
    "mrr.csv",
];

impl ChartStudy<'_> {
    /// `lobes.json` for programs, and `lobes.svg`, `lobes.png`, `lobes.csv`, `lobes.json`, `report.html`; `echo` is the
    /// file as it was understood.
    pub fn files(&self, echo: &[Echo], provenance: Provenance) -> (Value, ResultFiles) {
        let picture = picture(self);
        let verdicts = verdicts(self);
        let mut summary = summary(self);
        // Of every verdict and boundary: the same, however many threads or shards there were.
        summary["digest"] = json!(fingerprint(format!("{verdicts}{summary}").as_bytes()));
        let mut files = ResultFiles::default();
        files.push("lobes.svg", picture.svg());
        files.push("lobes.png", png(picture.as_ref(), PIXELS));
        files.push("lobes.csv", verdicts);
        files.push("lobes.json", format!("{summary:#}\n"));
        for map in &self.maps {
            let (word, picture) = (map.kind.word(), map.picture(self));
            files.push(format!("{word}.svg"), picture.svg());
            files.push(format!("{word}.png"), png(&picture, PIXELS));
            files.push(format!("{word}.csv"), values(self, map));
        }
        files.push("report.html", report(self, echo, provenance).html());
        (summary, files)
    }
}

/// The chart for programs: boundaries and operating points; the grid is in the table.
fn summary(study: &ChartStudy<'_>) -> Value {
    let file = study.file;
    let axes = file.cut.axes();
    let pairs = |points: &[(f64, f64)]| -> Vec<Value> {
        let pair = |(speed, depth): &(f64, f64)| {
            let depth = if depth.is_finite() { json!(axes.depth.shown(*depth)) } else { Value::Null };
            json!([axes.speed.shown(*speed), depth])
        };
        points.iter().map(pair).collect()
    };
    let piece = |piece: &BoundaryCurve| {
        let point = |[speed, depth, frequency]: &[f64; 3]| {
            json!([axes.speed.shown(*speed), axes.depth.shown(*depth), frequency])
        };
        let points: Vec<Value> = piece.points.iter().map(point).collect();
        json!({ "kind": word(piece.kind), "closed": piece.closed, "points": points })
    };
    let boundaries: Vec<Value> = study
        .curves
        .iter()
        .map(|curve| {
            json!({
                "label": curve.label,
                "columns": [axes.speed.column(), axes.depth.column()],
                "limit": pairs(&curve.limit),
                "further": pairs(&curve.further),
                "curves": curve.pieces.iter().map(piece).collect::<Vec<_>>(),
                "holes": curve.holes.iter().map(|(at, reason)| json!([axes.speed.shown(*at), reason])).collect::<Vec<_>>(),
            })
        })
        .collect();
    let points: Vec<Value> = file
        .points
        .iter()
        .zip(&study.judgements)
        .map(|(point, judged)| {
            let mut object = serde_json::Map::from_iter([("name".to_owned(), json!(point.name))]);
            match judged {
                Ok(judgement) => object.extend(judgement.json(&file.cut)),
                Err(error) => object.extend([
                    (axes.speed.column(), json!(axes.speed.shown(point.speed))),
                    (axes.depth.column(), json!(axes.depth.shown(point.depth))),
                    ("reason".to_owned(), json!(error.to_string())),
                ]),
            }
            Value::Object(object)
        })
        .collect();
    let hole = |hole: &Hole| {
        json!({
            (axes.speed.column()): axes.speed.shown(hole.speed),
            (axes.depth.column()): axes.depth.shown(hole.depth),
            "reason": hole.reason,
        })
    };
    let holes: Vec<Value> = study.grid.iter().flat_map(|grid| &grid.holes).map(hole).collect();
    let limits: Vec<Value> = study
        .limits
        .iter()
        .map(|(limited, depths)| {
            let line: Vec<(f64, f64)> = study.speeds.iter().copied().zip(depths.iter().copied()).collect();
            json!({ "limit": limited.word(), "depths": pairs(&line) })
        })
        .collect();
    let robust: Vec<Value> = study
        .robust
        .iter()
        .map(|robust| json!([axes.speed.shown(robust.spindle_speed), robust.probability.value]))
        .collect();
    let mut summary = json!({
        "schema": 1,
        "name": file.name,
        "process": file.cut.process().word(),
        "stable_share": study.grid.as_ref().map(Lobes::stable_share),
        "holes": holes.len(),
        "without_verdict": holes,
        "points": points,
        "boundaries": boundaries,
    });
    // What was not requested is not there.
    if let Some(measured) = &study.measured {
        let pairs = measured.limits.iter().map(|(speed, depth)| {
            let depth = if depth.is_finite() { json!(axes.depth.shown(*depth)) } else { Value::Null };
            json!([axes.speed.shown(*speed), depth])
        });
        summary["measured"] = json!({
            "limits": pairs.collect::<Vec<_>>(),
            "greatest_difference": measured.greatest.map(|(_, difference)| difference),
            "at": measured.greatest.map(|(speed, _)| axes.speed.shown(speed)),
            "median_difference": measured.median,
        });
    }
    if !limits.is_empty() {
        summary["limits"] = json!(limits);
    }
    if let Some(best) = &study.best {
        summary["best"] = best.json();
    }
    if !robust.is_empty() {
        summary["robust_speeds"] = json!({ "columns": [axes.speed.column(), "p_stable"], "speeds": robust });
    }
    summary
}

/// A map as a table.
fn values(study: &ChartStudy<'_>, map: &ChartMap) -> String {
    let axes = study.file.cut.axes();
    let mut rows: Vec<[Cell<'_>; 3]> = Vec::new();
    let mut values = map.values.iter();
    for speed in &map.speeds {
        for (depth, value) in map.depths.iter().zip(values.by_ref()) {
            let value = if value.is_finite() { (*value).into() } else { Cell::Empty };
            rows.push([axes.speed.shown(*speed).into(), axes.depth.shown(*depth).into(), value]);
        }
    }
    table([axes.speed.column(), axes.depth.column(), map.kind.column()], rows)
}

/// Every verdict of the grid, with the reason where there is none; the boundary where there is no grid.
fn verdicts(study: &ChartStudy<'_>) -> String {
    let file = study.file;
    let axes = file.cut.axes();
    let (speed, depth) = (axes.speed, axes.depth);
    let columns = [speed.column(), depth.column()];
    let [at, deep] = columns.each_ref().map(String::as_str);
    match &study.grid {
        Some(grid) => {
            let mut rows: Vec<[Cell<'_>; 7]> = Vec::new();
            // They come in the order of the points.
            let mut holes = grid.holes.iter();
            for (i, at) in grid.speed.iter().enumerate() {
                for (j, deep) in grid.depth.iter().enumerate() {
                    let [at, deep] = [speed.shown(*at).into(), depth.shown(*deep).into()];
                    let none = || [Cell::Empty, Cell::Empty, Cell::Empty, Cell::Empty];
                    let (verdict, hole) = match grid.at(i, j) {
                        Some(verdict) => {
                            let frequency = file.cut.chatter_frequency(verdict).into();
                            let radius = verdict.spectral_radius.into();
                            ([radius, verdict.stable.into(), word(verdict.kind).into(), frequency], Cell::Empty)
                        }
                        None => (none(), holes.next().map(|hole| hole.reason.as_str()).into()),
                    };
                    let [radius, stable, kind, frequency] = verdict;
                    rows.push([at, deep, radius, stable, kind, frequency, hole]);
                }
            }
            table([at, deep, "spectral_radius", "stable", "type", "chatter_frequency [Hz]", "hole"], rows)
        }
        None => {
            let mut rows: Vec<[Cell<'_>; 4]> = Vec::new();
            for curve in &study.curves {
                for (crossing, points) in [("first", &curve.limit), ("further", &curve.further)] {
                    for (at, deep) in points.iter().filter(|(_, deep)| deep.is_finite()) {
                        rows.push([
                            (&curve.label).into(),
                            crossing.into(),
                            speed.shown(*at).into(),
                            depth.shown(*deep).into(),
                        ]);
                    }
                }
            }
            table(["boundary", "crossing", at, deep], rows)
        }
    }
}
