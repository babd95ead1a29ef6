//! Parts that are put together from others: components wait in stock until all of them are there.
//!
//! A component is finished when it comes to the stock of its part. An operation that assembles begins only
//! when everything that goes into its job is in stock, and takes it at once, the first come first: nothing is
//! set aside for a job that still waits for something else.

use super::event::Event;
use super::job::Origin;
use super::recorder::Recorder;
use super::{Shop, ShopError};
use toolroom_scenario::ArrivalPattern;

/// Pieces in stock that came together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stocked {
    /// Where they came from.
    pub origin: Origin,
    /// How many of them are left.
    pub pieces: u32,
}

impl<R: Recorder> Shop<'_, R> {
    /// Pieces of a part in stock.
    fn in_stock(&self, part: usize) -> u64 {
        self.world.stock[part].iter().map(|own| u64::from(own.pieces)).sum()
    }

    /// Whether a job needs no components for its operation, has taken them, or may take them now.
    pub(super) fn is_supplied(&self, slot: u32) -> bool {
        let job = self.world.jobs.at(slot);
        if job.supplied || !self.layout.operations[job.row.part as usize][job.operation as usize].assembles {
            return true;
        }
        let part = &self.scenario.parts[job.row.part as usize];
        let needed = |quantity: u32| u64::from(quantity) * u64::from(job.row.quantity);
        part.components.iter().all(|component| self.in_stock(component.part) >= needed(component.quantity))
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
                let Some(first) = self.world.stock[component.part].front_mut() else { break };
                let taken = first.pieces.min(needed);
                first.pieces -= taken;
                needed -= taken;
                if first.pieces == 0 {
                    let origin = first.origin;
                    self.world.stock[component.part].pop_front();
                    self.replace(origin)?;
                }
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
    pub(super) fn stock(&mut self, part: usize, origin: Origin, pieces: u32) {
        self.world.stock[part].push_back(Stocked { origin, pieces });
        for machine in 0..self.layout.takes[part].len() {
            self.may_choose(self.layout.takes[part][machine] as usize);
        }
    }
}
