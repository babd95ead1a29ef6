//! The controller: samples, passes, edges.

use crate::records::{Change, ControlInput, ControlOutput, ControlState, Operation, Rule, Sensing};
use toolroom_effects::Effects;
use toolroom_process::{Advance, AnyRecord, ModelError, Process, ProcessEvent, Record};
use toolroom_wear::{Cut, Measurement, Observer, ObserverNoise, Pair, SpeedLaw, ramp_limits};

/// Share of a sampling period, and of the path of a pass, that counts as none: the sum of many steps ends there.
const ROUNDING: f64 = 1e-9;

/// A sampled controller of the cutting speed of one edge in one operation, one pass after the other.
///
/// At every sample it corrects its estimate of the wear; at the end of a pass it is shown a reading, decides about the edge,
/// and plans the next pass as a ramp of speed. A sample that is due at the end of a step is taken at the beginning of the
/// next one, with the inputs of that.
///
/// # Examples
/// ```
/// use toolroom_control::{ControlInput, SpeedController};
/// use toolroom_process::Process;
/// let mut controller = SpeedController::default();
/// controller.sensing.knows_wear = 1.0;
/// let mut state = controller.initial();
/// let new = controller.output(&state, &ControlInput::default()).cutting_speed;
/// let worn = ControlInput { flank_wear: 0.3e-3, ..ControlInput::default() };
/// controller.advance(&mut state, &worn, 3600.0).unwrap();
/// assert!(controller.output(&state, &worn).cutting_speed < new, "a worn edge is run slower");
/// ```
#[derive(Clone, Debug, Default)]
pub struct SpeedController {
    /// What it believes of tool and work.
    pub pair: Pair,
    /// The cut as programmed.
    pub operation: Operation,
    /// How it finds the speed.
    pub rule: Rule,
    /// When it changes an edge.
    pub change: Change,
    /// How it senses.
    pub sensing: Sensing,
    /// What its filter reckons with.
    pub observer: ObserverNoise,
    /// Effects: there are none of a controller.
    pub effects: Effects,
}

/// A pass as planned.
#[derive(Clone, Copy)]
struct Ramp {
    start: f64,
    end: f64,
}

impl SpeedController {
    /// The nominal cut at a speed, m/s.
    fn cut(&self, speed: f64) -> Cut {
        Cut::nominal(speed, self.operation.feed_per_rev, self.operation.depth_of_cut)
    }

    /// The believed pair within the speeds of the machine.
    fn pair(&self) -> Pair {
        let mut pair = self.pair.clone();
        let (slowest, fastest) = (self.rule.lowest_speed, self.rule.highest_speed.max(self.rule.lowest_speed));
        let limits = &mut pair.limits;
        limits.lowest_speed = limits.lowest_speed.max(slowest).min(fastest);
        limits.highest_speed = limits.highest_speed.max(slowest).min(fastest);
        pair
    }

    /// Whether it estimates wear.
    fn estimates(&self) -> bool {
        self.sensing.knows_wear < 0.5
    }

    /// Whether somebody reads the wear after passes.
    fn is_read(&self) -> bool {
        self.change.change_rule == 1.0
    }

    /// The filter with what it has learnt.
    fn filter(&self, pair: &Pair, x: &ControlState) -> Observer {
        Observer::new(pair, self.observer).with_belief(&x.belief)
    }

    /// Flank wear as it is believed, m.
    fn flank_wear(&self, x: &ControlState, u: &ControlInput) -> f64 {
        if self.estimates() { x.belief[0].max(0.0) } else { u.flank_wear.max(0.0) }
    }

    /// The ramp of the next pass, at the wear believed.
    fn plan(&self, pair: &Pair, x: &ControlState, flank_wear: f64) -> Ramp {
        let Operation { cutting_speed, path_length, .. } = self.operation;
        let factor = self.rule.speed_factor;
        let cut = self.cut(cutting_speed);
        let law = match self.rule.speed_rule as u32 {
            1 => SpeedLaw::MinimumWear,
            2 => SpeedLaw::ShadowPrice(self.rule.shadow_price),
            3 => {
                let wear_left = (pair.limits.wear_limit - flank_wear).max(0.0);
                let path_left = (self.rule.path_per_edge - x.edge_path).max(path_length);
                let speed_at = |flank_wear: f64| pair.intensity_speed(&cut, flank_wear, wear_left / path_left, factor);
                return self.along(pair, x, flank_wear, speed_at);
            }
            4 => SpeedLaw::LiteralBalance,
            _ => {
                let speed = self.limited(factor * cutting_speed);
                return Ramp { start: speed, end: speed };
            }
        };
        self.along(pair, x, flank_wear, |flank_wear| (pair.law_speed(&cut, law, factor, flank_wear), true))
    }

    fn along(&self, pair: &Pair, x: &ControlState, wear: f64, speed_at: impl Fn(f64) -> (f64, bool)) -> Ramp {
        let Operation { cutting_speed, path_length, .. } = self.operation;
        // A new edge starts within one step of the programmed speed.
        let last = if x.last_speed > 0.0 { x.last_speed } else { cutting_speed };
        let cut = self.cut(cutting_speed);
        let plan = pair.plan_pass_along(&cut, wear, path_length, &ramp_limits(pair), Some(last), speed_at);
        Ramp { start: self.limited(plan.start_speed), end: self.limited(plan.end_speed) }
    }

    fn limited(&self, speed: f64) -> f64 {
        speed.max(self.rule.lowest_speed).min(self.rule.highest_speed.max(self.rule.lowest_speed))
    }

    /// Whether the edge is changed before a pass that is planned like this.
    fn is_due(&self, pair: &Pair, x: &ControlState, flank_wear: f64, ramp: Ramp) -> bool {
        let path = self.operation.path_length;
        match self.change.change_rule as u32 {
            2 => x.edge_passes >= self.change.passes,
            3 => x.edge_time + 2.0 * path / (ramp.start + ramp.end) > self.change.cutting_time,
            4 => {
                let factor = if self.estimates() { x.belief[2].exp() } else { 1.0 };
                let cut = self.cut(self.operation.cutting_speed);
                pair.wear_after_pass(&cut, flank_wear, factor, path, (ramp.start, ramp.end)) > self.change.flank_wear
            }
            _ => false,
        }
    }

    /// The next pass begins, with another edge where `lost` or the rule says so.
    fn begin_pass(&self, pair: &Pair, x: &mut ControlState, u: &ControlInput, lost: bool) {
        let mut flank_wear = self.flank_wear(x, u);
        let mut ramp = self.plan(pair, x, flank_wear);
        if lost || x.edge_passes > 0.0 && self.is_due(pair, x, flank_wear, ramp) {
            if self.estimates() {
                x.belief = self.filter(pair, x).next_edge(self.observer.initial_wear).belief();
            }
            (x.edge_path, x.edge_time, x.edge_passes, x.last_speed) = (0.0, 0.0, 0.0, 0.0);
            x.edges += 1.0;
            x.changing = 1.0;
            flank_wear = if self.estimates() { x.belief[0].max(0.0) } else { 0.0 };
            ramp = self.plan(pair, x, flank_wear);
        }
        if self.estimates() {
            let mut filter = self.filter(pair, x);
            filter.begin_pass(self.operation.depth_of_cut);
            x.belief = filter.belief();
        }
        x.passes += 1.0;
        x.edge_passes += 1.0;
        (x.start_speed, x.end_speed, x.pass_time) = (ramp.start, ramp.end, 0.0);
    }

    /// Time that the pass takes as planned, s.
    fn duration(&self, x: &ControlState) -> f64 {
        2.0 * self.operation.path_length / (x.start_speed + x.end_speed)
    }

    /// The speed until the next sample, which is the mean of the ramp over that time.
    fn hold(&self, x: &mut ControlState) {
        let duration = self.duration(x);
        let left = (duration - x.pass_time).max(0.0);
        let part = self.sensing.sampling_period.min(left);
        x.speed = x.start_speed + (x.end_speed - x.start_speed) * ((x.pass_time + 0.5 * part) / duration);
        x.to_sample = part;
        x.since_sample = 0.0;
    }

    /// A sample is due.
    fn sample(&self, x: &mut ControlState, u: &ControlInput) {
        let pair = self.pair();
        // What the machine told of the edge before may still be on its way.
        let changed = std::mem::replace(&mut x.changing, 0.0) > 0.5;
        if x.started < 0.5 {
            x.started = 1.0;
            x.belief = Observer::new(&pair, self.observer).belief();
            self.begin_pass(&pair, x, u, false);
            return self.hold(x);
        }
        if self.estimates() && x.since_sample > 0.0 {
            let mut filter = self.filter(&pair, x);
            filter.predict(&self.cut(x.speed), x.since_sample);
            if u.engaged > 0.5 && u.tool_lost < 0.5 {
                let ControlInput { spindle_power, feed_force, thermo_emf, .. } = *u;
                filter.update(&self.cut(x.speed), &Measurement { spindle_power, feed_force, thermo_emf });
            }
            x.belief = filter.belief();
        }
        let duration = self.duration(x);
        let ended = x.pass_time >= duration * (1.0 - ROUNDING);
        let mut lost = u.tool_lost > 0.5 && !changed || ended && u.tool_worn > 0.5;
        // An edge that is spent already is taken out without a reading, as in the shop: the next filter starts from what
        // the sensors alone have taught.
        if ended && !lost && self.is_read() && (x.edge_passes % self.sensing.read_every) == 0.0 {
            if self.estimates() {
                let mut filter = self.filter(&pair, x);
                filter.read(u.flank_wear, self.sensing.reading_error);
                x.belief = filter.belief();
            }
            lost = u.flank_wear >= self.change.flank_wear;
        }
        if ended || lost {
            x.last_speed = x.end_speed;
            self.begin_pass(&pair, x, u, lost);
        }
        self.hold(x);
    }
}

impl Process for SpeedController {
    type Input = ControlInput;
    type State = ControlState;
    type Output = ControlOutput;

    const NAME: &'static str = "controller";
    const EVENTS: &'static [ProcessEvent] = &[];

    fn initial(&self) -> ControlState {
        ControlState::default()
    }

    fn output(&self, x: &ControlState, u: &ControlInput) -> ControlOutput {
        let mut x = *x;
        if x.started < 0.5 {
            // What it commands at first.
            self.sample(&mut x, u);
        }
        ControlOutput {
            cutting_speed: x.speed,
            tool_change: x.changing,
            estimated_flank_wear: self.flank_wear(&x, u),
            passes: x.passes,
            edges: x.edges,
        }
    }

    fn advance(&self, x: &mut ControlState, u: &ControlInput, dt: f64) -> Result<Advance, ModelError> {
        u.check()?;
        if !(dt >= 0.0 && dt.is_finite()) {
            return Err(ModelError::Step { seconds: dt });
        }
        let mut left = dt;
        while left > 0.0 {
            if x.started < 0.5 || x.to_sample <= ROUNDING * self.sensing.sampling_period.min(self.duration(x)) {
                self.sample(x, u);
            }
            let part = left.min(x.to_sample);
            // What remains is counted down, so that the end of the step is met exactly.
            left = if part == left { 0.0 } else { left - part };
            x.to_sample -= part;
            if u.engaged > 0.5 {
                x.since_sample += part;
                x.pass_time += part;
                x.edge_time += part;
                x.edge_path += x.speed * part;
            } else if x.to_sample <= 0.0 {
                // Out of cut the pass waits, and so does its next sample.
                x.to_sample = self.sensing.sampling_period;
            }
        }
        Ok(Advance { elapsed: dt, event: None })
    }

    fn event_indicators(&self, _: &ControlState, _: &ControlInput, _: &mut [f64]) {}

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        let mut groups = self.pair.parameters_mut();
        groups.push(("operation", &mut self.operation));
        groups.push(("rule", &mut self.rule));
        groups.push(("change", &mut self.change));
        groups.push(("sensing", &mut self.sensing));
        groups.push(("observer", &mut self.observer));
        groups
    }
}
