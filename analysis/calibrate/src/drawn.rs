//! Tables of draws: those of a calibration, and those of what is known before any data.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::fs::File;
use toolroom_process::unit;
use toolroom_records::table::{Kind, NewTable, TableError, Value};
use toolroom_wear::{EDGE_SCATTER_NAME, ParameterSet, Spread};

/// Numbers that are drawn for one value before its range is taken to leave no room (assumption: a prior of which less than
/// a hundredth lies in the range is none).
const TRIES: usize = 1000;

/// Greatest scatter of edges that tools of scenarios take.
const MOST_SCATTER: f64 = 2.0;

/// Draws of parameters in units of files.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnTable {
    /// `group.parameter [unit]` of each column.
    pub columns: Vec<String>,
    /// A row a draw.
    pub rows: Vec<Vec<f64>>,
    /// Group of the wear law.
    pub law: &'static str,
}

impl DrawnTable {
    /// `count` draws of what `[prior]` of a set says of its values, each for itself, and of the scatter of edges by its median
    /// and the standard deviation of its logarithm. A value outside the range of its parameter is drawn anew. The same seed
    /// gives the same draws.
    pub fn of_prior(set: &ParameterSet, scatter: (f64, f64), count: usize, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let known = |(key, spread): (&String, &Spread)| {
            let value = set.values.iter().find(|value| value.key() == *key)?;
            let unit = value.field.display;
            let column = if unit == "1" { key.clone() } else { format!("{key} [{unit}]") };
            Some((column, value, *spread))
        };
        let known: Vec<_> = set.prior.iter().filter_map(known).collect();
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let row = |_: usize| {
            let one = |(_, value, spread): &(String, &toolroom_wear::ParameterValue, Spread)| {
                let field = value.field;
                let shown = unit::convert(value.value, field.unit, field.display);
                let mut drawn = || match spread {
                    Spread::Factor(factor) => shown * (factor.ln() * normal()).exp(),
                    Spread::Deviation(deviation) => shown + deviation * normal(),
                };
                // Exponents of handbooks are not below zero.
                let possible = |drawn: &f64| {
                    *drawn >= 0.0 && field.check(unit::convert(*drawn, field.display, field.unit)).is_ok()
                };
                (0..TRIES).map(|_| drawn()).find(possible).unwrap_or(shown)
            };
            let mut row: Vec<f64> = known.iter().map(one).collect();
            let spread =
                (0..TRIES).map(|_| scatter.0 * (scatter.1 * normal()).exp()).find(|drawn| *drawn <= MOST_SCATTER);
            row.push(spread.unwrap_or(MOST_SCATTER));
            row
        };
        let rows = (0..count).map(row).collect();
        let columns = known.iter().map(|(column, ..)| column.clone()).chain([EDGE_SCATTER_NAME.to_owned()]).collect();
        Self { columns, rows, law: set.law.unwrap_or_default() }
    }

    /// Writes the table: its columns, `law`, and `weight`, which is 1.
    ///
    /// # Errors
    /// What the format says.
    pub fn write(&self, file: File, new_table: NewTable<'_>) -> Result<(), TableError> {
        let columns = self.columns.iter().map(|name| (name.as_str(), Kind::Real));
        let columns: Vec<(&str, Kind)> = columns.chain([("law", Kind::Text), ("weight", Kind::Real)]).collect();
        let mut table = new_table(file, &columns)?;
        for row in &self.rows {
            let numbers = row.iter().map(|value| Value::Real(Some(*value)));
            let cells: Vec<Value<'_>> = numbers.chain([Value::Text(self.law), Value::Real(Some(1.0))]).collect();
            table.row(&cells)?;
        }
        table.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_wear::{EDGE_SCATTER, EDGE_SCATTER_DEVIATION, FirstSet, KnownLife, TURNING_SETS};

    const SCATTER: (f64, f64) = (EDGE_SCATTER, EDGE_SCATTER_DEVIATION);

    #[test]
    fn draws_of_a_first_set_spread_as_its_answer_says() {
        let known = KnownLife {
            life: "15 min",
            cutting_speed: "200 m/min",
            feed: "0.25 mm/rev",
            depth_of_cut: "1.5 mm",
            wear_limit: "0.3 mm",
            tool_material: "carbide",
            iso513: "P",
        };
        let first = FirstSet::read(&known).expect("a life");
        let set = ParameterSet::parse("first.toml", &first.to_toml("first"), &TURNING_SETS).expect("a set");
        let drawn = DrawnTable::of_prior(&set, SCATTER, 4000, 1);
        let place = |name: &str| drawn.columns.iter().position(|column| column.starts_with(name)).expect("a column");
        let (life, exponent) = (place("extended_taylor.reference_life"), place("extended_taylor.speed_exponent"));
        assert_eq!(drawn.columns[life], "extended_taylor.reference_life [min]");
        let mut lives: Vec<f64> =
            drawn.rows.iter().map(|row| row[life] * (250.0_f64 / 200.0).powf(-row[exponent])).collect();
        lives.sort_by(f64::total_cmp);
        let told = first.life.life_at(250.0 / 60.0);
        for (share, expected) in [(0.05, told.low), (0.5, told.median), (0.95, told.high)] {
            let found = lives[(share * 4000.0) as usize];
            assert!((found / (expected / 60.0) - 1.0).abs() < 0.05, "{share}: {found} against {}", expected / 60.0);
        }
        let feed = place("extended_taylor.feed_exponent");
        assert!(drawn.rows.iter().all(|row| row[feed] >= 0.0));
        assert_eq!(drawn, DrawnTable::of_prior(&set, SCATTER, 4000, 1));
    }
}
