//! The applied point of a diagnosis.

use crate::predict::{Prediction, at};
use nalgebra::DMatrix;
use toolroom_gap::{
    Bare, Basis, EFFECT_PRIOR, EffectId, Forward, Linear, Movable, Point, WrittenEffect, fit, normal_equations,
};
use toolroom_scenario::{Calibration, CalibrationShift};

/// A constant that the applied point moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Constant {
    /// How a scenario says it.
    pub movable: Movable,
    /// Factor on the value of the model that was read, or summand, SI.
    pub value: f64,
    /// Root mean square distance of the logarithm of the factor, or of the summand, from this value over what the
    /// data leave open where the equations may be off by the form allowance.
    pub standard_error: f64,
    /// Standard deviation of the same before any data.
    pub prior: f64,
    /// Distance moved, in standard deviations before these data.
    pub moved: f64,
}

/// An effect of the applied point.
#[derive(Clone, Debug, PartialEq)]
pub struct AppliedEffect {
    /// The effect.
    pub id: EffectId,
    /// Candidate of the model.
    pub candidate: usize,
    /// How a scenario says it.
    pub written_effect: WrittenEffect,
    /// Size in all, that of the model included, SI.
    pub size: f64,
    /// Standard error, SI.
    pub standard_error: f64,
    /// Whether it is no effect but a constant of a part of the records, which stands among the calibration.
    pub is_constant: bool,
}

/// Calibration and effects that a scenario can hold, refitted without form allowance.
#[derive(Clone, Debug, PartialEq)]
pub struct Applied {
    /// Constants that moved.
    pub calibration: Vec<Constant>,
    /// Named effects.
    pub effects: Vec<AppliedEffect>,
    /// Names of the covariance: parameters, then effects with `.size`.
    pub names: Vec<String>,
    /// Covariance of logarithms of factors, summands and sizes, SI.
    pub covariance: DMatrix<f64>,
    /// Predictions of the model that was read, of its calibration alone, and of the applied point.
    pub predictions: [Vec<Prediction>; 3],
    /// Terms of the fit that no scenario can hold: at zero in all predictions.
    pub left: Vec<String>,
}

/// The applied point of a model with the named effects `active`; `aside` is the calibration of the file that was not
/// counted because these records had been seen by it, and `nominal` the model that does count it. `near` are the points
/// of the diagnosis without and with the effects, where it has come to any: an effect under which wear runs away is not
/// found again from the nominal point.
pub fn applied_to(
    model: &dyn Forward,
    nominal: &dyn Forward,
    aside: &[Calibration],
    basis: &Basis,
    active: &[usize],
    near: Option<[&Point; 2]>,
) -> Applied {
    let frame = model.frame();
    let keep = |name: &str, allowance: bool| !allowance && frame.words.of(name).is_some();
    let bare = Bare::keeping(model, keep);
    let [without, with] = near.map_or([None, None], |points| points.map(Some));
    let (calibrated, _) = fitted(&bare, basis, &[], without.map(|near| bare.part(near)));
    let (point, linear) = fitted(&bare, basis, active, with.map(|near| bare.part(near)));
    let own = bare.frame();
    let names: Vec<(&str, f64)> = own
        .parameters
        .iter()
        .map(|parameter| (parameter.name.as_str(), parameter.deviation))
        .chain(own.surfaces.iter().map(|surface| (surface.name.as_str(), surface.deviation)))
        .collect();
    let scales: Vec<f64> = names
        .iter()
        .map(|(_, deviation)| *deviation)
        .chain(active.iter().map(|index| frame.candidates[*index].typical))
        .collect();
    let spread = posterior(&bare, basis, &linear, active);
    let covariance = DMatrix::from_fn(scales.len(), scales.len(), |i, j| spread[(i, j)] * scales[i] * scales[j]);
    let moved: Vec<f64> = point.parameters.iter().chain(&point.surfaces).copied().collect();
    let open = left_open(model, basis, active, with);
    let constant = |(i, (name, deviation)): (usize, &(&str, f64))| {
        let movable = frame.words.of(name)?.clone();
        let shift = deviation * moved[i];
        let value = match (movable.summand, movable.inverse) {
            (true, _) => shift,
            (false, false) => shift.exp(),
            (false, true) => (-shift).exp(),
        };
        // What the file states of it already is part of the way to the end of its range.
        let stated = stated_shift(frame, name).exp();
        let value = if movable.summand { value } else { clamped(value, movable.range.map(|end| end / stated)) };
        let before = aside.iter().find(|own| {
            own.parameter == movable.parameter && own.target == movable.target && own.scope == movable.scope
        });
        let value = match before.map(|own| own.moved) {
            Some(CalibrationShift::Factor(factor)) if !movable.summand => value / factor,
            Some(CalibrationShift::Summand(summand)) if movable.summand => value - summand,
            Some(CalibrationShift::Factor(_) | CalibrationShift::Summand(_)) | None => value,
        };
        let own = open.iter().find(|(own, ..)| own == name);
        let standard_error =
            own.map_or(covariance[(i, i)].max(0.0).sqrt(), |(_, x, error)| deviation * (x - moved[i]).hypot(*error));
        let prior = before.and_then(|own| own.prior).unwrap_or(*deviation);
        (shift != 0.0).then_some(Constant { movable, value, standard_error, prior, moved: moved[i] })
    };
    let mut calibration: Vec<Constant> = names.iter().enumerate().filter_map(constant).collect();
    let base = |index: usize| frame.words.effects.iter().find(|(own, _)| *own == index).map_or(0.0, |(_, size)| *size);
    let effect = |(place, index): (usize, &usize)| AppliedEffect {
        id: frame.candidates[*index].id,
        candidate: *index,
        written_effect: model.written(*index),
        size: base(*index) + point.effects[*index],
        standard_error: covariance[(names.len() + place, names.len() + place)].max(0.0).sqrt(),
        is_constant: false,
    };
    let mut effects: Vec<AppliedEffect> = active.iter().enumerate().map(effect).collect();
    for effect in &mut effects {
        // A file that says it as an effect keeps it there.
        let rate = rate_of_part(frame, effect).filter(|_| base(effect.candidate) == 0.0);
        effect.is_constant = rate.is_some();
        calibration.extend(rate);
    }
    let mut words: Vec<String> = names
        .iter()
        .map(|(name, _)| frame.words.of(name).map_or_else(|| (*name).to_owned(), |own| own.parameter.clone()))
        .collect();
    words.extend(effects.iter().map(|found| format!("{}.size", found.id)));
    let left = frame
        .parameters
        .iter()
        .map(|own| (&own.name, own.role.is_allowance()))
        .chain(frame.surfaces.iter().map(|own| (&own.name, own.role.is_allowance())))
        .filter(|(name, allowance)| !allowance && frame.words.of(name).is_none())
        .map(|(name, _)| name.clone())
        .collect();
    let predictions =
        [at(nominal, &Point::nominal(nominal)), at(model, &bare.whole(&calibrated)), at(model, &bare.whole(&point))];
    Applied { calibration, effects, names: words, covariance, predictions, left }
}

/// The rate of wear that is another one on a part of the records, as the constant `wear_rate` of the tool with that scope.
fn rate_of_part(frame: &toolroom_gap::Frame, found: &AppliedEffect) -> Option<Constant> {
    const RATE: &str = "wear_rate";
    let everywhere = |own: &&Movable| own.parameter == RATE && own.scope.is_everywhere();
    let target = frame.words.movable.iter().map(|(_, movable)| movable).find(everywhere)?.target.clone();
    let factor = 1.0 + found.size;
    if !found.id.is_wear_rate() || factor <= 0.0 {
        return None;
    }
    // What is believed of it before any data is its ordinary size.
    let prior = frame.candidates[found.candidate].typical.ln_1p();
    let movable = Movable { scope: found.written_effect.scope.clone(), ..Movable::factor(RATE, target) };
    let standard_error = found.standard_error / factor;
    Some(Constant { movable, value: factor, standard_error, prior, moved: factor.ln() / prior })
}

/// A factor within a range.
fn clamped(value: f64, [least, greatest]: [f64; 2]) -> f64 {
    if least <= greatest { value.clamp(least, greatest) } else { value }
}

/// Logarithm of the factor that the file states of the parameter called `name`.
fn stated_shift(frame: &toolroom_gap::Frame, name: &str) -> f64 {
    let index = frame.parameters.iter().position(|own| own.name == name);
    let stated = frame.words.parameters.iter().find(|(own, _)| Some(*own) == index);
    stated.map_or(0.0, |(own, x)| frame.parameters[*own].deviation * x)
}

/// Parameters and surfaces by name, with their place and its standard error, in prior standard deviations, where the
/// form allowance takes part. The applied point has the allowance at zero: a constant may stand in for it there, and
/// other records will not let it.
fn left_open(model: &dyn Forward, basis: &Basis, active: &[usize], near: Option<&Point>) -> Vec<(String, f64, f64)> {
    // A discrepancy that the diagnosis added stands behind the surfaces of the model.
    let own = |near: &Point| {
        let surfaces = near.surfaces[..model.frame().surfaces.len().min(near.surfaces.len())].to_vec();
        Point { surfaces, ..near.clone() }
    };
    let (point, linear) = fitted(model, basis, active, near.map(own));
    let spread = posterior(model, basis, &linear, active);
    let frame = model.frame();
    let names = frame.parameters.iter().map(|own| &own.name).chain(frame.surfaces.iter().map(|own| &own.name));
    let places = point.parameters.iter().chain(&point.surfaces);
    let one = |(i, (name, x)): (usize, (&String, &f64))| (name.clone(), *x, spread[(i, i)].max(0.0).sqrt());
    names.zip(places).enumerate().map(one).collect()
}

/// The posterior mode of a model with the `active` candidates, started from its nominal point, from where edges are
/// near their readings, and from `near`.
fn fitted(model: &dyn Forward, basis: &Basis, active: &[usize], near: Option<Point>) -> (Point, Linear) {
    let mut starts = vec![Point::nominal(model)];
    starts.push(Point { locals: basis.nominal.point.locals.clone(), ..Point::nominal(model) });
    for index in active {
        starts.iter_mut().for_each(|start| start.effects[*index] = model.frame().candidates[*index].typical);
    }
    starts.extend(near.map(|mut near| {
        // What the diagnosis tried and does not name stays out.
        let others = (0..near.effects.len()).filter(|index| !active.contains(index));
        others.for_each(|index| near.effects[index] = 0.0);
        near
    }));
    let fits = starts
        .into_iter()
        .map(|start| fit(model, &basis.noise, Linear::with(model, start, active), active, &basis.local_scale));
    let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost));
    let point = best.map_or_else(|| Point::nominal(model), |best| best.linear.point);
    let linear = Linear::with(model, point.clone(), active);
    (point, linear)
}

/// Posterior covariance of parameters, surfaces and active sizes, in prior standard deviations and ordinary sizes.
fn posterior(model: &dyn Forward, basis: &Basis, linear: &Linear, active: &[usize]) -> DMatrix<f64> {
    let effects = active.iter().map(|index| linear.effects[*index].as_slice());
    let columns: Vec<&[f64]> = linear.nuisance.iter().map(Vec::as_slice).chain(effects).collect();
    let measured = &model.frame().measured;
    let gram = normal_equations(measured, &basis.noise, linear, &columns, &linear.residual, &basis.local_scale, &[]);
    let count = columns.len();
    let precision = DMatrix::from_fn(count, count, |i, j| {
        let prior = if i < linear.nuisance.len() { 1.0 } else { EFFECT_PRIOR.powi(-2) };
        gram.total[(i, j)] + if i == j { prior } else { 0.0 }
    });
    precision.cholesky().map_or_else(|| DMatrix::from_element(count, count, f64::NAN), |factor| factor.inverse())
}
