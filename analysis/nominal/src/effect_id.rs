//! Ids of effects: rows of the catalogues of processes, shop, part programs and empirical responses, or effects that a
//! user has defined.

use super::ChannelId;
use super::empirical_catalogue::EMPIRICAL_EFFECTS;
use std::fmt;
use toolroom_effects::{CatalogueEntry, Definition, Effect};
use toolroom_form::same;
use toolroom_scenario::ShopEffect;
use toolroom_scenario::effects::{PROGRAM_EFFECTS, SHOP_EFFECTS};

/// Id of a rate of wear that is another one on a part of the records: no cause, but a constant that is not the same everywhere.
pub const WEAR_RATE: &str = "constant.wear_rate";

/// An effect that may be missing from a nominal model, by its row of a catalogue. Inside the program effects are told apart
/// by this type alone; its word stands in files, in documents and on the command line.
///
/// ```
/// use toolroom_nominal::EffectId;
/// use toolroom_scenario::ShopEffect;
/// let hold = EffectId::named("feed_hold").unwrap();
/// assert_eq!((hold, hold.shop()), (EffectId::FEED_HOLD, Some(ShopEffect::FeedHold)));
/// assert_eq!(EffectId::named("feed_hld"), None);
/// ```
#[derive(Clone, Copy)]
pub struct EffectId(&'static CatalogueEntry);

/// The row of a catalogue whose id is `word`. As the value of a constant it does not compile where no row has it.
const fn row(catalogue: &'static [CatalogueEntry], word: &str) -> EffectId {
    let mut index = 0;
    while index < catalogue.len() {
        if same(catalogue[index].id.as_bytes(), word.as_bytes()) {
            return EffectId(&catalogue[index]);
        }
        index += 1;
    }
    panic!("no row of the catalogue has this id")
}

/// Effects that a model looks for by their name.
impl EffectId {
    /// Operators turn the feed override down.
    pub const FEED_OVERRIDE: Self = row(SHOP_EFFECTS, "feed_override");
    /// Operators hold the feed.
    pub const FEED_HOLD: Self = row(SHOP_EFFECTS, "feed_hold");
    /// Axes need time to accelerate.
    pub const AXIS_ACCELERATION: Self = row(SHOP_EFFECTS, "axis_acceleration");
    /// Canned cycles dwell at the bottom of the hole.
    pub const CANNED_CYCLE_DWELL: Self = row(SHOP_EFFECTS, "canned_cycle_dwell");
    /// Short stops that nobody books.
    pub const MICRO_STOPS: Self = row(SHOP_EFFECTS, "micro_stops");
    /// Operators come late to the machine.
    pub const OPERATOR_DELAY: Self = row(SHOP_EFFECTS, "operator_delay");
    /// A tool change takes longer than planned.
    pub const TOOL_CHANGE_DELAY: Self = row(SHOP_EFFECTS, "tool_change_delay");
    /// Edges are changed at another wear than planned.
    pub const TOOL_CHANGE_POLICY: Self = row(SHOP_EFFECTS, "tool_change_policy");
    /// Breakdowns come in bursts or after wear.
    pub const BREAKDOWN_SHAPE: Self = row(SHOP_EFFECTS, "breakdown_shape");
    /// The spindle needs time to come to speed and to rest.
    pub const SPINDLE_RAMP: Self = row(PROGRAM_EFFECTS, "spindle_ramp");
    /// Axes settle where a stop ends a motion.
    pub const STOP_SETTLING: Self = row(PROGRAM_EFFECTS, "stop_settling");
    /// Rapid motions accelerate more slowly.
    pub const RAPID_ACCELERATION: Self = row(PROGRAM_EFFECTS, "rapid_acceleration");
    /// Accelerations build up more slowly.
    pub const JERK: Self = row(PROGRAM_EFFECTS, "jerk");
    /// Corners are passed more slowly.
    pub const CORNER_SLOWING: Self = row(PROGRAM_EFFECTS, "corner_slowing");
    /// The control prepares short blocks more slowly.
    pub const BLOCK_TIME: Self = row(PROGRAM_EFFECTS, "block_time");
    /// The end of a program takes time.
    pub const PROGRAM_END: Self = row(PROGRAM_EFFECTS, "program_end");
    /// The magazine turns to the next tool.
    pub const MAGAZINE_DISTANCE: Self = row(PROGRAM_EFFECTS, "magazine_distance");
    /// A channel responds to a condition that the model leaves out.
    pub const CONDITION_RESPONSE: Self = row(EMPIRICAL_EFFECTS, "condition_response");
    /// A fresh edge wears faster.
    pub const RUN_IN: Self = row(Effect::CATALOGUE, "run_in");
    /// Wear feeds itself.
    pub const WEAR_ACCELERATION: Self = row(Effect::CATALOGUE, "wear_acceleration");
    /// Forces grow with flank wear.
    pub const WEAR_FORCE: Self = row(Effect::CATALOGUE, "wear_force");
    /// The contact grows hotter with flank wear.
    pub const WEAR_TEMPERATURE: Self = row(Effect::CATALOGUE, "wear_temperature");
    /// Old coolant cools less.
    pub const COOLANT_AGEING: Self = row(Effect::CATALOGUE, "coolant_ageing");
    /// Another coolant lubricates better or worse.
    pub const COOLANT_CHANGE: Self = row(Effect::CATALOGUE, "coolant_change");
    /// One lot of material is harder.
    pub const LOT_HARDNESS: Self = row(Effect::CATALOGUE, "lot_hardness");
    /// The force reading drifts.
    pub const FORCE_DRIFT: Self = row(Effect::CATALOGUE, "force_drift");
}

impl EffectId {
    /// Every effect of the catalogues: those of processes, of the shop, of part programs and of empirical responses.
    pub fn catalogue() -> impl Iterator<Item = Self> {
        [Effect::CATALOGUE, SHOP_EFFECTS, PROGRAM_EFFECTS, EMPIRICAL_EFFECTS].into_iter().flatten().map(Self)
    }

    /// The effect of the catalogues that a file or a document calls `word`; `None` if there is none.
    pub fn named(word: &str) -> Option<Self> {
        Self::catalogue().find(|effect| effect.word() == word)
    }

    /// Its row of the catalogue.
    pub fn entry(self) -> &'static CatalogueEntry {
        self.0
    }

    /// Its word in files and documents.
    pub fn word(self) -> &'static str {
        self.0.id
    }

    /// The effect that a simulated shop can have; `None` for an effect of a process, of a program or of a response.
    pub fn shop(self) -> Option<ShopEffect> {
        ShopEffect::from_word(self.word())
    }

    /// Channels that it moves.
    pub fn channels(self) -> impl Iterator<Item = ChannelId> {
        self.0.channels.iter().filter_map(|touched| ChannelId::from_word(touched.channel))
    }

    /// The words of several, in their order.
    pub fn words(effects: &[Self]) -> Vec<&'static str> {
        effects.iter().map(|effect| effect.word()).collect()
    }

    /// Whether it is no cause but a rate of wear that is another one on a part of the records.
    pub fn is_wear_rate(self) -> bool {
        self.word() == WEAR_RATE
    }

    /// Factor from SI to the display unit of its size, and the unit.
    pub fn report_units(self) -> (f64, &'static str) {
        (self.0.size.to_display(1.0), self.0.size.display)
    }
}

impl From<&'static CatalogueEntry> for EffectId {
    fn from(entry: &'static CatalogueEntry) -> Self {
        Self(entry)
    }
}

impl From<ShopEffect> for EffectId {
    fn from(effect: ShopEffect) -> Self {
        Self(effect.entry())
    }
}

impl From<&Effect> for EffectId {
    fn from(effect: &Effect) -> Self {
        Self(effect.entry())
    }
}

impl From<&'static Definition> for EffectId {
    fn from(definition: &'static Definition) -> Self {
        Self(definition.entry())
    }
}

/// Two are the same where their word is: no word stands twice among the effects that one run knows.
impl PartialEq for EffectId {
    fn eq(&self, other: &Self) -> bool {
        self.word() == other.word()
    }
}

impl Eq for EffectId {}

impl fmt::Display for EffectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl fmt::Debug for EffectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_word_stands_twice_in_the_catalogues_and_each_is_found_again() {
        let words: Vec<&str> = EffectId::catalogue().map(EffectId::word).collect();
        assert_eq!(words.iter().collect::<BTreeSet<_>>().len(), words.len());
        for effect in EffectId::catalogue() {
            assert_eq!(EffectId::named(effect.word()), Some(effect));
        }
        for word in ShopEffect::WORDS {
            let effect = ShopEffect::from_word(word).expect("its own word");
            assert_eq!(EffectId::from(effect).shop(), Some(effect));
        }
    }

    /// A word that no process has would be searched by none and be the parameter of no unit.
    #[test]
    fn every_process_of_an_effect_is_one() {
        for entry in Effect::CATALOGUE {
            for process in entry.process_names() {
                assert!(["turning", "milling", "infeed"].contains(&process), "{} acts on {process}", entry.id);
            }
        }
    }

    #[test]
    fn what_an_effect_moves_is_a_channel() {
        for effect in EffectId::catalogue() {
            for channel in effect.entry().channels {
                assert!(ChannelId::from_word(channel.channel).is_some(), "{effect} moves {}", channel.channel);
            }
        }
    }
}
