//! Plunge grinding as a unit.

use super::TurningMachine;
use crate::unit::{Renewal, Unit};
use toolroom_effects::Effects;
use toolroom_infeed::{Infeed, InfeedProfile, PARAMETER_SETS, Parameters, ProfileState};
use toolroom_process::Process;

/// Revolutions of the part that are worked out within a second: one takes 41 us in a development build
/// (measured on a shared server), and half of the second is kept in reserve.
const REVOLUTIONS: f64 = 10_000.0;

impl Unit for InfeedProfile {
    // Never requested.
    type Machine = TurningMachine;
    type Memory = ();
    const IDENTIFIER: &'static str = "toolroom_infeed";
    const TITLE: &'static str = "Plunge grinding: infeed, deflection, stock, burn and the wheel";
    const ABSTRACT: &'static str = "Plunge grinding as a delay equation around the circumference of the part: what a \
        revolution leaves is met by the next one. Force, size error, roundness, temperature, burn margin, wheel wear \
        and dulling follow. Co-Simulation only.";
    const EQUATIONS: &'static [(&'static str, &'static str)] = &[
        ("stock", "r(t) = (1 - K) u(t) + K r(t - T), K = Cp/(J + Cp), T one work revolution"),
        ("depth at a station", "h = max(0, (u - w - F0/J - r)/(1 + Cp/J + g/360)), g = (1/G) d_w/d_s"),
        ("normal force", "normal_force = F0 + Cp h"),
        ("temperature", "temperature_rise = 2/√π · ε q √(l_c/(v_w k ρ c))"),
    ];
    const VALIDITY: &'static [&'static str] = &[
        "Depth of cut far below wheel and work diameter; the moving heat source at high Péclet number.",
        "Not modelled: waves on the wheel, waves shorter than the contact, contact stiffness that grows with load, \
         thermal growth.",
    ];
    const STATE_GROUP: &'static str = "part";
    const SETS: &'static [(&'static str, &'static str)] = PARAMETER_SETS;
    const RENEWALS: &'static [Renewal<Self>] = &[
        Renewal {
            name: "part.change",
            count: "part.count",
            doc: "A rising edge loads a new part; the wheel stays as it is.",
            count_doc: "Parts loaded so far, the first one included.",
            renew: |infeed, x| ProfileState {
                wheel_wear: x.wheel_wear,
                removed_volume: x.removed_volume,
                ..infeed.initial()
            },
        },
        Renewal {
            name: "wheel.dress",
            count: "wheel.count",
            doc: "A rising edge dresses the wheel: sharp, true and set back to its size.",
            count_doc: "Dressings so far, the first one included.",
            renew: |_, x| ProfileState { wheel_wear: 0.0, removed_volume: 0.0, ..*x },
        },
    ];
    const CONTINUOUS: bool = false;
    const VIBRATES: bool = false;
    const ADAPTIVE: bool = false;
    const EXPERIMENT: (f64, f64) = (6.0, 0.01);
    const EFFECTS_OF: &'static str = Infeed::NAME;

    fn read(text: &str) -> Result<Self, String> {
        let parameters = Parameters::read(text).map_err(|error| error.to_string())?;
        Self::new(parameters, Effects::default()).map_err(|error| error.to_string())
    }

    fn longest_step(&self, u: &Self::Input) -> (f64, &'static str) {
        let revolutions = u.work_rotation_speed / std::f64::consts::TAU;
        let longest = if u.engaged > 0.5 && revolutions > 0.0 { REVOLUTIONS / revolutions } else { f64::INFINITY };
        (longest, "every revolution of the part is ground station by station")
    }

    fn effects_mut(&mut self) -> &mut Effects {
        &mut self.grinding.effects
    }
}
