//! How the hardness of workpieces scatters from trial to trial in a run of the scenario.

use super::Grinding;
use crate::settings::Settings;
use crate::{Point, Transform, features};
use rayon::prelude::*;
use std::collections::BTreeMap;
use toolroom_innovations::{Chain, Reading, Row};
use toolroom_records::Records;

/// Step of hardness in a difference, relative.
const SMALL: f64 = 1e-4;

/// Scatter of the scenario, as far as trials show it. That of a dressing is a factor of its group.
pub(super) struct Scattered {
    /// Standard deviations of the hardness of lots, and of pieces about that of their lot, relative.
    hardness: [f64; 2],
    /// Lot of each row.
    lots: Vec<usize>,
}

impl Scattered {
    pub fn new(records: &Records, settings: &Settings) -> Self {
        let hardness = settings.scatter.map_or([0.0; 2], |own| [own.batch_hardness, own.piece_hardness]);
        Self { hardness, lots: features::lots(records, &settings.lots) }
    }
}

impl Grinding {
    /// The chain of each dressing about `point`: hardness moves all readings of a trial, and nothing is carried to the
    /// next one. None where workpieces are all alike.
    pub(super) fn chains_at(&self, point: &Point) -> Vec<Chain> {
        let Some(Scattered { hardness: [lot, piece], lots }) = &self.scattered else { return Vec::new() };
        if *lot == 0.0 && *piece == 0.0 {
            return Vec::new();
        }
        let process = self.process_at(point);
        let measured = &self.frame.measured;
        let chain = |group: usize| {
            let [nominal, harder] = [0.0, SMALL].map(|harder| self.dressing(&process, point, group, harder));
            let place: BTreeMap<usize, usize> =
                self.rows[group].iter().enumerate().map(|(place, row)| (*row, place)).collect();
            let mut readings = vec![Vec::new(); self.rows[group].len()];
            for i in measured.spans[group].clone() {
                let observation = &measured.observations[i];
                let channel = &measured.channels[observation.channel];
                let index = place[&observation.row];
                let [here, there] = [&nominal, &harder].map(|all| all[index].channel(channel.id));
                let slope = match channel.transform {
                    Transform::Linear => (there - here) / SMALL,
                    Transform::Log => (there / here).ln() / SMALL,
                };
                let slope = if slope.is_finite() { slope } else { 0.0 };
                readings[index].push(Reading { place: i, by: [0.0, 0.0, slope], deviation: observation.deviation });
            }
            let row = |(readings, row): (Vec<Reading>, &usize)| Row {
                readings,
                level_by: [0.0; 3],
                memory: 0.0,
                lot: lots[*row],
            };
            let rows = readings.into_iter().zip(&self.rows[group]).map(row).collect();
            Chain { level: 0.0, rate: 0.0, lot: *lot, piece: *piece, rows }
        };
        (0..self.rows.len()).into_par_iter().map(chain).collect()
    }
}
