//! The wear laws with their parameters and priors.

use crate::parameter::{Parameter, Prior, Scale};
use toolroom_wear::{Cut, EnergyBalance, ExtendedTaylor, Pair, WearLaw};

/// A wear law that can be calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Law {
    /// Taylor's law with a wear curve.
    ExtendedTaylor,
    /// Abrasion by path and diffusion by time.
    TakeyamaMurata,
    /// Adhesive wear by pressure, path and temperature.
    Usui,
    /// Two functionals, one of force and path, one of temperature and time.
    EnergyBalance,
}

/// Standard deviation of the logarithm of a level that comes from a handbook.
const LEVEL: f64 = 0.7;
/// Standard deviation of the logarithm of an activation energy.
const ENERGY: f64 = 0.25;
/// Minutes in SI.
const MINUTE: f64 = 60.0;
/// mm/min of a rate in m/s.
const MM_PER_MIN: f64 = 6e4;

impl Law {
    /// Every law, those of fewest parameters first.
    pub const ALL: [Self; 4] = [Self::Usui, Self::TakeyamaMurata, Self::EnergyBalance, Self::ExtendedTaylor];

    /// Name of its group in parameter files.
    pub fn group(self) -> &'static str {
        match self {
            Self::ExtendedTaylor => "extended_taylor",
            Self::TakeyamaMurata => "takeyama_murata",
            Self::Usui => "usui",
            Self::EnergyBalance => "energy_balance",
        }
    }

    /// The law of a group.
    pub fn of_group(group: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|law| law.group() == group)
    }

    /// Its parameters with what is known of them from a handbook or from the set `base`.
    pub(crate) fn parameters(self, base: &Pair) -> Vec<Parameter> {
        let named = |key: &str| format!("{}.{key}", self.group());
        let level = |key, unit, value: f64| {
            let prior = Prior::new(value.ln(), LEVEL);
            Parameter::new(named(key), unit, Scale::Logarithm, prior, "measure wear of any edge")
        };
        let energy = |key, unit, value: f64| {
            let prior = Prior::new(value.ln(), ENERGY);
            Parameter::new(named(key), unit, Scale::Logarithm, prior, "vary cutting_speed by a factor of 1.2 or more")
        };
        let balance = match base.law {
            WearLaw::EnergyBalance(law) => law,
            WearLaw::ExtendedTaylor(_) | WearLaw::TakeyamaMurata(_) => EnergyBalance::default(),
        };
        match self {
            Self::ExtendedTaylor => {
                let law = taylor(base);
                let exponent = |key, value, deviation, lift| {
                    Parameter::new(named(key), "1", Scale::Plain, Prior::new(value, deviation), lift)
                };
                let contrast = Prior::new(Scale::Contrast.coordinate(law.stage_contrast), 1.0);
                vec![
                    level("reference_life", "min", law.reference_life / MINUTE),
                    Parameter::new(
                        named("speed_exponent"),
                        "1",
                        Scale::Logarithm,
                        Prior::new(law.speed_exponent.ln(), 0.3),
                        "vary cutting_speed by a factor of 1.2 or more",
                    ),
                    exponent("feed_exponent", 1.5, 0.6, "vary feed_per_rev"),
                    exponent("depth_exponent", 0.75, 0.3, "vary depth_of_cut"),
                    Parameter::new(
                        named("stage_contrast"),
                        "1",
                        Scale::Contrast,
                        contrast,
                        "read wear during the life",
                    ),
                ]
            }
            Self::TakeyamaMurata => vec![
                level("abrasive_wear", "um/m", balance.mechanical_wear_per_path * 1e6),
                level("diffusion_wear_at_reference", "um/min", balance.thermal_wear_rate * MINUTE * 1e6),
                energy("activation_energy", "kJ/mol", balance.thermal_activation_energy / 1e3),
            ],
            Self::Usui => vec![
                level("wear_at_reference", "um/m", balance.mechanical_wear_per_path * 1e6),
                // Usui's constant of carbide at high temperature (recalled).
                energy("activation_temperature", "K", 21950.0),
            ],
            Self::EnergyBalance => vec![
                level("mechanical_wear_per_path", "um/m", balance.mechanical_wear_per_path * 1e6),
                level("thermal_wear_rate", "um/min", balance.thermal_wear_rate * MINUTE * 1e6),
                energy("mechanical_activation_energy", "kJ/mol", balance.mechanical_activation_energy / 1e3),
                energy("thermal_activation_energy", "kJ/mol", balance.thermal_activation_energy / 1e3),
            ],
        }
    }

    /// The wear rate in mm/min at a land in mm under a cut, with `values` of the parameters in their units of files.
    pub(crate) fn rate<'a>(
        self,
        base: &'a Pair,
        cut: &Cut,
        limit: f64,
        values: &[f64],
    ) -> Box<dyn Fn(f64) -> f64 + 'a> {
        let contact = base.contact(cut);
        let (speed, factor) = (cut.cutting_speed, cut.wear_factor);
        let balance = match base.law {
            WearLaw::EnergyBalance(law) => law,
            WearLaw::ExtendedTaylor(_) | WearLaw::TakeyamaMurata(_) => EnergyBalance::default(),
        };
        let run_in = move |land: f64| 1.0 + balance.run_in_land / (land + balance.run_in_offset);
        let inverse = move |land: f64| contact.steady_temperature(land).recip() - balance.reference_temperature.recip();
        match self {
            Self::ExtendedTaylor => {
                let law = ExtendedTaylor {
                    reference_life: values[0] * MINUTE,
                    speed_exponent: values[1],
                    feed_exponent: values[2],
                    depth_exponent: values[3],
                    stage_contrast: values[4],
                    wear_limit: limit * 1e-3,
                    ..taylor(base)
                };
                let life = law.tool_life(cut) / MINUTE;
                Box::new(move |land| {
                    let x = (land / limit).min(1.0);
                    limit / (life * (1.0 + law.stage_contrast * (6.0 * x * (1.0 - x) - 1.0)))
                })
            }
            Self::TakeyamaMurata => {
                let (abrasive, diffusion) = (values[0] * 1e-6 * factor, values[1] * 1e-6 / MINUTE * factor);
                let energy = values[2] * 1e3 / balance.gas_constant;
                Box::new(move |land| {
                    let land = land * 1e-3;
                    MM_PER_MIN * (speed * abrasive * run_in(land) + diffusion * (-energy * inverse(land)).exp())
                })
            }
            Self::Usui => {
                let (level, temperature) = (values[0] * 1e-6 * factor, values[1]);
                Box::new(move |land| {
                    let land = land * 1e-3;
                    MM_PER_MIN * speed * level * run_in(land) * (-temperature * inverse(land)).exp()
                })
            }
            Self::EnergyBalance => {
                let law = EnergyBalance {
                    mechanical_wear_per_path: values[0] * 1e-6,
                    thermal_wear_rate: values[1] * 1e-6 / MINUTE,
                    mechanical_activation_energy: values[2] * 1e3,
                    thermal_activation_energy: values[3] * 1e3,
                    ..balance
                };
                Box::new(move |land| {
                    let land = land * 1e-3;
                    let theta = contact.steady_temperature(land);
                    let layer = 1.0 + (land / law.heated_layer_land).powi(2);
                    let mechanical = law.mechanical_wear_per_path * run_in(land) * law.softening(theta);
                    MM_PER_MIN * factor * (speed * mechanical + law.thermal_wear_rate * layer * law.activation(theta))
                })
            }
        }
    }
}

/// Taylor's law of a set, or the handbook's at the reference cut of the set.
fn taylor(base: &Pair) -> ExtendedTaylor {
    match base.law {
        WearLaw::ExtendedTaylor(law) => law,
        WearLaw::EnergyBalance(_) | WearLaw::TakeyamaMurata(_) => {
            let cut = base.reference_cut();
            ExtendedTaylor {
                reference_speed: cut.cutting_speed,
                reference_feed: cut.feed_per_rev,
                reference_depth: cut.depth_of_cut,
                ..ExtendedTaylor::default()
            }
        }
    }
}
