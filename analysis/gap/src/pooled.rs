//! Closure over several models that were diagnosed by themselves.

use super::closure::{FITS, Sums, closure, counted, huber, scored, standardised};
use super::left_out::LeftOut;
use super::measures::ResidualPair;
use super::{ChannelId, Closure, DiagnosisWithBasis, Forward};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Closure over several models, in units of noise; those of one process share groups of one name.
/// Where an effect is named only the channels count that it touches.
pub fn pooled(parts: &[(usize, &dyn Forward, &DiagnosisWithBasis)], seed: u64) -> Closure {
    let sums = |draw: Option<usize>| {
        let mut sums: BTreeMap<(usize, &str), [f64; 4]> = BTreeMap::new();
        for (process, model, diagnosed) in parts {
            let measured = &model.frame().measured;
            let residuals_of =
                |left: &LeftOut| draw.map_or_else(|| left.residual.clone(), |draw| left.drawn(seed, draw));
            let [base, chosen] = [&diagnosed.held_out[0], &diagnosed.held_out[1]].map(residuals_of);
            let counts = counted(measured, &touched(diagnosed));
            for group in scored(measured) {
                let sum = sums.entry((*process, measured.groups[group].as_str())).or_default();
                for i in measured.spans[group].clone().filter(|i| counts[measured.observations[*i].channel]) {
                    let unit = diagnosed.basis.noise.deviation(measured, i);
                    let terms = [huber(base[i] / unit), huber(chosen[i] / unit), 1.0, 1.0];
                    sum.iter_mut().zip(terms).for_each(|(sum, value)| *sum += value);
                }
            }
        }
        let column = |at: usize| sums.values().map(|own| own[at]).collect();
        Sums { before: column(0), after: column(1), floor: column(2), count: column(3) }
    };
    let fits: Vec<Sums> = (0..FITS).into_par_iter().map(|draw| sums(Some(draw))).collect();
    let left: Vec<ResidualPair> = parts
        .iter()
        .flat_map(|(_, model, diagnosed)| {
            let [base, chosen] = &diagnosed.held_out;
            standardised(*model, &diagnosed.basis, [base, chosen], &touched(diagnosed))
        })
        .collect();
    closure(&sums(None), &fits.iter().collect::<Vec<_>>(), &left, seed)
}

/// Channels that the named effects touch.
fn touched(diagnosed: &DiagnosisWithBasis) -> Vec<ChannelId> {
    diagnosed.diagnosis.effects.iter().flat_map(|effect| effect.id.channels()).collect()
}
