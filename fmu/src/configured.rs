//! A process with its parameter set, effects and policy, as the importer has configured it.

use crate::abi::at_unload;
use crate::fault::{Fault, Outcome};
use crate::unit::{AdaptivePolicy, Unit};
use std::any::{Any, TypeId};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use toolroom_cutting::Regeneration;
use toolroom_effects::Effects;
use toolroom_process::{AnyRecord, Field, Record};

/// Parameters as chosen, and the process that they make. Shared by the instance and its saved
/// states: it changes only where a parameter is set.
#[derive(Clone)]
pub(crate) struct Configured<U: Unit> {
    /// Name of the parameter set.
    pub set: String,
    /// The process with the effects that are switched on.
    pub process: U,
    /// The built-in policy.
    pub policy: AdaptivePolicy,
    /// What vibrates around the cut.
    machine: U::Machine,
    /// Every parameter, in the order of `fields`.
    pub values: Vec<f64>,
    /// Name and field of every parameter, as the set has it.
    pub fields: Arc<[(String, Field)]>,
    /// What wear changes of the vibration.
    regeneration: Regeneration,
    /// The process with every effect, also those of size zero.
    every: U,
    /// Parameters that were set by themselves; a later set leaves them alone.
    chosen: Vec<(usize, f64)>,
}

/// Name of a parameter in its unit; `effects` are the groups that are effects.
fn parameter_name(effects: &[&str], group: &str, field: &str) -> String {
    match (effects.contains(&group), field) {
        (false, name) => format!("{group}.{name}"),
        (true, "size") => format!("effect.{group}"),
        (true, name) => format!("shape.{group}.{name}"),
    }
}

/// The parameters of a process by the names that they have in its unit, with their values in SI; of effects those that are
/// switched on.
pub fn parameter_values<U: Unit>(process: &U) -> Vec<(String, f64)> {
    let mut process = process.clone();
    let effects: Vec<&str> = process.effects_mut().iter().map(|effect| effect.entry().id).collect();
    let groups = process.parameters_mut().into_iter();
    let values = groups.flat_map(|(group, record)| {
        let values = record.fields().iter().enumerate().filter_map(|(i, field)| Some((field.name, record.value(i)?)));
        values.map(|(field, value)| (parameter_name(&effects, group, field), value)).collect::<Vec<_>>()
    });
    values.collect()
}

/// Default sets that were read, by unit. Emptied when the library is unloaded, which would leave them behind.
struct Shipped {
    sets: Vec<(TypeId, Arc<dyn Any + Send + Sync>)>,
    /// Whether the emptying is arranged.
    ends: bool,
}

static SHIPPED: Mutex<Shipped> = Mutex::new(Shipped { sets: Vec::new(), ends: false });

fn shipped() -> MutexGuard<'static, Shipped> {
    SHIPPED.lock().unwrap_or_else(PoisonError::into_inner)
}

extern "C" fn forget() {
    let sets = std::mem::take(&mut shipped().sets);
    drop(sets);
}

impl<U: Unit> Configured<U> {
    /// The default set, read once a process: reading costs more than all else of an instance.
    pub fn shared() -> Arc<Self> {
        let mut kept = shipped();
        let known = kept.sets.iter().find(|(unit, _)| *unit == TypeId::of::<Self>());
        if let Some(Ok(known)) = known.map(|(_, set)| Arc::downcast(Arc::clone(set))) {
            return known;
        }
        let set = Arc::new(Self::shipped());
        kept.ends = kept.ends || at_unload(forget);
        if kept.ends {
            kept.sets.push((TypeId::of::<Self>(), Arc::clone(&set) as Arc<dyn Any + Send + Sync>));
        }
        set
    }

    /// The default set.
    pub fn shipped() -> Self {
        let (name, text) = U::SETS[0];
        Self::from_text(name, text).unwrap_or_else(|fault| panic!("the shipped set {name} is broken: {fault}"))
    }

    fn from_text(name: &str, text: &str) -> Outcome<Self> {
        let mut every = U::read(text).map_err(|reason| Fault::Set { name: name.to_owned(), reason })?;
        *every.effects_mut() = Effects::every(U::EFFECTS_OF);
        let mut configured = Self {
            set: name.to_owned(),
            process: every.clone(),
            policy: AdaptivePolicy::default(),
            machine: U::Machine::default(),
            values: Vec::new(),
            fields: Arc::new([]),
            regeneration: Regeneration::default(),
            every,
            chosen: Vec::new(),
        };
        let mut values = Vec::new();
        configured.visit(|record| values.extend((0..record.fields().len()).filter_map(|i| record.value(i))));
        configured.values = values;
        configured.fields = configured.described().into();
        configured.settle()?;
        Ok(configured)
    }

    /// Name and field of every parameter, as it is now.
    fn described(&mut self) -> Vec<(String, Field)> {
        let mut all = Vec::new();
        let effects: Vec<&str> = self.every.effects_mut().iter().map(|effect| effect.entry().id).collect();
        for (group, record) in self.every.parameters_mut() {
            for field in record.fields() {
                all.push((parameter_name(&effects, group, field.name), *field));
            }
        }
        if U::VIBRATES {
            all.extend(U::Machine::FIELDS.iter().map(|field| (format!("machine.{}", field.name), *field)));
            let wear = Regeneration::<f64>::FIELDS.iter();
            all.extend(wear.map(|field| (format!("regeneration.{}", field.name), *field)));
        }
        if U::ADAPTIVE {
            all.extend(AdaptivePolicy::<f64>::FIELDS.iter().map(|field| (format!("adaptive.{}", field.name), *field)));
        }
        debug_assert_eq!(all.len(), self.values.len(), "as visited");
        for ((_, field), value) in all.iter_mut().zip(&self.values) {
            field.start = *value;
        }
        all
    }

    /// Every record of parameters, in order.
    fn visit(&mut self, mut visitor: impl FnMut(&mut dyn AnyRecord)) {
        for (_, record) in self.every.parameters_mut() {
            visitor(record);
        }
        if U::VIBRATES {
            visitor(&mut self.machine);
            visitor(&mut self.regeneration);
        }
        if U::ADAPTIVE {
            visitor(&mut self.policy);
        }
    }

    /// Brings the process in line with `values`.
    fn settle(&mut self) -> Outcome<()> {
        let values = std::mem::take(&mut self.values);
        let mut index = 0;
        self.visit(|record| {
            for i in 0..record.fields().len() {
                record.set_value(i, values[index]);
                index += 1;
            }
        });
        self.values = values;
        let refused = |reason| Fault::Set { name: self.set.clone(), reason };
        self.process = self.every.clone();
        if U::VIBRATES && self.machine.get(0).is_some_and(|chatter| chatter > 0.5) {
            self.process.mount(&self.machine, self.regeneration).map_err(refused)?;
        }
        let active = self.every.effects_mut().iter().filter(|effect| effect.size() != 0.0).copied().collect();
        *self.process.effects_mut() =
            Effects::new(active).map_err(|error| Fault::Set { name: self.set.clone(), reason: error.to_string() })?;
        Ok(())
    }

    /// Sets parameters by index; each value lies in its range.
    pub fn assign(&mut self, parameters: &[(usize, f64)]) -> Outcome<()> {
        for &(i, value) in parameters {
            // Importers that write every start value have chosen nothing.
            if self.values[i] != value {
                self.values[i] = value;
                self.chosen.retain(|(chosen, _)| *chosen != i);
                self.chosen.push((i, value));
            }
        }
        self.settle()
    }

    /// Changes to the set `name`: the file `tools/name.toml` of the resources, or the shipped set.
    pub fn choose_set(&mut self, name: &str, resources: Option<&Path>) -> Outcome<()> {
        let known = || U::SETS.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(plain) {
            return Err(Fault::UnknownSet { name: name.to_owned(), known: known() }.into());
        }
        let file = resources.and_then(|folder| std::fs::read_to_string(folder.join(format!("tools/{name}.toml"))).ok());
        let shipped = U::SETS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text);
        let Some(text) = file.as_deref().or(shipped) else {
            return Err(Fault::UnknownSet { name: name.to_owned(), known: known() }.into());
        };
        let mut changed = Self::from_text(name, text)?;
        if changed.values.len() != self.values.len() {
            let reason = "it has another wear law than this unit".to_owned();
            return Err(Fault::Set { name: name.to_owned(), reason }.into());
        }
        // Machine and policy are no part of a set.
        let count = |there: bool, length: usize| if there { length } else { 0 };
        let extra = count(U::VIBRATES, U::Machine::LEN + Regeneration::<f64>::LEN)
            + count(U::ADAPTIVE, AdaptivePolicy::<f64>::LEN);
        let first = self.values.len() - extra;
        changed.values[first..].copy_from_slice(&self.values[first..]);
        for &(i, value) in &self.chosen {
            changed.values[i] = value;
        }
        changed.chosen = std::mem::take(&mut self.chosen);
        changed.settle()?;
        *self = changed;
        Ok(())
    }

    /// The parameters of a saved state.
    pub fn restored(set: &str, values: Vec<f64>, resources: Option<&Path>) -> Outcome<Self> {
        let mut configured = Self::clone(&Self::shared());
        if configured.set != set {
            configured.choose_set(set, resources)?;
        }
        if values.len() != configured.values.len() {
            return Err(Fault::Corrupt { reason: "another number of parameters" }.into());
        }
        let start = &configured.values;
        configured.chosen = values.iter().copied().enumerate().filter(|(i, value)| start[*i] != *value).collect();
        configured.values = values;
        configured.settle()?;
        Ok(configured)
    }
}
