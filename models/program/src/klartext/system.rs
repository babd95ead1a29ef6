//! Values of the control that a program reads: FN 18.

use super::Klartext;
use crate::error::Fault;
use crate::kernel::Kernel;
use crate::motion::Sense;

impl Klartext {
    /// The value that `ID… NR… IDX…` names.
    ///
    /// # Source
    /// Tables of system data of the TNC, cited from memory (assumption). Only those are read that a program decides by itself.
    pub(super) fn system_value(&self, text: &str, kernel: &Kernel) -> Result<f64, Fault> {
        let mut numbers = [("IDX", None), ("ID", None), ("NR", None)];
        let mut words = text.split_whitespace();
        while let Some(word) = words.next() {
            let named = numbers.iter_mut().find_map(|(name, slot)| Some((word.strip_prefix(*name)?, slot)));
            let (rest, slot) =
                named.ok_or_else(|| Fault::new(format!("{word} is no part of FN 18; ID, NR and IDX are")))?;
            let value = if rest.is_empty() { words.next().unwrap_or_default() } else { rest };
            *slot = Some(self.value(value, 1)?);
        }
        let [index, id, number] = numbers.map(|(_, value)| value.map(|value| value.round() as i64));
        let (Some(id), Some(number)) = (id, number) else { return Err(Fault::new("FN 18 needs ID and NR")) };
        let unknown = || {
            let index = index.map_or(String::new(), |index| format!(" IDX{index}"));
            Fault::new(format!(
                "FN 18: ID{id} NR{number}{index} is not known here; ID20 NR1, NR3, NR4, NR5 and NR9 (tool, its axis, speed, sense, feed), \
                 ID50 NR2 (radius) and ID270 NR1 IDX1 to IDX3 (place) are"
            ))
            .refusing()
        };
        let scale = kernel.scale.unwrap_or(1.0);
        match (id, number, index) {
            (20, 1, _) => kernel.tool.map(f64::from).ok_or_else(unknown),
            // 0 is X, 1 is Y, 2 is Z.
            (20, 3, _) => Ok(kernel.plane[2] as f64),
            (20, 4, _) => Ok(kernel.speed),
            (20, 5, _) => match kernel.sense {
                Sense::Clockwise => Ok(0.0),
                Sense::Counterclockwise => Ok(1.0),
                Sense::Still | Sense::Oriented => Err(unknown()),
            },
            (20, 9, _) => kernel.feed.map(|feed| feed / scale).ok_or_else(unknown),
            (50, 2, tool) => {
                let tool = tool.and_then(|tool| u32::try_from(tool).ok()).or(kernel.tool).ok_or_else(unknown)?;
                let given = kernel.control.diameters.get(&tool).map(|diameter| 0.5 * diameter);
                let radius = given.or_else(|| self.radii.get(&tool).copied()).ok_or_else(unknown)?;
                Ok(radius / scale)
            }
            (270, 1, Some(axis @ 1..=3)) => {
                let axis = axis as usize - 1;
                if kernel.referenced[axis] { Ok(kernel.program_at()[axis] / scale) } else { Err(unknown()) }
            }
            _ => Err(unknown()),
        }
    }
}
