//! Modes in words and as JSON.

use super::ModesStudy;
use serde_json::{Value, json};
use std::fmt::Write as _;
use toolroom_dynamics::{Estimate, FittedMode, Measurement};

/// N/m to N/um.
pub(super) const N_PER_UM: f64 = 1e-6;

impl ModesStudy {
    /// What was found, for people.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n", read(&self.measured));
        let _ = writeln!(
            text,
            "mode   frequency Hz             damping ratio            stiffness N/um           direction"
        );
        for (i, mode) in self.fit.modes.iter().enumerate() {
            let [frequency, damping, stiffness, direction] = cells(mode);
            let _ = writeln!(text, "{:<6} {frequency:<24} {damping:<24} {stiffness:<24} {direction}", i + 1);
        }
        let quality = &self.fit.quality;
        let _ = match quality.reduced_chi2 {
            Some(chi2) => writeln!(text, "\nchi2 over degrees of freedom {chi2:.3}"),
            None => writeln!(
                text,
                "\nchi2 over degrees of freedom –: without coherence or averages the residuals themselves tell the noise"
            ),
        };
        for (function, residual) in &quality.residuals {
            let _ = writeln!(text, "the fit leaves {:.1} % of {function}", residual * 100.0);
        }
        for warning in quality.warnings() {
            let _ = writeln!(text, "warning: {warning}");
        }
        let _ = writeln!(text, "{}", quality.verdict());
        let scatter = self.scatter;
        let _ = writeln!(
            text,
            "\nstandard deviations are those of the fit; the structure file adds {} % in frequency, {} % in damping and {} % in \
             stiffness for what changes from mounting to mounting (an assumption unless given with --scatter)",
            percent(scatter.natural_frequency),
            percent(scatter.damping_ratio),
            percent(scatter.stiffness)
        );
        if let Some(comparison) = &self.comparison {
            let _ = write!(text, "\n{}", comparison.text());
        }
        text
    }

    /// What was found, for programs.
    pub fn json(&self) -> Value {
        let quality = &self.fit.quality;
        let modes = self.fit.modes.iter().zip(&quality.coherence).map(|(mode, coherence)| {
            json!({
                "natural_frequency [Hz]": mode.natural_frequency.value,
                "damping_ratio": mode.damping_ratio.value,
                "stiffness [N/um]": mode.stiffness.value * N_PER_UM,
                "direction": mode.direction,
                "coherence": coherence,
                "sd": {
                    "natural_frequency [Hz]": mode.natural_frequency.sd,
                    "damping_ratio": mode.damping_ratio.sd,
                    "stiffness [N/um]": mode.stiffness.sd * N_PER_UM,
                    "direction [deg]": mode.direction_sd.map(f64::to_degrees),
                },
            })
        });
        let residuals = quality.residuals.iter().map(|(name, residual)| (name.clone(), json!(residual)));
        let upper = self.fit.upper.iter().map(|(pair, upper)| ((*pair).to_owned(), json!(upper.value * 1e6)));
        let mut found = json!({
            "schema": 1,
            "name": self.name,
            "modes": modes.collect::<Vec<_>>(),
            "upper_residual [um/N]": upper.collect::<serde_json::Map<_, _>>(),
            "residual": residuals.collect::<serde_json::Map<_, _>>(),
            "chi2": quality.reduced_chi2,
            "reciprocity": quality.reciprocity,
            "quality": quality.verdict(),
            "warnings": quality.warnings(),
            "notes": self.measured.notes,
            "refused": quality.refusals.first().map(|refusal| refusal.code()),
        });
        if let Some(comparison) = &self.comparison {
            found["comparison"] = comparison.json();
        }
        found
    }
}

/// What was read from the file, in one line and the notes.
pub fn read(measured: &Measurement) -> String {
    let functions: Vec<String> =
        measured.functions.iter().map(|function| format!("{} ({})", function.name(), function.motion.word())).collect();
    let coherence = if measured.functions.iter().all(|function| function.coherence.is_some()) {
        "with coherence"
    } else {
        "without coherence: the residuals of the fit tell the noise"
    };
    let (first, last) = (measured.frequencies.first().copied(), measured.frequencies.last().copied());
    let mut text = format!(
        "{}: {} over {} to {} Hz in steps of {} Hz, {coherence}",
        measured.source,
        functions.join(", "),
        shown(first.unwrap_or(0.0)),
        shown(last.unwrap_or(0.0)),
        shown(measured.step())
    );
    for note in &measured.notes {
        let _ = write!(text, "\nnote: {note}");
    }
    text
}

/// What was read from the file, for programs.
pub fn read_json(measured: &Measurement) -> Value {
    let functions = measured.functions.iter().map(|function| {
        json!({
            "name": function.name(),
            "motion": function.motion.word(),
            "coherence": function.coherence.is_some(),
        })
    });
    json!({
        "schema": 1,
        "source": measured.source,
        "functions": functions.collect::<Vec<_>>(),
        "first [Hz]": measured.frequencies.first(),
        "last [Hz]": measured.frequencies.last(),
        "step [Hz]": measured.step(),
        "lines": measured.frequencies.len(),
        "averages": measured.averages,
        "notes": measured.notes,
    })
}

/// A frequency to six digits, as it was told.
fn shown(frequency: f64) -> f64 {
    let digits = 10f64.powf(5.0 - frequency.abs().max(f64::MIN_POSITIVE).log10().floor());
    let rounded = (frequency * digits).round() / digits;
    if rounded.is_finite() { rounded } else { frequency }
}

/// Frequency, damping, stiffness and direction of a mode as people read them.
pub(super) fn cells(mode: &FittedMode) -> [String; 4] {
    let [x, y] = mode.direction;
    let angle = y.atan2(x).to_degrees();
    let direction = match mode.direction_sd {
        Some(sd) => with_sd(Estimate { value: angle, sd: sd.to_degrees() }) + " deg",
        // The zero that is added turns −0 into 0.
        None => format!("{:.0} deg", angle.round() + 0.0),
    };
    let stiffness = Estimate { value: mode.stiffness.value * N_PER_UM, sd: mode.stiffness.sd * N_PER_UM };
    [with_sd(mode.natural_frequency), with_sd(mode.damping_ratio), with_sd(stiffness), direction]
}

/// A value with its standard deviation to two digits.
fn with_sd(estimate: Estimate) -> String {
    let Estimate { value, sd } = estimate;
    if sd.is_nan() || sd <= 0.0 {
        return format!("{value}");
    }
    let places = usize::try_from((1 - sd.log10().floor() as i32).clamp(0, 12)).unwrap_or(0);
    format!("{value:.places$} ± {sd:.places$}")
}

fn percent(share: f64) -> String {
    format!("{:.3}", share * 100.0).trim_end_matches('0').trim_end_matches('.').to_owned()
}
