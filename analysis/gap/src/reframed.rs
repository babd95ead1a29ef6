//! A model beside which something else is stated.

use super::{Direction, Forward, Frame, Point};
use toolroom_innovations::Chain;
use toolroom_nominal::{EffectRefusal, WrittenEffect};

/// A model with another frame: the same parameters and effects in the same order, over the same rows.
pub(super) struct Reframed<'a> {
    pub model: &'a dyn Forward,
    pub frame: Frame,
}

impl Forward for Reframed<'_> {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn simulate(&self, at: &Point) -> Vec<f64> {
        self.model.simulate(at)
    }

    fn refusal(&self, at: &Point) -> Option<EffectRefusal> {
        self.model.refusal(at)
    }

    fn scatter_is_known(&self, channel: usize) -> bool {
        self.model.scatter_is_known(channel)
    }

    fn chains(&self, at: &Point) -> Vec<Chain> {
        self.model.chains(at)
    }

    fn slopes(&self, at: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        self.model.slopes(at, raw, along)
    }

    fn written(&self, candidate: usize) -> WrittenEffect {
        self.model.written(candidate)
    }
}
