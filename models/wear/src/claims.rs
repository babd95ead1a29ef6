//! Published numbers beside those that this crate computes.

use crate::{Cut, Objective, Pair, Scatter, SetError, WearLaw, WearState};
use toolroom_process::{Claim, ModelError};

const PAPER: &str = "Postnov & Shafikov, evolutionary model of tool wear";
const HANDBOOK: &str = "Kosilova & Meshcheryakov handbook, recalled";
const REFERENCE: &str = "independent implementation of the same equations in Python";

/// Why the claims could not be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClaimError {
    /// A parameter set did not load.
    #[error(transparent)]
    Pair(#[from] SetError),
    /// A calculation had no solution.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Every claim about tool wear, computed now, in units that people read; the claim names them.
///
/// # Errors
/// [`ClaimError`] where a parameter set or a calculation fails.
///
/// # Examples
/// ```
/// let claims = toolroom_wear::claims().unwrap();
/// assert!(claims.len() > 15 && claims.iter().all(|claim| claim.pass()));
/// ```
pub fn claims() -> Result<Vec<Claim>, ClaimError> {
    let mut table = paper()?;
    table.extend(handbook()?);
    table.extend(reference()?);
    Ok(table)
}

fn claim(claim: &str, source: &str, published: f64, computed: f64, tolerance: f64) -> Claim {
    Claim { claim: claim.to_owned(), source: source.to_owned(), published, computed, tolerance }
}

fn paper() -> Result<Vec<Claim>, ClaimError> {
    let pair = Pair::named("ni_vk6om")?;
    let cut = pair.reference_cut();
    let life_at = |wear: f64| pair.life(&cut.at_speed(pair.minimum_wear_speed(&cut, wear)));
    let mode_1 = pair.minimum_wear_life(&cut);
    let equal = |wear: f64| -> Result<f64, ModelError> {
        let constant = life_at(wear);
        Ok(pair.equal_life_optimum(&cut, constant.cutting_time)?.life.path / constant.path)
    };
    let figure = Pair::named("ni_vk8")?;
    let figure_cut = Cut::nominal(1.0, 0.11e-3, 0.5e-3);
    let minimum = |wear: f64| figure.point(&figure_cut.at_speed(figure.minimum_wear_speed(&figure_cut, wear)), wear);
    Ok(vec![
        claim(
            "variable speed of least wear makes tool life almost twice that at v0, here v*(0.2 mm) (demonstration: ni_vk6om was chosen to land here)",
            PAPER,
            2.0,
            mode_1.cutting_time / life_at(0.2e-3).cutting_time,
            0.05,
        ),
        claim(
            "at equal tool life the mean speed is 1.5 to 1.8 times v0, here v*(0.5 mm), a worn tool's (demonstration: no single v0 meets this and the doubled life)",
            PAPER,
            1.65,
            equal(0.5e-3)?,
            0.15 / 1.65,
        ),
        claim(
            "at equal tool life the mean speed is 1.5 to 1.8 times v0, here v*(0.6 mm), a spent tool's (demonstration, as above)",
            PAPER,
            1.65,
            equal(0.6e-3)?,
            0.15 / 1.65,
        ),
        claim(
            "Fig. 2: wear per path of a new edge is least between 770 and 1370 K (demonstration: levels assumed) [K]",
            PAPER,
            1070.0,
            minimum(0.0).temperature,
            300.0 / 1070.0,
        ),
        claim(
            "Fig. 2: the same at 0.6 mm of flank wear [K]",
            PAPER,
            1070.0,
            minimum(0.6e-3).temperature,
            300.0 / 1070.0,
        ),
        claim(
            "Fig. 2: least wear at 0.2 mm lies on the figure's axis, 1 to 5 um/m [um/m]",
            PAPER,
            3.0,
            minimum(0.2e-3).wear_intensity * 1e6,
            2.0 / 3.0,
        ),
    ])
}

/// The speed (m/min) within the limits at which an edge lasts `minutes`; life falls with speed
/// there.
fn speed_for_life(pair: &Pair, cut: &Cut, minutes: f64) -> f64 {
    let (low, high) = (pair.limits.lowest_speed, pair.limits.highest_speed);
    60.0 * crate::search::root(low, high, |speed| pair.life(&cut.at_speed(speed)).cutting_time - minutes * 60.0)
}

/// Slope of ln T in ln v.
fn taylor_slope(pair: &Pair, cut: &Cut, speed: f64) -> f64 {
    let ln_life = |share: f64| pair.life(&cut.at_speed(speed * share)).cutting_time.ln();
    (ln_life(1.01) - ln_life(1.0 / 1.01)) / (2.0 * 1.01f64.ln())
}

fn handbook() -> Result<Vec<Claim>, ClaimError> {
    let steel = Pair::named("c45_t15k6")?;
    let steel_cut = steel.reference_cut();
    let nickel = Pair::named("ni_vk6om_hb")?;
    let nickel_cut = nickel.reference_cut();
    let titanium = Pair::named("ti_vk6")?;
    let titanium_cut = titanium.reference_cut();
    let best = |pair: &Pair, cut: &Cut| pair.best_constant_speed(cut, Objective::Path).cutting_speed;
    let default = Pair::named("ni_vk6om")?;
    let scatter = Scatter::shop().life_moments(&default, &default.reference_cut().at_speed(0.5));
    let steel_speed = |minutes: f64| 420.0 / (f64::powf(minutes, 0.2) * 1.5f64.powf(0.15) * 0.3f64.powf(0.2));
    Ok(vec![
        claim(
            "steel, T15K6: speed for 60 min of tool life (by construction: the set was calibrated to it) [m/min]",
            HANDBOOK,
            steel_speed(60.0),
            speed_for_life(&steel, &steel_cut, 60.0),
            0.03,
        ),
        claim(
            "steel, T15K6: speed for 27 min of tool life (tests the slope only) [m/min]",
            HANDBOOK,
            steel_speed(27.0),
            speed_for_life(&steel, &steel_cut, 27.0),
            0.03,
        ),
        claim(
            "steel, T15K6: contact temperature at 180 m/min, thermocouple scale 148.8 v^0.4 s^0.24 t^0.1 degC [K]",
            HANDBOOK,
            148.8 * 180f64.powf(0.4) * 0.3f64.powf(0.24) * 1.5f64.powf(0.1) + 273.15,
            steel.point(&steel_cut, 0.2e-3).temperature,
            0.06,
        ),
        claim(
            "nickel alloy, slope of the handbook: speed for 20 min of tool life [m/min]",
            HANDBOOK,
            110.0 * 0.28 / (20f64.powf(0.2) * 0.75f64.powf(0.2) * 0.12f64.powf(0.45)),
            speed_for_life(&nickel, &nickel_cut, 20.0),
            0.15,
        ),
        claim(
            "nickel alloy: slope of ln T in ln v at 1.5 times the best constant speed (by construction)",
            HANDBOOK,
            -5.0,
            taylor_slope(&nickel, &nickel_cut, 1.5 * best(&nickel, &nickel_cut)),
            0.15,
        ),
        claim(
            "titanium: tool life falls about 4 % per 1 % of speed (milling), at twice the best constant speed",
            "Tatar 2020",
            -4.0,
            taylor_slope(&titanium, &titanium_cut, 2.0 * best(&titanium, &titanium_cut)),
            0.20,
        ),
        claim(
            "coefficient of variation of tool life in a shop (by construction: edge scatter was calibrated to it)",
            "Wager & Barash 1971, abstract; Machinery's Handbook 31, p. 139",
            0.3,
            scatter.variation,
            0.10,
        ),
    ])
}

fn reference() -> Result<Vec<Claim>, ClaimError> {
    let pair = Pair::named("ni_vk6om")?;
    let cut = pair.reference_cut();
    let best = pair.best_constant_speed(&cut, Objective::Path);
    let mode_1 = pair.minimum_wear_life(&cut);
    let run = pair.run(&WearState::default(), |_, _| cut, 1e5, 1e-9)?;
    let mut separable = pair.clone();
    separable.temperature.flank_heating = 0.0;
    if let WearLaw::EnergyBalance(law) = &mut separable.law {
        law.run_in_land = 0.0;
        law.heated_layer_land = f64::INFINITY;
    }
    let constant = separable.best_constant_speed(&cut, Objective::Path);
    Ok(vec![
        claim(
            "minimum-wear speed at 0.2 mm [m/min]",
            REFERENCE,
            39.99782,
            pair.minimum_wear_speed(&cut, 0.2e-3) * 60.0,
            1e-6,
        ),
        claim(
            "tool life at 40 m/min, quasi-steady [min]",
            REFERENCE,
            14.932164,
            pair.life(&cut).cutting_time / 60.0,
            1e-6,
        ),
        claim(
            "tool life at 40 m/min, cold start, integrated in time [min]",
            REFERENCE,
            14.77972,
            run.elapsed / 60.0,
            1e-6,
        ),
        claim("best constant speed for path [m/min]", REFERENCE, 30.430343, best.cutting_speed * 60.0, 1e-6),
        claim(
            "fair baseline: life under least wear against the best constant speed",
            REFERENCE,
            30.38734 / 22.619192,
            mode_1.cutting_time / best.life.cutting_time,
            1e-4,
        ),
        claim(
            "fair baseline: path under least wear against the best constant speed",
            REFERENCE,
            1070.5715 / 688.30976,
            mode_1.path / best.life.path,
            1e-4,
        ),
        claim(
            "a law separable in speed and wear (Taylor, Miner) gains nothing by variable speed",
            "optimal control: the Hamiltonian of such a law does not depend on wear",
            1.0,
            separable.minimum_wear_life(&cut).path / constant.life.path,
            1e-7,
        ),
        claim(
            "with 2 min per edge change, least wear makes less per time than the best constant speed",
            REFERENCE,
            33.1 / 44.1,
            mode_1.production_rate(120.0)
                / pair.best_constant_speed(&cut, Objective::Rate { change_time: 120.0 }).life.production_rate(120.0),
            2e-3,
        ),
    ])
}
