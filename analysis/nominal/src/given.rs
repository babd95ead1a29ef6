//! A nominal model counted from what its file states.

use super::{Direction, EffectRefusal, Forward, Frame, Point, Transform, WrittenEffect};
use toolroom_innovations::Chain;

/// A model whose nominal point is what its file states.
pub(super) struct FileNominal {
    model: Box<dyn Forward>,
    frame: Frame,
    base: Point,
}

impl FileNominal {
    /// The model counted from what its file states; the model itself where that is nothing.
    pub fn around(model: Box<dyn Forward>) -> Box<dyn Forward> {
        let words = &model.frame().words;
        if words.parameters.is_empty() && words.surfaces.is_empty() && words.effects.is_empty() {
            return model;
        }
        let mut base = Point::nominal(model.as_ref());
        words.parameters.iter().for_each(|(i, x)| base.parameters[*i] = *x);
        words.surfaces.iter().for_each(|(i, x)| base.surfaces[*i] = *x);
        words.effects.iter().for_each(|(i, size)| base.effects[*i] = *size);
        let mut frame = model.frame().clone();
        // What is stated may not be there: sizes are bounded in all.
        for (i, size) in &words.effects {
            frame.candidates[*i].least -= size;
            frame.candidates[*i].greatest -= size;
        }
        Box::new(Self { model, frame, base })
    }

    fn from(&self, at: &Point) -> Point {
        let mut point = at.clone();
        point.parameters.iter_mut().zip(&self.base.parameters).for_each(|(x, base)| *x += base);
        point.effects.iter_mut().zip(&self.base.effects).for_each(|(size, base)| *size += base);
        point
    }

    /// Factor and summand that the stated surfaces give each observation.
    fn surfaces(&self) -> Vec<(f64, f64)> {
        let measured = &self.frame.measured;
        let mut both = vec![(0.0_f64, 0.0); measured.len()];
        for (surface, x) in self.frame.surfaces.iter().zip(&self.base.surfaces).filter(|(_, x)| **x != 0.0) {
            for (observation, (relative, absolute)) in measured.observations.iter().zip(&mut both) {
                if surface.channels.contains(&observation.channel) {
                    let value = surface.deviation * x * surface.feature[observation.row];
                    *(if surface.absolute { absolute } else { relative }) += value;
                }
            }
        }
        both.iter_mut().for_each(|(relative, _)| *relative = relative.exp());
        both
    }
}

impl Forward for FileNominal {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn simulate(&self, point: &Point) -> Vec<f64> {
        let mut raw = self.model.simulate(&self.from(point));
        raw.iter_mut().zip(self.surfaces()).for_each(|(raw, (factor, summand))| *raw = *raw * factor + summand);
        raw
    }

    fn slopes(&self, point: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        let surfaces = self.surfaces();
        let inner: Vec<f64> = raw.iter().zip(&surfaces).map(|(raw, (factor, add))| (raw - add) / factor).collect();
        let mut slopes = self.model.slopes(&self.from(point), &inner, along);
        for slope in &mut slopes {
            slope.iter_mut().zip(&surfaces).for_each(|(slope, (factor, _))| *slope *= factor);
        }
        slopes
    }

    fn refusal(&self, point: &Point) -> Option<EffectRefusal> {
        self.model.refusal(&self.from(point))
    }

    fn scatter_is_known(&self, channel: usize) -> bool {
        self.model.scatter_is_known(channel)
    }

    fn chains(&self, point: &Point) -> Vec<Chain> {
        let from = self.from(point);
        let mut chains = self.model.chains(&from);
        if chains.is_empty() || self.base.surfaces.iter().all(|x| *x == 0.0) {
            return chains;
        }
        // What a stated surface does to a value it does to its scatter.
        let (raw, surfaces) = (self.model.simulate(&from), self.surfaces());
        let measured = &self.frame.measured;
        let readings = chains.iter_mut().flat_map(|chain| &mut chain.rows).flat_map(|row| &mut row.readings);
        for reading in readings {
            let (factor, summand) = surfaces[reading.place];
            let value = raw[reading.place] * factor;
            let scale = match measured.channels[measured.observations[reading.place].channel].transform {
                Transform::Linear => factor,
                Transform::Log if value + summand > 0.0 => value / (value + summand),
                Transform::Log => 0.0,
            };
            reading.by = reading.by.map(|slope| slope * scale);
        }
        chains
    }

    fn written(&self, candidate: usize) -> WrittenEffect {
        self.model.written(candidate)
    }
}
