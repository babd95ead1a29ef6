//! What a set and a file of priors say of parameters before any data.

use crate::base::Base;
use crate::channel::{Channel, ChannelModel};
use crate::law::Law;
use crate::model::Model;
use crate::parameter::{Parameter, Prior, Scale};
use crate::wear_model::{EDGE_SCATTER, of_edges};
use toolroom_process::unit;
use toolroom_wear::{ParameterSet, Spread};

/// Step of a working coordinate by which the slope of its value is found.
const STEP: f64 = 1e-4;

/// Every parameter that a calibration of these laws around a set may fit, with the prior that it has unless `[prior]` says more.
pub(crate) fn parameters(base: &Base, laws: &[Law], limit: f64) -> Vec<Parameter> {
    let of_laws = laws.iter().flat_map(|law| law.parameters(&law.template(base, limit)));
    let mut all: Vec<Parameter> = of_laws.chain(of_edges()).collect();
    if let Base::Turning { pair, .. } = base {
        for (channel, thermocouple) in
            Channel::ALL.into_iter().map(|channel| (channel, false)).chain([(Channel::ThermoEmf, true)])
        {
            let model = ChannelModel::from_channel(channel, pair, Vec::new(), None, thermocouple);
            let unknown = |parameter: &&Parameter| all.iter().all(|known| known.name != parameter.name);
            let new: Vec<Parameter> = model.parameters().iter().filter(unknown).cloned().collect();
            all.extend(new);
        }
    }
    all
}

/// How well a parameter is known by `[prior]`, in its working coordinate and around the value of the set. The mean is NaN where it is that
/// of the parameter anyway.
///
/// A `deviation` stands in the unit of the file and is carried over to first order at that value; a `factor` is one of the value.
pub(crate) fn prior(parameter: &Parameter, spread: Spread, set: &ParameterSet) -> Prior {
    let of_set = |key: &str| {
        let value = set.values.iter().find(|value| value.key() == key)?;
        Some(unit::convert(value.value, value.field.unit, value.field.display))
    };
    let mean = match parameter.scale {
        // Exponents of a set of another law are those of the parameter.
        Scale::Plain => of_set(&parameter.name),
        Scale::Logarithm if parameter.name == EDGE_SCATTER => {
            set.scatter.map(|scatter| scatter.common_wear.ln()).filter(|mean| mean.is_finite())
        }
        Scale::Logarithm | Scale::Contrast | Scale::Tilt => None,
    };
    let u = mean.unwrap_or(parameter.prior.mean);
    let scale = parameter.scale;
    let slope = match scale {
        Scale::Plain => 1.0,
        Scale::Logarithm => scale.value(u),
        Scale::Contrast | Scale::Tilt => (scale.value(u + STEP) - scale.value(u - STEP)) / (2.0 * STEP),
    };
    let deviation = match spread {
        Spread::Factor(factor) => factor.ln().abs() * scale.value(u).abs() / slope,
        // The coordinate counts a tilt in shares of what the contrast leaves it.
        Spread::Deviation(deviation) if scale == Scale::Tilt => {
            let contrast =
                parameter.name.split_once('.').and_then(|(group, _)| of_set(&format!("{group}.stage_contrast")));
            deviation / (1.0 - contrast.unwrap_or(0.0)) / slope
        }
        Spread::Deviation(deviation) => deviation / slope,
    };
    Prior { mean: mean.unwrap_or(f64::NAN), deviation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_wear::{Pair, TURNING_SETS};

    const SET: &str = r#"schema = 1
name = "ours"
title = "calibrated before"
process = "turning"
based_on = "c45_t15k6"
law = "extended_taylor"
[parameters.extended_taylor]
reference_life = { value = "40 min", source = "ours" }
speed_exponent = { value = 4.2, source = "ours" }
feed_exponent = { value = 1.1, source = "ours" }
depth_exponent = { value = 0.5, source = "ours" }
hardness_exponent = { value = 1.0, source = "ours" }
stage_contrast = { value = 0.7, source = "ours" }
stage_tilt = { value = 0.0, source = "ours" }
wear_limit = { value = "0.3 mm", source = "ours" }
reference_speed = { value = "180 m/min", source = "ours" }
reference_feed = { value = "0.3 mm/rev", source = "ours" }
reference_depth = { value = "1.5 mm", source = "ours" }
[parameters.limits]
wear_limit = { value = "0.3 mm", source = "ours" }
[prior]
"extended_taylor.reference_life" = { deviation = 2.0 }
"extended_taylor.speed_exponent" = { factor = 1.05 }
"extended_taylor.feed_exponent" = { deviation = 0.2 }
"extended_taylor.stage_contrast" = { deviation = 0.03 }
"temperature.speed_exponent" = { deviation = 0.02 }
edge_scatter = { factor = 1.2 }
reading_noise = { factor = 1.1 }
[scatter]
common_wear = 0.14
"#;

    #[test]
    fn priors_of_a_set_lie_around_its_values_in_the_units_of_files() {
        let set = ParameterSet::parse("ours.toml", SET, &TURNING_SETS).expect("a set");
        let pair = Pair::of_set(&set).expect("a pair");
        let all = parameters(&Base::from(&pair), &[Law::ExtendedTaylor], 0.3);
        let of = |name: &str| {
            let parameter = all.iter().find(|parameter| parameter.name == name).unwrap_or_else(|| panic!("{name}"));
            let told = prior(parameter, set.prior[name], &set);
            // What calibrations start from, where no spread is told: the value of the set.
            Prior { mean: if told.mean.is_nan() { parameter.prior.mean } else { told.mean }, ..told }
        };
        // Standard deviations of logarithms and exponents; of the contrast by the derivative of its logit, 0.95/(0.7·0.25).
        for (name, mean, deviation) in [
            ("extended_taylor.reference_life", 40f64.ln(), 2.0 / 40.0),
            ("extended_taylor.speed_exponent", 4.2f64.ln(), 1.05f64.ln()),
            ("extended_taylor.feed_exponent", 1.1, 0.2),
            ("extended_taylor.stage_contrast", (0.7f64 / 0.25).ln(), 0.03 * 0.95 / (0.7 * 0.25)),
            ("temperature.speed_exponent", 0.4, 0.02),
            ("edge_scatter", 0.14f64.ln(), 1.2f64.ln()),
            ("reading_noise", 0.011f64.ln(), 1.1f64.ln()),
        ] {
            let found = of(name);
            assert!((found.mean - mean).abs() < 1e-6, "{name}: mean {} for {mean}", found.mean);
            assert!((found.deviation / deviation - 1.0).abs() < 1e-5, "{name}: {} for {deviation}", found.deviation);
        }
    }

    /// What a set does not say of other laws is that of the set on which it is based, however long the chain.
    #[test]
    fn laws_beside_the_one_of_a_set_are_as_in_the_set_that_it_is_based_on() {
        let set = ParameterSet::parse("ours.toml", SET, &TURNING_SETS).expect("a set");
        let base = Base::Turning {
            pair: Box::new(Pair::of_set(&set).expect("a pair")),
            others: Pair::other_laws(&set).into(),
        };
        let steel = Base::from(&Pair::named("c45_t15k6").expect("a shipped set"));
        for law in [Law::EnergyBalance, Law::TakeyamaMurata, Law::Usui] {
            let (ours, due) = (parameters(&base, &[law], 0.3), parameters(&steel, &[law], 0.3));
            assert_eq!(ours[..3], due[..3], "{}", law.group());
        }
    }
}
