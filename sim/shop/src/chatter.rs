//! Chatter in a pass: how it is logged, and who reacts to it.

use super::pass::Place;
use super::recorder::Recorder;
use super::task::MOUNTED;
use super::{Shop, ShopError};
use crate::runlog::{EventRow, LogEvent};
use rand_distr::{Distribution as _, StandardNormal};
use toolroom_cuts::edge::owner;
use toolroom_cuts::ports::read;
use toolroom_cuts::reaction::Reaction;
use toolroom_kernel::{Purpose, Stream};

/// Other speeds that are tried for one pass on one machine before a controller gives up
/// (assumption).
const MOST_TRIALS: usize = 6;

impl<R: Recorder> Shop<'_, R> {
    /// Logs that chatter has set in, `elapsed` s ago counted from the end of the segment.
    pub(super) fn log_onset(&mut self, machine: usize, place: Place, edge: u32) {
        let now = self.now().seconds();
        let segment = &self.world.machines[machine].segment;
        let Some(onset) = segment.vibration.as_ref().and_then(|vibration| vibration.onset) else { return };
        let (machine, job) = (Some(machine as u32), Some(place.job));
        let time = now - segment.elapsed + onset;
        self.recorder.event(EventRow { time, event: LogEvent::ChatterOnset, machine, job, edge: Some(edge) });
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
