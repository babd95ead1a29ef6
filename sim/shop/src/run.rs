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

#[cfg(test)]
mod tests {
    use super::super::runlog::RunLog;
    use super::*;
    use std::sync::Arc;
    use toolroom_scenario::Scenario;
    use toolroom_scenario::policies::ResolvedPolicy;

    /// A shop of four plain machines with all that such a shop may have, in one of several mixtures.
    fn shop(rule: &str, mixture: usize) -> Scenario {
        let mut text = format!(
            "schema = 1\n[shop]\nname = \"plain\"\nhorizon = \"60 h\"\nwarm_up = \"3 h\"\nseed = {mixture}\n\
             [dispatch]\nrule = {rule}\n"
        );
        for machine in 0..4 {
            text += &format!("[[machine]]\nname = \"M{machine}\"\nprocess = \"plain\"\n");
            match (mixture + machine) % 4 {
                1 => text += "setup_time = \"2 min\"\n",
                2 => text += "setup_matrix = \"m\"\nsetup_at_start = \"1\"\n",
                3 => text += "setup_at_start = \"\"\nsetup_time = \"0 min\"\n",
                _ => {}
            }
        }
        let row = |from: usize| format!("[{}]", [0, 1, 2].map(|to| format!("\"{} min\"", from + 2 * to)).join(", "));
        text += &format!(
            "[[setup_matrix]]\nname = \"m\"\ngroups = [\"0\", \"1\", \"2\"]\ntimes = [{}]\n",
            [0, 0, 1, 2].map(row).join(", ")
        );
        for part in 0..4 {
            text += &format!("[[part]]\nname = \"P{part}\"\nbatch_size = {}\noperation = [\n", 1 + part % 2);
            for step in 0..4 {
                let (machine, mean) = ((part * 3 + step * (part % 2 + 1)) % 4, 2 + (part + step) % 3);
                let work = match (step + mixture) % 4 {
                    2 => "\"3 min\"".to_owned(),
                    3 if part == 3 => "\"0 min\"".to_owned(),
                    _ => format!("{{ distribution = \"exponential\", mean = \"{mean} min\" }}"),
                };
                let more = ["", ", work_per = \"lot\"", ", setup_time = \"1 min\"", ""][(part + step + mixture) % 4];
                let pace = if step == 1 { format!(", time_on = {{ M{machine} = 1.25 }}") } else { String::new() };
                text += &format!(
                    "{{ name = \"{step}\", machines = \"M{machine}\", work = {work}, \
                     setup_group = \"{}\"{more}{pace} }},\n",
                    (part + step) % 3
                );
            }
            text += "]\n";
        }
        let due = ["", "due = { rule = \"TWK\", k = 4 }\n", "due = { rule = \"slack\", slack = \"1 h\" }\n"];
        let patterns = [
            "pattern = \"poisson\"\nrate = \"3 1/h\"\n",
            "pattern = \"renewal\"\ntime_between = { distribution = \"uniform\", low = \"10 min\", high = \"50 min\" }\n",
            "pattern = \"batch\"\ninterval = \"2 h\"\nsize = 4\n",
            "pattern = \"schedule\"\nlot = [{ time = \"5 h\", size = 3 }, { time = \"1 h\", size = 2 }]\n",
            "pattern = \"constant_work\"\njobs = 3\n",
        ];
        for source in 0..3 {
            let part = if source == 1 {
                "part_mix = { P1 = 0.3, P2 = 0.7 }\n"
            } else {
                ["part = \"P0\"\n", "", "part = \"P3\"\n"][source]
            };
            let quantity = if source == mixture % 3 { "quantity = { low = 1, high = 3 }\n" } else { "" };
            text += &format!(
                "[[arrivals]]\nname = \"S{source}\"\npriority = {source}\nweight = 1.5\n{part}{quantity}{}{}",
                patterns[(source + mixture) % 5],
                due[(source + mixture) % 3]
            );
        }
        let file = toolroom_scenario_file::parse("plain.toml", &text, &[]);
        file.unwrap_or_else(|error| panic!("{error:?}\n{text}")).scenario
    }

    fn opened(scenario: &Scenario) -> Shop<'_> {
        let policy = Arc::new(ResolvedPolicy::from_scenario(scenario, 0).unwrap());
        Shop::with_recorder(scenario, policy, 0, RunLog::default()).unwrap()
    }

    #[test]
    fn a_plain_shop_leaves_the_log_of_any_other() {
        let rules = [
            "\"fifo\"",
            "\"spt\"",
            "[\"priority\", \"edd\"]",
            "\"srpt\"",
            "\"odd\"",
            "\"most_operations\"",
            "\"lifo\"",
        ];
        for mixture in 0..42 {
            let scenario = shop(rules[mixture % 7], mixture);
            let plain = opened(&scenario);
            assert!(is_plain(&scenario, &plain.layout));
            let mut whole = plain.clone();
            whole.run_until(SimTime::from_seconds(scenario.horizon).unwrap()).unwrap();
            let (plain, whole) = (plain.run().unwrap(), whole.run().unwrap());
            assert!(plain.operations.len() > 500, "{}", plain.operations.len());
            // NaN in rows: compared as they are written.
            assert_eq!(format!("{plain:?}"), format!("{whole:?}"), "{mixture}");
        }
    }
}
