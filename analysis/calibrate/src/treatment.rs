//! From records to edges: what is used.

use crate::base::{Base, Condition, Process};
use crate::edge::{Edge, Life, Stretch};
use crate::force::Channel;
use std::collections::BTreeMap;
use toolroom_form::significant;
use toolroom_records::Records;
use toolroom_wear::Cut;

/// Flank wear in mm that a reading microscope just resolves (assumption: a third of the usual error of a reading). Where no
/// reading reaches it, the unit is wrong.
const LEAST: f64 = 0.003;
/// Flank wear in mm that no edge survives (assumption; the column of records has the same bound).
const MOST: f64 = 5.0;
/// Flank wear in mm below which no reading of an edge lies: five times the usual error of a reading below zero.
const BELOW: f64 = -0.055;
/// Channels of records that speak of wear and are not used here.
const UNUSED: [&str; 2] = ["temperature", "thermo_emf"];

/// Digits of a cutting speed and of feeds and depths that make two conditions different (assumption: machines hold a speed to
/// 0.1 % and lengths to 1 %; an exponent of 5 makes 0.3 % of a life of them). Each condition costs a wear curve.
const SPEED_DIGITS: usize = 4;
const LENGTH_DIGITS: usize = 3;

/// Groups of edges that wear at rates of their own (assumption: each is a parameter, and edges are few).
const MOST_GROUPS: usize = 8;

/// A number to so many digits.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Columns of speed, feed, depth and width of cut.
fn columns(process: Process) -> [Option<&'static str>; 4] {
    let width = match process {
        Process::Turning => None,
        Process::Milling => Some("width_of_cut"),
    };
    [Some("cutting_speed"), Some(process.feed()), Some("depth_of_cut"), width]
}

/// Words of groups, that of group 0 first, and the group of each row.
type Groups = (Vec<String>, Vec<usize>);

/// The groups of records.
fn groups(records: &Records, treatment: &Treatment) -> Result<Option<Groups>, DataError> {
    let Some((column, first)) = &treatment.by else { return Ok(None) };
    let wrong = |what: String| DataError::Groups { column: column.clone(), what };
    let (mut words, mut of) =
        records.levels(column).ok_or_else(|| wrong("the records have no such column of words".to_owned()))?;
    if words.len() < 2 {
        return Err(wrong(format!("every row has the same word `{}`: leave --by out", words.join(""))));
    }
    if words.len() > MOST_GROUPS {
        return Err(wrong(format!("{} different words; at most {MOST_GROUPS} groups can be told", words.len())));
    }
    // The order of first appearance, after the word that the set is to carry.
    let mut order: Vec<usize> = Vec::new();
    of.iter().for_each(|group| {
        if !order.contains(group) {
            order.push(*group);
        }
    });
    if let Some(word) = first {
        let place = words.iter().position(|known| known == word);
        let place = place.ok_or_else(|| wrong(format!("no row has `{word}`; there are {}", words.join(", "))))?;
        order.retain(|group| *group != place);
        order.insert(0, place);
    }
    of.iter_mut().for_each(|group| *group = order.iter().position(|place| place == group).unwrap_or(0));
    words = order.iter().map(|place| words[*place].clone()).collect();
    Ok(Some((words, of)))
}

/// Time of each row of an edge: minutes of cutting, or without them the operations since the row before, counted by
/// `sequence`.
fn times(records: &Records, rows: &[usize], edge: &str) -> Result<Vec<f64>, DataError> {
    let value = |what: String| DataError::Value { edge: edge.to_owned(), what };
    if let Some(time) = records.numbers("cutting_time").filter(|time| time.iter().any(|time| time.is_finite())) {
        let minutes = rows.iter().map(|row| time[*row] / 60.0);
        return minutes
            .map(|minutes| {
                let usable = minutes >= 0.0 && minutes.is_finite();
                usable
                    .then_some(minutes)
                    .ok_or_else(|| value(format!("a cutting time of {minutes} min cannot be used")))
            })
            .collect();
    }
    if let Some(path) = path(records) {
        let speed = records.numbers("cutting_speed").ok_or_else(|| DataError::NoColumn("cutting_speed".to_owned()))?;
        let minutes = |row: &usize| {
            let minutes = path[*row] / speed[*row] / 60.0;
            let usable = minutes >= 0.0 && minutes.is_finite();
            usable
                .then_some(minutes)
                .ok_or_else(|| value(format!("row {}: a path_length of {} m cannot be used", row + 1, path[*row])))
        };
        return rows.iter().map(minutes).collect();
    }
    let sequence = records.numbers("sequence").ok_or_else(|| DataError::NoColumn("cutting_time".to_owned()))?;
    let mut before = 0.0;
    rows.iter()
        .map(|row| {
            let passed = sequence[*row] - before;
            before = sequence[*row];
            let usable = passed > 0.0 && passed.is_finite();
            usable.then_some(passed).ok_or_else(|| value(format!("sequence {before} twice, or below 1")))
        })
        .collect()
}

/// Cutting path of each operation of turning, m, where it stands in place of the time in cut.
fn path(records: &Records) -> Option<&[f64]> {
    let path = records.numbers("path_length").filter(|path| path.iter().any(|path| path.is_finite()))?;
    // In milling a path is that of the centre of the cutter, which takes no part in the time of an edge in cut.
    records.numbers("feed_per_tooth").is_none().then_some(path)
}

/// The unit in which readings would be flank wear, where there is one.
fn meant(greatest: f64) -> &'static str {
    let fits = |factor: f64| (LEAST..=MOST).contains(&(greatest * factor));
    match (fits(1e-3), fits(1e3)) {
        (true, _) => "; they look like micrometres: write flank_wear [um]",
        (_, true) => "; they look like metres: write flank_wear [m]",
        (false, false) => "",
    }
}

/// Why records cannot be calibrated on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// A column without which nothing can be told.
    #[error("the records have no column `{0}`")]
    NoColumn(String),
    /// A column of words that is to tell groups of edges.
    #[error("--by {column}: {what}")]
    Groups {
        /// What was wanted.
        column: String,
        /// What is wrong.
        what: String,
    },
    /// A word in `edge_end` that means nothing.
    #[error("edge `{edge}`: edge_end is `{read}`; it is one of worn, chipped, broken, stopped, changed")]
    End {
        /// The edge.
        edge: String,
        /// What was read.
        read: String,
    },
    /// A life, an inspection or a cutting time that cannot be.
    #[error("edge `{edge}`: {what}")]
    Value {
        /// The edge.
        edge: String,
        /// What is wrong.
        what: String,
    },
    /// Readings of flank wear that no edge has.
    #[error(
        "the greatest reading of flank_wear is {} mm, and flank wear lies between {LEAST} and {MOST} mm: check its \
         unit{}",
        significant(*greatest),
        meant(*greatest)
    )]
    Unit {
        /// The greatest reading, mm.
        greatest: f64,
    },
    /// No edge with a reading or a life.
    #[error("no edge has a reading of flank_wear or a life")]
    Nothing,
}

/// How an edge ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// Worn out.
    Worn,
    /// Chipped.
    Chipped,
    /// Broken.
    Broken,
    /// Still good when the record ends.
    Stopped,
    /// Changed before it was worn out.
    Changed,
}

impl End {
    const ALL: [Self; 5] = [Self::Worn, Self::Chipped, Self::Broken, Self::Stopped, Self::Changed];

    /// Word in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Worn => "worn",
            Self::Chipped => "chipped",
            Self::Broken => "broken",
            Self::Stopped => "stopped",
            Self::Changed => "changed",
        }
    }
}

/// How records are to be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Treatment {
    /// The process that cut.
    pub process: Process,
    /// The cut that is taken for columns that the records lack.
    pub reference: Condition,
    /// Column of words whose edges may wear at different rates, with the word to whose edges the level belongs; that of the
    /// first row if none.
    pub by: Option<(String, Option<String>)>,
    /// Whether edges were not new when their records began: their first reading is then where they start.
    pub begun: bool,
}

impl Treatment {
    /// That of records of the process of a set.
    pub fn of(base: &Base) -> Self {
        Self { process: base.process(), reference: base.reference(), by: None, begun: false }
    }
}

/// What the time of edges counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Minutes of cutting.
    Minutes,
    /// Operations: the records have no cutting time.
    Operations,
}

impl Clock {
    /// Its unit in texts and keys.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Minutes => "min",
            Self::Operations => "operations",
        }
    }
}

/// What was read of one channel at the end of each stretch of an edge, with the cut as it was recorded.
pub type ChannelReadings = Vec<Option<(Cut, f64)>>;

/// Edges as they were measured, and what is to be said of the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The process that cut.
    pub process: Process,
    /// What the time counts.
    pub clock: Clock,
    /// Words of the groups of edges, from group 0 on; none without groups.
    pub groups: Vec<String>,
    /// Conditions that occur.
    pub conditions: Vec<Condition>,
    /// Edges in the order of the records.
    pub edges: Vec<Edge>,
    /// What was read of each edge, channel by channel in the order of [`Channel::ALL`].
    pub loads: Vec<[ChannelReadings; 3]>,
    /// How each ended.
    pub ends: Vec<End>,
    /// Whether the records tell how edges ended.
    pub ends_told: bool,
    /// Remarks.
    pub notes: Vec<String>,
    /// What the data cannot tell, each with what would lift it.
    pub refusals: Vec<String>,
}

impl Measured {
    /// The edges of records of turning, whose lives end at a flank wear of `limit` mm.
    ///
    /// # Errors
    /// [`DataError`]: a column that is missing, a word or a number that cannot be, nothing measured.
    pub fn of(records: &Records, limit: f64) -> Result<Self, DataError> {
        let reference = Cut::default().into();
        Self::treated(records, limit, &Treatment { process: Process::Turning, reference, by: None, begun: false })
    }

    /// The same of records of any process.
    ///
    /// # Errors
    /// As [`Measured::of`].
    pub fn treated(records: &Records, limit: f64, treatment: &Treatment) -> Result<Self, DataError> {
        let process = treatment.process;
        let there = |name: &str| records.numbers(name).filter(|values| values.iter().any(|value| value.is_finite()));
        let mut notes = Vec::new();
        let [speed, feed, depth, width] = columns(process).map(|name| name.and_then(there));
        let lacking: Vec<&str> = columns(process).into_iter().flatten().filter(|name| there(name).is_none()).collect();
        if !lacking.is_empty() {
            notes.push(format!("no {}: that of the set is taken, the same for all edges", lacking.join(", ")));
        }
        let groups = groups(records, treatment)?;
        let clock = match there("cutting_time").or(there("life")).or(path(records)) {
            Some(_) => Clock::Minutes,
            None => Clock::Operations,
        };
        let names = records.texts("tool_id").ok_or_else(|| DataError::NoColumn("tool_id".to_owned()))?;
        let mut rows: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        let mut order: Vec<&str> = Vec::new();
        for (row, name) in names.iter().map(String::as_str).enumerate() {
            if !rows.contains_key(name) {
                order.push(name);
            }
            rows.entry(name).or_default().push(row);
        }
        if let Some(sequence) = records.numbers("sequence") {
            rows.values_mut().for_each(|rows| rows.sort_by(|a, b| sequence[*a].total_cmp(&sequence[*b])));
        }
        let mut measured = Self {
            process,
            clock,
            groups: groups.as_ref().map(|(words, _)| words.clone()).unwrap_or_default(),
            conditions: Vec::new(),
            edges: Vec::new(),
            loads: Vec::new(),
            ends: Vec::new(),
            ends_told: false,
            notes,
            refusals: Vec::new(),
        };
        let mut unsaid = 0;
        for name in order {
            let rows = &rows[name];
            let reference = treatment.reference.quantities();
            let quantities = |row: usize| {
                let value = |(place, column): (usize, Option<&[f64]>)| match column {
                    Some(values) if place == 0 => rounded(values[row] * 60.0, SPEED_DIGITS) / 60.0,
                    Some(values) => rounded(values[row] * 1e3, LENGTH_DIGITS) * 1e-3,
                    None => reference[place],
                };
                [(0, speed), (1, feed), (2, depth), (3, width)].map(value)
            };
            if let Some((row, values)) = rows
                .iter()
                .map(|row| (*row, quantities(*row)))
                .find(|(_, values)| values.iter().any(|value| !(value.is_finite() && *value > 0.0)))
            {
                let names = columns(process).into_iter().flatten();
                let wrong = names.zip(values).find(|(_, value)| !(value.is_finite() && *value > 0.0));
                let what = format!("row {} has no usable {}", row + 1, wrong.map_or("width_of_cut", |(name, _)| name));
                return Err(DataError::Value { edge: name.to_owned(), what });
            }
            let mut condition = |row: usize| {
                let [speed, feed, depth, width] = quantities(row);
                let condition = Condition {
                    cut: Cut::nominal(speed, feed, depth),
                    width: (process == Process::Milling).then_some(width),
                    group: groups.as_ref().map_or(0, |(_, of)| of[row]),
                };
                measured.conditions.iter().position(|known| *known == condition).unwrap_or_else(|| {
                    measured.conditions.push(condition);
                    measured.conditions.len() - 1
                })
            };
            let last = *rows.last().expect("an edge has a row");
            let word = records.texts("edge_end").map_or("", |ends| ends[last].trim());
            let end = match End::ALL.into_iter().find(|end| end.name() == word) {
                Some(end) => {
                    measured.ends_told = true;
                    end
                }
                None if word.is_empty() => {
                    unsaid += 1;
                    End::Stopped
                }
                None => return Err(DataError::End { edge: name.to_owned(), read: word.to_owned() }),
            };
            let at = |column: &str, row: usize| records.numbers(column).map_or(f64::NAN, |values| values[row]);
            let load = |channel: Channel, row: usize| {
                let load =
                    Some(channel.scale() * at(channel.column(), row)).filter(|load| load.is_finite() && *load > 0.0);
                let (Some(speed), Some(feed), Some(depth)) = (speed, feed, depth) else { return None };
                load.map(|load| (Cut::nominal(speed[row], feed[row], depth[row]), load))
            };
            let mut loads: [ChannelReadings; 3] = Default::default();
            let edge = if at("life", last).is_finite() {
                let minutes = at("life", last) / 60.0;
                let inspected = at("inspected", last) / 60.0;
                let wrong = |what: String| DataError::Value { edge: name.to_owned(), what };
                if minutes <= 0.0 {
                    return Err(wrong(format!("a life of {minutes} min is none")));
                }
                let lasted = at("censored", last).is_nan() || at("censored", last) == 0.0;
                let worn = lasted && (word.is_empty() || end == End::Worn);
                let life = match (worn, inspected.is_finite() && inspected > 0.0) {
                    (false, _) => Life::Censored(minutes),
                    (true, false) => Life::Exact(minutes),
                    (true, true) if inspected < minutes => Life::Between(inspected, minutes),
                    (true, true) => {
                        return Err(wrong(format!("inspected at {inspected} min, after its life of {minutes} min")));
                    }
                };
                unsaid -= i32::from(word.is_empty());
                measured.ends.push(if worn { End::Worn } else { end });
                Edge { name: name.to_owned(), stretches: Vec::new(), life: Some((condition(last), life)), begun: None }
            } else {
                let times = times(records, rows, name)?;
                loads = Channel::ALL.map(|channel| rows.iter().map(|row| load(channel, *row)).collect());
                let mut stretches = Vec::new();
                for (row, time) in rows.iter().zip(times) {
                    let wear = Some(at("flank_wear", *row) * 1e3).filter(|wear| wear.is_finite());
                    if let Some(wear) = wear.filter(|wear| *wear < BELOW) {
                        let what = format!(
                            "row {}: a flank_wear of {} mm cannot be; leave the cell empty where wear was not read",
                            row + 1,
                            significant(wear)
                        );
                        return Err(DataError::Value { edge: name.to_owned(), what });
                    }
                    stretches.push(Stretch { condition: condition(*row), time, wear, block: None });
                }
                measured.ends.push(end);
                let mut begun = None;
                if treatment.begun
                    && let Some(first) = stretches.iter().position(|stretch| stretch.wear.is_some())
                {
                    begun = stretches[first].wear;
                    stretches.drain(..=first);
                    loads.iter_mut().for_each(|loads| drop(loads.drain(..=first)));
                    if stretches.is_empty() {
                        return Err(DataError::Value {
                            edge: name.to_owned(),
                            what: "one reading tells nothing of an edge that was not new: leave the edge out"
                                .to_owned(),
                        });
                    }
                }
                let mut edge = Edge { name: name.to_owned(), stretches, life: None, begun };
                if edge.readings() == 0 && begun.is_none() {
                    // Without readings the end of the edge is all there is.
                    let total: f64 = edge.stretches.iter().map(|stretch| stretch.time).sum();
                    let life = if end == End::Worn { Life::Exact(total) } else { Life::Censored(total) };
                    edge.life = Some((edge.stretches[0].condition, life));
                }
                edge
            };
            measured.edges.push(edge);
            measured.loads.push(loads);
        }
        if unsaid > 0 {
            measured.notes.push(format!("{unsaid} edges without edge_end: taken as stopped while still good"));
        }
        if measured.edges.is_empty() {
            return Err(DataError::Nothing);
        }
        let greatest = measured.greatest();
        if measured.readings() > 0 && !(LEAST..=MOST).contains(&greatest) {
            return Err(DataError::Unit { greatest });
        }
        let unused: Vec<&str> = UNUSED
            .into_iter()
            .filter(|name| records.numbers(name).is_some_and(|values| values.iter().any(|value| value.is_finite())))
            .collect();
        let doubled = there(Channel::CuttingForce.column()).and(there(Channel::SpindlePower.column())).is_some();
        if doubled {
            let note = "spindle_power is not used: cutting_force tells the same without the losses of the drive";
            measured.notes.push(note.to_owned());
        }
        if !unused.is_empty() {
            measured.notes.push(format!("not used: {}", unused.join(", ")));
        }
        measured.remark(limit);
        measured.refuse(limit);
        measured.pack();
        measured.join();
        Ok(measured)
    }

    /// Number of wear readings.
    pub fn readings(&self) -> usize {
        let stretches = self.edges.iter().flat_map(|edge| &edge.stretches).filter(|stretch| stretch.wear.is_some());
        stretches.map(|stretch| stretch.block.map_or(1, |block| block.count as usize)).sum()
    }

    /// The same without some edges, whose conditions stay.
    ///
    /// # Errors
    /// In words: an edge that is not there, fewer than two edges left.
    pub(crate) fn without(&self, names: &[String]) -> Result<Self, String> {
        if let Some(name) = names.iter().find(|name| self.edges.iter().all(|edge| edge.name != **name)) {
            let known: Vec<&str> = self.edges.iter().take(12).map(|edge| edge.name.as_str()).collect();
            return Err(format!("no edge `{name}`; there are {}", known.join(", ")));
        }
        let kept: Vec<usize> =
            (0..self.edges.len()).filter(|index| !names.contains(&self.edges[*index].name)).collect();
        if kept.len() < 2 && !names.is_empty() {
            return Err(format!("{} of {} edges would be left: hold out fewer", kept.len(), self.edges.len()));
        }
        Ok(Self {
            edges: kept.iter().map(|index| self.edges[*index].clone()).collect(),
            loads: kept.iter().map(|index| self.loads[*index].clone()).collect(),
            ends: kept.iter().map(|index| self.ends[*index]).collect(),
            ..self.clone()
        })
    }

    /// Greatest flank wear read, mm; zero without readings.
    pub(crate) fn greatest(&self) -> f64 {
        let stretches = self.edges.iter().flat_map(|edge| &edge.stretches);
        stretches.filter_map(|stretch| stretch.wear).fold(0.0, f64::max)
    }

    /// Median time of the edges, scaled to a flank wear of `limit` mm where wear was read.
    pub(crate) fn usual_life(&self, limit: f64) -> f64 {
        let life = |edge: &Edge| {
            let time: f64 = edge.stretches.iter().map(|stretch| stretch.time).sum();
            let last = edge.stretches.iter().rev().find_map(|stretch| stretch.wear).filter(|wear| *wear > 0.0);
            time * last.map_or(1.0, |wear| limit / wear)
        };
        let mut lives: Vec<f64> = self.edges.iter().map(life).filter(|life| *life > 0.0).collect();
        lives.sort_by(f64::total_cmp);
        lives.get(lives.len() / 2).copied().unwrap_or(1.0)
    }

    /// Cutting speeds, m/min.
    pub fn speeds(&self) -> Vec<f64> {
        self.conditions.iter().map(|condition| condition.cut.cutting_speed * 60.0).collect()
    }
}
