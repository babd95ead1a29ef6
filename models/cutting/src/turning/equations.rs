//! The equations of turning, once for `f64` and dual numbers.

use super::{Turning, TurningInput, TurningOutput, TurningState};
use toolroom_effects::{Context, Terms};
use toolroom_process::Number;
use toolroom_wear::{Cut, WearLaw};

impl<N: Number> Turning<N> {
    /// What the effects make of this instant.
    pub(crate) fn terms(&self, x: &TurningState<N>, u: &TurningInput<N>) -> Terms<N> {
        self.effects.terms(&Context {
            flank_wear: x.flank_wear,
            cutting_time: x.cutting_time,
            coolant_age: u.coolant_age,
            lot_deviation: u.lot_deviation,
            cutting_speed: u.cutting_speed,
            pass_time: u.pass_time,
            sensor_time: u.sensor_time,
            feed_override: u.feed_override,
            ..Context::neutral()
        })
    }

    /// The cut that the edge meets: command, scatter and effects together.
    pub(crate) fn cut(&self, u: &TurningInput<N>, terms: &Terms<N>) -> Cut<N> {
        let own_damage_rate = match &self.pair.law {
            WearLaw::EnergyBalance(law) => law.damage_rate,
            _ => N::from(0.0),
        };
        Cut {
            cutting_speed: u.cutting_speed,
            feed_per_rev: u.feed_per_rev,
            depth_of_cut: u.depth_of_cut,
            engaged: u.engaged,
            hardness: u.hardness_ratio,
            mechanical_factor: u.mechanical_wear_factor * terms.mechanical_wear,
            thermal_factor: u.thermal_wear_factor,
            wear_factor: u.wear_rate_factor * terms.wear_rate,
            temperature_factor: terms.temperature_rise,
            force_factor: u.force_factor * terms.specific_cutting_force,
            flank_shear_factor: u.flank_shear_factor,
            flank_pressure_factor: u.flank_pressure_factor,
            damage_rate: if own_damage_rate.re() > 0.0 { N::from(0.0) } else { self.finish.thermal_damage_rate },
            damage_gain: terms.thermal_damage_coupling,
            chipping_rate: u.chipping_rate + terms.chipping_rate,
        }
    }

    /// What softening of the hot work material leaves of the specific cutting force at a contact
    /// temperature.
    fn softened(&self, terms: &Terms<N>, temperature: N) -> N {
        -(terms.thermal_softening * (temperature - self.pair.temperature.ambient_temperature)) + 1.0
    }

    /// Right-hand side: rates per second.
    pub fn rates(&self, x: &TurningState<N>, u: &TurningInput<N>) -> TurningState<N> {
        let terms = self.terms(x, u);
        let cut = self.cut(u, &terms);
        let wear = self.pair.derivative(&x.wear(), &cut);
        let soft = self.softened(&terms, self.pair.contact_temperature(&x.wear(), &cut));
        let warm = Cut { force_factor: cut.force_factor * soft, ..cut };
        let force = self.pair.force.cutting(&warm, x.flank_wear) * terms.cutting_force;
        TurningState {
            flank_wear: wear.flank_wear,
            tool_body_temperature_rise: wear.body_temperature_rise,
            thermal_damage: wear.thermal_damage,
            mechanical_wear: wear.mechanical_wear,
            thermal_wear: wear.thermal_wear,
            cutting_path: wear.path,
            cutting_time: wear.cutting_time,
            chipping_hazard: wear.chipping_hazard,
            energy: force * u.cutting_speed * u.engaged,
        }
    }

    /// Everything that can be observed, as the sensors read it: their effects act on forces,
    /// temperature and power.
    ///
    /// | output | equation |
    /// |---|---|
    /// | passive_force | `feed_force / tan κ` |
    /// | peak_cutting_force | cutting force at `depth_of_cut + runout` |
    /// | roughness_ra | `f²/(32 r_ε)`, the ideal profile (Rz = f²/(8 r_ε), Ra ≈ Rz/4) |
    /// | size_error | `flank_wear·tan α_o + (F_p - F_p of the new edge)/static_stiffness` |
    pub fn observe(&self, x: &TurningState<N>, u: &TurningInput<N>) -> TurningOutput<N> {
        let terms = self.terms(x, u);
        let cut = self.cut(u, &terms);
        let point = self.pair.output(&x.wear(), &cut);
        let warm = Cut { force_factor: cut.force_factor * self.softened(&terms, point.temperature), ..cut };
        let cutting_force = self.pair.force.cutting(&warm, x.flank_wear) * cut.engaged * terms.cutting_force;
        let feed_force = self.pair.force.feed(&warm, x.flank_wear) * cut.engaged * terms.feed_force;
        let edge_angle = self.pair.force.cutting_edge_angle.tan();
        let new_feed_force = self.pair.force.feed(&cut, N::from(0.0)) * cut.engaged;
        let deflection = (feed_force - new_feed_force) / edge_angle / self.finish.static_stiffness;
        let eccentric = Cut { depth_of_cut: cut.depth_of_cut + terms.runout, ..warm };
        TurningOutput {
            flank_wear: x.flank_wear,
            wear_ratio: x.flank_wear / self.pair.limits.wear_limit,
            temperature: point.temperature + terms.temperature_offset,
            mechanical_wear_per_path: point.mechanical_wear_per_path,
            thermal_wear_rate: point.thermal_wear_rate,
            wear_intensity: point.wear_intensity,
            wear_balance: point.wear_balance,
            cutting_force: cutting_force * terms.force_reading + terms.force_offset,
            feed_force: feed_force * terms.force_reading,
            passive_force: feed_force / edge_angle,
            peak_cutting_force: self.pair.force.cutting(&eccentric, x.flank_wear) * terms.cutting_force * cut.engaged,
            spindle_power: cutting_force * u.cutting_speed + terms.spindle_loss,
            thermo_emf: point.thermo_emf,
            spindle_speed: u.cutting_speed / u.workpiece_diameter * 2.0,
            material_removal_rate: u.cutting_speed * u.feed_per_rev * u.depth_of_cut * u.engaged,
            roughness_ra: u.feed_per_rev * u.feed_per_rev / self.finish.corner_radius / 32.0,
            size_error: x.flank_wear * self.finish.clearance_angle.tan() + deflection,
        }
    }
}
