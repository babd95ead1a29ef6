//! Quantities of the context and terms by name.

use crate::{Context, Terms};
use toolroom_process::{Field, Number, Record};

/// Lists fields of a record, so that a formula reaches them by number over any number type.
macro_rules! slots {
    ($(#[doc = $doc:literal])+ $slot:ident of $record:ident: $($field:ident)+) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[expect(non_camel_case_types, reason = "a slot is called as the field that it is")]
        pub(crate) enum $slot { $($field,)+ }

        impl $slot {
            /// Every field, in the order of the record.
            pub const ALL: &'static [Self] = &[$(Self::$field,)+];

            /// Name of the field.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$field => stringify!($field),)+ }
            }

            /// Description of the field.
            pub fn field(self) -> &'static Field {
                let own = |field: &&Field| field.name == self.name();
                $record::<f64>::FIELDS.iter().find(own).expect("a slot is a field")
            }

            /// Its value.
            pub fn of<N: Number>(self, record: &$record<N>) -> N {
                match self { $(Self::$field => record.$field,)+ }
            }

            /// Its place.
            pub fn of_mut<N: Number>(self, record: &mut $record<N>) -> &mut N {
                match self { $(Self::$field => &mut record.$field,)+ }
            }
        }
    };
}

slots! {
    /// A quantity at which an effect may look.
    Quantity of Context:
    flank_wear cutting_time coolant_age lot_deviation coolant_changed removed_volume cutting_speed pass_time
    sensor_time machine_time feed_override wait_time feed_rate path_curvature helical_deviation feed depth_of_cut
    width_of_cut workpiece_diameter
}

slots! {
    /// A term that an effect may change.
    Term of Terms:
    cutting_force feed_force specific_cutting_force temperature_rise wear_rate mechanical_wear
    thermal_damage_coupling runout chuck_modulation mode_frequency mode_damping mode_stiffness process_damping
    process_stiffness threshold_force
    thermal_softening chipping_rate force_reading force_offset temperature_offset spindle_loss form_error
    width_of_cut wheel_wear_ratio start_offset system_stiffness thermal_growth
}

impl Term {
    /// Whether changes multiply the term; they are added otherwise.
    pub fn is_factor(self) -> bool {
        self.field().start == 1.0
    }

    /// Channels that follow the term. All that depends on wear is listed by the flank wear alone.
    pub fn channels(self) -> &'static [&'static str] {
        const FORCES: &[&str] = &["cutting_force", "feed_force", "spindle_power"];
        const GRINDING: &[&str] = &["normal_force", "tangential_force", "rise_revolutions", "stock_removed"];
        match self {
            Self::cutting_force => &["cutting_force", "spindle_power"],
            Self::feed_force => &["feed_force"],
            Self::specific_cutting_force => {
                &["cutting_force", "feed_force", "spindle_power", "temperature", "thermo_emf", "flank_wear"]
            }
            Self::temperature_rise => &["temperature", "thermo_emf", "flank_wear"],
            Self::wear_rate | Self::mechanical_wear | Self::thermal_damage_coupling => &["flank_wear"],
            Self::runout => &["vibration_rms", "roughness_ra", "flank_wear"],
            Self::chuck_modulation => &["vibration_rms"],
            Self::mode_frequency => &["dominant_frequency", "vibration_rms", "roughness_ra"],
            Self::mode_damping | Self::mode_stiffness | Self::process_damping => &["vibration_rms", "roughness_ra"],
            Self::process_stiffness | Self::system_stiffness => GRINDING,
            Self::threshold_force => &["normal_force", "force_after_spark_out", "stock_removed"],
            Self::thermal_softening => FORCES,
            Self::chipping_rate => &["stop_count"],
            Self::force_reading => &["cutting_force", "feed_force"],
            Self::force_offset => &["cutting_force"],
            Self::temperature_offset => &["temperature"],
            Self::spindle_loss => &["spindle_power"],
            Self::form_error => &["form_error"],
            Self::width_of_cut => &["cutting_force", "spindle_power", "flank_wear"],
            Self::wheel_wear_ratio => &["stock_removed", "normal_force"],
            Self::start_offset => &["stock_removed", "rise_revolutions"],
            Self::thermal_growth => &["stock_removed"],
        }
    }

    /// Whether the equations of a process read the term.
    pub fn is_read_by(self, process: &str) -> bool {
        match self {
            Self::cutting_force
            | Self::feed_force
            | Self::specific_cutting_force
            | Self::wear_rate
            | Self::mechanical_wear
            | Self::runout
            | Self::mode_frequency
            | Self::mode_damping
            | Self::mode_stiffness
            | Self::process_damping
            | Self::chipping_rate
            | Self::force_reading
            | Self::force_offset
            | Self::spindle_loss => matches!(process, "turning" | "milling"),
            Self::thermal_damage_coupling
            | Self::chuck_modulation
            | Self::thermal_softening
            | Self::temperature_offset => process == "turning",
            Self::form_error | Self::width_of_cut => process == "milling",
            Self::temperature_rise => matches!(process, "turning" | "infeed"),
            Self::process_stiffness
            | Self::threshold_force
            | Self::wheel_wear_ratio
            | Self::start_offset
            | Self::system_stiffness
            | Self::thermal_growth => process == "infeed",
        }
    }
}

impl Quantity {
    /// Processes that fill the quantity.
    pub const fn filled_by(self) -> &'static [&'static str] {
        match self {
            Self::flank_wear
            | Self::cutting_time
            | Self::lot_deviation
            | Self::cutting_speed
            | Self::sensor_time
            | Self::feed_override
            | Self::feed
            | Self::depth_of_cut => &["turning", "milling"],
            Self::coolant_age => &["turning", "infeed"],
            Self::pass_time | Self::workpiece_diameter => &["turning"],
            Self::feed_rate | Self::path_curvature | Self::helical_deviation | Self::width_of_cut => &["milling"],
            Self::coolant_changed | Self::removed_volume | Self::machine_time | Self::wait_time => &["infeed"],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_of_context_and_terms_has_its_slot() {
        let names = |fields: &[Field]| fields.iter().map(|field| field.name).collect::<Vec<_>>();
        assert_eq!(Quantity::ALL.iter().map(|own| own.name()).collect::<Vec<_>>(), names(Context::<f64>::FIELDS));
        assert_eq!(Term::ALL.iter().map(|own| own.name()).collect::<Vec<_>>(), names(Terms::<f64>::FIELDS));
    }
}
