//! Measured and fitted responses in pictures, and the report around them.

use super::text::{cells, read};
use super::{Comparison, ModesStudy};
use nalgebra::Complex;
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_chart::{Axis, Colour, Marker, Plot, Style, Table};
use toolroom_dynamics::Frf;

/// Coherence below which a line is drawn as not counting.
const CLEAR: f64 = 0.5;
const MEASURED: Style = Style::nth(1).marker(Marker::Circle);
const UNCLEAR: Style = Style::nth(1).marker(Marker::Circle).colour(Colour::Grey);

/// The report of a modal fit.
pub(super) fn report(study: &ModesStudy, provenance: Provenance) -> Report {
    let quality = &study.fit.quality;
    let mut report = Report::new(format!("Vibration modes: {}", study.name))
        .lead(format!("{} modes; the fit is {}.", study.fit.modes.len(), quality.verdict()))
        .tile(Tile::new("modes", study.fit.modes.len().to_string(), "that stand out of the noise"))
        .tile(Tile::new(
            "chi2 over freedom",
            quality.reduced_chi2.map_or("–".to_owned(), |chi2| format!("{chi2:.2}")),
            "1 where the coherence is right",
        ));
    let mut modes = Section::new("Modes").paragraph(
        "Values with the standard deviation of the fit alone. What changes from tap to tap and from mounting to mounting is \
         added in the structure file.",
    );
    for refusal in &quality.refusals {
        modes = modes.warning(format!("{refusal}: {}", refusal.fix()));
    }
    for warning in quality.warnings() {
        modes = modes.warning(warning);
    }
    let mut table =
        Table::new(["mode", "frequency [Hz]", "damping ratio", "stiffness [N/um]", "direction", "coherence"]);
    for (i, (mode, coherence)) in study.fit.modes.iter().zip(&quality.coherence).enumerate() {
        let [frequency, damping, stiffness, direction] = cells(mode);
        let coherence = coherence.map_or_else(|| "not measured".to_owned(), |value| format!("{value:.3}"));
        let name = format!("m{}", i + 1);
        table.push([
            name.into(),
            frequency.into(),
            damping.into(),
            stiffness.into(),
            direction.into(),
            coherence.into(),
        ]);
    }
    report = report.section(modes.table("Modes at the point of cut", table));
    let mut responses = Section::new("Responses").paragraph(read(&study.measured));
    for (index, function) in study.measured.functions.iter().enumerate() {
        responses = responses
            .figure(Figure::new(
                &magnitude(study, function, index),
                format!("Receptance {}: measured and fitted.", function.name()),
            ))
            .figure(Figure::new(
                &real(study, function, index),
                format!("Real part of {}; its least value sets the limit of the cut.", function.name()),
            ));
    }
    if let Some(comparison) = &study.comparison {
        responses = responses.figure(Figure::new(
            &beside(comparison),
            format!("The tip as it is predicted and as it was measured ({}).", comparison.source),
        ));
    }
    report
        .section(responses)
        .section(
            Section::new("Stabilisation")
                .paragraph(
                    "Poles of a common denominator over its order. A pole is stable where the order before has one within 1 % \
                     in frequency and 5 % in damping: the columns are modes.",
                )
                .figure(Figure::new(&stabilisation(study), "Poles over the order of the denominator.")),
        )
        .provenance(provenance)
}

fn frequency_axis(study: &ModesStudy) -> Axis {
    let (first, last) = (study.measured.frequencies.first(), study.measured.frequencies.last());
    Axis::linear("Frequency", "Hz").range(first.copied().unwrap_or(0.0), last.copied().unwrap_or(1.0))
}

/// Points of a function split by whether its coherence counts.
fn measured(study: &ModesStudy, function: &Frf, clear: bool, of: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    let counts = |i: usize| function.coherence.as_ref().is_none_or(|coherence| coherence[i] >= CLEAR);
    (0..study.measured.frequencies.len())
        .filter(|i| counts(*i) == clear)
        .map(|i| (study.measured.frequencies[i], of(i)))
        .collect()
}

fn fitted(study: &ModesStudy, of: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
    study.measured.frequencies.iter().enumerate().map(|(i, frequency)| (*frequency, of(i))).collect()
}

fn magnitude(study: &ModesStudy, function: &Frf, index: usize) -> Plot {
    let raw = |i: usize| function.receptance[i].norm() * 1e6;
    let values = &study.fit.fitted[index];
    let greatest = values.iter().map(|value| value.norm()).fold(0.0, f64::max) * 1e6;
    let mut plot = Plot::new(
        format!("Receptance {}", function.name()),
        frequency_axis(study),
        Axis::log("Magnitude", "um/N").range(1e-4 * greatest, 2.0 * greatest),
    )
    .scatter("measured", measured(study, function, true, raw), MEASURED)
    .scatter("coherence below 0.5", measured(study, function, false, raw), UNCLEAR)
    .line("fitted", fitted(study, |i| values[i].norm() * 1e6), Style::nth(0))
    .describe("Magnitude of the measured and of the fitted receptance over frequency.");
    for mode in &study.fit.modes {
        plot = plot.vertical(mode.natural_frequency.value, format!("{:.0} Hz", mode.natural_frequency.value));
    }
    plot
}

/// A predicted tip beside the measured one.
fn beside(comparison: &Comparison) -> Plot {
    let points = |values: &[Complex<f64>]| -> Vec<(f64, f64)> {
        comparison.frequencies.iter().zip(values).map(|(frequency, value)| (*frequency, value.norm() * 1e6)).collect()
    };
    let greatest = points(&comparison.measured).iter().map(|(_, size)| *size).fold(0.0, f64::max);
    let [first, last] = [comparison.frequencies.first(), comparison.frequencies.last()].map(|end| end.copied());
    Plot::new(
        "Tip: predicted and measured",
        Axis::linear("Frequency", "Hz").range(first.unwrap_or(0.0), last.unwrap_or(1.0)),
        Axis::log("Magnitude", "um/N").range(1e-4 * greatest, 2.0 * greatest),
    )
    .scatter("measured", points(&comparison.measured), MEASURED)
    .line("predicted", points(&comparison.predicted), Style::nth(0))
    .describe("Magnitude of the predicted and of the measured receptance over frequency.")
}

fn real(study: &ModesStudy, function: &Frf, index: usize) -> Plot {
    let values = &study.fit.fitted[index];
    let least = values.iter().map(|value| value.re).fold(0.0, f64::min) * 1e6;
    let greatest = values.iter().map(|value| value.re).fold(0.0, f64::max) * 1e6;
    let margin = 0.3 * (greatest - least);
    let mut plot = Plot::new(
        format!("Real part of {}", function.name()),
        frequency_axis(study),
        Axis::linear("Real part", "um/N").range(least - margin, greatest + margin),
    )
    .height(220.0)
    .scatter("measured", measured(study, function, true, |i| function.receptance[i].re * 1e6), MEASURED)
    .line("fitted", fitted(study, |i| values[i].re * 1e6), Style::nth(0))
    .describe("Real part of the measured and of the fitted receptance over frequency.");
    if function.is_direct() {
        plot = plot.horizontal(least, "least");
    }
    plot
}

fn stabilisation(study: &ModesStudy) -> Plot {
    let poles = |stable: bool| {
        let found = study.fit.poles.iter().filter(move |pole| pole.stable == stable);
        found.map(|pole| (pole.natural_frequency, pole.order as f64)).collect::<Vec<_>>()
    };
    let mut plot = Plot::new("Stabilisation", frequency_axis(study), Axis::linear("Order of the denominator", ""))
        .scatter("other poles", poles(false), UNCLEAR)
        .scatter("stable poles", poles(true), Style::nth(0).marker(Marker::Diamond))
        .describe("Poles of common denominators over their order.");
    for mode in &study.fit.modes {
        plot = plot.vertical(mode.natural_frequency.value, format!("{:.0} Hz", mode.natural_frequency.value));
    }
    plot
}
