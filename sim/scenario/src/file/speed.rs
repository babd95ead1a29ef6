//! How a file chooses the cutting speed: the words, the keys of their numbers, their reader.

use super::choices::ProcessKind;
use super::keys::{FACTOR, PATH, SPEED, WEAR};
use crate::{Knowledge, MachineType, SpeedChoice, SpeedRule};
use toolroom_form::{Fault, Key, Kind, Section, Walk, significant, vocabulary};

vocabulary! {
    /// How the cutting speed is chosen.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum SpeedWord {
        /// As programmed.
        Programmed = "programmed",
        /// A constant speed that the file gives.
        Constant = "constant",
        /// The constant speed of the longest cutting path per edge.
        BestPath = "best_path",
        /// The constant speed of the longest tool life.
        BestLife = "best_life",
        /// The constant speed of the greatest production rate.
        BestRate = "best_rate",
        /// The constant speed of least cost.
        BestCost = "best_cost",
        /// Makarov's constant speed.
        Makarov = "makarov",
        /// Speed against cumulative path.
        Schedule = "schedule",
        /// Minimum wear per path.
        MinimumWear = "minimum_wear",
        /// Minimum wear by the paper's literal rule.
        MinimumWearLiteral = "minimum_wear_literal",
        /// A set wear increment per pass.
        SetIncrement = "set_increment",
        /// Greatest production rate at a shadow price of edges.
        Productivity = "productivity",
        /// Minimum wear with the true wear known.
        Oracle = "oracle",
    }
}

/// A shadow price of edges.
pub(super) const PRICE: Kind = Kind::positive("s/m", "s/m", 1e5, "2.4 s/m");

/// Keys of a policy that choose its speed.
pub(super) const KEYS: &[Key] = &[
    Key::required("speed", Kind::Choice(SpeedWord::WORDS), "How the cutting speed of turning passes is chosen"),
    Key::required("cutting_speed", SPEED, "The constant speed").when("speed", &["constant"]),
    Key::required("at_flank_wear", WEAR, "Wear whose minimum-wear speed is held").when("speed", &["makarov"]),
    Key::required("path_per_edge", PATH, "Cutting path over the life of an edge").when("speed", &["set_increment"]),
    Key::optional("price", PRICE, "Shadow price of edges; left out: the rate optimum").when("speed", &["productivity"]),
    Key::default("speed_factor", FACTOR, "1", "Factor on the speed that the rule commands"),
    Key::default(
        "knows",
        Kind::Choice(Knowledge::WORDS),
        Knowledge::Sensors.word(),
        "What the rule knows of the edge; more than sensors is a bound that no real controller reaches",
    )
    .when("speed", &["minimum_wear", "minimum_wear_literal", "set_increment", "productivity"]),
];

pub(super) fn speed_rule(walk: &mut Walk, section: &Section<'_>, machines: &[MachineType]) -> SpeedRule {
    let constant = SpeedRule::Constant;
    let Some(word) = section.chosen("speed", SpeedWord::from_word) else {
        return SpeedRule::Programmed; // a problem was noted
    };
    match word {
        SpeedWord::Constant => {
            let speed = section.required("cutting_speed");
            let within = |machine: &MachineType| (machine.speed_range.0..=machine.speed_range.1).contains(&speed);
            let mut lathes =
                machines.iter().filter(|machine| machine.process == ProcessKind::Turning.word()).peekable();
            if speed.is_finite() && lathes.peek().is_some() && !lathes.any(within) {
                let fault = Fault::OutOfRange {
                    key: "cutting_speed".to_owned(),
                    read: format!("{} m/min", significant(speed * 60.0)),
                    range: "the speed_range of every turning machine".to_owned(),
                    meant: Vec::new(),
                };
                walk.fault(section.span_of("cutting_speed"), fault);
            }
            constant(SpeedChoice::Given(speed))
        }
        SpeedWord::BestPath => constant(SpeedChoice::BestPath),
        SpeedWord::BestLife => constant(SpeedChoice::BestLife),
        SpeedWord::BestRate => constant(SpeedChoice::BestRate),
        SpeedWord::BestCost => constant(SpeedChoice::BestCost),
        SpeedWord::Makarov => constant(SpeedChoice::Makarov(section.required("at_flank_wear"))),
        SpeedWord::Schedule => SpeedRule::Schedule,
        SpeedWord::MinimumWear => SpeedRule::MinimumWear { literal: false },
        SpeedWord::MinimumWearLiteral => SpeedRule::MinimumWear { literal: true },
        SpeedWord::SetIncrement => SpeedRule::SetIncrement { path_per_edge: section.required("path_per_edge") },
        SpeedWord::Productivity => SpeedRule::Productivity { price: section.si("price") },
        SpeedWord::Oracle => SpeedRule::Oracle,
        SpeedWord::Programmed => SpeedRule::Programmed,
    }
}
