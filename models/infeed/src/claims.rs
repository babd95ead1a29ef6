//! Published numbers that this crate reproduces.

use crate::{
    CycleLimits, IdentifyOptions, Infeed, Input, State, fastest_cycle_while_dulling, identify, lag_from_stock,
    paper_eq8_contradicts_eq3, paper_trials, stiffness_from_k,
};
use toolroom_process::{Claim, ModelError, Process};

/// Published numbers beside those that the default parameters give.
///
/// The trials are computed with one lag and one process stiffness for all, so the scatter of
/// the trials is in the difference: the gauge reads to 1 um, and the process stiffness of the
/// trials has a standard deviation of 2.8 %, of which the tolerance is three.
///
/// # Errors
/// None with the shipped parameters; those of [`Process::advance`].
pub fn claims() -> Result<Vec<Claim>, ModelError> {
    let grinding = Infeed::default();
    let mut claims = Vec::new();
    let mut claim = |claim: &str, source: &str, published: f64, computed: f64, tolerance: f64| {
        claims.push(Claim { claim: claim.to_owned(), source: source.to_owned(), published, computed, tolerance });
    };
    let trials = paper_trials();
    for trial in &trials {
        let input = Input { infeed_per_rev: trial.infeed_per_rev, ..Input::default() };
        let mut part = grinding.initial();
        grinding.advance(&mut part, &input, trial.revolutions * 60.0 / 292.0)?;
        let output = grinding.output(&part, &input);
        let id = &trial.trial_id;
        let source = format!("Sizyi, Fesenko & Lyubimyi, table 1, trial {id}");
        if let Some(stock) = trial.stock_removed {
            claim(
                &format!("grinding stock of trial {id} [um]"),
                &source,
                stock * 1e6,
                output.stock_removed * 1e6,
                0.02,
            );
        }
        if let Some(force) = trial.normal_force {
            claim(&format!("grinding force of trial {id} [N]"), &source, force, output.normal_force, 0.084);
        }
    }
    if let Ok(found) = identify(&trials, &IdentifyOptions::default()) {
        let source = "Sizyi, Fesenko & Lyubimyi, fig. 5";
        claim("mean lag K identified from the stock of five trials", source, 0.553, found.lag.mean, 1e-3);
        if let Some(stiffness) = found.trials[0].process_stiffness {
            let source = "Sizyi, Fesenko & Lyubimyi, eq. (4) for trial 1";
            claim("process stiffness identified from trial 1 [N/um]", source, 38.37, stiffness * 1e-6, 1e-3);
        }
    }
    stiffnesses(&mut claim);
    let input = Input::default();
    let cut = State { depth_of_cut: input.infeed_per_rev, ..State::default() };
    let output = grinding.output(&cut, &input);
    claim("grinding lag K", "Sizyi, Fesenko & Lyubimyi, eq. (3)", 0.553, output.lag, 1e-3);
    claim(
        "burn limit B in u* = u0 + B d_e^(1/4) a^(-3/4) v_w^(-1/2) [J, mm, s]",
        "Malkin, Grinding Technology, recalled",
        7.2,
        burn_constant(&grinding, &input, &output),
        0.01,
    );
    limited_cycles(&mut claim);
    Ok(claims)
}

/// Cycles within limits, beside those of an independent search.
fn limited_cycles(claim: &mut impl FnMut(&str, &str, f64, f64, f64)) {
    let source = "independent search over the revolution recursion";
    let (wheel, input) = (State::default(), Input::default());
    let revolutions = |grinding: &Infeed, limits: &CycleLimits| {
        let cycle = fastest_cycle_while_dulling(grinding, &wheel, &input, limits, None);
        cycle.map_or(f64::NAN, |cycle| f64::from(cycle.revolutions))
    };
    let (sharp, mut dulling, mut soft) = (Infeed::default(), Infeed::default(), Infeed::default());
    dulling.parameters.dulling_rate = 1.0 / 300e-6;
    soft.parameters.process_stiffness = 3e6;
    let limits = CycleLimits::default();
    let weak = CycleLimits { power: 2000.0, ..limits };
    let free = CycleLimits { material_removal: 1e-2, ..weak };
    for (name, published, computed) in [
        ("revolutions of the fastest cycle for 100 um", 27.0, revolutions(&sharp, &limits)),
        ("revolutions of the fastest cycle below 2 kW", 38.0, revolutions(&sharp, &weak)),
        ("revolutions of the fastest cycle on a wheel that dulls in the part", 28.0, revolutions(&dulling, &limits)),
        ("revolutions of a soft process without limit of the removal rate", 7.0, revolutions(&soft, &free)),
    ] {
        claim(name, source, published, computed, 1e-9);
    }
}

/// Both readings of the system stiffness: eq. (3) solved for J agrees with the force over the lag
/// measured in trial 1, eq. (8) as printed does not.
fn stiffnesses(claim: &mut impl FnMut(&str, &str, f64, f64, f64)) {
    let process_stiffness = 170.0 / 4.43e-6;
    let over_lag = 170.0 / (16.0 * 4.43e-6 - 66e-6);
    let lag = lag_from_stock(4.43e-6, 16.0, 0.0, 66e-6).unwrap_or(f64::NAN);
    claim(
        "system stiffness of trial 1: eq. (3) solved for J against force over measured lag [N/um]",
        "Sizyi, Fesenko & Lyubimyi, table 1: 170 N over 16 x 4.43 - 66 um",
        over_lag * 1e-6,
        stiffness_from_k(process_stiffness, lag) * 1e-6,
        1e-3,
    );
    claim(
        "system stiffness by eq. (8) as printed, which contradicts eq. (3) by the factor K [N/um]",
        "Sizyi, Fesenko & Lyubimyi, eq. (8) and the value that follows it",
        17.15,
        paper_eq8_contradicts_eq3(process_stiffness, 0.553) * 1e-6,
        1e-3,
    );
}

/// B of Malkin's burn limit, from the temperature that the process gives at one depth.
fn burn_constant(grinding: &Infeed, input: &Input, output: &crate::Output) -> f64 {
    let p = &grinding.parameters;
    let equivalent_diameter = p.equivalent_diameter();
    let work_speed = 0.5 * p.work_diameter * input.work_rotation_speed;
    let carried_off = p.chip_heat_share * p.chip_formation_energy;
    let at_burn = (output.specific_energy - carried_off) * p.burn_temperature_rise / output.temperature_rise;
    let shape = output.depth_of_cut.powf(0.75) * work_speed.sqrt() / equivalent_diameter.powf(0.25);
    // J, m, s to J, mm, s.
    1e-6 * at_burn * shape
}
