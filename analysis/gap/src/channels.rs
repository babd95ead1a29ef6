//! Channels that are models of their own, diagnosed one by one and answered for together.

use super::constants::GATE;
use super::diagnose::{CELLS, DiagnosisWithBasis, diagnose_by};
use super::enough::too_little;
use super::pooled::pooled;
use super::{Budget, Diagnosis, Fitness, Forward, GapVerdict, Method, NextExperiment};

/// Diagnoses parts that know nothing of each other, such as the channels of an empirical model.
/// Effects of several parts carry the channel in their shape, and pay for the choice among them. Where
/// fewer than two groups or fewer than eight values of any channel were measured, that is the answer.
pub fn diagnose_parts(parts: &[Box<dyn Forward>], seed: u64) -> Diagnosis {
    diagnose_among(parts, 1, seed).0
}

/// [`diagnose_parts`] of one of `processes` of a data set, with what the answer rests on.
pub(super) fn diagnose_among(
    parts: &[Box<dyn Forward>],
    processes: usize,
    seed: u64,
) -> (Diagnosis, Vec<DiagnosisWithBasis>) {
    if let Some(why) = too_little(parts) {
        return (Diagnosis::cannot_tell(why), Vec::new());
    }
    let method = Method { processes, ..Method::default() };
    let mut diagnosed: Vec<DiagnosisWithBasis> =
        parts.iter().map(|part| diagnose_by(part.as_ref(), method, seed)).collect();
    if diagnosed.len() == 1 {
        return (diagnosed[0].diagnosis.clone(), diagnosed);
    }
    let names: Vec<String> = parts.iter().map(|part| name(part.as_ref())).collect();
    for (each, name) in diagnosed.iter_mut().zip(&names) {
        label(&mut each.diagnosis, name, parts.len());
    }
    (merged(parts, &diagnosed, seed), diagnosed)
}

fn name(part: &dyn Forward) -> String {
    part.frame().measured.channels.first().map_or_else(String::new, |channel| channel.id.to_string())
}

/// Says of which channel everything is; an effect has to pay for the choice among the channels.
fn label(diagnosis: &mut Diagnosis, name: &str, count: usize) {
    let shaped = |shape: &str| if shape.is_empty() { name.to_owned() } else { format!("{name}, {shape}") };
    let paid = GATE + (count as f64).ln();
    if diagnosis.effects.iter().any(|effect| effect.gain[0] < paid) {
        diagnosis.effects.clear();
        diagnosis.verdict = GapVerdict::Unknown;
        diagnosis.notes.push("no effect pays for the choice among the channels".to_owned());
    }
    diagnosis.effects.iter_mut().for_each(|effect| effect.shape = shaped(&effect.shape));
    diagnosis.masked.iter_mut().for_each(|masked| masked.shape = shaped(&masked.shape));
    for tried in &mut diagnosis.tried {
        tried.effects.iter_mut().for_each(|effect| *effect = format!("{name}: {effect}"));
    }
    diagnosis.ranking.iter_mut().for_each(|ranked| ranked.shape = shaped(&ranked.shape));
    diagnosis.notes.iter_mut().for_each(|note| *note = format!("{name}: {note}"));
}

fn merged(parts: &[Box<dyn Forward>], diagnosed: &[DiagnosisWithBasis], seed: u64) -> Diagnosis {
    let each = || diagnosed.iter().map(|each| &each.diagnosis);
    let verdict = GapVerdict::of_all(each().map(|own| own.verdict));
    let named: Vec<usize> = (0..parts.len()).filter(|i| !diagnosed[*i].diagnosis.effects.is_empty()).collect();
    let counted: Vec<usize> = if named.is_empty() { (0..parts.len()).collect() } else { named };
    let pool: Vec<(usize, &dyn Forward, &DiagnosisWithBasis)> =
        counted.iter().map(|i| (0, parts[*i].as_ref(), &diagnosed[*i])).collect();
    let mut cells: Vec<_> = each().flat_map(|own| own.cells.clone()).collect();
    cells.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()));
    cells.truncate(CELLS);
    let mut calibration: Vec<_> = each().flat_map(|own| own.calibration.clone()).collect();
    calibration.sort_by(|a, b| b.prior_sd_moved.abs().total_cmp(&a.prior_sd_moved.abs()));
    let mut ranking: Vec<_> = each().flat_map(|own| own.ranking.clone()).collect();
    ranking.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut held_out: Vec<String> = Vec::new();
    for group in each().flat_map(|own| &own.held_out) {
        if !held_out.contains(group) {
            held_out.push(group.clone());
        }
    }
    let next = each().map(|own| &own.next).find(|next| !next.design.is_empty());
    Diagnosis {
        verdict,
        effects: each().flat_map(|own| own.effects.clone()).collect(),
        cells,
        total: pooled(&pool, seed),
        channels: each().flat_map(|own| own.channels.clone()).collect(),
        held_out,
        apart: each().flat_map(|own| own.apart.clone()).collect(),
        budget: mean_budget(each()),
        masked: each().flat_map(|own| own.masked.clone()).collect(),
        next: next.cloned().unwrap_or_else(NextExperiment::default),
        calibration,
        ranking,
        tried: each().flat_map(|own| own.tried.clone()).collect(),
        notes: each().flat_map(|own| own.notes.clone()).collect(),
        fit: Fitness::together(each().filter_map(|own| own.fit.as_ref())),
        fit_with_effects: Fitness::together(each().filter_map(|own| own.fit_with_effects.as_ref())),
        suspected: each().find_map(|own| own.suspected.clone()).filter(|_| verdict == GapVerdict::Masked),
        not_named: each().flat_map(|own| own.not_named.clone()).collect(),
        facts: Vec::new(),
        findings: Vec::new(),
        dynamics: Vec::new(),
    }
}

/// Every channel or process of which something is known counts alike.
pub(super) fn mean_budget<'a>(each: impl Iterator<Item = &'a Diagnosis>) -> Budget {
    let mut sum = Budget::default();
    let mut count = 0.0;
    for own in each.filter(|own| own.verdict != GapVerdict::CannotTell) {
        let budget = &own.budget;
        sum.calibration += budget.calibration;
        sum.form_allowance += budget.form_allowance;
        sum.effects += budget.effects;
        sum.unexplained += budget.unexplained;
        sum.noise_floor += budget.noise_floor;
        count += 1.0;
    }
    Budget {
        calibration: sum.calibration / count,
        form_allowance: sum.form_allowance / count,
        effects: sum.effects / count,
        unexplained: sum.unexplained / count,
        noise_floor: sum.noise_floor / count,
    }
}
