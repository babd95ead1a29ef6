//! Closure on groups that were kept out of a fit: what a diagnosis said of the closure is held against it.

use super::belief::held_against;
use super::closure::closures;
use super::diagnosing::Diagnosing;
use super::fit::fit;
use super::reframed::Reframed;
use super::settle::settled;
use super::trial::Trial;
use super::{Basis, ChannelId, Closure, Forward, Linear, Method};

/// Closure on groups that were kept out of the fit, of any effects that one asks about: by how much
/// an effect that is known to be there would close the gap.
pub struct Outside<'a> {
    model: &'a dyn Forward,
    basis: Basis,
    base: Trial,
    groups: Vec<usize>,
}

impl<'a> Outside<'a> {
    /// Fits the nominal model to the groups that are to be fitted; `None` where none is kept out.
    pub fn new(model: &'a dyn Forward) -> Option<Self> {
        let measured = &model.frame().measured;
        let kept_out = |group: &usize| !measured.fitted[*group] && !measured.spans[*group].is_empty();
        let groups: Vec<usize> = (0..measured.groups.len()).filter(kept_out).collect();
        if groups.is_empty() {
            return None;
        }
        let (basis, fit) = settled(model, Method::default());
        let base = Trial::of(model, &basis, &[], fit);
        Some(Self { model, basis, base, groups })
    }

    /// Closure of the candidates `active` over the channels `touched`, and what their fit costs. As in a diagnosis, the
    /// model without them is the best fit that can be found, and held within belief.
    pub fn closure(&self, active: &[usize], touched: &[ChannelId], seed: u64) -> (Closure, f64) {
        let (model, basis) = (self.model, &self.basis);
        let context = Diagnosing { model, basis, folds: &[], seed };
        let trial = context.trial(&self.base.fit, active);
        let nearer = self.nearer(context, &trial);
        let base = nearer.as_ref().unwrap_or(&self.base);
        let (before, after) = held_against(context, base, &trial, Diagnosing::left_out);
        let (total, _) = closures(model, basis, &before, &after, &self.groups, touched, seed);
        (total, trial.fit.cost)
    }

    /// A better fit of the nominal model that starts where `trial` ended; `None` where it is none.
    fn nearer(&self, context: Diagnosing<'_>, trial: &Trial) -> Option<Trial> {
        let mut point = trial.fit.linear.point.clone();
        point.effects.iter_mut().for_each(|size| *size = 0.0);
        let start = Linear::with(self.model, point, &[]);
        let found = fit(self.model, &self.basis.noise, start, &[], &self.basis.local_scale);
        (found.cost < self.base.fit.cost).then(|| context.trial_of(found.settled(self.model)))
    }

    /// Size (SI) of the candidate `index` that the groups kept out ask for by themselves.
    pub fn size(&self, index: usize) -> f64 {
        let mut frame = self.model.frame().clone();
        frame.measured.fitted.iter_mut().for_each(|fitted| *fitted = !*fitted);
        let turned = Reframed { model: self.model, frame };
        let trial = Trial::new(&turned, &self.basis, &[], &self.base.fit, &[index]);
        trial.fit.linear.point.effects[index]
    }
}
