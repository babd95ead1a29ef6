//! What the jobs that came to a shop count, against what its file says: how many came, and what was scrapped.

use super::Diagnosis;
use super::queue::Came;
use std::collections::{BTreeMap, BTreeSet};
use toolroom_facts::Fact;
use toolroom_facts::arrivals::arrivals_of;
use toolroom_facts::scrap::{Pieces, scrap};
use toolroom_nominal::shop::{ExpectedScrap, Shop, expected_scrap};
use toolroom_records::Records;
use toolroom_scenario::Scenario;

/// Said where the data hold no jobs.
pub(super) const WITHOUT_JOBS: &str = "not tested: arrivals, scrap and lead times; for the first two --data is the folder that holds orders.csv beside \
                                       the events, and no other log is held out";
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
        match self.left() {
            Some(left) => facts.extend(self.scrap(&left, &mut untested)),
            None => untested.push("scrap, for want of a column `scrapped_quantity` in the orders".to_owned()),
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

    /// Pieces of the jobs that are done, by part type; `None` where nobody counted scrap.
    fn left(&self) -> Option<BTreeMap<&str, Pieces>> {
        let scrapped = self.records.numbers("scrapped_quantity")?;
        let finish = self.records.numbers("finish_time").unwrap_or_default();
        let quantity = self.records.numbers("quantity").unwrap_or_default();
        let mut left: BTreeMap<&str, Pieces> = BTreeMap::new();
        for (row, part) in self.parts().iter().enumerate() {
            // A job without a quantity is one piece.
            let pieces = quantity.get(row).copied().filter(|pieces| pieces.is_finite()).unwrap_or(1.0).round() as u64;
            let done = finish.get(row).is_some_and(|time| time.is_finite());
            if done && scrapped[row].is_finite() {
                let own = left.entry(part).or_insert(Pieces { left: 0, scrapped: 0 });
                own.left += pieces;
                own.scrapped += (scrapped[row].round() as u64).min(pieces);
            }
        }
        (!left.is_empty()).then_some(left)
    }

    /// Scrap of every part type that inspections alone scrap.
    fn scrap(&self, left: &BTreeMap<&str, Pieces>, untested: &mut Vec<String>) -> Vec<Fact> {
        let most = left.values().map(|pieces| pieces.left).max().unwrap_or(0);
        let mut facts = Vec::new();
        for expected in expected_scrap(&self.scenario, most) {
            let ExpectedScrap { part, left: planned, scrapped, clustering, operation, otherwise } = expected;
            let Some(recorded) = left.get(part.as_str()) else { continue };
            if otherwise {
                untested.push(format!("scrap of {part}, which follows from wear and breakdowns"));
                continue;
            }
            let place = operation.map_or_else(|| part.clone(), |operation| format!("{part}/{operation}"));
            facts.extend(scrap(&place, *recorded, Pieces { left: planned, scrapped }, clustering));
        }
        facts
    }
}
