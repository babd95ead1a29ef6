//! What the search for the best settings of one rule has found.

use super::field::Field;
use super::outlook::Outlook;
use super::trial::{Point, Run};
use super::{Excluded, SettingsMap, ToolChangeTried, TunedPolicy, TunedSetting, given};
use toolroom_process::unit::convert;
use toolroom_statistics::Moments;

impl Field<'_> {
    /// An objective of the search as files have it.
    fn in_file(&self, objective: f64) -> f64 {
        self.search.sign * self.search.scale * objective
    }

    /// What was found.
    pub fn told(&self) -> TunedPolicy {
        let request = self.search.request;
        let outlook = self.outlook();
        let estimated = &outlook.estimates.means;
        let Some(best) = self.known().first().copied() else {
            let failure = request
                .failure
                .map_or_else(String::new, |failure| format!(", or more than {} % are lost in cut", 100.0 * failure));
            let reason = format!(
                "at every setting that was tried the guard is broken: more than {} % of edges collapse{failure}",
                100.0 * request.collapse
            );
            let excluded = self.excluded(&outlook, f64::INFINITY, 0.0);
            return TunedPolicy { evaluations: self.runs_spent, excluded, ..given(&self.rule.name, reason) };
        };
        let least = estimated[best];
        let place = best;
        let best = &self.points[best];
        let flat = |index: &usize| {
            let point = &self.points[*index];
            point.runs.len() >= 2 * self.first()
                && outlook.admissible[*index]
                && estimated[*index] - least <= request.indifference * least.abs()
        };
        let flat: Vec<&Point> = (0..self.points.len()).filter(flat).map(|index| &self.points[index]).collect();
        let settings = self.axes.iter().enumerate().map(|(number, axis)| {
            let value = best.values[number];
            let spread_of = |points: &mut dyn Iterator<Item = &Point>| {
                let values: Vec<f64> = points.map(|point| point.values[number]).collect();
                (values.iter().copied().fold(value, f64::min), values.iter().copied().fold(value, f64::max))
            };
            let (lowest, greatest) = spread_of(&mut self.points.iter());
            let (low, high) = spread_of(&mut flat.iter().copied());
            TunedSetting {
                key: axis.setting.key().to_owned(),
                value: axis.setting.shown(value),
                flat: (axis.setting.shown(low), axis.setting.shown(high)),
                border: value <= lowest || value >= greatest,
            }
        });
        let moments: Moments = best.runs.iter().map(|run| run.objective).collect();
        TunedPolicy {
            name: self.rule.name.clone(),
            settings: settings.collect(),
            given: None,
            changes: self.changes(best),
            evaluations: self.runs_spent,
            objective: Some(self.in_file(moments.mean())),
            standard_error: Some(self.search.scale * moments.standard_error()),
            collapsed: Some(best.share(|run: &Run| run.collapsed)),
            failed: Some(best.share(|run: &Run| run.failed)),
            excluded: self.excluded(&outlook, least, moments.mean() - least),
            tool_changes: Vec::new(),
            map: self.map(&outlook, place),
        }
    }

    /// Changes of the scenario file that give the policy these settings.
    fn changes(&self, point: &Point) -> Vec<String> {
        self.axes.iter().zip(&point.values).map(|(axis, value)| self.rule.override_of(axis.setting, *value)).collect()
    }

    /// The best settings among those that the guard excludes, where their estimate is below `least`; `shift` leads from an
    /// estimate to a mean of the replications that are reported.
    fn excluded(&self, outlook: &Outlook, least: f64, shift: f64) -> Option<Excluded> {
        let estimated = &outlook.estimates.means;
        let excluded = |index: &usize| !outlook.admissible[*index] && estimated[*index] < least;
        let cheapest = (0..self.points.len()).filter(excluded).min_by(|a, b| estimated[*a].total_cmp(&estimated[*b]));
        let cheapest = cheapest.filter(|index| estimated[*index].is_finite())?;
        let point = &self.points[cheapest];
        Some(Excluded {
            settings: self.shown(&point.values),
            changes: self.changes(point),
            objective: self.in_file(estimated[cheapest] + shift),
        })
    }

    /// The best settings with this rule of tool change, for people.
    pub fn tried(&self) -> ToolChangeTried {
        let best = self.known().first().copied();
        ToolChangeTried {
            rule: self.rule.tool_change.word().to_owned(),
            settings: best.map_or_else(String::new, |best| self.shown(&self.points[best].values)),
            objective: best.map(|best| self.in_file(self.outlook().estimates.means[best])),
        }
    }

    /// Estimates on the grid, with the settings that were chosen.
    fn map(&self, outlook: &Outlook, chosen: usize) -> Option<SettingsMap> {
        let [first, second] = self.axes.as_slice() else { return None };
        let estimated = &outlook.estimates.means;
        let axes = [first, second];
        let told = |number: usize, value: f64| {
            let (unit, display) = axes[number].setting.units();
            convert(value, unit, display)
        };
        let pairs: Vec<[f64; 2]> =
            second.values.iter().flat_map(|y| first.values.iter().map(move |x| [*x, *y])).collect();
        let tried = |pair: &[f64; 2]| self.points.iter().position(|point| point.values == *pair);
        let estimate = |pair: &[f64; 2]| {
            tried(pair).map(|index| estimated[index]).filter(|value| value.is_finite()).map(|value| self.in_file(value))
        };
        let barred = |pair: &[f64; 2]| tried(pair).is_some_and(|index| !outlook.admissible[index]);
        let values = |number: usize| axes[number].values.iter().map(|value| told(number, *value)).collect();
        Some(SettingsMap {
            settings: axes.map(|axis| (axis.setting.key().to_owned(), axis.setting.units().1.to_owned())),
            values: [values(0), values(1)],
            objective: pairs.iter().map(estimate).collect(),
            excluded: pairs.iter().map(barred).collect(),
            chosen: [0, 1].map(|number| told(number, self.points[chosen].values[number])),
        })
    }
}
