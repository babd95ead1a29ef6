//! A diagnosis in ten lines for the terminal, and as a report.

use super::{Diagnosis, EffectId, GapVerdict, NamedEffect};
use std::fmt::Write;
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Estimate, Intervals, Table, Waterfall};
use toolroom_facts::Fact;

/// Effects that cannot be seen which the terminal lists.
const LISTED: usize = 4;
/// Difference of a closure with and without the readings that stand apart from which on both are said (1). Assumption: a
/// twentieth of a gap changes what a reader makes of it.
const APART: f64 = 0.05;

/// Four significant digits without trailing zeros: more of a size are below its own interval.
pub(super) fn rounded(value: f64) -> String {
    let four = format!("{value:.3e}").parse();
    toolroom_form::significant(four.unwrap_or(value))
}

pub(super) fn percent(share: f64) -> String {
    if share.is_finite() { format!("{:.0} %", 100.0 * share) } else { "–".to_owned() }
}

pub(super) fn named(id: EffectId, shape: &str) -> String {
    if shape.is_empty() { id.to_string() } else { format!("{id} ({shape})") }
}

/// A named effect in words, with the warning that a description is no cause.
pub(super) fn named_effect(effect: &NamedEffect) -> String {
    let words = named(effect.id, &effect.shape);
    if effect.empirical { format!("{words}, empirical, not a cause") } else { words }
}

pub(super) fn with_unit(value: f64, unit: &str) -> String {
    if unit == "1" { rounded(value) } else { format!("{} {unit}", rounded(value)) }
}

/// The verdict as a sentence.
pub(super) fn verdict(diagnosis: &Diagnosis) -> String {
    match diagnosis.verdict {
        GapVerdict::Effect => {
            let names: Vec<String> = diagnosis.effects.iter().map(named_effect).collect();
            format!("missing effect: {}", names.join(" and "))
        }
        GapVerdict::Small => "the model does not fit exactly, but what it leaves matters nowhere".to_owned(),
        GapVerdict::Constant if diagnosis.findings.is_empty() => {
            "a constant of the model is wrong; with it corrected the model fits".to_owned()
        }
        GapVerdict::Constant => {
            let constants = diagnosis.findings.iter().filter(|finding| finding.constant).map(|finding| finding.fact);
            let name =
                |fact: usize| format!("{} of {}", diagnosis.facts[fact].quantity.words(), diagnosis.facts[fact].place);
            format!("the file has another constant: {}", constants.map(name).collect::<Vec<_>>().join("; "))
        }
        GapVerdict::Unknown => "there is a gap that no effect of the catalogue explains".to_owned(),
        GapVerdict::Masked => "what is missing cannot be seen in such data: calibration takes it up".to_owned(),
        GapVerdict::NoGap => match &diagnosis.fit {
            Some(fit) => format!("no gap beyond calibration and noise (p = {:.2})", fit.p),
            None => "no gap beyond calibration and noise".to_owned(),
        },
        GapVerdict::CannotTell => "too little was measured for any answer".to_owned(),
    }
}

impl Diagnosis {
    /// About ten lines that say what was found and what to do.
    pub fn terminal(&self) -> String {
        let mut text = format!("verdict  {}\n", verdict(self));
        for effect in &self.effects {
            let _ = writeln!(
                text,
                "  {}  {} (90 %: {} … {}), probability {:.2}, score {:.1}",
                named_effect(effect),
                with_unit(effect.size, effect.unit),
                rounded(effect.ci90[0]),
                rounded(effect.ci90[1]),
                effect.probability,
                effect.z
            );
            if effect.class.len() > 1 {
                let _ = writeln!(
                    text,
                    "    the data do not distinguish it from {}: {}",
                    EffectId::words(&effect.class[1..]).join(", "),
                    effect.class_reason
                );
            }
        }
        for finding in &self.findings {
            let kind = match (finding.constant, self.facts.get(finding.fact).is_some_and(Fact::is_cause)) {
                (true, _) => "constant",
                (false, true) => "cause   ",
                (false, false) => "queue   ",
            };
            let _ = writeln!(text, "{kind} {}", finding.words);
        }
        if let Some(cell) = self.cells.first() {
            let place = if cell.group == "all" { &cell.regime } else { &cell.group };
            let _ = writeln!(text, "where    {} follows {place} (score {:.1})", cell.channel, cell.score);
        }
        // What the events of machines show closes nothing in the records of their process.
        if self.effects.iter().any(|effect| effect.gain[0].is_finite()) {
            let _ = writeln!(
                text,
                "closed   {} of the gap on groups left out (90 %: {} … {}; of as many new groups {} … {}); {} of what can be closed",
                percent(self.total.closed),
                percent(self.total.ci90[0]),
                percent(self.total.ci90[1]),
                percent(self.total.pi90[0]),
                percent(self.total.pi90[1]),
                percent(self.total.of_closable)
            );
            let [mean, without] = [self.total.measures.mean, self.total.measures.mean_without_apart];
            if !self.apart.is_empty() && without.is_finite() && (mean - without).abs() > APART {
                let _ = writeln!(
                    text,
                    "         of the mean {}; {} without what stands apart (readings: {})",
                    percent(mean),
                    percent(without),
                    self.apart.len()
                );
            }
        }
        if self.verdict != GapVerdict::CannotTell {
            text += &self.budget_line();
        }
        let hidden: Vec<String> = self
            .masked
            .iter()
            .filter(|masked| masked.minimal_detectable.is_finite())
            .take(LISTED)
            .map(|masked| format!("{} below {}", masked.id, with_unit(masked.minimal_detectable, masked.unit)))
            .collect();
        if !hidden.is_empty() {
            let _ = writeln!(text, "hidden   {}", hidden.join(", "));
        }
        if !self.next.design.is_empty() {
            let _ = writeln!(text, "next     {}", self.next.design);
        }
        for note in &self.notes {
            let _ = writeln!(text, "note     {note}");
        }
        text.trim_end().to_owned()
    }

    fn budget_line(&self) -> String {
        format!(
            "budget   calibration {}, effects {}, form {}, unexplained {}, noise and scatter {}\n",
            percent(self.budget.calibration),
            percent(self.budget.effects),
            percent(self.budget.form_allowance),
            percent(self.budget.unexplained),
            percent(self.budget.noise_floor)
        )
    }

    /// Sections of a report for whoever wants to know how the answer came about; `of` goes before their headings.
    pub(super) fn sections(&self, of: &str) -> Vec<Section> {
        let heading = |text: &str| match (of, text.split_at(1)) {
            ("", _) => text.to_owned(),
            (of, (first, rest)) => format!("{of}: {}{rest}", first.to_lowercase()),
        };
        if self.verdict == GapVerdict::CannotTell {
            return vec![Section::new(heading("Too little data")).list(self.notes.clone())];
        }
        vec![
            self.waterfall(heading("The gap and its causes")),
            self.places(heading("Localisation")),
            self.candidates(heading("Ranking of effects")),
            self.hidden(heading("What hides behind calibration")),
        ]
    }

    fn waterfall(&self, heading: String) -> Section {
        let budget = &self.budget;
        let total =
            budget.calibration + budget.form_allowance + budget.effects + budget.unexplained + budget.noise_floor;
        let chart = Waterfall::new("Where the gap goes", Axis::linear("Share of the gap", "%"))
            .describe("Sum of squares of measurement less model, weighed by noise and scatter, stage by stage.")
            .total("nominal model", 100.0 * total)
            .change("calibration", -100.0 * budget.calibration)
            .change("named effects", -100.0 * budget.effects)
            .change("form allowance", -100.0 * budget.form_allowance)
            .change("unexplained", -100.0 * budget.unexplained)
            .total("noise and scatter of edges", 100.0 * budget.noise_floor);
        Section::new(heading).figure(Figure::new(
            &chart,
            "Each stage counts beyond those before it, and beyond what as many numbers explain of noise alone. \
             Calibration moves constants within their priors; named effects are terms of the catalogue; the form \
             allowance is what the equations may be wrong by.",
        ))
    }

    fn places(&self, heading: String) -> Section {
        let mut chart = Intervals::new("Where the gap lies", Axis::linear("Score", ""))
            .describe("Score of each channel against each covariate; beyond 4 is no chance.")
            .reference(0.0, "no gap");
        for cell in &self.cells {
            let place = if cell.group == "all" { &cell.regime } else { &cell.group };
            chart = chart.row(
                // Long labels are cut, and sets of channels are longer than what they follow.
                format!("{place} × {}", cell.channel),
                Estimate::new(cell.score, cell.score - 1.0, cell.score + 1.0),
            );
        }
        let section = Section::new(heading);
        if self.cells.is_empty() {
            return section.paragraph("No channel follows any covariate beyond what calibration explains.");
        }
        section.figure(Figure::new(&chart, "What calibration and allowance leave, ± one standard deviation."))
    }

    fn candidates(&self, heading: String) -> Section {
        let mut table = Table::new(["effect", "size", "unit", "score", "gain", "gain on groups left out", "± error"]);
        for ranked in self.ranking.iter().take(20) {
            table.push([
                named(ranked.id, &ranked.shape).into(),
                ranked.size.into(),
                written(ranked.unit).into(),
                ranked.z.into(),
                ranked.gain.into(),
                ranked.left_out[0].into(),
                ranked.left_out[1].into(),
            ]);
        }
        let mut section = Section::new(heading)
            .paragraph(
                "Gain in log evidence over the calibrated nominal model; an effect is named from 4 on, if \
                        groups agree and no other structure is as strong.",
            )
            .table("Single effects", table);
        for effect in self.effects.iter().filter(|effect| effect.class.len() > 1) {
            section = section.warning(format!(
                "The data do not distinguish {} from {}: {}",
                effect.id,
                EffectId::words(&effect.class[1..]).join(", "),
                effect.class_reason
            ));
        }
        section
    }

    fn hidden(&self, heading: String) -> Section {
        let mut table =
            Table::new(["effect", "masking", "least size seen", "unit", "test that separates them", "if left out"]);
        for masked in &self.masked {
            table.push([
                named(masked.id, &masked.shape).into(),
                masked.masking.into(),
                masked.minimal_detectable.into(),
                written(masked.unit).into(),
                masked.separating_test.into(),
                masked.bias.clone().into(),
            ]);
        }
        Section::new(heading).table("Effects that hide behind calibration in such data", table)
    }
}

/// A unit beside a number; that of a pure number is not written.
fn written(unit: &'static str) -> &'static str {
    if unit == "1" { "" } else { unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_told_to_four_digits() {
        let told = [0.152_385_7, -0.166_666_7, 1234.567, 2.0, 0.0, f64::INFINITY].map(rounded);
        assert_eq!(told, ["0.1524", "-0.1667", "1235", "2", "0", "inf"]);
        assert_eq!(with_unit(14.987_65, "s"), "14.99 s");
    }
}
