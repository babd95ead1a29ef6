//! Published numbers of life statistics beside computed ones.

use super::fit::fit;
use super::law::{Family, Law};
use super::regression::regress;
use super::replacement::Costs;
use super::sample::{Observation, Sample, SampleError};
use toolroom_process::Claim;

/// Claims about fits and replacement.
///
/// # Errors
/// [`SampleError`], which would be a fault of the data in here.
pub fn claims() -> Result<Vec<Claim>, SampleError> {
    let mut claims = Vec::new();
    let mut add = |claim: String, source: &str, published: f64, computed: f64, tolerance: f64| {
        claims.push(Claim { claim, source: source.to_owned(), published, computed, tolerance });
    };
    // J. Lieblein, M. Zelen, J. Research NBS 57 (1956) 273.
    let bearings = [
        17.88, 28.92, 33.00, 41.52, 42.12, 45.60, 48.40, 51.84, 51.96, 54.12, 55.56, 67.80, 68.64, 68.64, 68.88, 84.12,
        93.12, 98.64, 105.12, 105.84, 127.92, 128.04, 173.40,
    ];
    let sample = Sample::new(bearings.map(Observation::Failed))?;
    let lawless = "Lawless 1982, data of Lieblein & Zelen 1956";
    if let Law::Weibull { shape, scale } = fit(&sample, Family::Weibull)?.law {
        add("Weibull shape of 23 ball bearings".to_owned(), lawless, 2.10, shape, 2e-3);
        add("their Weibull scale, 10^6 revolutions".to_owned(), lawless, 81.88, scale, 1e-3);
    }
    // Two points on a line of no scatter: a thousandth of it keeps the likelihood finite.
    let lives = [5.0, 41.0].iter().flat_map(|life| [life * 1.001, life / 1.001]).map(Observation::Failed);
    let rows: Vec<Vec<f64>> = [160.0f64, 160.0, 100.0, 100.0].iter().map(|speed| vec![speed.ln()]).collect();
    if let Ok(law) = regress(["ln v"], &rows, &Sample::new(lives)?) {
        let life = law.predict(&[130f64.ln()], 0.9).median;
        let groover = "Groover, Fundamentals of Modern Manufacturing, ex. 22.1";
        add(
            "Taylor exponent through (160 m/min, 5 min) and (100, 41)".to_owned(),
            groover,
            0.2234,
            -law.coefficients[1].recip(),
            1e-3,
        );
        add("life at 130 m/min on that line, min".to_owned(), groover, 12.7, life, 5e-3);
    }
    let barlow = "policy of Barlow & Hunter 1960, computed independently";
    for (shape, failure, age, saving) in
        [(2.0, 5.0, 0.5107, 0.276), (3.0, 5.0, 0.5026, 0.459), (4.08, 5.0, 0.5414, 0.552), (4.08, 10.0, 0.4434, 0.728)]
    {
        let best = Costs { planned: 1.0, failure }.best_age(&Law::Weibull { shape, scale: 1.0 });
        let case = format!("Weibull shape {shape}, failure {failure} times as dear");
        // Four digits are published: half of the last one.
        add(format!("best age of replacement over the scale, {case}"), barlow, age, best.age, 0.5e-4 / age);
        add(format!("what it saves against running to failure, {case}"), barlow, saving, best.saving(), 2e-3);
    }
    Ok(claims)
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_claim_holds() {
        let claims = super::claims().unwrap();
        assert!(claims.len() >= 12);
        for claim in claims {
            assert!(claim.pass(), "{claim:?}");
        }
    }
}
