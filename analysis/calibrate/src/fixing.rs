//! Parameters of a law that are held at a value.

use crate::parameter::Scale;
use crate::slot::Slot;
use crate::wear_model::WearModel;
use toolroom_process::Field;

impl WearModel {
    /// Fixes a parameter of the law at a value in its unit, also one that the shape of the wear curve leaves at zero; `false` where
    /// the law has none of this name.
    pub fn fix(&mut self, name: &str, value: f64) -> bool {
        let all = self.law.parameters(&self.template);
        let Some(slot) = all.iter().position(|parameter| parameter.name == name) else { return false };
        if let Slot::Free(index) = self.slots[slot] {
            self.parameters.remove(index);
            for slot in &mut self.slots {
                match slot {
                    Slot::Free(free) if *free > index => *free -= 1,
                    Slot::Free(_) | Slot::Fixed(_) | Slot::Tilt(_) => {}
                }
            }
        }
        self.slots[slot] = if all[slot].scale == Scale::Tilt { Slot::Tilt(value) } else { Slot::Fixed(value) };
        true
    }

    /// Whether the law has a parameter of this name, free or fixed.
    pub fn has(&self, name: &str) -> bool {
        self.law.parameters(&self.template).iter().any(|parameter| parameter.name == name)
    }

    /// Names of all parameters of the law, free or fixed.
    pub fn names(&self) -> Vec<String> {
        self.law.parameters(&self.template).into_iter().map(|parameter| parameter.name).collect()
    }

    /// Why no law has the values that are fixed, where the others are as expected.
    pub fn fault(&self) -> Option<String> {
        let expected: Vec<f64> = self.parameters.iter().map(|parameter| parameter.prior.mean).collect();
        let mut base = self.at(&expected);
        let record = base.law_mut();
        let fields = record.fields().iter().enumerate();
        let fault = |(index, field): (usize, &Field)| {
            let free = self.any_speed && field.name == "speed_exponent";
            if free { None } else { field.check(record.value(index)?).err() }
        };
        if let Some(fault) = fields.filter_map(fault).next() {
            return Some(fault.to_string());
        }
        base.stages().err().map(|error| error.to_string())
    }

    /// Whether a parameter of the law of this name is fixed already.
    pub fn fixed(&self, name: &str) -> bool {
        let all = self.law.parameters(&self.template);
        let slot = all.iter().position(|parameter| parameter.name == name).map(|index| self.slots[index]);
        matches!(slot, Some(Slot::Fixed(_) | Slot::Tilt(_)))
    }
}
