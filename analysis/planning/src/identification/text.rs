//! What the trials say, on the terminal.

use super::IdentificationStudy;
use std::fmt::Write;
use toolroom_infeed::{Estimate, Scatter};

const UM: f64 = 1e6;
/// N/m to N/um.
const N_PER_UM: f64 = 1e-6;

impl IdentificationStudy {
    /// What the trials say, in a few lines.
    pub fn text(&self) -> String {
        let found = &self.identification;
        let plural = if self.trials.len() == 1 { "" } else { "s" };
        let mut text = format!("{}: {} trial{plural}\n", self.title, self.trials.len());
        let _ = writeln!(
            text,
            "  {:14} {:>8} {:>7} {:>8} {:>8} {:>9} {:>9} {:>6}",
            "trial", "K", "± sd", "by stock", "by force", "Cp, N/um", "J, N/um", "Pz/Py"
        );
        let number =
            |value: Option<f64>, digits: usize| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.digits$}"));
        for trial in &found.trials {
            let _ = writeln!(
                text,
                "  {:14} {:>8.5} {:>7.4} {:>8} {:>8} {:>9} {:>9} {:>6}",
                shortened(&trial.trial_id),
                trial.lag.value,
                trial.lag.sd,
                number(trial.from_stock.map(|estimate| estimate.value), 5),
                number(trial.from_force.map(|estimate| estimate.value), 5),
                number(trial.process_stiffness.map(|value| value * N_PER_UM), 2),
                number(trial.system_stiffness.map(|value| value * N_PER_UM), 2),
                number(trial.force_ratio, 4),
            );
        }
        let mut row = |name: &str, value: String| {
            let _ = writeln!(text, "  {name:34} {value}");
        };
        row("mean K", interval(found.lag.mean, found.lag.ci95, 5, "95 % by Student's t"));
        if self.trials.len() > 2 {
            row("median, Huber's mean", format!("{:.5}, {:.5}", found.lag.median, found.lag.huber));
        }
        if let Some(bootstrap) = &found.bootstrap {
            let how = format!(
                "95 % by bootstrap, {} {} resamples",
                if bootstrap.exact { "all" } else { "of" },
                bootstrap.resamples
            );
            row("", interval(bootstrap.median, Some(bootstrap.ci95), 5, &how));
        }
        if let Some(pooled) = &found.pooled {
            let mut value = interval(pooled.lag, pooled.ci95, 5, "95 %");
            if let Some(sd) = pooled.sd_stock {
                let _ = write!(value, "; stock scatters by {:.2} um", sd * UM);
            }
            row("one K for the stock of all", value);
        }
        if let Some([low, high]) = found.lag.prediction95 {
            row("one more trial would give", format!("{low:.4} … {high:.4}  (95 %)"));
        }
        for (name, scatter) in [
            ("process stiffness Cp, N/um", &found.process_stiffness),
            ("system stiffness J, N/um", &found.system_stiffness),
        ] {
            if let Some(scatter) = scatter {
                row(name, stiffness(scatter));
            }
        }
        if let Some(joint) = &found.joint {
            let one = |name: &str, estimate: Estimate, scale: f64, digits: usize| {
                format!("{name} {:.digits$} ± {:.digits$}", estimate.value * scale, estimate.sd * scale)
            };
            let mut words =
                vec![one("Cp", joint.process_stiffness, N_PER_UM, 2), one("J", joint.system_stiffness, N_PER_UM, 2)];
            words.extend(joint.threshold_force.map(|force| one("F0", force, 1.0, 2)));
            words.extend(joint.force_exponent.map(|exponent| one("m", exponent, 1.0, 4)));
            let end = format!("  (sd; {} readings, misfit {:.2})", joint.readings, joint.misfit);
            row("all readings together", words.join(", ") + &end);
        }
        if let Some([less, more]) = found.half_revolution_range() {
            let by_force = found.trials.iter().any(|trial| trial.from_force.is_some());
            let by = if by_force { "by stock alone" } else { "systematic, in no interval above" };
            row("half a revolution less, more", format!("K {less:.4}, {more:.4}  ({by})"));
        }
        row(
            "best length of a trial",
            format!("{} revolutions, sd of K {:.3}", found.best.revolutions, found.best.lag_sd),
        );
        for trial in &found.left_out {
            let _ = writeln!(text, "  ! left out: {trial}");
        }
        for advice in &found.advice {
            let _ = writeln!(text, "  ! {advice}");
        }
        text.truncate(text.trim_end().len());
        text
    }
}

fn interval(value: f64, ci95: Option<[f64; 2]>, digits: usize, how: &str) -> String {
    let low_high = |[low, high]: [f64; 2]| format!("  ({low:.4} … {high:.4}, {how})");
    format!("{value:.digits$}{}", ci95.map_or_else(String::new, low_high))
}

fn stiffness(scatter: &Scatter) -> String {
    let in_display = |value: f64| value * N_PER_UM;
    let range = |[low, high]: [f64; 2]| format!("  ({:.1} … {:.1}, 95 %)", in_display(low), in_display(high));
    format!("{:.2}{}", in_display(scatter.mean), scatter.ci95.map_or_else(String::new, range))
}

/// A name that leaves the columns in place.
fn shortened(name: &str) -> String {
    if name.chars().count() <= 14 { name.to_owned() } else { name.chars().take(13).chain(['…']).collect() }
}
