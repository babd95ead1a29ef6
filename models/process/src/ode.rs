//! Ordinary differential equations: the classical Runge–Kutta step and an adaptive
//! Dormand–Prince 5(4) pair with dense output and event location.
//!
//! Systems here have a handful of states and smooth right-hand sides; sizes are known at
//! compile time, nothing is allocated.

use crate::{ModelError, Number};

/// One classical fourth-order Runge–Kutta step of length `h` from (`t`, `y`).
///
/// # Source
/// Kutta 1901; Hairer, Nørsett, Wanner, Solving ODEs I, table II.1.2.
///
/// ```
/// use toolroom_process::ode::rk4;
/// let y = rk4(|_, y: &[f64; 1]| [-y[0]], 0.0, &[1.0], 0.1);
/// assert!((y[0] - (-0.1f64).exp()).abs() < 1e-7);
/// ```
pub fn rk4<N: Number, const D: usize>(mut rhs: impl FnMut(N, &[N; D]) -> [N; D], t: N, y: &[N; D], h: N) -> [N; D] {
    let half = h * 0.5;
    let along = |k: &[N; D], step: N| -> [N; D] { std::array::from_fn(|i| y[i] + k[i] * step) };
    let k1 = rhs(t, y);
    let k2 = rhs(t + half, &along(&k1, half));
    let k3 = rhs(t + half, &along(&k2, half));
    let k4 = rhs(t + h, &along(&k3, h));
    std::array::from_fn(|i| y[i] + (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0))
}

/// Accuracy asked of [`integrate`]: the local error of component i stays below
/// `absolute[i] + relative · |y[i]|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance<const D: usize> {
    /// Relative part, 1.
    pub relative: f64,
    /// Absolute part, unit of the component.
    pub absolute: [f64; D],
}

/// Where an integration ended and what it cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integration<const D: usize> {
    /// Time reached, s.
    pub time: f64,
    /// State there.
    pub state: [f64; D],
    /// Index of the event function that stopped it.
    pub event: Option<usize>,
    /// Accepted steps.
    pub steps: u32,
    /// Rejected steps.
    pub rejected: u32,
    /// Calls of the right-hand side.
    pub evaluations: u32,
}

/// Least step as a share of the interval; below it the problem is refused as stiff or broken.
const LEAST_STEP: f64 = 1e-12;

/// Integrates `y' = rhs(t, y)` from `y` over `[0, t_end]`, or up to the first instant at which
/// one of the event functions reaches zero from below.
///
/// An event function that is zero or positive at the start has happened already: the integration ends there, at
/// time 0, whatever `t_end`. Whoever lets a system go on past such an event takes it out with [`unless_passed`].
/// Any other event is located on the dense output by bisection to 1e-12 of the step; the returned state lies on or
/// after the event, never before.
///
/// # Errors
/// [`ModelError::Step`] for a `t_end` that is negative or not finite,
/// [`ModelError::StepTooSmall`] where the tolerance cannot be met (a stiff or non-finite
/// right-hand side).
///
/// # Source
/// Dormand & Prince 1980; dense output by Shampine, as in Hairer, Nørsett, Wanner,
/// Solving ODEs I, II.5 and II.6.
///
/// ```
/// use toolroom_process::ode::{Tolerance, integrate};
/// let tolerance = Tolerance { relative: 1e-9, absolute: [1e-12] };
/// // A ball of height 1 - t reaches the ground at t = 1.
/// let end = integrate(|_, _| [-1.0], |_, y: &[f64; 1]| [-y[0]], &[1.0], 5.0, &tolerance).unwrap();
/// assert_eq!(end.event, Some(0));
/// assert!((end.time - 1.0).abs() < 1e-9);
/// ```
pub fn integrate<const D: usize, const E: usize>(
    rhs: impl FnMut(f64, &[f64; D]) -> [f64; D],
    events: impl FnMut(f64, &[f64; D]) -> [f64; E],
    y: &[f64; D],
    t_end: f64,
    tolerance: &Tolerance<D>,
) -> Result<Integration<D>, ModelError> {
    integrate_watched(rhs, events, y, t_end, tolerance, |_| ())
}

/// [`integrate`], handing every accepted step to `watch`: the state between its ends comes from
/// the dense output, which is as accurate as the ends to within a digit.
///
/// # Errors
/// As [`integrate`].
///
/// ```
/// use toolroom_process::ode::{Tolerance, integrate_watched};
/// let tolerance = Tolerance { relative: 1e-9, absolute: [1e-12] };
/// let mut middle = 0.0;
/// let decay = |_: f64, y: &[f64; 1]| [-y[0]];
/// integrate_watched(decay, |_, _| [-1.0], &[1.0], 5.0, &tolerance, |step| {
///     if step.start < 2.0 && step.end >= 2.0 {
///         middle = step.at(2.0)[0];
///     }
/// })
/// .unwrap();
/// assert!((middle - (-2.0f64).exp()).abs() < 1e-8);
/// ```
pub fn integrate_watched<const D: usize, const E: usize>(
    mut rhs: impl FnMut(f64, &[f64; D]) -> [f64; D],
    events: impl FnMut(f64, &[f64; D]) -> [f64; E],
    y: &[f64; D],
    t_end: f64,
    tolerance: &Tolerance<D>,
    watch: impl FnMut(&Stretch<'_, D>),
) -> Result<Integration<D>, ModelError> {
    let slope = if t_end > 0.0 { rhs(0.0, y) } else { [0.0; D] };
    integrate_from(rhs, events, y, &slope, t_end, tolerance, watch)
}

/// [`integrate_watched`] where the right-hand side at the start is known.
fn integrate_from<const D: usize, const E: usize>(
    mut rhs: impl FnMut(f64, &[f64; D]) -> [f64; D],
    mut events: impl FnMut(f64, &[f64; D]) -> [f64; E],
    y: &[f64; D],
    slope: &[f64; D],
    t_end: f64,
    tolerance: &Tolerance<D>,
    mut watch: impl FnMut(&Stretch<'_, D>),
) -> Result<Integration<D>, ModelError> {
    if !(t_end >= 0.0 && t_end.is_finite()) {
        return Err(ModelError::Step { seconds: t_end });
    }
    let mut before = events(0.0, y);
    let held = before.iter().position(|value| *value >= 0.0);
    let mut integration = Integration { time: 0.0, state: *y, event: held, steps: 0, rejected: 0, evaluations: 1 };
    if held.is_some() || t_end == 0.0 {
        return Ok(integration);
    }
    let mut k1 = *slope;
    let least = LEAST_STEP * t_end;
    let mut h = first_step(y, &k1, t_end, tolerance);
    while integration.time < t_end {
        // The last step is stretched a little rather than leaving a crumb behind.
        let last = integration.time + 1.01 * h >= t_end;
        if last {
            h = t_end - integration.time;
        }
        let step = dormand_prince(&mut rhs, integration.time, &integration.state, &k1, h);
        integration.evaluations += 6;
        let error = step.error_norm(&integration.state, tolerance);
        if error.is_nan() || error > 1.0 {
            integration.rejected += 1;
            h *= if error.is_nan() { 0.1 } else { (0.9 * error.powf(-0.2)).max(0.2) };
            // A slope that is no number gives a step that is none.
            if h.is_nan() || h < least {
                return Err(ModelError::StepTooSmall { time: integration.time, step: least });
            }
            continue;
        }
        integration.steps += 1;
        let end = if last { t_end } else { integration.time + h };
        let after = events(end, &step.end);
        let crossed = |i: usize| before[i] < 0.0 && after[i] >= 0.0;
        if (0..E).any(crossed) {
            let dense = step.dense(&integration.state, &k1, h);
            let (share, index) = locate(&mut events, &dense, integration.time, h, &before, &after);
            watch(&Stretch {
                start: integration.time,
                end: integration.time + share * h,
                length: h,
                y: &integration.state,
                k1: &k1,
                step: &step,
            });
            integration.state = if share == 1.0 { step.end } else { dense.at(share) };
            integration.time += share * h;
            integration.event = Some(index);
            return Ok(integration);
        }
        watch(&Stretch { start: integration.time, end, length: h, y: &integration.state, k1: &k1, step: &step });
        integration.time = end;
        integration.state = step.end;
        k1 = step.k7;
        before = after;
        h *= (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.2, 5.0);
    }
    Ok(integration)
}

/// [`integrate_watched`] in stages of at most `stage(slope)` seconds, `slope` being the right-hand
/// side at their start.
///
/// An error estimate sees a right-hand side only where it samples it: a curve that is equally
/// steep on both sides of a bend passes for a straight line in one long step. Stages that the
/// problem itself knows (a tenth of an edge's wear) prevent that.
///
/// # Errors
/// As [`integrate`].
pub fn integrate_staged<const D: usize, const E: usize>(
    mut rhs: impl FnMut(f64, &[f64; D]) -> [f64; D],
    mut events: impl FnMut(f64, &[f64; D]) -> [f64; E],
    y: &[f64; D],
    t_end: f64,
    tolerance: &Tolerance<D>,
    stage: impl Fn(&[f64; D]) -> f64,
    mut watch: impl FnMut(&Stretch<'_, D>),
) -> Result<Integration<D>, ModelError> {
    let mut total = integrate(&mut rhs, &mut events, y, if t_end > 0.0 { 0.0 } else { t_end }, tolerance)?;
    while total.event.is_none() && total.time < t_end {
        let (start, rest) = (total.time, t_end - total.time);
        let slope = rhs(start, &total.state);
        let stage = stage(&slope);
        // A stage that is not a number is no limit.
        let last = stage.is_nan() || stage >= rest;
        let part = integrate_from(
            |time, y| rhs(start + time, y),
            |time, y| events(start + time, y),
            &total.state,
            &slope,
            if last { rest } else { stage },
            tolerance,
            |step| watch(&Stretch { start: start + step.start, end: start + step.end, ..*step }),
        )?;
        total.state = part.state;
        total.steps += part.steps;
        total.rejected += part.rejected;
        total.evaluations += part.evaluations;
        total.event = part.event;
        total.time = if last && part.event.is_none() { t_end } else { start + part.time };
    }
    Ok(total)
}

/// Values of event functions without those that have `passed`: for systems that go on past an event, which would
/// otherwise end every later integration at its start.
///
/// ```
/// use toolroom_process::ode::{Tolerance, integrate, unless_passed};
/// let tolerance = Tolerance { relative: 1e-9, absolute: [1e-12] };
/// // Past the first of two marks: at once with it, at the second without it.
/// let marks = |y: &[f64; 1]| [y[0] - 1.0, y[0] - 3.0];
/// let past = [true, false];
/// let with = integrate(|_, _| [1.0], |_, y| marks(y), &[2.0], 5.0, &tolerance).unwrap();
/// let without = integrate(|_, _| [1.0], |_, y| unless_passed(past, marks(y)), &[2.0], 5.0, &tolerance).unwrap();
/// assert_eq!((with.event, with.time), (Some(0), 0.0));
/// assert_eq!(without.event, Some(1));
/// ```
pub fn unless_passed<const E: usize>(passed: [bool; E], events: [f64; E]) -> [f64; E] {
    std::array::from_fn(|i| if passed[i] { f64::NEG_INFINITY } else { events[i] })
}

/// Greatest change of a component in a [`short_step`], share of its size and scale.
const SHORT: f64 = 0.02;

/// A right-hand side that time does not enter. A closure is one; a type of its own may have it
/// compiled into the step with `#[inline(always)]`, so that what it returns stays in registers.
pub trait Autonomous<const D: usize> {
    /// The right-hand side at `y`.
    fn slope(&self, y: &[f64; D]) -> [f64; D];
}

impl<const D: usize, F: Fn(&[f64; D]) -> [f64; D]> Autonomous<D> for F {
    #[inline]
    fn slope(&self, y: &[f64; D]) -> [f64; D] {
        self(y)
    }
}

/// One third-order step over `h` where so little changes in it that this is accurate enough; `None` where it is not. It takes
/// three calls of the right-hand side, whatever went before it.
///
/// Accurate enough is: no component changes by more than 2 % of its size plus its scale
/// (`absolute/relative` of the tolerance), and the error of the embedded second-order step is
/// within the tolerance. That of the step itself is smaller by the ratio of `h` to the time in
/// which the right-hand side changes.
///
/// # Source
/// Bogacki & Shampine, Appl. Math. Lett. 2 (1989) 321-325: the third-order step. Their second-order step asks for the
/// right-hand side at the end as well, which the next step can only use where its input is the same; an input that changes
/// with every step would cost a fourth call. The weights 1/9, 2/3, 2/9 of the same three calls meet the conditions of second
/// order, too, and their error is at least that of Bogacki and Shampine in each of the two terms of third order:
///
/// | term | this | Bogacki & Shampine |
/// |---|---|---|
/// | f'f'f | 1/12 | 1/48 |
/// | f''(f, f) | 1/48 | 1/48 |
///
/// ```
/// use toolroom_process::ode::{Tolerance, short_step};
/// let tolerance = Tolerance { relative: 1e-7, absolute: [1e-7] };
/// let end = short_step(&|y: &[f64; 1]| [-y[0]], &[1.0], 0.01, &tolerance).unwrap();
/// assert!((end[0] - (-0.01f64).exp()).abs() < 1e-9);
/// ```
#[inline]
pub fn short_step<const D: usize>(
    rhs: &impl Autonomous<D>,
    y: &[f64; D],
    h: f64,
    tolerance: &Tolerance<D>,
) -> Option<[f64; D]> {
    let relative = tolerance.relative;
    let size = |i: usize| tolerance.absolute[i] + relative * y[i].abs();
    let k1 = rhs.slope(y);
    if !every(D, |i| (h * k1[i]).abs() * relative <= SHORT * size(i)) {
        return None;
    }
    let k2 = rhs.slope(&std::array::from_fn(|i| y[i] + 0.5 * h * k1[i]));
    let k3 = rhs.slope(&std::array::from_fn(|i| y[i] + 0.75 * h * k2[i]));
    let error = |i: usize| h * (1.0 / 9.0) * (k1[i] - 3.0 * k2[i] + 2.0 * k3[i]);
    every(D, |i| error(i).abs() <= size(i))
        .then(|| std::array::from_fn(|i| y[i] + h * (2.0 / 9.0 * k1[i] + 1.0 / 3.0 * k2[i] + 4.0 / 9.0 * k3[i])))
}

/// Whether a condition holds for every component, without a branch for each.
#[inline]
fn every(components: usize, holds: impl Fn(usize) -> bool) -> bool {
    (0..components).fold(true, |so_far, i| so_far & holds(i))
}

/// An accepted step of an integration.
#[derive(Clone, Copy)]
pub struct Stretch<'a, const D: usize> {
    /// Time at its start, s.
    pub start: f64,
    /// Time at its end, or at the event that cut it short, s.
    pub end: f64,
    length: f64,
    y: &'a [f64; D],
    k1: &'a [f64; D],
    step: &'a Step<D>,
}

impl<const D: usize> Stretch<'_, D> {
    /// State at `time` between its ends.
    pub fn at(&self, time: f64) -> [f64; D] {
        self.step.dense(self.y, self.k1, self.length).at((time - self.start) / self.length)
    }
}

/// First share of the step at which an event function is no longer negative, and which.
fn locate<const D: usize, const E: usize>(
    events: &mut impl FnMut(f64, &[f64; D]) -> [f64; E],
    dense: &Dense<D>,
    time: f64,
    h: f64,
    before: &[f64; E],
    after: &[f64; E],
) -> (f64, usize) {
    let mut earliest = (1.0, usize::MAX);
    for index in (0..E).filter(|i| before[*i] < 0.0 && after[*i] >= 0.0) {
        let (mut low, mut high) = (0.0, 1.0);
        while high - low > 1e-12 {
            let middle = 0.5 * (low + high);
            if events(time + middle * h, &dense.at(middle))[index] < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        if high < earliest.0 || earliest.1 == usize::MAX {
            earliest = (high, index);
        }
    }
    earliest
}

struct Step<const D: usize> {
    end: [f64; D],
    error: [f64; D],
    k3: [f64; D],
    k4: [f64; D],
    k5: [f64; D],
    k6: [f64; D],
    k7: [f64; D],
}

/// Coefficients of the Dormand–Prince 5(4) pair with first-same-as-last.
fn dormand_prince<const D: usize>(
    rhs: &mut impl FnMut(f64, &[f64; D]) -> [f64; D],
    t: f64,
    y: &[f64; D],
    k1: &[f64; D],
    h: f64,
) -> Step<D> {
    let k2 = rhs(t + h / 5.0, &std::array::from_fn(|i| y[i] + h * (k1[i] / 5.0)));
    let k3 = rhs(t + 0.3 * h, &std::array::from_fn(|i| y[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i])));
    let k4 = rhs(
        t + 0.8 * h,
        &std::array::from_fn(|i| y[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i])),
    );
    let k5 = rhs(
        t + 8.0 / 9.0 * h,
        &std::array::from_fn(|i| {
            y[i] + h
                * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i] + 64448.0 / 6561.0 * k3[i]
                    - 212.0 / 729.0 * k4[i])
        }),
    );
    let k6 = rhs(
        t + h,
        &std::array::from_fn(|i| {
            y[i] + h
                * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i] + 46732.0 / 5247.0 * k3[i] + 49.0 / 176.0 * k4[i]
                    - 5103.0 / 18656.0 * k5[i])
        }),
    );
    let end: [f64; D] = std::array::from_fn(|i| {
        y[i] + h
            * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i] + 125.0 / 192.0 * k4[i] - 2187.0 / 6784.0 * k5[i]
                + 11.0 / 84.0 * k6[i])
    });
    let k7 = rhs(t + h, &end);
    let error = std::array::from_fn(|i| {
        h * (71.0 / 57600.0 * k1[i] - 71.0 / 16695.0 * k3[i] + 71.0 / 1920.0 * k4[i] - 17253.0 / 339200.0 * k5[i]
            + 22.0 / 525.0 * k6[i]
            - k7[i] / 40.0)
    });
    Step { end, error, k3, k4, k5, k6, k7 }
}

impl<const D: usize> Step<D> {
    /// Root mean square of the error in units of the tolerance; at most 1 is accepted.
    fn error_norm(&self, y: &[f64; D], tolerance: &Tolerance<D>) -> f64 {
        let mut sum = 0.0;
        for (i, start) in y.iter().enumerate() {
            let scale = tolerance.absolute[i] + tolerance.relative * start.abs().max(self.end[i].abs());
            sum += (self.error[i] / scale).powi(2);
        }
        (sum / D as f64).sqrt()
    }

    fn dense(&self, y: &[f64; D], k1: &[f64; D], h: f64) -> Dense<D> {
        let rise: [f64; D] = std::array::from_fn(|i| self.end[i] - y[i]);
        let bend: [f64; D] = std::array::from_fn(|i| h * k1[i] - rise[i]);
        Dense {
            start: *y,
            rise,
            bend,
            third: std::array::from_fn(|i| rise[i] - h * self.k7[i] - bend[i]),
            fourth: std::array::from_fn(|i| {
                h * (-12715105075.0 / 11282082432.0 * k1[i] + 87487479700.0 / 32700410799.0 * self.k3[i]
                    - 10690763975.0 / 1880347072.0 * self.k4[i]
                    + 701980252875.0 / 199316789632.0 * self.k5[i]
                    - 1453857185.0 / 822651844.0 * self.k6[i]
                    + 69997945.0 / 29380423.0 * self.k7[i])
            }),
        }
    }
}

/// Fourth-order polynomial over one step.
struct Dense<const D: usize> {
    start: [f64; D],
    rise: [f64; D],
    bend: [f64; D],
    third: [f64; D],
    fourth: [f64; D],
}

impl<const D: usize> Dense<D> {
    fn at(&self, share: f64) -> [f64; D] {
        let rest = 1.0 - share;
        std::array::from_fn(|i| {
            self.start[i]
                + share * (self.rise[i] + rest * (self.bend[i] + share * (self.third[i] + rest * self.fourth[i])))
        })
    }
}

/// Starting step: a tenth of the time in which the state would change by its own size. A fifth
/// order pair at the tolerances used here takes steps of about that length.
fn first_step<const D: usize>(y: &[f64; D], slope: &[f64; D], t_end: f64, tolerance: &Tolerance<D>) -> f64 {
    let (mut size, mut speed) = (0.0f64, 0.0f64);
    for i in 0..D {
        let scale = tolerance.absolute[i] + tolerance.relative * y[i].abs();
        size += (y[i] / scale).powi(2);
        speed += (slope[i] / scale).powi(2);
    }
    let guess = if size < 1e-10 || speed < 1e-10 { 1e-2 * t_end } else { 0.1 * (size / speed).sqrt() };
    guess.clamp(1e-6 * t_end, t_end)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIGHT: Tolerance<2> = Tolerance { relative: 1e-10, absolute: [1e-12; 2] };

    fn oscillator(_: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], -y[0]]
    }

    #[test]
    fn a_short_step_errs_by_the_fourth_power_of_its_length_and_is_refused_by_its_estimate() {
        // y' = -y², y(0) = 1: y = 1/(1 + t), f'f'f = -4, f''(f, f) = -2, so that the estimate is (4/12 + 2/48) h³.
        let step = |h: f64, relative: f64| {
            let tolerance = Tolerance { relative, absolute: [relative] };
            Some(short_step(&|y: &[f64; 1]| [-y[0] * y[0]], &[1.0], h, &tolerance)?[0])
        };
        let error = |h: f64| (step(h, 1e-3).expect("short") - 1.0 / (1.0 + h)).abs();
        let ratio = error(0.016) / error(0.008);
        assert!((ratio / 16.0 - 1.0).abs() < 0.1, "{ratio}");
        // The tolerance at 1 is 2e-7, which the estimate meets at h = 0.0081.
        assert!(step(0.0079, 1e-7).is_some() && step(0.0083, 1e-7).is_none());
        assert!(error(0.0079) < 0.1 * 2e-7, "{}", error(0.0079));
        // More than 2 % of size and scale.
        assert!(step(0.05, 1.0).is_none());
    }

    #[test]
    fn the_oscillator_returns_after_one_period() {
        let end = integrate(oscillator, |_, _| [-1.0], &[1.0, 0.0], std::f64::consts::TAU, &TIGHT).unwrap();
        assert!((end.state[0] - 1.0).abs() < 1e-8 && end.state[1].abs() < 1e-8, "{end:?}");
    }

    #[test]
    fn an_event_is_located_and_never_overshot_backwards() {
        // cos t falls through 0.3 at acos 0.3.
        let end = integrate(oscillator, |_, y| [0.3 - y[0]], &[1.0, 0.0], 10.0, &TIGHT).unwrap();
        assert!((end.time - 0.3f64.acos()).abs() < 1e-8, "{end:?}");
        assert!(end.state[0] <= 0.3 + 1e-9);
    }

    #[test]
    fn the_earliest_of_two_events_wins() {
        let end = integrate(
            |_, _| [1.0],
            |_, y: &[f64; 1]| [y[0] - 2.0, y[0] - 1.5],
            &[0.0],
            100.0,
            &Tolerance { relative: 1e-6, absolute: [1e-6] },
        )
        .unwrap();
        assert_eq!(end.event, Some(1));
        assert!((end.time - 1.5).abs() < 1e-9);
    }

    #[test]
    fn an_event_that_already_holds_ends_an_integration_at_once() {
        let tolerance = Tolerance { relative: 1e-6, absolute: [1e-6] };
        for (start, t_end) in [(2.0, 100.0), (1.5, 100.0), (2.0, 0.0)] {
            let events = |_: f64, y: &[f64; 1]| [y[0] - 9.0, y[0] - 1.5];
            let plain = integrate(|_, _| [1.0], events, &[start], t_end, &tolerance).unwrap();
            let staged = integrate_staged(|_, _| [1.0], events, &[start], t_end, &tolerance, |_| 0.1, |_| ()).unwrap();
            for end in [plain, staged] {
                assert_eq!((end.event, end.time, end.state, end.steps), (Some(1), 0.0, [start], 0));
            }
        }
        // Passed events are left out, the others still found, in stages as in one.
        let beyond = |_: f64, y: &[f64; 1]| unless_passed([false, true], [y[0] - 9.0, y[0] - 1.5]);
        let end = integrate_staged(|_, _| [1.0], beyond, &[2.0], 100.0, &tolerance, |_| 0.3, |_| ()).unwrap();
        assert!(end.event == Some(0) && (end.time - 7.0).abs() < 1e-9, "{end:?}");
    }

    #[test]
    fn both_methods_converge_with_their_order() {
        let exact = (-1.0f64).exp();
        let error = |n: u32| {
            let h = 1.0 / f64::from(n);
            let y = (0..n).fold([1.0], |y, i| rk4(|_, y: &[f64; 1]| [-y[0]], f64::from(i) * h, &y, h));
            (y[0] - exact).abs()
        };
        let order = (error(10) / error(20)).log2();
        assert!((order - 4.0).abs() < 0.1, "observed order {order}");
        let adaptive = |relative: f64| {
            let tolerance = Tolerance { relative, absolute: [relative] };
            let end = integrate(|_, y: &[f64; 1]| [-y[0]], |_, _| [-1.0], &[1.0], 1.0, &tolerance).unwrap();
            (end.state[0] - exact).abs()
        };
        for relative in [1e-4, 1e-6, 1e-8, 1e-10] {
            assert!(adaptive(relative) < relative, "tolerance {relative} not met: {}", adaptive(relative));
        }
    }

    #[test]
    fn stages_see_the_bend_that_one_step_misses() {
        // Steep at first, flat between 1 and 2, steep again from then on.
        let rate = |y: f64| 1.0 - 0.99 * (-(4.0 * (y - 1.5)).powi(4)).exp();
        let tolerance = Tolerance { relative: 1e-8, absolute: [1e-8] };
        let end = integrate_staged(
            |_, y: &[f64; 1]| [rate(y[0])],
            |_, y| [y[0] - 3.0],
            &[0.0],
            1e9,
            &tolerance,
            |slope| 0.1 / slope[0],
            |_| (),
        )
        .unwrap();
        assert_eq!(end.event, Some(0));
        // Midpoint rule over the same bend.
        let n = 100_000;
        let time: f64 = (0..n).map(|i| 3.0 / f64::from(n) / rate((f64::from(i) + 0.5) * 3.0 / f64::from(n))).sum();
        assert!((end.time / time - 1.0).abs() < 1e-6, "{end:?}, not {time}");
    }

    #[test]
    fn a_right_hand_side_that_is_no_number_at_the_start_ends() {
        // The state is known by then, so that the first step follows from the slope.
        let tolerance = Tolerance { relative: 1e-6, absolute: [1e-6; 2] };
        let end = integrate(|_, _| [1.0, f64::NAN], |_, _: &[f64; 2]| [-1.0], &[1.0, 1.0], 1.0, &tolerance);
        assert!(matches!(end, Err(ModelError::StepTooSmall { .. })), "{end:?}");
    }

    #[test]
    fn a_broken_right_hand_side_is_refused() {
        let end = integrate(
            |_, _| [f64::NAN],
            |_, _: &[f64; 1]| [-1.0],
            &[0.0],
            1.0,
            &Tolerance { relative: 1e-6, absolute: [1e-6] },
        );
        assert!(matches!(end, Err(ModelError::StepTooSmall { .. })));
        assert!(matches!(
            integrate(
                |_, _| [0.0],
                |_, _: &[f64; 1]| [-1.0],
                &[0.0],
                -1.0,
                &Tolerance { relative: 1e-6, absolute: [1.0] }
            ),
            Err(ModelError::Step { .. })
        ));
    }
}
