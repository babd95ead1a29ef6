//! A pass on the process model: planned as a whole on a copy of the edge's state, taken over
//! when it ends, planned again for a shorter time when it is interrupted.

use super::cut_fault::{CutFault, STUCK};
use super::ports::{Ports, elements, read, write};
use super::program::Program;
use super::reaction::Reaction;
use super::vibration::{Instant, Listener, Vibration};
use toolroom_process::{MachineProcess, ProcessEvent, watched};
use toolroom_scenario::policies::{Sample, Stability};

/// A stretch of cutting under one command: where it starts, where it ends, what happens.
#[derive(Clone, Debug, Default)]
pub struct Segment {
    /// Input at the start.
    pub start_input: Vec<f64>,
    /// Commands that change within the pass.
    pub program: Program,
    /// Input at the end (a ramp has moved the speed).
    pub input: Vec<f64>,
    /// State at the end.
    pub state: Vec<f64>,
    /// Output at the end.
    pub output: Vec<f64>,
    /// Duration requested, s.
    pub requested: f64,
    /// Time between samples, s; `None` where nobody watches.
    pub sampling_period: Option<f64>,
    /// Duration, s; shorter than requested where the edge is lost.
    pub elapsed: f64,
    /// What the edge was lost by.
    pub lost: Option<ProcessEvent>,
    /// Events that do not stop the cut, with their time since the start, s.
    pub passed: Vec<(f64, ProcessEvent)>,
    /// Mechanical energy, J.
    pub energy: f64,
    /// Time in engagement, s; 0 where the process knows no cutting speed.
    pub engaged_time: f64,
    /// Cutting speed integrated over that time, m.
    pub cutting_length: f64,
    /// Sensor samples.
    pub samples: Vec<Sample>,
    /// Vibration, where the process judges it.
    pub vibration: Option<Vibration>,
    /// When a controller that has heard chatter stops it, s.
    pub stop: Option<f64>,
}

impl Segment {
    /// Cuts from `state` under [`Segment::start_input`] for `duration`, with a sensor sample
    /// every `sampling_period`.
    pub fn plan(
        &mut self,
        process: &dyn MachineProcess,
        ports: &Ports,
        state: &[f64],
        duration: f64,
        sampling_period: Option<f64>,
    ) -> Result<(), CutFault> {
        self.input.clone_from(&self.start_input);
        let mut boundary = self.program.command(0.0, &mut self.input);
        self.state.clear();
        self.state.extend_from_slice(state);
        self.output.resize(elements(process.outputs()), 0.0);
        self.passed.clear();
        self.samples.clear();
        self.lost = None;
        self.energy = 0.0;
        self.engaged_time = 0.0;
        self.cutting_length = 0.0;
        self.requested = duration;
        self.sampling_period = sampling_period;
        // A process that counts its energy does so better than samples of its power.
        let counted = ports.energy_state.map(|i| self.state[i]);
        if counted.is_none() {
            process.output(&self.state, &self.input, &mut self.output);
        }
        let mut power = read(&self.output, ports.spindle_power, 0.0);
        let (mut time, mut stuck) = (0.0, 0);
        let mut times = Vec::new();
        let mut listener = ports.structure.then(|| Listener::new(process, ports));
        while time < duration {
            if time >= boundary {
                boundary = self.program.command(time, &mut self.input);
                process.output(&self.state, &self.input, &mut self.output);
                power = read(&self.output, ports.spindle_power, 0.0);
            }
            let goal = duration.min(boundary);
            let taken = self.samples.len() as f64;
            let next = |i: usize| sampling_period.map(|period| (taken + 1.0 + i as f64) * period);
            times.clear();
            times.extend((0..).map_while(next).take_while(|next| *next < goal).map(|next| next - time));
            let (samples, energy) = (&mut self.samples, &mut self.energy);
            let speed_before = read(&self.input, ports.cutting_speed, 0.0);
            let engaged = ports.cutting_speed.is_some() && read(&self.input, ports.engaged, 1.0) > 0.0;
            let mut looked = 0.0;
            let mut look = |u: &[f64], y: &[f64], elapsed: f64, sampled: Option<f64>| {
                let before = std::mem::replace(&mut power, read(y, ports.spindle_power, 0.0));
                *energy += 0.5 * (before + power) * (elapsed - looked);
                looked = elapsed;
                samples.extend(sampled.map(|time| sample(ports, u, y, time)));
            };
            let start =
                listener.as_ref().map(|_| Instant { time, state: self.state.clone(), input: self.input.clone() });
            let advance = process
                .advance_to_output(
                    &mut self.state,
                    &mut self.input,
                    goal - time,
                    &times,
                    &mut |i, u, y| look(u, y, times[i], next(i)),
                    &mut self.output,
                )
                .map_err(CutFault::Model)?;
            let end = sampling_period.filter(|_| advance.event.is_none() && goal == duration).map(|_| duration);
            look(&self.input, &self.output, advance.elapsed, end);
            if engaged {
                // The speed is constant or a ramp: the mean of its ends is exact.
                self.engaged_time += advance.elapsed;
                self.cutting_length +=
                    0.5 * (speed_before + read(&self.input, ports.cutting_speed, 0.0)) * advance.elapsed;
            }
            if let (Some(listener), Some(start)) = (&mut listener, start) {
                let end =
                    Instant { time: time + advance.elapsed, state: self.state.clone(), input: self.input.clone() };
                listener.follow(&start, &end)?;
            }
            let Some(event) = advance.event else {
                time = goal;
                continue;
            };
            time += advance.elapsed;
            if event.ends_cut() {
                self.lost = Some(event);
                break;
            }
            self.passed.push((time, event));
            stuck = if advance.elapsed > 0.0 { 0 } else { stuck + 1 };
            if stuck > STUCK {
                return Err(CutFault::Stuck);
            }
        }
        if let (Some(before), Some(i)) = (counted, ports.energy_state) {
            self.energy = self.state[i] - before;
        }
        self.elapsed = time;
        self.stop = None;
        self.vibration = listener.map(|listener| listener.heard);
        Ok(())
    }

    /// When a listening controller stops the segment, s from its start.
    pub fn stop(&self, rule: Option<&Stability>, known: Option<&Reaction>) -> Option<f64> {
        let reaction_time = rule?.reaction_time()?;
        let stop = self.vibration.as_ref()?.onset? + reaction_time;
        (stop < self.elapsed && known.is_none_or(|known| !known.exhausted)).then_some(stop)
    }

    /// Moves an edge that is out of cut, before it cuts under [`Segment::start_input`]: it cools, nothing else.
    ///
    /// # Errors
    /// What the model refuses.
    pub fn rest(
        &mut self,
        process: &dyn MachineProcess,
        ports: &Ports,
        state: &mut [f64],
        duration: f64,
    ) -> Result<(), CutFault> {
        let Some(engaged) = ports.engaged else { return Ok(()) };
        let (mut left, mut stuck) = (duration, 0);
        let input = &mut self.input;
        input.clone_from(&self.start_input);
        input[engaged] = 0.0;
        write(input, ports.cutting_acceleration, 0.0);
        while left > 0.0 {
            let advance = process.advance(state, input, left).map_err(CutFault::Model)?;
            if advance.event.is_none() {
                break;
            }
            left -= advance.elapsed;
            stuck = if advance.elapsed > 0.0 { 0 } else { stuck + 1 };
            if stuck > STUCK {
                return Err(CutFault::Stuck);
            }
        }
        Ok(())
    }

    /// Whether `event` happened without stopping the cut.
    pub fn has(&self, event: ProcessEvent) -> bool {
        self.passed.iter().any(|(_, each)| *each == event)
    }

    /// Share of the path of the whole segment as requested that is behind after `elapsed`
    /// seconds, the speed going linearly from that of the start input.
    pub fn share(&self, ports: &Ports, elapsed: f64) -> f64 {
        let whole = self.requested;
        let speed = read(&self.start_input, ports.cutting_speed, 0.0);
        let acceleration = read(&self.start_input, ports.cutting_acceleration, 0.0);
        let path = |t: f64| speed * t + 0.5 * acceleration * t * t;
        if elapsed >= whole {
            1.0
        } else if path(whole) > 0.0 {
            path(elapsed) / path(whole)
        } else {
            elapsed / whole
        }
    }
}

fn sample(ports: &Ports, input: &[f64], output: &[f64], elapsed: f64) -> Sample {
    Sample {
        elapsed,
        cutting_speed: read(input, ports.cutting_speed, 0.0),
        spindle_power: read(output, ports.spindle_power, 0.0),
        feed_force: read(output, ports.feed_force, 0.0),
        thermo_emf: read(output, ports.thermo_emf, 0.0),
        force_ripple: read(output, ports.force_ripple, 0.0),
    }
}

/// Does `work` and refuses it where an effect of a user gave no value on the way.
pub fn refusing<T>(work: impl FnOnce() -> Result<T, CutFault>) -> Result<T, CutFault> {
    watched(work).map_err(CutFault::Model)?
}
