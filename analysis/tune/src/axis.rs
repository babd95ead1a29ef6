//! Values of a setting that are tried.

use toolroom_scenario::{PolicyRule, Scenario, Setting, SpeedRule, ToolChangeRule, Tunable, Work};

/// Values of the setting of the speed on the first grid.
const SPEEDS: usize = 6;
/// Values of the setting of the tool change on the first grid.
const CHANGES: usize = 4;
/// Values on the first grid of a rule that has one setting alone.
const ALONE: usize = 12;
/// First grid of a speed or of a factor on it, over the present one: 15 % to 30 % to either side of it, a step of about
/// 10 % (assumption; the grid is extended where the best lies at its end).
const SPEED_SPAN: (f64, f64) = (0.8, 1.3);
/// First grid of the shadow price, over the time that a metre takes at the programmed speed: from little more than that
/// time, below which a metre is worth nothing, to what makes edges very dear (assumption).
const PRICE_SPAN: (f64, f64) = (1.15, 4.5);
/// First grid of a path, a time or a number of parts, over the present one (assumption).
const LIFE_SPAN: (f64, f64) = (0.6, 1.5);
/// First grid of the wear at which an edge is changed, over the tool's own limit, beyond which every edge is changed anyway
/// (assumption).
const LIMIT_SPAN: (f64, f64) = (0.5, 0.95);

/// What the first grid is laid around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reference {
    /// Cutting speed as programmed, m/s.
    pub speed: f64,
    /// Flank wear at which the tool itself is worn, m.
    pub wear_limit: f64,
    /// Time in cut of an edge without scatter at the programmed cut, s; `None` where it has no such life.
    pub life: Option<f64>,
}

impl Reference {
    /// Of the first pass that follows a commanded speed; `None` where there is none.
    pub fn of(scenario: &Scenario) -> Option<Self> {
        scenario.parts.iter().flat_map(|part| &part.operations).find_map(|operation| {
            let tool = &scenario.tools[operation.tool?];
            let Work::Cutting(cuts) = &operation.work else { return None };
            let cut = cuts.first().filter(|_| scenario.commands_speed_of(tool))?;
            let life = tool.process.nominal_life(cut);
            Some(Self { speed: cut.cutting_speed, wear_limit: tool.process.wear_limit(), life })
        })
    }
}

/// One setting, the values of it that are tried, and how far they may go.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub setting: Setting,
    /// In order, SI.
    pub values: Vec<f64>,
    /// Least and greatest value that may be tried.
    pub range: (f64, f64),
    /// Whether values lie evenly on the scale of ratios.
    ratios: bool,
}

impl Axis {
    /// The first grid of every setting of a rule.
    pub fn all(rule: &PolicyRule, reference: Reference) -> Vec<Self> {
        let settings = rule.settings();
        let alone = settings.len() == 1;
        settings.into_iter().map(|setting| Self::of(rule, setting, reference, alone)).collect()
    }

    fn of(rule: &PolicyRule, setting: Setting, reference: Reference, alone: bool) -> Self {
        let over = |present: f64, span: (f64, f64)| (present * span.0, present * span.1);
        let span = match (setting, rule.speed, rule.tool_change) {
            (Setting::CuttingSpeed, SpeedRule::Constant { cutting_speed: speed }, _) => over(speed, SPEED_SPAN),
            (Setting::CuttingSpeed, _, _) => over(reference.speed, SPEED_SPAN),
            (Setting::SpeedFactor, _, _) => over(rule.speed_factor, SPEED_SPAN),
            (Setting::Price, _, _) => over(reference.speed.recip(), PRICE_SPAN),
            (Setting::PathPerEdge, SpeedRule::SetIncrement { path_per_edge }, _) => over(path_per_edge, LIFE_SPAN),
            (Setting::WearLimit, _, _) => over(reference.wear_limit, LIMIT_SPAN),
            (Setting::CuttingTime, _, ToolChangeRule::CuttingTime { time }) => over(time, LIFE_SPAN),
            (Setting::Parts, _, ToolChangeRule::PartCount { parts }) => over(f64::from(parts), LIFE_SPAN),
            (Setting::PathPerEdge | Setting::CuttingTime | Setting::Parts, _, _) => {
                unreachable!("a rule has the settings that it names")
            }
        };
        let widest = match setting {
            Setting::WearLimit => (0.1 * reference.wear_limit, reference.wear_limit),
            Setting::Parts => (1.0, f64::INFINITY),
            // The best speed may be above the programmed one, and a metre then takes less time than it does there.
            Setting::Price => (0.2 * span.0, f64::INFINITY),
            Setting::CuttingSpeed | Setting::SpeedFactor | Setting::PathPerEdge | Setting::CuttingTime => {
                (0.2 * span.0, 5.0 * span.1)
            }
        };
        let given = if let Tunable::Free { ranges, .. } = &rule.tune {
            ranges.iter().find(|(other, _)| *other == setting).map(|(_, range)| *range)
        } else {
            None
        };
        let count = match (alone, setting.is_of_change()) {
            (true, _) => ALONE,
            (false, true) => CHANGES,
            (false, false) => SPEEDS,
        };
        let ratios = setting != Setting::WearLimit;
        let (low, high) = given.unwrap_or(span);
        let values = (0..count).map(|i| {
            let share = i as f64 / (count - 1) as f64;
            setting.rounded(if ratios { low * (high / low).powf(share) } else { low + (high - low) * share })
        });
        let mut axis = Self { setting, values: values.collect(), range: given.unwrap_or(widest), ratios };
        axis.values.dedup();
        axis
    }

    /// The next value below (`up` false) or above those there are; `None` at the end of what may be tried.
    pub fn beyond(&self, up: bool) -> Option<f64> {
        let (first, last) = (*self.values.first()?, *self.values.last()?);
        let steps = (self.values.len() - 1).max(1) as f64;
        let value = match (self.ratios, up) {
            (true, true) => last * (last / first).powf(steps.recip()),
            (true, false) => first / (last / first).powf(steps.recip()),
            (false, true) => last + (last - first) / steps,
            (false, false) => first - (last - first) / steps,
        };
        let value = self.setting.rounded(value.max(self.range.0).min(self.range.1));
        let new = if up { value > last * (1.0 + 1e-9) } else { value < first * (1.0 - 1e-9) };
        new.then_some(value)
    }

    /// Position of a value on the scale of steps.
    pub fn position(&self, value: f64) -> f64 {
        let scale = |value: f64| if self.ratios { value.ln() } else { value };
        let (first, last) = (self.values[0], self.values[self.values.len() - 1]);
        let steps = (self.values.len() - 1).max(1) as f64;
        let width = (scale(last) - scale(first)) / steps;
        if width > 0.0 { (scale(value) - scale(first)) / width } else { 0.0 }
    }

    /// The value at a position on that scale, within what may be tried.
    pub fn value(&self, position: f64) -> f64 {
        let (first, last) = (self.values[0], self.values[self.values.len() - 1]);
        let share = position / (self.values.len() - 1).max(1) as f64;
        let value = if self.ratios { first * (last / first).powf(share) } else { first + (last - first) * share };
        self.setting.rounded(value.max(self.range.0).min(self.range.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> Axis {
        let rule = PolicyRule::default();
        let reference = Reference { speed: 40.0 / 60.0, wear_limit: 0.6e-3, life: None };
        Axis::all(&rule, reference).remove(1)
    }

    #[test]
    fn a_grid_goes_on_by_its_own_step_up_to_what_may_be_tried() {
        let mut axis = axis();
        assert_eq!((axis.setting, axis.values.len()), (Setting::WearLimit, 4));
        assert!((axis.position(axis.values[2]) - 2.0).abs() < 0.02);
        let below = axis.beyond(false).expect("a value");
        assert!((below - 0.21e-3).abs() < 1e-9, "{below}");
        let above = axis.beyond(true).expect("a value");
        assert!((above - 0.6e-3).abs() < 1e-12, "{above}");
        axis.values.push(above);
        assert_eq!(axis.beyond(true), None, "an edge is worn there anyway");
    }

    #[test]
    fn a_price_may_belong_to_speeds_above_the_programmed_one() {
        let rule = PolicyRule { speed: SpeedRule::Productivity { price: None }, ..PolicyRule::default() };
        let axis = Axis::all(&rule, Reference { speed: 3.0, wear_limit: 0.3e-3, life: None }).remove(0);
        assert_eq!(axis.setting, Setting::Price);
        let below = axis.beyond(false).expect("the grid goes on");
        assert!(below < 1.0 / 3.0, "{below} s/m");
    }

    #[test]
    fn a_given_range_is_not_left() {
        let range = (0.3e-3, 0.5e-3);
        let tune = Tunable::Free { ranges: vec![(Setting::WearLimit, range)], change: false };
        let rule = PolicyRule { tune, ..PolicyRule::default() };
        let axis = Axis::all(&rule, Reference { speed: 1.0, wear_limit: 0.6e-3, life: None }).remove(1);
        assert!((axis.values[0] - range.0).abs() < 1e-12 && (axis.values[3] - range.1).abs() < 1e-12);
        assert_eq!((axis.beyond(true), axis.beyond(false)), (None, None));
        assert!(axis.value(9.0) <= range.1 * (1.0 + 1e-12));
    }
}
