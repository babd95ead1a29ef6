//! Variables of macros and of LinuxCNC.

use crate::Dialect;
use crate::motion::Axes;
use std::collections::{BTreeMap, HashMap};
use toolroom_dialect::Variables;

/// Variables of one level of calls.
#[derive(Clone, Debug)]
pub(super) struct Locals {
    pub numbered: [Option<f64>; 34],
    pub named: HashMap<String, f64>,
}

impl Default for Locals {
    fn default() -> Self {
        Self { numbered: [None; 34], named: HashMap::new() }
    }
}

/// Variables of a program.
#[derive(Clone, Debug)]
pub(super) struct Store {
    pub dialect: Dialect,
    pub levels: Vec<Locals>,
    common: BTreeMap<u32, f64>,
    global: HashMap<String, f64>,
    /// Position in program coordinates and units, and modal codes by group from 1, for the system's variables.
    pub position: Axes,
    pub modal: BTreeMap<u32, f64>,
}

impl Store {
    pub fn new(dialect: Dialect) -> Self {
        Self {
            dialect,
            levels: vec![Locals::default()],
            common: BTreeMap::new(),
            global: HashMap::new(),
            position: [0.0; 9],
            modal: BTreeMap::new(),
        }
    }

    fn locals(&self) -> &Locals {
        &self.levels[self.levels.len() - 1]
    }

    /// Sets a numbered variable; a vacant value makes it vacant.
    pub fn set(&mut self, index: u32, value: Option<f64>) -> Result<(), String> {
        let level = self.levels.len() - 1;
        let linuxcnc = self.dialect == Dialect::LinuxCnc;
        let local = if linuxcnc { 1..=30 } else { 1..=33 };
        if local.contains(&index) {
            self.levels[level].numbered[index as usize] = value;
            return Ok(());
        }
        let free = if linuxcnc {
            (31..=5000).contains(&index)
        } else {
            (100..=199).contains(&index) || (500..=999).contains(&index)
        };
        if !free {
            return Err(format!(
                "#{index} belongs to the control, and what is written there is not followed; write to {}",
                if linuxcnc { "#1 to #5000" } else { "#1 to #33, #100 to #199 or #500 to #999" }
            ));
        }
        match value {
            Some(value) => self.common.insert(index, value),
            None => self.common.remove(&index),
        };
        Ok(())
    }

    /// Variables that have a value, as programs write them: numbers, then names.
    pub fn known(&self) -> Vec<(String, f64)> {
        let locals = self.locals();
        let numbered = (1..).zip(&locals.numbered[1..]).filter_map(|(index, value)| Some((index, (*value)?)));
        let common = self.common.iter().map(|(index, value)| (*index, *value));
        let mut named: Vec<(String, f64)> =
            locals.named.iter().chain(&self.global).map(|(name, value)| (format!("#<{name}>"), *value)).collect();
        named.sort_by(|a, b| a.0.cmp(&b.0));
        numbered.chain(common).map(|(index, value)| (format!("#{index}"), value)).chain(named).collect()
    }

    pub fn name(&mut self, name: &str, value: f64) {
        if name.starts_with('_') {
            self.global.insert(name.to_owned(), value);
        } else {
            let level = self.levels.len() - 1;
            self.levels[level].named.insert(name.to_owned(), value);
        }
    }
}

impl Variables for Store {
    fn number(&self, index: u32) -> Result<Option<f64>, String> {
        let linuxcnc = self.dialect == Dialect::LinuxCnc;
        let vacant = |value: Option<f64>| if linuxcnc { Some(value.unwrap_or(0.0)) } else { value };
        Ok(match index {
            0 => vacant(None),
            1..=33 if !linuxcnc || index <= 30 => vacant(self.locals().numbered[index as usize]),
            31..=5000 if linuxcnc => vacant(self.common.get(&index).copied()),
            100..=199 | 500..=999 => self.common.get(&index).copied(),
            5420..=5428 if linuxcnc => Some(self.position[index as usize - 5420]),
            // The position at the end of the block and that in machine coordinates, which differ by offsets that are
            // not known: only differences of the latter mean anything.
            5001..=5009 if !linuxcnc => Some(self.position[index as usize - 5001]),
            5041..=5049 if !linuxcnc => Some(self.position[index as usize - 5041]),
            4001..=4130 if !linuxcnc => match self.modal.get(&(index - 4000)) {
                Some(value) => Some(*value),
                None => return Err(format!("#{index} is a modal value that is not known here")),
            },
            _ => {
                return Err(format!(
                    "#{index} is a value of the control that a program without its machine does not have; assign a number instead"
                ));
            }
        })
    }

    fn named(&self, name: &str) -> Result<Option<f64>, String> {
        let system = match name {
            "_X" => Some(self.position[0]),
            "_Y" => Some(self.position[1]),
            "_Z" => Some(self.position[2]),
            "_A" => Some(self.position[3]),
            "_B" => Some(self.position[4]),
            "_C" => Some(self.position[5]),
            _ => None,
        };
        Ok(system.or_else(|| self.global.get(name).copied()).or_else(|| self.locals().named.get(name).copied()))
    }
}
