//! Contours: spindle speed and feed for every section, planned once for machine and tool.

use crate::{ContourRule, ContourWork, MachineType, ProcessModel, ToolType};
use std::f64::consts::PI;
use toolroom_contour::{
    ContourError, CornerPolicy, Economics, Engagement, Machine, Milling, Objective, Parameters, Planner, Shape,
    corner_undershoot,
};

/// Why a contour cannot be planned for a tool.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The planner refuses.
    #[error("pass \"{pass}\" of {file}: {source}")]
    Contour {
        /// Contour file as written in the scenario.
        file: String,
        /// Pass.
        pass: String,
        /// Why.
        source: Box<ContourError>,
    },
    /// A contour planned for another cutter than the tool.
    #[error("{file} is planned for a cutter with {quantity} {planned}, the tool has {tool}")]
    Cutter {
        /// Contour file as written in the scenario.
        file: String,
        /// What differs, with its unit.
        quantity: &'static str,
        /// In the contour file.
        planned: f64,
        /// Of the tool.
        tool: f64,
    },
}

/// A section as it is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourSection {
    /// Shape of the wall.
    pub shape: Shape,
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Feed per tooth, m.
    pub feed_per_tooth: f64,
    /// Duration, s.
    pub time: f64,
    /// Error of the drives, m, positive where material is left.
    pub path_error: f64,
    /// Deflection that the programme takes back, m.
    pub compensation: f64,
    /// Angle by which the cutter is engaged further than by the wall of the section alone, rad: near a hollow wall, where
    /// the plan holds limits along the path.
    pub engaged_further: f64,
}

impl ContourSection {
    /// Engagement of a cutter of a radius (m) in an allowance (m), which may differ from the planned one.
    pub fn engagement(&self, cutter_radius: f64, allowance: f64) -> Engagement {
        let alone = Engagement::new(self.shape, cutter_radius, allowance);
        if self.engaged_further == 0.0 {
            return alone;
        }
        let angle = (alone.angle + self.engaged_further).clamp(0.0, PI);
        Engagement { angle, immersion: cutter_radius * (1.0 - angle.cos()) }
    }
}

/// A pass around a contour as it is run.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourPlan {
    /// Sections in the order of the contour.
    pub sections: Vec<ContourSection>,
    /// Time around corners and for changes of spindle speed, out of cut, s.
    pub idle_time: f64,
    /// Greatest distance by which the path cuts a corner, m.
    pub corner_error: f64,
    /// Length of the cutter-centre path, m.
    pub path_length: f64,
    /// Nominal allowance along the wall's normal, m.
    pub allowance: f64,
    /// Height of the wall, m.
    pub depth_of_cut: f64,
    /// Radius of the cutter, m.
    pub cutter_radius: f64,
    /// Down or up milling.
    pub milling: Milling,
    /// Angle by which an edge lags per height, rad/m.
    pub helix_lag: f64,
    /// Share of an edge's life that the pass uses, as planned.
    pub life_fraction: f64,
}

impl ContourPlan {
    /// Plans pass `pass` of `work` by `rule`, with the spindle speeds that `machine` has and the
    /// money that machine and tool cost in this shop.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn new(
        work: &ContourWork,
        pass: usize,
        rule: ContourRule,
        tool: &ToolType,
        machine: &MachineType,
    ) -> Result<Self, PlanError> {
        let content = &work.content;
        let (name, pass) = work.pass(pass);
        let cutter = &content.parameters.cutter;
        if let ProcessModel::Milling(milling) = &tool.process {
            let both = [
                ("a diameter in mm of", 1e3 * cutter.diameter, 1e3 * milling.cutter.diameter),
                ("a number of teeth of", cutter.teeth, milling.cutter.teeth),
            ];
            for (quantity, planned, mounted) in both {
                if (planned - mounted).abs() > 1e-9 * mounted {
                    return Err(PlanError::Cutter { file: work.file.clone(), quantity, planned, tool: mounted });
                }
            }
        }
        let refuse =
            |source| PlanError::Contour { file: work.file.clone(), pass: name.to_owned(), source: Box::new(source) };
        let parameters = Parameters {
            machine: spindle(&content.parameters.machine, machine.speed_range, cutter.diameter),
            economics: economics(&content.parameters.economics, tool, machine),
            ..content.parameters.clone()
        };
        content.contour.clears(parameters.cutter.radius(), pass.gouge()).map_err(refuse)?;
        let planner = Planner::new(&content.contour, &parameters, pass, &content.models).map_err(refuse)?;
        let plan = match rule {
            ContourRule::HandbookOneFeed => planner.handbook(),
            ContourRule::HandbookPerSection => planner.handbook_by_section(),
            ContourRule::BestConstant => planner.best_constant(Objective::Cost),
            ContourRule::Time => planner.optimal(Objective::Time),
            ContourRule::Cost => planner.optimal(Objective::Cost),
        }
        .map_err(refuse)?;
        let compensated = pass.deflection_compensation / cutter.stiffness();
        let pieces = planner.contour().sections.iter().zip(planner.pieces());
        let sections = pieces.zip(&plan.sections).map(|((section, piece), planned)| {
            let shape = content.contour.shape(section);
            ContourSection {
                shape,
                cutting_speed: planned.evaluation.cutting_speed,
                feed_per_tooth: planned.setting.feed_per_tooth,
                time: planned.time,
                path_error: planned.evaluation.path_error,
                compensation: compensated * planned.evaluation.forces.normal,
                engaged_further: piece.engagement.angle - Engagement::new(shape, cutter.radius(), pass.allowance).angle,
            }
        });
        let gain = parameters.machine.position_gain;
        let undershoot = |corner: &toolroom_contour::CornerMove| match content.models.corners {
            CornerPolicy::SlowDown { .. } => corner_undershoot(corner.feed, corner.corner.interior_angle, gain),
            // Stops and loops meet the corner.
            CornerPolicy::ExactStop | CornerPolicy::Loop { .. } => 0.0,
        };
        Ok(Self {
            sections: sections.collect(),
            idle_time: plan.corner_time + plan.speed_change_time + plan.ramp_time,
            corner_error: plan.corners.iter().map(undershoot).fold(0.0, f64::max),
            path_length: content.contour.centre_length(cutter.radius()),
            allowance: pass.allowance,
            depth_of_cut: pass.depth_of_cut,
            cutter_radius: cutter.radius(),
            milling: content.models.milling,
            helix_lag: cutter.helix_lag(),
            life_fraction: plan.life_fraction,
        })
    }

    /// Duration of the pass, s.
    pub fn time(&self) -> f64 {
        self.idle_time + self.sections.iter().map(|section| section.time).sum::<f64>()
    }
}

/// The gears that lie within the shop machine's range of cutting speeds, m/s.
fn spindle(machine: &Machine, speed_range: (f64, f64), diameter: f64) -> Machine {
    let spindle = |speed: f64| 2.0 * speed / diameter;
    Machine {
        lowest_spindle_speed: machine.lowest_spindle_speed.max(spindle(speed_range.0)),
        highest_spindle_speed: machine.highest_spindle_speed.min(spindle(speed_range.1)),
        ..*machine
    }
}

/// What time and edges cost in the shop. A machine without a rate would make every edge infinitely
/// dear; it keeps that of the contour file.
fn economics(believed: &Economics, tool: &ToolType, machine: &MachineType) -> Economics {
    Economics {
        machine_rate: if machine.rate > 0.0 { machine.rate } else { believed.machine_rate },
        edge_change_time: machine.tool_change_time + machine.refill_time / f64::from(machine.magazine.max(1)),
        edge_cost: tool.edge_cost,
    }
}
