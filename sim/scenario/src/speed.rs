//! How a cutting speed is chosen: one entry a rule.
//!
//! The table of this file is the only list of speed rules. The enum [`SpeedRule`], the words and keys of scenario files and of
//! studies of tool lives, their readers, the way in which the speed is found, the setting that `compare --tune` moves and the
//! part that a rule plays in a comparison are all made from its entries. A rule whose speed is a law of flank wear is complete
//! with its entry. [`policies`](crate::policies) says how shops follow such a law.

use crate::Setting;
use toolroom_cutting::TurningInput;
use toolroom_form::{Key, Kind, Section};
use toolroom_process::Record as _;
use toolroom_wear::SpeedLaw;

/// A cutting speed that a cut is commanded: what the models of cutting take, in milling as in turning.
pub const SPEED: Kind = Kind::positive("m/s", "m/min", TurningInput::<f64>::FIELDS[0].max, "60 m/min");
/// A cutting path.
pub const PATH: Kind = Kind::positive("m", "m", 1e6, "75 m");
/// A flank wear.
pub const WEAR: Kind = Kind::positive("m", "mm", 5e-3, "0.3 mm");
/// A shadow price of edges.
pub const PRICE: Kind = Kind::positive("s/m", "s/m", 1e5, "2.4 s/m");

/// Everything that is known of a speed rule beside its name and its numbers.
#[derive(Clone, Copy, Debug)]
pub struct SpeedEntry {
    /// How its speed is found.
    pub course: Course,
    /// The setting of the speed that tuning may move; `None` where it is the claim of the rule that its speed is right.
    pub setting: Option<Setting>,
    /// The part that it plays in a comparison.
    pub part: SpeedPart,
}

/// How the speed of a rule is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// As the operation says.
    Programmed,
    /// One speed over the life of an edge.
    Constant(SpeedChoice),
    /// Speed against the path that an edge has cut, worked out once.
    Schedule,
    /// Speed against flank wear, planned anew for every pass.
    Law(SpeedLaw),
    /// The law of [`SpeedLaw::ShadowPrice`] at this price, s/m; `None`: at the price of the rate optimum.
    Price(Option<f64>),
    /// The wear that is left, shared out evenly over what is left of this path, m.
    SetIncrement(f64),
}

/// A constant speed and what it is best for, on the believed model of an edge in continuous cut.
/// Speeds at which an edge that reaches its wear limit in the middle of a pass would collapse
/// are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpeedChoice {
    /// Given, m/s.
    Given(f64),
    /// Longest cutting path per edge.
    BestPath,
    /// Longest tool life.
    BestLife,
    /// Greatest production rate with the machine's tool change time.
    BestRate,
    /// Least cost.
    BestCost,
    /// Makarov's optimum: minimum wear per path at this flank wear, m.
    Makarov(f64),
}

/// The part of a speed rule in a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpeedPart {
    /// A speed that somebody gave.
    Given,
    /// A constant speed that is best for what the word says.
    Best(&'static str),
    /// Constant speed by Makarov's law at this flank wear, m.
    Makarov(f64),
    /// Speed against path, without feedback.
    Schedule,
    /// Follows what is measured.
    Adaptive,
}

/// Makes everything from the table. An entry is `Variant { numbers } = "word" observes => SpeedEntry`: each number is
/// `required` or `optional`, with its kind in files and its words for people; `observes` says that the rule follows wear, so
/// that a file may say what it knows of the edge.
macro_rules! speed_rules {
    (@number required) => { f64 };
    (@number optional) => { Option<f64> };
    (@read $section:ident required $number:ident) => { $section.required(stringify!($number)) };
    (@read $section:ident optional $number:ident) => { $section.si(stringify!($number)) };
    (@key required $number:ident $kind:expr, $says:literal, $word:literal) => {
        Key::required(stringify!($number), $kind, $says).when("speed", &[$word])
    };
    (@key optional $number:ident $kind:expr, $says:literal, $word:literal) => {
        Key::optional(stringify!($number), $kind, $says).when("speed", &[$word])
    };
    (@observes) => { false };
    (@observes observes) => { true };
    ($(
        $(#[$meta:meta])*
        $rule:ident $({
            $($(#[$inner:meta])* $need:ident $number:ident: $kind:expr, $says:literal;)+
        })? = $word:literal $($observes:ident)? => $entry:expr;
    )+) => {
        /// How the cutting speed is chosen.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum SpeedRule {
            $($(#[$meta])* $rule $({ $($(#[$inner])* $number: speed_rules!(@number $need),)+ })?,)+
        }

        impl SpeedRule {
            /// The words of files, in the order in which people are shown them.
            pub const WORDS: &'static [&'static str] = &[$($word),+];
            /// Keys of the numbers of the rules, each under the words that have it.
            pub const KEYS: &'static [Key] =
                &[$($($(speed_rules!(@key $need $number $kind, $says, $word),)+)?)+];
            /// Every word, and whether its rule follows wear.
            const FOLLOWING: &'static [(&'static str, bool)] = &[$(($word, speed_rules!(@observes $($observes)?)),)+];

            /// The word in files.
            pub const fn word(self) -> &'static str {
                match self {
                    $(Self::$rule $({ $($number: _),+ })? => $word,)+
                }
            }

            /// The rule of a word, with its numbers from the same section; `None` if there is no such word.
            pub fn of_word(word: &str, section: &Section<'_>) -> Option<Self> {
                match word {
                    $($word => Some(Self::$rule $({ $($number: speed_rules!(@read section $need $number),)+ })?),)+
                    _ => None,
                }
            }

            /// What is known of the rule.
            pub fn entry(self) -> SpeedEntry {
                match self {
                    $(Self::$rule $({ $($number),+ })? => $entry,)+
                }
            }
        }
    };
}

speed_rules! {
    /// As programmed in the operation.
    Programmed = "programmed" => SpeedEntry {
        course: Course::Programmed,
        setting: Some(Setting::SpeedFactor),
        part: SpeedPart::Given,
    };
    /// A given constant speed.
    Constant {
        /// Cutting speed, m/s.
        required cutting_speed: SPEED, "The constant speed";
    } = "constant" => SpeedEntry {
        course: Course::Constant(SpeedChoice::Given(cutting_speed)),
        setting: Some(Setting::CuttingSpeed),
        part: SpeedPart::Given,
    };
    /// The constant speed of the longest cutting path per edge, worked out once for every nominal cut (feed, depth) and
    /// machine, as the following ones are.
    BestPath = "best_path" => SpeedEntry {
        course: Course::Constant(SpeedChoice::BestPath),
        setting: None,
        part: SpeedPart::Best("path"),
    };
    /// The constant speed of the longest tool life.
    BestLife = "best_life" => SpeedEntry {
        course: Course::Constant(SpeedChoice::BestLife),
        setting: None,
        part: SpeedPart::Best("life"),
    };
    /// The constant speed of the greatest production rate with the machine's tool change time.
    BestRate = "best_rate" => SpeedEntry {
        course: Course::Constant(SpeedChoice::BestRate),
        setting: None,
        part: SpeedPart::Best("rate"),
    };
    /// The constant speed of least cost.
    BestCost = "best_cost" => SpeedEntry {
        course: Course::Constant(SpeedChoice::BestCost),
        setting: None,
        part: SpeedPart::Best("cost"),
    };
    /// Makarov's constant speed: minimum wear per path at a stated flank wear.
    Makarov {
        /// Flank wear, m.
        required at_flank_wear: WEAR, "Wear whose minimum-wear speed is held";
    } = "makarov" => SpeedEntry {
        course: Course::Constant(SpeedChoice::Makarov(at_flank_wear)),
        setting: None,
        part: SpeedPart::Makarov(at_flank_wear),
    };
    /// Speed against cumulative path, tabulated once on the believed model.
    Schedule = "schedule" => SpeedEntry {
        course: Course::Schedule,
        setting: Some(Setting::SpeedFactor),
        part: SpeedPart::Schedule,
    };
    /// Paper's mode 1: minimum wear per path at the estimated wear. In a shop, a new edge starts within one step (15 % of the
    /// pair's reference speed) of the programmed speed.
    MinimumWear = "minimum_wear" observes => SpeedEntry {
        course: Course::Law(SpeedLaw::MinimumWear),
        setting: Some(Setting::SpeedFactor),
        part: SpeedPart::Adaptive,
    };
    /// The paper's literal rule of mode 1, both functionals equal, instead of the exact balance.
    MinimumWearLiteral = "minimum_wear_literal" observes => SpeedEntry {
        course: Course::Law(SpeedLaw::LiteralBalance),
        setting: Some(Setting::SpeedFactor),
        part: SpeedPart::Adaptive,
    };
    /// Paper's mode 2: a set wear increment per pass, so that the limit is reached after a cutting path.
    SetIncrement {
        /// Cutting path over the life of an edge, m.
        required path_per_edge: PATH, "Cutting path over the life of an edge";
    } = "set_increment" observes => SpeedEntry {
        course: Course::SetIncrement(path_per_edge),
        setting: Some(Setting::PathPerEdge),
        part: SpeedPart::Adaptive,
    };
    /// Greatest production rate at a shadow price of edges.
    Productivity {
        /// Shadow price, s/m; `None`: that of the rate optimum for the machine's tool change time and cost.
        optional price: PRICE, "Shadow price of edges; left out: the rate optimum";
    } = "productivity" observes => SpeedEntry {
        course: Course::Price(price),
        setting: Some(Setting::Price),
        part: SpeedPart::Adaptive,
    };
    /// Mode 1 with the true wear, the bound for every observer.
    Oracle = "oracle" => SpeedEntry {
        course: Course::Law(SpeedLaw::MinimumWear),
        setting: Some(Setting::SpeedFactor),
        part: SpeedPart::Adaptive,
    };
}

impl SpeedRule {
    /// Words of the rules that follow wear, and of which a file may therefore say what they know of it.
    pub const OBSERVING: &'static [&'static str] = &{
        let mut words = [""; observing(Self::FOLLOWING)];
        let (mut rule, mut count) = (0, 0);
        while rule < Self::FOLLOWING.len() {
            if Self::FOLLOWING[rule].1 {
                words[count] = Self::FOLLOWING[rule].0;
                count += 1;
            }
            rule += 1;
        }
        words
    };

    /// A word as the table has it, for [`Section::chosen`].
    pub fn known_word(word: &str) -> Option<&'static str> {
        Self::WORDS.iter().find(|known| **known == word).copied()
    }
}

/// Number of rules that follow wear.
const fn observing(rules: &[(&str, bool)]) -> usize {
    let (mut rule, mut count) = (0, 0);
    while rule < rules.len() {
        count += rules[rule].1 as usize;
        rule += 1;
    }
    count
}

/// Every speed rule, as read from its word and the examples of its numbers.
#[cfg(test)]
pub(crate) fn examples() -> Vec<SpeedRule> {
    use toolroom_form::{Form, Need, example, joined, parse};
    const WORD: &[Key] = &[Key::required("speed", Kind::Choice(SpeedRule::WORDS), "The rule")];
    static FORM: Form = Form {
        title: "the rule",
        doc: "A speed rule alone",
        keys: &joined::<{ 1 + SpeedRule::KEYS.len() }>(&[WORD, SpeedRule::KEYS]),
    };
    let rule = |word: &&str| {
        let due =
            |key: &&Key| matches!(key.need, Need::Required) && key.when.is_some_and(|when| when.values.contains(word));
        let numbers = SpeedRule::KEYS.iter().filter(due).map(|key| format!("{} = {}\n", key.name, example(&key.kind)));
        let text = format!("speed = \"{word}\"\n{}", numbers.collect::<String>());
        let read = parse("rule.toml", &text, &[], &FORM, |_, section| SpeedRule::of_word(word, section));
        read.unwrap_or_else(|error| panic!("{error}")).content
    };
    SpeedRule::WORDS.iter().map(rule).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_reads_as_its_rule_and_no_other() {
        let read = examples();
        assert_eq!(read.iter().map(|rule| rule.word()).collect::<Vec<_>>(), SpeedRule::WORDS);
        for (i, one) in read.iter().enumerate() {
            assert!(read.iter().skip(i + 1).all(|other| one != other), "{} is another rule, too", one.word());
        }
    }

    #[test]
    fn rules_that_follow_wear_say_so_and_are_adaptive() {
        for rule in examples() {
            let follows = matches!(rule.entry().course, Course::Law(_) | Course::Price(_) | Course::SetIncrement(_));
            assert_eq!(rule.entry().part == SpeedPart::Adaptive, follows, "{}", rule.word());
            // The oracle has its own word for what it knows.
            let says = SpeedRule::OBSERVING.contains(&rule.word()) || rule == SpeedRule::Oracle;
            assert_eq!(says, follows, "{}", rule.word());
        }
    }
}
