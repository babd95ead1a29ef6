//! Many readings of one edge, joined to blocks: the wear of a recorded shop is read after every pass.

use crate::base::Condition;
use crate::edge::{Block, Edge, Stretch};
use crate::loads::forget_unread;
use crate::treatment::Measured;
use toolroom_wear::Cut;

/// Readings of an edge beyond which neighbours are joined to a block, and blocks that an edge then has at least (assumption:
/// over a sixtieth of a life wear follows a parabola).
const MANY: usize = 120;
const BLOCKS: usize = 60;

impl Measured {
    /// Joins neighbouring readings of edges that have many.
    pub(crate) fn pack(&mut self) {
        let mut joined = 0;
        for place in 0..self.edges.len() {
            let count = self.edges[place].readings();
            if count <= MANY {
                continue;
            }
            joined += 1;
            self.pack_edge(place, count / BLOCKS);
        }
        if joined > 0 {
            self.notes.push(format!(
                "{joined} edges with more than {MANY} readings: neighbouring readings are taken together, {BLOCKS} to {} an edge",
                2 * BLOCKS
            ));
        }
    }

    fn pack_edge(&mut self, place: usize, size: usize) {
        let old = std::mem::take(&mut self.edges[place].stretches);
        let loads = std::mem::take(&mut self.loads[place]);
        let mut stretches = Vec::new();
        let mut means: [Vec<_>; 5] = Default::default();
        let mut from = 0;
        let mut read = 0;
        for end in 0..old.len() {
            read += usize::from(old[end].wear.is_some());
            // Edges of other groups wear at another rate, which no mean stands for.
            let group = |stretch: &Stretch| self.conditions[stretch.condition].group;
            let last = end + 1 == old.len() || group(&old[end + 1]) != group(&old[from]);
            if read < size && !last {
                continue;
            }
            let condition = self.mean_condition(&old[from..=end]);
            let whole: f64 = old[from..=end].iter().map(|stretch| stretch.time).sum();
            let load = loads.each_ref().map(|loads| mean_reading(loads.get(from..=end).unwrap_or(&[])));
            let mut push = |load: [Option<(Cut, f64)>; 5]| {
                means.iter_mut().zip(load).for_each(|(means, load)| means.push(load));
            };
            match block(&old[from..=end]) {
                Some((time, wear, block)) => {
                    stretches.push(Stretch { condition, time, wear: Some(wear), block: Some(block) });
                    push(load);
                    stretches.push(Stretch::unread(condition, (whole - time).max(0.0)));
                    push([None; 5]);
                }
                None => {
                    stretches.push(Stretch::unread(condition, whole));
                    push(load);
                }
            }
            (from, read) = (end + 1, 0);
        }
        self.edges[place] = Edge { stretches, ..self.edges[place].clone() };
        forget_unread(&mut means);
        self.loads[place] = means;
    }

    /// Index of the mean condition of some stretches over their time.
    fn mean_condition(&mut self, stretches: &[Stretch]) -> usize {
        let first = stretches[0].condition;
        if stretches.iter().all(|stretch| stretch.condition == first) {
            return first;
        }
        let total: f64 = stretches.iter().map(|stretch| stretch.time).sum();
        let begin = self.conditions[first];
        let mean = |i: usize| {
            // From the first, so that equal values stay what they are.
            let base = begin.quantities()[i];
            let off = stretches.iter().map(|stretch| {
                let share = if total > 0.0 { stretch.time / total } else { 1.0 / stretches.len() as f64 };
                share * (self.conditions[stretch.condition].quantities()[i] - base)
            });
            base + off.sum::<f64>()
        };
        let condition = Condition {
            cut: Cut::nominal(mean(0), mean(1), mean(2)),
            width: begin.width.map(|_| mean(3)),
            group: begin.group,
        };
        self.conditions.iter().position(|known| *known == condition).unwrap_or_else(|| {
            self.conditions.push(condition);
            self.conditions.len() - 1
        })
    }
}

/// Mean time from the beginning, mean wear and sums of the readings of some stretches; none without a reading.
fn block(stretches: &[Stretch]) -> Option<(f64, f64, Block)> {
    let mut passed = 0.0;
    let times = stretches.iter().filter_map(|stretch| {
        passed += stretch.time;
        Some((passed, stretch.wear?))
    });
    let read: Vec<(f64, f64)> = times.collect();
    let count = read.len() as f64;
    if read.is_empty() {
        return None;
    }
    let time = read.iter().map(|(time, _)| time).sum::<f64>() / count;
    let wear = read.iter().map(|(_, wear)| wear).sum::<f64>() / count;
    let sum = |of: &dyn Fn(f64, f64) -> f64| read.iter().map(|(t, w)| of(t - time, w - wear)).sum::<f64>();
    let block = Block { count, squares: sum(&|_, w| w * w), mixed: sum(&|t, w| t * w), times: sum(&|t, _| t * t) };
    Some((time, wear, block))
}

/// Mean of the readings of a channel, at the mean of their cuts.
fn mean_reading(readings: &[Option<(Cut, f64)>]) -> Option<(Cut, f64)> {
    let read: Vec<&(Cut, f64)> = readings.iter().flatten().collect();
    if read.is_empty() {
        return None;
    }
    let mean = |of: &dyn Fn(&(Cut, f64)) -> f64| read.iter().map(|one| of(one)).sum::<f64>() / read.len() as f64;
    let cut = Cut::nominal(
        mean(&|(cut, _)| cut.cutting_speed),
        mean(&|(cut, _)| cut.feed_per_rev),
        mean(&|(cut, _)| cut.depth_of_cut),
    );
    Some((cut, mean(&|(_, value)| *value)))
}
