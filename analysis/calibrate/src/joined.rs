//! Neighbouring conditions of recorded shops, joined: each condition costs a wear curve.

use crate::base::Condition;
use crate::edge::Life;
use crate::treatment::Measured;
use std::collections::BTreeMap;
use toolroom_wear::Cut;

/// Conditions beyond which neighbours are joined (assumption): designed tests have fewer, recorded shops a new one with every
/// pass.
const MANY: usize = 24;
/// Ratio of the greatest to the least speed, feed, depth and width of joined conditions (assumption): at exponents of 5, 1.5 and 0.75
/// the rate of a pass then differs by at most 4 % from that of its condition, either way, which evens out over an edge.
const JOINED: [f64; 4] = [1.015, 1.05, 1.10, 1.10];

impl Measured {
    /// Joins neighbouring conditions where there are many, each class at its mean over cutting time.
    pub(crate) fn join(&mut self) {
        if self.conditions.len() <= MANY {
            return;
        }
        let quantities = Condition::quantities;
        let least = self.conditions.iter().map(quantities).reduce(|a, b| [0, 1, 2, 3].map(|i| a[i].min(b[i])));
        let most = self.conditions.iter().map(quantities).reduce(|a, b| [0, 1, 2, 3].map(|i| a[i].max(b[i])));
        let (Some(least), Some(most)) = (least, most) else { return };
        // Classes of equal ratio between the least and the greatest value.
        let class = |condition: &Condition| {
            let values = quantities(condition);
            [0, 1, 2, 3].map(|i| {
                let whole = (most[i] / least[i]).ln();
                let classes = (whole / JOINED[i].ln()).ceil().max(1.0);
                let place = if whole > 0.0 { (values[i] / least[i]).ln() / whole * classes } else { 0.0 };
                place.min(classes - 1.0) as usize
            })
        };
        let mut time = vec![0.0; self.conditions.len()];
        for edge in &self.edges {
            edge.stretches.iter().for_each(|stretch| time[stretch.condition] += stretch.time);
            if let Some((condition, Life::Exact(life) | Life::Censored(life) | Life::Between(_, life))) = edge.life {
                time[condition] += life;
            }
        }
        let mut classes: BTreeMap<(usize, [usize; 4]), Vec<usize>> = BTreeMap::new();
        for (index, condition) in self.conditions.iter().enumerate() {
            classes.entry((condition.group, class(condition))).or_default().push(index);
        }
        let mut joined = vec![0; self.conditions.len()];
        let mut conditions = Vec::new();
        for members in classes.into_values() {
            let total: f64 = members.iter().map(|member| time[*member]).sum();
            let weight = |member: usize| if total > 0.0 { time[member] / total } else { 1.0 / members.len() as f64 };
            let mean = |i: usize| {
                // From the first, so that equal values stay what they are.
                let first = quantities(&self.conditions[members[0]])[i];
                let off =
                    members.iter().map(|member| weight(*member) * (quantities(&self.conditions[*member])[i] - first));
                first + off.sum::<f64>()
            };
            members.iter().for_each(|member| joined[*member] = conditions.len());
            let first = &self.conditions[members[0]];
            conditions.push(Condition {
                cut: Cut::nominal(mean(0), mean(1), mean(2)),
                width: first.width.map(|_| mean(3)),
                group: first.group,
            });
        }
        for edge in &mut self.edges {
            edge.stretches.iter_mut().for_each(|stretch| stretch.condition = joined[stretch.condition]);
            if let Some((condition, _)) = &mut edge.life {
                *condition = joined[*condition];
            }
        }
        let (before, after) = (self.conditions.len(), conditions.len());
        self.notes.push(format!("{before} conditions were joined to {after}: neighbours wear at their mean"));
        self.conditions = conditions;
    }
}
