//! A list of effects.

use crate::{Context, Effect, EffectError, Terms};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use toolroom_process::{AnyRecord, ModelError, Number};

/// The effects of a process, each shape of one at most once, in the order in which they act.
///
/// Factors multiply and summands add up, so the order changes nothing but the last bit.
///
/// ```
/// use toolroom_effects::{Context, Effects};
/// let effects: Effects = serde_json::from_str(r#"[{ "id": "wear_force", "size": 0.2 }]"#).unwrap();
/// let worn = Context { flank_wear: 0.3e-3, ..Context::neutral() };
/// assert_eq!(effects.terms(&worn).cutting_force, 1.2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Effects<N: Copy = f64>(Vec<Effect<N>>);

impl<N: Copy> Default for Effects<N> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<N: Copy> Effects<N> {
    /// The effects, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Effect<N>> {
        self.0.iter()
    }

    /// Whether there is none: [`Effects::terms`] is neutral whatever the context.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether an effect that a user has defined is among them.
    pub fn has_defined(&self) -> bool {
        self.0.iter().any(|effect| matches!(effect, Effect::User(_)))
    }

    /// Does `work`, which evaluates these effects on this thread, and refuses its result where one that a user has defined
    /// gave no number or drove a term out of its range. Effects of the catalogue stay within it; where there are no others
    /// this is `work` alone.
    ///
    /// # Errors
    /// [`ModelError::EffectValue`], or what `work` refuses.
    pub fn watched<T>(&self, work: impl FnOnce() -> Result<T, ModelError>) -> Result<T, ModelError> {
        if self.has_defined() { toolroom_process::watched(work)? } else { work() }
    }

    /// The same effects over another number type.
    pub fn map<M: Copy>(&self, mut convert: impl FnMut(N) -> M) -> Effects<M> {
        Effects(self.0.iter().map(|effect| effect.map(&mut convert)).collect())
    }

    /// What the effects make of the cut that `context` describes. Plain sizes serve dual
    /// contexts and dual sizes serve dual contexts, so that states, inputs and sizes can all
    /// carry derivatives.
    pub fn terms<M: Number + From<N>>(&self, context: &Context<M>) -> Terms<M> {
        let mut terms = Terms::neutral();
        for effect in &self.0 {
            effect.map(M::from).act(context, &mut terms);
        }
        terms
    }
}

impl Effects {
    /// A list of effects.
    ///
    /// # Errors
    /// [`EffectError::Twice`] where an effect of one shape is listed twice.
    pub fn new(effects: Vec<Effect>) -> Result<Self, EffectError> {
        for (i, effect) in effects.iter().enumerate() {
            if effects[..i].iter().any(|earlier| earlier.with_size(0.0) == effect.with_size(0.0)) {
                return Err(EffectError::Twice { id: effect.entry().id });
            }
        }
        Ok(Self(effects))
    }

    /// Effects of which some may be of one shape: entries of a file whose scopes meet in an operation. Their
    /// factors multiply and their summands add up, in the order of the list.
    pub fn overlaid(effects: Vec<Effect>) -> Self {
        Self(effects)
    }

    /// Every effect of a process at size zero: nothing changes until a size is set, which is
    /// what an FMU's parameters and a diagnosis start from.
    ///
    /// ```
    /// use toolroom_effects::{Context, Effects, Terms};
    /// let off = Effects::every("infeed");
    /// assert_eq!(off.terms(&Context::<f64>::neutral()), Terms::neutral());
    /// ```
    pub fn every(process: &str) -> Self {
        Self(Effect::all().filter(|effect| effect.entry().search(process).is_some()).collect())
    }

    /// That every effect acts on `process`.
    ///
    /// # Errors
    /// [`EffectError::NotOfProcess`] for the first that does not.
    pub fn check(&self, process: &'static str) -> Result<(), EffectError> {
        match self.iter().find(|effect| effect.entry().search(process).is_none()) {
            None => Ok(()),
            Some(effect) => {
                let known = Self::every(process).iter().map(|effect| effect.entry().id).collect::<Vec<_>>().join(", ");
                Err(EffectError::NotOfProcess { id: effect.entry().id, process, known })
            }
        }
    }

    /// The effect called `id`.
    pub fn find_mut(&mut self, id: &str) -> Option<&mut Effect> {
        self.0.iter_mut().find(|effect| effect.entry().id == id)
    }

    /// Parameter groups by effect id, as [`Process::parameters_mut`] hands them on.
    ///
    /// [`Process::parameters_mut`]: toolroom_process::Process::parameters_mut
    pub fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        self.0.iter_mut().map(|effect| (effect.entry().id, effect.parameters_mut())).collect()
    }
}

impl Serialize for Effects {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&self.0)
    }
}

impl<'de> Deserialize<'de> for Effects {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::new(Vec::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}
