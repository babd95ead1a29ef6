//! Stations, how occupied they are, and what a faster cell would change.

use crate::kpi;
use crate::study::Study;
use toolroom_scenario::{ArrivalPattern, Scenario};
use toolroom_statistics::{CONFIDENCE, t_interval};

/// Machines that can do the same operations.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Machines by index.
    pub machines: Vec<usize>,
    /// Their names.
    pub name: String,
    /// Mean share of the shift in which they are not idle.
    pub load: f64,
    /// Share of that time in cut or tool change; 0 where the policy sets no speed.
    pub cell_share: f64,
    /// Share of the shift in cut.
    pub cutting_share: f64,
    /// Whether the policy sets the speed of these machines.
    pub in_cell: bool,
}

/// The stations of a scenario with their loads under the first policy of a study.
pub fn stations(scenario: &Scenario, study: &Study) -> Vec<Station> {
    let cell = kpi::cell(scenario);
    let mean = |machine: usize, id: &str| {
        let values = study.machine_index(machine, id).map_or_else(Vec::new, |kpi| study.values(0, kpi));
        t_interval(&values, CONFIDENCE).mean
    };
    groups(scenario)
        .into_iter()
        .map(|machines| {
            let average = |of: &dyn Fn(usize) -> f64| {
                machines.iter().map(|&machine| of(machine)).sum::<f64>() / machines.len() as f64
            };
            let in_shift = average(&|machine| 1.0 - mean(machine, "off_shift_time_share"));
            let occupied = in_shift - average(&|machine| mean(machine, "idle_time_share"));
            let cutting = average(&|machine| mean(machine, "cutting_time_share"));
            let change = average(&|machine| mean(machine, "tool_change_time_share"));
            let in_cell = machines.iter().all(|machine| cell.contains(machine));
            let names: Vec<&str> = machines.iter().map(|&machine| scenario.machines[machine].name.as_str()).collect();
            Station {
                name: names.join(" + "),
                load: occupied / in_shift,
                cell_share: if in_cell { (cutting + change) / occupied } else { 0.0 },
                cutting_share: cutting / in_shift,
                in_cell,
                machines,
            }
        })
        .collect()
}

/// Machines that are named by the same operations, in the order of the machines.
fn groups(scenario: &Scenario) -> Vec<Vec<usize>> {
    let named = |machine: usize| -> Vec<bool> {
        let operations = scenario.parts.iter().flat_map(|part| &part.operations);
        operations.map(|operation| operation.machines.contains(&machine)).collect()
    };
    let mut groups: Vec<(Vec<bool>, Vec<usize>)> = Vec::new();
    for machine in 0..scenario.machines.len() {
        let signature = named(machine);
        match groups.iter_mut().find(|(other, _)| *other == signature && signature.contains(&true)) {
            Some((_, machines)) => machines.push(machine),
            None => groups.push((signature, vec![machine])),
        }
    }
    groups.into_iter().map(|(_, machines)| machines).collect()
}

/// The most occupied station.
pub(super) fn bottleneck(stations: &[Station]) -> Option<usize> {
    let loaded = stations.iter().enumerate().filter(|(_, station)| station.load > 0.0);
    loaded.max_by(|(_, a), (_, b)| a.load.total_cmp(&b.load)).map(|(index, _)| index)
}

/// Greatest shop gain at a cell gain; NaN where nothing is loaded.
pub(super) fn amdahl_limit(scenario: &Scenario, stations: &[Station], cell_gain: f64, offered_over_made: f64) -> f64 {
    let Some(bottleneck) = bottleneck(stations).filter(|_| cell_gain.is_finite()) else { return f64::NAN };
    let constant_work =
        scenario.arrivals.iter().any(|arrival| matches!(arrival.pattern, ArrivalPattern::ConstantWork { .. }));
    let attainable = if constant_work { stations[bottleneck].load } else { 1.0_f64.max(stations[bottleneck].load) };
    let loads = stations.iter().filter(|station| station.load > 0.0).map(|station| {
        let share = station.cell_share;
        station.load * (1.0 - share + share / cell_gain)
    });
    let heaviest = loads.fold(0.0, f64::max);
    (attainable / heaviest).min(offered_over_made)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    fn station(load: f64, cell_share: f64) -> Station {
        Station {
            machines: vec![0],
            name: String::new(),
            load,
            cell_share,
            cutting_share: 0.0,
            in_cell: cell_share > 0.0,
        }
    }

    fn constant_work() -> Scenario {
        let mut scenario = fixture::scenario();
        scenario.arrivals[0].pattern = ArrivalPattern::ConstantWork { jobs: 9 };
        scenario
    }

    #[test]
    fn lathes_that_share_their_operations_are_one_station() {
        assert_eq!(groups(&fixture::scenario()), [vec![0, 1], vec![2]]);
    }

    #[test]
    fn a_cell_that_is_the_bottleneck_gains_by_amdahls_law() {
        // Half of the time sped up by two: 1 / (0.5 + 0.25).
        let limit = amdahl_limit(&constant_work(), &[station(0.9, 0.5)], 2.0, f64::INFINITY);
        assert!((limit - 4.0 / 3.0).abs() < 1e-15);
    }

    #[test]
    fn the_next_station_limits_the_gain() {
        let stations = [station(0.9, 1.0), station(0.75, 0.0)];
        assert!((amdahl_limit(&constant_work(), &stations, 3.0, f64::INFINITY) - 1.2).abs() < 1e-15);
    }

    #[test]
    fn a_bottleneck_outside_the_cell_leaves_no_gain() {
        let stations = [station(0.6, 1.0), station(0.95, 0.0)];
        assert_eq!(amdahl_limit(&constant_work(), &stations, 1.5, f64::INFINITY), 1.0);
    }

    #[test]
    fn nothing_is_gained_beyond_the_parts_that_are_offered() {
        let stations = [station(0.5, 1.0)];
        assert_eq!(amdahl_limit(&fixture::scenario(), &stations, 1.5, 1.05), 1.05);
        // A cell half as fast is still fast enough for them.
        assert_eq!(amdahl_limit(&fixture::scenario(), &stations, 0.5, 1.0), 1.0);
    }

    #[test]
    fn an_undefined_gain_gives_no_limit() {
        assert!(amdahl_limit(&constant_work(), &[station(0.9, 0.5)], f64::NAN, f64::INFINITY).is_nan());
        assert!(amdahl_limit(&constant_work(), &[], 1.5, f64::INFINITY).is_nan());
    }
}
