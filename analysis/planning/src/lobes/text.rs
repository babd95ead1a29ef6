//! A chart on the terminal.

use super::cut::with_unit;
use super::robust::robust_text;
use super::{ChartStudy, word};
use std::fmt::Write;

impl ChartStudy<'_> {
    /// The chart in a few lines.
    pub fn text(&self) -> String {
        let file = self.file;
        let axes = file.cut.axes();
        let mut text = format!("{}\n", file.title);
        for curve in &self.curves {
            let limits = || curve.limit.iter().filter(|(_, depth)| depth.is_finite());
            let least = limits().min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((speed, depth)) = least {
                let (depth, speed) = (with_unit(&axes.depth, *depth), with_unit(&axes.speed, *speed));
                let _ =
                    writeln!(text, "  {}: least {depth} at {} {speed}", curve.label, axes.speed.label.to_lowercase());
            } else {
                let _ = writeln!(text, "  {}: none on the chart", curve.label);
            }
        }
        if let Some(grid) = &self.grid {
            let (all, holes) = (grid.verdicts.len(), grid.holes.len());
            let share = 100.0 * grid.stable_share();
            let _ = match holes {
                0 => writeln!(text, "  stable: {share:.1} % of the chart"),
                _ if holes == all => writeln!(text, "  no point of the chart has a verdict"),
                _ => {
                    writeln!(
                        text,
                        "  stable: {share:.1} % of the {} points with a verdict; {holes} have none",
                        all - holes
                    )
                }
            };
        }
        if let Some(words) = self.beside_measured() {
            let _ = writeln!(text, "  {words}");
        }
        if let Some(best) = &self.best {
            let _ = writeln!(text, "  best: {}", best.text(file));
        }
        text += &robust_text(self);
        if !self.judgements.is_empty() {
            let _ = writeln!(
                text,
                "  {:20} {:>12} {:>12}  {:10} {:>9} {:>12} {:>8} {:>10}",
                "operating point", axes.speed.key, axes.depth.key, "verdict", "radius", "limit", "margin", "frequency"
            );
        }
        for (point, judged) in file.points.iter().zip(&self.judgements) {
            let Ok(judgement) = judged else {
                let (speed, depth) = (with_unit(&axes.speed, point.speed), with_unit(&axes.depth, point.depth));
                let _ = writeln!(text, "  {:20} {speed:>12} {depth:>12}  no verdict", point.name);
                continue;
            };
            let verdict = &judgement.verdict;
            let none = || "none".to_owned();
            let _ = writeln!(
                text,
                "  {:20} {:>12} {:>12}  {:10} {:>9.4} {:>12} {:>8} {:>10}",
                point.name,
                with_unit(&axes.speed, point.speed),
                with_unit(&axes.depth, point.depth),
                word(verdict.kind),
                verdict.spectral_radius,
                judgement.limit.map_or_else(none, |limit| with_unit(&axes.depth, limit)),
                judgement.margin().map_or_else(none, |margin| format!("{:.1} %", 100.0 * margin)),
                format!("{:.1} Hz", file.cut.chatter_frequency(verdict)),
            );
        }
        text.truncate(text.trim_end().len());
        text
    }
}
