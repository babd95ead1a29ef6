//! Lives of the four laws at constant conditions against an independent quadrature.
//!
//! Origin: independent implementation in Python, composite three-point Gauss rule on the grid
//! h ∝ u³ with 1000 and 4000 panels, which agree in all printed digits.

use toolroom_process::num_dual::{Dual64, first_derivative};
use toolroom_wear::{Cut, ExtendedTaylor, Pair, TakeyamaMurata, Usui, WearLaw};

/// Temperatures of steel C45 under a law whose parameters are round numbers.
fn steel(law: WearLaw) -> Pair {
    Pair { law, ..Pair::named("c45_t15k6").unwrap() }
}

fn diffusion() -> TakeyamaMurata {
    TakeyamaMurata {
        abrasive_wear: 0.01e-6,
        diffusion_wear_at_reference: 1.5e-6 / 60.0,
        activation_energy: 231.6e3,
        reference_temperature: 1140.8,
        run_in_land: 0.08e-3,
        ..TakeyamaMurata::default()
    }
}

fn tilted() -> ExtendedTaylor {
    ExtendedTaylor {
        reference_life: 1800.0,
        speed_exponent: 4.2,
        feed_exponent: 1.2,
        stage_contrast: 0.5,
        stage_tilt: -0.4,
        reference_speed: 220.0 / 60.0,
        ..ExtendedTaylor::default()
    }
}

/// Speed m/min; minutes to 0.12 and to 0.3 mm at 0.25 mm/rev and 2 mm; tolerance 1e-7.
#[test]
fn lives_agree_with_an_independent_quadrature() {
    #[rustfmt::skip]
    let table = [
        (WearLaw::Usui(Usui::default()), 160.0, 98.548700489, 198.041811491),
        (WearLaw::Usui(Usui::default()), 220.0, 10.641393523, 21.691780204),
        (WearLaw::Usui(Usui::default()), 320.0, 0.900908704, 1.873149079),
        (WearLaw::TakeyamaMurata(diffusion()), 160.0, 33.47360064, 99.951521497),
        (WearLaw::TakeyamaMurata(diffusion()), 220.0, 17.493405419, 38.858762888),
        (WearLaw::TakeyamaMurata(diffusion()), 320.0, 3.554402746, 5.936934978),
        (WearLaw::ExtendedTaylor(tilted()), 160.0, 54.106323952, 114.632042272),
        (WearLaw::ExtendedTaylor(tilted()), 220.0, 14.202889106, 30.09086675),
        (WearLaw::ExtendedTaylor(tilted()), 320.0, 2.943893175, 6.237061811),
    ];
    for (law, speed, first, whole) in table {
        let pair = steel(law);
        let cut = Cut::nominal(speed / 60.0, 0.25e-3, 2e-3);
        for (limit, minutes) in [(0.12e-3, first), (0.3e-3, whole)] {
            let life = pair.life_between(0.0, limit, |_| cut).cutting_time / 60.0;
            assert!((life / minutes - 1.0).abs() < 1e-7, "{} at {speed}: {life}, {minutes}", law.group());
        }
    }
}

/// The sum of reciprocal rates over a grid, refined, converges to the life with the square of
/// the panel: the trapezoidal rule over [`WearLaw::rate`].
#[test]
fn the_rate_alone_gives_the_life_as_the_grid_is_refined() {
    for law in [WearLaw::Usui(Usui::default()), WearLaw::TakeyamaMurata(diffusion()), WearLaw::ExtendedTaylor(tilted())]
    {
        let pair = steel(law);
        let cut = Cut::nominal(220.0 / 60.0, 0.25e-3, 2e-3);
        let contact = pair.contact(&cut);
        let exact = pair.life_between(0.0, 0.3e-3, |_| cut).cutting_time;
        let error = |panels: u32| {
            // Graded grid h ∝ k², as run-in asks for.
            let land = |k: u32| 0.3e-3 * (f64::from(k) / f64::from(panels)).powi(2);
            let slowness = |h: f64| law.rate(&cut, h, contact.steady_temperature(h)).recip();
            let panel = |k| (land(k + 1) - land(k)) * 0.5 * (slowness(land(k)) + slowness(land(k + 1)));
            (0..panels).map(panel).sum::<f64>() / exact - 1.0
        };
        let (coarse, fine) = (error(250), error(500));
        assert!(fine.abs() < 1e-5 && (coarse / fine - 4.0).abs() < 0.1, "{}: {coarse}, {fine}", law.group());
    }
}

/// Hot rates by the reference form and by the coefficient at infinite temperature are the same.
#[test]
fn the_reference_form_is_the_classic_form() {
    let law = diffusion();
    let infinite = law.diffusion_wear_at_reference
        * (law.activation_energy / (law.gas_constant * law.reference_temperature)).exp();
    let cut = Cut::nominal(3.0, 0.3e-3, 1.5e-3);
    for temperature in [900.0, 1140.8, 1500.0] {
        let rate = WearLaw::TakeyamaMurata(law).rate(&cut, 0.1e-3, temperature);
        let abrasion = law.abrasive_wear * 3.0 * (1.0 + 0.08 / 0.12);
        let diffusion = infinite * (-law.activation_energy / (law.gas_constant * temperature)).exp();
        assert!((rate / (abrasion + diffusion) - 1.0).abs() < 1e-12);
    }
}

/// More pressure on the flank wears a Usui edge faster in proportion; slopes by parameters are exact.
#[test]
fn usui_wears_in_proportion_to_pressure_and_its_slopes_are_exact() {
    let law = Usui::default();
    let cut = Cut::nominal(3.0, 0.3e-3, 1.5e-3);
    let pressed = Cut { flank_pressure_factor: 1.3, ..cut };
    let rate = WearLaw::Usui(law).rate(&cut, 0.1e-3, 1200.0);
    assert!((WearLaw::Usui(law).rate(&pressed, 0.1e-3, 1200.0) / rate - 1.3).abs() < 1e-12);
    let by_activation = |activation_temperature: Dual64| {
        let law = Usui { activation_temperature, ..law.map(Dual64::from) };
        WearLaw::Usui(law).rate(&cut.map(Dual64::from), 0.1e-3.into(), 1200.0.into())
    };
    let (_, slope) = first_derivative(by_activation, law.activation_temperature);
    let expected = -rate * (1.0 / 1200.0 - 1.0 / law.reference_temperature);
    assert!((slope / expected - 1.0).abs() < 1e-12);
}
