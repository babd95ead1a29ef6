//! The contract suite that every process runs: [`process_contract!`](crate::process_contract!).

use crate::{AnyRecord, Field, Process, Record, unit};

/// A point of the operating range at which the contract is checked: an input and the duration
/// of a step, s.
pub type Point<P> = (<P as Process>::Input, f64);

/// Splitting a step gives the same state to `relative` of each component's largest value.
pub fn split_invariance<P: Process>(process: &P, points: &[Point<P>], relative: f64) {
    for (input, duration) in points {
        let mut whole = process.initial();
        let advance = process.advance(&mut whole, input, *duration).expect("contract points lie in the domain");
        let mut parts = process.initial();
        let mut held = *input;
        let mut left = advance.elapsed;
        for share in [0.31, 0.5, 1.0] {
            let step = share * left;
            let part = process.advance(&mut parts, &held, step).expect("contract points lie in the domain");
            held = process.input_after(&held, part.elapsed);
            left -= part.elapsed;
            if part.event.is_some() {
                break;
            }
        }
        for i in 0..P::State::LEN {
            let (a, b) = (whole.get(i).unwrap_or(0.0), parts.get(i).unwrap_or(0.0));
            assert!((a - b).abs() <= relative * a.abs().max(b.abs()) + 1e-15, "state {i}: {a} whole, {b} in parts");
        }
    }
}

/// A look on the way shows what stopping there would, to `relative`, and changes nothing but
/// within the same accuracy.
pub fn looks_show_the_way<P: Process>(process: &P, points: &[Point<P>], relative: f64) {
    let close = |a: f64, b: f64| (a - b).abs() <= relative * a.abs().max(b.abs()) + 1e-12;
    for (input, duration) in points {
        let mut plain = process.initial();
        let elapsed = process.advance(&mut plain, input, *duration).expect("contract points lie in the domain").elapsed;
        let times = [0.1, 0.37, 0.5, 0.99].map(|share| share * elapsed);
        let mut seen = Vec::new();
        let mut watched = process.initial();
        let advance = process
            .advance_watched(&mut watched, input, *duration, &times, &mut |i, u, y| seen.push((i, *u, *y)))
            .expect("contract points lie in the domain");
        assert!(close(advance.elapsed, elapsed));
        for i in 0..P::State::LEN {
            let (a, b) = (plain.get(i).unwrap_or(0.0), watched.get(i).unwrap_or(0.0));
            assert!(close(a, b), "state {i}: {a} without, {b} with looks");
        }
        assert_eq!(seen.iter().map(|look| look.0).collect::<Vec<_>>(), [0, 1, 2, 3]);
        for (i, u, y) in seen {
            let mut state = process.initial();
            process.advance(&mut state, input, times[i]).expect("contract points lie in the domain");
            assert_eq!(u, process.input_after(input, times[i]));
            let stopped = process.output(&state, &u);
            for k in 0..P::Output::LEN {
                let (a, b) = (stopped.get(k).unwrap_or(0.0), y.get(k).unwrap_or(0.0));
                assert!(close(a, b), "output {k} after {} s: {a} there, {b} seen", times[i]);
            }
        }
    }
}

/// The same call gives the same bits.
pub fn determinism<P: Process>(process: &P, points: &[Point<P>]) {
    for (input, duration) in points {
        let run = || {
            let mut state = process.initial();
            let advance = process.advance(&mut state, input, *duration);
            (state, advance, process.output(&state, input))
        };
        assert_eq!(run(), run());
    }
}

/// Outputs and states stay finite and inside their ranges.
pub fn finite_outputs<P: Process>(process: &P, points: &[Point<P>]) {
    for (input, duration) in points {
        let mut state = process.initial();
        process.output(&state, input).check().expect("output of a new edge");
        process.advance(&mut state, input, *duration).expect("contract points lie in the domain");
        state.check().expect("state after a step");
        process.output(&state, input).check().expect("output after a step");
    }
}

/// A step is as long as requested, or an event cut it short.
pub fn events_stop_the_step<P: Process>(process: &P, points: &[Point<P>]) {
    let mut indicators = vec![0.0; P::EVENTS.len()];
    for (input, duration) in points {
        let mut state = process.initial();
        for _ in 0..200 {
            let advance = process.advance(&mut state, input, *duration).expect("contract points lie in the domain");
            match advance.event {
                None => assert_eq!(advance.elapsed, *duration),
                Some(event) => {
                    assert!(advance.elapsed <= *duration);
                    let index = P::EVENTS.iter().position(|each| *each == event).expect("a declared event");
                    process.event_indicators(&state, input, &mut indicators);
                    assert!(indicators[index] >= -1e-9, "{event:?} raised at {}", indicators[index]);
                    break;
                }
            }
        }
    }
}

/// Range of each element of a record.
fn ranges(fields: &[Field]) -> impl Iterator<Item = [f64; 2]> + '_ {
    fields.iter().flat_map(|field| std::iter::repeat_n([field.min, field.max], field.len))
}

/// An event that holds at the start and ends the cut is reported at once; past any other the step goes on and
/// does not tell it again.
///
/// Every component of the state is raised until an event holds, every input is set to either end of its range.
/// Each declared event has to hold somewhere, so that the check is never empty.
pub fn held_events_are_told_at_once<P: Process>(process: &P, points: &[Point<P>]) {
    let held = |state: &P::State, input: &P::Input| -> Vec<bool> {
        let mut indicators = vec![0.0; P::EVENTS.len()];
        process.event_indicators(state, input, &mut indicators);
        indicators.into_iter().map(|value| value >= 0.0).collect()
    };
    let mut seen = vec![false; P::EVENTS.len()];
    for (input, duration) in points {
        if P::Input::index_of("engaged").and_then(|i| input.get(i)) == Some(0.0) {
            continue;
        }
        let mut cut = process.initial();
        process.advance(&mut cut, input, 0.3 * duration).expect("contract points lie in the domain");
        let mut starts: Vec<(P::State, P::Input, bool)> = Vec::new();
        for (i, [_, most]) in ranges(P::State::FIELDS).enumerate() {
            // Just past the event: the least power of ten of the range at which it holds.
            let raised = (0..=120).map(|tenth| {
                let mut state = cut;
                state.set(i, most * 10f64.powf(0.1 * f64::from(tenth) - 12.0));
                state
            });
            starts
                .extend(raised.into_iter().find(|state| held(state, input).contains(&true)).map(|x| (x, *input, true)));
        }
        for (i, ends) in ranges(P::Input::FIELDS).enumerate() {
            for end in ends {
                let mut changed = *input;
                changed.set(i, end);
                starts.push((cut, changed, false));
            }
        }
        for (start, input, in_domain) in starts {
            let held = held(&start, &input);
            if !held.contains(&true) {
                continue;
            }
            let mut state = start;
            let advance = match process.advance(&mut state, &input, *duration) {
                Ok(advance) => advance,
                // An input at the end of its range may contradict another.
                Err(_) if !in_domain => continue,
                Err(error) => panic!("{start:?}: {error}"),
            };
            seen.iter_mut().zip(&held).for_each(|(seen, held)| *seen |= held);
            let reported = advance.event.and_then(|event| P::EVENTS.iter().position(|each| *each == event));
            if P::EVENTS.iter().zip(&held).any(|(event, held)| *held && event.ends_cut()) {
                assert!(reported.is_some_and(|i| held[i] && P::EVENTS[i].ends_cut()), "{start:?}: {advance:?}");
                assert_eq!((advance.elapsed, state), (0.0, start));
            } else {
                assert!(reported.is_none_or(|i| !held[i]), "{start:?}: {advance:?} was reported before");
            }
        }
    }
    assert!(!seen.contains(&false), "of {:?} there held: {seen:?}", P::EVENTS);
}

/// Inputs out of range and broken steps are refused and leave the state alone.
pub fn domain_errors<P: Process>(process: &P, points: &[Point<P>]) {
    let (input, duration) = points.first().expect("at least one contract point");
    let refused = |input: &P::Input, duration: f64| {
        let mut state = process.initial();
        assert!(process.advance(&mut state, input, duration).is_err(), "{input:?} over {duration} s was accepted");
        assert_eq!(state, process.initial());
    };
    for step in [-1.0, f64::NAN, f64::INFINITY] {
        refused(input, step);
    }
    for i in 0..P::Input::LEN {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut broken = *input;
            broken.set(i, value);
            refused(&broken, *duration);
        }
    }
}

/// The right-hand side, where there is one, is the slope of `advance`.
pub fn derivative_is_the_slope<P: Process>(process: &P, points: &[Point<P>], relative: f64) {
    for (input, duration) in points {
        let mut state = process.initial();
        process.advance(&mut state, input, 0.3 * duration).expect("contract points lie in the domain");
        let input = process.input_after(input, 0.3 * duration);
        let Some(slope) = process.derivative(&state, &input) else { return };
        let h = 1e-4 * duration;
        let (mut one, mut two) = (state, state);
        process.advance(&mut one, &input, h).expect("a short step");
        process.advance(&mut two, &input, 2.0 * h).expect("a short step");
        for i in 0..P::State::LEN {
            let at = |record: &P::State| record.get(i).unwrap_or(0.0);
            let difference = (4.0 * at(&one) - at(&two) - 3.0 * at(&state)) / (2.0 * h);
            let expected = at(&slope);
            let scale = expected.abs().max(at(&state).abs() / duration).max(1e-12);
            assert!((difference - expected).abs() <= relative * scale, "state {i}: slope {difference}, rhs {expected}");
        }
    }
}

/// Expressing every parameter and input in other base units changes outputs and states by
/// their dimension and by nothing else: no dimensional constant hides in an equation.
pub fn unit_rescaling<P: Process + Clone>(process: &P, points: &[Point<P>], relative: f64) {
    // One metre of the new system is 1/3 m and so on; deliberately no powers of ten.
    const BASE: [f64; 8] = [3.0, 0.7, 1.7, 1.3, 2.1, 1.0, 1.0, 1.0];
    let scale = |si: &str| {
        let dimension = unit::parse(si).unwrap_or_else(|(symbol, _)| panic!("unit {symbol} is not known")).dimension;
        BASE.iter().zip(dimension).map(|(base, power)| base.powi(i32::from(power))).product::<f64>()
    };
    let rescale = |record: &mut dyn AnyRecord| {
        let mut index = 0;
        for field in record.fields() {
            for _ in 0..field.len {
                if let Some(value) = record.value(index) {
                    record.set_value(index, value * scale(field.unit));
                }
                index += 1;
            }
        }
    };
    let mut other = process.clone();
    for (_, group) in other.parameters_mut() {
        rescale(group);
    }
    for (input, duration) in points {
        let mut state = process.initial();
        process.advance(&mut state, input, *duration).expect("contract points lie in the domain");
        let mut output = process.output(&state, input);
        rescale(&mut output);
        let (mut other_state, mut other_input) = (state, *input);
        rescale(&mut other_state);
        rescale(&mut other_input);
        let other_output = other.output(&other_state, &other_input);
        let mut index = 0;
        for field in P::Output::FIELDS {
            for _ in 0..field.len {
                let (a, b) = (output.get(index).unwrap_or(0.0), other_output.get(index).unwrap_or(0.0));
                assert!((a - b).abs() <= relative * a.abs().max(b.abs()), "{}: {a} expected, {b} computed", field.name);
                index += 1;
            }
        }
    }
}

/// Runs the whole contract on a process: `process_contract!(name, process, points)` makes a
/// module `name` of tests. `points` is a `Vec` of (input, duration) inside the domain.
#[macro_export]
macro_rules! process_contract {
    ($name:ident, $process:expr, $points:expr) => {
        mod $name {
            use super::*;
            use $crate::contract;

            #[test]
            fn splitting_a_step_changes_nothing() {
                contract::split_invariance(&$process, &$points, 1e-6);
            }
            #[test]
            fn looks_on_the_way_show_what_a_stop_would() {
                contract::looks_show_the_way(&$process, &$points, 1e-4);
            }
            #[test]
            fn the_same_call_gives_the_same_bits() {
                contract::determinism(&$process, &$points);
            }
            #[test]
            fn outputs_are_finite_and_in_range() {
                contract::finite_outputs(&$process, &$points);
            }
            #[test]
            fn only_an_event_shortens_a_step() {
                contract::events_stop_the_step(&$process, &$points);
            }
            #[test]
            fn an_event_that_already_holds_is_told_at_once() {
                contract::held_events_are_told_at_once(&$process, &$points);
            }
            #[test]
            fn what_lies_outside_the_domain_is_refused() {
                contract::domain_errors(&$process, &$points);
            }
            #[test]
            fn the_right_hand_side_is_the_slope() {
                contract::derivative_is_the_slope(&$process, &$points, 1e-3);
            }
            #[test]
            fn other_units_give_the_same_physics() {
                contract::unit_rescaling(&$process, &$points, 1e-9);
            }
        }
    };
}
