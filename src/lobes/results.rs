//! The files of a chart.

use super::Computed;
use super::cut::word;
use super::file::LobesFile;
use super::picture::{picture, report};
use crate::args::LobesArgs;
use crate::failure::Failure;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;
use toolroom_analysis::page::Provenance;
use toolroom_analysis::results::fingerprint;
use toolroom_sim::scenario::file::FormFile;

/// Writes `lobes.svg`, `lobes.csv`, `lobes.json`, `report.html` and, last, `run.json`.
pub fn write(
    directory: &Path,
    args: &LobesArgs,
    file: &FormFile<LobesFile>,
    computed: &Computed,
    wall: Duration,
) -> Result<(), Failure> {
    let put = |name: &str, text: &str| {
        let path = directory.join(name);
        std::fs::write(&path, text).map_err(|source| Failure::Unwritable { path, source })
    };
    let pretty = |value: &Value| serde_json::to_string_pretty(value).map(|text| text + "\n").map_err(Failure::Json);
    let input = args.file.display().to_string();
    let mut command = format!("toolroom lobes {input}");
    for change in &args.set {
        let _ = write!(command, " --set {change:?}");
    }
    let hash = fingerprint(file.text.as_bytes());
    let version = env!("CARGO_PKG_VERSION");
    let inputs = vec![(input.clone(), hash.clone())];
    let provenance = Provenance { version: version.to_owned(), command: command.clone(), seed: None, inputs };
    put("lobes.svg", &picture(&file.content, computed).svg())?;
    put("lobes.csv", &table(&file.content, computed))?;
    put("lobes.json", &pretty(&summary(&file.content, computed))?)?;
    put("report.html", &report(&file.content, &file.echo, computed, provenance).html())?;
    let run = json!({
        "schema": 1,
        "version": version,
        "command": command,
        "inputs": [{ "name": input, "hash": hash }],
        "complete": true,
        "wall_time [s]": wall.as_secs_f64(),
    });
    put("run.json", &pretty(&run)?)
}

/// The chart for programs: boundaries and operating points; the grid is in the table.
pub fn summary(file: &LobesFile, computed: &Computed) -> Value {
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
            })
        })
        .collect();
    let points: Vec<Value> = file
        .points
        .iter()
        .zip(&computed.judgements)
        .map(|(point, judgement)| {
            let mut object = serde_json::Map::from_iter([("name".to_owned(), json!(point.name))]);
            object.extend(file.cut.json(judgement));
            Value::Object(object)
        })
        .collect();
    json!({
        "schema": 1,
        "name": file.name,
        "process": file.cut.process(),
        "stable_share": computed.grid.as_ref().map(toolroom_chatter::Lobes::stable_share),
        "points": points,
        "boundaries": boundaries,
    })
}

/// Every verdict of the grid, or the boundary where there is no grid.
fn table(file: &LobesFile, computed: &Computed) -> String {
    let axes = file.cut.axes();
    let (speed, depth) = (axes.speed, axes.depth);
    let mut text = String::new();
    if let Some(grid) = &computed.grid {
        let _ =
            writeln!(text, "{},{},spectral_radius,stable,type,chatter_frequency [Hz]", speed.column(), depth.column());
        for (i, at) in grid.speed.iter().enumerate() {
            for (j, deep) in grid.depth.iter().enumerate() {
                let Some(verdict) = grid.at(i, j) else { continue };
                let _ = writeln!(
                    text,
                    "{},{},{},{},{},{}",
                    speed.shown(*at),
                    depth.shown(*deep),
                    verdict.spectral_radius,
                    verdict.stable,
                    word(verdict.kind),
                    file.cut.chatter_frequency(verdict)
                );
            }
        }
        return text;
    }
    let _ = writeln!(text, "boundary,crossing,{},{}", speed.column(), depth.column());
    for curve in &computed.curves {
        for (crossing, points) in [("first", &curve.limit), ("further", &curve.further)] {
            for (at, deep) in points.iter().filter(|(_, deep)| deep.is_finite()) {
                let _ = writeln!(text, "{},{crossing},{},{}", curve.label, speed.shown(*at), depth.shown(*deep));
            }
        }
    }
    text
}
