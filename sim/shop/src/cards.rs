//! Cards: a limited number of jobs between stations.
//!
//! A job that comes to an operation in a loop of which it has no card is *parked*: it stands in the backlog of the loop,
//! and in a shop with limited buffers keeps its place on the machine behind it. It takes the cards of all loops that it
//! enters together, or none. It returns a card when it has left the last operation of the loop; who goes from one loop
//! straight into another has left the first when it has a card of the second. All jobs of an order, and those that were
//! divided from one another, have one card together.

use super::look::{Look, facts, queue_kind, started_work};
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::LogEvent;
use toolroom_queues::{Moment, keys};
use toolroom_queues::{Queue, QueueEntry};
use toolroom_scenario::{CardLoop, DispatchRule, Scenario};

/// Cards of all loops.
#[derive(Clone, Debug, Default)]
pub struct Cards {
    /// As in the scenario.
    pub(super) loops: Vec<Backlog>,
    /// Who has cards together, by number.
    pub(super) tickets: Vec<Ticket>,
    /// Numbers of tickets that nobody has.
    free: Vec<u32>,
    /// Whether a job was parked, or a card returned, since cards were given out.
    pub(super) changed: bool,
}

/// A loop and the jobs that wait for its cards.
#[derive(Clone, Debug)]
pub(super) struct Backlog {
    /// Cards that are taken; more than there are where a run began with them.
    pub taken: u32,
    queue: Queue,
}

/// Jobs that have cards together.
#[derive(Clone, Debug, Default)]
pub(super) struct Ticket {
    /// Their places.
    pub members: Vec<u32>,
    /// Loops of which they have a card, as the bits of a word.
    pub held: u64,
}

/// The loops in a set of them.
pub(super) fn loops_in(set: u64) -> impl Iterator<Item = usize> + Clone {
    (0..u64::BITS as usize).filter(move |index| set >> index & 1 == 1)
}

/// Rules of the backlog of a loop.
fn rules_of<'a>(scenario: &'a Scenario, card_loop: &'a CardLoop) -> &'a [DispatchRule] {
    if card_loop.rules.is_empty() { &scenario.dispatch } else { &card_loop.rules }
}

impl Cards {
    pub(super) fn from_scenario(scenario: &Scenario) -> Self {
        let backlog = |own: &CardLoop| {
            let kind = queue_kind(rules_of(scenario, own), &scenario.control.keys);
            Backlog { taken: 0, queue: Queue::from_queue_kind(kind) }
        };
        Self { loops: scenario.control.loops.iter().map(backlog).collect(), ..Self::default() }
    }
}

impl<R: Recorder> Shop<'_, R> {
    /// Whether any number of jobs is limited by cards.
    #[inline]
    pub(super) fn has_cards(&self) -> bool {
        !self.scenario.control.loops.is_empty()
    }

    /// A job that has come to the shop gets a ticket of its own, or joins the one of its order; which one it is.
    pub(super) fn enroll(&mut self, slot: u32, ticket: Option<u32>) -> u32 {
        let cards = &mut self.world.cards;
        let ticket = ticket.or_else(|| cards.free.pop()).unwrap_or_else(|| {
            cards.tickets.push(Ticket::default());
            (cards.tickets.len() - 1) as u32
        });
        cards.tickets[ticket as usize].members.push(slot);
        self.world.jobs.at_mut(slot).ticket = ticket;
        ticket
    }

    /// A job that is within loops when the run begins has their cards.
    pub(super) fn take_cards_at_start(&mut self, slot: u32) {
        let need = self.needs(slot);
        self.take(self.world.jobs.at(slot).ticket, need);
    }

    fn take(&mut self, ticket: u32, need: u64) {
        self.world.cards.tickets[ticket as usize].held |= need;
        loops_in(need).for_each(|index| self.world.cards.loops[index].taken += 1);
    }

    /// First and last operation of a job in a loop.
    fn span(&self, slot: u32, index: usize) -> Option<(u32, u32)> {
        let (first, last) = self.scenario.control.loops[index].spans[self.world.jobs.at(slot).row.part as usize]?;
        Some((first as u32, last as u32))
    }

    /// Loops whose cards a job lacks for its operation.
    pub(super) fn needs(&self, slot: u32) -> u64 {
        let job = self.world.jobs.at(slot);
        let held = self.world.cards.tickets[job.ticket as usize].held;
        let inside =
            |index: usize| self.span(slot, index).is_some_and(|(first, last)| (first..=last).contains(&job.operation));
        let all = (0..self.scenario.control.loops.len()).filter(|index| held >> index & 1 == 0 && inside(*index));
        all.fold(0, |set, index| set | 1 << index)
    }

    /// Whether a loop has a card left.
    pub(super) fn has_card(&self, index: usize) -> bool {
        self.world.cards.loops[index].taken < self.scenario.control.loops[index].cards
    }

    /// A job that has come to its operation waits for cards, if it lacks any.
    pub(super) fn park(&mut self, slot: u32) -> bool {
        let need = self.needs(slot);
        if need == 0 {
            return false;
        }
        let job = self.world.jobs.at_mut(slot);
        job.parked = true;
        if self.world.cards.tickets[job.ticket as usize].held != 0 {
            self.world.flow.suspect = true;
        }
        loops_in(need).for_each(|index| self.join_backlog(index, slot));
        self.world.cards.changed = true;
        true
    }

    fn join_backlog(&mut self, index: usize, slot: u32) {
        let (scenario, layout, streams) = (self.scenario, &self.layout, &self.streams);
        let rules = rules_of(scenario, &scenario.control.loops[index]);
        let (cards, jobs) = (&mut self.world.cards, &self.world.jobs);
        let job = jobs.at(slot);
        let waiting = QueueEntry { since: job.queued, number: job.number, slot, operation: job.operation };
        let machine = scenario.parts[job.row.part as usize].operations[job.operation as usize].machines[0];
        cards.loops[index].queue.join(
            waiting,
            || facts(scenario, layout, streams, (jobs, slot), (machine, rules)),
            |facts| keys(rules, waiting.since.seconds(), facts, &Moment::default()),
            |waiting| is_parked(jobs, waiting),
        );
    }

    /// The job of a backlog that goes first by its rules; it is taken out.
    fn first_of_backlog(&mut self, index: usize) -> Option<u32> {
        let now = self.now().seconds();
        let (scenario, layout) = (self.scenario, &*self.layout);
        let rules = rules_of(scenario, &scenario.control.loops[index]);
        let started = started_work(scenario, layout, (&self.world.jobs, &self.world.machines), now);
        let (cards, jobs, waiting_work) = (&mut self.world.cards, &self.world.jobs, &self.world.waiting_work);
        let look = Look { scenario, layout, jobs, waiting_work, started, chooser: None, rules, now };
        let found = cards.loops[index].queue.take(
            now,
            |waiting| is_parked(look.jobs, waiting),
            |facts| look.measures(facts),
            |waiting, facts, mean| look.keys(waiting, facts, mean),
        );
        found.map(|waiting| waiting.slot)
    }

    /// The first job of a backlog for which all loops that it enters have a card.
    fn first_admissible(&mut self, index: usize) -> Option<u32> {
        let (mut found, mut aside) = (None, Vec::new());
        while let Some(slot) = self.first_of_backlog(index) {
            if loops_in(self.needs(slot)).all(|own| self.has_card(own)) {
                found = Some(slot);
                break;
            }
            aside.push(slot);
        }
        aside.into_iter().for_each(|slot| self.join_backlog(index, slot));
        found
    }

    /// Gives out the cards that are there, loop by loop.
    pub(super) fn give_cards(&mut self) -> Result<(), ShopError> {
        while std::mem::take(&mut self.world.cards.changed) {
            for index in 0..self.world.cards.loops.len() {
                while self.has_card(index)
                    && let Some(slot) = self.first_admissible(index)
                {
                    self.admit(slot);
                }
            }
        }
        Ok(())
    }

    /// A parked job gets its cards.
    fn admit(&mut self, slot: u32) {
        let ticket = self.world.jobs.at(slot).ticket;
        let need = self.needs(slot);
        self.take(ticket, need);
        let members = self.world.cards.tickets[ticket as usize].members.clone();
        for member in members {
            if self.world.jobs.at(member).parked && self.needs(member) == 0 {
                self.unpark(member);
            }
        }
        self.settle_ticket(ticket);
    }

    fn unpark(&mut self, slot: u32) {
        let now = self.now();
        let is_held = self.is_held(slot);
        let job = self.world.jobs.at_mut(slot);
        job.parked = false;
        let number = job.number;
        if !is_held {
            job.queued = now;
        }
        self.world.cards.loops.iter_mut().for_each(|own| own.queue.leave(slot));
        self.log_event(LogEvent::Card, None, Some(number), None);
        if !is_held {
            self.proceed(slot, None); // else it moves as soon as there is a place
        }
    }

    /// Whether a job stands on the machine, or in the output buffer, of the operation before.
    fn is_held(&self, slot: u32) -> bool {
        self.world.flow.held.iter().any(|held| held.slot == slot)
    }

    /// A job has moved: its ticket returns the cards of loops that it has left.
    pub(super) fn return_cards(&mut self, slot: u32) {
        self.settle_ticket(self.world.jobs.at(slot).ticket);
    }

    fn settle_ticket(&mut self, ticket: u32) {
        let held = self.world.cards.tickets[ticket as usize].held;
        for index in loops_in(held) {
            if !self.is_inside(ticket, index) {
                self.world.cards.tickets[ticket as usize].held &= !(1 << index);
                self.world.cards.loops[index].taken -= 1;
                self.world.cards.changed = true;
                let member = self.world.cards.tickets[ticket as usize].members.first();
                let number = member.map(|slot| self.world.jobs.at(*slot).number);
                self.log_event(LogEvent::CardReturn, None, number, None);
            }
        }
    }

    /// Whether any job of a ticket is in a loop. Of several jobs those count that have not come to it yet: they belong to
    /// the card that the first of them took.
    fn is_inside(&self, ticket: u32, index: usize) -> bool {
        let members = &self.world.cards.tickets[ticket as usize].members;
        members.iter().any(|&slot| {
            let job = self.world.jobs.at(slot);
            self.span(slot, index).is_some_and(|(first, last)| {
                let behind = job.operation == last + 1 && (job.parked || self.is_held(slot));
                (first..=last).contains(&job.operation) || behind || members.len() > 1 && job.operation <= last
            })
        })
    }

    /// A job leaves the shop.
    pub(super) fn leave_ticket(&mut self, slot: u32) {
        let ticket = self.world.jobs.at(slot).ticket;
        let members = &mut self.world.cards.tickets[ticket as usize].members;
        members.retain(|member| *member != slot);
        let nobody = members.is_empty();
        self.settle_ticket(ticket);
        if nobody {
            self.world.cards.free.push(ticket);
        }
    }
}

/// Whether a job still waits for a card, and for what its place in a backlog says.
fn is_parked(jobs: &super::job::Jobs, waiting: &QueueEntry) -> bool {
    let job = jobs.get(waiting.slot);
    job.is_some_and(|job| {
        job.parked && job.number == waiting.number && job.operation == waiting.operation && job.queued == waiting.since
    })
}
