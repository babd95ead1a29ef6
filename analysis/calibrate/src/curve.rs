//! The wear curve of one condition: flank wear over cutting time, and back.

use std::sync::Arc;

/// Cells of the table. The cumulative rule is of fourth order on a grid that is fine where the edge is new, which leaves
/// relative errors below 1e-6 of the time for the laws of this project.
const CELLS: usize = 128;
/// Cells that are walked through before the whole table is searched.
const NEAR: usize = 8;

/// Flank wear over cutting time at constant conditions, tabulated as `t(h) = ∫ dh / rate(h)` on a grid with `h ∝ k²`.
///
/// Curves that differ by a factor on the rate share a table.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    table: Arc<Table>,
    /// How much faster than in the table the edge wears.
    pace: f64,
}

/// The table of a curve.
#[derive(Debug, Default)]
struct Table {
    /// Flank wear of the nodes, mm.
    wear: Vec<f64>,
    /// Time of the nodes, min.
    time: Vec<f64>,
    /// Rate at the nodes, mm/min.
    rate: Vec<f64>,
    greatest: f64,
}

impl Curve {
    /// The curve up to the flank wear `greatest` in mm, of a wear rate in mm/min.
    ///
    /// # Examples
    /// ```
    /// let curve = toolroom_calibrate::Curve::new(0.6, |wear| 0.01 * (1.0 + wear));
    /// let time = (1.3_f64).ln() / 0.01;
    /// assert!((curve.time(0.3) / time - 1.0).abs() < 1e-6);
    /// assert!((curve.wear(time, &mut 0).0 / 0.3 - 1.0).abs() < 1e-6);
    /// ```
    pub fn new(greatest: f64, rate: impl Fn(f64) -> f64) -> Self {
        Self::bent(greatest, greatest, rate)
    }

    /// The same of a rate that bends at the flank wear `bend` in mm, as that of a wear curve with stages does at the wear
    /// limit. A node lies there and no rule reaches across it; the table ends a little beyond `greatest`.
    pub fn bent(greatest: f64, bend: f64, rate: impl Fn(f64) -> f64) -> Self {
        let cells = CELLS as f64;
        let node = ((bend / greatest).sqrt() * cells).floor().clamp(1.0, cells);
        let greatest = if bend < greatest { bend * (cells / node).powi(2) } else { greatest };
        let bend = if bend < greatest { node as usize } else { CELLS };
        let step = greatest / (CELLS * CELLS) as f64;
        let wear: Vec<f64> = (0..=CELLS).map(|k| step * (k * k) as f64).collect();
        let rate: Vec<f64> = wear.iter().map(|wear| rate(*wear)).collect();
        // dt/dk, odd in k.
        let pace: Vec<f64> = rate.iter().enumerate().map(|(k, rate)| 2.0 * step * k as f64 / rate).collect();
        let mut time = vec![0.0; CELLS + 1];
        for k in 0..CELLS {
            let before = if k == 0 { -pace[1] } else { pace[k - 1] };
            let area = if k + 1 == bend || k + 1 == CELLS {
                (5.0 * pace[k + 1] + 8.0 * pace[k] - before) / 12.0
            } else if k == bend {
                (5.0 * pace[k] + 8.0 * pace[k + 1] - pace[k + 2]) / 12.0
            } else {
                (13.0 * (pace[k] + pace[k + 1]) - before - pace[k + 2]) / 24.0
            };
            // A rate that changes abruptly must not make time run backwards.
            time[k + 1] = time[k] + if area > 0.0 { area } else { 0.5 * (pace[k] + pace[k + 1]) };
        }
        Self { table: Arc::new(Table { wear, time, rate, greatest }), pace: 1.0 }
    }

    /// The curve of an edge that wears `factor` times as fast at every land.
    pub fn faster(&self, factor: f64) -> Self {
        Self { table: Arc::clone(&self.table), pace: self.pace * factor }
    }

    /// How many times as long as on `other` the same wear takes, where both share a table.
    pub fn slower_than(&self, other: &Self) -> Option<f64> {
        Arc::ptr_eq(&self.table, &other.table).then(|| other.pace / self.pace)
    }

    /// Flank wear in mm and its rate in mm/min after a cutting time in min. Beyond the table the edge wears on at the
    /// last rate. `cell` is where the search begins and where it ended: times of an edge rise.
    pub fn wear(&self, time: f64, cell: &mut usize) -> (f64, f64) {
        let (wear, rate) = self.table.wear(time * self.pace, cell);
        (wear, rate * self.pace)
    }

    /// Cutting time in min until a flank wear in mm.
    pub fn time(&self, wear: f64) -> f64 {
        self.table.place(wear).0 / self.pace
    }

    /// Cutting time in min until a flank wear in mm, the rate there in mm/min, and the cell from which [`Curve::wear`]
    /// searches on.
    pub(crate) fn place(&self, wear: f64) -> (f64, f64, usize) {
        let (time, rate, cell) = self.table.place(wear);
        (time / self.pace, rate * self.pace, cell)
    }
}

impl Table {
    fn wear(&self, time: f64, cell: &mut usize) -> (f64, f64) {
        if time <= 0.0 || time.is_nan() {
            return (0.0, self.rate[0]);
        }
        let last = CELLS;
        if time >= self.time[last] {
            return (self.greatest + (time - self.time[last]) * self.rate[last], self.rate[last]);
        }
        let times = &self.time[..=last];
        let mut place = (*cell).min(last - 1);
        if times[place] > time || times[(place + NEAR).min(last)] <= time {
            place = times.partition_point(|node| *node <= time) - 1;
        }
        while times[place + 1] <= time {
            place += 1;
        }
        *cell = place;
        let cell = place;
        let width = self.time[cell + 1] - self.time[cell];
        let x = (time - self.time[cell]) / width;
        let rise = self.wear[cell + 1] - self.wear[cell];
        let (first, second) = (self.rate[cell] * width, self.rate[cell + 1] * width);
        // Cubic with the slopes of both ends.
        let (c, d) = (3.0 * rise - 2.0 * first - second, first + second - 2.0 * rise);
        (self.wear[cell] + x * (first + x * (c + x * d)), (first + x * (2.0 * c + 3.0 * x * d)) / width)
    }

    /// Time, rate and cell of a flank wear.
    fn place(&self, wear: f64) -> (f64, f64, usize) {
        let last = CELLS;
        if wear <= 0.0 {
            return (0.0, self.rate[0], 0);
        }
        if wear >= self.greatest {
            return (self.time[last] + (wear - self.greatest) / self.rate[last], self.rate[last], last - 1);
        }
        let k = ((wear / self.greatest).sqrt() * CELLS as f64) as usize;
        let cell = k.min(CELLS - 1);
        let width = self.wear[cell + 1] - self.wear[cell];
        let x = (wear - self.wear[cell]) / width;
        let rise = self.time[cell + 1] - self.time[cell];
        let (first, second) = (width / self.rate[cell], width / self.rate[cell + 1]);
        let (c, d) = (3.0 * rise - 2.0 * first - second, first + second - 2.0 * rise);
        let time = self.time[cell] + x * (first + x * (c + x * d));
        (time, width / (first + x * (2.0 * c + 3.0 * x * d)), cell)
    }
}
