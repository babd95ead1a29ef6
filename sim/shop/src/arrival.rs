//! Jobs enter.

use super::draws::{self, PIECES};
use super::event::Event;
use super::job::{Job, Origin};
use super::lot::Lot;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::{JobOutcome, JobRow, LogEvent};
use rand::RngExt;
use toolroom_kernel::{Entity, Purpose, SimTime, Stream, Streams};
use toolroom_scenario::{ArrivalPattern, Distribution, DrawUnit, DueRule, InProcess, Scenario, Work, by_id};

/// An operation with plain work of an order: the rank of all its jobs and the time of it, s, where they have one, and the stream.
type DrawnTogether = (usize, Option<(f64, f64)>, Stream);

impl<R: Recorder> Shop<'_, R> {
    /// Schedules the first release of every source; constant work enters at once.
    pub(super) fn open_sources(&mut self) -> Result<(), ShopError> {
        for source in 0..self.scenario.arrivals.len() {
            match &self.scenario.arrivals[source].pattern {
                ArrivalPattern::Schedule(rows) => {
                    // Rows may stand in any order; each is an event of its own.
                    for &(time, _) in rows {
                        let time = SimTime::from_seconds(time)?;
                        self.schedule(time, Event::Arrival { source: source as u32 })?;
                    }
                }
                ArrivalPattern::Renewal(_) | ArrivalPattern::Poisson { .. } => self.schedule_next(source)?,
                ArrivalPattern::Batch { .. } | ArrivalPattern::ConstantWork { .. } => {
                    self.schedule(SimTime::ZERO, Event::Arrival { source: source as u32 })?;
                }
            }
        }
        Ok(())
    }

    /// A source releases its jobs and schedules the next release.
    pub(super) fn arrive(&mut self, source: usize) -> Result<(), ShopError> {
        let release = self.world.sources[source].releases;
        self.world.sources[source].releases += 1;
        let count = match &self.scenario.arrivals[source].pattern {
            ArrivalPattern::Schedule(rows) => rows[self.layout.schedules[source][release as usize]].1,
            ArrivalPattern::Renewal(_) | ArrivalPattern::Poisson { .. } => {
                self.schedule_next(source)?;
                1
            }
            &ArrivalPattern::Batch { interval, size } => {
                // From the number of the lot, so that no rounding adds up.
                let next = SimTime::from_seconds((release + 1) as f64 * self.interval(source, interval))?;
                self.schedule(next, Event::Arrival { source: source as u32 })?;
                size
            }
            &ArrivalPattern::ConstantWork { jobs } if release == 0 => jobs,
            ArrivalPattern::ConstantWork { .. } => 1,
        };
        for _ in 0..count {
            self.release(source)?;
        }
        Ok(())
    }

    /// Draws when the next job of a source comes.
    fn schedule_next(&mut self, source: usize) -> Result<(), ShopError> {
        let stream = &mut self.world.sources[source].stream;
        let Some(time) = next_interval(&self.scenario.arrivals[source].pattern, stream) else { return Ok(()) };
        let next = self.now().after(self.interval(source, time))?;
        self.schedule(next, Event::Arrival { source: source as u32 })?;
        Ok(())
    }

    /// One job of a source enters the shop.
    pub(super) fn release(&mut self, source: usize) -> Result<(), ShopError> {
        let now = self.now();
        let index = self.world.sources[source].released;
        self.world.sources[source].released += 1;
        let origin = self.layout.sources[source];
        let entity = origin.part(index);
        let (part, quantity) = drawn_job(self.scenario, &self.streams, source, entity);
        let first_piece = self.world.sources[source].pieces;
        self.world.sources[source].pieces += u64::from(quantity);
        let lot = index / u64::from(self.scenario.parts[part].batch_size.max(1));
        // Nobody counts beyond that.
        let named = u32::try_from(lot + 1).unwrap_or(u32::MAX);
        let number = self.world.jobs.released;
        let route = self.route(part, entity);
        let due = now.seconds() + self.scenario.parts[part].flow_allowance;
        let mut row = JobRow { lot: named, ..JobRow::new(part as u32, quantity, now.seconds(), due) };
        let handling = self.layout.random_handling.then(|| Box::new(self.streams.open(entity, Purpose::Processing)));
        let mut job = Job::new(number, (entity, Origin::Source(source as u32)), row, now);
        job.priority = self.scenario.arrivals[source].priority;
        job.weight = self.scenario.arrivals[source].weight;
        job.operation = route.as_ref().map_or(0, |route| u32::from(route[0]));
        (job.route, job.lot_owner, job.lot, job.handling) = (route, origin, lot, handling);
        job.first_piece = first_piece;
        let slot = self.world.jobs.insert(job);
        let mut ranks = std::mem::take(&mut self.world.sources[source].ranks);
        if let Some(own) = ranks.iter_mut().find(|own| own.part == part) {
            own.next(&self.scenario.parts[part].operations, self.world.jobs.drawn_of(slot));
            for (operation, stream) in &mut own.apart {
                self.draw_work(slot, *operation, stream);
            }
        }
        self.world.sources[source].ranks = ranks;
        if let Some(due) = self.due(source, slot) {
            row.due = due;
            self.world.jobs.at_mut(slot).row.due = due;
        }
        if self.has_cards() {
            self.enroll(slot, None);
        }
        self.recorder.arrival(number, row);
        self.log_event(LogEvent::Arrival, None, Some(number), None);
        self.let_in(slot)
    }

    /// Schedules the release of every order; those that are in the shop already come to their places first. What comes in the
    /// same instant does so in the order of the names: where a row stands in its table decides nothing.
    pub(super) fn open_orders(&mut self) -> Result<(), ShopError> {
        let orders = &self.scenario.orders;
        let mut by_name: Vec<u32> = (0..orders.len() as u32).collect();
        by_name.sort_by(|a, b| by_id(&orders[*a as usize].id, &orders[*b as usize].id));
        let all = || by_name.iter().map(|order| (*order, &orders[*order as usize]));
        let mut inside: Vec<(u32, f64)> =
            all().filter_map(|(order, own)| Some((order, own.in_process.as_ref()?.since))).collect();
        inside.sort_by(|a, b| a.1.total_cmp(&b.1));
        let inside = inside.into_iter().map(|(order, _)| (order, 0.0));
        let later = all().filter(|(_, own)| own.in_process.is_none()).map(|(order, own)| (order, own.release));
        let releases: Vec<(u32, f64)> = inside.chain(later).collect();
        for (order, release) in releases {
            self.schedule(SimTime::from_seconds(release)?, Event::Release { order })?;
        }
        Ok(())
    }

    /// An order enters the shop: as one job where all of its work is plain and moves on together, else in
    /// pieces or in as many as are transferred at a time.
    pub(super) fn release_order(&mut self, order: usize) -> Result<(), ShopError> {
        let scenario = self.scenario;
        let (ordered, now, urgency) = (&scenario.orders[order], self.now(), self.urgency(order));
        let part = &scenario.parts[ordered.part];
        let owner = Entity::named(&format!("order {}", ordered.id));
        let pieces = ordered.pieces();
        let (size, together) = (ordered.job_size(part), ordered.transfer.unwrap_or(pieces).min(pieces));
        let count = pieces.div_ceil(size);
        if count > 1 || ordered.setup_ahead {
            let moving = together.div_ceil(size);
            self.world.lots[order] = Some(Lot::new(count, moving, ordered.split, part.operations.len()));
        }
        let passed = ordered.jobs_passed(part);
        if let Some(inside) = &ordered.in_process {
            self.set_lot_at_start(order, inside, passed);
        }
        // One rank of every operation for the whole order, or one for each of its pieces.
        let mut ranks: Vec<DrawnTogether> = Vec::new();
        for (index, operation) in part.operations.iter().enumerate() {
            if let Work::Plain(work) = &operation.work {
                let owner = Entity::named(&format!("order {}/{}", ordered.id, operation.name));
                let mut stream = self.streams.open(owner, Purpose::Processing);
                let rank = (operation.draw == DrawUnit::Lot).then(|| stream.random());
                ranks.push((index, rank.map(|rank| (rank, work.quantile(rank))), stream));
            }
        }
        let (mut left, mut ticket) = (pieces, None);
        for index in 0..count {
            let quantity = size.min(left);
            left -= quantity;
            let operation =
                ordered.in_process.as_ref().map_or(0, |inside| inside.operation + usize::from(index < passed));
            if operation == part.operations.len() {
                continue; // it has left the shop before the start
            }
            let entity = if count > 1 { owner.part(PIECES).part(u64::from(index)) } else { owner };
            let number = self.world.jobs.released;
            let route = self.route(ordered.part, entity);
            let arrival = if ordered.in_process.is_some() { ordered.release } else { now.seconds() };
            let row = JobRow {
                order: Some(order as u32),
                lot: order as u32 + 1,
                ..JobRow::new(ordered.part as u32, quantity, arrival, urgency.due)
            };
            let handling =
                self.layout.random_handling.then(|| Box::new(self.streams.open(entity, Purpose::Processing)));
            let slot = self.world.jobs.insert(Job {
                priority: urgency.priority,
                weight: urgency.weight,
                operation: route.as_ref().map_or(operation as u32, |route| u32::from(route[0])),
                route,
                lot_owner: owner,
                first_piece: u64::from(index * size),
                handling,
                ..Job::new(number, (entity, Origin::Order(order as u32)), row, now)
            });
            for (operation, together, stream) in &mut ranks {
                match together {
                    &mut Some((rank, time)) => {
                        self.set_rank(slot, *operation, rank);
                        self.set_work(slot, *operation, time);
                    }
                    None => self.draw_work(slot, *operation, stream),
                }
            }
            if self.has_cards() {
                ticket = Some(self.enroll(slot, ticket));
                if ordered.in_process.is_some() {
                    self.take_cards_at_start(slot);
                }
            }
            self.recorder.arrival(number, row);
            self.log_event(LogEvent::Arrival, None, Some(number), None);
            match &ordered.in_process {
                Some(inside) => {
                    let machine = inside.machine.filter(|_| index == passed);
                    let in_process = InProcess { machine, done: ordered.share_done(part, index), ..inside.clone() };
                    self.come_at_start(slot, &in_process)?;
                }
                None => self.let_in(slot)?,
            }
        }
        Ok(())
    }

    /// A job joins the queues of its next operation, or leaves where there is none; `machine` is the one from which
    /// it comes.
    pub(super) fn enqueue(&mut self, slot: u32, machine: Option<usize>) -> Result<(), ShopError> {
        if self.layout.samples {
            self.pass_by(slot);
        }
        let job = self.world.jobs.at(slot);
        let (part, operation) = (job.row.part as usize, job.operation as usize);
        if operation >= self.layout.operations[part].len() {
            return self.leave(slot, JobOutcome::Good);
        }
        if let Some(only) = self.layout.operations[part][operation].only_machine
            && self.layout.machine_plans[only as usize].is_quick
        {
            self.wait_quick(slot, only as usize);
            return Ok(());
        }
        if let Some(machine) = machine.filter(|_| !self.layout.bare)
            && (self.call_vehicle(slot, machine) || self.begin_move(slot, machine)?)
        {
            return Ok(());
        }
        self.come(slot, machine);
        Ok(())
    }

    /// A job comes to where its next operation is done.
    pub(super) fn come(&mut self, slot: u32, machine: Option<usize>) {
        let now = self.now();
        let job = self.world.jobs.at_mut(slot);
        job.queued = now;
        if self.has_cards() {
            if self.park(slot) {
                if let Some(machine) = machine.filter(|_| self.world.flow.is_limited()) {
                    self.look_for_place(slot, Some(machine)); // it stays where it is
                }
                return;
            }
            if !self.world.flow.is_limited() {
                self.return_cards(slot);
            }
        }
        self.proceed(slot, machine);
    }

    /// A job that has the cards which it needs waits for its operation.
    pub(super) fn proceed(&mut self, slot: u32, machine: Option<usize>) {
        match self.world.jobs.at(slot).origin {
            Origin::Order(order) if self.world.lots[order as usize].is_some() => self.gather(order, slot),
            Origin::Order(_) | Origin::Source(_) | Origin::Crib(_) | Origin::Stock(_)
                if self.world.flow.is_limited() =>
            {
                self.look_for_place(slot, machine);
            }
            Origin::Order(_) | Origin::Source(_) | Origin::Crib(_) | Origin::Stock(_) => self.wait(slot),
        }
    }

    /// A job leaves the shop; constant work lets the next one in.
    pub(super) fn leave(&mut self, slot: u32, outcome: JobOutcome) -> Result<(), ShopError> {
        if self.world.flow.is_limited() {
            self.free_places(slot);
        }
        if self.has_cards() && self.world.jobs.get(slot).is_some() {
            self.leave_ticket(slot);
        }
        self.unclamp_all(slot);
        let Some(job) = self.world.jobs.get(slot) else { return Ok(()) };
        let &Job { number, origin, operation, .. } = job;
        let row = JobRow { finish: self.now().seconds(), outcome, ..job.row };
        self.world.jobs.remove(slot);
        self.recorder.job(number, row);
        let event = if outcome == JobOutcome::Good { LogEvent::Finish } else { LogEvent::Scrap };
        self.log_event(event, None, Some(number), None);
        if let Origin::Order(order) = origin {
            if outcome != JobOutcome::Good {
                self.make_up(order, row.quantity)?;
            }
            self.left_lot(order, operation);
        }
        if let Origin::Crib(crib) = origin {
            return self.ground_edges(crib as usize, number, outcome);
        }
        // A component is in the shop until it has been built in.
        let part = row.part as usize;
        if outcome == JobOutcome::Good && self.layout.components[part] {
            self.stock(part, origin, row.quantity)?;
            return self.arrived(origin, row.quantity);
        }
        self.replace(origin)?;
        self.arrived(origin, row.quantity)
    }

    /// The order of operations of a job whose part has no fixed routing.
    pub(super) fn route(&self, part: usize, entity: Entity) -> Option<Box<[u16]>> {
        let part = &self.scenario.parts[part];
        part.random_routing.then(|| draws::route(&self.streams, entity, part.operations.len()))
    }

    /// When a job of a source is due, s, where that hangs on its work; the times are those drawn for it.
    pub(super) fn due(&self, source: usize, slot: u32) -> Option<f64> {
        let row = &self.world.jobs.at(slot).row;
        let part = row.part as usize;
        let time = |operation: usize| self.layout.drawn_time(&self.world.jobs, slot, part, operation);
        let work = || (0..self.layout.operations[part].len()).map(time).sum::<f64>();
        let entity = || self.world.jobs.at(slot).entity;
        due_by(&self.scenario.arrivals[source].due, row.arrival, work, (&self.streams, entity))
    }
}

/// When a job is due that came at `arrival`, s, where that hangs on its work; `entity` draws for it.
#[inline]
pub(super) fn due_by(
    rule: &DueRule,
    arrival: f64,
    work: impl Fn() -> f64,
    (streams, entity): (&Streams, impl Fn() -> Entity),
) -> Option<f64> {
    match rule {
        DueRule::Allowance => None,
        DueRule::Random(allowance) => {
            let owner = entity().part(draws::DUE);
            Some(arrival + allowance.sample(&mut streams.open(owner, Purpose::Arrival)))
        }
        DueRule::TotalWork { k } => Some(arrival + k * work()),
        DueRule::Slack { slack } => Some(arrival + work() + slack),
    }
}

/// Draws the time to the next job of a source, s; `None` where its jobs do not come one after the other.
#[inline]
pub(super) fn next_interval(pattern: &ArrivalPattern, stream: &mut Stream) -> Option<f64> {
    match pattern {
        ArrivalPattern::Renewal(time) => Some(time.sample(stream)),
        ArrivalPattern::Poisson { rate } if *rate > 0.0 => Some(-(-stream.random::<f64>()).ln_1p() / rate),
        ArrivalPattern::Poisson { .. }
        | ArrivalPattern::Schedule(_)
        | ArrivalPattern::Batch { .. }
        | ArrivalPattern::ConstantWork { .. } => None,
    }
}

/// Part and pieces of the job of a source for which `entity` draws.
pub(super) fn drawn_job(scenario: &Scenario, streams: &Streams, source: usize, entity: Entity) -> (usize, u32) {
    let arrival = &scenario.arrivals[source];
    let part = match arrival.parts[..] {
        [(only, _)] => only,
        _ => {
            let rank: f64 = streams.open(entity.part(draws::PART), Purpose::Arrival).random();
            let mut below = 0.0;
            let found = arrival.parts.iter().find(|(_, share)| {
                below += share;
                rank < below
            });
            // Rounding may leave the sum of all shares a little below 1.
            found.or(arrival.parts.last()).map_or(0, |(part, _)| *part)
        }
    };
    let quantity = if let Distribution::Constant(pieces) = arrival.quantity {
        pieces
    } else {
        arrival.quantity.sample(&mut streams.open(entity.part(draws::QUANTITY), Purpose::Arrival))
    };
    (part, (quantity.round() as u32).max(1))
}
