//! Milling as a unit.

use super::MillingMachine;
use crate::unit::{Renewal, Unit};
use std::sync::Arc;
use toolroom_chatter::Mode;
use toolroom_cutting::{
    MILLING_SETS, Milling, MillingInput, MillingOutput, MillingState, MillingStructure, Regeneration,
};
use toolroom_effects::Effects;
use toolroom_process::Process;
use toolroom_process::num_dual::Dual64;

/// Flank wear beyond which nothing is known of a cutter, m: the range in which contour milling plans its cuts. Force
/// linear in wear and the wear rate of the last stage have no evidence there (assumption).
const WORN_OUT: f64 = 2e-3;

impl Unit for Milling {
    type Machine = MillingMachine;
    type Memory = ();
    const IDENTIFIER: &'static str = "toolroom_milling";
    const TITLE: &'static str = "Milling: wear, force, power and form error of one cutter";
    const ABSTRACT: &'static str = "Peripheral milling of a wall or a slot with one cutter: mean forces by the linear \
        edge-force model, wear by an extended Taylor law with three stages, deflection of the cutter, runout. A rising \
        edge of tool.change mounts a new cutter.";
    const EQUATIONS: &'static [(&'static str, &'static str)] = &[
        (
            "tool life",
            "tool_life = reference_life · (v/v_r)^-p · (f_z/f_r)^-q · (a_p/a_r)^-r · (a_e/e_r)^-s / hardness^n",
        ),
        ("flank wear", "d flank_wear/dt = wear_limit/(tool_life · s(x)), s = 1 + stage_contrast·(6·x·(1 - x) - 1)"),
        (
            "tooth force",
            "F_t = (K_tc h + K_te + flank_shear_stress VB) a_p, F_r = (K_rc h + K_re + flank_pressure VB) a_p",
        ),
        ("mean tangential force", "F_t = a_p/2π · z · (K_tc f_z (1 - cos ψ) + K_te ψ)"),
        ("form error", "form_error = normal_force/static_stiffness"),
    ];
    const VALIDITY: &'static [&'static str] = &[
        "Straight wall, teeth alike but for runout, chip thickness in the range of the force coefficients.",
        "Beyond a flank wear of 2 mm nothing is known: in Co-Simulation the cutter then counts as lost.",
        "Not modelled: heat, curved walls, the helix beyond the mean, ploughing of thin chips, tilted runout.",
        "Chatter is judged where machine.chatter is true, by one mode; the verdict is kept at rounded speed and damping.",
    ];
    const STATE_GROUP: &'static str = "tool";
    const SETS: &'static [(&'static str, &'static str)] = MILLING_SETS;
    const RENEWALS: &'static [Renewal<Self>] = &[Renewal {
        name: "tool.change",
        count: "tool.count",
        doc: "A rising edge mounts a new cutter.",
        count_doc: "Cutters mounted so far, the first one included.",
        renew: |milling, _| milling.initial(),
    }];
    const CONTINUOUS: bool = true;
    const VIBRATES: bool = true;
    const ADAPTIVE: bool = false;
    const EXPERIMENT: (f64, f64) = (3600.0, 1.0);

    fn read(text: &str) -> Result<Self, String> {
        Milling::read(text).map_err(|error| error.to_string())
    }

    fn worn_out(&self, x: &Self::State) -> bool {
        x.flank_wear >= WORN_OUT
    }

    fn effects_mut(&mut self) -> &mut Effects {
        &mut self.effects
    }

    fn mount(&mut self, machine: &MillingMachine, regeneration: Regeneration) -> Result<(), String> {
        let along = |direction| Mode {
            direction,
            natural_frequency: machine.natural_frequency,
            damping_ratio: machine.damping_ratio,
            stiffness: machine.stiffness,
        };
        let modes = vec![along([1.0, 0.0]), along([0.0, 1.0])];
        let structure = MillingStructure::new(modes, machine.helix_angle, machine.process_damping, regeneration);
        self.structure = Some(Arc::new(structure.map_err(|error| error.to_string())?));
        Ok(())
    }

    fn linearise(
        &self,
        x: &MillingState,
        u: &MillingInput,
        dx: &MillingState,
        du: &MillingInput,
    ) -> Option<(MillingState, MillingOutput)> {
        let milling = self.map(Dual64::from);
        let (x, u) = (super::seeded!(x, dx, MillingState), super::seeded!(u, du, MillingInput));
        Some((milling.rates(&x, &u).map(|rate| rate.eps), milling.observe(&x, &u).map(|output| output.eps)))
    }
}
