//! Vehicles that carry jobs between places.
//!
//! A job that is done calls a vehicle where its next operation is done at another place. When all events of an
//! instant are settled, free vehicles take jobs: they drive to them empty, and then to where they go. What is
//! carried stands in no queue.

use super::event::Event;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::LogEvent;
use std::collections::VecDeque;
use toolroom_kernel::Purpose;
use toolroom_scenario::{Parking, Transport, TransportRule};

/// Owner of the moves of a job, part of its own name; operations are counted from it.
const MOVE: u64 = 1 << 47;

/// Vehicles of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TransportState {
    /// Every vehicle.
    pub vehicles: Vec<VehicleState>,
    /// Jobs that wait for one, the first in front.
    pub calls: VecDeque<Call>,
    /// Jobs that are carried beside the one for which a vehicle set out, by vehicle.
    pub(super) beside: Vec<Vec<u32>>,
}

/// A vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VehicleState {
    /// Where it is, or where it will be next, by index into the places of its kind.
    pub at: usize,
    /// Where it carries its jobs.
    pub to: usize,
    /// Whether it drives.
    pub busy: bool,
    /// The job for which it drives; `None`: it drives home.
    pub job: Option<u32>,
}

/// A job that waits for a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// Where the job is kept.
    pub slot: u32,
    /// Where it waits.
    pub from: usize,
    /// Where it goes.
    pub to: usize,
}

impl TransportState {
    pub(super) fn from_transport(transport: &Transport) -> Self {
        let vehicle = VehicleState { at: 0, to: 0, busy: false, job: None };
        let count = transport.count as usize;
        Self { vehicles: vec![vehicle; count], calls: VecDeque::new(), beside: vec![Vec::new(); count] }
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// Calls a vehicle for a job that comes from a machine; false where none is needed.
    pub(super) fn call_vehicle(&mut self, slot: u32, machine: usize) -> bool {
        let machines = &self.scenario.machines;
        let goes = &machines[self.next_machines(slot)[0]].location;
        for (transport, resource) in self.scenario.transports.iter().enumerate() {
            if let (Some(from), Some(to)) = (resource.location(&machines[machine].location), resource.location(goes)) {
                if from == to {
                    return false;
                }
                self.world.transports[transport].calls.push_back(Call { slot, from, to });
                return true;
            }
        }
        false
    }

    /// A job without a vehicle begins to move from a machine to another place; false where its next operation is done here.
    pub(super) fn begin_move(&mut self, slot: u32, machine: usize) -> Result<bool, ShopError> {
        let scenario = self.scenario;
        if scenario.move_time.mean() == 0.0 {
            return Ok(false);
        }
        let here = &scenario.machines[machine].location;
        if self.next_machines(slot).iter().any(|next| scenario.machines[*next].location == *here) {
            return Ok(false);
        }
        let job = self.world.jobs.at(slot);
        let owner = job.entity.part(MOVE + u64::from(job.operation));
        let time = scenario.move_time.sample(&mut self.streams.at(owner, Purpose::Transport, u64::from(job.visits)));
        self.log_event(LogEvent::Move, None, Some(self.world.jobs.at(slot).number), None);
        let there = self.now().after(time)?;
        self.schedule(there, Event::Moved { slot })?;
        Ok(true)
    }

    /// A job has come to the place of its next operation.
    pub(super) fn moved_to(&mut self, slot: u32) {
        self.log_event(LogEvent::Delivery, None, Some(self.world.jobs.at(slot).number), None);
        self.come(slot, None);
    }

    /// Free vehicles take the jobs that wait for them.
    pub(super) fn send_vehicles(&mut self) -> Result<(), ShopError> {
        for transport in 0..self.world.transports.len() {
            while let Some((vehicle, call)) = self.next_way(transport) {
                let resource = &self.scenario.transports[transport];
                let state = &mut self.world.transports[transport];
                let Some(call) = state.calls.remove(call) else { break };
                let (empty, loaded) =
                    (resource.times[state.vehicles[vehicle].at][call.from], resource.times[call.from][call.to]);
                let alone = resource.capacity == 1;
                let at = if alone { call.to } else { call.from };
                state.vehicles[vehicle] = VehicleState { at, to: call.to, busy: true, job: Some(call.slot) };
                self.log_event(LogEvent::Move, None, Some(self.world.jobs.at(call.slot).number), None);
                if alone {
                    self.drives(transport, vehicle, empty + loaded)?;
                } else {
                    let (transport, vehicle) = (transport as u16, vehicle as u16);
                    let there = self.now().after(empty)?;
                    self.schedule(there, Event::PickUp { transport, vehicle })?;
                }
            }
        }
        Ok(())
    }

    /// The vehicle and the job, by their places, that go next.
    fn next_way(&self, transport: usize) -> Option<(usize, usize)> {
        let (resource, state) = (&self.scenario.transports[transport], &self.world.transports[transport]);
        let most = match resource.rule {
            TransportRule::Fifo => 1,
            TransportRule::Nearest => state.calls.len(),
        };
        let free = state.vehicles.iter().enumerate().filter(|(_, vehicle)| !vehicle.busy);
        let ways = free.flat_map(|(vehicle, from)| {
            let calls = state.calls.iter().take(most).enumerate();
            calls.map(move |(call, to)| (resource.times[from.at][to.from], call, vehicle))
        });
        let nearest = ways.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        nearest.map(|(_, call, vehicle)| (vehicle, call))
    }

    fn drives(&mut self, transport: usize, vehicle: usize, time: f64) -> Result<(), ShopError> {
        let arrival = self.now().after(time)?;
        self.schedule(arrival, Event::Delivery { transport: transport as u16, vehicle: vehicle as u16 })?;
        Ok(())
    }

    /// A vehicle that carries several jobs has come to the one for which it set out: what waits there for the same way goes
    /// with it, as far as there is room.
    pub(super) fn picks_up(&mut self, transport: usize, vehicle: usize) -> Result<(), ShopError> {
        let resource = &self.scenario.transports[transport];
        let state = &mut self.world.transports[transport];
        let VehicleState { at: from, to, .. } = state.vehicles[vehicle];
        let mut room = resource.capacity - 1;
        let mut taken = Vec::new();
        state.calls.retain(|call| {
            let goes = room > 0 && call.from == from && call.to == to;
            if goes {
                room -= 1;
                taken.push(call.slot);
            }
            !goes
        });
        state.beside[vehicle].clone_from(&taken);
        state.vehicles[vehicle].at = to;
        for slot in taken {
            self.log_event(LogEvent::Move, None, Some(self.world.jobs.at(slot).number), None);
        }
        self.drives(transport, vehicle, resource.times[from][to])
    }

    /// A vehicle has come to where it drove.
    pub(super) fn delivered(&mut self, transport: usize, vehicle: usize) -> Result<(), ShopError> {
        let resource = &self.scenario.transports[transport];
        let state = &mut self.world.transports[transport];
        let (position, nobody) = (state.vehicles[vehicle].at, state.calls.is_empty());
        let job = state.vehicles[vehicle].job.take();
        state.vehicles[vehicle].busy = false;
        if resource.park == Parking::Home && position != 0 && nobody {
            state.vehicles[vehicle] = VehicleState { at: 0, to: 0, busy: true, job: None };
            self.drives(transport, vehicle, resource.times[position][0])?;
        }
        let beside = std::mem::take(&mut self.world.transports[transport].beside[vehicle]);
        for slot in job.into_iter().chain(beside) {
            self.log_event(LogEvent::Delivery, None, Some(self.world.jobs.at(slot).number), None);
            self.come(slot, None);
        }
        Ok(())
    }
}
