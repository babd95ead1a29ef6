//! What records of a design can show of each effect, before and beside a diagnosis.

use super::constants::{ANYHOW, CONFUSED, CONVINCING, DETECTABLE, LARGE, NEIGHBOURS, PUSHED, UNLUCKY, WHOLLY};
use super::noise::unstated_scales;
use super::score::Scores;
use super::trial::Trial;
use super::{Basis, EffectId, Forward, Method};
use nalgebra::DVector;

/// What records of such a design can show of one effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiable {
    /// The effect.
    pub id: EffectId,
    /// Shape; may be empty.
    pub shape: String,
    /// Share of the squared length of its signature that calibration, allowance and group factors take
    /// up: 0.98 leaves 14 % of the length, which many readings may well show.
    pub masking: f64,
    /// Least size whose score would convince nineteen times of twenty, for all the noise, even where its
    /// function is not quite that of the catalogue, or between two shapes of it; display unit.
    pub minimal_detectable: f64,
    /// Unit of that.
    pub unit: &'static str,
    /// Effects with nearly the same signature.
    pub confused: Vec<EffectId>,
    /// What leaving it out would do to the calibration, at ordinary size.
    pub bias: String,
    /// Experiment that tells it from its worst confounder.
    pub separating_test: &'static str,
}

impl Identifiable {
    /// Score that an effect of `size` (display unit) promises: 5 at the least size that would convince.
    pub fn score(&self, size: f64) -> f64 {
        DETECTABLE * size / self.minimal_detectable
    }
}

/// What records of the design of `model` could show, by the sensor sheet and the scatter of the scenario: no measured value
/// counts, but where nobody states how much a channel scatters. That is read off its readings, as a diagnosis does.
pub fn identifiability(model: &dyn Forward) -> Vec<Identifiable> {
    let mut linear = super::Linear::new(model, super::Point::nominal(model));
    // An effect promises no more than it shows at its ordinary size and at twice that: its slope at
    // zero overstates one that saturates, its change at such sizes one that runs away.
    let (nominal, _) = super::linear::predict(model, &linear.point);
    for (index, candidate) in model.frame().candidates.iter().enumerate() {
        let observations = &model.frame().measured.observations;
        let square = |column: &[f64]| {
            let standard = column.iter().zip(observations).map(|(value, each)| value / each.deviation);
            standard.map(|value| value * value).sum::<f64>()
        };
        for size in [1.0, 2.0] {
            let mut point = linear.point.clone();
            point.effects[index] = (size * candidate.typical).min(candidate.greatest);
            let (there, _) = super::linear::predict(model, &point);
            let change: Vec<f64> = there.iter().zip(&nominal).map(|(there, here)| (there - here) / size).collect();
            if square(&change) < square(&linear.effects[index]) {
                std::sync::Arc::make_mut(&mut linear.effects)[index] = change;
            }
        }
    }
    let measured = &model.frame().measured;
    let scale = unstated_scales(measured, &linear.residual);
    let basis = Basis::unmeasured(model, Method::default(), linear.clone()).scaled(measured, &scale);
    let trial = Trial::of(model, &basis, &[], super::Fit::at(linear, 0.0));
    identified(model, &basis, &trial).into_iter().map(|shown| shown.row).collect()
}

/// What such data show of one effect.
pub(super) struct Shown {
    pub row: Identifiable,
    /// Ordinary size, display unit.
    typical: f64,
    /// Where an ordinary size moves the calibration if it is left out, prior standard deviations.
    moves: DVector<f64>,
}

/// Effects that such data can hardly show at their ordinary size.
pub(super) fn hidden(model: &dyn Forward, basis: &Basis, base: &Trial) -> Vec<Shown> {
    let mut list: Vec<Shown> = Vec::new();
    for shown in identified(model, basis, base) {
        // Of several shapes of an effect the one that shows best speaks for all.
        match list.iter_mut().find(|other| other.row.id == shown.row.id) {
            Some(other) if shown.row.minimal_detectable < other.row.minimal_detectable => *other = shown,
            Some(_) => {}
            None => list.push(shown),
        }
    }
    list.retain(|shown| shown.row.minimal_detectable > shown.typical);
    list
}

/// What calibration went far for, if a masked effect of a size that occurs pushes it there.
pub(super) fn hidden_by_calibration(model: &dyn Forward, base: &Trial, hidden: &[Shown]) -> Option<String> {
    let point = &base.fit.linear.point;
    let moved = point.parameters.iter().chain(&point.surfaces).enumerate();
    let pushed = |(i, x): (usize, &f64)| {
        let by = hidden.iter().find(|own| own.row.masking > WHOLLY && pushes(own.moves[i], *x))?;
        let (name, id) = (nuisance_name(model, i), by.row.id);
        Some(format!("`{name}` is {:.1} prior standard deviations off, where {id} would push it", x.abs()))
    };
    moved.into_iter().find_map(pushed)
}

/// Whether a number of the calibration that went to `moved` may have been pushed there by an effect whose
/// ordinary size moves it by `push`, prior standard deviations.
fn pushes(push: f64, moved: f64) -> bool {
    moved.abs() > PUSHED && LARGE * push * moved.signum() > moved.abs()
}

fn identified(model: &dyn Forward, basis: &Basis, trial: &Trial) -> Vec<Shown> {
    let scores = trial.scores();
    let nuisance = trial.fit.linear.nuisance.len();
    let shared: Vec<usize> = (0..nuisance).collect();
    let mut matrix = super::gram::part(&trial.gram.total, &shared, &shared);
    (0..nuisance).for_each(|i| matrix[(i, i)] += 1.0);
    let matrix = super::gram::factor(matrix);
    let row = |(index, candidate): (usize, &super::Candidate)| {
        let (factor, unit) = candidate.id.report_units();
        let moved = matrix.solve(&super::gram::part_column(&trial.gram.total, &shared, nuisance + index));
        let least = least(model, basis, trial, index, &moved, scores.length[index])
            / between(model, basis, trial, &scores, index);
        let worst = (0..nuisance).max_by(|a, b| moved[*a].abs().total_cmp(&moved[*b].abs()));
        let bias = worst.map_or_else(String::new, |worst| {
            let name = nuisance_name(model, worst);
            format!("at ordinary size it moves `{name}` by {:.1} prior standard deviations", moved[worst])
        });
        let mut confused: Vec<EffectId> = (0..model.frame().candidates.len())
            .filter(|other| {
                scores.cosine[(index, *other)] > CONFUSED && model.frame().candidates[*other].id != candidate.id
            })
            .map(|other| model.frame().candidates[other].id)
            .collect();
        confused.dedup();
        let row = Identifiable {
            id: candidate.id,
            shape: candidate.shape.clone(),
            masking: scores.masking[index],
            minimal_detectable: if least * candidate.typical > candidate.greatest {
                // A size that the effect cannot have.
                f64::INFINITY
            } else {
                least * candidate.typical * factor
            },
            unit,
            confused,
            bias,
            separating_test: candidate.id.entry().separating_test,
        };
        Shown { row, typical: candidate.typical * factor, moves: moved }
    };
    model.frame().candidates.iter().enumerate().map(row).collect()
}

/// Name of a number of the calibration or the form allowance.
fn nuisance_name(model: &dyn Forward, i: usize) -> &str {
    let frame = model.frame();
    let parameters = frame.parameters.iter().map(|parameter| &parameter.name);
    parameters.chain(frame.surfaces.iter().map(|surface| &surface.name)).nth(i).map_or("", String::as_str)
}

/// Least size, in ordinary ones, whose score convinces although the noise takes away of it, and
/// although the function of the effect is not quite that of the catalogue: what the projection leaves of a
/// signature is small beside what it takes away, so that a little change of form can cost much of it.
/// `score` is that of an ordinary size.
fn least(model: &dyn Forward, basis: &Basis, trial: &Trial, index: usize, moved: &DVector<f64>, score: f64) -> f64 {
    let linear = &trial.fit.linear;
    if score == 0.0 {
        return f64::INFINITY;
    }
    let mut effects = linear.effects[index].clone();
    for (column, x) in linear.nuisance.iter().zip(moved.iter()) {
        effects.iter_mut().zip(column).for_each(|(effects, slope)| *effects -= slope * x);
    }
    let forms = super::tolerance::columns(model, linear, &[index], &[1.0]);
    let columns: Vec<&[f64]> = forms.iter().map(Vec::as_slice).collect();
    let measured = &model.frame().measured;
    let gram =
        super::gram::normal_equations(measured, &basis.noise, linear, &columns, &effects, &basis.local_scale, &[]);
    let lost: f64 = (0..forms.len()).map(|form| (gram.total[(form, gram.last())] / score).powi(2)).sum();
    convincing(score, (UNLUCKY * lost.sqrt()).min((1.0 - ANYHOW) * score))
}

/// Size x at which `score` x − √((`lost` x)² + UNLUCKY²), the noise of a score being 1, comes to
/// CONVINCING; `lost` is below `score`.
fn convincing(score: f64, lost: f64) -> f64 {
    let (a, b, c) = (score * score - lost * lost, CONVINCING * score, CONVINCING * CONVINCING - UNLUCKY * UNLUCKY);
    (b + (b * b - a * c).sqrt()) / a
}

/// Share of the score of a shape that is left where the cause lies halfway between it and its neighbour: what the
/// projection leaves of the two may have little in common, so that neither sees it well.
fn between(model: &dyn Forward, basis: &Basis, trial: &Trial, scores: &Scores, index: usize) -> f64 {
    let frame = model.frame();
    let effects = &trial.fit.linear.effects;
    let dot = |a: usize, b: usize| -> f64 {
        let products = effects[a].iter().zip(&effects[b]).enumerate();
        products.map(|(i, (a, b))| a * b / basis.noise.deviation(&frame.measured, i).powi(2)).sum()
    };
    let alike = |other: &usize| *other != index && frame.candidates[*other].id == frame.candidates[index].id;
    let cosine = |other: usize| (other, dot(index, other) / (dot(index, index) * dot(other, other)).sqrt());
    let near = (0..frame.candidates.len()).filter(alike).map(cosine).filter(|(_, cosine)| *cosine > NEIGHBOURS);
    let Some((other, _)) = near.max_by(|a, b| a.1.total_cmp(&b.1)) else { return 1.0 };
    let (length, its, common) = (scores.length[index], scores.length[other], scores.cosine[(index, other)]);
    if length == 0.0 {
        return 1.0;
    }
    (0.5 * (length + its * common).max(its + length * common) / length).clamp(ANYHOW, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ChannelId;
    use crate::settle::{settled, stated};
    use crate::{Linear, NominalModel, Point};
    use toolroom_records::parse_csv;
    use toolroom_truth::Case;

    #[test]
    fn the_least_size_convinces_in_spite_of_noise_and_form() {
        for (score, lost) in [(5.0, 0.0), (3.0, 1.2), (40.0, 36.0)] {
            let size = convincing(score, lost);
            let left = score * size - (lost * size).hypot(UNLUCKY);
            assert!((left - CONVINCING).abs() < 1e-9, "{left} at {size}");
        }
        assert!((convincing(1.0, 0.0) - CONVINCING - UNLUCKY).abs() < 1e-12);
    }

    /// Loading scatters by 2 s in these shops, and their file gives it one time.
    #[test]
    fn a_design_is_judged_by_the_scatter_that_a_diagnosis_reads_off_its_records() {
        let text = include_str!("../../../scenarios/gap/turning.toml");
        let nominal = NominalModel::parse("turning.toml", text, &[]).expect("a shipped model");
        let over = |csv: &str| {
            let (records, _) = parse_csv("truth", csv.as_bytes(), nominal.kind()).expect("records");
            nominal.over(&records, None, |_, _| false).0
        };
        let csv = Case::null("turning", 3_000_100_214).records();
        let model = over(&csv);
        let measured = &model.frame().measured;
        let (basis, fit) = settled(model.as_ref(), Method::default());
        let (stated, _) = stated(model.as_ref(), &basis, &fit);
        let linear = Linear::new(model.as_ref(), Point::nominal(model.as_ref()));
        let scale = unstated_scales(measured, &linear.residual);
        for (channel, (scale, diagnosed)) in measured.channels.iter().zip(scale.iter().zip(&stated.noise.scale)) {
            assert!((scale / diagnosed - 1.0).abs() < 0.15, "{}: {scale} {diagnosed}", channel.id);
            assert_eq!(*scale > 3.0, channel.id == ChannelId::CycleTime, "{}: {scale}", channel.id);
        }
        // So less is promised of a time than the clock alone would show.
        let least = |model: &dyn Forward| {
            let rows = identifiability(model);
            rows.iter().find(|own| own.id == EffectId::OPERATOR_DELAY).expect("a delay").minimal_detectable
        };
        let head = csv.lines().next().expect("a header").split(',').position(|own| own.starts_with("cycle_time"));
        let planned = |(row, line): (usize, &str)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if let (Some(column), true) = (head, row > 0) {
                cells[column] = "100";
            }
            cells.join(",") + "\n"
        };
        let planned: String = csv.lines().enumerate().map(planned).collect();
        let (known, clock) = (least(model.as_ref()), least(over(&planned).as_ref()));
        assert!(known > 2.0 * clock, "{known} {clock}");
    }

    #[test]
    fn calibration_is_pushed_its_own_way_by_sizes_that_occur() {
        assert!(pushes(1.5, 5.0) && pushes(-1.5, -5.0));
        assert!(!pushes(-1.5, 5.0), "the effect would push it the other way");
        assert!(!pushes(1.0, 5.0), "five ordinary sizes are too many");
        assert!(!pushes(3.0, 3.5), "it did not go far");
    }
}
