//! Parts of the method that can be left out, to show what they are worth.

use super::{Direction, Forward, Frame, Point};

/// Which parts of the method take part. The diagnosis uses all of them; the blind benchmark leaves
/// them out one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// The form allowance: equations may be a few per cent wrong.
    pub allowance: bool,
    /// "Unknown" where structure is left that no effect explains.
    pub abstention: bool,
    /// The form tolerance: so may the function of a named effect.
    pub tolerance: bool,
    /// Correlation of neighbouring readings, and less weight for outliers.
    pub memory: bool,
    /// Processes of the data set that are asked together: each has an equal share of the error.
    pub processes: usize,
}

impl Method {
    /// What a name pays for having been chosen among several processes.
    pub(super) fn share(self) -> f64 {
        (self.processes.max(1) as f64).ln()
    }
}

impl Default for Method {
    fn default() -> Self {
        Self { allowance: true, abstention: true, tolerance: true, memory: true, processes: 1 }
    }
}

/// A model without its form allowance.
pub(super) struct Bare<'a> {
    model: &'a dyn Forward,
    frame: Frame,
    /// Parameters that are no allowance.
    kept: Vec<usize>,
}

impl<'a> Bare<'a> {
    pub fn new(model: &'a dyn Forward) -> Self {
        let mut frame = model.frame().clone();
        let kept = (0..frame.parameters.len()).filter(|i| !frame.parameters[*i].allowance).collect();
        frame.parameters.retain(|parameter| !parameter.allowance);
        frame.surfaces.retain(|surface| !surface.allowance);
        Self { model, frame, kept }
    }

    /// The point of the whole model: its allowance is zero.
    fn whole(&self, at: &Point) -> Point {
        let mut parameters = vec![0.0; self.model.frame().parameters.len()];
        self.kept.iter().zip(&at.parameters).for_each(|(i, x)| parameters[*i] = *x);
        let surfaces = vec![0.0; self.model.frame().surfaces.len()];
        Point { parameters, surfaces, ..at.clone() }
    }
}

impl Forward for Bare<'_> {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn simulate(&self, at: &Point) -> Vec<f64> {
        self.model.simulate(&self.whole(at))
    }

    fn slopes(&self, at: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        let along: Vec<Direction> = along
            .iter()
            .map(|direction| match direction {
                Direction::Parameter(i) => Direction::Parameter(self.kept[*i]),
                other => *other,
            })
            .collect();
        self.model.slopes(&self.whole(at), raw, &along)
    }
}
