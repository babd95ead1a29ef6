//! The whole way from a nominal model and records to a diagnosis.

use super::belief::{closed_by_constants, held_against, spares};
use super::budget::budget;
use super::class::class;
use super::closure::{closures, scored, standing_apart, touched};
use super::constants::{NINETY, PROBABLE_THOUGH_OFF, REPORTED_ALLOWANCE};
use super::decide::decide;
use super::decision::{Decision, Single};
use super::diagnosing::Diagnosing;
use super::discrepancy::Widened;
use super::evidence::{folds, gain, predictive_gain};
use super::fit_answer::WIDE;
use super::fitness::{exchangeable, tested};
use super::identifiability::{hidden, hidden_by_calibration};
use super::left_out::LeftOut;
use super::method::Bare;
use super::narrowed::Narrowed;
use super::probability::{inclusion, printed};
use super::settle::{settled, stated};
use super::trial::{Trial, shape_lead};
use super::verdict::{backed, doubted, unrejected};
use super::{
    Basis, Calibrated, Cell, Diagnosis, Fit, Forward, GapVerdict, Method, NamedEffect, NextExperiment, Ranked,
    Transform, Tried,
};
use rayon::prelude::*;
use toolroom_effects::Definition;

/// Cells of the map that are reported.
pub(super) const CELLS: usize = 12;

/// A diagnosis with what it rests on.
pub struct DiagnosisWithBasis {
    /// What it says.
    pub diagnosis: Diagnosis,
    /// The decision behind it.
    pub decision: Decision,
    /// Noise and scatter.
    pub basis: Basis,
    /// Residuals of groups left out: nominal model, and with the named effects.
    pub(super) held_out: [LeftOut; 2],
}

impl DiagnosisWithBasis {
    /// Candidates of the model that are named.
    pub fn named(&self) -> &[usize] {
        if self.diagnosis.effects.is_empty() { &[] } else { &self.decision.model().fit.active }
    }
}

/// Diagnoses the gap between `model` and what was measured. The same `seed` gives the same answer.
pub fn diagnose(model: &dyn Forward, seed: u64) -> DiagnosisWithBasis {
    diagnose_by(model, Method::default(), seed)
}

/// [`diagnose`] by parts of the method only.
pub fn diagnose_by(model: &dyn Forward, method: Method, seed: u64) -> DiagnosisWithBasis {
    if method.allowance && method.scatter {
        return diagnosed(model, method, seed);
    }
    diagnosed(&Bare::new(model, method), method, seed)
}

fn diagnosed(model: &dyn Forward, method: Method, seed: u64) -> DiagnosisWithBasis {
    let (basis, refit) = settled(model, method);
    if let Some(narrowed) = Narrowed::new(model, &basis, &refit) {
        let (basis, refit) = settled(&narrowed.model, method);
        let mut diagnosed = judged(&narrowed.model, basis, refit, seed);
        diagnosed.diagnosis.notes.push(narrowed.note());
        return diagnosed;
    }
    match Widened::new(model, &basis, &refit) {
        None => judged(model, basis, refit, seed),
        Some(widened) => {
            let (basis, refit) = settled(&widened.model, method);
            let mut diagnosed = judged(&widened.model, basis, refit, seed);
            diagnosed.diagnosis.notes.push(widened.note());
            if widened.far() {
                let effects = diagnosed.diagnosis.effects.iter_mut();
                effects.for_each(|effect| effect.probability = effect.probability.min(PROBABLE_THOUGH_OFF));
            }
            diagnosed
        }
    }
}

/// Said of a fit that came to no numbers.
const NOT_FITTED: &str = "the calibrated model has no finite prediction of these records, so that nothing was fitted: look for \
                          edges on which it would break long before they did";

/// What to say of named effects of which the file has some already: sizes are counted from that.
fn stated_effects(model: &dyn Forward, trial: &Trial) -> Vec<String> {
    let frame = model.frame();
    let words = |index: &usize| {
        let (_, stated) = frame.words.effects.iter().find(|(own, _)| own == index)?;
        let id = frame.candidates[*index].id;
        let (factor, unit) = id.report_units();
        let place = model.written(*index).scope.words();
        let (at, unit) = (if place.is_empty() { "" } else { " at " }, if unit == "1" { "" } else { unit });
        let [stated, whole] = [*stated, stated + trial.fit.linear.point.effects[*index]].map(|size| factor * size);
        Some(format!("{id}{at}{place}: the file states {stated:.4} {unit}, and in all it is {whole:.4} {unit}"))
    };
    trial.fit.active.iter().filter_map(words).collect()
}

/// The diagnosis by a nominal model that was calibrated.
fn judged(model: &dyn Forward, basis: Basis, refit: Fit, seed: u64) -> DiagnosisWithBasis {
    let folds = folds(&model.frame().measured);
    let context = Diagnosing { model, basis: &basis, folds: &folds, seed };
    let mut decision = decide(context, context.trial_of(refit));
    for _ in 0..RESTARTS {
        let Some(better) = restarted(context, &decision) else { break };
        decision = decide(context, better);
    }
    let left_out =
        if decision.verdict == GapVerdict::Effect { Diagnosing::left_out_with_moves } else { Diagnosing::left_out };
    let (base_left, chosen_left) = held_against(context, &decision.base, decision.model(), left_out);
    let measured = &model.frame().measured;
    let scored = scored(measured);
    let touched = touched(model, decision.model());
    let ((total, channels), (named, (hidden, tried))) = rayon::join(
        || closures(model, &basis, &base_left, &chosen_left, &scored, &touched, seed),
        || {
            let rest = || tried(context, &decision, &scored);
            rayon::join(|| named(context, &decision), || rayon::join(|| hidden(model, &basis, &decision.base), rest))
        },
    );
    let mut notes = decision.reasons.clone();
    notes.extend(stated_effects(model, decision.model()));
    if decision.verdict == GapVerdict::Unknown
        && let Some(best) = tried.first().filter(|best| best.gain > 0.0 && best.closure.closed > 0.0)
    {
        let (effects, closed) = (best.effects.join(" with "), 100.0 * best.closure.closed);
        notes.push(format!("{effects} would close {closed:.0} % of the gap on groups left out; that is no proof"));
    }
    // What is named is not hidden.
    let unnamed = hidden.iter().filter(|shown| named.iter().all(|effect| effect.id != shown.row.id));
    let masked = unnamed.map(|shown| shown.row.clone()).collect();
    let mut diagnosis = Diagnosis {
        verdict: decision.verdict,
        effects: named,
        cells: cells(model, &decision),
        total,
        channels,
        held_out: scored.iter().map(|group| measured.groups[*group].clone()).collect(),
        apart: standing_apart(model, &basis, [&base_left, &chosen_left], &scored),
        budget: budget(model, &decision),
        masked,
        next: NextExperiment::default(),
        calibration: calibration(model, &decision),
        ranking: ranking(model, &decision),
        tried,
        notes,
        fit: None,
        fit_with_effects: None,
        suspected: None,
        not_named: decision.not_named.clone(),
        facts: Vec::new(),
        findings: Vec::new(),
        dynamics: Vec::new(),
    };
    let known = decision.base.fit.cost.is_finite() && base_left.residual.iter().all(|left| left.is_finite());
    if !known {
        // No test of such a fit rejects anything: that is no absence of a gap.
        diagnosis.verdict = GapVerdict::CannotTell;
        diagnosis.effects.clear();
        diagnosis.notes.insert(0, NOT_FITTED.to_owned());
        return DiagnosisWithBasis { diagnosis, decision, basis, held_out: [base_left, chosen_left] };
    }
    let pushed = || hidden_by_calibration(model, &decision.base, &hidden);
    let stated_channels = (0..measured.channels.len()).any(|channel| model.scatter_is_known(channel));
    if basis.method.abstention && stated_channels {
        let (stated, fit) = stated(model, &basis, &decision.base.fit);
        let test = |fit: &Fit| tested(model, &stated, fit, &folds, seed);
        diagnosis.notes.extend(scattering(model, &stated));
        diagnosis.fit = Some(test(&fit));
        if decision.verdict == GapVerdict::Effect {
            diagnosis.fit_with_effects = Some(test(&decision.model().fit.clone().complete(model)));
        }
        let spared = diagnosis.verdict == GapVerdict::Effect && spares(context, &decision.base, decision.model());
        let asked = || decision.asked_for(context);
        backed(&mut diagnosis, pushed, asked, spared, || closed_by_constants(context, &decision.base));
    } else {
        if diagnosis.verdict == GapVerdict::NoGap {
            unrejected(&mut diagnosis, pushed);
        }
        if basis.method.abstention {
            let test = |fit: &Fit| exchangeable(model, &basis, &fit.clone().complete(model), &folds, seed);
            diagnosis.fit = Some(test(&decision.base.fit));
            if decision.verdict == GapVerdict::Effect {
                diagnosis.fit_with_effects = Some(test(&decision.model().fit));
            }
            let (structure, asked) = (decision.structure(model), || decision.asked_for(context));
            doubted(&mut diagnosis, structure, pushed, asked, || closed_by_constants(context, &decision.base));
        }
    }
    let far = diagnosis.far_gains();
    diagnosis.notes.extend(far);
    diagnosis.next = next(&diagnosis);
    DiagnosisWithBasis { diagnosis, decision, basis, held_out: [base_left, chosen_left] }
}

/// How much channels scatter of which nobody states it, where their sensors do not explain it.
fn scattering(model: &dyn Forward, basis: &Basis) -> Vec<String> {
    let measured = &model.frame().measured;
    let unstated = (0..measured.channels.len()).filter(|channel| measured.unstated[*channel]);
    let wide = unstated.filter(|channel| basis.noise.scale[*channel] > WIDE);
    let note = |channel: usize| {
        let (about, scale) = (&measured.channels[channel], basis.noise.scale[channel]);
        let places = measured.observations.iter().filter(|own| own.channel == channel);
        let mut sheet: Vec<f64> = places.map(|own| own.deviation).collect();
        let sheet = toolroom_statistics::median(&mut sheet);
        let ([all, sheet], unit) = ([scale * sheet, sheet], about.unit);
        format!(
            "{} scatters by {all:.3} {unit} from row to row, of which its sensor explains {sheet:.3} {unit}: the model gives \
             loading one time, so that the scatter was read off the records",
            about.id
        )
    };
    wide.map(note).collect()
}

/// What every fitted model would close, by falling gain.
fn tried(context: Diagnosing<'_>, decision: &Decision, scored: &[usize]) -> Vec<Tried> {
    let Diagnosing { model, basis, seed, .. } = context;
    let candidates = &model.frame().candidates;
    let word = |index: &usize| match candidates[*index].shape.as_str() {
        "" => candidates[*index].id.to_string(),
        shape => format!("{} ({shape})", candidates[*index].id),
    };
    let one = |trial: &Trial| {
        let (before, after) = held_against(context, &decision.base, trial, Diagnosing::left_out);
        Tried {
            effects: trial.fit.active.iter().map(word).collect(),
            gain: decision.gain_of(trial, candidates.len()),
            closure: closures(model, basis, &before, &after, scored, &[], seed).0,
        }
    };
    let admissible = decision.trials.par_iter().filter(|trial| trial.evidence.admissible);
    let mut tried: Vec<Tried> = admissible.map(one).collect();
    tried.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    tried
}

/// Times that the nominal model is fitted anew from the fits with effects.
const RESTARTS: usize = 3;

/// A better fit of the nominal model, started where the fits with effects ended: a model that lacks
/// something may have been caught far away, and its gap may not be blamed on an effect.
fn restarted(context: Diagnosing<'_>, decision: &Decision) -> Option<Trial> {
    let Diagnosing { model, basis, .. } = context;
    let near = |trial: &Trial| trial.fit.cost < decision.base.fit.cost - 1.0;
    let nearer: Vec<&Trial> = decision.trials.iter().filter(|trial| near(trial)).take(3).collect();
    let fits = nearer.into_par_iter().map(|trial| {
        let mut point = trial.fit.linear.point.clone();
        point.effects.iter_mut().for_each(|size| *size = 0.0);
        super::fit::fit(model, &basis.noise, super::Linear::with(model, point, &[]), &[], &basis.local_scale)
    });
    let best = fits.collect::<Vec<_>>().into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    (best.cost < decision.base.fit.cost - 1.0).then(|| context.trial_of(best.complete(model)))
}

fn named(context: Diagnosing<'_>, decision: &Decision) -> Vec<NamedEffect> {
    let model = context.model;
    if decision.verdict != GapVerdict::Effect {
        return Vec::new();
    }
    let trial = decision.model();
    let posterior = trial.deviations();
    let between = trial.jackknife();
    let probabilities = inclusion(context, decision);
    let scores = decision.base.scores();
    let value = decision.gain_of(trial, model.frame().candidates.len());
    let score = |index: &usize| {
        let candidate = &model.frame().candidates[*index];
        let by_means = scores.length[*index] * trial.fit.linear.point.effects[*index] / candidate.typical;
        by_means.hypot((2.0 * shape_lead(model, *index)).sqrt()).copysign(by_means)
    };
    let one = |(place, index): (usize, &usize)| {
        let candidate = &model.frame().candidates[*index];
        let size = trial.fit.linear.point.effects[*index];
        let deviation = posterior[place].max(between[place]) * candidate.typical;
        let (factor, unit) = candidate.id.report_units();
        let class = class(context, decision, trial, *index);
        let names = trial.fit.active.iter().map(|other| model.frame().candidates[*other].id);
        let others = class.iter().filter(|(id, _)| names.clone().all(|name| name != *id));
        let written = model.written(*index);
        NamedEffect {
            id: candidate.id,
            title: candidate.id.entry().title,
            empirical: written.definition.is_some_and(Definition::is_empirical),
            shape: candidate.shape.clone(),
            written,
            size: size * factor,
            unit,
            ci90: [(size - NINETY * deviation).max(candidate.least) * factor, (size + NINETY * deviation) * factor],
            probability: printed(&probabilities, candidate.id, score(index)),
            z: score(index),
            gain: [value, predictive_gain(&trial.evidence, &decision.base.evidence).0],
            class: std::iter::once(candidate.id).chain(others.clone().map(|(id, _)| *id)).collect(),
            class_reason: others.map(|(_, reason)| reason.clone()).collect::<Vec<_>>().join("; "),
        }
    };
    trial.fit.active.iter().enumerate().map(one).collect()
}

fn ranking(model: &dyn Forward, decision: &Decision) -> Vec<Ranked> {
    let scores = decision.base.scores();
    let price = (model.frame().candidates.len().max(1) as f64).ln() + decision.share;
    let one = |single: &Single| {
        let candidate = &model.frame().candidates[single.candidate];
        let (factor, unit) = candidate.id.report_units();
        let value = gain(&single.evidence, &decision.base.evidence);
        let (left_out, left_out_error) = predictive_gain(&single.evidence, &decision.base.evidence);
        let size = single.trial.map_or(scores.estimate[single.candidate] * candidate.typical, |trial| {
            decision.trials[trial].fit.linear.point.effects[single.candidate]
        });
        Ranked {
            id: candidate.id,
            shape: candidate.shape.clone(),
            size: size * factor,
            unit,
            z: single.score,
            gain: value - price,
            left_out: [left_out, left_out_error],
        }
    };
    decision.singles.iter().filter(|single| single.evidence.admissible).map(one).collect()
}

/// The strongest cells of the map, one for each pair of channel and covariate.
fn cells(model: &dyn Forward, decision: &Decision) -> Vec<Cell> {
    let measured = &model.frame().measured;
    let remainder = &decision.before;
    let mut order: Vec<usize> = (0..remainder.dictionary.len()).collect();
    order.sort_by(|a, b| remainder.scores.score[*b].abs().total_cmp(&remainder.scores.score[*a].abs()));
    let relative = |trial: &Trial, column: &[f64]| {
        let linear = &trial.fit.linear;
        let (mut sum, mut count) = (0.0, 0.0);
        let greatest = column.iter().fold(0.0_f64, |greatest, value| greatest.max(value.abs()));
        for (i, observation) in measured.observations.iter().enumerate() {
            if column[i].abs() < 0.5 * greatest || greatest == 0.0 {
                continue;
            }
            let value = match measured.channels[observation.channel].transform {
                Transform::Log => linear.residual[i],
                Transform::Linear => linear.residual[i] / linear.raw[i].abs().max(f64::MIN_POSITIVE),
            };
            sum += value * value;
            count += 1.0;
        }
        if count > 0.0 { (sum / count).sqrt() } else { f64::NAN }
    };
    let cell = |index: &usize| {
        let signature = &remainder.dictionary[*index];
        let (group, regime) = match signature.covariate.split_once('=') {
            Some(_) => (signature.covariate.clone(), "all".to_owned()),
            None => ("all".to_owned(), signature.covariate.clone()),
        };
        Cell {
            channel: signature.channel.clone(),
            group,
            regime,
            score: remainder.scores.score[*index],
            rms_before: relative(&decision.base, &signature.column),
            rms_after: relative(decision.model(), &signature.column),
        }
    };
    order
        .iter()
        .filter(|index| remainder.scores.score[**index].abs() > 0.5 * remainder.threshold)
        .take(CELLS)
        .map(cell)
        .collect()
}

fn calibration(model: &dyn Forward, decision: &Decision) -> Vec<Calibrated> {
    let point = &decision.model().fit.linear.point;
    let moved = point.parameters.iter().chain(&point.surfaces).copied();
    let parameters = model.frame().parameters.iter().map(|own| (&own.name, &own.role, own.deviation, false));
    let surfaces = model.frame().surfaces.iter().map(|own| (&own.name, &own.role, own.deviation, own.absolute));
    let mut list: Vec<Calibrated> = parameters
        .chain(surfaces)
        .zip(moved)
        .zip(decision.model().uncertainties())
        .filter(|(((_, role, ..), x), _)| !role.is_allowance() || x.abs() > REPORTED_ALLOWANCE)
        .map(|(((name, role, deviation, summand), x), uncertainty)| {
            let value = |x: f64| if summand { deviation * x } else { (deviation * x).exp() };
            Calibrated {
                parameter: name.clone(),
                value: value(x),
                ci90: [-NINETY, NINETY].map(|end| value(x + end * uncertainty)),
                prior_sd_moved: x,
                gain: role.is_gain(),
                constant: !role.is_allowance() && !role.is_gain(),
            }
        })
        .collect();
    list.sort_by(|a, b| b.prior_sd_moved.abs().total_cmp(&a.prior_sd_moved.abs()));
    list
}

fn next(diagnosis: &Diagnosis) -> NextExperiment {
    let confused = diagnosis.effects.iter().find(|effect| effect.class.len() > 1);
    if let Some(effect) = confused {
        let other = effect.class[1];
        let test = effect.id.entry().separating_test;
        let separates = vec![[effect.id.to_string(), other.to_string()]];
        return NextExperiment { design: format!("{test}; three times"), minutes: 60.0, separates };
    }
    let Some(masked) = diagnosis.masked.iter().find(|_| diagnosis.verdict != GapVerdict::Effect) else {
        return NextExperiment::default();
    };
    let confounder = masked.id.entry().confounder;
    NextExperiment {
        design: format!("{}; three times", masked.separating_test),
        minutes: 60.0,
        separates: vec![[masked.id.to_string(), confounder.to_owned()]],
    }
}
