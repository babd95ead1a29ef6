//! An edge through its operations, in steps that are the same wherever the model is asked.

use super::{Action, Change, Cutting, LAND, LandForm, NARROW, Nominal, Source, scattered};
use crate::forward::{RowByRow, first_refusal};
use crate::{ChannelId, Direction, EffectRefusal, Forward, Frame, Point, WrittenEffect};
use rayon::prelude::*;
use toolroom_effects::{Effect, Effects};
use toolroom_innovations::Chain;
use toolroom_process::Record;
use toolroom_scenario::move_constant;

/// The start of a cut that force, power and temperature means leave out, s.
const LEFT_OUT: f64 = 20.0;
/// Longest step, s.
const LONGEST_STEP: f64 = 90.0;
/// Greatest growth of the land in a step, relative to itself and a small land.
const GROWTH: f64 = 0.35;
const SMALL_LAND: f64 = 0.03e-3;
/// Land beyond which no edge is followed, m.
const GREATEST_LAND: f64 = 1.2e-3;
/// Components that a state has at most.
pub(super) const MOST: usize = 12;

/// A step of an operation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Length, s.
    pub length: f64,
    /// Whether it counts in the means over the cut.
    pub seen: bool,
    /// What a rate of the body at the start adds to its mean over the step, and to its end, s: the body follows an
    /// exponential.
    lagged: [f64; 2],
    /// Time constant of that, s.
    lag: f64,
}

impl Step {
    fn new(start: f64, end: f64, seen: bool, lag: f64) -> Self {
        let length = end - start;
        let lagged = if lag.is_finite() {
            let end = lag * -(-length / lag).exp_m1();
            [lag * (1.0 - end / length), end]
        } else {
            [0.5 * length, length]
        };
        Self { length, seen, lagged, lag }
    }
}

/// A model at a point: what all rows have in common.
pub(super) struct Setting<'a, P> {
    /// The process by the set of entries that act, as [`Cutting::masks`].
    processes: Vec<P>,
    variant_of_row: &'a [usize],
    pub at: &'a Point,
    /// Weight, feature of the row if it has one, and form along the land, in the logarithm of the wear rate.
    of_land: Vec<AlongLand<'a>>,
    /// Logarithm of the wear rate of all rows.
    wear: f64,
    /// Weight and feature of the row, in the logarithm of the wear rate.
    of_row: Vec<(f64, &'a [f64])>,
    /// Size and rows of lots.
    lots: Vec<(f64, &'a [f64])>,
    /// Factor on the land of a new edge.
    pub start: f64,
}

/// One number a row, where rows differ.
pub(super) type Feature<'a> = Option<&'a [f64]>;
type AlongLand<'a> = (f64, Feature<'a>, LandForm);

impl LandForm {
    /// Values of all forms, in their order.
    pub(super) fn all_at(land: f64) -> [f64; 3] {
        [land / LAND, land / LAND - 0.5, (-land / NARROW).exp()]
    }
}

/// Forms and weights of the logarithm of the wear rate along the land in a row.
pub(super) struct OfLand(Vec<(f64, LandForm)>);

impl OfLand {
    /// Factor on the rate of wear.
    fn factor(&self, land: f64) -> f64 {
        if self.0.is_empty() {
            return 1.0;
        }
        let values = LandForm::all_at(land);
        self.0.iter().map(|(weight, form)| weight * values[*form as usize]).sum::<f64>().exp()
    }
}

impl<P> Setting<'_, P> {
    /// The process in a row.
    pub(super) fn process(&self, row: usize) -> &P {
        &self.processes[self.variant_of_row[row]]
    }

    /// What multiplies the wear rate along the land in a row.
    pub(super) fn of_land(&self, row: usize) -> OfLand {
        let of_row = |feature: Feature<'_>| feature.map_or(1.0, |feature| feature[row]);
        OfLand(self.of_land.iter().map(|(weight, feature, form)| (weight * of_row(*feature), *form)).collect())
    }
}

/// Places of what is read of a state by name.
pub(super) struct Parts {
    pub land: usize,
    pub lagged: Option<usize>,
    pub damage: Option<usize>,
}

impl Parts {
    pub(super) fn of<P: Nominal>() -> Self {
        Self {
            land: P::State::index_of("flank_wear").unwrap_or(0),
            lagged: P::LAGGED.and_then(P::State::index_of),
            damage: P::State::index_of("thermal_damage"),
        }
    }
}

impl<P: Nominal> Cutting<P> {
    /// Fixes the steps of every row by a nominal run; wear at the end of each row.
    pub(super) fn schedule(&mut self) -> Vec<f64> {
        let mut steps = vec![Vec::new(); self.inputs.len()];
        let mut wear = vec![0.0; self.inputs.len()];
        let parts = Parts::of::<P>();
        let lag = self.process.lag();
        for rows in &self.rows {
            let mut x = self.fresh(1.0);
            for row in rows {
                self.cool(&parts, *row, &mut x);
                let held = self.process.held(&self.inputs[*row]);
                let duration = self.durations[*row];
                let short = duration <= LEFT_OUT;
                let mut time = 0.0;
                while time < duration {
                    let rate = P::rates(&held, &P::State::from_slice(&x), 1.0).get(parts.land).unwrap_or(0.0);
                    let allowed = GROWTH * (x[parts.land] + SMALL_LAND) / rate.max(f64::MIN_POSITIVE);
                    let mut end = time + allowed.clamp(2.0, LONGEST_STEP);
                    if time < LEFT_OUT && end > LEFT_OUT && duration > LEFT_OUT {
                        end = LEFT_OUT;
                    }
                    // No slivers at the end, unless all that counts of a cut a little longer than what is left out is one.
                    if end > duration - 1.0 && (short || time >= LEFT_OUT) {
                        end = duration;
                    }
                    let step = Step::new(time, end, time >= LEFT_OUT || short, lag);
                    taken::<P>(&parts, &held, &mut x, &step, [1.0; 2], &OfLand(Vec::new()));
                    steps[*row].push(step);
                    time = end;
                }
                wear[*row] = x[parts.land];
            }
        }
        self.steps = steps;
        wear
    }

    /// A new edge whose land is `factor` times that of the scenario.
    pub(super) fn fresh(&self, factor: f64) -> [f64; MOST] {
        let mut x = [0.0; MOST];
        self.process.initial().write_to(&mut x);
        x[Parts::of::<P>().land] += factor * self.start;
        x
    }

    pub(super) fn setting<'a>(&'a self, point: &'a Point) -> Setting<'a, P> {
        let mut setting = Setting {
            processes: self.masks.iter().map(|mask| self.process_at(point, *mask)).collect(),
            variant_of_row: &self.variant_of_row,
            at: point,
            of_land: Vec::new(),
            wear: 0.0,
            of_row: Vec::new(),
            lots: Vec::new(),
            start: 1.0,
        };
        for ((change, x), parameter) in self.changes.iter().zip(&point.parameters).zip(&self.frame.parameters) {
            let weight = parameter.deviation * x;
            match change {
                _ if weight == 0.0 => {}
                Change::Wear => setting.wear += weight,
                Change::WearFeature(feature) => setting.of_row.push((weight, feature)),
                Change::WearOfLand(feature, form) => setting.of_land.push((weight, feature.as_deref(), *form)),
                Change::Start => setting.start = (1.0 + weight).max(0.0),
                Change::Constant { .. } => {}
            }
        }
        for (action, size) in self.actions.iter().zip(&point.effects) {
            if let (Action::Lot(.., rows), true) = (action, *size != 0.0) {
                setting.lots.push((*size, rows));
            }
        }
        setting
    }

    /// The process of a point: constants and effects of the rows in which the entries of `mask` act.
    fn process_at(&self, point: &Point, mask: u128) -> P {
        let mut process = self.process.clone();
        let mut effects: Vec<Effect> = process.effects().iter().copied().collect();
        let mut bit = 0;
        for (action, size) in self.actions.iter().zip(&point.effects) {
            match action {
                Action::Effect(effect) if *size != 0.0 => effects.push(effect.with_size(*size)),
                Action::Scoped(effect, ..) => {
                    if *size != 0.0 && mask >> bit & 1 == 1 {
                        effects.push(effect.with_size(*size));
                    }
                    bit += 1;
                }
                // The deviation of the lot carries the size.
                Action::Lot(effect, ..)
                    if *size != 0.0 && effects.iter().all(|own| own.entry().id != effect.entry().id) =>
                {
                    effects.push(effect.with_size(1.0));
                }
                Action::Effect(_) | Action::Lot(..) | Action::Reading { .. } => {}
            }
        }
        process = process.with_effects(Effects::overlaid(effects));
        for fixed in &self.fixed {
            let acts = fixed.rows.is_none() || mask >> bit & 1 == 1;
            bit += usize::from(fixed.rows.is_some());
            if acts {
                // A constant that the process lacks was refused with its file.
                let _ = move_constant(process.parameters_mut(), &fixed.group, &fixed.field, fixed.moved);
            }
        }
        for ((change, x), parameter) in self.changes.iter().zip(&point.parameters).zip(&self.frame.parameters) {
            let Change::Constant { group, name } = change else { continue };
            if *x == 0.0 {
                continue;
            }
            for (known_group, record) in process.parameters_mut() {
                if known_group == *group
                    && let Some(i) = record.fields().iter().position(|field| field.name == *name)
                    && let Some(value) = record.value(i)
                {
                    // A constant that left its range would be a model that no file can state.
                    let moved = value * (parameter.deviation * x).exp();
                    let field = &record.fields()[i];
                    record.set_value(i, moved.clamp(field.min.min(value), field.max.max(value)));
                }
            }
        }
        process
    }

    /// Values of all observations of a group, `each` of whose rows is handed the work on it.
    fn edge(&self, setting: &Setting<'_, P>, group: usize, each: &mut RowByRow<'_>) -> Vec<f64> {
        let parts = Parts::of::<P>();
        let channels = self.outputs.len().max(1);
        let mut values = vec![0.0; channels * self.rows[group].len()];
        let mut y = vec![0.0; P::Output::LEN];
        let mut x = self.fresh(setting.start);
        for (row, values) in self.rows[group].iter().zip(values.chunks_exact_mut(channels)) {
            each(*row, &mut || self.follow(setting, (group, *row), (&parts, &mut x, &mut y), values));
        }
        self.observed(group, &values)
    }

    /// Takes an edge through a row; values of each channel.
    fn follow(
        &self,
        setting: &Setting<'_, P>,
        (group, row): (usize, usize),
        (parts, x, y): (&Parts, &mut [f64; MOST], &mut [f64]),
        values: &mut [f64],
    ) {
        let (u, factor) = self.conditions(setting, group, row);
        let of_land = setting.of_land(row);
        let held = setting.process(row).held(&u);
        self.cool(parts, row, x);
        let mut seen = 0.0;
        for step in &self.steps[row] {
            let middle = taken::<P>(parts, &held, x, step, [factor; 2], &of_land);
            if step.seen {
                self.observe(&held, &middle).write_to(y);
                for (channel, output) in &self.means {
                    values[*channel] += step.length * y[*output];
                }
                seen += step.length;
            }
        }
        for ((value, source), sign) in values.iter_mut().zip(&self.outputs).zip(&self.signs) {
            *value = sign
                * match source {
                    Source::Wear => x[parts.land],
                    Source::Output(_) => *value / seen,
                    Source::Duration => self.durations[row] + self.handling[row],
                    Source::Stops => 0.0,
                };
        }
    }

    /// What the channels ask for at a state.
    pub(super) fn observe(&self, held: &P::Held<'_>, x: &[f64; MOST]) -> P::Output {
        let x = P::State::from_slice(x);
        if self.readings { P::readings(held, &x) } else { P::observe(held, &x) }
    }

    /// Input of a row, and the factor on its rate of wear.
    pub(super) fn conditions(&self, setting: &Setting<'_, P>, group: usize, row: usize) -> (P::Input, f64) {
        let local = |kind: usize| setting.at.locals[kind][group] * self.frame.locals[kind].deviation;
        let mut u = self.inputs[row];
        if let (Some(scattered), true) = (&self.scattered, setting.at.locals.len() > scattered::KIND) {
            scattered.set_kinds(&self.ports, local(scattered::KIND), &mut u);
        }
        u.set(self.ports.force, local(1).exp());
        if !setting.lots.is_empty() {
            u.set(self.ports.lot, setting.lots.iter().map(|(size, rows)| size * rows[row]).sum());
        }
        if let Some(port) = self.ports.pass_time {
            u.set(port, self.durations[row]);
        }
        let of_row = setting.of_row.iter().map(|(weight, feature)| weight * feature[row]);
        (u, (local(0) + setting.wear + of_row.sum::<f64>()).exp())
    }

    /// What was observed of a group, out of `values` of each of its rows and each channel.
    pub(super) fn observed(&self, group: usize, values: &[f64]) -> Vec<f64> {
        let channels = self.outputs.len();
        let span = &self.frame.measured.observations[self.frame.measured.spans[group].clone()];
        span.iter().map(|observation| values[self.places[observation.row] * channels + observation.channel]).collect()
    }
}

/// Midpoint step; the body follows its exponential to where it would settle halfway. Returns the state halfway, with the
/// mean of the body over the step. The factors on the
/// rate of wear are those at the start and halfway.
pub(super) fn taken<P: Nominal>(
    parts: &Parts,
    held: &P::Held<'_>,
    x: &mut [f64; MOST],
    step: &Step,
    [first_factor, second_factor]: [f64; 2],
    of_land: &OfLand,
) -> [f64; MOST] {
    let half = Half::new::<P>(parts, held, *x, step, first_factor, of_land);
    *x = half.end::<P>(parts, held, step, second_factor, of_land);
    half.middle
}

/// A step up to its middle.
pub(super) struct Half {
    start: [f64; MOST],
    /// State halfway.
    pub middle: [f64; MOST],
    /// Place of the damage, where it changes, and its rate in a healed edge.
    damaging: Option<(usize, f64)>,
}

impl Half {
    #[inline]
    pub(super) fn new<P: Nominal>(
        parts: &Parts,
        held: &P::Held<'_>,
        start: [f64; MOST],
        step: &Step,
        factor: f64,
        of_land: &OfLand,
    ) -> Self {
        let first = rates::<P>(parts, held, &start, factor, of_land);
        // Damage of a hot edge comes and goes within seconds; its equation is linear.
        let damaging = parts.damage.filter(|i| first[*i] != 0.0).map(|i| {
            let mut healed = start;
            healed[i] = 0.0;
            (i, if start[i] == 0.0 { first[i] } else { rates::<P>(parts, held, &healed, factor, of_land)[i] })
        });
        let mut half = Self { start, middle: start, damaging };
        half.middle = half.moved(parts, &first, 0.5 * step.length);
        if let Some(i) = parts.lagged {
            half.middle[i] = start[i] + first[i] * step.lagged[0];
        }
        half
    }

    /// State at the end, with the factor on the rate of wear halfway.
    #[inline]
    pub(super) fn end<P: Nominal>(
        &self,
        parts: &Parts,
        held: &P::Held<'_>,
        step: &Step,
        factor: f64,
        of_land: &OfLand,
    ) -> [f64; MOST] {
        let rate = rates::<P>(parts, held, &self.middle, factor, of_land);
        let mut end = self.moved(parts, &rate, step.length);
        if let Some(i) = parts.lagged {
            // The rate is that of a body as warm as halfway; at the start it is farther from where it settles.
            let first = rate[i] + (self.middle[i] - self.start[i]) / step.lag;
            let next = self.start[i] + first * step.lagged[1];
            end[i] = if next.is_finite() { next } else { self.start[i] };
        }
        end
    }

    #[inline]
    fn moved(&self, parts: &Parts, rate: &[f64; MOST], time: f64) -> [f64; MOST] {
        let start = &self.start;
        let mut next: [f64; MOST] = std::array::from_fn(|i| start[i] + rate[i] * time);
        if let Some((i, fresh)) = self.damaging {
            let decay = if start[i] > 1e-6 { (fresh - rate[i]) / start[i] } else { fresh };
            let stretch = if decay > 0.0 { -(-decay * time).exp_m1() / decay } else { time };
            next[i] = start[i] + rate[i] * stretch;
        }
        // An edge whose model runs away has broken long before: numbers stay numbers.
        next = std::array::from_fn(|i| if next[i].is_finite() { next[i] } else { start[i] });
        next[parts.land] = next[parts.land].min(GREATEST_LAND);
        next
    }
}

/// Rates per second where the edge wears by `factor` faster, and by what it does along the land.
#[inline]
pub(super) fn rates<P: Nominal>(
    parts: &Parts,
    held: &P::Held<'_>,
    x: &[f64; MOST],
    factor: f64,
    of_land: &OfLand,
) -> [f64; MOST] {
    let bent = factor * of_land.factor(x[parts.land]);
    let mut slope = [0.0; MOST];
    P::rates(held, &P::State::from_slice(x), bent).write_to(&mut slope);
    slope
}

impl<P: Nominal> Forward for Cutting<P> {
    fn frame(&self) -> &Frame {
        &self.frame
    }
    fn simulate(&self, point: &Point) -> Vec<f64> {
        let setting = self.setting(point);
        let edges: Vec<Vec<f64>> = (0..self.rows.len())
            .into_par_iter()
            .map(|group| self.edge(&setting, group, &mut |_, work| work()))
            .collect();
        let mut raw = edges.concat();
        for (action, size) in self.actions.iter().zip(&point.effects) {
            if let Action::Reading { channels, column, .. } = action
                && *size != 0.0
            {
                for (raw, observation) in raw.iter_mut().zip(&self.frame.measured.observations) {
                    if channels.contains(&observation.channel) {
                        *raw += size * column[observation.row];
                    }
                }
            }
        }
        raw
    }
    fn refusal(&self, point: &Point) -> Option<EffectRefusal> {
        let setting = self.setting(point);
        if !setting.processes.iter().any(|process| process.effects().has_defined()) {
            return None;
        }
        first_refusal(self.rows.len(), |group, each| {
            self.edge(&setting, group, each);
        })
    }
    fn scatter_is_known(&self, channel: usize) -> bool {
        // The error of a signed channel is bounded from below, so that it is not that of the sheet; how stops scatter is not
        // stated.
        let id = self.frame.measured.channels[channel].id;
        self.scattered.is_some() && !P::SIGNED.contains(&id) && id != ChannelId::StopTime
    }
    fn chains(&self, point: &Point) -> Vec<Chain> {
        self.chains_at(point)
    }
    fn slopes(&self, point: &Point, _raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        self.slopes_along(point, along)
    }
    fn written(&self, candidate: usize) -> WrittenEffect {
        self.written_effect(candidate)
    }
}
