//! Functions of what was recorded, each on each class of channels, as effects of a user.

use crate::seen::{VaryingQuantity, rounded};

/// Powers of a quantity over its median that are tried (assumption: laws of machining are power laws, and these are the usual
/// exponents).
const POWERS: [f64; 5] = [-2.0, -1.0, 0.5, 1.0, 2.0];
/// Times, as shares of the greatest age of an edge, over which a term dies away (assumption).
const DECAYS: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.5];
/// Size of a term that multiplies: unit, ordinary and greatest value of the logarithm of its factor. Assumption: what describes a
/// gap by more than a factor of seven is a wrong model.
const FACTOR: (&str, f64, f64) = ("1", 0.1, 2.0);
/// Size of a term that is added to a temperature. Assumption: no thermocouple that is read at all is off by more.
const KELVIN: (&str, f64, f64) = ("K", 20.0, 300.0);

/// Channels that one change of the model moves together.
#[derive(Debug)]
pub struct Class {
    /// Word of its ids.
    pub name: &'static str,
    /// What it is, for people.
    pub title: &'static str,
    /// Terms that are changed, all alike.
    terms: &'static [&'static str],
    /// Unit, ordinary and greatest value of the size.
    size: (&'static str, f64, f64),
    /// Words of the map of channels that ask for it.
    pub channels: &'static [&'static str],
    /// Processes that read the terms.
    pub processes: &'static [&'static str],
}

/// Every class.
pub const CLASSES: [Class; 6] = [
    Class {
        name: "force",
        title: "both forces",
        terms: &["cutting_force", "feed_force"],
        size: FACTOR,
        channels: &["cutting_force", "feed_force", "spindle_power"],
        processes: &["turning", "milling"],
    },
    Class {
        name: "cutting_force",
        title: "the cutting force",
        terms: &["cutting_force"],
        size: FACTOR,
        channels: &["cutting_force", "spindle_power"],
        processes: &["turning", "milling"],
    },
    Class {
        name: "feed_force",
        title: "the feed force",
        terms: &["feed_force"],
        size: FACTOR,
        channels: &["feed_force"],
        processes: &["turning", "milling"],
    },
    Class {
        name: "temperature",
        title: "the rise of temperature",
        terms: &["temperature_rise"],
        size: FACTOR,
        channels: &["temperature", "thermo_emf"],
        processes: &["turning"],
    },
    Class {
        name: "temperature_reading",
        title: "the reading of temperature",
        terms: &["temperature_offset"],
        size: KELVIN,
        channels: &["temperature"],
        processes: &["turning"],
    },
    Class {
        name: "wear",
        title: "the rate of wear",
        terms: &["wear_rate"],
        size: FACTOR,
        channels: &["flank_wear", "wear rate"],
        processes: &["turning", "milling"],
    },
];

/// A function of the context: a word for ids, one for people, its formula, and the quantities that it reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    word: String,
    people: String,
    formula: String,
    /// Places among the seen quantities.
    pub reads: Vec<usize>,
}

/// The function that is one everywhere: a term of it says where, and nothing else.
pub fn level() -> Function {
    Function {
        word: "level".to_owned(),
        people: "acts on a part of the records".to_owned(),
        formula: "1".to_owned(),
        reads: Vec::new(),
    }
}

/// Functions of the quantities that were seen, each at most 1 over their ranges.
pub fn functions(seen: &[VaryingQuantity]) -> Vec<Function> {
    let mut all = Vec::new();
    let most = |values: &[f64]| rounded(values.iter().fold(0.0_f64, |most, value| most.max((value - 1.0).abs())));
    for (place, own) in seen.iter().enumerate() {
        // A power below one has no slope at zero.
        for power in POWERS.iter().filter(|power| own.least > 0.0 || **power >= 1.0) {
            let scale = most(&own.ends().map(|end| end.powf(*power)));
            let digits = power.to_string().replace('-', "m").replace('.', "p");
            all.push(Function {
                word: format!("{}_{digits}", own.name),
                people: format!("follows {}^{power}", own.name),
                formula: format!("({}^{power} - 1) / {scale}", own.ratio()),
                reads: vec![place],
            });
        }
        if own.name == "cutting_time" {
            for (number, share) in DECAYS.iter().enumerate() {
                let decay = rounded(share * own.greatest);
                all.push(Function {
                    word: format!("early_{}", number + 1),
                    people: format!("follows exp(−cutting_time / {decay} {})", own.unit),
                    formula: format!("exp(0 - {} / {decay} {})", own.held(), own.unit),
                    reads: vec![place],
                });
            }
        }
    }
    for (place, one) in seen.iter().enumerate() {
        for (beside, other) in seen.iter().enumerate().skip(place + 1) {
            let corners: Vec<f64> = one.ends().iter().flat_map(|a| other.ends().map(|b| a * b)).collect();
            let scale = most(&corners);
            all.push(Function {
                word: format!("{}_{}", one.name, other.name),
                people: format!("follows {} × {}", one.name, other.name),
                formula: format!("({} * {} - 1) / {scale}", one.ratio(), other.ratio()),
                reads: vec![place, beside],
            });
        }
    }
    all
}

/// Id of a function on a class.
pub fn id(class: &Class, function: &Function) -> String {
    format!("proposed.{}.{}", class.name, function.word)
}

/// The section `[[effect]]` of a function on a class; `source` says where it comes from.
pub fn definition(process: &str, class: &Class, function: &Function, source: &str) -> String {
    let (unit, ordinary, most) = class.size;
    let change = |term: &&str| match unit {
        "1" => format!("{{ term = \"{term}\", factor = \"exp(size * {})\" }}", function.formula),
        _ => format!("{{ term = \"{term}\", summand = \"size * {}\" }}", function.formula),
    };
    let changes = class.terms.iter().map(change).collect::<Vec<_>>().join(", ");
    let kind = if unit == "1" { "factor of" } else { "change of" };
    let amount = |value: f64| if unit == "1" { value.to_string() } else { format!("\"{value} {unit}\"") };
    let [ordinary, least, most] = [ordinary, -most, most].map(amount);
    format!(
        "[[effect]]\nid = \"{}\"\ntitle = \"{kind} {} that {}: empirical, not a cause\"\nkind = \"empirical\"\n\
         process = [\"{process}\"]\nsize = {{ unit = \"{unit}\", ordinary = {ordinary}, range = [{least}, {most}] }}\n\
         changes = [{changes}]\nsource = \"{source}\"\n\n",
        id(class, function),
        class.title,
        function.people
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_effects::{Context, Effect, Effects, UserEffect, parse_definitions};

    fn quantities() -> Vec<VaryingQuantity> {
        let seen = |name, unit, least, middle, greatest| VaryingQuantity { name, unit, least, middle, greatest };
        vec![
            seen("cutting_speed", "m/min", 120.0, 200.0, 260.0),
            seen("flank_wear", "mm", 0.0, 0.1, 0.3),
            seen("cutting_time", "min", 1.0, 12.0, 40.0),
            seen("sensor_time", "h", 0.0, 30.0, 80.0),
        ]
    }

    #[test]
    fn every_term_of_the_library_is_an_effect_that_a_user_may_write() {
        let functions = [functions(&quantities()), vec![level()]].concat();
        let all =
            CLASSES.iter().flat_map(|class| functions.iter().map(|own| definition("turning", class, own, "a test")));
        let text = all.collect::<String>();
        let read = parse_definitions("library.toml", &text).expect("definitions");
        assert_eq!(read.len(), CLASSES.len() * functions.len());
        assert!(read.iter().all(|own| own.is_empirical()));
    }

    #[test]
    fn a_term_holds_its_value_at_the_ends_of_what_was_seen_and_its_size_is_its_greatest_logarithm() {
        let seen = quantities();
        let square = functions(&seen).into_iter().find(|own| own.word == "cutting_speed_2").expect("a square");
        let text = definition("turning", &CLASSES[1], &square, "a test");
        let definition = parse_definitions("library.toml", &text).expect("a definition")[0];
        let effects = Effects::new(vec![Effect::User(UserEffect::new(definition)).with_size(0.2)]).expect("one effect");
        let force = |speed: f64| {
            let context: Context = Context { cutting_speed: speed / 60.0, ..Context::neutral() };
            effects.terms::<f64>(&context).cutting_force
        };
        assert_eq!(force(260.0).to_bits(), force(400.0).to_bits());
        assert_eq!(force(120.0).to_bits(), force(10.0).to_bits());
        assert!((force(200.0) - 1.0).abs() < 1e-12, "{}", force(200.0));
        // The square is 1.69 times that of the median at one end, 0.36 times at the other: 0.69 is the greater distance.
        assert!((force(260.0).ln() - 0.2).abs() < 1e-9, "{}", force(260.0).ln());
        assert!((force(120.0).ln() + 0.2 * 0.64 / 0.69).abs() < 1e-9, "{}", force(120.0).ln());
    }
}
