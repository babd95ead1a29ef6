//! The wear laws with their parameters and priors.

use crate::base::{Base, Process};
use crate::parameter::{Parameter, Prior, Scale};
use toolroom_cutting::CutterLife;
use toolroom_wear::{
    ASSUMED_DEVIATIONS, ASSUMED_EXPONENTS, EnergyBalance, ExtendedTaylor, Pair, SPEED_EXPONENT_DEVIATION,
    TakeyamaMurata, Usui, WearLaw, stage_time,
};

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
    /// Taylor's law of milling, with a wear curve.
    CutterLife,
}

/// Standard deviation of the logarithm of a level that comes from a handbook (assumption: a factor of two).
const LEVEL: f64 = 0.7;
/// Standard deviation of the logarithm of an activation energy (assumption: a factor 1.28).
const ENERGY: f64 = 0.25;
/// Exponent of feed where no set states one, and its standard deviation.
const FEED: (f64, f64) = (ASSUMED_EXPONENTS[0], ASSUMED_DEVIATIONS[0]);
/// Exponent of depth of cut where no set states one, and its standard deviation.
const DEPTH: (f64, f64) = (ASSUMED_EXPONENTS[1], ASSUMED_DEVIATIONS[1]);
/// Standard deviation of the exponent of width of cut in milling (assumption).
const WIDTH: f64 = 0.3;
/// Standard deviation of the coordinate of the contrast of the wear stages (assumption: two thirds lie between 0.37 and
/// 0.78 where 0.6 is the median).
const CONTRAST: f64 = 1.0;
/// Standard deviation of the coordinate of the tilt of the wear stages, where it is free (assumption).
const TILT: f64 = 1.0;
/// Contrasts around which a prior may lie: at the ends of its range the coordinate is infinite.
const CONTRASTS: (f64, f64) = (0.05, 0.90);
/// Wear by path of Usui's law over the mechanical part of an energy balance at the reference cut (assumption).
const WHOLE: f64 = 1.4;
/// Seconds of a minute.
const MINUTE: f64 = 60.0;
/// um of a metre.
const MICRO: f64 = 1e6;
/// Units of a kilo-unit.
const KILO: f64 = 1e3;

impl Law {
    /// Every law of turning, those of fewest parameters first.
    pub const ALL: [Self; 4] = [Self::Usui, Self::TakeyamaMurata, Self::EnergyBalance, Self::ExtendedTaylor];

    /// The laws of a process.
    pub fn of(process: Process) -> &'static [Self] {
        match process {
            Process::Turning => &Self::ALL,
            Process::Milling => &[Self::CutterLife],
        }
    }

    /// Name of its group in parameter files.
    pub fn group(self) -> &'static str {
        match self {
            Self::ExtendedTaylor => "extended_taylor",
            Self::TakeyamaMurata => "takeyama_murata",
            Self::Usui => "usui",
            Self::EnergyBalance => "energy_balance",
            Self::CutterLife => "life",
        }
    }

    /// The law of a group.
    pub fn of_group(group: &str) -> Option<Self> {
        Self::ALL.into_iter().chain([Self::CutterLife]).find(|law| law.group() == group)
    }

    /// Whether the law states lives, so that its wear curve may have any [`Shape`](crate::Shape).
    pub fn states_lives(self) -> bool {
        match self {
            Self::ExtendedTaylor | Self::CutterLife => true,
            Self::TakeyamaMurata | Self::Usui | Self::EnergyBalance => false,
        }
    }

    /// The set with this law and what it says of it, so that lives end at a flank wear of `limit` mm.
    pub(crate) fn template(self, base: &Base, limit: f64) -> Base {
        match base {
            Base::Turning { pair, others } => {
                let law = ending_at(self.of_pair(pair, others), limit);
                Base::Turning { pair: Box::new(Pair { law, ..pair.as_ref().clone() }), others: others.clone() }
            }
            Base::Milling { life, diameter, chipping } => {
                let share = stage_time(limit * 1e-3 / life.wear_limit, life.stage_contrast, life.stage_tilt);
                let reference_life = life.reference_life * share;
                let life = CutterLife { wear_limit: limit * 1e-3, reference_life, ..*life };
                Base::Milling { life, diameter: *diameter, chipping: *chipping }
            }
        }
    }

    /// The law with what the set says of it: its own parameters where the set states the law, otherwise levels, run-in and
    /// reference temperature of the set's energy balance, and for Taylor's law the reference cut of the set. `others` are laws that
    /// the set states beside its own, such as the energy balance of a shipped set on which one with lives is based.
    fn of_pair(self, base: &Pair, others: &[WearLaw]) -> WearLaw {
        let mut stated = std::iter::once(&base.law).chain(others);
        if let Some(own) = stated.clone().find(|law| law.group() == self.group()) {
            return *own;
        }
        let balance = stated.find_map(|law| match law {
            WearLaw::EnergyBalance(law) => Some(*law),
            WearLaw::ExtendedTaylor(_) | WearLaw::TakeyamaMurata(_) | WearLaw::Usui(_) => None,
        });
        let balance = balance.unwrap_or_default();
        let EnergyBalance { run_in_land, run_in_offset, reference_temperature, gas_constant, .. } = balance;
        match self {
            Self::ExtendedTaylor | Self::CutterLife => {
                let cut = base.reference_cut();
                WearLaw::ExtendedTaylor(ExtendedTaylor {
                    reference_speed: cut.cutting_speed,
                    reference_feed: cut.feed_per_rev,
                    reference_depth: cut.depth_of_cut,
                    feed_exponent: FEED.0,
                    depth_exponent: DEPTH.0,
                    ..ExtendedTaylor::default()
                })
            }
            Self::TakeyamaMurata => WearLaw::TakeyamaMurata(TakeyamaMurata {
                abrasive_wear: balance.mechanical_wear_per_path,
                diffusion_wear_at_reference: balance.thermal_wear_rate,
                activation_energy: balance.thermal_activation_energy,
                reference_temperature,
                run_in_land,
                run_in_offset,
                gas_constant,
                ..TakeyamaMurata::default()
            }),
            Self::Usui => WearLaw::Usui(Usui {
                // One law stands for both parts of an energy balance.
                wear_at_reference: WHOLE * balance.mechanical_wear_per_path,
                reference_temperature,
                run_in_land,
                run_in_offset,
                ..Usui::default()
            }),
            Self::EnergyBalance => WearLaw::EnergyBalance(balance),
        }
    }

    /// Its parameters with what is known of them from a handbook, around the values of a template.
    pub(crate) fn parameters(self, template: &Base) -> Vec<Parameter> {
        let named = |key: &str| format!("{}.{key}", self.group());
        let around = |key, unit, value: f64, deviation, lift| {
            let prior = Prior::new(value.ln(), deviation);
            Parameter::new(named(key), unit, Scale::Logarithm, prior, lift)
        };
        let level = |key, unit, value| around(key, unit, value, LEVEL, "measure the wear of any edge");
        let energy =
            |key, unit, value| around(key, unit, value, ENERGY, "vary cutting_speed by a factor of 1.2 or more");
        let exponent = |key, (mean, deviation), lift: &str| {
            Parameter::new(named(key), "1", Scale::Plain, Prior::new(mean, deviation), lift)
        };
        let speed = |value| {
            let lift = "vary cutting_speed by a factor of 1.2 or more";
            around("speed_exponent", "1", value, SPEED_EXPONENT_DEVIATION, lift)
        };
        let stages = |contrast: f64| {
            let lift = "read wear early, in the middle and late in the life of edges";
            let prior = Prior::new(Scale::Contrast.coordinate(contrast.clamp(CONTRASTS.0, CONTRASTS.1)), CONTRAST);
            let contrast = Parameter::new(named("stage_contrast"), "1", Scale::Contrast, prior, lift);
            [contrast, Parameter::new(named("stage_tilt"), "1", Scale::Tilt, Prior::new(0.0, TILT), lift)]
        };
        // Around the exponents of the set, which stay where the data do not vary.
        let of_lives = |life: f64, exponents: [f64; 3], feed: &str, contrast: f64| {
            let mut parameters = vec![
                level("reference_life", "min", life / MINUTE),
                speed(exponents[0]),
                exponent("feed_exponent", (exponents[1], FEED.1), feed),
                exponent("depth_exponent", (exponents[2], DEPTH.1), "vary depth_of_cut"),
            ];
            parameters.extend(stages(contrast));
            parameters
        };
        let law = match template {
            Base::Turning { pair, .. } => &pair.law,
            Base::Milling { life, .. } => {
                let exponents = [life.speed_exponent, life.feed_exponent, life.depth_exponent];
                let mut parameters =
                    of_lives(life.reference_life, exponents, "vary feed_per_tooth", life.stage_contrast);
                parameters.push(exponent("width_exponent", (life.width_exponent, WIDTH), "vary width_of_cut"));
                return parameters;
            }
        };
        match law {
            WearLaw::ExtendedTaylor(law) => {
                let exponents = [law.speed_exponent, law.feed_exponent, law.depth_exponent];
                of_lives(law.reference_life, exponents, "vary feed_per_rev", law.stage_contrast)
            }
            WearLaw::TakeyamaMurata(law) => vec![
                level("abrasive_wear", "um/m", law.abrasive_wear * MICRO),
                level("diffusion_wear_at_reference", "um/min", law.diffusion_wear_at_reference * MINUTE * MICRO),
                energy("activation_energy", "kJ/mol", law.activation_energy / KILO),
            ],
            WearLaw::Usui(law) => vec![
                level("wear_at_reference", "um/m", law.wear_at_reference * MICRO),
                energy("activation_temperature", "K", law.activation_temperature),
            ],
            WearLaw::EnergyBalance(law) => vec![
                level("mechanical_wear_per_path", "um/m", law.mechanical_wear_per_path * MICRO),
                level("thermal_wear_rate", "um/min", law.thermal_wear_rate * MINUTE * MICRO),
                energy("mechanical_activation_energy", "kJ/mol", law.mechanical_activation_energy / KILO),
                energy("thermal_activation_energy", "kJ/mol", law.thermal_activation_energy / KILO),
            ],
        }
    }
}

/// A template with other values of the parameters of its law, in their units and the order of [`Law::parameters`].
pub(crate) fn with_values(template: &Base, values: &[f64]) -> Base {
    match template {
        Base::Turning { pair, others } => {
            let law = law_with(&pair.law, values);
            Base::Turning { pair: Box::new(Pair { law, ..pair.as_ref().clone() }), others: others.clone() }
        }
        Base::Milling { life, diameter, chipping } => {
            let life = CutterLife {
                reference_life: values[0] * MINUTE,
                speed_exponent: values[1],
                feed_exponent: values[2],
                depth_exponent: values[3],
                stage_contrast: values[4],
                stage_tilt: values[5] * (1.0 - values[4]),
                width_exponent: values[6],
                ..*life
            };
            Base::Milling { life, diameter: *diameter, chipping: *chipping }
        }
    }
}

fn law_with(template: &WearLaw, values: &[f64]) -> WearLaw {
    match *template {
        WearLaw::ExtendedTaylor(law) => WearLaw::ExtendedTaylor(ExtendedTaylor {
            reference_life: values[0] * MINUTE,
            speed_exponent: values[1],
            feed_exponent: values[2],
            depth_exponent: values[3],
            stage_contrast: values[4],
            // The coordinate counts the tilt in shares of what the contrast leaves it.
            stage_tilt: values[5] * (1.0 - values[4]),
            ..law
        }),
        WearLaw::TakeyamaMurata(law) => WearLaw::TakeyamaMurata(TakeyamaMurata {
            abrasive_wear: values[0] / MICRO,
            diffusion_wear_at_reference: values[1] / MICRO / MINUTE,
            activation_energy: values[2] * KILO,
            ..law
        }),
        WearLaw::Usui(law) => {
            WearLaw::Usui(Usui { wear_at_reference: values[0] / MICRO, activation_temperature: values[1], ..law })
        }
        WearLaw::EnergyBalance(law) => WearLaw::EnergyBalance(EnergyBalance {
            mechanical_wear_per_path: values[0] / MICRO,
            thermal_wear_rate: values[1] / MICRO / MINUTE,
            mechanical_activation_energy: values[2] * KILO,
            thermal_activation_energy: values[3] * KILO,
            ..law
        }),
    }
}

/// The law with lives that end at a wear limit in mm, to which the life of the law is carried along its wear curve.
fn ending_at(template: WearLaw, limit: f64) -> WearLaw {
    match template {
        WearLaw::ExtendedTaylor(law) => {
            let wear_limit = limit * 1e-3;
            let share = stage_time(wear_limit / law.wear_limit, law.stage_contrast, law.stage_tilt);
            let reference_life = law.reference_life * share;
            WearLaw::ExtendedTaylor(ExtendedTaylor { wear_limit, reference_life, ..law })
        }
        WearLaw::TakeyamaMurata(_) | WearLaw::Usui(_) | WearLaw::EnergyBalance(_) => template,
    }
}
