//! Parts that are put together from others: components wait in stock until all of them are there.
//!
//! A component is finished when it comes to the stock of its part. An operation that assembles begins only
//! when everything that goes into its job is in stock, and takes it at once, the first come first: nothing is
//! set aside for a job that still waits for something else.

use super::event::Event;
use super::job::Origin;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use toolroom_scenario::{ArrivalPattern, Pegging};

/// Pieces in stock that came together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StockArrival {
    /// Where they came from.
    pub origin: Origin,
    /// How many of them are left.
    pub pieces: u32,
}

impl<R: Recorder> Shop<'_, R> {
    /// Pieces of a part in stock that a job may take.
    fn in_stock(&self, part: usize, slot: u32) -> u64 {
        let all = self.world.stock[part].iter();
        all.filter(|own| self.is_for(**own, slot)).map(|own| u64::from(own.pieces)).sum()
    }

    /// Whether a job may take pieces in stock: where they are made for its order, or for none.
    fn is_for(&self, own: StockArrival, slot: u32) -> bool {
        let made_for = match own.origin {
            Origin::Order(order) => self.scenario.orders[order as usize].parent,
            Origin::Source(_) | Origin::Crib(_) | Origin::Stock(_) => None,
        };
        let row = self.world.jobs.at(slot).row;
        match self.scenario.parts[row.part as usize].pegging {
            Pegging::Stock => made_for.is_none(),
            Pegging::Order => made_for.is_some() && made_for == row.order.map(|order| order as usize),
        }
    }

    /// Whether a job needs no components for its operation, has taken them, or may take them now.
    pub(super) fn is_supplied(&self, slot: u32) -> bool {
        let job = self.world.jobs.at(slot);
        if job.supplied || !self.layout.operations[job.row.part as usize][job.operation as usize].assembles {
            return true;
        }
        let part = &self.scenario.parts[job.row.part as usize];
        let needed = |quantity: u32| u64::from(quantity) * u64::from(job.row.quantity);
        part.components.iter().all(|component| self.in_stock(component.part, slot) >= needed(component.quantity))
    }

    /// A job that begins takes its components.
    pub(super) fn supply(&mut self, slot: u32) -> Result<(), ShopError> {
        let scenario = self.scenario;
        let job = self.world.jobs.at_mut(slot);
        if job.supplied || !self.layout.operations[job.row.part as usize][job.operation as usize].assembles {
            return Ok(());
        }
        let part = &scenario.parts[job.row.part as usize];
        job.supplied = true;
        let quantity = job.row.quantity;
        for component in &part.components {
            let mut needed = component.quantity.saturating_mul(quantity);
            while needed > 0 {
                let place = self.world.stock[component.part].iter().position(|own| self.is_for(*own, slot));
                let Some(place) = place else { break };
                let first = &mut self.world.stock[component.part][place];
                let taken = first.pieces.min(needed);
                first.pieces -= taken;
                needed -= taken;
                if first.pieces == 0 {
                    let origin = first.origin;
                    self.world.stock[component.part].remove(place);
                    self.replace(origin)?;
                }
            }
            if let Some(stock) = self.stock_of(component.part) {
                self.reorder(stock)?;
            }
        }
        Ok(())
    }

    /// Constant work lets the next job in for one that has left.
    pub(super) fn replace(&mut self, origin: Origin) -> Result<(), ShopError> {
        if let Origin::Source(source) = origin
            && matches!(self.scenario.arrivals[source as usize].pattern, ArrivalPattern::ConstantWork { .. })
        {
            // By an event: a routing without duration must not recurse.
            self.schedule(self.now(), Event::Arrival { source })?;
        }
        Ok(())
    }

    /// Finished pieces of a component come to its stock.
    pub(super) fn stock(&mut self, part: usize, origin: Origin, pieces: u32) -> Result<(), ShopError> {
        self.world.stock[part].push_back(StockArrival { origin, pieces });
        for machine in 0..self.layout.takes[part].len() {
            self.may_choose(self.layout.takes[part][machine] as usize);
        }
        Ok(())
    }
}
