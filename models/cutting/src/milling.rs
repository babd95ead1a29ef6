//! Milling: one cutter in one workpiece.

mod claims;
mod equations;
mod held;
mod life;
mod records;
mod runout;
mod sets;
mod vibration;

pub use claims::claims;
pub use held::HeldMilling;
pub use records::{Cutter, CutterLife, EdgeForce, MillingInput, MillingOutput, MillingState};
pub use sets::{MILLING_CATALOGUE, MILLING_SETS, process_of_set};

use crate::vibration::{Ends, MillingStructure, first_switch};
use std::cell::Cell;
use std::sync::Arc;
use toolroom_effects::Effects;
use toolroom_process::ode::{self, Tolerance};
use toolroom_process::{Advance, AnyRecord, ModelError, Number, Process, ProcessEvent, Record};
use toolroom_wear::Chipping;

/// Peripheral milling of a wall or a slot with one cutter.
///
/// Forces are those of the linear edge-force model, mean over a rotation; wear follows an
/// extended Taylor law; the cutter gives way with the stiffness of its holder.
///
/// # Validity
/// Straight wall, all teeth alike but for runout, chip thickness in the range of the force
/// coefficients. A helix leaves the means as they are and lowers the peaks.
///
/// # Examples
/// ```
/// use toolroom_cutting::{Milling, MillingInput};
/// use toolroom_process::{Process, ProcessEvent};
/// let (milling, cut) = (Milling::default(), MillingInput::default());
/// let mut cutter = milling.initial();
/// let end = milling.advance(&mut cutter, &cut, 1e5).unwrap();
/// assert_eq!(end.event, Some(ProcessEvent::WearLimit));
/// assert!((end.elapsed / milling.output(&cutter, &cut).tool_life - 1.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Milling<N: Copy = f64> {
    /// Cutter and holder.
    pub cutter: Cutter<N>,
    /// Cutting and edge forces.
    pub force: EdgeForce<N>,
    /// Tool life.
    pub life: CutterLife<N>,
    /// Chipping of an edge.
    pub chipping: Chipping<N>,
    /// Effects that are switched on.
    pub effects: Effects<N>,
    /// What vibrates around the cut; without one every cut is stable and none is asked.
    pub structure: Option<Arc<MillingStructure>>,
}

impl Default for Milling {
    /// The set `c45_endmill_d12` without effects.
    fn default() -> Self {
        Self {
            cutter: Cutter::default(),
            force: EdgeForce::default(),
            life: CutterLife::default(),
            chipping: Chipping::default(),
            effects: Effects::default(),
            structure: None,
        }
    }
}

/// Events of milling.
const EVENTS: [ProcessEvent; 2] = [ProcessEvent::WearLimit, ProcessEvent::Chipping];

/// Relative accuracy of [`Process::advance`].
const ACCURACY: f64 = 1e-9;

/// Greatest wear of one call of the integrator at the rate of its start, relative to the limit.
const STAGE: f64 = 0.1;

/// Number of components of [`MillingState`].
const STATES: usize = <MillingState as Record>::LEN;

/// How far a cut came.
enum Followed {
    /// To where its verdict changed, s after it began.
    Switched(f64),
    /// To its end, or to an event, s after it began.
    Ended(Option<(ProcessEvent, f64)>),
}

impl<N: Number> Milling<N> {
    /// The same process over another number type, for exact derivatives.
    pub fn map<M: Copy>(&self, mut convert: impl FnMut(N) -> M) -> Milling<M> {
        Milling {
            cutter: self.cutter.map(&mut convert),
            force: self.force.map(&mut convert),
            life: self.life.map(&mut convert),
            chipping: self.chipping.map(&mut convert),
            effects: self.effects.map(&mut convert),
            structure: self.structure.clone(),
        }
    }
}

impl Milling {
    /// Error of a state that counts as one, with `relative` accuracy.
    fn tolerance(&self, relative: f64) -> Tolerance<STATES> {
        let (life, speed) = (self.life.reference_life, self.life.reference_speed);
        let force = self.force.tangential_edge * self.life.reference_depth;
        let scales = MillingState {
            flank_wear: self.life.wear_limit,
            cutting_path: speed * life,
            cutting_time: life,
            // Early hazard grows with a broken power of path, which takes short steps to follow.
            chipping_hazard: 1e-4,
            energy: (force + self.force.tangential_cutting * self.life.reference_feed * self.life.reference_depth)
                * speed
                * life,
            chatter_time: 1e4 * life,
        };
        let mut absolute = [0.0; STATES];
        scales.write_to(&mut absolute);
        Tolerance { relative, absolute: absolute.map(|scale| relative * scale) }
    }

    /// State after `dt` seconds in a cut of the domain, or at the first event.
    fn run(&self, x: &MillingState, u: &MillingInput, dt: f64) -> Result<(MillingState, Advance), ModelError> {
        self.effects.watched(|| self.run_unwatched(x, u, dt))
    }

    fn run_unwatched(
        &self,
        x: &MillingState,
        u: &MillingInput,
        dt: f64,
    ) -> Result<(MillingState, Advance), ModelError> {
        // Out of cut nothing changes.
        if u.engaged == 0.0 {
            return Ok((*x, Advance { elapsed: dt, event: None }));
        }
        // A worn cutter goes on, and its wear limit is not met again.
        let at_start = self.indicators(x, u);
        let passed = std::array::from_fn(|i| at_start[i] >= 0.0 && !EVENTS[i].ends_cut());
        let (mut x, mut time, mut unstable) = (*x, 0.0, self.judge(x, u).unstable);
        loop {
            match self.follow(&mut x, u, dt - time, unstable, passed)? {
                Followed::Switched(after) => (time, unstable) = (time + after, !unstable),
                Followed::Ended(None) => return Ok((x, Advance { elapsed: dt, event: None })),
                Followed::Ended(Some((event, after))) => {
                    return Ok((x, Advance { elapsed: time + after, event: Some(event) }));
                }
            }
        }
    }

    /// Moves a cut to the instant at which it becomes unstable or stable again, or to the end of the step or an event.
    fn follow(
        &self,
        x: &mut MillingState,
        u: &MillingInput,
        dt: f64,
        unstable: bool,
        passed: [bool; EVENTS.len()],
    ) -> Result<Followed, ModelError> {
        // Without effects and chatter the cutter changes the cut by its land alone.
        let settled = self.effects.is_empty() && !unstable;
        let first = self.engagement_while(x, u, unstable);
        let rhs = |_: f64, y: &[f64; STATES]| {
            let x = MillingState::from_slice(y);
            let mut slope = [0.0; STATES];
            let rates = if settled {
                self.rates_in(&first, &x)
            } else {
                self.rates_in(&self.engagement_while(&x, u, unstable), &x)
            };
            rates.write_to(&mut slope);
            slope
        };
        let switch: Cell<Option<(f64, [f64; STATES])>> = Cell::new(None);
        let events = |_: f64, y: &[f64; STATES]| {
            let [worn, chipped] = ode::unless_passed(passed, self.indicators(&MillingState::from_slice(y), u));
            // Behind a switch nothing is worth integrating.
            [worn, chipped, if switch.get().is_some() { 1.0 } else { -1.0 }]
        };
        let tolerance = self.tolerance(ACCURACY);
        let mut state = [0.0; STATES];
        x.write_to(&mut state);
        // The wear curve is as steep at its end as at its start.
        let stage = |slope: &[f64; STATES]| STAGE * self.life.wear_limit / MillingState::from_slice(slope).flank_wear;
        let watch = |step: &ode::Stretch<'_, STATES>| {
            if self.structure.is_some() && switch.get().is_none() {
                let judge = |time| self.judge(&MillingState::from_slice(&step.at(time)), u);
                let found = first_switch(step.start, step.end, Ends::Verdict { unstable }, judge);
                switch.set(found.map(|time| (time, step.at(time))));
            }
        };
        let end = ode::integrate_staged(rhs, events, &state, dt, &tolerance, stage, watch)?;
        if let Some((time, state)) = switch.get() {
            *x = MillingState::from_slice(&state);
            return Ok(Followed::Switched(time));
        }
        *x = MillingState::from_slice(&end.state);
        Ok(Followed::Ended(end.event.map(|index| (EVENTS[index], end.time))))
    }

    fn indicators(&self, x: &MillingState, u: &MillingInput) -> [f64; 2] {
        [x.flank_wear / self.life.wear_limit - 1.0, x.chipping_hazard - u.chipping_resistance]
    }

    /// Inputs in their ranges, and a cut that the cutter spans.
    fn check(&self, u: &MillingInput) -> Result<(), ModelError> {
        u.check()?;
        if u.width_of_cut > self.cutter.diameter {
            return Err(ModelError::Contradiction {
                first: "width_of_cut",
                first_value: u.width_of_cut,
                second: "diameter",
                second_value: self.cutter.diameter,
                rule: "the cutter spans the width of cut",
            });
        }
        Ok(())
    }
}

impl Process for Milling {
    type Input = MillingInput;
    type State = MillingState;
    type Output = MillingOutput;

    const NAME: &'static str = "milling";
    const EVENTS: &'static [ProcessEvent] = &EVENTS;

    fn initial(&self) -> MillingState {
        MillingState::default()
    }

    fn output(&self, x: &MillingState, u: &MillingInput) -> MillingOutput {
        self.observe(x, u)
    }

    /// A worn cutter may go on past its wear limit; a chipped one ends the step at once.
    fn advance(&self, x: &mut MillingState, u: &MillingInput, dt: f64) -> Result<Advance, ModelError> {
        self.check(u)?;
        if !(dt >= 0.0 && dt.is_finite()) {
            return Err(ModelError::Step { seconds: dt });
        }
        let (state, advance) = self.run(x, u, dt)?;
        *x = state;
        Ok(advance)
    }

    fn derivative(&self, x: &MillingState, u: &MillingInput) -> Option<MillingState> {
        Some(self.rates(x, u))
    }

    fn event_indicators(&self, x: &MillingState, u: &MillingInput, indicators: &mut [f64]) {
        indicators.copy_from_slice(&self.indicators(x, u));
    }

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        let mut groups: Vec<(&'static str, &mut dyn AnyRecord)> = vec![
            ("cutter", &mut self.cutter),
            ("force", &mut self.force),
            ("life", &mut self.life),
            ("chipping", &mut self.chipping),
        ];
        groups.extend(self.effects.parameters_mut());
        if let Some(structure) = &mut self.structure {
            groups.push(("regeneration", &mut Arc::make_mut(structure).regeneration));
        }
        groups
    }
}

/// The lesser of two numbers.
fn least<N: Number>(a: N, b: N) -> N {
    if a.re() <= b.re() { a } else { b }
}
