//! Effects switched on in a nominal model of part programs.

use crate::failure::Failure;
use serde_json::Value;
use toolroom_gap::program::{ProgramModel, effects_section};
use toolroom_process::{Record, unit};
use toolroom_scenario::effects::ShopDeviations;

/// Parts of the shape of an acceleration, and the keys of `[drives]` that say the same.
const DRIVES: [(&str, &str); 2] = [("corners within ", "corner_deviation"), ("jerk time ", "jerk_time")];

/// The text of a model with the effects of a diagnosis on top of those that it has.
pub fn applied(text: &str, model: &ProgramModel, named: &[Value]) -> Result<String, Failure> {
    let mut effects = model.effects;
    let mut drives: Vec<String> = Vec::new();
    for effect in named {
        let (id, shape) = (effect["id"].as_str().unwrap_or_default(), effect["shape"].as_str().unwrap_or_default());
        let written = format!("{} {}", effect["size"], effect["unit"].as_str().unwrap_or("1"));
        let index = ShopDeviations::<f64>::index_of(id)
            .ok_or_else(|| Failure::argument(format!("{id} is no effect of part programs"), "give their diagnosis"))?;
        let field = &ShopDeviations::<f64>::FIELDS[index];
        let size = if field.unit == "1" {
            effect["size"].as_f64().unwrap_or(0.0)
        } else {
            unit::quantity(&written, field.unit).map_err(|error| Failure::argument(error, "diagnose again"))?
        };
        effects.set(index, effects.get(index).unwrap_or(0.0) + size);
        for (part, (start, key)) in shape.split(", ").flat_map(|part| DRIVES.map(|drive| (part, drive))) {
            drives.extend(part.strip_prefix(start).map(|value| format!("{key} = \"{value}\"")));
        }
    }
    let mut lines: Vec<String> = Vec::new();
    let mut section = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with('[') {
            section = line.trim().to_owned();
        }
        let key = |line: &str| line.split('=').next().unwrap_or_default().trim().to_owned();
        let replaced = section == "[drives]" && drives.iter().any(|own| key(own) == key(line));
        if section != "[effects]" && !replaced {
            lines.push(line.to_owned());
        }
        if line.trim() == "[drives]" {
            lines.append(&mut drives.clone());
        }
    }
    if !drives.is_empty() && lines.iter().all(|line| line.trim() != "[drives]") {
        lines.push(format!("\n[drives]\n{}", drives.join("\n")));
    }
    Ok(format!("{}\n\n{}", lines.join("\n").trim_end(), effects_section(&effects)))
}

#[cfg(test)]
mod tests {
    use super::applied;
    use serde_json::json;
    use toolroom_gap::program::ProgramModel;
    use toolroom_scenario::effects::ShopDeviations;

    #[test]
    fn effects_add_to_those_that_are_on() {
        let effects = ShopDeviations { tool_change_delay: 2.0, ..ShopDeviations::default() };
        let model = ProgramModel { effects, ..ProgramModel::default() };
        let text = "schema = 1\n[drives]\ncorner_deviation = \"5 um\"\n[effects]\ntool_change_delay = \"2 s\"\n[[program]]\nname = \"A\"\n";
        let named = [
            json!({ "id": "tool_change_delay", "shape": "", "size": 3.5, "unit": "s" }),
            json!({ "id": "axis_acceleration", "shape": "corners within 10 um", "size": 0.5, "unit": "s2/m" }),
        ];
        let out = applied(text, &model, &named).expect("known effects");
        assert!(
            out.contains("tool_change_delay = \"5.5 s\"") && out.contains("axis_acceleration = \"0.5 s2/m\""),
            "{out}"
        );
        assert!(out.contains("corner_deviation = \"10 um\"") && !out.contains("5 um\"\n["), "{out}");
        assert_eq!(out.matches("[effects]").count(), 1);
        assert!(out.contains("[[program]]\nname = \"A\""), "{out}");
    }
}
