//! Laws of lives that `toolroom life` has fitted, as random times of a shop.

use super::fault::ScenarioFault;
use serde_json::Value;
use std::sync::Arc;
use toolroom_form::{Section, Walk, nearest};
use toolroom_process::unit::convert;
use toolroom_scenario::{Distribution, Empirical};

/// Laws that a summary may hold, by their words there.
pub(super) const LAWS: &[&str] =
    &["weibull", "weibull_3", "lognormal", "normal", "gamma", "inverse_gaussian", "competing_risks"];

/// Equally likely times that stand for a law without a family of its own here: each for a share of 1/4000, so that a share of
/// all lives is met to 1/8000 (assumption: no replication draws so many edges that it could be seen).
const TIMES: usize = 4000;

/// The law that the table names; a time that is no number where a fault was noted.
pub(super) fn law(walk: &mut Walk, table: &Section<'_>) -> Distribution {
    let none = Distribution::Constant(f64::NAN);
    let Some(file) = table.text("from") else { return none };
    let path = walk.folder.join(file);
    let text = std::fs::read_to_string(&path).map_err(|error| error.to_string());
    walk.named(path);
    let summary = text.and_then(|text| serde_json::from_str::<Value>(&text).map_err(|error| error.to_string()));
    let found = summary.and_then(|summary| chosen(&summary, table.text("law"), table.text("group")));
    found.unwrap_or_else(|reason| {
        walk.fault(table.span_of("from"), ScenarioFault::FittedLaw { file: file.to_owned(), reason });
        none
    })
}

/// The law of a group of a summary.
fn chosen(summary: &Value, law: Option<&str>, group: Option<&str>) -> Result<Distribution, String> {
    let of_group = match group {
        None => summary,
        Some(wanted) => {
            let groups = summary["groups"].as_array().map_or(&[][..], Vec::as_slice);
            let name = |group: &Value| group["group"].as_str().map(str::to_owned);
            let names: Vec<String> = groups.iter().filter_map(name).collect();
            let near =
                nearest(wanted, names.iter().map(String::as_str)).map(|near| format!("; did you mean `{near}`?"));
            let unknown = || format!("no group `{wanted}`; there are {}{}", listed(&names), near.unwrap_or_default());
            groups.iter().find(|group| name(group).as_deref() == Some(wanted)).ok_or_else(unknown)?
        }
    };
    let fits = of_group["fits"].as_array().filter(|fits| !fits.is_empty()).ok_or("it has no fitted laws")?;
    let word = |fit: &Value| fit["distribution"].as_str().unwrap_or_default().to_owned();
    let fit = match law {
        None => &fits[0],
        Some(wanted) => {
            let words: Vec<String> = fits.iter().map(word).collect();
            fits.iter()
                .find(|fit| word(fit) == wanted)
                .ok_or_else(|| format!("the law `{wanted}` was not fitted; there are {}", listed(&words)))?
        }
    };
    read(&word(fit), &fit["parameters"])
}

fn listed(words: &[String]) -> String {
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

/// A law by its word and its parameters, ages in the unit that their keys name.
fn read(word: &str, parameters: &Value) -> Result<Distribution, String> {
    let number = |name: &str| {
        let value = parameters[name].as_f64().filter(|value| value.is_finite() && *value > 0.0);
        value.ok_or_else(|| format!("the law `{word}` has no usable `{name}`"))
    };
    let age = |name: &str| {
        let keys = parameters.as_object().into_iter().flatten();
        let named = |key: &str| {
            key.strip_prefix(name).and_then(|rest| Some(rest.strip_prefix(" [")?.strip_suffix(']')?.to_owned()))
        };
        let (unit, value) = keys
            .filter_map(|(key, value)| Some((named(key)?, value.as_f64()?)))
            .next()
            .ok_or_else(|| format!("the law `{word}` has no `{name}` with a unit"))?;
        let seconds = convert(value, &unit, "s");
        if seconds.is_finite() && seconds >= 0.0 {
            Ok(seconds)
        } else {
            Err(format!(
                "`{name} [{unit}]` is {value}, which is no time: lives in cuts or parts do not tell how long an edge works"
            ))
        }
    };
    let weibull = |shape: f64, scale: f64| Distribution::Weibull { mean: scale * weibull_mean(shape), shape };
    let lognormal = |median: f64, sigma: f64| {
        let variance = sigma * sigma;
        Distribution::Lognormal { mean: median * (0.5 * variance).exp(), cv: variance.exp_m1().sqrt() }
    };
    match word {
        "weibull" => Ok(weibull(number("shape")?, age("scale")?)),
        "lognormal" => Ok(lognormal(age("median")?, number("sigma")?)),
        // No edge lasts less than no time: what the law has below zero is cut off.
        "normal" => {
            Ok(Distribution::Normal { mean: age("mean")?, sd: age("deviation")?, low: 0.0, high: f64::INFINITY })
        }
        "gamma" => {
            let (shape, scale) = (number("shape")?, age("scale")?);
            Ok(Distribution::Gamma { mean: shape * scale, cv: shape.sqrt().recip() })
        }
        "weibull_3" => {
            let (law, location) = (weibull(number("shape")?, age("scale")?), age("location")?);
            Ok(tabulated(|u| location + law.quantile(u)))
        }
        "inverse_gaussian" => {
            let (mean, shape) = (age("mean")?, age("shape")?);
            Ok(tabulated(|u| inverse(u, mean, |time| inverse_gaussian(time, mean, shape))))
        }
        "competing_risks" => {
            let wear = lognormal(age("wear_median")?, number("wear_sigma")?);
            let chipping = weibull(number("chipping_shape")?, age("chipping_scale")?);
            let ended = |time: f64| 1.0 - (1.0 - wear.share_below(time)) * (1.0 - chipping.share_below(time));
            let typical = wear.quantile(0.5).min(chipping.quantile(0.5));
            Ok(tabulated(|u| inverse(u, typical, ended)))
        }
        other => Err(format!("`{other}` is no law that a shop knows; it knows {}", LAWS.join(", "))),
    }
}

/// Mean of a Weibull law of scale 1: a law of mean 1 has its quantile at the share 1 − 1/e where its scale is.
fn weibull_mean(shape: f64) -> f64 {
    Distribution::Weibull { mean: 1.0, shape }.quantile(-(-1.0_f64).exp_m1()).recip()
}

/// Equally likely times of a law, by its quantiles.
fn tabulated(quantile: impl Fn(f64) -> f64) -> Distribution {
    let times: Vec<(f64, f64)> = (0..TIMES).map(|i| (quantile((i as f64 + 0.5) / TIMES as f64), 1.0)).collect();
    Distribution::Empirical(Arc::new(Empirical::new(&times)))
}

/// The time before which a share `u` has ended, by bisection of its logarithm.
fn inverse(u: f64, typical: f64, ended: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (typical, typical);
    while ended(low) > u && low > f64::MIN_POSITIVE {
        low *= 0.5;
    }
    while ended(high) < u && high < f64::MAX / 4.0 {
        high *= 2.0;
    }
    while high / low > 1.0 + 1e-12 {
        let middle = (low * high).sqrt();
        if middle <= low || middle >= high {
            break;
        }
        *(if ended(middle) < u { &mut low } else { &mut high }) = middle;
    }
    (low * high).sqrt()
}

/// Share of an inverse Gaussian law below `time`.
///
/// # Source
/// J. Shuster, Journal of the American Statistical Association 63 (1968) 1514.
fn inverse_gaussian(time: f64, mean: f64, shape: f64) -> f64 {
    let normal = Distribution::Normal { mean: 0.0, sd: 1.0, low: f64::NEG_INFINITY, high: f64::INFINITY };
    let root = (shape / time).sqrt();
    let (near, far) = (root * (time / mean - 1.0), root * (time / mean + 1.0));
    // The product of a large and a small number by the series of the tail, whose next term is 3/far⁴.
    let second = if far > 20.0 {
        (-0.5 * near * near).exp() / (2.0 * std::f64::consts::PI).sqrt() / far * (1.0 - far.powi(-2))
    } else {
        (2.0 * shape / mean).exp() * normal.share_below(-far)
    };
    (normal.share_below(near) + second).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Laws with quantiles at 10, 50 and 90 % in minutes, by their distribution functions in another language.
    fn laws() -> Vec<(&'static str, Value, [f64; 3])> {
        vec![
            ("weibull", json!({ "shape": 2.6, "scale [min]": 41.0 }), [17.254, 35.609, 56.506]),
            ("lognormal", json!({ "median [min]": 30.0, "sigma": 0.4 }), [17.968, 30.000, 50.090]),
            ("gamma", json!({ "shape": 4.0, "scale [h]": 0.1 }), [10.469, 22.032, 40.085]),
            (
                "weibull_3",
                json!({ "shape": 1.5, "scale [min]": 20.0, "location [min]": 10.0 }),
                [14.462, 25.664, 44.874],
            ),
            ("inverse_gaussian", json!({ "mean [min]": 30.0, "shape [min]": 170.0 }), [16.444, 27.595, 46.627]),
        ]
    }

    #[test]
    fn fitted_laws_have_the_quantiles_that_were_computed_independently() {
        for (word, parameters, expected) in laws() {
            let law = read(word, &parameters).unwrap_or_else(|reason| panic!("{reason}"));
            for (share, expected) in [0.1, 0.5, 0.9].into_iter().zip(expected) {
                let minutes = law.quantile(share) / 60.0;
                assert!((minutes / expected - 1.0).abs() < 1e-3, "{word} at {share}: {minutes}, not {expected}");
            }
        }
    }

    #[test]
    fn the_earlier_of_two_risks_is_reached_by_the_product_of_both() {
        let parameters = json!({ "wear_median [min]": 40.0, "wear_sigma": 0.2, "chipping_shape": 1.3, "chipping_scale [min]": 60.0 });
        let law = read("competing_risks", &parameters).unwrap_or_else(|reason| panic!("{reason}"));
        // At the median of wear half of the edges that have not chipped by then are worn out.
        let good = 0.5 * (-(40.0_f64 / 60.0).powf(1.3)).exp();
        assert!((law.share_below(2400.0) - (1.0 - good)).abs() < 1e-3);
    }

    #[test]
    fn a_law_that_is_not_there_and_a_life_that_is_no_time_are_refused_in_words() {
        let fit = |word: &str, parameters: Value| json!({ "distribution": word, "parameters": parameters });
        let summary = json!({
            "fits": [fit("weibull", json!({ "shape": 2.0, "scale [cuts]": 300.0 }))],
            "groups": [{ "group": "steel", "fits": [fit("lognormal", json!({ "median [min]": 30.0, "sigma": 0.3 }))] }],
        });
        let refused = |law, group| chosen(&summary, law, group).expect_err("a fault");
        assert!(refused(None, None).contains("no time"), "{}", refused(None, None));
        assert!(refused(Some("gamma"), None).contains("there are weibull"));
        assert!(refused(None, Some("steal")).contains("did you mean `steel`?"));
        assert!(chosen(&summary, None, Some("steel")).is_ok());
    }
}
