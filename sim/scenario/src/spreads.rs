//! How well the parameters of a tool are known before any records of its own.

use super::posterior::{Posterior, with_group};
use crate::ProcessModel;
use std::collections::BTreeMap;
use toolroom_process::unit;
use toolroom_wear::{ParameterSet, Scatter, Spread};

/// Draws that are looked at for the spread of the wear level (assumption: it is then known to 4 %).
const LOOKED: usize = 400;

/// Standard deviations of logarithms, as draws of a posterior or the section `[prior]` of a parameter set give them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spreads {
    /// Of parameters, by `group.parameter`.
    pub parameters: BTreeMap<String, f64>,
    /// Of the wear rate at the reference cut of the set; `None` where nothing is known of it.
    pub wear_level: Option<f64>,
}

impl Spreads {
    /// Those of draws for the parameters of `process`.
    pub fn of_draws(posterior: &Posterior, process: &ProcessModel) -> Self {
        let logarithms = |values: Vec<f64>| deviation(values.into_iter().map(f64::ln));
        let spread_of = |name: &String| Some((name.clone(), logarithms(posterior.values(name)?)?));
        let step = posterior.count().div_ceil(LOOKED);
        let lives = posterior.each().step_by(step).filter_map(|draw| {
            let mut drawn = process.clone();
            posterior.put(draw, &mut drawn, &mut Scatter::none());
            reference_life(&drawn)
        });
        Self {
            parameters: posterior.names().iter().filter_map(spread_of).collect(),
            wear_level: logarithms(lives.collect()).filter(|level| *level > 0.0),
        }
    }

    /// Those of the section `[prior]` of a set, of which `process` has the values.
    pub fn of_set(set: &ParameterSet, process: &ProcessModel) -> Self {
        let value_of = |key: &String| set.values.iter().find(|value| value.key() == *key);
        let spread = |key: &String, spread: &Spread| {
            let value = value_of(key)?;
            match *spread {
                Spread::Factor(factor) => Some(factor.ln()),
                Spread::Deviation(deviation) => {
                    let shown = unit::convert(value.value, value.field.unit, value.field.display);
                    Some(deviation / shown).filter(|relative| *relative > 0.0 && relative.is_finite())
                }
            }
        };
        let parameters: BTreeMap<String, f64> =
            set.prior.iter().filter_map(|(key, own)| Some((key.clone(), spread(key, own)?))).collect();
        // The parameters of a set are known independently of each other.
        let group = match process {
            ProcessModel::Turning(turning) => Some(turning.pair.law.group()),
            ProcessModel::Milling(_) => Some("life"),
            ProcessModel::Infeed(_) | ProcessModel::Other(_) => None,
        };
        let moved = |(key, deviation): (&String, &f64)| {
            let (group_name, name) = key.split_once('.')?;
            let value = value_of(key).filter(|_| group == Some(group_name))?;
            let life = |sign: f64| {
                let mut process = process.clone();
                with_group(&mut process, value.group, |record| {
                    let place = record.fields().iter().position(|field| field.name == name)?;
                    record.set_value(place, value.value * (sign * deviation).exp())
                })??;
                reference_life(&process)
            };
            Some((0.5 * (life(1.0)? / life(-1.0)?).ln()).powi(2)).filter(|square| square.is_finite())
        };
        let squares: f64 = parameters.iter().filter_map(moved).sum();
        Self { wear_level: Some(squares.sqrt()).filter(|level| *level > 0.0), parameters }
    }

    /// These, and those of `other` where these say nothing.
    #[must_use]
    pub fn or(self, mut other: Self) -> Self {
        other.parameters.extend(self.parameters);
        Self { wear_level: self.wear_level.or(other.wear_level), parameters: other.parameters }
    }
}

/// Life in s of a nominal edge at the cut to which the set belongs.
fn reference_life(process: &ProcessModel) -> Option<f64> {
    let life = match process {
        ProcessModel::Turning(turning) => turning.pair.life(&turning.pair.reference_cut()).cutting_time,
        ProcessModel::Milling(milling) => milling.life.reference_life,
        ProcessModel::Infeed(_) | ProcessModel::Other(_) => return None,
    };
    (life > 0.0 && life.is_finite()).then_some(life)
}

/// Standard deviation; `None` of fewer than two values and where one is not finite.
fn deviation(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    Some((squares / (count - 1.0)).sqrt()).filter(|deviation| deviation.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DrawTable;
    use std::sync::Arc;
    use toolroom_cutting::Turning;
    use toolroom_wear::{Pair, TURNING_SETS};

    const OWN: &str = "schema = 1\nname = \"own\"\ntitle = \"own\"\nprocess = \"turning\"\nbased_on = \"c45_t15k6\"\n\
                       law = \"extended_taylor\"\n[parameters.extended_taylor]\n\
                       reference_life = { value = \"30 min\", source = \"test\" }\n\
                       reference_speed = { value = \"220 m/min\", source = \"test\" }\n\
                       reference_feed = { value = \"0.3 mm/rev\", source = \"test\" }\n\
                       reference_depth = { value = \"1.5 mm\", source = \"test\" }\n\
                       speed_exponent = { value = \"5\", source = \"test\" }\n\
                       feed_exponent = { value = \"1.2\", source = \"test\" }\n\
                       depth_exponent = { value = \"0.6\", source = \"test\" }\n\
                       wear_limit = { value = \"0.3 mm\", source = \"test\" }\n\
                       [prior]\n\"extended_taylor.reference_life\" = { factor = 1.5 }\n\
                       \"extended_taylor.feed_exponent\" = { deviation = 0.3 }\n\
                       \"force.specific_force\" = { factor = 1.2 }\n";

    fn own() -> (ParameterSet, ProcessModel) {
        let set = ParameterSet::parse("own.toml", OWN, &TURNING_SETS).expect("a set");
        let pair = Pair::of_set(&set).expect("a pair");
        (set, ProcessModel::Turning(Arc::new(Turning { pair, ..Turning::default() })))
    }

    #[test]
    fn the_section_prior_of_a_set_says_how_well_force_and_wear_are_known() {
        let (set, process) = own();
        let known = Spreads::of_set(&set, &process);
        assert!((known.parameters["force.specific_force"] - 1.2_f64.ln()).abs() < 1e-12);
        // A Taylor life is its level at the cut to which it belongs; exponents turn about it.
        assert!((known.wear_level.expect("a level") - 1.5_f64.ln()).abs() < 1e-3, "{known:?}");
        assert!(Spreads::of_set(&ParameterSet { prior: BTreeMap::new(), ..set }, &process) == Spreads::default());
    }

    #[test]
    fn draws_go_before_the_section_prior_and_fill_what_it_leaves_out() {
        let (set, process) = own();
        let lives = ["25", "30", "36"];
        let header = vec!["extended_taylor.reference_life [min]".to_owned()];
        let table = DrawTable { header, rows: lives.iter().map(|life| vec![(*life).to_owned()]).collect() };
        let posterior = Posterior::of(&table, &process, false).expect("draws");
        let drawn = Spreads::of_draws(&posterior, &process);
        let expected = deviation([25.0_f64, 30.0, 36.0].into_iter().map(f64::ln)).expect("a deviation");
        assert!((drawn.wear_level.expect("a level") - expected).abs() < 1e-6, "{drawn:?} {expected}");
        let both = drawn.or(Spreads::of_set(&set, &process));
        assert!((both.parameters["extended_taylor.reference_life"] - expected).abs() < 1e-9);
        assert!((both.parameters["force.specific_force"] - 1.2_f64.ln()).abs() < 1e-12);
    }
}
