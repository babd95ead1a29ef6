//! Coefficients in words, as JSON and as a file.

use super::{CoefficientOrigin, CoefficientStudy, TABLE_DEVIATION};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_dynamics::{Coefficient, Coefficients};

/// Names of the coefficients in files: of the chip (MPa), then of the edge (N/mm).
const NAMES: [[&str; 3]; 2] = [["tangential", "radial", "axial"], ["edge_tangential", "edge_radial", "edge_axial"]];
const UNITS: [(&str, f64); 2] = [("MPa", 1e-6), ("N/mm", 1e-3)];

impl CoefficientStudy {
    /// Every coefficient by its name, with its unit and the factor to it.
    fn entries(&self) -> Vec<(&'static str, &'static str, f64, Coefficient)> {
        let found = match &self.origin {
            CoefficientOrigin::Test(found) => [found.chip, found.edge],
            CoefficientOrigin::Group { group, chip, radial_ratio } => {
                let known = |value: f64| Some(Coefficient { value, sd: TABLE_DEVIATION * value });
                group.touching(*chip).map(|value| [known(value), known(value * radial_ratio), None])
            }
        };
        let mut entries = Vec::new();
        for ((names, values), (unit, factor)) in NAMES.iter().zip(found).zip(UNITS) {
            for (name, value) in names.iter().zip(values) {
                if let Some(value) = value {
                    entries.push((*name, unit, factor, value));
                }
            }
        }
        entries
    }

    /// For a terminal.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.name, self.material);
        let quantile = match &self.origin {
            CoefficientOrigin::Test(found) => Some(found.quantile),
            CoefficientOrigin::Group { .. } => None,
        };
        for (name, unit, factor, Coefficient { value, sd }) in self.entries() {
            let _ = write!(text, "  {name:16} {:>9.3} ± {:<8.3} {unit:5}", value * factor, sd * factor);
            if let Some(quantile) = quantile {
                let (low, high) = ((value - quantile * sd) * factor, (value + quantile * sd) * factor);
                let _ = write!(text, "  95 %: {low:.3} … {high:.3}");
            }
            text.push('\n');
        }
        match &self.origin {
            CoefficientOrigin::Test(found) => tested(found, &mut text),
            CoefficientOrigin::Group { group, chip, radial_ratio } => {
                let _ = writeln!(
                    text,
                    "  k_c1.1 {} MPa, m_c {}: the line that touches Kienzle's law at a chip of {} mm; radial over tangential \
                     {radial_ratio} and a standard deviation of {} % are assumptions",
                    group.pressure * 1e-6,
                    group.exponent,
                    chip * 1e3,
                    TABLE_DEVIATION * 100.0
                );
            }
        }
        let _ = write!(text, "  source: {}", self.source);
        text
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let coefficients: Map<String, Value> = self
            .entries()
            .into_iter()
            .map(|(name, unit, factor, Coefficient { value, sd })| {
                (format!("{name} [{unit}]"), json!({ "value": value * factor, "sd": sd * factor }))
            })
            .collect();
        let mut object = json!({
            "schema": 1,
            "name": self.name,
            "material": self.material,
            "source": self.source,
            "coefficients": coefficients,
        });
        match &self.origin {
            CoefficientOrigin::Test(found) => {
                let lines: Vec<Value> = ["x", "y", "z"]
                    .iter()
                    .zip(found.lines)
                    .filter_map(|(axis, line)| {
                        let line = line?;
                        Some(json!({
                            "axis": axis,
                            "intercept [N]": line.intercept,
                            "slope [N/mm]": line.slope * 1e-3,
                            "residual_sd [N]": line.residual,
                            "lack_of_fit": line.lack_of_fit.map(|test| json!({
                                "f": test.ratio,
                                "critical_95": test.critical,
                                "freedom": test.freedom,
                            })),
                        }))
                    })
                    .collect();
                object["freedom"] = json!(found.freedom);
                object["t_95"] = json!(found.quantile);
                object["feed_per_tooth [mm]"] = json!(found.range.map(|feed| feed * 1e3));
                object["lines"] = json!(lines);
                object["warnings"] = json!(found.warnings);
            }
            CoefficientOrigin::Group { group, chip, radial_ratio } => {
                object["group"] = json!({
                    "vdi_3323": group.number,
                    "iso_513": group.letter.to_string(),
                    "kc11 [MPa]": group.pressure * 1e-6,
                    "mc": group.exponent,
                    "chip_thickness [mm]": chip * 1e3,
                    "radial_ratio": radial_ratio,
                });
            }
        }
        object
    }

    /// The coefficient file, which a lobes file takes by `coefficients`.
    pub fn file(&self) -> String {
        let quoted = |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
        let mut text = format!(
            "schema = 1\nname = {}\nmaterial = {}\nsource = {}\n",
            quoted(&self.name),
            quoted(&self.material),
            quoted(&self.source)
        );
        if let CoefficientOrigin::Test(found) = &self.origin {
            let [from, to] = found.range.map(|feed| feed * 1e3);
            let _ = writeln!(text, "feed_per_tooth = [\"{from} mm\", \"{to} mm\"]");
        }
        for (name, unit, factor, Coefficient { value, sd }) in self.entries() {
            let (value, sd) = (value * factor, sd * factor);
            let _ = writeln!(text, "{name} = {{ value = \"{value:.5} {unit}\", sd = \"{sd:.5} {unit}\" }}");
        }
        text
    }
}

/// What a test says of itself.
fn tested(coefficients: &Coefficients, text: &mut String) {
    for (axis, line) in ["feed", "normal", "axis"].iter().zip(coefficients.lines) {
        let Some(line) = line else { continue };
        let _ = write!(text, "  along the {axis:6} residual {:.2} N", line.residual);
        let _ = match line.lack_of_fit {
            Some(test) => {
                let word = if test.ratio > test.critical { "no straight line" } else { "a straight line" };
                writeln!(text, ", lack of fit F {:.2} (95 %: {:.2}): {word}", test.ratio, test.critical)
            }
            None => writeln!(text, ", no feed was cut twice: the line cannot be tested"),
        };
    }
    for warning in &coefficients.warnings {
        let _ = writeln!(text, "  warning: {warning}");
    }
}
