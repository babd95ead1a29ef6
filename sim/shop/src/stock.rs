//! Components that are ordered when few are left, and pieces that begin anew for those that were lost.
//!
//! What is on order counts as in stock when it is asked whether more have to come. Lots that the shop makes are jobs like
//! those of a source; bought ones come after a time.

use super::assembly::StockArrival;
use super::event::Event;
use super::job::{Job, Origin};
use super::recorder::Recorder;
use super::{Shop, ShopError};
use crate::runlog::{JobRow, LogEvent};
use toolroom_kernel::{Entity, Purpose};
use toolroom_scenario::{Replenish, Work};

/// Owner of the pieces that begin anew, part of the name of their order.
const ANEW: u64 = 1 << 40;

/// A stock on its way to the next lot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StockState {
    /// Pieces that are ordered and have not come.
    pub on_order: u64,
    /// Lots ordered so far.
    pub lots: u64,
}

impl<R: Recorder> Shop<'_, R> {
    /// Puts what is there at the start into stock, and orders where that is too little.
    pub(super) fn open_stocks(&mut self) -> Result<(), ShopError> {
        for (index, stock) in self.scenario.shared.stocks.iter().enumerate() {
            if stock.quantity > 0 {
                let origin = Origin::Stock(index as u32);
                self.world.stock[stock.part].push_back(StockArrival { origin, pieces: stock.quantity });
            }
            self.reorder(index)?;
        }
        Ok(())
    }

    /// The stock of a part, by index.
    pub(super) fn stock_of(&self, part: usize) -> Option<usize> {
        self.scenario.shared.stocks.iter().position(|stock| stock.part == part)
    }

    /// Orders lots until enough pieces are in stock and on order.
    pub(super) fn reorder(&mut self, index: usize) -> Result<(), ShopError> {
        let stock = self.scenario.shared.stocks[index];
        let Some(reorder) = stock.reorder else { return Ok(()) };
        let there: u64 = self.world.stock[stock.part].iter().map(|own| u64::from(own.pieces)).sum();
        while there + self.world.stocks[index].on_order < u64::from(reorder.below) {
            self.world.stocks[index].on_order += u64::from(reorder.lot);
            self.log_event(LogEvent::Reorder, None, None, None);
            let comes = self.now().after(reorder.lead.unwrap_or(0.0))?;
            self.schedule(comes, Event::Restock { stock: index as u32 })?;
        }
        Ok(())
    }

    /// A lot that was ordered is bought and comes, or is let into the shop.
    pub(super) fn restock(&mut self, index: usize) -> Result<(), ShopError> {
        let scenario = self.scenario;
        let stock = &scenario.shared.stocks[index];
        let Some(reorder) = stock.reorder else { return Ok(()) };
        let number = self.world.stocks[index].lots;
        self.world.stocks[index].lots += 1;
        let origin = Origin::Stock(index as u32);
        if reorder.lead.is_some() {
            self.log_event(LogEvent::Restock, None, None, None);
            self.stock(stock.part, origin, reorder.lot)?;
            return self.arrived(origin, reorder.lot);
        }
        let part = &scenario.parts[stock.part];
        let owner = Entity::named(&format!("stock {}", part.name)).part(number);
        let together = part.operations.iter().all(|operation| matches!(operation.work, Work::Plain(_)));
        let count = if together { 1 } else { reorder.lot };
        for piece in 0..count {
            let entity = if together { owner } else { owner.part(u64::from(piece)) };
            let due = self.now().seconds() + part.flow_allowance;
            let row = JobRow::new(stock.part as u32, reorder.lot / count, self.now().seconds(), due);
            let first_piece = number * u64::from(reorder.lot) + u64::from(piece);
            let job = Job {
                priority: reorder.priority,
                lot_owner: owner,
                first_piece,
                ..Job::new(self.world.jobs.released, (entity, origin), row, self.now())
            };
            self.let_job_in(job)?;
        }
        Ok(())
    }

    /// Pieces that were on order have come into stock or are lost.
    pub(super) fn arrived(&mut self, origin: Origin, pieces: u32) -> Result<(), ShopError> {
        let Origin::Stock(index) = origin else { return Ok(()) };
        let state = &mut self.world.stocks[index as usize];
        state.on_order = state.on_order.saturating_sub(u64::from(pieces));
        self.reorder(index as usize)
    }

    /// A job of an order is lost: where its part says so, as many pieces begin anew in this instant.
    pub(super) fn make_up(&mut self, order: u32, pieces: u32) -> Result<(), ShopError> {
        let part = self.scenario.orders[order as usize].part;
        if !matches!(self.scenario.parts[part].replenish, Replenish::NewOrder { .. }) {
            return Ok(());
        }
        self.world.join_anew(order);
        self.world.missing.push((order, pieces));
        let now = self.now();
        self.schedule(now, Event::MakeUp { order })?;
        Ok(())
    }

    /// Pieces of an order begin anew.
    pub(super) fn begin_anew(&mut self, order: u32) -> Result<(), ShopError> {
        let Some(place) = self.world.missing.iter().position(|(own, _)| *own == order) else { return Ok(()) };
        let (_, pieces) = self.world.missing.remove(place);
        let ordered = &self.scenario.orders[order as usize];
        let urgency = self.urgency(order as usize);
        let more = match self.scenario.parts[ordered.part].replenish {
            Replenish::NewOrder { priority } => priority,
            Replenish::Nothing | Replenish::Overrun(_) => 0,
        };
        let number = self.world.anew[order as usize];
        self.world.anew[order as usize] += pieces;
        let owner = Entity::named(&format!("order {}", ordered.id));
        let row = JobRow {
            order: Some(order),
            lot: order + 1,
            ..JobRow::new(ordered.part as u32, pieces, self.now().seconds(), urgency.due)
        };
        let identity = (owner.part(ANEW).part(u64::from(number)), Origin::Order(order));
        let job = Job {
            priority: urgency.priority.saturating_add_signed(more),
            weight: urgency.weight,
            lot_owner: owner,
            first_piece: u64::from(ordered.pieces() + number),
            ..Job::new(self.world.jobs.released, identity, row, self.now())
        };
        self.log_event(LogEvent::Replenish, None, Some(job.number), None);
        self.let_job_in(job)
    }

    /// Lets a job in whose times are drawn by its own name.
    fn let_job_in(&mut self, job: Job) -> Result<(), ShopError> {
        let (entity, number, row) = (job.entity, job.number, job.row);
        let route = self.route(row.part as usize, entity);
        let handling = self.layout.random_handling.then(|| Box::new(self.streams.open(entity, Purpose::Processing)));
        let operation = route.as_ref().map_or(0, |route| u32::from(route[0]));
        let slot = self.world.jobs.insert(Job { route, handling, operation, ..job });
        for index in 0..self.layout.operations[row.part as usize].len() {
            let mut stream = self.streams.open(entity.part(index as u64), Purpose::Processing);
            self.draw_work(slot, index, &mut stream);
        }
        if self.has_cards() {
            self.enroll(slot, None);
        }
        self.recorder.arrival(number, row);
        self.log_event(LogEvent::Arrival, None, Some(number), None);
        self.let_in(slot)
    }
}
