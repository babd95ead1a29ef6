//! The files of a chart.

use super::Computed;
use super::picture::{picture, report};
use crate::failure::Failure;
use crate::output::{OutputDir, no_table, provenance};
use serde_json::{Value, json};
use std::time::Instant;
use toolroom_chart::png;
use toolroom_chatter::{Hole, Lobes};
use toolroom_form::FormFile;
use toolroom_planning::lobes::{LobesFile, word};
use toolroom_process::table::{Cell, csv_text};
use toolroom_shards::fingerprint;

/// Width of the PNG: sharp over a column of print.
const PIXELS: u32 = 1600;

/// Where a chart comes from.
pub struct Origin<'a> {
    /// Name of the lobes file.
    pub file: &'a str,
    /// Changes to it, `path=value`.
    pub changes: &'a [String],
    /// When the work began.
    pub start: Instant,
}

/// The files of a chart.
pub const NAMES: &[&str] = &["lobes.svg", "lobes.png", "lobes.csv", "lobes.json", "report.html"];

/// Writes `lobes.svg`, `lobes.png`, `lobes.csv`, `lobes.json`, `report.html` and, last, `run.json`; returns what
/// is in `lobes.json`.
pub fn write(
    out: &OutputDir,
    origin: &Origin<'_>,
    file: &FormFile<LobesFile>,
    computed: &Computed,
) -> Result<Value, Failure> {
    let inputs = [(origin.file.to_owned(), file.text.as_bytes())];
    let changes = origin.changes.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
    let provenance = provenance("lobes", &inputs, changes, None);
    let picture = picture(&file.content, computed);
    out.put("lobes.svg", &picture.svg())?;
    out.put_bytes("lobes.png", &png(picture.as_ref(), PIXELS))?;
    let table = table(&file.content, computed)?;
    out.put("lobes.csv", &table)?;
    let mut summary = summary(&file.content, computed);
    // Of every verdict and boundary: the same, however many threads or shards there were.
    summary["digest"] = json!(fingerprint(format!("{table}{summary}").as_bytes()));
    out.put_json("lobes.json", &summary)?;
    out.put("report.html", &report(&file.content, &file.echo, computed, provenance.clone()).html())?;
    out.record(&provenance, origin.start.elapsed())?;
    Ok(summary)
}

/// The chart for programs: boundaries and operating points; the grid is in the table.
fn summary(file: &LobesFile, computed: &Computed) -> Value {
    let axes = file.cut.axes();
    let pairs = |points: &[(f64, f64)]| -> Vec<Value> {
        let pair = |(speed, depth): &(f64, f64)| {
            let depth = if depth.is_finite() { json!(axes.depth.shown(*depth)) } else { Value::Null };
            json!([axes.speed.shown(*speed), depth])
        };
        points.iter().map(pair).collect()
    };
    let boundaries: Vec<Value> = computed
        .curves
        .iter()
        .map(|curve| {
            json!({
                "label": curve.label,
                "columns": [axes.speed.column(), axes.depth.column()],
                "limit": pairs(&curve.limit),
                "further": pairs(&curve.further),
                "holes": curve.holes.iter().map(|(at, reason)| json!([axes.speed.shown(*at), reason])).collect::<Vec<_>>(),
            })
        })
        .collect();
    let points: Vec<Value> = file
        .points
        .iter()
        .zip(&computed.judgements)
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
    let holes: Vec<Value> = computed.grid.iter().flat_map(|grid| &grid.holes).map(hole).collect();
    json!({
        "schema": 1,
        "name": file.name,
        "process": file.cut.process(),
        "stable_share": computed.grid.as_ref().map(Lobes::stable_share),
        "holes": holes.len(),
        "without_verdict": holes,
        "points": points,
        "boundaries": boundaries,
    })
}

/// Every verdict of the grid, with the reason where there is none; the boundary where there is no grid.
fn table(file: &LobesFile, computed: &Computed) -> Result<String, Failure> {
    let axes = file.cut.axes();
    let (speed, depth) = (axes.speed, axes.depth);
    let columns = [speed.column(), depth.column()];
    let [at, deep] = columns.each_ref().map(String::as_str);
    let text = match &computed.grid {
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
            csv_text([at, deep, "spectral_radius", "stable", "type", "chatter_frequency [Hz]", "hole"], rows)
        }
        None => {
            let mut rows: Vec<[Cell<'_>; 4]> = Vec::new();
            for curve in &computed.curves {
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
            csv_text(["boundary", "crossing", at, deep], rows)
        }
    };
    text.map_err(|error| no_table("lobes.csv", &error))
}
