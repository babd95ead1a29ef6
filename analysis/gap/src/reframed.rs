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

    fn simulate(&self, point: &Point) -> Vec<f64> {
        self.model.simulate(point)
    }

    fn refusal(&self, point: &Point) -> Option<EffectRefusal> {
        self.model.refusal(point)
    }

    fn scatter_is_known(&self, channel: usize) -> bool {
        self.model.scatter_is_known(channel)
    }

    fn chains(&self, point: &Point) -> Vec<Chain> {
        self.model.chains(point)
    }

    fn slopes(&self, point: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        self.model.slopes(point, raw, along)
    }

    fn written(&self, candidate: usize) -> WrittenEffect {
        self.model.written(candidate)
    }
}
