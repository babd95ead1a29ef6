//! Key figures of a shop from what its machines did, on one mix of programs.

use std::collections::BTreeMap;
use toolroom_nominal::shop::{Program, Shop, Visits};

/// Key figures of an event log, on a given mix of programs: two logs of different jobs compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShopKpi {
    /// Mean time that an operation occupies its machine, breakdowns and nights left out, s.
    pub cycle_time: f64,
    /// Operations per hour of an occupied machine, 1/s.
    pub throughput: f64,
    /// Programmed time in cut over occupied time: the performance part of the OEE (ISO 22400-2).
    pub effectiveness: f64,
}

/// Operations by program: the mix on which logs are compared.
pub fn mix(visits: &Visits) -> BTreeMap<String, f64> {
    let mut counts = BTreeMap::new();
    for visit in &visits.list {
        *counts.entry(visits.programs[visit.program].clone()).or_insert(0.0) += 1.0;
    }
    counts
}

impl ShopKpi {
    /// Of a log; programs of the mix that it or the nominal shop does not know are left out.
    pub fn from_shop(shop: &Shop, seen: &Visits, mix: &BTreeMap<String, f64>) -> Self {
        let mut occupied: BTreeMap<&str, [f64; 3]> = BTreeMap::new();
        for visit in &seen.list {
            let changes: f64 = visit.changes.iter().chain(&visit.holds).chain(&visit.stops).sum();
            let name = seen.programs[visit.program].as_str();
            let of_one = |own: &Program| visit.times(own.pieces) * own.pace_on(&seen.machines[visit.machine]);
            let pace = shop.programs.get(name).map_or(1.0, of_one);
            let [sum, paces, visits] = occupied.entry(name).or_default();
            *sum += visit.cutting + visit.handling + visit.setup + changes;
            *paces += pace;
            *visits += 1.0;
        }
        let (mut time, mut programmed, mut count) = (0.0, 0.0, 0.0);
        for (name, share) in mix {
            let (Some([sum, paces, visits]), Some(program)) = (occupied.get(name.as_str()), shop.programs.get(name))
            else {
                continue;
            };
            time += share * sum / visits;
            programmed += share * program.time * paces / visits;
            count += share;
        }
        Self { cycle_time: time / count, throughput: count / time, effectiveness: programmed / time }
    }
}
