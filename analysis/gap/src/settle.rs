//! Noise and scatter that a diagnosis starts from, and the nominal model calibrated beside them.

use super::constants::DETECTABLE;
use super::fit::fit;
use super::trial::Trial;
use super::{Basis, Fit, Forward, Method};

/// Times that the noise is read off anew.
const NOISES: usize = 3;

/// Noise and scatter as the data show them, and the nominal model calibrated beside them.
pub(super) fn settled(model: &dyn Forward, method: Method) -> (Basis, Fit) {
    let sheet = Basis::of_sheet(model, method);
    let first = sheet.start(model);
    let rough = Basis::new(model, &first, &sheet);
    // A strong effect may not be taken for noise: the noise is read off beside the best effect, again
    // as long as it falls, since what is best is judged by the noise.
    let mut probe = Trial::of(model, &rough, &[], first);
    let mut basis = beside_best(model, &rough, &probe);
    for _ in 0..NOISES {
        let fit = fit(model, &basis.noise, probe.fit.linear.clone(), &[], &basis.local_scale);
        probe = Trial::of(model, &basis, &[], fit.complete(model));
        let next = beside_best(model, &basis, &probe);
        let fell = basis.noise.scale.iter().zip(&next.noise.scale).any(|(before, after)| *after < 0.8 * before);
        if !fell {
            break;
        }
        basis = next;
    }
    let refit = fit(model, &basis.noise, probe.fit.linear, &[], &basis.local_scale).complete(model);
    (basis, refit)
}

/// The noise of the sensor sheet and the scatter of the scenario, by which a fit is tested; the scatter between groups
/// that nobody states is that of `basis`, and so is that of channels of which nobody states it.
pub(super) fn stated(model: &dyn Forward, basis: &Basis, fit: &Fit) -> (Basis, Fit) {
    let mut stated = Basis::unmeasured(model, basis.method, basis.nominal.clone());
    stated.local_scale.clone_from(&basis.local_scale);
    let measured = &model.frame().measured;
    stated.noise = stated.noise.with_unstated(measured, &basis.noise);
    let fit = super::fit::fit(model, &stated.noise, fit.linear.clone(), &[], &stated.local_scale);
    let fit = fit.with_slopes_of_usual_groups(model);
    // Wear moves its own scatter along: the chains are those of the fit.
    let chains = model.chains(&fit.linear.point);
    let noise = super::Noise::at_predictions(measured, &fit.linear.residual, chains);
    stated.noise = noise.with_unstated(measured, &basis.noise);
    (stated, fit)
}

/// Noise and scatter beside the candidate that `probe`, a fit of the nominal model, asks for most.
fn beside_best(model: &dyn Forward, basis: &Basis, probe: &Trial) -> Basis {
    let scores = probe.strengths();
    let best = (0..scores.len()).max_by(|a, b| scores[*a].total_cmp(&scores[*b]));
    match best.filter(|index| scores[*index] > DETECTABLE) {
        Some(index) => {
            let best = Trial::fitted(model, basis, &probe.fit, &[index]);
            Basis::new(model, &best.complete(model), basis)
        }
        None => Basis::new(model, &probe.fit, basis),
    }
}
