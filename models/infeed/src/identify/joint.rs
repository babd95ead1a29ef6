//! Stiffnesses and, where the data tell them, threshold force and force exponent, from all trials together.

use super::{Estimate, MeasurementErrors};
use crate::Trial;
use crate::law::{REFERENCE_DEPTH, chip, share_out};

/// What all trials say together: one machine and one process fitted to every stock and every force.
///
/// Each trial is run through the recursion `J (u − r − h) = F0 + Cp h0 (h/h0)^m`, `h0 = 1 um`, with the wheel as it is;
/// the squares of what is left, over the errors of the measurement, are least. Threshold force and exponent are only
/// fitted where forces at three depths at least can tell them, and only kept where the fit gains more by them than
/// chance gives in one of a hundred cases.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Process stiffness Cp, N/m; with an exponent other than 1 at a depth of 1 um.
    pub process_stiffness: Estimate,
    /// System stiffness J, N/m.
    pub system_stiffness: Estimate,
    /// Threshold force F0, N; none where the data do not ask for one.
    pub threshold_force: Option<Estimate>,
    /// Force exponent m; none where the data do not ask for one other than 1.
    pub force_exponent: Option<Estimate>,
    /// Sum of squares of what is left over the errors, a degree of freedom; near 1 where the errors are right.
    pub misfit: f64,
    /// Readings that were fitted.
    pub readings: usize,
}

/// Numbers of the fit: ln Cp, ln J, F0, m.
type Numbers = [f64; 4];

/// Quantile of chi² with one degree of freedom at 99 %: what a number more must gain.
const GAIN: f64 = 6.635;
/// Ratio of depths that count as different (assumption).
const APART: f64 = 1.2;
/// Ranges of threshold force (N) and exponent.
const BOUNDS: [[f64; 2]; 2] = [[0.0, 1e4], [0.3, 1.0]];

/// Depth, stock and force at the end of a revolution.
#[derive(Clone, Copy, Default)]
struct Turn {
    depth: f64,
    stock: f64,
    force: f64,
}

/// A trial, revolution by revolution, from rest.
fn course([process, system, threshold, exponent]: Numbers, trial: &Trial) -> Vec<Turn> {
    let (process, system) = (process.exp(), system.exp());
    let last = (trial.revolutions + trial.finish_revolutions + trial.spark_out_revolutions).ceil().min(1e5) as u32;
    let mut turns = vec![Turn::default()];
    let mut stock = 0.0;
    for revolution in 1..=last {
        let beyond = (f64::from(revolution) - trial.revolutions).clamp(0.0, trial.finish_revolutions);
        let commanded =
            trial.infeed_per_rev * f64::from(revolution).min(trial.revolutions) + trial.finish_infeed_per_rev * beyond;
        let engagement = (commanded - stock - threshold / system).max(0.0);
        let (depth, _) = share_out(engagement, process / system, 0.0, exponent, REFERENCE_DEPTH);
        let pressed = system * (commanded - stock);
        stock += depth;
        let force = if depth > 0.0 { threshold + process * chip(depth, exponent, REFERENCE_DEPTH) } else { pressed };
        turns.push(Turn { depth, stock, force });
    }
    turns
}

/// A turn between two ends of revolutions.
fn at(turns: &[Turn], revolution: f64) -> Turn {
    let before = (revolution.floor() as usize).min(turns.len() - 1);
    let after = (before + 1).min(turns.len() - 1);
    let share = revolution - revolution.floor();
    let between = |of: fn(&Turn) -> f64| of(&turns[before]) + share * (of(&turns[after]) - of(&turns[before]));
    Turn { depth: between(|turn| turn.depth), stock: between(|turn| turn.stock), force: between(|turn| turn.force) }
}

/// What is left of every reading over its error, and the depths at which forces were read.
fn residuals(numbers: Numbers, trials: &[Trial], errors: &MeasurementErrors) -> (Vec<f64>, Vec<f64>) {
    let (mut left, mut depths) = (Vec::new(), Vec::new());
    for trial in trials {
        let turns = course(numbers, trial);
        let steady = at(&turns, trial.revolutions);
        let end = at(&turns, trial.revolutions + trial.finish_revolutions + trial.spark_out_revolutions);
        let infeed_error = errors.infeed_per_rev / trial.infeed_per_rev;
        if let Some(stock) = trial.stock_removed {
            // A revolution more or less costs the last depth of stock.
            let sd = errors.stock.hypot(stock * infeed_error).hypot(end.depth * errors.revolutions);
            left.push((stock - end.stock) / sd.max(f64::MIN_POSITIVE));
        }
        let mut force = |read: Option<f64>, turn: Turn| {
            if let Some(read) = read {
                let sd = errors.force.hypot(read * infeed_error);
                left.push((read - turn.force) / sd.max(f64::MIN_POSITIVE));
                depths.push(turn.depth);
            }
        };
        force(trial.normal_force, steady);
        if trial.spark_out_revolutions > 0.0 {
            force(trial.force_after_spark_out, end);
        }
    }
    (left, depths)
}

/// Solves `matrix x = right` by elimination; none where it is singular.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    for column in 0..n {
        let pivot = (column..n).max_by(|a, b| matrix[*a][column].abs().total_cmp(&matrix[*b][column].abs()))?;
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let head = matrix[column].clone();
        if head[column].abs() <= f64::MIN_POSITIVE || !head[column].is_finite() {
            return None;
        }
        for row in 0..n {
            if row != column {
                let factor = matrix[row][column] / head[column];
                matrix[row].iter_mut().zip(&head).for_each(|(value, above)| *value -= factor * above);
                right[row] -= factor * right[column];
            }
        }
    }
    Some((0..n).map(|i| right[i] / matrix[i][i]).collect())
}

/// A fit of some of the numbers.
#[derive(Clone)]
struct Fit {
    numbers: Numbers,
    free: Vec<usize>,
    squares: f64,
    /// Variances of the free numbers by the errors of the measurement.
    variances: Vec<f64>,
    readings: usize,
}

impl Fit {
    /// Damped least squares over the `free` numbers from a start.
    fn of(start: Numbers, free: &[usize], trials: &[Trial], errors: &MeasurementErrors) -> Option<Self> {
        const STEPS: Numbers = [1e-5, 1e-5, 1e-3, 1e-5];
        let squares =
            |numbers: Numbers| residuals(numbers, trials, errors).0.iter().map(|each| each * each).sum::<f64>();
        let mut numbers = start;
        let (mut best, mut damping) = (squares(numbers), 1e-3);
        let mut normal = Vec::new();
        for _ in 0..100 {
            let (left, _) = residuals(numbers, trials, errors);
            let slopes: Vec<Vec<f64>> = free
                .iter()
                .map(|&k| {
                    let mut moved = numbers;
                    // Away from the upper bound of the exponent.
                    let step = if k == 3 { -STEPS[k] } else { STEPS[k] };
                    moved[k] += step;
                    let (other, _) = residuals(moved, trials, errors);
                    other.iter().zip(&left).map(|(other, left)| (other - left) / step).collect()
                })
                .collect();
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            normal = slopes.iter().map(|a| slopes.iter().map(|b| dot(a, b)).collect::<Vec<f64>>()).collect();
            let right: Vec<f64> = slopes.iter().map(|slope| -dot(slope, &left)).collect();
            let mut damped = normal.clone();
            damped.iter_mut().enumerate().for_each(|(i, row)| row[i] *= 1.0 + damping);
            let step = solved(damped, right)?;
            let mut tried = numbers;
            for (&k, step) in free.iter().zip(&step) {
                tried[k] += step;
                if k >= 2 {
                    tried[k] = tried[k].clamp(BOUNDS[k - 2][0], BOUNDS[k - 2][1]);
                }
            }
            let found = squares(tried);
            if found.is_finite() && found <= best {
                let gained = best - found;
                (numbers, best, damping) = (tried, found, damping * 0.3);
                if gained <= 1e-10 * (1.0 + best) {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e12 {
                    break;
                }
            }
        }
        let unit = |k: usize| (0..free.len()).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
        let variances: Option<Vec<f64>> =
            (0..free.len()).map(|k| solved(normal.clone(), unit(k)).map(|column| column[k])).collect();
        let readings = residuals(numbers, trials, errors).0.len();
        let variances = variances?;
        let determined =
            readings > free.len() && variances.iter().all(|variance| *variance > 0.0 && variance.is_finite());
        determined.then(|| Self { numbers, free: free.to_vec(), squares: best, variances, readings })
    }

    /// Sum of squares a degree of freedom.
    fn misfit(&self) -> f64 {
        self.squares / (self.readings - self.free.len()) as f64
    }

    /// Whether this fit gains more over `plain` than chance gives.
    fn beats(&self, plain: &Self) -> bool {
        let more = (self.free.len() - plain.free.len()) as f64;
        plain.squares - self.squares > GAIN * more * self.misfit().max(1.0)
    }

    /// Number `k` with its standard deviation, where it is free.
    fn estimate(&self, k: usize) -> Option<Estimate> {
        let place = self.free.iter().position(|free| *free == k)?;
        // Where the errors are greater than they are said to be, the fit tells by how much.
        let sd = (self.variances[place] * self.misfit().max(1.0)).sqrt();
        Some(if k < 2 {
            let value = self.numbers[k].exp();
            Estimate { value, sd: value * sd }
        } else {
            Estimate { value: self.numbers[k], sd }
        })
    }
}

/// Fits all possible trials from stiffnesses that are about right (N/m); none where they do not tell both.
pub(super) fn joint(trials: &[Trial], stiffnesses: [f64; 2], errors: &MeasurementErrors) -> Option<Joint> {
    let start = [stiffnesses[0].ln(), stiffnesses[1].ln(), 0.0, 1.0];
    if !start.iter().all(|number| number.is_finite()) {
        return None;
    }
    let plain = Fit::of(start, &[0, 1], trials, errors)?;
    let (_, mut depths) = residuals(plain.numbers, trials, errors);
    depths.sort_by(f64::total_cmp);
    let mut apart = Vec::new();
    for depth in depths {
        if apart.last().is_none_or(|last| depth > APART * last) {
            apart.push(depth);
        }
    }
    let mut best = plain.clone();
    if apart.len() >= 3 {
        let begun = Numbers::from([plain.numbers[0], plain.numbers[1], 1.0, 0.95]);
        let with = |free: &[usize]| {
            let mut start = begun;
            if !free.contains(&2) {
                start[2] = 0.0;
            }
            if !free.contains(&3) {
                start[3] = 1.0;
            }
            Fit::of(start, free, trials, errors)
        };
        let singles = [with(&[0, 1, 2]), with(&[0, 1, 3])];
        let single = singles.into_iter().flatten().min_by(|a, b| a.squares.total_cmp(&b.squares));
        best = single.filter(|single| single.beats(&plain)).unwrap_or(plain);
        // Two numbers more are told apart by four depths at least.
        let both = if apart.len() >= 4 { with(&[0, 1, 2, 3]) } else { None };
        best = both.filter(|both| both.beats(&best)).unwrap_or(best);
    }
    Some(Joint {
        process_stiffness: best.estimate(0)?,
        system_stiffness: best.estimate(1)?,
        threshold_force: best.estimate(2),
        force_exponent: best.estimate(3),
        misfit: best.misfit(),
        readings: best.readings,
    })
}
