//! How often jobs come to their operations where inspections send some back or to the scrap, and what replaces those that are lost.

use super::Shop;
use crate::Warning;
use toolroom_scenario::{InspectedTo, Order, Part, Replenish};

/// Times that a job is sent back until no more of them count: of a share of 95 % less than 1e-4 is left.
const MOST_ROUNDS: u32 = 200;

/// What becomes of the jobs of a part on average.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Visits {
    /// How often a job comes to every operation.
    pub by_operation: Vec<f64>,
    /// Share of the jobs that go through the last one and are not scrapped before.
    pub finished: f64,
}

impl Visits {
    /// Of the operations of a part. A job that was sent back `rework_max` times is scrapped instead of the next time.
    pub fn of(part: &Part) -> Self {
        let operations = &part.operations;
        let mut all = Self { by_operation: vec![0.0; operations.len()], finished: 0.0 };
        // Jobs that come to every operation from elsewhere than the one before it, after so many times back.
        let mut come = vec![0.0; operations.len()];
        match come.first_mut() {
            Some(first) => *first = 1.0,
            None => all.finished = 1.0,
        }
        for round in 0..MOST_ROUNDS {
            let mut back = vec![0.0; operations.len()];
            let mut here = 0.0;
            for (number, operation) in operations.iter().enumerate() {
                here += come[number];
                all.by_operation[number] += here;
                let inspection = &operation.inspection;
                let mut good = 1.0;
                for outcome in &inspection.outcomes {
                    good -= outcome.share;
                    match outcome.to {
                        InspectedTo::Operation(to) if inspection.rework_max.is_none_or(|most| round < most) => {
                            back[to] += here * outcome.share;
                        }
                        InspectedTo::Operation(_) | InspectedTo::Scrap => {}
                    }
                }
                here *= good.max(0.0);
            }
            all.finished += here;
            if back.iter().all(|share| *share == 0.0) {
                break;
            }
            come = back;
        }
        all
    }
}

impl Shop<'_> {
    /// Pieces of an order that are begun for every one of its quantity: where lost ones begin anew, those that replace them too.
    pub(super) fn begun(&self, order: &Order, visits: &Visits) -> f64 {
        match self.scenario.parts[order.part].replenish {
            Replenish::NewOrder { .. } if visits.finished > 0.0 => 1.0 / visits.finished,
            // What is always lost begins anew for ever; that is a warning of its own.
            Replenish::NewOrder { .. } | Replenish::Nothing | Replenish::Overrun(_) => 1.0,
        }
    }

    /// Lost pieces that are never made up for, and keys that replace none.
    pub(super) fn never_replaced(&self) -> Vec<Warning> {
        let scenario = self.scenario;
        let told = |(index, part): (usize, &Part)| {
            if part.replenish == Replenish::Nothing {
                return None;
            }
            let name = &part.name;
            if !scenario.orders.iter().any(|order| order.part == index) {
                let message =
                    format!("`replenish` of part \"{name}\" does nothing: it acts on orders, and none is of this part");
                return Some(Warning { code: "no-effect", message });
            }
            let lost = matches!(part.replenish, Replenish::NewOrder { .. }) && Visits::of(part).finished <= 0.0;
            let message =
                || format!("orders of part \"{name}\" are never finished: every piece is scrapped and begins anew");
            lost.then(|| Warning { code: "never-finished", message: message() })
        };
        scenario.parts.iter().enumerate().filter_map(told).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Visits;
    use toolroom_scenario::{InspectedTo, InspectionOutcome, Part, Scenario};

    /// A shop of one machine with a part of three operations, of which the last one sends a fifth back to the first and scraps a tenth.
    fn shop(part: &str, rework_max: &str, demand: &str) -> Scenario {
        let outcomes = "outcomes = [{ share = 0.2, go = \"turn\" }, { share = 0.1, scrap = true }]";
        let operation = |name: &str, more: &str| {
            format!("[[part.operation]]\nname = \"{name}\"\nmachines = [\"M\"]\nwork = \"1 min\"\n{more}\n")
        };
        let last = format!("{outcomes}\n{rework_max}");
        let text = [
            "schema = 1\n[shop]\nname = \"rework\"\nhorizon = \"8 h\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\n",
            "[[part]]\nname = \"shaft\"\n",
            part,
            &operation("turn", ""),
            &operation("grind", ""),
            &operation("measure", &last),
            demand,
        ];
        toolroom_scenario_file::parse("rework", &text.concat(), &[]).unwrap_or_else(|error| panic!("{error}")).scenario
    }

    const SOURCE: &str = "[[arrivals]]\npart = \"shaft\"\npattern = \"poisson\"\nrate = \"1 1/h\"\n";
    const ORDER: &str = "[[order]]\nid = \"A\"\npart = \"shaft\"\nquantity = 7\ndue = \"8 h\"\n";

    fn part(rework_max: &str) -> Part {
        shop("", rework_max, SOURCE).parts.remove(0)
    }

    #[test]
    fn what_replaces_lost_pieces_is_work_of_an_order() {
        let minutes = |part: &str| crate::workload::workload(&shop(part, "", ORDER)).loads[0].work / 60.0;
        // 1.25 visits of a minute at each of three operations for seven pieces, for 7 / 0.875 = 8 pieces, or for 7 + 1.
        assert!((minutes("") - 26.25).abs() < 1e-9);
        assert!((minutes("replenish = \"new_order\"\n") - 30.0).abs() < 1e-9);
        assert!((minutes("replenish = { overrun = 0.1 }\n") - 30.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_never_replaced_is_told() {
        let told = |shop: &Scenario| -> Vec<&str> {
            crate::workload::workload(shop).warnings.iter().map(|warning| warning.code).collect()
        };
        let anew = "replenish = \"new_order\"\n";
        assert_eq!(told(&shop(anew, "", SOURCE)), ["no-effect"]);
        assert!(told(&shop(anew, "", ORDER)).is_empty());
        let mut lost = shop(anew, "", ORDER);
        lost.parts[0].operations[2].inspection.outcomes =
            vec![InspectionOutcome { share: 1.0, to: InspectedTo::Scrap }];
        assert_eq!(told(&lost), ["never-finished"]);
    }

    #[test]
    fn jobs_come_again_as_often_as_the_shares_say() {
        let all = Visits::of(&part(""));
        // 1 / (1 − 0.2), and of each visit 0.7 go on.
        assert!(all.by_operation.iter().all(|visits| (visits - 1.25).abs() < 1e-12), "{all:?}");
        assert!((all.finished - 0.875).abs() < 1e-12, "{all:?}");
    }

    #[test]
    fn who_was_sent_back_often_enough_is_scrapped() {
        let all = Visits::of(&part("rework_max = 1"));
        assert!(all.by_operation.iter().all(|visits| (visits - 1.2).abs() < 1e-12), "{all:?}");
        assert!((all.finished - 0.7 * 1.2).abs() < 1e-12, "{all:?}");
        assert_eq!(Visits::of(&part("rework_max = 0")).by_operation, [1.0; 3]);
    }
}
