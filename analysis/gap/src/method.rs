//! Parts of the method that can be left out, to show what they are worth.

use super::{Direction, Forward, Frame, Point};
use toolroom_innovations::Chain;
use toolroom_nominal::{EffectRefusal, WrittenEffect};

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
    /// Factors that differ from group to group, such as the wear of an edge.
    pub scatter: bool,
    /// Whether groups have to agree on the size of an effect.
    pub agreement: bool,
    /// Correlation of neighbouring readings, and less weight for outliers.
    pub memory: bool,
    /// Processes of the data set that are asked together: each has an equal share of the error.
    pub processes: usize,
}

impl Method {
    /// All parts, for one process.
    pub const WHOLE: Self = Self {
        allowance: true,
        abstention: true,
        tolerance: true,
        scatter: true,
        agreement: true,
        memory: true,
        processes: 1,
    };

    /// What a name pays for having been chosen among several processes.
    pub(super) fn share(self) -> f64 {
        (self.processes.max(1) as f64).ln()
    }
}

impl Default for Method {
    fn default() -> Self {
        Self::WHOLE
    }
}

/// A model without its form allowance, or without factors of groups.
pub struct Bare<'a> {
    model: &'a dyn Forward,
    frame: Frame,
    /// Parameters and surfaces that are left.
    kept: [Vec<usize>; 2],
}

impl<'a> Bare<'a> {
    /// The model with the parts that `method` keeps.
    pub(super) fn new(model: &'a dyn Forward, method: Method) -> Self {
        let mut bare = Self::keeping(model, |_, allowance| method.allowance || !allowance);
        if !method.allowance {
            bare.frame.discrepancy = None;
        }
        if !method.scatter {
            bare.frame.locals.clear();
        }
        bare
    }

    /// The model with those parameters and surfaces only for which `keep` says so: it is asked for a name and
    /// whether that is part of the form allowance.
    pub fn keeping(model: &'a dyn Forward, keep: impl Fn(&str, bool) -> bool) -> Self {
        let mut frame = model.frame().clone();
        let parameters = (0..frame.parameters.len())
            .filter(|i| keep(&frame.parameters[*i].name, frame.parameters[*i].role.is_allowance()))
            .collect();
        let surfaces = (0..frame.surfaces.len())
            .filter(|i| keep(&frame.surfaces[*i].name, frame.surfaces[*i].role.is_allowance()))
            .collect();
        frame.parameters.retain(|own| keep(&own.name, own.role.is_allowance()));
        frame.surfaces.retain(|own| keep(&own.name, own.role.is_allowance()));
        Self { model, frame, kept: [parameters, surfaces] }
    }

    /// The point of this model at a point of the whole one; what was left out is dropped.
    pub fn part(&self, whole: &Point) -> Point {
        let kept_of = |kept: &[usize], all: &[f64]| kept.iter().map(|i| all.get(*i).copied().unwrap_or(0.0)).collect();
        Point {
            parameters: kept_of(&self.kept[0], &whole.parameters),
            surfaces: kept_of(&self.kept[1], &whole.surfaces),
            ..whole.clone()
        }
    }

    /// The point of the whole model: what was left out is zero.
    pub fn whole(&self, point: &Point) -> Point {
        let mut whole = Point::nominal(self.model);
        self.kept[0].iter().zip(&point.parameters).for_each(|(i, x)| whole.parameters[*i] = *x);
        self.kept[1].iter().zip(&point.surfaces).for_each(|(i, x)| whole.surfaces[*i] = *x);
        whole.effects.clone_from(&point.effects);
        whole.locals.iter_mut().zip(&point.locals).for_each(|(all, own)| all.clone_from(own));
        whole
    }
}

impl Forward for Bare<'_> {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn simulate(&self, point: &Point) -> Vec<f64> {
        self.model.simulate(&self.whole(point))
    }

    fn refusal(&self, point: &Point) -> Option<EffectRefusal> {
        self.model.refusal(&self.whole(point))
    }

    fn scatter_is_known(&self, channel: usize) -> bool {
        self.model.scatter_is_known(channel)
    }

    fn chains(&self, point: &Point) -> Vec<Chain> {
        if self.frame.locals.is_empty() { Vec::new() } else { self.model.chains(&self.whole(point)) }
    }

    fn slopes(&self, point: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        let along: Vec<Direction> = along
            .iter()
            .map(|direction| match direction {
                Direction::Parameter(i) => Direction::Parameter(self.kept[0][*i]),
                Direction::Effect(_) | Direction::Local(_) => *direction,
            })
            .collect();
        self.model.slopes(&self.whole(point), raw, &along)
    }

    fn written(&self, candidate: usize) -> WrittenEffect {
        self.model.written(candidate)
    }
}
