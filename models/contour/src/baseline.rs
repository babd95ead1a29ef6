//! Regimes that a plan is compared with.

use crate::constraint::FEASIBILITY;
use crate::plan::Extras;
use crate::{Constraint, ContourError, Objective, Plan, Planner, Setting};
use std::f64::consts::PI;

/// Steps of the feed override: 100 % down to 10 %.
const OVERRIDE_STEPS: u32 = 10;

impl Planner<'_> {
    /// The handbook regime: table feed, the gear below the handbook speed for the nominal life
    /// at the nominal allowance, one feed for the whole contour, the feed override lowered in
    /// steps of 10 % until every section passes. Where the life alone is too short, the next
    /// lower gear instead.
    ///
    /// # Errors
    /// [`ContourError::NoHandbookRegime`] where no override helps.
    pub fn handbook(&self) -> Result<Plan, ContourError> {
        let mut gear = self.handbook_gear();
        let mut step = 0;
        loop {
            let setting = self.overridden(gear, step);
            let settings = vec![setting; self.len()];
            let violated = self.violated(&settings);
            if violated.is_empty() {
                return Ok(self.assemble(&settings, Extras::default()));
            }
            if violated == [Constraint::ToolLife] && gear > 0 {
                gear -= 1;
            } else if step + 1 < OVERRIDE_STEPS {
                step += 1;
            } else {
                return Err(ContourError::NoHandbookRegime { violated });
            }
        }
    }

    /// The handbook regime with an override for every section.
    ///
    /// # Errors
    /// [`ContourError::NoHandbookRegime`] for the first section on which no override helps.
    pub fn handbook_by_section(&self) -> Result<Plan, ContourError> {
        let gear = self.handbook_gear();
        let mut settings = Vec::with_capacity(self.len());
        for i in 0..self.len() {
            let admitted = |setting: &Setting| self.evaluate(i, *setting).is_some_and(|at| at.ratios.admissible());
            let Some(setting) = (0..OVERRIDE_STEPS).map(|step| self.overridden(gear, step)).find(admitted) else {
                let slowest = self.evaluate(i, self.overridden(gear, OVERRIDE_STEPS - 1));
                let violated = slowest.into_iter().flat_map(|at| at.ratios.violated().collect::<Vec<_>>()).collect();
                return Err(ContourError::NoHandbookRegime { violated });
            };
            settings.push(setting);
        }
        Ok(self.assemble(&settings, Extras::default()))
    }

    /// The best single spindle speed and feed for the whole contour.
    ///
    /// # Errors
    /// [`ContourError::NoCommonSetting`] where none suits every section.
    pub fn best_constant(&self, objective: Objective) -> Result<Plan, ContourError> {
        let weights = objective.weights(self);
        let mut lengths = vec![0.0; self.wall_count()];
        for i in 0..self.len() {
            lengths[self.wall_of(i)] += self.centre_length(i);
        }
        let mut best: Option<(f64, Setting)> = None;
        for gear in 0..self.speeds.len() {
            for feed in 0..self.feeds.len() {
                let mut total = Some(0.0);
                for (wall, length) in lengths.iter().enumerate() {
                    let Some(candidate) = self.rates(wall, gear, feed) else {
                        total = None;
                        break;
                    };
                    total = total.map(|value| value + weights.value(&candidate) * length);
                }
                if let Some(value) = total
                    && best.is_none_or(|(least, _)| value < least)
                {
                    best = Some((value, self.setting(gear, feed)));
                }
            }
        }
        let (_, setting) = best.ok_or_else(|| self.no_common_setting())?;
        Ok(self.assemble(&vec![setting; self.len()], Extras::default()))
    }

    /// The fastest gear not above the handbook speed, or the slowest one.
    fn handbook_gear(&self) -> usize {
        let (life, cutter, pass) = (&self.parameters.life, &self.parameters.cutter, self.pass);
        let speed = life.speed_for(
            life.nominal_life,
            pass.table_feed,
            pass.allowance,
            pass.depth_of_cut,
            cutter.teeth,
            cutter.diameter,
        );
        let spindle_speed = speed / (PI * cutter.diameter) * 2.0 * PI;
        self.speeds.iter().rposition(|gear| *gear <= spindle_speed * FEASIBILITY).unwrap_or(0)
    }

    fn overridden(&self, gear: usize, step: u32) -> Setting {
        let share = 1.0 - f64::from(step) / f64::from(OVERRIDE_STEPS);
        Setting { spindle_speed: self.speeds[gear], feed_per_tooth: self.pass.table_feed * share }
    }
}
