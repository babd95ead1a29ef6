//! How wear, rate and hardness of a row move its readings and the land that it leaves behind.

use super::run::{Parts, Setting, rates};
use super::scattered::Scattered;
use super::slopes::{Differentiated, OUTPUTS, Sensitive, written};
use super::{Cutting, Nominal, Source};
use crate::{Point, Transform};
use rayon::prelude::*;
use toolroom_innovations::{Chain, Reading, Row};
use toolroom_process::Record;

/// Step of hardness in a difference, relative.
const SMALL: f64 = 1e-4;
/// Factor by which a row may carry a difference of land on, and standard deviations of its sensor by which a reading may
/// move (1). Assumption: beyond it the edge of the model has run away, and its slopes say nothing; squares of them would
/// leave the numbers.
const RUNAWAY: f64 = 1e6;
/// Land that a row may leave, m. Assumption: no edge has a land of a metre; as above.
const ENDLESS: f64 = 1.0;

impl<P: Nominal> Cutting<P> {
    /// The chain of each edge about `point`; none where the scenario says nothing of its scatter.
    pub(super) fn chains_at(&self, point: &Point) -> Vec<Chain> {
        let Some(scattered) = &self.scattered else { return Vec::new() };
        let setting = self.setting(point);
        (0..self.rows.len()).into_par_iter().map(|group| self.chain(&setting, scattered, group)).collect()
    }

    fn chain(&self, setting: &Setting<'_, P>, scattered: &Scattered, group: usize) -> Chain {
        let scatter = &scattered.scatter;
        let parts = Parts::of::<P>();
        let channels = self.outputs.len();
        let mut places = vec![Vec::new(); self.rows[group].len()];
        for place in self.frame.measured.spans[group].clone() {
            places[self.places[self.frame.measured.observations[place].row]].push(place);
        }
        let mut x = self.fresh(setting.start);
        let mut rows = Vec::with_capacity(places.len());
        for (row, places) in self.rows[group].iter().zip(places) {
            let (u, factor) = self.conditions(setting, group, *row);
            let mut harder = u;
            harder.set(self.ports.hardness, u.get(self.ports.hardness).unwrap_or(1.0) * (1.0 + SMALL));
            let (held, hard, of_land) =
                (setting.process(*row).held(&u), setting.process(*row).held(&harder), setting.of_land(*row));
            self.cool(&parts, *row, &mut x);
            // By level, rate and hardness.
            let mut carried: [Sensitive; 3] = [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
            let mut sums = vec![[0.0; 3]; channels];
            let (mut means, mut seen) = (vec![0.0; channels], 0.0);
            for step in &self.steps[*row] {
                let local = Differentiated::new(self, &parts, &held, x, step, factor, &of_land);
                let weight = if step.seen { step.length } else { 0.0 };
                seen += weight;
                let faster = [x, local.middle].map(|x| {
                    let [there, here] =
                        [&hard, &held].map(|held| rates::<P>(&parts, held, &x, factor, &of_land)[parts.land]);
                    if here > 0.0 && there > 0.0 { (there / here).ln() / SMALL } else { 0.0 }
                });
                for (i, phi) in [[0.0; 2], [1.0; 2], faster].into_iter().enumerate() {
                    let mut values = vec![0.0; channels];
                    local.carry(self, &mut carried[i], phi, weight, &mut values);
                    sums.iter_mut().zip(values).for_each(|(sums, value)| sums[i] += value);
                }
                if step.seen && !self.means.is_empty() {
                    let there: [f64; OUTPUTS] = written(&self.observe(&hard, &local.middle));
                    for (channel, output) in &self.means {
                        means[*channel] += weight * local.y[*output];
                        sums[*channel][2] += weight * (there[*output] - local.y[*output]) / SMALL;
                    }
                }
                x = local.end;
            }
            let reading = |place: usize| {
                let observation = &self.frame.measured.observations[place];
                let channel = observation.channel;
                let (by, mean) = match self.outputs[channel] {
                    Source::Wear => (carried.map(|s| s[0]), x[parts.land]),
                    Source::Output(_) => (sums[channel].map(|sum| sum / seen), means[channel] / seen),
                    Source::Duration | Source::Stops => ([0.0; 3], 1.0),
                };
                let unit = match self.frame.measured.channels[channel].transform {
                    Transform::Linear => self.signs[channel],
                    Transform::Log => mean.recip(),
                };
                let scales = [scattered.land_deviation(), 1.0, 1.0];
                let moves = |slope: f64, scale: f64| (slope * unit * scale).abs() < RUNAWAY * observation.deviation;
                let by = [0, 1, 2].map(|i| if moves(by[i], scales[i]) { by[i] * unit } else { 0.0 });
                Reading { place, by, deviation: observation.deviation }
            };
            rows.push(Row {
                readings: places.into_iter().map(reading).collect(),
                level_by: left_behind(carried.map(|s| s[0])),
                memory: (-self.durations[*row] / scatter.life_noise_time).exp(),
                lot: scattered.lots[*row],
            });
        }
        Chain {
            level: scattered.land_deviation(),
            rate: scatter.life_noise,
            lot: scatter.batch_hardness,
            piece: scatter.piece_hardness,
            rows,
        }
    }
}

/// How the land that a row leaves follows from the land before it, the rate and the hardness: from nothing of which the
/// model ran away.
fn left_behind(slopes: [f64; 3]) -> [f64; 3] {
    let ends = [RUNAWAY, ENDLESS, ENDLESS];
    [0, 1, 2].map(|i| if slopes[i].abs() < ends[i] { slopes[i] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use crate::{Direction, NominalModel, Point, Transform};
    use toolroom_records::parse_csv;
    use toolroom_truth::Case;

    /// Of a cut of 20.5 s half a second counts; it was taken for a sliver, its means were of nothing, and one such row made
    /// a whole fit unknown.
    #[test]
    fn a_cut_of_any_length_has_predictions() {
        let text = include_str!("../../../../scenarios/gap/turning.toml");
        let model = NominalModel::parse("turning.toml", text, &[]).unwrap();
        let (mut records, _) = parse_csv("truth", Case::null("turning", 3).records().as_bytes(), model.kind()).unwrap();
        let lengths: Vec<f64> = (0..records.len()).map(|row| 18.0 + 0.1 * (row % 50) as f64).collect();
        records.set_numbers("cutting_time", lengths);
        let (model, _) = model.over(&records, None, |_, _| false);
        let raw = model.simulate(&Point::nominal(model.as_ref()));
        assert!(raw.len() > 100 && raw.iter().all(|value| value.is_finite()));
    }

    #[test]
    fn an_edge_that_ran_away_leaves_nothing_that_is_no_number() {
        use super::left_behind;
        assert_eq!(left_behind([1.1, 2e-6, -3e-6]), [1.1, 2e-6, -3e-6]);
        assert_eq!(left_behind([f64::NAN, f64::INFINITY, 1e200]), [0.0; 3]);
    }

    #[test]
    fn a_rate_that_stays_moves_the_chain_as_the_level_of_the_wear_rate_moves_the_model() {
        let text = include_str!("../../../../scenarios/gap/turning.toml");
        let model = NominalModel::parse("turning.toml", text, &[]).unwrap();
        let csv = Case::null("turning", 3).records();
        let (records, _) = parse_csv("truth", csv.as_bytes(), model.kind()).unwrap();
        let (model, _) = model.over(&records, None, |_, _| false);
        let frame = model.frame();
        let point = Point::nominal(model.as_ref());
        let level = frame.parameters.iter().position(|parameter| parameter.name == "wear rate level").unwrap();
        let raw = model.simulate(&point);
        let slopes = model.slopes(&point, &raw, &[Direction::Parameter(level)]).remove(0);
        let chains = model.chains(&point);
        assert_eq!(chains.len(), frame.measured.groups.len());
        let mut compared = 0;
        for chain in &chains {
            let mut land = 0.0;
            for row in &chain.rows {
                for reading in &row.readings {
                    let observation = &frame.measured.observations[reading.place];
                    let unit = match frame.measured.channels[observation.channel].transform {
                        Transform::Linear => 1.0,
                        Transform::Log => raw[reading.place],
                    };
                    let moved = (reading.by[0] * land + reading.by[1]) * unit;
                    let golden = slopes[reading.place] / frame.parameters[level].deviation;
                    let scale = golden.abs().max(1e-3 * raw[reading.place].abs());
                    assert!((moved - golden).abs() < 0.01 * scale, "{moved} instead of {golden}");
                    compared += 1;
                }
                land = row.level_by[0] * land + row.level_by[1];
            }
        }
        assert!(compared > 500, "{compared}");
    }
}
