//! Where the quantities of the shop sit in the slices of a process.

use toolroom_process::{Field, MachineProcess};
use toolroom_scenario::MachineType;

/// Element indices of one process, looked up by name once. A quantity that the process does not
/// have is neither set nor read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ports {
    pub cutting_speed: Option<usize>,
    pub cutting_acceleration: Option<usize>,
    pub feed: Option<usize>,
    pub depth_of_cut: Option<usize>,
    pub width_of_cut: Option<usize>,
    pub work_rotation_speed: Option<usize>,
    pub down_milling: Option<usize>,
    pub engaged: Option<usize>,
    pub hardness_ratio: Option<usize>,
    pub mechanical_wear_factor: Option<usize>,
    pub thermal_wear_factor: Option<usize>,
    pub wear_rate_factor: Option<usize>,
    pub chipping_resistance: Option<usize>,
    pub process_stiffness_factor: Option<usize>,
    pub flank_shear_factor: Option<usize>,
    pub flank_pressure_factor: Option<usize>,
    pub coolant_age: Option<usize>,
    pub coolant_changed: Option<usize>,
    pub machine_time: Option<usize>,
    pub sensor_time: Option<usize>,
    pub pass_time: Option<usize>,
    pub lot_deviation: Option<usize>,
    pub flank_wear_state: Option<usize>,
    pub energy_state: Option<usize>,
    pub feed_rate: Option<usize>,
    pub flank_wear: Option<usize>,
    pub cutting_force: Option<usize>,
    pub feed_force: Option<usize>,
    pub spindle_power: Option<usize>,
    pub temperature: Option<usize>,
    pub thermo_emf: Option<usize>,
    pub size_error: Option<usize>,
    pub workpiece_diameter: Option<usize>,
    pub position: Option<usize>,
    pub natural_frequency_factor: Option<usize>,
    pub modal_damping_factor: Option<usize>,
    pub speed_variation: Option<usize>,
    pub variation_revolutions: Option<usize>,
    pub chatter_time: Option<usize>,
    pub stable: Option<usize>,
    pub stability_margin: Option<usize>,
    pub vibration_amplitude: Option<usize>,
    pub dominant_frequency: Option<usize>,
    pub chatter_growth_rate: Option<usize>,
    pub force_ripple: Option<usize>,
    pub roughness: Option<usize>,
    /// Whether the process judges the stability of its cuts.
    pub structure: bool,
}

impl Ports {
    pub fn of(process: &dyn MachineProcess) -> Self {
        let (u, x, y) = (process.inputs(), process.states(), process.outputs());
        Self {
            cutting_speed: element(u, &["cutting_speed"]),
            cutting_acceleration: element(u, &["cutting_acceleration"]),
            feed: element(u, &["feed_per_rev", "feed_per_tooth", "infeed_per_rev"]),
            depth_of_cut: element(u, &["depth_of_cut"]),
            width_of_cut: element(u, &["width_of_cut"]),
            work_rotation_speed: element(u, &["work_rotation_speed"]),
            down_milling: element(u, &["down_milling"]),
            engaged: element(u, &["engaged"]),
            hardness_ratio: element(u, &["hardness_ratio"]),
            mechanical_wear_factor: element(u, &["mechanical_wear_factor"]),
            thermal_wear_factor: element(u, &["thermal_wear_factor"]),
            wear_rate_factor: element(u, &["wear_rate_factor"]),
            chipping_resistance: element(u, &["chipping_resistance"]),
            process_stiffness_factor: element(u, &["process_stiffness_factor"]),
            flank_shear_factor: element(u, &["flank_shear_factor"]),
            flank_pressure_factor: element(u, &["flank_pressure_factor"]),
            coolant_age: element(u, &["coolant_age"]),
            coolant_changed: element(u, &["coolant_changed"]),
            machine_time: element(u, &["machine_time"]),
            sensor_time: element(u, &["sensor_time"]),
            pass_time: element(u, &["pass_time"]),
            lot_deviation: element(u, &["lot_deviation"]),
            flank_wear_state: element(x, &["flank_wear"]),
            energy_state: element(x, &["energy"]),
            feed_rate: element(y, &["feed_rate"]),
            flank_wear: element(y, &["flank_wear", "wheel_wear"]),
            cutting_force: element(y, &["cutting_force", "normal_force"]),
            feed_force: element(y, &["feed_force"]),
            spindle_power: element(y, &["spindle_power"]),
            temperature: element(y, &["temperature"]),
            thermo_emf: element(y, &["thermo_emf"]),
            size_error: element(y, &["size_error"]),
            workpiece_diameter: element(u, &["workpiece_diameter"]),
            position: element(u, &["position"]),
            natural_frequency_factor: element(u, &["natural_frequency_factor"]),
            modal_damping_factor: element(u, &["modal_damping_factor"]),
            speed_variation: element(u, &["speed_variation"]),
            variation_revolutions: element(u, &["variation_revolutions"]),
            chatter_time: element(x, &["chatter_time"]),
            stable: element(y, &["stable"]),
            stability_margin: element(y, &["stability_margin"]),
            vibration_amplitude: element(y, &["vibration_amplitude"]),
            dominant_frequency: element(y, &["dominant_frequency"]),
            chatter_growth_rate: element(y, &["chatter_growth_rate"]),
            force_ripple: element(y, &["force_ripple"]),
            roughness: element(y, &["roughness_ra"]),
            structure: false,
        }
    }
}

impl Ports {
    /// Sets what ages: machines are cold and sensors calibrated at the start of the run.
    pub fn write_ages(&self, input: &mut [f64], now: f64, machine: &MachineType) {
        let (age, changed) = machine.coolant(now);
        write(input, self.coolant_age, age);
        write(input, self.coolant_changed, f64::from(u8::from(changed)));
        write(input, self.machine_time, now);
        write(input, self.sensor_time, now);
    }
}

/// Index of the first element of the first of `names` that there is.
fn element(fields: &[Field], names: &[&str]) -> Option<usize> {
    names.iter().find_map(|name| {
        let mut at = 0;
        for field in fields {
            if field.name == *name {
                return Some(at);
            }
            at += field.len;
        }
        None
    })
}

/// Number of elements of `fields`.
pub(super) fn elements(fields: &[Field]) -> usize {
    fields.iter().map(|field| field.len).sum()
}

/// Element of `values`, or `missing` where the process does not have it.
pub(super) fn read(values: &[f64], at: Option<usize>, missing: f64) -> f64 {
    at.map_or(missing, |i| values[i])
}

/// Sets an element where the process has it.
pub(super) fn write(values: &mut [f64], at: Option<usize>, value: f64) {
    if let Some(i) = at {
        values[i] = value;
    }
}

/// Start values of all elements.
pub(super) fn start_values(fields: &[Field]) -> impl Iterator<Item = f64> {
    fields.iter().flat_map(|field| std::iter::repeat_n(field.start, field.len))
}
