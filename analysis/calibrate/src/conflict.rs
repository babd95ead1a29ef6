//! Values that do not go with what was expected of them.

use crate::calibration::Calibration;
use crate::model::Model;
use crate::parameter::{Parameter, Prior, Scale};
use crate::sample::Posterior;
use crate::wear_model::READING_NOISE;
use toolroom_form::significant;

/// Standard deviations of a prior beyond which a value does not go with it (assumption: one value in 370 by chance).
const FAR: f64 = 3.0;

impl Calibration {
    /// What lies far from what the set says: mostly the unit of a column, or another material.
    pub(crate) fn far_from_priors(&self) -> Vec<String> {
        let wear = (self.carried().model.parameters(), &self.posterior);
        let channels = self.channels.iter().map(|fit| (fit.model.parameters(), &fit.posterior));
        let far = |(parameters, posterior): (&[Parameter], &Posterior)| {
            let one = |(parameter, u): (&Parameter, &f64)| {
                let Prior { mean, deviation } = parameter.prior;
                let off = (u - mean) / deviation;
                // Shapes of the wear curve and exponents of feed and depth have no unit that could be wrong.
                if off.abs() <= FAR || parameter.scale != Scale::Logarithm {
                    return None;
                }
                let name = &parameter.name;
                let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
                let [found, due] = [*u, mean].map(|u| significant(parameter.scale.value(u)));
                Some(if name == READING_NOISE {
                    let what = if off > 0.0 { "more" } else { "less" };
                    let look = "look for readings of another edge, of another unit, or rounded ones";
                    format!("readings scatter by {found}{unit}, far {what} than the usual {due}{unit}: {look}")
                } else {
                    let side = if off > 0.0 { "above" } else { "below" };
                    let deviations = off.abs();
                    format!(
                        "{name} is {found}{unit}, {deviations:.1} standard deviations {side} the {due}{unit} that were expected: \
                         check the units of the columns, whether --model is of your material, and whether one law holds for all"
                    )
                })
            };
            parameters.iter().zip(posterior.map.u.iter()).filter_map(one).collect::<Vec<String>>()
        };
        std::iter::once(wear).chain(channels).flat_map(far).collect()
    }
}
