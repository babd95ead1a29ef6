//! A plan: settings for every section and what they come to.

use crate::{Constraint, ContourError, CornerMove, Evaluation, Planner, Setting, Warning};

/// One section of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedSection {
    /// Spindle speed and feed per tooth.
    pub setting: Setting,
    /// What they do.
    pub evaluation: Evaluation,
    /// Time of the section, s.
    pub time: f64,
    /// Share of an edge's life that it uses.
    pub life_fraction: f64,
    /// The constraint that refuses the next higher feed at this spindle speed; `None` where the
    /// objective or the candidates end there.
    pub active: Option<Constraint>,
}

/// Settings for every section, and time, cost and edge life that they come to.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Every section in the order of the contour.
    pub sections: Vec<PlannedSection>,
    /// Moves around corners.
    pub corners: Vec<CornerMove>,
    /// Time along the wall, s.
    pub cutting_time: f64,
    /// Time around corners, s.
    pub corner_time: f64,
    /// Time of changes of spindle speed, s.
    pub speed_change_time: f64,
    /// Time lost in ramps between feeds, s; 0 where ramps are not planned.
    pub ramp_time: f64,
    /// Sections before which, in the order of travel, the edge is changed.
    pub edge_changes: Vec<usize>,
    /// Time of those changes, s.
    pub edge_change_time: f64,
    /// Operative time: all of the above, s.
    pub time: f64,
    /// Cost of time and edges, in the currency of the economics.
    pub cost: f64,
    /// Edge lives used in cutting.
    pub life_fraction: f64,
    /// Edge lives thrown away with changed edges.
    pub wasted_life: f64,
    /// What should be known before the plan is used.
    pub warnings: Vec<Warning>,
}

impl Plan {
    /// Productivity gained against a baseline, `baseline.time/time − 1`.
    pub fn productivity_gain(&self, baseline: &Self) -> f64 {
        baseline.time / self.time - 1.0
    }

    /// Change of cost against a baseline, `cost/baseline.cost − 1`.
    pub fn cost_change(&self, baseline: &Self) -> f64 {
        self.cost / baseline.cost - 1.0
    }

    /// Share of the cost that edges make.
    pub fn edge_share(&self, planner: &Planner) -> f64 {
        (self.life_fraction + self.wasted_life) * planner.parameters.economics.edge_price() / self.cost
    }

    /// Constraints that are active somewhere, in the order of system (4).
    pub fn active(&self) -> Vec<Constraint> {
        let mut active: Vec<Constraint> = self.sections.iter().filter_map(|section| section.active).collect();
        active.sort();
        active.dedup();
        active
    }

    /// Number of changes of spindle speed.
    pub fn speed_changes(&self) -> usize {
        let changed = |pair: &&[PlannedSection]| pair[0].setting.spindle_speed != pair[1].setting.spindle_speed;
        self.sections.windows(2).filter(changed).count()
    }

    /// Greatest error of the wall over the sections, m, with its sign.
    pub fn greatest_wall_error(&self) -> f64 {
        let errors = self.sections.iter().map(|section| section.evaluation.wall_error());
        errors.fold(0.0, |worst: f64, error| if error.abs() > worst.abs() { error } else { worst })
    }
}

/// What a search adds to settings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Extras {
    pub ramp_time: f64,
    pub edge_changes: Vec<usize>,
    pub wasted_life: f64,
}

impl Planner<'_> {
    /// The plan with given settings, admissible or not.
    ///
    /// # Errors
    /// [`ContourError::SettingCount`] unless there is one setting for each section.
    pub fn plan(&self, settings: &[Setting]) -> Result<Plan, ContourError> {
        if settings.len() != self.len() {
            return Err(ContourError::SettingCount { settings: settings.len(), sections: self.len() });
        }
        Ok(self.assemble(settings, Extras::default()))
    }

    pub(crate) fn assemble(&self, settings: &[Setting], extras: Extras) -> Plan {
        let planned = settings.iter().enumerate().filter_map(|(i, setting)| {
            let evaluation = self.evaluate(i, *setting)?;
            let time = self.centre_length(i) / evaluation.feed;
            let active = self.refuses_more(i, *setting);
            Some(PlannedSection {
                setting: *setting,
                evaluation,
                time,
                life_fraction: time / evaluation.tool_life,
                active,
            })
        });
        let sections: Vec<PlannedSection> = planned.collect();
        let corners = self.corner_moves();
        let (machine, economics) = (&self.parameters.machine, &self.parameters.economics);
        let mut plan = Plan {
            cutting_time: sections.iter().map(|section| section.time).sum(),
            corner_time: corners.iter().map(|corner| corner.time).sum(),
            speed_change_time: 0.0,
            ramp_time: extras.ramp_time,
            edge_change_time: extras.edge_changes.len() as f64 * economics.edge_change_time,
            edge_changes: extras.edge_changes,
            time: 0.0,
            cost: 0.0,
            life_fraction: sections.iter().map(|section| section.life_fraction).sum(),
            wasted_life: extras.wasted_life,
            warnings: self.warnings(settings),
            sections,
            corners,
        };
        plan.speed_change_time = plan.speed_changes() as f64 * machine.speed_change_time;
        let moving = plan.cutting_time + plan.corner_time + plan.speed_change_time + plan.ramp_time;
        plan.time = moving + plan.edge_change_time;
        // The price of an edge contains the time of its change.
        plan.cost = economics.machine_rate * moving + (plan.life_fraction + plan.wasted_life) * economics.edge_price();
        plan
    }
}
