//! The first parameter set of a shop that knows about how long an edge lasts.

use super::one_life::{ABOUT, EDGE_SCATTER, EDGE_SCATTER_DEVIATION, SPEED_EXPONENT_DEVIATION};
use super::{FORCE_DEVIATION, ISO_513, OneLife, ToolMaterial};
use serde_json::{Value, json};
use toolroom_process::unit::{self, UnitError};

/// One life, the cut at which it is known, and the material.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstSet {
    /// The life.
    pub life: OneLife,
    /// Feed per revolution, m.
    pub feed: f64,
    /// Depth of cut, m.
    pub depth_of_cut: f64,
    /// Flank wear at which an edge is spent, m.
    pub wear_limit: f64,
    /// ISO 513 letter of the work material.
    pub iso513: &'static str,
}

/// What a user knows, as typed: quantities with their units.
#[derive(Clone, Copy, Debug)]
pub struct KnownLife<'a> {
    /// Time in cut until the wear limit.
    pub life: &'a str,
    /// Cutting speed.
    pub cutting_speed: &'a str,
    /// Feed per revolution.
    pub feed: &'a str,
    /// Depth of cut.
    pub depth_of_cut: &'a str,
    /// Flank wear at which an edge is spent.
    pub wear_limit: &'a str,
    /// Word of a tool material.
    pub tool_material: &'a str,
    /// ISO 513 letter.
    pub iso513: &'a str,
}

/// Why what a user typed is no known life.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KnownLifeError {
    /// Not a quantity of that kind.
    #[error("{what} \"{read}\": {reason}")]
    Unit {
        /// Which value.
        what: &'static str,
        /// What was read.
        read: String,
        /// What is wrong.
        reason: UnitError,
    },
    /// A number that no cut has.
    #[error("{what} \"{read}\" is outside what a cut can be: look at its unit")]
    Range {
        /// Which value.
        what: &'static str,
        /// What was read.
        read: String,
    },
    /// A word that is not known.
    #[error("{what} \"{read}\" is not known")]
    Word {
        /// Which value.
        what: &'static str,
        /// What was read.
        read: String,
    },
}

impl KnownLifeError {
    /// What to write instead: a value of the same kind.
    pub fn fix(&self) -> String {
        match self {
            Self::Unit { what, .. } | Self::Range { what, .. } => {
                let example = match *what {
                    "--life" => "15 min",
                    "--at" => "200 m/min",
                    "--feed" => "0.25 mm/rev",
                    "--depth" => "1.5 mm",
                    // A wear limit is the last of them.
                    _ => "0.3 mm",
                };
                format!("write a number with its unit, such as {what} \"{example}\"")
            }
            Self::Word { what, .. } => format!("`toolroom calibrate --help` lists the words of {what}"),
        }
    }
}

/// Factor about the known speed of the other speeds that an answer names.
const FASTER: f64 = 1.25;

/// Factor about the known speed within which speeds are searched (assumption).
const SPEED_RANGE: f64 = 3.0;

impl FirstSet {
    /// What a user typed.
    ///
    /// # Errors
    /// [`KnownLifeError`]: a unit that does not fit, a number that no cut has, an unknown word.
    pub fn read(known: &KnownLife<'_>) -> Result<Self, KnownLifeError> {
        let quantity = |what, text: &str, unit: &'static str, (least, greatest): (f64, f64)| {
            let read = text.to_owned();
            match unit::quantity(text, unit) {
                Err(reason) => Err(KnownLifeError::Unit { what, read, reason }),
                Ok(value) if !(least..=greatest).contains(&value) => Err(KnownLifeError::Range { what, read }),
                Ok(value) => Ok(value),
            }
        };
        let word = |what, read: &str| KnownLifeError::Word { what, read: read.to_owned() };
        let letter = ISO_513.iter().find(|letter| **letter == known.iso513);
        Ok(Self {
            life: OneLife {
                life: quantity("--life", known.life, "s", (1.0, 1e6))?,
                cutting_speed: quantity("--at", known.cutting_speed, "m/s", (0.01, 16.0))?,
                tool_material: ToolMaterial::from_word(known.tool_material)
                    .ok_or_else(|| word("--tool-material", known.tool_material))?,
            },
            feed: quantity("--feed", known.feed, "m", (1e-6, 5e-3))?,
            depth_of_cut: quantity("--depth", known.depth_of_cut, "m", (1e-6, 20e-3))?,
            wear_limit: quantity("--limit", known.wear_limit, "m", (1e-6, 5e-3))?,
            iso513: letter.ok_or_else(|| word("--material", known.iso513))?,
        })
    }

    /// The answer for people: what is assumed, and what the life means at another speed.
    pub fn text(&self) -> String {
        format!("assumed\n  {}\n{}", self.assumptions().join("\n  "), self.sentence(FASTER * self.life.cutting_speed))
    }

    /// The answer for programs; `file` is where the set stands.
    pub fn json(&self, file: &std::path::Path) -> Value {
        let speed = self.life.cutting_speed;
        let band = |speed: f64| {
            let (median, next) = (self.life.life_at(speed), self.life.next_edge_at(speed));
            json!({
                "cutting_speed [m/min]": 60.0 * speed,
                "median [min]": median.median / 60.0,
                "ci90": [median.low / 60.0, median.high / 60.0],
                "next_edge90": [next.low / 60.0, next.high / 60.0],
            })
        };
        json!({
            "schema": 1,
            "process": "turning",
            "law": "extended_taylor",
            "file": file,
            "assumed": self.assumptions(),
            "life": [band(speed / FASTER), band(speed), band(speed * FASTER)],
        })
    }

    /// What is assumed beside the life, in the order of its weight for a decision.
    pub fn assumptions(&self) -> Vec<String> {
        let material = self.life.tool_material;
        let deviations = OneLife::deviations();
        let law = self.life.law();
        vec![
            format!("tool material: {}", material.word()),
            format!(
                "Taylor's law with ln p ~ N(ln {}, {SPEED_EXPONENT_DEVIATION}²), p the exponent of speed",
                law.speed_exponent
            ),
            format!("\"about\": a factor {:.2} on the life (standard deviation of ln {ABOUT})", ABOUT.exp()),
            format!(
                "exponents of feed q ~ N({}, {}²) and of depth r ~ N({}, {}²)",
                law.feed_exponent, deviations[0], law.depth_exponent, deviations[1]
            ),
            format!(
                "scatter of edges ln τ ~ N(ln {EDGE_SCATTER}, {EDGE_SCATTER_DEVIATION}²), a shop \
                 (Wager & Barash 1971; Machinery's Handbook 31)"
            ),
            format!("cutting force of ISO 513 group {} within {:.0} %", self.iso513, 100.0 * FORCE_DEVIATION),
            "no physics, hence no dependence on the state of wear: adaptive speed gains exactly nothing under this \
             set, and whether it would pay can not be judged from one life"
                .to_owned(),
        ]
    }

    /// The set as a file called `name`.
    pub fn to_toml(&self, name: &str) -> String {
        let OneLife { life, cutting_speed, tool_material } = self.life;
        // Temperatures and EMF act on no life under this law; they are those of a shipped set.
        let base = if self.iso513 == "S" { "ni_vk6om_hb" } else { "c45_t15k6" };
        let (speed, feed, depth) = (60.0 * cutting_speed, 1e3 * self.feed, 1e3 * self.depth_of_cut);
        let round = toolroom_form::significant;
        let quoted = toml::Value::String(name.to_owned()).to_string();
        let limit = |value: f64| {
            format!(
                "{{ value = \"{} m/min\", source = \"assumption: within a factor {SPEED_RANGE} of the known speed\" }}",
                round(value)
            )
        };
        format!(
            "# About how long an edge lasts at one cut; everything else is assumed.\n\
             # toolroom check FILE lists every value with where it comes from.\n\
             schema = 1\n\
             name = {quoted}\n\
             title = \"{} min at {} m/min, {}\"\n\
             process = \"turning\"\n\
             based_on = \"{base}\" # temperatures and EMF, which act on no life here\n\
             law = \"extended_taylor\"\n\
             material = {{ iso513 = \"{}\" }}\n\n\
             [handbook]\n\
             one_life = {{ life = \"{} min\", cutting_speed = \"{} m/min\", feed = \"{} mm/rev\", depth_of_cut = \"{} mm\", \
             tool_material = \"{}\", wear_limit = \"{} mm\" }}\n\n\
             [parameters.temperature]\n\
             reference_feed = {{ value = \"{} mm/rev\", source = \"the known cut\" }}\n\
             reference_depth = {{ value = \"{} mm\", source = \"the known cut\" }}\n\n\
             [parameters.limits]\n\
             reference_speed = {{ value = \"{} m/min\", source = \"the known cut\" }}\n\
             lowest_speed = {}\n\
             highest_speed = {}\n",
            round(life / 60.0),
            round(speed),
            tool_material.word(),
            self.iso513,
            round(life / 60.0),
            round(speed),
            round(feed),
            round(depth),
            tool_material.word(),
            round(1e3 * self.wear_limit),
            round(feed),
            round(depth),
            round(speed),
            limit(speed / SPEED_RANGE),
            limit(speed * SPEED_RANGE),
        )
    }

    /// What the life says of another speed (m/s), in one line.
    pub fn sentence(&self, cutting_speed: f64) -> String {
        let (median, next) = (self.life.life_at(cutting_speed), self.life.next_edge_at(cutting_speed));
        let minutes = |seconds: f64| format!("{:.1}", seconds / 60.0);
        format!(
            "at {} m/min an edge lasts {} min ({} … {}); the next edge {} … {}. Two edges tested at {0} m/min would \
             narrow the first interval to {:.0} % of its width",
            toolroom_form::significant(60.0 * cutting_speed),
            minutes(median.median),
            minutes(median.low),
            minutes(median.high),
            minutes(next.low),
            minutes(next.high),
            100.0 * self.life.narrowed(cutting_speed, 2),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pair, ParameterSet, TURNING_SETS, ToolMaterial};

    #[test]
    fn the_written_set_lasts_the_known_life() {
        let life = OneLife { life: 900.0, cutting_speed: 200.0 / 60.0, tool_material: ToolMaterial::Carbide };
        let first = FirstSet { life, feed: 0.25e-3, depth_of_cut: 2e-3, wear_limit: 0.3e-3, iso513: "P" };
        let set = ParameterSet::parse("first.toml", &first.to_toml("first"), &TURNING_SETS).unwrap();
        let pair = Pair::of_set(&set).unwrap();
        assert!((pair.life(&pair.reference_cut()).cutting_time / 900.0 - 1.0).abs() < 1e-6);
        assert_eq!(set.prior.len(), 5);
        // Nothing depends on the state of wear but by the separable curve.
        let constant = pair.best_constant_speed(&pair.reference_cut(), crate::Objective::Path).life;
        let adaptive = pair.minimum_wear_life(&pair.reference_cut());
        assert!((adaptive.path / constant.path - 1.0).abs() < 1e-6);
    }
}
