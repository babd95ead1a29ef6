//! Key figures of the recorded shop, of its nominal model, and of the model with the effects.

use crate::{GapStudyError, Reading};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use toolroom_gap::shop::{Shop, ShopKpi, mix, visits};
use toolroom_gap::{ModelFileError, NominalModel, NominalProcess, Settings};
use toolroom_recording::simulated;
use toolroom_records::RecordKind;
use toolroom_scenario::file::read;

/// One key figure: of the recorded shop, of its nominal model, and of the model with the effects.
#[derive(Clone, Debug)]
pub struct Figure {
    name: &'static str,
    unit: &'static str,
    recorded: f64,
    before: f64,
    after: f64,
}

impl Figure {
    /// Share of the gap that the effects close.
    fn closed(&self) -> f64 {
        1.0 - (self.recorded - self.after).abs() / (self.recorded - self.before).abs()
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({
            "kpi": self.name, "unit": self.unit, "recorded": self.recorded, "nominal": self.before,
            "with_effects": self.after, "closed": self.closed().is_finite().then(|| self.closed()),
        })
    }
}

/// Runs the shop of `model` and of `better`, the model with the effects, and holds both against the recorded events.
///
/// # Errors
/// [`GapStudyError`]: a file that cannot be read, a model that is no shop, a run that stops.
pub fn figures(model: &Path, better: &Path, data: &Path, reading: &Reading<'_>) -> Result<Vec<Figure>, GapStudyError> {
    let nominal = NominalModel::read(model, &[])?;
    let NominalProcess::Shop(shop) = &nominal.process else { return Err(GapStudyError::NoShop) };
    let seen = visits(&reading.records(data, &nominal)?);
    let mix = mix(&seen);
    let recorded = ShopKpi::of(shop, &seen, &mix);
    let [before, after] = [run(model, shop, &mix)?, run(better, shop, &mix)?];
    let figure = |name, unit, value: &dyn Fn(&ShopKpi) -> f64| Figure {
        name,
        unit,
        recorded: value(&recorded),
        before: value(&before),
        after: value(&after),
    };
    Ok(vec![
        figure("cycle_time", "s", &|kpi| kpi.cycle_time),
        figure("throughput", "1/h", &|kpi| 3600.0 * kpi.throughput),
        figure("effectiveness", "1", &|kpi| kpi.effectiveness),
    ])
}

fn run(model: &Path, shop: &Shop, mix: &std::collections::BTreeMap<String, f64>) -> Result<ShopKpi, GapStudyError> {
    let scenario = read(model, &[]).map_err(ModelFileError::from)?.scenario;
    let log = toolroom_shop::run(&scenario, 0, 0).map_err(|error| GapStudyError::Work(error.to_string()))?;
    let all = simulated(&scenario, &log, &|_, channel| Settings::default().sensor(channel));
    let events = all.iter().find(|records| records.kind == RecordKind::Shop);
    Ok(ShopKpi::of(shop, &events.map(visits).unwrap_or_default(), mix))
}

/// The figures as people read them.
pub fn table(figures: &[Figure]) -> String {
    let mut text = format!(
        "{:16} {:>10} {:>10} {:>14} {:>20}\n",
        "on recorded mix", "recorded", "nominal", "with effects", "gap before → after"
    );
    for figure in figures {
        let name =
            if figure.unit == "1" { figure.name.to_owned() } else { format!("{}, {}", figure.name, figure.unit) };
        let digits = match figure.recorded.abs() {
            size if size < 10.0 => 3,
            size if size < 100.0 => 2,
            _ => 1,
        };
        let _ = writeln!(
            text,
            "{name:16} {:>10.digits$} {:>10.digits$} {:>14.digits$} {:>9.digits$} → {:.digits$}",
            figure.recorded,
            figure.before,
            figure.after,
            figure.recorded - figure.before,
            figure.recorded - figure.after,
        );
    }
    text
}
