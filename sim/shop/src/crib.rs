//! Edges that are limited: they come from a crib, go back to it worn, are ground anew, and new ones are bought.
//!
//! A machine that needs an edge takes the one that has been in the crib for longest. Where there is none its step is
//! [`Step::NoTool`]: it holds its part and nobody, and gets the next edge that comes after those who waited before it. Worn
//! edges leave the machine as soon as it begins to change them, so that the only edge of a tool can be ground anew while its
//! machine waits for it. Edges that are ground on a machine of the shop are jobs there, in its queue with all others.

use super::event::Event;
use super::job::{Job, Origin};
use super::recorder::Recorder;
use super::task::{IN_WORK, Step};
use super::{Shop, ShopError};
use crate::runlog::{JobOutcome, JobRow, LogEvent};
use std::collections::{BTreeMap, VecDeque};
use toolroom_kernel::{Entity, Purpose};
use toolroom_scenario::Crib;

/// The edges of a tool; an edge is how often it has been ground.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CribState {
    /// Edges that are there, those that came first in front.
    pub there: VecDeque<u32>,
    /// Machines that wait for one, the first in front.
    pub waiting: VecDeque<u32>,
    /// Edges on their way into a machine.
    pub(super) in_hand: Vec<(u32, u32)>,
    /// Worn ones that wait for others to be sent away with.
    pub(super) worn: VecDeque<u32>,
    /// Edges in the jobs that grind them, by number of the job.
    pub(super) ground: BTreeMap<u32, Vec<u32>>,
    /// Edges that come by an event, by its number, and whether they were bought.
    pub(super) coming: BTreeMap<u32, (Vec<u32>, bool)>,
    /// Bought edges that have not come.
    pub on_order: u32,
    /// Consignments so far.
    pub(super) sent: u32,
}

impl CribState {
    pub(super) fn from_crib(crib: &Crib) -> Self {
        Self { there: (0..crib.edges).map(|_| 0).collect(), ..Self::default() }
    }
}

impl<R: Recorder> Shop<'_, R> {
    fn crib_entity(&self, crib: usize) -> Entity {
        Entity::named(&format!("crib {}", self.scenario.tools[self.scenario.shared.cribs[crib].tool].name))
    }

    /// Whether a machine has an edge of a tool at hand to mount, which it takes from the crib where it has to.
    pub(super) fn finds_edge(&mut self, machine: usize, tool: usize) -> Result<bool, ShopError> {
        let Some(crib) = self.layout.crib_of[tool] else { return Ok(true) };
        let state = &mut self.world.cribs[crib];
        if state.in_hand.iter().any(|(own, _)| *own as usize == machine) {
            return Ok(true);
        }
        let Some(edge) = state.there.pop_front() else { return Ok(false) };
        state.in_hand.push((machine as u32, edge));
        self.buy(crib)?;
        Ok(true)
    }

    /// How often the edge that a machine mounts has been ground.
    pub(super) fn take_edge(&mut self, machine: usize, tool: usize) -> u32 {
        let Some(crib) = self.layout.crib_of[tool] else { return 0 };
        let state = &mut self.world.cribs[crib];
        match state.in_hand.iter().position(|(own, _)| *own as usize == machine) {
            Some(place) => state.in_hand.remove(place).1,
            // Who cuts already when the run begins has an edge in any case.
            None => state.there.pop_front().unwrap_or(0),
        }
    }

    /// Life of an edge over that of a new one.
    pub(super) fn life_factor(&self, tool: usize, ground: u32) -> f64 {
        let crib = self.layout.crib_of[tool].map(|crib| &self.scenario.shared.cribs[crib]);
        let regrind = crib.and_then(|crib| crib.regrind.as_ref());
        regrind.map_or(1.0, |own| own.life_factor.powf(f64::from(ground)))
    }

    /// The worn edge of a machine goes back to the crib, once.
    pub(super) fn give_back(&mut self, crib: usize, machine: usize) -> Result<(), ShopError> {
        let (own, now) = (&self.scenario.shared.cribs[crib], self.now().seconds());
        let Some(edge) = self.world.machines[machine].edges[own.tool].as_mut() else { return Ok(()) };
        if std::mem::replace(&mut edge.given_back, true) {
            return Ok(());
        }
        edge.row.removed = now;
        let ground = edge.row.ground;
        let Some(regrind) = own.regrind.as_ref().filter(|own| own.times.is_none_or(|most| ground < most)) else {
            return self.buy(crib);
        };
        let batch = regrind.batch as usize;
        let state = &mut self.world.cribs[crib];
        state.worn.push_back(ground + 1);
        if state.worn.len() >= batch {
            // By an event: a job must not reach a queue while machines choose.
            self.schedule(self.now(), Event::Regrind { crib: crib as u32 })?;
        }
        Ok(())
    }

    /// Edges that a machine grinds while the order for which it is kept has nothing for it: those for which another machine
    /// waits, since the pieces that are on their way may be in that one.
    pub(super) fn edges_meanwhile(&mut self, machine: usize) -> Option<u32> {
        let kept = self.world.machines[machine].kept_for.is_some();
        if !kept || self.world.cribs.iter().all(|crib| crib.waiting.is_empty() || crib.ground.is_empty()) {
            return None;
        }
        let (mut found, mut aside) = (None, Vec::new());
        while let Some(waiting) = self.choose(machine) {
            let awaited = match self.world.jobs.at(waiting.slot).origin {
                Origin::Crib(crib) => !self.world.cribs[crib as usize].waiting.is_empty(),
                Origin::Order(_) | Origin::Source(_) | Origin::Stock(_) => false,
            };
            if awaited && self.lack_of(machine, waiting.slot).is_none() && self.fits(machine, waiting.slot) {
                found = Some(waiting.slot);
                break;
            }
            aside.push(waiting.slot);
        }
        aside.into_iter().for_each(|slot| self.join(machine, slot));
        if let Some(slot) = found {
            self.stop_waiting(slot, Some(machine));
        }
        found
    }

    /// A machine waits for an edge: those that grind edges of this tool may do it now, whatever they are kept for.
    pub(super) fn await_edge(&mut self, crib: usize, machine: usize) {
        self.world.cribs[crib].waiting.push_back(machine as u32);
        let regrind = self.scenario.shared.cribs[crib].regrind.as_ref();
        for &station in regrind.and_then(|own| own.part).iter().flat_map(|part| {
            let operations = &self.scenario.parts[*part].operations;
            operations.iter().flat_map(|operation| &operation.machines)
        }) {
            self.may_choose(station);
        }
        self.release_operator(machine);
        let state = &mut self.world.machines[machine];
        let task = state.task.as_mut().expect(IN_WORK);
        (task.step, task.left) = (Step::NoTool, 0.0);
        if std::mem::take(&mut state.leaving) {
            state.off_shift = true; // nobody waits after the shift
            self.stop_clocks(machine);
        }
    }

    /// A machine waits for no edge any more: its operation is begun anew or given up.
    pub(super) fn forget_edge(&mut self, machine: usize) {
        self.world.cribs.iter_mut().for_each(|crib| crib.waiting.retain(|own| *own as usize != machine));
    }

    /// Edges come to the crib: machines that wait for them are changed.
    fn edges_come(&mut self, crib: usize, edges: Vec<u32>) -> Result<(), ShopError> {
        self.log_event(LogEvent::EdgesToCrib, None, None, None);
        for edge in edges {
            let state = &mut self.world.cribs[crib];
            let Some(machine) = state.waiting.pop_front() else {
                state.there.push_back(edge);
                continue;
            };
            state.in_hand.push((machine, edge));
            let machine = machine as usize;
            self.change_edge(machine);
            if self.world.machines[machine].is_up() {
                self.drive(machine, false)?;
            }
            self.show_state(machine);
        }
        self.buy(crib)
    }

    /// Edges come that were bought or ground elsewhere.
    pub(super) fn consigned(&mut self, crib: usize, number: u32) -> Result<(), ShopError> {
        let state = &mut self.world.cribs[crib];
        let (edges, bought) = state.coming.remove(&number).expect("every consignment comes once");
        if bought {
            state.on_order -= edges.len() as u32;
        }
        self.edges_come(crib, edges)
    }

    fn consign(&mut self, crib: usize, edges: Vec<u32>, after: f64, bought: bool) -> Result<(), ShopError> {
        let state = &mut self.world.cribs[crib];
        let number = state.sent;
        state.sent += 1;
        state.coming.insert(number, (edges, bought));
        let time = self.now().after(after)?;
        self.schedule(time, Event::Edges { crib: crib as u16, number })?;
        Ok(())
    }

    /// New edges are ordered where too few are there or on order.
    fn buy(&mut self, crib: usize) -> Result<(), ShopError> {
        let Some(buy) = self.scenario.shared.cribs[crib].buy else { return Ok(()) };
        loop {
            let state = &mut self.world.cribs[crib];
            if state.there.len() + state.on_order as usize >= buy.below as usize {
                return Ok(());
            }
            state.on_order += buy.lot;
            self.log_event(LogEvent::EdgesOrdered, None, None, None);
            self.consign(crib, vec![0; buy.lot as usize], buy.lead, true)?;
        }
    }

    /// Worn edges of which there are enough are sent to be ground.
    pub(super) fn send_to_regrind(&mut self, crib: usize) -> Result<(), ShopError> {
        let Some(regrind) = &self.scenario.shared.cribs[crib].regrind else { return Ok(()) };
        let state = &mut self.world.cribs[crib];
        if state.worn.len() < regrind.batch as usize {
            return Ok(());
        }
        let edges: Vec<u32> = state.worn.drain(..regrind.batch as usize).collect();
        let number = u64::from(state.sent);
        let mut stream = self.streams.at(self.crib_entity(crib), Purpose::Processing, number);
        let time = regrind.time.sample(&mut stream);
        self.log_event(LogEvent::EdgesToRegrind, None, None, None);
        let Some(part) = regrind.part else { return self.consign(crib, edges, time, false) };
        self.world.cribs[crib].sent += 1;
        let (now, job, entity) = (self.now(), self.world.jobs.released, self.crib_entity(crib).part(number));
        let due = now.seconds() + self.scenario.parts[part].flow_allowance;
        let row = JobRow::new(part as u32, edges.len() as u32, now.seconds(), due);
        let handling = self.layout.random_handling.then(|| Box::new(self.streams.open(entity, Purpose::Processing)));
        let origin = Origin::Crib(crib as u32);
        let slot = self.world.jobs.insert(Job { handling, ..Job::new(job, (entity, origin), row, now) });
        *self.world.jobs.drawn_mut(slot, 0) = time;
        if self.has_cards() {
            self.enroll(slot, None);
        }
        self.world.cribs[crib].ground.insert(job, edges);
        self.recorder.arrival(job, row);
        self.log_event(LogEvent::Arrival, None, Some(job), None);
        self.let_in(slot)
    }

    /// A job that ground edges leaves its machine: they are in the crib again, unless they are lost.
    pub(super) fn ground_edges(&mut self, crib: usize, job: u32, outcome: JobOutcome) -> Result<(), ShopError> {
        let edges = self.world.cribs[crib].ground.remove(&job).expect("a job grinds the edges that it was sent with");
        if outcome == JobOutcome::Good { self.edges_come(crib, edges) } else { self.buy(crib) }
    }
}
