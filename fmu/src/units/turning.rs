//! Turning as a unit.

use super::TurningMachine;
use crate::unit::{AdaptivePolicy, Renewal, Unit};
use std::sync::Arc;
use toolroom_chatter::Mode;
use toolroom_cutting::{
    Regeneration, Turning, TurningInput, TurningMemory, TurningOutput, TurningState, TurningStructure,
};
use toolroom_effects::Effects;
use toolroom_process::num_dual::Dual64;
use toolroom_process::{Advance, ModelError, Process};
use toolroom_wear::{Cut, PARAMETER_SETS};

impl Unit for Turning {
    type Machine = TurningMachine;
    type Memory = TurningMemory;
    const IDENTIFIER: &'static str = "toolroom_turning";
    const TITLE: &'static str = "Turning: wear, force, heat and power of one edge";
    const ABSTRACT: &'static str = "One cutting edge in one workpiece. The flank land grows by force along the path \
        and by temperature in time; both feed back through the land. Forces, contact temperature, thermo-EMF, power, \
        energy, roughness and size error follow. A rising edge of tool.change mounts a new edge.";
    const EQUATIONS: &'static [(&'static str, &'static str)] = &[
        ("flank wear", "d flank_wear/dt = cutting_speed · mechanical_wear_per_path + thermal_wear_rate"),
        ("mechanical wear per path", "A = A0 · hardness^n · (1 + h_r/(h + h_e)) · phi(temperature)"),
        ("thermal wear rate", "B = B0 · (1 + (h/h_t)²) · exp(-E_t/R · (1/temperature - 1/reference_temperature))"),
        ("softening", "phi = 1/(1/phi_c + (1 - 1/phi_c) · exp(-E_m/R · (1/temperature - 1/reference_temperature)))"),
        ("tool body", "d body/dt = (chip and flank heating - body)/body_time_constant"),
        ("energy", "d energy/dt = cutting_force · cutting_speed"),
        ("roughness", "roughness_ra = feed_per_rev²/(32 corner_radius), more under chatter"),
        (
            "stability",
            "stability_margin = 1 - depth_of_cut/limit, limit by the characteristic roots of x'' + 2ζω x' + ω² x = K b (x(t - T) - x)/m",
        ),
    ];
    const VALIDITY: &'static [&'static str] = &[
        "Constants marked as assumptions in the parameter sets are assumptions: calibrate before trusting an absolute number.",
        "The default set demonstrates that the doubled tool life of Postnov and Shafikov is attainable; it predicts nothing.",
        "Not modelled: built-up edge, thermal growth of workpiece and spindle, notch and crater wear, chip breaking, \
         interruptions within a revolution.",
        "Chatter is judged where machine.chatter is true, by one mode; the verdict is kept at rounded speed and damping.",
        "The built-in speed policy sees the true wear; a real controller has to estimate it.",
    ];
    const STATE_GROUP: &'static str = "tool";
    const SETS: &'static [(&'static str, &'static str)] = PARAMETER_SETS;
    const RENEWALS: &'static [Renewal<Self>] = &[Renewal {
        name: "tool.change",
        count: "tool.count",
        doc: "A rising edge mounts a new edge.",
        count_doc: "Edges mounted so far, the first one included.",
        renew: |turning, _| turning.initial(),
    }];
    const ENUMERATIONS: &'static [(&'static str, &'static [&'static str])] =
        &[("adaptive.mode", &["least wear", "productivity at a shadow price", "set wear per path"])];
    const CONTINUOUS: bool = true;
    const VIBRATES: bool = true;
    const ADAPTIVE: bool = true;
    const EXPERIMENT: (f64, f64) = (600.0, 0.1);

    fn read(text: &str) -> Result<Self, String> {
        let pair = toolroom_wear::Pair::read(text).map_err(|error| error.to_string())?;
        Ok(Self { pair, ..Self::default() })
    }

    fn effects_mut(&mut self) -> &mut Effects {
        &mut self.effects
    }

    fn step(
        &self,
        x: &mut TurningState,
        u: &TurningInput,
        dt: f64,
        memory: &mut TurningMemory,
    ) -> Result<Advance, ModelError> {
        Turning::step(self, x, u, dt, memory)
    }

    fn observe(&self, x: &TurningState, u: &TurningInput, memory: &TurningMemory) -> TurningOutput {
        self.output_after(x, u, memory)
    }

    fn observe_one(&self, output: usize, x: &TurningState, u: &TurningInput, memory: &TurningMemory) -> Option<f64> {
        self.one_output_after(output, x, u, memory)
    }

    fn mount(&mut self, machine: &TurningMachine, regeneration: Regeneration) -> Result<(), String> {
        let mode = Mode {
            direction: [1.0, 0.0],
            natural_frequency: machine.natural_frequency,
            damping_ratio: machine.damping_ratio,
            stiffness: machine.stiffness,
        };
        // The diameter is that of the cut, an input.
        let cut = toolroom_chatter::Turning {
            process_damping: machine.process_damping,
            ..toolroom_chatter::Turning::orthogonal(vec![mode], machine.cutting_coefficient, 0.1)
        };
        let structure = TurningStructure::new(cut, None, regeneration).map_err(|error| error.to_string())?;
        self.structure = Some(Arc::new(structure));
        Ok(())
    }

    fn linearise(
        &self,
        x: &TurningState,
        u: &TurningInput,
        dx: &TurningState,
        du: &TurningInput,
    ) -> Option<(TurningState, TurningOutput)> {
        let turning = self.map(Dual64::from);
        let (x, u) = (super::seeded!(x, dx, TurningState), super::seeded!(u, du, TurningInput));
        Some((turning.rates(&x, &u).map(|rate| rate.eps), turning.observe(&x, &u).map(|output| output.eps)))
    }

    fn commanded_speed(&self, policy: &AdaptivePolicy, x: &TurningState, u: &TurningInput) -> f64 {
        let pair = &self.pair;
        // As programmed: the policy does not know the scatter of this edge.
        let cut = Cut::nominal(pair.limits.reference_speed, u.feed_per_rev, u.depth_of_cut);
        let speed = match policy.mode {
            mode if mode <= 1.0 => pair.minimum_wear_speed(&cut, x.flank_wear),
            mode if mode <= 2.0 => pair.shadow_price_speed(&cut, x.flank_wear, policy.shadow_price),
            _ => pair.set_intensity_speed(&cut, x.flank_wear, policy.wear_intensity).cutting_speed,
        };
        pair.limits.clip(speed)
    }
}
