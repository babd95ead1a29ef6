//! Chatter in a pass: what it does to part and log, and who reacts to it.

use super::cut::Segment;
use super::draws::owner;
use super::machine::{MOUNTED, Piece};
use super::pass::Place;
use super::ports::{Ports, read};
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::{EventRow, LogEvent, PassRow};
use rand_distr::{Distribution as _, StandardNormal};
use toolroom_kernel::{Purpose, Stream};
use toolroom_process::MachineProcess;
use toolroom_scenario::policies::Stability;

/// Places of a segment that are looked at.
const PLACES: usize = 9;
/// Amplitude of the vibration from which chatter grows, m: that of the surface which a tool finds
/// (assumption).
const SEED: f64 = 1e-6;
/// Other speeds that are tried for one pass on one machine before a controller gives up
/// (assumption).
const MOST_TRIALS: usize = 6;

/// Vibration over one segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Least margin.
    pub margin: f64,
    /// Time in an unstable cut, s.
    pub chatter_time: f64,
    /// When chatter has grown, s from the start of the segment; `None` in a stable one.
    pub onset: Option<f64>,
    /// Its frequency, Hz.
    pub frequency: f64,
    /// Greatest amplitude, m.
    pub amplitude: f64,
    /// Greatest roughness Ra, m.
    pub roughness: f64,
}

/// What a machine has learnt about chatter in one kind of pass.
#[derive(Clone, Debug)]
pub struct Reaction {
    /// What is cut: the number of its controller.
    pub kind: u32,
    /// Speeds that chattered, m/s, with the amplitude that was heard, m.
    pub tried: Vec<(f64, f64)>,
    /// Speed that is commanded now, m/s.
    pub speed: f64,
    /// Whether no other speed is left to try.
    pub exhausted: bool,
}

/// Looks along a planned segment, from the state at its start.
pub(super) fn along(segment: &Segment, process: &dyn MachineProcess, ports: &Ports, state: &[f64]) -> Vibration {
    let mut output = segment.output.clone();
    let mut input = segment.start_input.clone();
    let mut seen = Vibration {
        margin: f64::INFINITY,
        chatter_time: read(&segment.state, ports.chatter_time, 0.0) - read(state, ports.chatter_time, 0.0),
        onset: None,
        frequency: 0.0,
        amplitude: 0.0,
        roughness: 0.0,
    };
    for place in 0..PLACES {
        let share = place as f64 / (PLACES - 1) as f64;
        for ((value, start), end) in input.iter_mut().zip(&segment.start_input).zip(&segment.input) {
            *value = start + share * (end - start);
        }
        let worn = if place == PLACES - 1 { segment.state.as_slice() } else { state };
        process.output(worn, &input, &mut output);
        let amplitude = read(&output, ports.vibration_amplitude, 0.0);
        seen.margin = seen.margin.min(read(&output, ports.stability_margin, 1.0));
        seen.roughness = seen.roughness.max(read(&output, ports.roughness, 0.0));
        seen.amplitude = seen.amplitude.max(amplitude);
        if seen.onset.is_none() && read(&output, ports.stable, 1.0) < 0.5 {
            let rate = read(&output, ports.chatter_growth_rate, 0.0);
            let grows = (amplitude / SEED).max(1.0).ln() / rate;
            seen.onset = Some(share * segment.elapsed + grows).filter(|onset| *onset < segment.elapsed);
            seen.frequency = read(&output, ports.dominant_frequency, 0.0);
        }
    }
    seen
}

impl Vibration {
    /// Adds the segment to the row of its pass and to the part.
    pub(super) fn note(&self, row: &mut PassRow, surface: &mut Surface) {
        row.chatter_time += self.chatter_time;
        row.stability_margin = row.stability_margin.min(self.margin);
        if row.chatter_frequency == 0.0 {
            row.chatter_frequency = self.frequency;
        }
        row.vibration_amplitude = row.vibration_amplitude.max(self.amplitude);
        row.roughness = row.roughness.max(self.roughness);
        surface.roughness = surface.roughness.max(self.roughness);
        surface.chattered |= self.chatter_time > 0.0;
    }
}

/// The surface that the last pass leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Greatest roughness Ra, m.
    pub roughness: f64,
    /// Whether it was cut under chatter.
    pub chattered: bool,
}

impl Segment {
    /// When a listening controller stops the segment, s from its start.
    pub(super) fn stop(&self, rule: Option<&Stability>, known: Option<&Reaction>) -> Option<f64> {
        let reaction_time = rule?.reaction_time()?;
        let stop = self.vibration.as_ref()?.onset? + reaction_time;
        (stop < self.elapsed && known.is_none_or(|known| !known.exhausted)).then_some(stop)
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// Logs that chatter has set in, `elapsed` s ago counted from the end of the segment.
    pub(super) fn log_onset(&mut self, machine: usize, place: Place, edge: u32) {
        let now = self.now().seconds();
        let segment = &self.world.machines[machine].segment;
        let Some(onset) = segment.vibration.as_ref().and_then(|vibration| vibration.onset) else { return };
        if onset < segment.elapsed {
            let (machine, job) = (Some(machine as u32), Some(place.job));
            let time = now - segment.elapsed + onset;
            self.recorder.event(EventRow { time, event: LogEvent::ChatterOnset, machine, job, edge: Some(edge) });
        }
    }

    /// The controller has heard chatter: the rest of the pass is cut at another speed, and later
    /// passes of the kind on this machine too.
    pub(super) fn react(&mut self, machine: usize, place: Place, stop: f64) -> Result<(), ShopError> {
        let plan = self.layout.passes(place.part, place.operation);
        let pass = plan.first_pass + place.pass as u32;
        let ports = &self.layout.tools[place.tool].ports;
        let heard = {
            let state = &self.world.machines[machine];
            let segment = &state.segment;
            let frequency = segment.vibration.as_ref().map_or(0.0, |vibration| vibration.frequency);
            let amplitude = segment.vibration.as_ref().map_or(0.0, |vibration| vibration.amplitude);
            (frequency, read(&segment.start_input, ports.cutting_speed, 0.0), amplitude)
        };
        self.halt_pass(machine, stop)?;
        self.close_pass(machine);
        let controller = self.controllers.of_pass(machine, pass);
        let state = &mut self.world.machines[machine];
        let edge = state.edges[place.tool].as_ref().expect(MOUNTED);
        let mut noise: Stream =
            self.streams.at(edge.entity.part(owner::CHATTER), Purpose::Measurement, u64::from(edge.row.passes));
        let z: f64 = StandardNormal.sample(&mut noise);
        let (frequency, speed) = (heard.0 * (1.0 + controller.sensors().dominant_frequency * z), heard.1);
        let kind = self.controllers.kind_of_pass(machine, pass);
        let index = state.reactions.iter().position(|each| each.kind == kind).unwrap_or_else(|| {
            state.reactions.push(Reaction { kind, tried: Vec::new(), speed, exhausted: false });
            state.reactions.len() - 1
        });
        let known = &mut state.reactions[index];
        known.tried.push((speed, heard.2));
        let tried: Vec<f64> = known.tried.iter().map(|(speed, _)| *speed).collect();
        match controller.reaction(frequency, speed, &tried).filter(|_| tried.len() <= MOST_TRIALS) {
            Some(other) => known.speed = other,
            None => {
                // Nowhere quiet: where it was the least loud.
                let quietest = known.tried.iter().min_by(|a, b| a.1.total_cmp(&b.1));
                known.speed = quietest.map_or(speed, |(speed, _)| *speed);
                known.exhausted = true;
            }
        }
        self.next_pass(machine)
    }
}

impl Piece {
    /// A pass begins anew on the surface.
    pub(super) fn renew_surface(&mut self) {
        if self.share_left >= 1.0 {
            self.surface = Surface::default();
        }
    }
}
