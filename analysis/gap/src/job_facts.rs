//! What the jobs that came to a shop count, against what its file says: how many came, and what was scrapped.

use super::Diagnosis;
use super::queue::Came;
use std::collections::{BTreeMap, BTreeSet};
use toolroom_facts::arrivals::arrivals_of;
use toolroom_facts::scrap::{Pieces, scrap};
use toolroom_facts::{Fact, FactDetail};
use toolroom_nominal::shop::{Shop, expected_scrap, settled};
use toolroom_records::Records;
use toolroom_scenario::Scenario;

/// Said where the data hold no jobs.
pub(super) const WITHOUT_JOBS: &str = "not tested: arrivals, scrap and lead times; for the first two --data is the folder that \
                                       holds orders.csv beside the events, and no other log is held out";
/// Parts that a note names (assumption: more are not read).
const NAMED: usize = 5;

/// The jobs that came to a shop, and the file by which it runs.
#[derive(Clone, Debug)]
pub struct Jobs {
    /// One row for each job.
    pub records: Records,
    /// The file.
    pub scenario: Scenario,
}

impl Jobs {
    /// Their facts, and in the notes of the `diagnosis` what is not tested of them. `events` say from when until when jobs were
    /// seen; the same `seed` gives the same replicated histories.
    pub(super) fn facts(&self, shop: &Shop, events: &Records, diagnosis: &mut Diagnosis, seed: u64) -> Vec<Fact> {
        let strangers = self.strangers();
        let mut facts: Vec<Fact> = self.arrivals(shop, events, seed).collect();
        // What is called otherwise in the log has not stayed away.
        facts.retain(|fact| fact.count > 0 || strangers.is_empty());
        let mut untested = vec!["lead times".to_owned()];
        untested.extend(shop.other_sources.iter().map(|parts| format!("arrivals of {parts}")));
        match self.left(diagnosis) {
            Ok(left) => facts.extend(self.scrap(&left, &mut untested)),
            Err(why) => untested.push(format!("scrap, {why}")),
        }
        diagnosis.notes.push(format!("not tested: {}", untested.join("; ")));
        if !strangers.is_empty() {
            let names: Vec<&str> = strangers.into_iter().take(NAMED).collect();
            let note = format!("jobs of parts that the model has not are of no source: {}", names.join(", "));
            diagnosis.notes.push(note);
        }
        facts
    }

    /// When each came and when its first operation began.
    pub(super) fn came(&self) -> Came<'_> {
        let of = |name: &str| self.records.numbers(name).unwrap_or_default();
        let names = self.records.texts("order").unwrap_or_default();
        let times = of("arrival_time").iter().zip(of("start_time"));
        names.iter().map(String::as_str).zip(times).map(|(name, (came, start))| (name, (*came, *start))).collect()
    }

    fn parts(&self) -> &[String] {
        self.records.texts("part_type").unwrap_or_default()
    }

    /// Part types of jobs that the file has not.
    fn strangers(&self) -> BTreeSet<&str> {
        let known = |part: &str| self.scenario.parts.iter().any(|own| own.name == part);
        self.parts().iter().map(String::as_str).filter(|part| !known(part)).collect()
    }

    /// Jobs of every source that comes by chance, between the first and the last event of the log.
    fn arrivals<'a>(&'a self, shop: &'a Shop, events: &Records, seed: u64) -> impl Iterator<Item = Fact> + use<'a> {
        let events = events.numbers("time").unwrap_or_default();
        let span = [
            events.iter().copied().fold(f64::INFINITY, f64::min),
            events.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ];
        let times = self.records.numbers("arrival_time").unwrap_or_default();
        shop.sources.iter().filter_map(move |source| {
            let own = self.parts().iter().zip(times).filter(|(part, _)| **part == source.part);
            let own: Vec<f64> = own.map(|(_, time)| *time).collect();
            arrivals_of(&source.part, &own, span, &source.interval, seed)
        })
    }

    /// Pieces of the jobs that are done, by part type; else why nobody knows.
    fn left(&self, diagnosis: &mut Diagnosis) -> Result<BTreeMap<&str, Pieces>, &'static str> {
        let scrapped = self
            .records
            .numbers("scrapped_quantity")
            .ok_or("for want of a column `scrapped_quantity` in the orders")?;
        let quantity = self.records.numbers("quantity").ok_or("for want of a column `quantity` in the orders")?;
        let finish = self.records.numbers("finish_time").ok_or("for want of a column `finish_time` in the orders")?;
        let came = self.records.numbers("arrival_time").unwrap_or_default();
        let times: Vec<(f64, f64)> = came.iter().copied().zip(finish.iter().copied()).collect();
        let mut left: BTreeMap<&str, Pieces> = BTreeMap::new();
        let mut impossible = 0;
        for (row, _) in settled(&times).into_iter().enumerate().filter(|(_, settled)| *settled) {
            let (pieces, lost) = (quantity[row].round(), scrapped[row].round());
            if lost > pieces {
                impossible += 1;
            } else if pieces.is_finite() && lost.is_finite() {
                let own = left.entry(&self.parts()[row]).or_insert(Pieces { left: 0, scrapped: 0 });
                own.left += pieces as u64;
                own.scrapped += lost as u64;
            }
        }
        if impossible > 0 {
            diagnosis
                .notes
                .push(format!("{impossible} orders of which more was scrapped than came do not count for scrap"));
        }
        if left.is_empty() { Err("for want of orders that are done") } else { Ok(left) }
    }

    /// Scrap of every part type that inspections alone scrap.
    fn scrap(&self, left: &BTreeMap<&str, Pieces>, untested: &mut Vec<String>) -> Vec<Fact> {
        let most = left.values().map(|pieces| pieces.left).max().unwrap_or(0);
        let expected = expected_scrap(&self.scenario, most);
        let mut facts = Vec::new();
        for (part, recorded) in left {
            let Some(own) = expected.iter().find(|own| own.part == *part) else {
                untested.push(format!("scrap of {part}, of which nothing left the simulated shop"));
                continue;
            };
            if own.otherwise {
                untested.push(format!(
                    "scrap of {part}, some of which follows from wear, breakdowns or the end of a shift"
                ));
                continue;
            }
            let place =
                own.operation.as_ref().map_or_else(|| own.part.clone(), |operation| format!("{part}/{operation}"));
            let planned = Pieces { left: own.left, scrapped: own.scrapped };
            let told = FactDetail { ownerless: own.operation.is_none(), ..FactDetail::default() };
            let fact = scrap(&place, *recorded, planned, own.clustering);
            facts.extend(fact.map(|fact| Fact { told, ..fact }));
        }
        facts
    }
}
