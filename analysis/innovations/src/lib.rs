//! Readings of something that goes on from row to row and scatters on its way: a worn edge in its operations.
//!
//! Three deviations decide about the readings of a row beside the errors of their sensors: a **level** that is
//! carried from row to row (the land of the edge), a **rate** by which it grows (an Ornstein–Uhlenbeck process),
//! and the **hardness** of the workpiece, a part of which it shares with its lot. Readings of all channels hang on
//! them, so that they are neither independent of each other nor of those of rows before.
//!
//! [`Chain`] says how; [`Filter`] turns any column of readings into innovations: what of each reading those before
//! it do not predict, in units of its predicted standard deviation. Where the chain is right they are independent
//! and standard normal. The cost is proportional to the number of readings.
//!
//! # Source
//! Kalman 1960; innovations as whitening: Kailath 1968. Sequential processing of readings with independent errors:
//! Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed., section 6.4.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Number of deviations: level, rate, hardness.
const DEVIATIONS: usize = 3;
/// Number of states: level, rate, hardness of the lot, hardness of the piece beside it.
const STATES: usize = 4;

/// A reading of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Its place in the columns that are whitened.
    pub place: usize,
    /// Its derivatives by level and rate at the start of the row, and by the hardness of the piece.
    pub by: [f64; DEVIATIONS],
    /// Standard deviation of its sensor.
    pub deviation: f64,
}

/// A row: an operation.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its readings, in any order.
    pub readings: Vec<Reading>,
    /// Derivatives of the level at its end by level and rate at its start, and by the hardness of the piece.
    pub level_by: [f64; DEVIATIONS],
    /// Correlation of the rate in the next row with that of this one, 0 … 1.
    pub memory: f64,
    /// The lot of its piece; numbers are those of all chains.
    pub lot: usize,
}

/// Rows in sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Standard deviation of the level at the start of the first row.
    pub level: f64,
    /// Standard deviation of the rate, relative to the nominal one.
    pub rate: f64,
    /// Standard deviation of the hardness of lots, relative.
    pub lot: f64,
    /// Standard deviation of the hardness of pieces about that of their lot, relative.
    pub piece: f64,
    /// The rows.
    pub rows: Vec<Row>,
}

impl Chain {
    /// Adds a draw of what the chain scatters by, without errors of sensors, to `column`; `lots` holds a standard
    /// normal number for each lot. The rate is multiplied by a lognormal factor of mean 1. Takes two numbers a row and
    /// two more from `random`.
    ///
    /// # Panics
    /// Where a lot has no number, or a reading no place in `column`.
    pub fn add_draw<R: Rng + ?Sized>(&self, random: &mut R, lots: &[f64], column: &mut [f64]) {
        let mut normal = || -> f64 { StandardNormal.sample(random) };
        let mut level = self.level * normal();
        let mut noise = self.rate * normal();
        for row in &self.rows {
            let hardness = self.lot * lots[row.lot] + self.piece * normal();
            let x = [level, (noise - 0.5 * self.rate * self.rate).exp_m1(), hardness];
            for reading in &row.readings {
                column[reading.place] += dot(&reading.by, &x);
            }
            level = dot(&row.level_by, &x);
            noise = row.memory * noise + self.rate * (1.0 - row.memory * row.memory).max(0.0).sqrt() * normal();
        }
    }
}

/// What a reading does in the filter.
#[derive(Clone, Copy, Debug)]
struct Gain {
    place: usize,
    by: [f64; STATES],
    /// What a unit of its innovation says about the deviations.
    gain: [f64; STATES],
    /// One over the predicted standard deviation.
    precision: f64,
    /// Share of the predicted variance that is the sensor's.
    share: f64,
}

/// The filter of a chain: its gains do not depend on the readings.
#[derive(Clone, Debug)]
pub struct Filter {
    rows: Vec<FilteredRow>,
}

#[derive(Clone, Debug)]
struct FilteredRow {
    gains: Vec<Gain>,
    level_by: [f64; STATES],
    /// Share of the rate, and of the hardness of the lot, that the next row keeps.
    kept: [f64; 2],
}

/// Hardness counts the same, whether of lot or piece.
fn of_states([level, rate, hardness]: [f64; DEVIATIONS]) -> [f64; STATES] {
    [level, rate, hardness, hardness]
}

impl Filter {
    /// The filter of `chain`. A lot that comes back after another counts as a new one.
    pub fn new(chain: &Chain) -> Self {
        let squares = [chain.level, chain.rate, chain.lot, chain.piece].map(|deviation| deviation * deviation);
        let mut p = [[0.0; STATES]; STATES];
        (0..STATES).for_each(|i| p[i][i] = squares[i]);
        let mut rows = Vec::with_capacity(chain.rows.len());
        for (index, row) in chain.rows.iter().enumerate() {
            let mut gains = Vec::with_capacity(row.readings.len());
            for reading in &row.readings {
                let by = of_states(reading.by);
                let cross: [f64; STATES] = std::array::from_fn(|i| dot(&p[i], &by));
                let sensor = reading.deviation * reading.deviation;
                let variance = dot(&cross, &by) + sensor;
                let gain = cross.map(|cross| cross / variance);
                for (p, gain) in p.iter_mut().zip(gain) {
                    p.iter_mut().zip(cross).for_each(|(p, cross)| *p -= gain * cross);
                }
                let precision = variance.sqrt().recip();
                gains.push(Gain { place: reading.place, by, gain, precision, share: sensor / variance });
            }
            // To the next row: the level grows, the rate forgets, a lot stays or goes.
            let stays = chain.rows.get(index + 1).is_some_and(|next| next.lot == row.lot);
            let kept = [row.memory, f64::from(u8::from(stays))];
            let level_by = of_states(row.level_by);
            let to = [level_by, [0.0, kept[0], 0.0, 0.0], [0.0, 0.0, kept[1], 0.0], [0.0; STATES]];
            let half: [[f64; STATES]; STATES] =
                std::array::from_fn(|i| std::array::from_fn(|j| (0..STATES).map(|k| to[i][k] * p[k][j]).sum()));
            p = std::array::from_fn(|i| std::array::from_fn(|j| dot(&half[i], &to[j])));
            for (i, kept) in [(1, kept[0]), (2, kept[1]), (3, 0.0)] {
                p[i][i] += squares[i] * (1.0 - kept * kept);
            }
            rows.push(FilteredRow { gains, level_by, kept });
        }
        Self { rows }
    }

    /// Writes the innovations of `column` over their predicted standard deviations into `white`, at the places of
    /// the readings; other places stay as they are.
    pub fn whiten(&self, column: &[f64], white: &mut [f64]) {
        let mut x = [0.0; STATES];
        for FilteredRow { gains, level_by, kept } in &self.rows {
            for gain in gains {
                let innovation = column[gain.place] - dot(&gain.by, &x);
                white[gain.place] = innovation * gain.precision;
                x.iter_mut().zip(&gain.gain).for_each(|(x, gain)| *x += gain * innovation);
            }
            x = [dot(level_by, &x), kept[0] * x[1], kept[1] * x[2], 0.0];
        }
    }

    /// The place of each reading, and the share of its predicted variance that is its sensor's.
    pub fn shares(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.rows.iter().flat_map(|row| row.gains.iter().map(|gain| (gain.place, gain.share)))
    }
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Cholesky, DMatrix};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// Five operations with a reading of the land at the end, of force and, in some, of power.
    fn chain() -> Chain {
        let row = |i: usize| {
            let land = Reading { place: i, by: [1.02, 6.0 + i as f64, 2.0], deviation: 3.0 };
            let force = Reading { place: 5 + i, by: [0.004, 0.01, 0.9], deviation: 0.02 };
            let power = Reading { place: 10 + i, by: [0.004, 0.012, 1.0], deviation: 0.025 };
            let readings = if i.is_multiple_of(2) { vec![land, force, power] } else { vec![force, land] };
            Row { readings, level_by: [1.02, 6.0 + i as f64, 2.0], memory: 0.8 - 0.1 * i as f64, lot: 4 + i / 3 }
        };
        Chain { level: 2.5, rate: 0.1, lot: 0.03, piece: 0.02, rows: (0..5).map(row).collect() }
    }

    const PLACES: usize = 15;

    /// The covariance of the readings written out: every independent deviation with all that it moves.
    fn covariance(chain: &Chain) -> DMatrix<f64> {
        let mut covariance = DMatrix::zeros(PLACES, PLACES);
        // Level and rate at the start of row `first`, and the hardness of each row.
        let mut add = |first: usize, [level, rate]: [f64; 2], hardness: &dyn Fn(usize) -> f64| {
            let mut column = vec![0.0; PLACES];
            let (mut level, mut rate) = (level, rate);
            for (i, row) in chain.rows.iter().enumerate().skip(first) {
                let x = [level, rate, hardness(i)];
                row.readings.iter().for_each(|reading| column[reading.place] += dot(&reading.by, &x));
                (level, rate) = (dot(&row.level_by, &x), row.memory * rate);
            }
            let column = nalgebra::DVector::from_vec(column);
            covariance += &column * column.transpose();
        };
        add(0, [chain.level, 0.0], &|_| 0.0);
        for lot in [4, 5] {
            add(0, [0.0; 2], &|i| if chain.rows[i].lot == lot { chain.lot } else { 0.0 });
        }
        let mut fresh = 1.0;
        for (i, row) in chain.rows.iter().enumerate() {
            add(i, [0.0, chain.rate * f64::sqrt(fresh)], &|_| 0.0);
            add(i, [0.0; 2], &|row| if row == i { chain.piece } else { 0.0 });
            fresh = 1.0 - row.memory * row.memory;
        }
        for reading in chain.rows.iter().flat_map(|row| &row.readings) {
            covariance[(reading.place, reading.place)] += reading.deviation * reading.deviation;
        }
        covariance
    }

    /// Places that hold a reading.
    fn filled(chain: &Chain) -> Vec<usize> {
        chain.rows.iter().flat_map(|row| row.readings.iter().map(|reading| reading.place)).collect()
    }

    #[test]
    fn innovations_are_those_of_the_covariance_written_out() {
        let chain = chain();
        let places = filled(&chain);
        let whole = covariance(&chain);
        let covariance = DMatrix::from_fn(places.len(), places.len(), |i, j| whole[(places[i], places[j])]);
        let root = Cholesky::new(covariance).unwrap();
        let column: Vec<f64> = (0..PLACES).map(|i| (i as f64 * 0.7).sin()).collect();
        let right = nalgebra::DVector::from_fn(places.len(), |i, _| column[places[i]]);
        // In the order of processing the innovations are the column solved with the lower factor.
        let golden = root.l().solve_lower_triangular(&right).unwrap();
        let mut white = vec![0.0; PLACES];
        Filter::new(&chain).whiten(&column, &mut white);
        for (place, golden) in places.iter().zip(golden.iter()) {
            assert!((white[*place] - golden).abs() < 1e-10, "{} instead of {golden}", white[*place]);
        }
    }

    #[test]
    fn draws_have_the_covariance_written_out() {
        let chain = chain();
        let golden = covariance(&chain);
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let count = 20_000;
        let mut squares = DMatrix::<f64>::zeros(PLACES, PLACES);
        for _ in 0..count {
            let mut column = vec![0.0; PLACES];
            let lots: Vec<f64> = (0..6).map(|_| StandardNormal.sample(&mut random)).collect();
            chain.add_draw(&mut random, &lots, &mut column);
            let column = nalgebra::DVector::from_vec(column);
            squares += &column * column.transpose() / f64::from(count);
        }
        for reading in chain.rows.iter().flat_map(|row| &row.readings) {
            let place = reading.place;
            let drawn = squares[(place, place)] + reading.deviation * reading.deviation;
            // A lognormal rate of 10 % has a variance 2 % above the normal one; 20 000 draws are good to 1 %.
            assert!((drawn / golden[(place, place)] - 1.0).abs() < 0.05, "{place}: {drawn}");
        }
    }

    #[test]
    fn sensors_alone_give_readings_over_their_deviations() {
        let chain = Chain { level: 0.0, rate: 0.0, lot: 0.0, piece: 0.0, ..chain() };
        let filter = Filter::new(&chain);
        let mut white = vec![f64::NAN; PLACES];
        filter.whiten(&[6.0; PLACES], &mut white);
        assert_eq!((white[0], white[5]), (2.0, 300.0));
        assert!(white[11].is_nan(), "nothing was read there");
        assert!(filter.shares().all(|(_, share)| share == 1.0));
    }
}
