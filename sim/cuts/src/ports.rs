//! Where the quantities of the shop sit in the slices of a process.

use toolroom_process::{Field, MachineProcess};
use toolroom_scenario::MachineType;

/// Which slice of a process a quantity stands in.
#[derive(Clone, Copy)]
enum Slice {
    Input,
    State,
    Output,
}

impl Slice {
    fn fields(self, process: &dyn MachineProcess) -> &[Field] {
        match self {
            Self::Input => process.inputs(),
            Self::State => process.states(),
            Self::Output => process.outputs(),
        }
    }
}

/// Declares the quantities: one line each, with its slice and the names that processes give it.
macro_rules! ports {
    ($($quantity:ident: $slice:ident [$($name:literal),+];)+) => {
        /// Element indices of one process, looked up by name once. A quantity that the process does not
        /// have is neither set nor read.
        #[derive(Clone, Copy, Debug)]
        pub struct Ports {
            $(#[doc = concat!("Element of `", stringify!($quantity), "`.")] pub $quantity: Option<usize>,)+
            /// Whether the process judges the stability of its cuts.
            pub structure: bool,
        }

        impl Ports {
            /// Those of a process.
            pub fn of(process: &dyn MachineProcess) -> Self {
                Self {
                    $($quantity: element(Slice::$slice.fields(process), &[$($name),+]),)+
                    structure: false,
                }
            }
        }
    };
}

ports! {
    cutting_speed: Input ["cutting_speed"];
    cutting_acceleration: Input ["cutting_acceleration"];
    feed: Input ["feed_per_rev", "feed_per_tooth", "infeed_per_rev"];
    depth_of_cut: Input ["depth_of_cut"];
    width_of_cut: Input ["width_of_cut"];
    work_rotation_speed: Input ["work_rotation_speed"];
    down_milling: Input ["down_milling"];
    engaged: Input ["engaged"];
    hardness_ratio: Input ["hardness_ratio"];
    mechanical_wear_factor: Input ["mechanical_wear_factor"];
    thermal_wear_factor: Input ["thermal_wear_factor"];
    wear_rate_factor: Input ["wear_rate_factor"];
    chipping_resistance: Input ["chipping_resistance"];
    process_stiffness_factor: Input ["process_stiffness_factor"];
    flank_shear_factor: Input ["flank_shear_factor"];
    flank_pressure_factor: Input ["flank_pressure_factor"];
    coolant_age: Input ["coolant_age"];
    coolant_changed: Input ["coolant_changed"];
    machine_time: Input ["machine_time"];
    sensor_time: Input ["sensor_time"];
    pass_time: Input ["pass_time"];
    lot_deviation: Input ["lot_deviation"];
    flank_wear_state: State ["flank_wear"];
    flank_wear_seen: State ["seen_flank_wear"];
    energy_state: State ["energy"];
    feed_rate: Output ["feed_rate"];
    flank_wear: Output ["flank_wear", "wheel_wear"];
    cutting_force: Output ["cutting_force", "normal_force"];
    feed_force: Output ["feed_force"];
    spindle_power: Output ["spindle_power"];
    temperature: Output ["temperature"];
    thermo_emf: Output ["thermo_emf"];
    size_error: Output ["size_error"];
    workpiece_diameter: Input ["workpiece_diameter"];
    position: Input ["position"];
    natural_frequency_factor: Input ["natural_frequency_factor"];
    modal_damping_factor: Input ["modal_damping_factor"];
    speed_variation: Input ["speed_variation"];
    variation_revolutions: Input ["variation_revolutions"];
    chatter_time: State ["chatter_time"];
    stable: Output ["stable"];
    stability_margin: Output ["stability_margin"];
    vibration_amplitude: Output ["vibration_amplitude"];
    dominant_frequency: Output ["dominant_frequency"];
    chatter_growth_rate: Output ["chatter_growth_rate"];
    force_ripple: Output ["force_ripple"];
    roughness: Output ["roughness_ra"];
}

impl Ports {
    /// Flank wear of an edge in `state`, m: where it is neither a state nor kept beside one, as by an imported unit, the output
    /// of `process` with this input.
    pub fn worn(&self, process: &dyn MachineProcess, state: &[f64], input: &[f64], output: &mut Vec<f64>) -> f64 {
        if let Some(wear) = self.flank_wear_state.or(self.flank_wear_seen) {
            return state[wear];
        }
        if self.flank_wear.is_none() {
            return 0.0;
        }
        output.resize(elements(process.outputs()), 0.0);
        process.output(state, input, output);
        read(output, self.flank_wear, 0.0)
    }

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
        let mut index = 0;
        for field in fields {
            if field.name == *name {
                return Some(index);
            }
            index += field.len;
        }
        None
    })
}

/// Number of elements of `fields`.
pub fn elements(fields: &[Field]) -> usize {
    fields.iter().map(|field| field.len).sum()
}

/// Element of `values`, or `missing` where the process does not have it.
pub fn read(values: &[f64], index: Option<usize>, missing: f64) -> f64 {
    index.map_or(missing, |i| values[i])
}

/// Sets an element where the process has it.
pub fn write(values: &mut [f64], index: Option<usize>, value: f64) {
    if let Some(i) = index {
        values[i] = value;
    }
}

/// Start values of all elements.
pub fn start_values(fields: &[Field]) -> impl Iterator<Item = f64> {
    fields.iter().flat_map(|field| std::iter::repeat_n(field.start, field.len))
}
