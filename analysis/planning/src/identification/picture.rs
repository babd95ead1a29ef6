//! The lag, stock and force in pictures, and the report around them.

use super::IdentificationStudy;
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_chart::{Axis, Colour, Dash, Estimate, Intervals, Marker, Plot, Style, Table};
use toolroom_infeed::{Trial, fit_force_trace, lag_sd, stock_after};

const UM: f64 = 1e6;
/// N/m to N/um.
const N_PER_UM: f64 = 1e-6;
/// Trials beyond which the picture of the lags shows their summary alone.
const MOST_ROWS: usize = 30;
/// Recorded forces that are drawn.
const MOST_TRACES: usize = 4;

/// The report of an identification.
pub(super) fn report(study: &IdentificationStudy, provenance: Provenance) -> Report {
    let found = &study.identification;
    let mut report = Report::new(format!("Grinding identification: {}", study.title)).lead(lead(study));
    report =
        report.tile(Tile::new("lag K", format!("{:.4}", found.lag.mean), interval("95 %", found.lag.ci95, 1.0, 3)));
    for (label, scatter) in
        [("process stiffness Cp", &found.process_stiffness), ("system stiffness J", &found.system_stiffness)]
    {
        if let Some(scatter) = scatter {
            let value = format!("{:.1} N/um", scatter.mean * N_PER_UM);
            report = report.tile(Tile::new(label, value, interval("95 %", scatter.ci95, N_PER_UM, 1)));
        }
    }
    if let Some([less, more]) = found.half_revolution_range() {
        let value = format!("{less:.3} … {more:.3}");
        report = report.tile(Tile::new("K, half a revolution ∓", value, "systematic"));
    }
    let best = format!("{} rev", found.best.revolutions);
    report = report.tile(Tile::new("best length of a trial", best, format!("sd of K {:.3}", found.best.lag_sd)));
    let mut lags = Section::new("The lag")
        .paragraph(
            "A work revolution leaves the share K of the deflection. Intervals of scatter say how well these trials \
             agree; the systematic interval says what half a revolution in the definition of n would do, which no \
             repetition removes.",
        )
        .figure(Figure::new(&intervals(study), "K by trial, over all trials, and under another count of revolutions."));
    for advice in &found.advice {
        lags = lags.warning(advice.to_string());
    }
    report = report.section(lags.table("Trials", trials(study)));
    if study.trials.iter().any(|trial| {
        trial.stock_removed.is_some() && trial.spark_out_revolutions == 0.0 && trial.finish_revolutions == 0.0
    }) {
        report = report.section(
            Section::new("Infeed and stock")
                .figure(Figure::new(&stock(study), "Commanded infeed and stock ground, at the infeed of the first trial."))
                .figure(Figure::new(
                    &deflection(study),
                    "What the stock lags behind the infeed: the small difference of two large numbers that K is taken from.",
                )),
        );
    }
    let traced = traces(study);
    if !traced.is_empty() {
        let mut section = Section::new("Force").paragraph(
            "Rise and decay fitted with one K for each trial; where they end is free, so that neither a late start nor a \
             threshold force falls into K.",
        );
        for plot in &traced {
            section = section.figure(Figure::new(plot, "Recorded force and fit."));
        }
        report = report.section(section);
    }
    report
        .section(Section::new("Length of trial").figure(Figure::new(
            &lengths(study),
            "Standard deviation of K from the stock of one trial, by the errors of gauge, feed and start of contact.",
        )))
        .provenance(provenance)
}

fn lead(study: &IdentificationStudy) -> String {
    let found = &study.identification;
    let by = if found.trials.iter().all(|trial| trial.from_force.is_none()) {
        "stock"
    } else if found.trials.iter().all(|trial| trial.from_stock.is_none()) {
        "force"
    } else {
        "stock and force"
    };
    let trials =
        if study.trials.len() == 1 { "one trial".to_owned() } else { format!("{} trials", study.trials.len()) };
    let mut text = format!("From the {by} of {trials}, the lag K is {:.3}", found.lag.mean);
    if let Some([low, high]) = found.lag.ci95 {
        text += &format!(" ({low:.3} to {high:.3} by scatter)");
    }
    if let Some([less, more]) = found.half_revolution_range() {
        text += &format!("; counted half a revolution otherwise it would be {less:.3} or {more:.3}");
    }
    text + "."
}

fn interval(name: &str, bounds: Option<[f64; 2]>, scale: f64, digits: usize) -> String {
    bounds
        .map_or_else(String::new, |[low, high]| format!("{name}: {:.digits$} … {:.digits$}", low * scale, high * scale))
}

fn intervals(study: &IdentificationStudy) -> Intervals {
    let found = &study.identification;
    let mut chart = Intervals::new("Lag K and how well it is known", Axis::linear("Lag K", ""))
        .reference(found.lag.mean, "mean")
        .describe("Lag of each trial with two standard deviations of measurement, and intervals over all trials.");
    if found.trials.len() <= MOST_ROWS {
        for trial in &found.trials {
            let (value, sd) = (trial.lag.value, trial.lag.sd);
            chart = chart.row(
                format!("trial {}, ± 2 sd", trial.trial_id),
                Estimate::new(value, value - 2.0 * sd, value + 2.0 * sd),
            );
        }
    }
    let mut row = |label: &str, value: f64, bounds: Option<[f64; 2]>| {
        if let Some([low, high]) = bounds {
            chart = chart.clone().row(label, Estimate::new(value, low, high));
        }
    };
    row("mean, Student's t 95 %", found.lag.mean, found.lag.ci95);
    if let Some(bootstrap) = &found.bootstrap {
        row("mean, bootstrap 95 %", bootstrap.median, Some(bootstrap.ci95));
    }
    if let Some(pooled) = &found.pooled {
        row("one K for all stock, 95 %", pooled.lag, pooled.ci95);
    }
    row("one more trial, 95 %", found.lag.mean, found.lag.prediction95);
    row("systematic: ∓ half a revolution", found.lag.mean, found.half_revolution_range());
    chart
}

/// Trials whose stock can be drawn over revolutions of infeed.
fn plain_trials(study: &IdentificationStudy) -> impl Iterator<Item = (&Trial, f64)> {
    let plain = |trial: &&Trial| trial.spark_out_revolutions == 0.0 && trial.finish_revolutions == 0.0;
    study.trials.iter().filter(plain).filter_map(|trial| Some((trial, trial.stock_removed?)))
}

fn longest(study: &IdentificationStudy) -> f64 {
    let most = study.trials.iter().map(|trial| trial.revolutions).fold(4.0, f64::max);
    (1.15 * most).ceil()
}

fn whole_revolutions(most: f64) -> impl Iterator<Item = f64> {
    (0..=most as u32).map(f64::from)
}

const MEASURED: Style = Style::nth(1).marker(Marker::Diamond);

fn stock(study: &IdentificationStudy) -> Plot {
    let (most, lag) = (longest(study), study.identification.lag.mean);
    let infeed = plain_trials(study).next().map_or(0.0, |(trial, _)| trial.infeed_per_rev);
    let commanded = whole_revolutions(most).map(|n| (n, n * infeed * UM));
    let ground = whole_revolutions(most).map(|n| (n, stock_after(infeed, n, lag) * UM));
    let mut plot = Plot::new("Infeed and stock", Axis::linear("Work revolutions", ""), Axis::linear("Radius", "um"))
        .line("commanded infeed", commanded, Style::nth(0).colour(Colour::Ink).dash(Dash::Dashed))
        .line(format!("stock at the mean K of {lag:.4}"), ground, Style::nth(0))
        .describe("Commanded infeed, stock by the recursion, and measured stock over work revolutions.");
    if let Some([less, more]) = study.identification.half_revolution_range() {
        let band =
            whole_revolutions(most).map(|n| (n, stock_after(infeed, n, more) * UM, stock_after(infeed, n, less) * UM));
        plot = plot.band("stock at K of ∓ half a revolution", band, Style::nth(0));
    }
    plot.scatter("measured stock", plain_trials(study).map(|(trial, stock)| (trial.revolutions, stock * UM)), MEASURED)
}

fn deflection(study: &IdentificationStudy) -> Plot {
    let (most, found) = (longest(study), &study.identification);
    let curve = |lag: f64| whole_revolutions(most).map(move |n| (n, n - stock_after(1.0, n, lag)));
    let mut plot = Plot::new(
        "Stock behind infeed",
        Axis::linear("Work revolutions", ""),
        Axis::linear("Infeed not ground, in infeeds per revolution", "").include(0.0),
    )
    .line(format!("mean K = {:.4}", found.lag.mean), curve(found.lag.mean), Style::nth(0))
    .describe("Infeed that was not ground, over work revolutions, by trial and by the recursion.");
    if let Some([low, high]) = found.lag.ci95 {
        let band = curve(low).zip(curve(high)).map(|((n, low), (_, high))| (n, low, high));
        plot = plot.band("95 % of the mean", band, Style::nth(0));
    }
    if let Some([less, more]) = found.half_revolution_range() {
        let style = Style::nth(0).colour(Colour::Ink);
        plot = plot.line(format!("half a revolution less, K = {less:.4}"), curve(less), style.dash(Dash::Dotted)).line(
            format!("half a revolution more, K = {more:.4}"),
            curve(more),
            style.dash(Dash::DashDot),
        );
    }
    let measured =
        plain_trials(study).map(|(trial, stock)| (trial.revolutions, trial.revolutions - stock / trial.infeed_per_rev));
    plot.scatter("trials", measured, MEASURED)
}

fn traces(study: &IdentificationStudy) -> Vec<Plot> {
    let plot = |trial: &Trial| {
        let fit = fit_force_trace(&trial.force_trace, trial.revolutions, study.options.errors.force)?;
        let samples = trial.force_trace.iter().map(|sample| (sample.revolution, sample.force));
        let mut plot = Plot::new(
            format!("Force of trial {}, K = {:.4} ± {:.4}", trial.trial_id, fit.lag.value, fit.lag.sd),
            Axis::linear("Work revolutions since the commanded start", ""),
            Axis::linear("Force", "N").include(0.0),
        )
        .height(220.0)
        .scatter("recorded", samples, MEASURED)
        .vertical(trial.revolutions, "end of infeed")
        .describe("Recorded force over revolutions, with the end of infeed.");
        for (value, label) in [(fit.steady_force, "end of the rise"), (fit.floor, "end of spark-out")] {
            if let Some(value) = value {
                plot = plot.horizontal(value, label);
            }
        }
        Some(plot)
    };
    study.trials.iter().filter(|trial| !trial.force_trace.is_empty()).filter_map(plot).take(MOST_TRACES).collect()
}

fn lengths(study: &IdentificationStudy) -> Plot {
    let (lag, best) = (study.identification.lag.mean, study.identification.best);
    let infeed = study.trials.iter().map(|trial| trial.infeed_per_rev).sum::<f64>() / study.trials.len() as f64;
    let most = f64::from(best.revolutions * 3).max(longest(study));
    let sd = |n: f64| lag_sd(lag, infeed, n, 0.0, &study.options.errors);
    Plot::new(
        "Best length of a trial",
        Axis::linear("Work revolutions", ""),
        Axis::linear("Standard deviation of K", "").include(0.0),
    )
    .height(220.0)
    .line("one trial, by stock", whole_revolutions(most).skip(2).map(|n| (n, sd(n))), Style::nth(0))
    .vertical(f64::from(best.revolutions), format!("best: {}", best.revolutions))
    .describe("Standard deviation of the lag over the length of the trial.")
}

fn trials(study: &IdentificationStudy) -> Table {
    let mut table = Table::new(["trial", "K", "sd of K", "K by stock", "K by force", "Cp [N/um]", "J [N/um]", "Pz/Py"]);
    for trial in &study.identification.trials {
        let optional = |value: Option<f64>| value.unwrap_or(f64::NAN).into();
        table.push([
            trial.trial_id.as_str().into(),
            trial.lag.value.into(),
            trial.lag.sd.into(),
            optional(trial.from_stock.map(|estimate| estimate.value)),
            optional(trial.from_force.map(|estimate| estimate.value)),
            optional(trial.process_stiffness.map(|value| value * N_PER_UM)),
            optional(trial.system_stiffness.map(|value| value * N_PER_UM)),
            optional(trial.force_ratio),
        ]);
    }
    table
}
