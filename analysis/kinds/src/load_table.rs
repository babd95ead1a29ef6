//! Load against capacity as a table for people, and for programs.

use crate::workload::{Load, Workload};
use serde_json::{Value, json};
use std::fmt::Write as _;

impl Workload {
    /// The table for people; empty where nothing is to be done.
    pub fn text(&self) -> String {
        let mut text = String::new();
        if self.loads.is_empty() {
            return text;
        }
        let width = self.loads.iter().map(|load| load.name.chars().count()).max().unwrap_or(0).max(7);
        let _ = write!(
            text,
            "\nload until the horizon, mean times, one setup a lot\n  {:width$}  {:>10}  {:>10}  {:>10}  {:>6}",
            "station", "work", "setups", "capacity", "load"
        );
        for load in &self.loads {
            let hours = |seconds: f64| format!("{:.1} h", seconds / 3600.0);
            let _ = write!(
                text,
                "\n  {:width$}  {:>10}  {:>10}  {:>10}  {:>6}",
                load.name,
                hours(load.work),
                hours(load.setup),
                hours(load.capacity),
                if load.endless { "any".to_owned() } else { format!("{:.0} %", 100.0 * load.share()) },
            );
        }
        if self.loads.iter().any(|load| load.endless) {
            text += "\n  any: `constant_work` replaces every job that leaves, so that demand has no limit; orders and other sources are told";
        }
        text
    }

    /// The same for programs.
    pub fn json(&self) -> (String, Value) {
        let load = |load: &Load| {
            json!({
                "station": load.name,
                "work [h]": load.work / 3600.0,
                "setup [h]": load.setup / 3600.0,
                "capacity [h]": load.capacity / 3600.0,
                "load": (!load.endless).then(|| load.share()),
                "unlimited_demand": load.endless,
            })
        };
        let loads: Vec<Value> = self.loads.iter().map(load).collect();
        ("load".to_owned(), json!(loads))
    }
}
