//! Draws of a posterior, of which each replication takes the parameters of a tool.

use crate::ProcessModel;
use rand::seq::SliceRandom;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use toolroom_cutting::Turning;
use toolroom_form::{Section, Value};
use toolroom_kernel::{Entity, Purpose, Streams};
use toolroom_process::{AnyRecord, Process as _, unit};
use toolroom_wear::{Pair, Scatter};

/// Name of the scatter of edges among the columns.
const EDGE_SCATTER: &str = toolroom_wear::EDGE_SCATTER_NAME;
/// Name of the error of wear readings among the columns; a shop has its own sensor sheet.
const READING_NOISE: &str = toolroom_wear::READING_NOISE_NAME;
/// Name of the noise of the wear rate within a life among the columns.
const LIFE_NOISE: &str = "life_noise";
/// Greatest scatter of edges and noise within a life, as in [`toolroom_wear::Scatter`].
const MOST_SCATTER: f64 = 2.0;
/// Parts of the draws of which each round takes one (assumption: a comparison seldom has fewer than eight draws).
const PARTS: usize = 8;
/// Steps of the power iteration for the first principal component; only the order along it matters.
const ITERATIONS: usize = 50;

/// A table of draws as it was read: headers and the text of each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawTable {
    /// Headers, `group.parameter [unit]`, `law`, `weight`.
    pub header: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

/// Reads a table of draws; answers with what is wrong where it cannot.
pub type DrawReader = fn(&Path) -> Result<DrawTable, String>;

static READER: OnceLock<DrawReader> = OnceLock::new();

/// Names the reader of tables of draws for this program; the first one stays. This crate knows no table format itself.
pub fn set_draw_reader(reader: DrawReader) {
    let _ = READER.set(reader);
}

/// Reads a table of draws.
fn read_draws(path: &Path) -> Result<DrawTable, String> {
    let reader = READER.get().ok_or("this program has no reader of tables of draws")?;
    reader(path)
}

/// The draws of a file for a process whose section of a scenario or study also has the keys `scatter`, `parameters` and `handbook`:
/// what is stated there stays, or is refused where the draws hold it as well.
///
/// # Errors
/// In words: a file that is no table of draws, or draws that do not fit the section.
pub fn read_posterior(path: &Path, section: &Section<'_>, process: &ProcessModel) -> Result<Posterior, String> {
    if section.given("handbook") {
        return Err("`handbook` states constants, which the draws are of as well: leave one of the two out".to_owned());
    }
    let posterior = Posterior::of(&read_draws(path)?, process, section.given("scatter"))?;
    let stated = |name: &&String| {
        let parameter = name.split_once('.').zip(section.got("parameters"));
        parameter.is_some_and(|((group, field), got)| {
            let Value::Raw(raw) = &got.value else { return false };
            raw.get(group).is_some_and(|group| group.get_ref().get(field).is_some())
        })
    };
    match posterior.names().iter().find(stated) {
        Some(name) => {
            Err(format!("`parameters` states {name}, which the draws hold as well: leave one of the two out"))
        }
        None => Ok(posterior),
    }
}

/// The same for a section whose process is turning of a pair.
///
/// # Errors
/// As [`read_posterior`].
pub fn read_posterior_of_pair(path: &Path, section: &Section<'_>, pair: &Pair) -> Result<Posterior, String> {
    let turning = Turning { pair: pair.clone(), ..Turning::default() };
    read_posterior(path, section, &ProcessModel::Turning(Arc::new(turning)))
}

/// What a column of draws stands for.
#[derive(Clone, Debug, PartialEq)]
enum Column {
    /// A parameter of the process: its group, its place in the group.
    Parameter(&'static str, usize),
    /// The scatter of edges.
    EdgeScatter,
    /// The noise of the wear rate within a life.
    LifeNoise,
}

/// Equally likely values of the parameters of a tool.
///
/// The draws are in the order of their first principal component, in eight parts of equal number. A study takes them in
/// rounds: each round takes one draw of every part, in random order, so that few replications already meet low, middle
/// and high draws. The order belongs to the seed of the study and to the name of the tool: every policy and every shard
/// meets the same draws, and two tools are independent of each other (a Latin hypercube of the parts).
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    columns: Vec<Column>,
    /// `group.parameter` of each column.
    names: Vec<String>,
    /// SI, a row a draw.
    draws: Vec<Vec<f64>>,
}

impl Posterior {
    /// The draws of a table for the parameters of `process`. The scatter of edges comes from the draws, too, unless the tool
    /// states its scatter (`scatter_stated`).
    ///
    /// # Errors
    /// In words, with the row: no draw, a parameter that the process does not have, a number out of its range, unequal
    /// weights.
    pub fn of(table: &DrawTable, process: &ProcessModel, scatter_stated: bool) -> Result<Self, String> {
        let mut process = process.clone();
        let (mut columns, mut names, mut fields, mut places) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (place, header) in table.header.iter().enumerate() {
            let (name, unit) = match header.split_once('[') {
                Some((name, unit)) => (name.trim(), unit.trim_end_matches(']').trim()),
                None => (header.trim(), "1"),
            };
            let column = match name {
                READING_NOISE => continue,
                "law" => {
                    same_law(table, place, &process)?;
                    continue;
                }
                // The factor of a group of edges that is not the one of the set.
                _ if name.contains('=') => continue,
                LIFE_NOISE if scatter_stated => continue,
                LIFE_NOISE => Column::LifeNoise,
                "weight" => {
                    equal(table, place)?;
                    continue;
                }
                EDGE_SCATTER if scatter_stated => continue,
                EDGE_SCATTER => Column::EdgeScatter,
                _ => parameter(&mut process, name)?,
            };
            let field = match column {
                Column::Parameter(group, index) => with_group(&mut process, group, |record| &record.fields()[index]),
                Column::EdgeScatter | Column::LifeNoise => None,
            };
            if let Some(field) = field
                && !unit::convert(1.0, unit, field.unit).is_finite()
            {
                return Err(format!("column `{header}`: a {} cannot be in {unit}", field.name));
            }
            columns.push(column);
            names.push(name.to_owned());
            fields.push((field, unit));
            places.push(place);
        }
        if !columns.iter().any(|column| matches!(column, Column::Parameter(..))) {
            return Err(
                "no column is a parameter of the process, such as `extended_taylor.reference_life [min]`".into()
            );
        }
        let mut draws = Vec::with_capacity(table.rows.len());
        for (row, cells) in table.rows.iter().enumerate() {
            let mut draw = Vec::with_capacity(places.len());
            for ((place, (field, unit)), name) in places.iter().zip(&fields).zip(&names) {
                let text = cells.get(*place).map_or("", String::as_str).trim();
                let refuse = |reason: &str| format!("row {}, {name} = {text}: {reason}", row + 1);
                let number: f64 = text.parse().map_err(|_| refuse("a number is due"))?;
                let value = field.map_or(number, |field| unit::convert(number, unit, field.unit));
                match field {
                    Some(field) => field.check(value).map_err(|reason| refuse(&reason.to_string()))?,
                    None if (0.0..=MOST_SCATTER).contains(&value) => {}
                    None => return Err(refuse("a scatter lies between 0 and 2")),
                }
                draw.push(value);
            }
            draws.push(draw);
        }
        if draws.is_empty() {
            return Err("there is no draw".to_owned());
        }
        along_the_first_component(&mut draws);
        Ok(Self { columns, names, draws })
    }

    /// Names of the parameters that it holds, `group.parameter`.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Values of a parameter by its name, SI, a value a draw; `None` where the draws do not hold it.
    pub(crate) fn values(&self, name: &str) -> Option<Vec<f64>> {
        let column = self.names.iter().position(|own| own == name)?;
        Some(self.draws.iter().map(|draw| draw[column]).collect())
    }

    /// The draws, along their first principal component.
    pub(crate) fn each(&self) -> impl Iterator<Item = &[f64]> {
        self.draws.iter().map(Vec::as_slice)
    }

    /// Number of draws.
    pub fn count(&self) -> usize {
        self.draws.len()
    }

    /// Draw number `number` of a study for a tool, SI; numbers beyond the last draw begin again.
    pub fn draw(&self, seed: u64, tool: &str, number: u32) -> &[f64] {
        &self.draws[self.order(seed, tool)[number as usize % self.draws.len()]]
    }

    /// Tool and work material with its scatter as each draw has them, in the order in which a study takes the draws for a
    /// tool. A column that stands for no parameter of the pair leaves it as it is.
    pub fn pairs(&self, seed: u64, tool: &str, pair: &Pair, scatter: &Scatter) -> Vec<(Pair, Scatter)> {
        let turning = Turning { pair: pair.clone(), ..Turning::default() };
        let process = ProcessModel::Turning(Arc::new(turning));
        let pair_of = |place: usize| {
            let (mut process, mut scatter) = (process.clone(), *scatter);
            self.put(&self.draws[place], &mut process, &mut scatter);
            match process {
                ProcessModel::Turning(turning) => Some((turning.pair.clone(), scatter)),
                ProcessModel::Milling(_) | ProcessModel::Infeed(_) | ProcessModel::Other(_) => None,
            }
        };
        self.order(seed, tool).into_iter().filter_map(pair_of).collect()
    }

    /// Places of the draws in the order in which a study takes them for a tool.
    fn order(&self, seed: u64, tool: &str) -> Vec<usize> {
        let count = self.draws.len();
        let mut random = Streams::new(seed, 0).open(Entity::named(tool), Purpose::Parameters);
        let parts = PARTS.min(count);
        let mut members: Vec<Vec<usize>> =
            (0..parts).map(|part| (part * count / parts..(part + 1) * count / parts).collect()).collect();
        members.iter_mut().for_each(|members| members.shuffle(&mut random));
        let mut turn: Vec<usize> = (0..parts).collect();
        let mut order: Vec<usize> = Vec::with_capacity(count);
        for round in 0..count.div_ceil(parts) {
            turn.shuffle(&mut random);
            order.extend(turn.iter().filter_map(|part| members[*part].get(round)));
        }
        order
    }

    /// A tool whose set takes the values of a draw; `bare` is its process without effects and calibration.
    pub(crate) fn put(&self, draw: &[f64], bare: &mut ProcessModel, scatter: &mut Scatter) {
        for (column, value) in self.columns.iter().zip(draw) {
            match column {
                Column::Parameter(group, index) => {
                    with_group(bare, group, |record| record.set_value(*index, *value));
                }
                Column::EdgeScatter => scatter.common_wear = *value,
                Column::LifeNoise => scatter.life_noise = *value,
            }
        }
    }
}

/// Refuses weights that differ.
fn equal(table: &DrawTable, place: usize) -> Result<(), String> {
    let told = |row: &Vec<String>| row.get(place).map_or("", String::as_str).trim().to_owned();
    let first = table.rows.first().map(told).unwrap_or_default();
    if !table.rows.is_empty() && !first.parse::<f64>().is_ok_and(|weight| weight > 0.0 && weight.is_finite()) {
        return Err(format!("row 1: a draw of weight {first} is none; weights are equal and above 0"));
    }
    let position = table.rows.iter().position(|row| told(row) != first);
    position.map_or(Ok(()), |row| {
        Err(format!("row {}: the weights differ; draws are to be resampled to equal weights", row + 1))
    })
}

/// The draws are those of the law of the process.
fn same_law(table: &DrawTable, place: usize, process: &ProcessModel) -> Result<(), String> {
    let ProcessModel::Turning(turning) = process else { return Ok(()) };
    let law = turning.pair.law.group();
    let told = |row: &Vec<String>| row.get(place).map_or("", String::as_str).trim().to_owned();
    let other = table.rows.iter().map(told).enumerate().find(|(_, told)| told != law);
    other.map_or(Ok(()), |(row, told)| {
        Err(format!(
            "row {}: the draw is of the law {told}, and the set has {law}: give the set of the same calibration",
            row + 1
        ))
    })
}

/// The column of `group.parameter`.
fn parameter(process: &mut ProcessModel, name: &str) -> Result<Column, String> {
    let (mut known, mut found) = (Vec::new(), None);
    groups(process, &mut |group, record| {
        for (index, field) in record.fields().iter().enumerate() {
            let key = format!("{group}.{}", field.name);
            if key == name {
                found = Some(Column::Parameter(group, index));
            }
            known.push(key);
        }
    });
    found.ok_or_else(|| {
        // A parameter of another group that is called alike was not meant: exponents have the same names in many.
        let group = name.split_once('.').map_or(name, |(group, _)| group);
        let alike = known.iter().map(String::as_str).filter(|key| key.split_once('.').is_some_and(|(of, _)| of == group));
        let near = toolroom_form::nearest(name, alike);
        let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        format!("the process of the tool has no parameter `{name}`{near}; draws of another wear law belong to a set with that law")
    })
}

/// Calls `each` with every group of parameters.
fn groups(process: &mut ProcessModel, visit: &mut dyn FnMut(&'static str, &mut dyn AnyRecord)) {
    match process {
        ProcessModel::Turning(process) => {
            Arc::make_mut(process).parameters_mut().into_iter().for_each(|(name, record)| visit(name, record));
        }
        ProcessModel::Milling(process) => {
            Arc::make_mut(process).parameters_mut().into_iter().for_each(|(name, record)| visit(name, record));
        }
        ProcessModel::Infeed(process) => {
            Arc::make_mut(process).parameters_mut().into_iter().for_each(|(name, record)| visit(name, record));
        }
        // A unit keeps its parameters to itself.
        ProcessModel::Other(_) => {}
    }
}

pub(crate) fn with_group<T>(
    process: &mut ProcessModel,
    group: &str,
    work: impl Fn(&mut dyn AnyRecord) -> T,
) -> Option<T> {
    let mut done = None;
    groups(process, &mut |name, record| {
        if name == group && done.is_none() {
            done = Some(work(record));
        }
    });
    done
}

/// Orders draws along the first principal component of their values, each in units of its own deviation.
fn along_the_first_component(draws: &mut [Vec<f64>]) {
    let (count, size) = (draws.len() as f64, draws[0].len());
    let mean: Vec<f64> = (0..size).map(|i| draws.iter().map(|draw| draw[i]).sum::<f64>() / count).collect();
    let spread = |i: usize| (draws.iter().map(|draw| (draw[i] - mean[i]).powi(2)).sum::<f64>() / count).sqrt();
    let spread: Vec<f64> = (0..size).map(|i| Some(spread(i)).filter(|spread| *spread > 0.0).unwrap_or(1.0)).collect();
    let score = |draw: &[f64], axis: &[f64]| (0..size).map(|i| axis[i] * (draw[i] - mean[i]) / spread[i]).sum::<f64>();
    // Unequal parts, so that the first axis is not perpendicular to the component by symmetry.
    let mut axis: Vec<f64> = (0..size).map(|i| 1.0 / (i + 1) as f64).collect();
    for _ in 0..ITERATIONS {
        let mut next = vec![0.0; size];
        for draw in draws.iter() {
            let component = score(draw, &axis);
            next.iter_mut().enumerate().for_each(|(i, next)| *next += component * (draw[i] - mean[i]) / spread[i]);
        }
        let length = next.iter().map(|part| part * part).sum::<f64>().sqrt();
        if length == 0.0 {
            break;
        }
        axis = next.iter().map(|part| part / length).collect();
    }
    let mut scored: Vec<(f64, Vec<f64>)> = draws.iter().map(|draw| (score(draw, &axis), draw.clone())).collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    draws.iter_mut().zip(scored).for_each(|(draw, (_, sorted))| *draw = sorted);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn process() -> ProcessModel {
        let pair = Pair::named("c45_t15k6").expect("shipped");
        ProcessModel::Turning(Arc::new(Turning { pair, ..Turning::default() }))
    }

    fn table(header: &[&str], rows: &[&[&str]]) -> DrawTable {
        let texts = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>();
        DrawTable { header: texts(header), rows: rows.iter().map(|row| texts(row)).collect() }
    }

    const WEAR: &str = "energy_balance.thermal_wear_rate [um/min]";

    #[test]
    fn few_replications_already_meet_every_part_of_the_draws() {
        let cells: Vec<String> = (0..64).map(|i| format!("{}", 1.0 + f64::from((i * 37) % 64) / 64.0)).collect();
        let rows: Vec<Vec<&str>> = cells.iter().map(|cell| vec![cell.as_str()]).collect();
        let rows: Vec<&[&str]> = rows.iter().map(Vec::as_slice).collect();
        let draws = Posterior::of(&table(&[WEAR], &rows), &process(), false).expect("draws");
        let share = |number, tool| 6e7 * draws.draw(5, tool, number)[0] - 1.0;
        for tool in ["insert", "drill"] {
            let mut eighths: Vec<usize> = (0..8).map(|number| (8.0 * share(number, tool) + 1e-6) as usize).collect();
            eighths.sort_unstable();
            assert_eq!(eighths, (0..8).collect::<Vec<_>>(), "one draw in each eighth");
            let mut all: Vec<u64> = (0..64).map(|number| (64.0 * share(number, tool)).round() as u64).collect();
            all.sort_unstable();
            assert_eq!(all, (0..64).collect::<Vec<_>>(), "every draw once");
            assert_eq!(draws.draw(5, tool, 64), draws.draw(5, tool, 0), "reused in order");
        }
        let order = |tool| (0..64).map(|number| share(number, tool)).collect::<Vec<_>>();
        let (a, b) = (order("insert"), order("drill"));
        let product: f64 = a.iter().zip(&b).map(|(a, b)| (a - 0.5) * (b - 0.5)).sum::<f64>() / 64.0;
        assert!((product * 12.0).abs() < 0.4, "the draws of two tools are not tied to each other: {product}");
    }

    #[test]
    fn a_draw_takes_the_place_of_the_values_of_the_set() {
        let rows: &[&[&str]] = &[&["1.5", "0.21", "energy_balance", "1"], &["1.6", "0.22", "energy_balance", "1"]];
        let header = [WEAR, "edge_scatter", "law", "weight"];
        let draws = Posterior::of(&table(&header, rows), &process(), false).expect("draws");
        let (mut bare, mut scatter) = (process(), Scatter::shop());
        draws.put(&draws.draws[1].clone(), &mut bare, &mut scatter);
        let ProcessModel::Turning(turning) = &bare else { panic!("turning") };
        let toolroom_wear::WearLaw::EnergyBalance(law) = turning.pair.law else { panic!("an energy balance") };
        let wear = law.thermal_wear_rate * 6e7;
        assert!((wear - 1.6).abs() < 1e-12 || (wear - 1.5).abs() < 1e-12);
        assert!((scatter.common_wear - if wear > 1.55 { 0.22 } else { 0.21 }).abs() < 1e-12);
        let stated = Posterior::of(&table(&header, rows), &process(), true).expect("draws");
        assert_eq!(stated.names(), ["energy_balance.thermal_wear_rate"], "the scatter that a tool states stands");
    }

    #[test]
    fn tables_that_a_tool_cannot_take_are_refused_with_the_row() {
        let refused = |header: &[&str], rows: &[&[&str]]| {
            Posterior::of(&table(header, rows), &process(), false).expect_err("a faulty table")
        };
        assert!(refused(&["energy_balance.thermal_wear_rat [um/min]"], &[&["1"]]).contains("did you mean"));
        let other = refused(&["extended_taylor.depth_exponent"], &[&["1"]]);
        assert!(other.contains("another wear law") && !other.contains("did you mean"), "{other}");
        assert!(refused(&["energy_balance.thermal_wear_rate [kg]"], &[&["1"]]).contains("cannot be in kg"));
        assert!(refused(&[WEAR], &[&["1"], &["-1"]]).starts_with("row 2"));
        assert!(refused(&[WEAR], &[&["one"]]).contains("a number is due"));
        assert!(refused(&[WEAR, "weight"], &[&["1", "1"], &["2", "0.5"]]).contains("weights differ"));
        assert!(refused(&[WEAR, "weight"], &[&["1", "0"], &["2", "0"]]).contains("above 0"));
        assert!(refused(&[WEAR, "law"], &[&["1", "usui"]]).contains("the law usui, and the set has energy_balance"));
        assert_eq!(refused(&[WEAR], &[]), "there is no draw");
    }
}
