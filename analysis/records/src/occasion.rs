//! Recorded operations as scopes see them.

use crate::Records;
use toolroom_scenario::Occasion;

/// Columns under which records hold what a scope may ask for; `part/operation` is told apart below.
const COLUMNS: [(&str, &str); 8] = [
    ("machine", "machine"),
    ("tool_id", "tool_id"),
    ("part", "part_type"),
    ("material", "material"),
    ("lot", "lot"),
    ("shift", "shift"),
    ("operator", "operator"),
    ("coolant", "coolant_id"),
];

impl Records {
    /// The operation of a row as scopes see it; `tool` is the name of its tool in the scenario, which records do
    /// not tell.
    ///
    /// The operation is the second part of an `operation_id` such as `J12/turn`.
    pub fn occasion(&self, row: usize, tool: Option<&str>) -> Occasion<'_> {
        let mut occasion = Occasion::default();
        if let Some(tool) = tool {
            occasion.set("tool", tool.to_owned());
        }
        let text = |column: &str| self.texts(column).map(|values| values[row].as_str()).filter(|text| !text.is_empty());
        for (key, column) in COLUMNS {
            if let Some(name) = text(column) {
                occasion.set(key, name);
            }
        }
        if let Some(operation) = text("operation_id").and_then(|id| id.split('/').nth(1)) {
            occasion.set("operation", operation);
        }
        occasion.time = self.numbers("start_time").map(|times| times[row]).filter(|time| time.is_finite());
        occasion
    }
}
