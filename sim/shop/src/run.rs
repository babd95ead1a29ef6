//! A run from where a shop is to its horizon.

use super::Shop;
use super::error::ShopError;
use super::plain_plan::is_plain;
use super::plain_shop::{PlainShop, agenda_of};
use super::recorder::Recorder;
use super::world::World;
use toolroom_kernel::{KernelError, SimTime};

/// Pieces of a run between which it looks whether it is still wanted.
const LOOKS: u32 = 256;

/// What became of a run.
enum Ended<R> {
    /// It is over, or has stopped for a reason.
    Over(R, Option<ShopError>),
    /// It was given up.
    GivenUp,
}

impl<R: Recorder> Shop<'_, R> {
    /// Runs to the horizon of the scenario and closes the log.
    ///
    /// # Errors
    /// [`ShopError`]; nothing of the log is handed out then.
    pub fn run(self) -> Result<R, ShopError> {
        match self.run_as_far() {
            (recorder, None) => Ok(recorder),
            (_, Some(reason)) => Err(reason),
        }
    }

    /// Runs like [`Shop::run`], and hands out what was recorded when the shop stopped before its
    /// horizon, too, with the reason. Passes in process are then left out.
    pub fn run_as_far(self) -> (R, Option<ShopError>) {
        match self.run_to_horizon(|| true) {
            Ended::Over(recorder, reason) => (recorder, reason),
            Ended::GivenUp => unreachable!("it is wanted for ever"),
        }
    }

    /// Runs like [`Shop::run`] while `goes_on` says so, which is asked now and then; `None` where it is given up. Asking at
    /// any time changes nothing of a run that goes on.
    ///
    /// # Errors
    /// [`ShopError`]: the shop stopped.
    pub fn run_while(self, goes_on: impl Fn() -> bool) -> Result<Option<R>, ShopError> {
        match self.run_to_horizon(goes_on) {
            Ended::Over(recorder, None) => Ok(Some(recorder)),
            Ended::Over(_, Some(reason)) => Err(reason),
            Ended::GivenUp => Ok(None),
        }
    }

    fn run_to_horizon(mut self, goes_on: impl Fn() -> bool) -> Ended<R> {
        let horizon = self.scenario.horizon;
        let pieces = (1..=LOOKS).map(|look| SimTime::from_seconds(horizon * f64::from(look) / f64::from(LOOKS)));
        if self.events == 0 && is_plain(self.scenario, &self.layout) {
            return self.run_plain(pieces, goes_on);
        }
        for time in pieces {
            if !goes_on() {
                return Ended::GivenUp;
            }
            if let Err(reason) = time.map_err(ShopError::from).and_then(|time| self.run_until(time)) {
                return Ended::Over(self.hand_out(), Some(reason));
            }
        }
        let closed = SimTime::from_seconds(horizon).map_err(ShopError::from).and_then(|horizon| self.close(horizon));
        Ended::Over(self.hand_out(), closed.err())
    }

    /// The same to the same effect in a shop at time zero that [is plain](is_plain).
    fn run_plain(
        self,
        pieces: impl Iterator<Item = Result<SimTime, KernelError>>,
        goes_on: impl Fn() -> bool,
    ) -> Ended<R> {
        let Self { scenario, layout, streams, world: World { sources, .. }, calendar, recorder, .. } = self;
        let agenda = match agenda_of(calendar) {
            Ok(agenda) => agenda,
            Err(reason) => return Ended::Over(recorder, Some(reason)),
        };
        let (mut shop, mut horizon) = (PlainShop::new(scenario, layout, streams, (sources, agenda), recorder), None);
        for time in pieces {
            if !goes_on() {
                return Ended::GivenUp;
            }
            if let Err(reason) = time.map_err(ShopError::from).and_then(|time| shop.run_until(*horizon.insert(time))) {
                let now = shop.now();
                return Ended::Over(shop.hand_out(now), Some(reason));
            }
        }
        Ended::Over(shop.close(horizon.unwrap_or(SimTime::ZERO)), None)
    }
}
