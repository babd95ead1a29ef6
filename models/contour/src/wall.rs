//! Walls of one shape and engagement: limits as functions of spindle speed and feed.

use crate::constraint::exceeds;
use crate::path_error::ArcError;
use crate::{
    Constraint, Cutter, Engagement, Forces, FormError, HelicalCut, MeanForces, Parameters, Planner, Ratios, Setting,
    Shape,
};
use std::f64::consts::{PI, TAU};

/// Everything about a wall shape that does not depend on the setting.
#[derive(Clone, Debug)]
pub(crate) struct Wall {
    pub(crate) shape: Shape,
    pub(crate) engagement: Engagement,
    pub(crate) forces: MeanForces,
    /// Forces at lesser engagement angles that occur on it, too.
    pub(crate) lesser: Vec<MeanForces>,
    pub(crate) chip_thickness_ratio: f64,
    pub(crate) life: f64,
    /// Roughness per feed per tooth squared, 1/m.
    pub(crate) cusp: f64,
    pub(crate) arc_error: ArcError,
    /// Finishing force, N, and its slope, N/m, at the heights that matter; empty for the mean.
    pub(crate) heights: Vec<(f64, f64)>,
}

impl Wall {
    /// The greatest of what the forces of its engagement angles do.
    fn greatest(&self, feed_per_tooth: f64, quantity: impl Fn(&Forces) -> f64) -> f64 {
        self.lesser
            .iter()
            .map(|forces| quantity(&forces.at(feed_per_tooth)))
            .fold(quantity(&self.forces.at(feed_per_tooth)), f64::max)
    }
}

/// A candidate on a wall: feed index, time and edge life used per length of centre path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Candidate {
    pub feed: usize,
    pub time: f64,
    pub life: f64,
}

/// The settings of one point with what depends on them alone.
#[derive(Clone, Copy)]
pub(crate) struct Operating {
    pub(crate) spindle_speed: f64,
    pub(crate) feed_per_tooth: f64,
    pub(crate) feed: f64,
    pub(crate) cutting_speed: f64,
    pub(crate) life: f64,
}

impl Planner<'_> {
    pub(crate) fn wall(
        &self,
        shape: Shape,
        (engagement, least): (Engagement, f64),
        arc_angle: f64,
        coefficients: &crate::EdgeForce,
    ) -> Wall {
        let Parameters { machine, cutter, life, .. } = self.parameters;
        let (pass, models, radius) = (self.pass, self.models, cutter.radius());
        let contact = 1.0 / shape.centre_path_ratio(radius);
        /// Angles below the greatest at which forces are looked at: the angles of a piece differ by a few per cent, over which
        /// a force between two of them is off by less than a thousandth (a test on random contours).
        const LESSER: u32 = 4;
        let lesser: Vec<f64> = if least < engagement.angle {
            let share = |i: u32| f64::from(i) / f64::from(LESSER);
            (0..LESSER).map(|i| least + share(i) * (engagement.angle - least)).collect()
        } else {
            Vec::new()
        };
        let heights = match models.form_error {
            FormError::Mean => Vec::new(),
            FormError::Helical => std::iter::once(&engagement.angle)
                .chain(&lesser)
                .flat_map(|angle| helical_heights(&self.helical(*angle, coefficients)))
                .collect(),
        };
        let forces = |angle: f64| coefficients.mean(angle, pass.depth_of_cut, cutter.teeth, models.milling);
        Wall {
            shape,
            engagement,
            forces: forces(engagement.angle),
            lesser: lesser.into_iter().map(forces).collect(),
            chip_thickness_ratio: engagement.chip_thickness_ratio(),
            life: life.of_cutter(pass.depth_of_cut, cutter.teeth, cutter.diameter)
                * life.of_immersion(engagement.immersion),
            // Run-out makes one cusp a revolution; the contact point is slower or faster than
            // the cutter centre.
            cusp: (cutter.teeth * contact).powi(2) / 8.0 * (1.0 / radius + shape.curvature()),
            arc_error: models.path_error.on_arc(shape.centre_radius(radius), arc_angle, machine.position_gain),
            heights,
        }
    }

    pub(crate) fn helical<'f>(&self, engagement_angle: f64, force: &'f crate::EdgeForce) -> HelicalCut<'f> {
        let cutter = &self.parameters.cutter;
        HelicalCut {
            force,
            milling: self.models.milling,
            engagement_angle,
            depth_of_cut: self.pass.depth_of_cut,
            teeth: cutter.teeth,
            // A straight edge is the limit of a slight helix.
            lag: cutter.helix_lag().max(1e-6 / self.pass.depth_of_cut),
        }
    }

    pub(crate) fn operating(&self, setting: Setting) -> Operating {
        let Cutter { diameter, teeth, .. } = self.parameters.cutter;
        let life = &self.parameters.life;
        Operating {
            spindle_speed: setting.spindle_speed,
            feed_per_tooth: setting.feed_per_tooth,
            feed: setting.feed(teeth),
            cutting_speed: setting.spindle_speed / TAU * PI * diameter,
            life: life.of_speed(setting.spindle_speed, diameter) * life.of_feed(setting.feed_per_tooth),
        }
    }

    /// The candidate of gear and feed index.
    pub(crate) fn candidate(&self, gear: usize, feed: usize) -> Operating {
        let Cutter { diameter, teeth, .. } = self.parameters.cutter;
        let (spindle_speed, feed_per_tooth) = (self.speeds[gear], self.feeds[feed]);
        Operating {
            spindle_speed,
            feed_per_tooth,
            feed: spindle_speed / TAU * feed_per_tooth * teeth,
            cutting_speed: spindle_speed / TAU * PI * diameter,
            life: self.life_of_speed[gear] * self.life_of_feed[feed],
        }
    }

    pub(crate) fn deflection(&self, wall: &Wall, feed_per_tooth: f64) -> f64 {
        let left = 1.0 - self.pass.deflection_compensation;
        let worst = |worst: f64, force: f64| if force.abs() > worst.abs() { force } else { worst };
        let force = if wall.heights.is_empty() {
            let normal = |forces: &MeanForces| forces.at(feed_per_tooth).normal;
            wall.lesser.iter().map(normal).fold(normal(&wall.forces), worst)
        } else {
            wall.heights.iter().map(|(edge, slope)| edge + slope * feed_per_tooth).fold(0.0, worst)
        };
        left * force / self.stiffness
    }

    pub(crate) fn ratio(&self, constraint: Constraint, wall: &Wall, operating: &Operating) -> f64 {
        let Parameters { machine, cutter, life, .. } = self.parameters;
        let pass = self.pass;
        match constraint {
            Constraint::HighestFeed => operating.feed / machine.highest_feed,
            Constraint::LowestFeed => machine.lowest_feed / operating.feed,
            Constraint::LowestSpindleSpeed => machine.lowest_spindle_speed / operating.spindle_speed,
            Constraint::HighestSpindleSpeed => operating.spindle_speed / machine.highest_spindle_speed,
            Constraint::Power => {
                let force = wall.forces.edge.tangential + wall.forces.per_feed.tangential * operating.feed_per_tooth;
                force * operating.cutting_speed / (machine.power * machine.efficiency)
            }
            Constraint::FeedForce => wall.greatest(operating.feed_per_tooth, Forces::resultant) / machine.feed_force,
            Constraint::ToothStrength => {
                let force =
                    self.tooth_force.0 + self.tooth_force.1 * wall.chip_thickness_ratio * operating.feed_per_tooth;
                6.0 * cutter.tooth_height * force / (cutter.tooth_thickness.powi(2) * cutter.tooth_strength)
            }
            Constraint::BodyStrength => {
                let moment =
                    |forces: &Forces| (forces.resultant() * cutter.overhang).hypot(forces.tangential * cutter.radius());
                wall.greatest(operating.feed_per_tooth, moment)
                    / (cutter.section_modulus_ratio * cutter.radius().powi(3) * cutter.body_strength)
            }
            Constraint::ChipSpace => {
                operating.feed_per_tooth * wall.engagement.immersion * cutter.chip_packing
                    / (cutter.chip_space_ratio * cutter.diameter.powi(2))
            }
            Constraint::ToolLife => life.nominal_life / (wall.life * operating.life),
            Constraint::Accuracy => {
                (self.deflection(wall, operating.feed_per_tooth).abs() + wall.arc_error.at(operating.feed))
                    / pass.tolerance
            }
            Constraint::Roughness => {
                (cutter.roughness_floor + wall.cusp * operating.feed_per_tooth * operating.feed_per_tooth)
                    / pass.roughness
            }
        }
    }

    pub(crate) fn admits(&self, wall: &Wall, operating: &Operating) -> bool {
        // Cheap and usually decisive ones first.
        const ORDER: [Constraint; 12] = [
            Constraint::HighestFeed,
            Constraint::LowestFeed,
            Constraint::Accuracy,
            Constraint::ToolLife,
            Constraint::ToothStrength,
            Constraint::Roughness,
            Constraint::Power,
            Constraint::BodyStrength,
            Constraint::FeedForce,
            Constraint::ChipSpace,
            Constraint::LowestSpindleSpeed,
            Constraint::HighestSpindleSpeed,
        ];
        ORDER.into_iter().all(|constraint| !exceeds(self.ratio(constraint, wall, operating)))
    }

    pub(crate) fn ratios(&self, wall: &Wall, operating: &Operating) -> Ratios {
        Ratios(Constraint::ALL.map(|constraint| self.ratio(constraint, wall, operating)))
    }

    /// By how much the form error over the height exceeds that of the average force, at most, m.
    pub(crate) fn hidden_form_error(&self, settings: &[Setting]) -> f64 {
        let force = self.parameters.force.under(self.pass.hardness_ratio, self.pass.flank_wear);
        let left = 1.0 - self.pass.deflection_compensation;
        let heights: Vec<Vec<(f64, f64)>> =
            self.walls.iter().map(|wall| helical_heights(&self.helical(wall.engagement.angle, &force))).collect();
        let excess = settings.iter().zip(&self.sections).map(|(setting, (wall, _))| {
            let height = |(edge, slope): &(f64, f64)| (edge + slope * setting.feed_per_tooth).abs();
            let worst = heights[*wall].iter().map(height).fold(0.0, f64::max);
            let mean = self.walls[*wall].forces.at(setting.feed_per_tooth).normal.abs();
            left * (worst - mean) / self.stiffness
        });
        excess.fold(0.0, f64::max)
    }
}

/// Finishing force at zero feed and its slope at the kinks of the form and halfway between.
pub(crate) fn helical_heights(cut: &HelicalCut) -> Vec<(f64, f64)> {
    const UNIT_FEED: f64 = 1e-4;
    let kinks = cut.heights();
    let between = kinks.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let line = |height: f64| {
        let edge = cut.finishing_force(0.0, height);
        (edge, (cut.finishing_force(UNIT_FEED, height) - edge) / UNIT_FEED)
    };
    kinks.iter().copied().chain(between).map(line).collect()
}
