//! Derivatives of all readings of an edge in one run along its life.
//!
//! A number of the fit acts in one of four ways. What multiplies the rate of wear is carried along
//! by the chain rule: a step `x₁ = Φ(x₀, ln f)` gives `S₁ = ∂Φ/∂x S₀ + ∂Φ/∂ln f · φ`, with the same
//! two derivatives of Φ for all of them, φ being the feature of the row or of the land. What changes
//! readings only is asked at the states of the run. Everything else runs beside it. What adds to a
//! reading needs no run at all.

use super::run::{Feature, Half, MOST, OfLand, Parts, Setting, Step, taken};
use super::{Action, Change, Cutting, LandForm, Nominal, Source};
use crate::{Direction, Point};
use rayon::prelude::*;
use toolroom_process::Record;

/// Step of a difference that a step of the run is differentiated by, relative.
const SMALL: f64 = 1e-6;
/// What the land, the body and the damage count as beside themselves in such a difference.
const SCALES: [f64; 3] = [0.03e-3, 100.0, 0.1];

/// What a run of its own needs in a row beside what all have in common: conditions and factor on the wear rate.
type RowSetting<'a, P> = (<P as Nominal>::Held<'a>, f64);

/// How a direction acts.
enum Way<'a, P> {
    /// On the logarithm of the rate of wear: weight, and feature of the row if it has one.
    Rate(f64, Feature<'a>),
    /// The same by a function of the land.
    RateOfLand(f64, Feature<'a>, LandForm),
    /// On what is observed: the setting a step ahead, and the step.
    Seen(Setting<'a, P>, f64),
    /// On everything.
    Run(Setting<'a, P>, f64),
    /// On the readings of these channels: per row.
    Reading(&'a [usize], &'a [f64], f64),
}

/// Components of the state by which others change, and their places.
pub(super) type Sensitive = [f64; 3];

/// What is carried along with one direction.
struct Carried<'a, 's, P: Nominal> {
    way: &'a Way<'s, P>,
    /// The state of its own run.
    x: [f64; MOST],
    /// Derivatives of the components that matter.
    s: Sensitive,
    /// Sums over the row, then slopes: by row and channel.
    values: Vec<f64>,
}

impl<P: Nominal> Cutting<P> {
    /// Derivatives of the raw values by each of `along`.
    pub(super) fn slopes_along(&self, point: &Point, along: &[Direction]) -> Vec<Vec<f64>> {
        let here = self.setting(point);
        let ahead: Vec<(Point, f64)> = along.iter().map(|direction| direction.ahead(&self.frame, point)).collect();
        let ways: Vec<Way<'_, P>> = along.iter().zip(&ahead).map(|(way, ahead)| self.way(*way, ahead)).collect();
        let groups: Vec<Vec<Vec<f64>>> =
            (0..self.rows.len()).into_par_iter().map(|group| self.edge_slopes(&here, &ways, group)).collect();
        let mut columns: Vec<Vec<f64>> = ways.iter().map(|_| Vec::with_capacity(self.frame.measured.len())).collect();
        for group in &groups {
            columns.iter_mut().zip(group).for_each(|(column, part)| column.extend(part));
        }
        columns
    }

    fn way<'a>(&'a self, direction: Direction, (ahead, step): &'a (Point, f64)) -> Way<'a, P> {
        let still = !self.process.vibrates();
        let seen = match direction {
            Direction::Parameter(i) => {
                let deviation = self.frame.parameters[i].deviation;
                match &self.changes[i] {
                    Change::Wear => return Way::Rate(deviation, None),
                    Change::WearFeature(feature) => return Way::Rate(deviation, Some(feature)),
                    Change::WearOfLand(feature, form) => {
                        return Way::RateOfLand(deviation, feature.as_deref(), *form);
                    }
                    // Forces do not wear the edge.
                    Change::Constant { group, .. } => still && *group == "force",
                    Change::Start => false,
                }
            }
            Direction::Effect(i) => match &self.actions[i] {
                Action::Reading { channels, column, .. } => {
                    return Way::Reading(channels, column, self.frame.candidates[i].typical);
                }
                Action::Lot(..) => false,
                // The catalogue lists flank wear wherever an effect changes its rate.
                Action::Effect(effect) | Action::Scoped(effect, ..) => {
                    still && effect.entry().channels.iter().all(|it| it.channel != "flank_wear")
                }
            },
            Direction::Local(0) => return Way::Rate(self.frame.locals[0].deviation, None),
            // Force does not wear the edge; what differs between kinds of wear does.
            Direction::Local(kind) => still && kind == 1,
        };
        let setting = self.setting(ahead);
        if seen { Way::Seen(setting, *step) } else { Way::Run(setting, *step) }
    }

    /// Derivatives of what was observed of a group by each way.
    fn edge_slopes(&self, here: &Setting<'_, P>, ways: &[Way<'_, P>], group: usize) -> Vec<Vec<f64>> {
        let (channels, rows) = (self.outputs.len(), &self.rows[group]);
        let parts = Parts::of::<P>();
        let mut x = self.fresh(here.start);
        let started = |way: &Way<'_, P>| match way {
            Way::Run(setting, _) => self.fresh(setting.start),
            Way::Rate(..) | Way::RateOfLand(..) | Way::Seen(..) | Way::Reading(..) => x,
        };
        let carry = |way| Carried { way, x: started(way), s: [0.0; 3], values: vec![0.0; channels * rows.len()] };
        let mut carried: Vec<Carried<'_, '_, P>> = ways.iter().map(carry).collect();
        let mut means = vec![0.0; channels];
        for (place, row) in rows.iter().enumerate() {
            let (u, factor) = self.conditions(here, group, *row);
            let (held, of_land) = (here.process(*row).held(&u), here.of_land(*row));
            let own: Vec<Option<RowSetting<'_, P>>> = ways
                .iter()
                .map(|way| match way {
                    Way::Seen(setting, _) | Way::Run(setting, _) => {
                        let (u, factor) = self.conditions(setting, group, *row);
                        Some((setting.process(*row).held(&u), factor))
                    }
                    Way::Rate(..) | Way::RateOfLand(..) | Way::Reading(..) => None,
                })
                .collect();
            self.cool(&parts, *row, &mut x);
            for way in &mut carried {
                self.cool(&parts, *row, &mut way.x);
                way.s[1] *= self.warm[*row];
            }
            means.fill(0.0);
            let mut seen = 0.0;
            let of_row = place * channels..(place + 1) * channels;
            for step in &self.steps[*row] {
                let local = Differentiated::new(self, &parts, &held, x, step, factor, &of_land);
                let weight = if step.seen { step.length } else { 0.0 };
                seen += weight;
                if step.seen {
                    self.add(&mut means, weight, &local.y);
                }
                for (each, own) in carried.iter_mut().zip(&own) {
                    let values = &mut each.values[of_row.clone()];
                    match (each.way, own) {
                        (Way::Rate(weight_of, feature), _) => {
                            let phi = weight_of * feature.map_or(1.0, |feature| feature[*row]);
                            local.carry(self, &mut each.s, [phi; 2], weight, values);
                        }
                        (Way::RateOfLand(weight_of, feature, form), _) => {
                            let weight_of = weight_of * feature.map_or(1.0, |feature| feature[*row]);
                            let phi = local.of_land.map(|values| weight_of * values[*form as usize]);
                            local.carry(self, &mut each.s, phi, weight, values);
                        }
                        (Way::Seen(..), Some((held, ..))) if step.seen => {
                            self.add(values, weight, &written(&self.observe(held, &local.middle)));
                        }
                        (Way::Run(..), Some((held, factor))) => {
                            // What the rate is along the land is carried along by `RateOfLand` alone.
                            let middle = taken::<P>(&parts, held, &mut each.x, step, [*factor; 2], &of_land);
                            if step.seen {
                                self.add(values, weight, &written(&self.observe(held, &middle)));
                            }
                        }
                        _ => {}
                    }
                }
                x = local.end;
            }
            for each in &mut carried {
                let values = each.values[of_row.clone()].iter_mut().zip(&means).zip(&self.outputs).zip(&self.signs);
                for (channel, (((value, mean), source), sign)) in values.enumerate() {
                    *value = match (each.way, source) {
                        (Way::Reading(of, column, typical), _) => {
                            *value = if of.contains(&channel) { typical * column[*row] } else { 0.0 };
                            continue;
                        }
                        (Way::Rate(..) | Way::RateOfLand(..), Source::Wear) => each.s[0],
                        (Way::Rate(..) | Way::RateOfLand(..), Source::Output(_)) => *value / seen,
                        (Way::Seen(_, step) | Way::Run(_, step), Source::Output(_)) => (*value - mean) / seen / step,
                        (Way::Run(_, step), Source::Wear) => (each.x[parts.land] - x[parts.land]) / step,
                        _ => 0.0,
                    };
                    *value *= sign;
                }
            }
        }
        carried.iter().map(|each| self.observed(group, &each.values)).collect()
    }

    /// Adds what a step contributes to the means over a row.
    fn add(&self, sums: &mut [f64], weight: f64, y: &[f64; OUTPUTS]) {
        for (channel, output) in &self.means {
            sums[*channel] += weight * y[*output];
        }
    }
}

/// Outputs that a process has at most.
pub(super) const OUTPUTS: usize = 32;

pub(super) fn written<R: Record>(record: &R) -> [f64; OUTPUTS] {
    let mut values = [0.0; OUTPUTS];
    record.write_to(&mut values);
    values
}

/// A step of the run, differentiated.
pub(super) struct Differentiated {
    pub middle: [f64; MOST],
    pub end: [f64; MOST],
    /// Outputs halfway.
    pub y: [f64; OUTPUTS],
    /// Components that something depends on.
    active: [bool; 3],
    /// `∂middle/∂x` and `∂end/∂x`, by column.
    by_state: [[Sensitive; 2]; 3],
    /// The same by the logarithms of the factors at the start and halfway.
    by_factor: [[Sensitive; 2]; 2],
    /// Outputs by the state halfway.
    y_by_state: [[f64; OUTPUTS]; 3],
    /// Forms along the land at the start and halfway.
    of_land: [[f64; 3]; 2],
}

impl Differentiated {
    pub(super) fn new<P: Nominal>(
        model: &Cutting<P>,
        parts: &Parts,
        held: &P::Held<'_>,
        x: [f64; MOST],
        step: &Step,
        factor: f64,
        of_land: &OfLand,
    ) -> Self {
        let run = |x: [f64; MOST], factors: [f64; 2]| {
            let half = Half::new::<P>(parts, held, x, step, factors[0], of_land);
            let end = half.end::<P>(parts, held, step, factors[1], of_land);
            (half, end)
        };
        let places = [Some(parts.land), parts.lagged, parts.damage];
        let (half, end) = run(x, [factor; 2]);
        let middle = half.middle;
        let active = places.map(|place| place.is_some_and(|i| place != parts.damage || x[i] != 0.0 || end[i] != 0.0));
        let change = |there: &[f64; MOST], here: &[f64; MOST], by: f64| {
            places.map(|place| place.map_or(0.0, |i| (there[i] - here[i]) / by))
        };
        let both =
            |(half, there): (Half, [f64; MOST]), by: f64| [change(&half.middle, &middle, by), change(&there, &end, by)];
        let observe = |x: &[f64; MOST]| written(&model.observe(held, x));
        let asked = step.seen && !model.means.is_empty();
        let y = if asked { observe(&middle) } else { [0.0; OUTPUTS] };
        let (mut by_state, mut y_by_state) = ([[[0.0; 3]; 2]; 3], [[0.0; OUTPUTS]; 3]);
        for c in (0..3).filter(|c| active[*c]) {
            let Some(i) = places[c] else { continue };
            let by = SMALL * (x[i] + SCALES[c]);
            let mut there = x;
            there[i] += by;
            by_state[c] = both(run(there, [factor; 2]), by);
            if asked {
                let mut there = middle;
                there[i] += by;
                let there = observe(&there);
                for (_, output) in &model.means {
                    y_by_state[c][*output] = (there[*output] - y[*output]) / by;
                }
            }
        }
        let faster = factor * (1.0 + SMALL);
        let by = SMALL.ln_1p();
        let late = half.end::<P>(parts, held, step, faster, of_land);
        let by_factor = [both(run(x, [faster, factor]), by), [[0.0; 3], change(&late, &end, by)]];
        let of_land = [x, middle].map(|x| LandForm::all_at(x[parts.land]));
        Self { middle, end, y, active, by_state, by_factor, y_by_state, of_land }
    }

    /// Carries `s` through the step, with the logarithms of the factors changing by `phi`; adds to the means.
    #[inline]
    pub(super) fn carry<P: Nominal>(
        &self,
        model: &Cutting<P>,
        s: &mut Sensitive,
        phi: [f64; 2],
        weight: f64,
        sums: &mut [f64],
    ) {
        let active = || (0..3).filter(|c| self.active[*c]);
        let moved = |stage: usize| -> Sensitive {
            std::array::from_fn(|to| {
                let by_state: f64 = active().map(|from| self.by_state[from][stage][to] * s[from]).sum();
                by_state + self.by_factor[0][stage][to] * phi[0] + self.by_factor[1][stage][to] * phi[1]
            })
        };
        let (middle, end) = (moved(0), moved(1));
        if weight > 0.0 {
            for (channel, output) in &model.means {
                sums[*channel] += weight * active().map(|c| self.y_by_state[c][*output] * middle[c]).sum::<f64>();
            }
        }
        *s = end;
    }
}

#[cfg(test)]
mod tests {
    use crate::{Direction, Forward, NominalModel, Point};
    use toolroom_records::parse_csv;
    use toolroom_truth::Case;

    /// A shop off its nominal point: everything moved a little, one effect on.
    fn model_at(process: &'static str, text: &str, effect: &str) -> (Box<dyn Forward>, Point) {
        let model = NominalModel::parse(process, text, &[]).unwrap();
        let csv = Case::null(process, 3).records();
        let (records, _) = parse_csv("truth", csv.as_bytes(), model.kind()).unwrap();
        let (model, _) = model.over(&records, None, |_, _| false);
        let mut point = Point::nominal(model.as_ref());
        point.parameters.iter_mut().enumerate().for_each(|(i, x)| *x = 0.3 - 0.1 * (i % 7) as f64);
        point.locals.iter_mut().flatten().enumerate().for_each(|(i, x)| *x = 0.4 - 0.2 * (i % 5) as f64);
        for (candidate, size) in model.frame().candidates.iter().zip(&mut point.effects) {
            if candidate.id.word() == effect {
                *size = candidate.typical;
            }
        }
        (model, point)
    }

    fn assert_slopes(model: &dyn Forward, point: &Point) {
        let frame = model.frame();
        let along: Vec<Direction> = (0..frame.parameters.len())
            .map(Direction::Parameter)
            .chain((0..frame.candidates.len()).map(Direction::Effect))
            .chain((0..frame.locals.len()).map(Direction::Local))
            .collect();
        let here = model.simulate(point);
        let slopes = model.slopes(point, &here, &along);
        for (direction, slope) in along.iter().zip(&slopes) {
            let by_rate = match direction {
                Direction::Parameter(i) => frame.parameters[*i].name.starts_with("wear rate"),
                Direction::Local(kind) => *kind == 0,
                Direction::Effect(_) => false,
            };
            let (ahead, step) = direction.ahead(frame, point);
            let there = model.simulate(&ahead);
            let difference: Vec<f64> = if by_rate {
                // Carried along exactly: the difference has to be a small one.
                let mix = |share: f64| {
                    let mut near = point.clone();
                    near.parameters.iter_mut().zip(&ahead.parameters).for_each(|(x, far)| *x += share * (far - *x));
                    let locals = near.locals.iter_mut().flatten().zip(ahead.locals.iter().flatten());
                    locals.for_each(|(x, far)| *x += share * (far - *x));
                    model.simulate(&near)
                };
                mix(1e-3).iter().zip(mix(-1e-3)).map(|(a, b)| (a - b) / (2e-3 * step)).collect()
            } else {
                there.iter().zip(&here).map(|(there, here)| (there - here) / step).collect()
            };
            for (channel, name) in frame.measured.channels.iter().enumerate().map(|(i, channel)| (i, channel.id)) {
                let of_channel = |i: &usize| frame.measured.observations[*i].channel == channel;
                let inside: Vec<usize> = (0..here.len()).filter(of_channel).collect();
                let scale = inside.iter().map(|i| difference[*i].abs().max(1e-6 * here[*i].abs())).fold(0.0, f64::max);
                for i in inside {
                    let off = (slope[i] - difference[i]).abs() / scale;
                    assert!(off < 1e-4, "{direction:?} of {name}: {} instead of {}", slope[i], difference[i]);
                }
            }
        }
    }

    #[test]
    fn slopes_of_turning_are_those_of_differences() {
        let text = include_str!("../../../../scenarios/gap/turning.toml");
        for effect in ["none", "wear_temperature", "thermal_heredity"] {
            let (model, point) = model_at("turning", text, effect);
            assert_slopes(model.as_ref(), &point);
        }
    }

    #[test]
    fn slopes_of_milling_are_those_of_differences() {
        let text = include_str!("../../../../scenarios/gap/milling.toml");
        for effect in ["none", "wear_acceleration", "runout"] {
            let (model, point) = model_at("milling", text, effect);
            assert_slopes(model.as_ref(), &point);
        }
    }
}
