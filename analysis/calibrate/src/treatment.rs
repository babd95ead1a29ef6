//! From records to edges: what is used.

use crate::base::{Base, Condition, Process};
use crate::channel::Channel;
use crate::data_error::{DataError, LEAST, MOST};
use crate::edge::{Edge, Life, Stretch};
use crate::edge_start::EdgeStart;
use crate::end::End;
use crate::loads::{ChannelReadings, forget_unread};
use crate::stated::LifeStatement;
use crate::times::{path, times};
use std::collections::BTreeMap;
use toolroom_form::significant;
use toolroom_records::Records;
use toolroom_wear::Cut;

/// Share of the wear limit that readings have to reach for a life to be measured rather than extrapolated (assumption).
const REACHED: f64 = 0.8;

/// Flank wear in mm below which no reading of an edge lies: five times the usual error of a reading below zero.
const BELOW: f64 = -0.055;

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
    /// How edges were when their records began.
    pub start: EdgeStart,
    /// Line of the file of each row of the records; empty where it is not known.
    pub lines: Vec<usize>,
    /// Unit in which flank wear was read.
    pub wear_unit: String,
}

impl Treatment {
    /// That of records of the process of a set.
    pub fn from_base(base: &Base) -> Self {
        Self::new(base.process(), base.reference())
    }

    /// That of records of a process, with the cut that is taken for columns that they lack.
    fn new(process: Process, reference: Condition) -> Self {
        Self { process, reference, by: None, start: EdgeStart::Auto, lines: Vec::new(), wear_unit: "mm".to_owned() }
    }

    /// Where a row stands.
    fn place(&self, row: usize) -> String {
        self.lines.get(row).map_or_else(|| format!("row {}", row + 1), |line| format!("line {line}"))
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
    pub loads: Vec<[ChannelReadings; 5]>,
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
        Self::treated(records, limit, &Treatment::new(Process::Turning, Cut::default().into()))
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
        let (mut unsaid, mut early, mut notes_of_lives) = (0, Vec::new(), Vec::new());
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
                let wrong = names.zip(values).enumerate().find(|(_, (_, value))| !(value.is_finite() && *value > 0.0));
                let what = match wrong {
                    Some((quantity, (name, value))) if value.is_finite() => {
                        let (shown, unit) = if quantity == 0 { (value * 60.0, "m/min") } else { (value * 1e3, "mm") };
                        format!("a {name} of {} {unit} cannot be used; write what was cut", significant(shown))
                    }
                    Some((_, (name, _))) => format!("no {name}; write what was cut"),
                    None => "no width_of_cut; write what was cut".to_owned(),
                };
                let what = format!("{}: {what}", treatment.place(row));
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
            let word_of = |row: usize| records.texts("edge_end").map_or("", |ends| ends[row].trim());
            let word = word_of(last);
            let known =
                |row: &&usize| word_of(**row).is_empty() || End::ALL.iter().any(|end| end.name() == word_of(**row));
            if let Some(&row) = rows.iter().find(|row| !known(row)) {
                let (edge, place, read) = (name.to_owned(), treatment.place(row), word_of(row).to_owned());
                return Err(DataError::End { edge, place, read });
            }
            if let Some(&row) = rows.iter().find(|row| !word_of(**row).is_empty() && word_of(**row) != word) {
                early.push((name, treatment.place(row), word_of(row)));
            }
            let end = match End::ALL.into_iter().find(|end| end.name() == word) {
                Some(end) => {
                    measured.ends_told = true;
                    end
                }
                None => {
                    unsaid += 1;
                    End::Stopped
                }
            };
            let at = |column: &str, row: usize| records.numbers(column).map_or(f64::NAN, |values| values[row]);
            let load = |channel: Channel, row: usize| {
                let load =
                    Some(channel.scale() * at(channel.column(), row)).filter(|load| load.is_finite() && *load > 0.0);
                let (Some(speed), Some(feed), Some(depth)) = (speed, feed, depth) else { return None };
                load.map(|load| (Cut::nominal(speed[row], feed[row], depth[row]), load))
            };
            let mut loads: [ChannelReadings; 5] = Default::default();
            let edge = if at("life", last).is_finite() {
                let of_life = |row: &&usize| at("life", **row).is_finite();
                if let Some(&other) = rows.iter().filter(of_life).find(|row| **row != last) {
                    let places = format!("{} and {}", treatment.place(other), treatment.place(last));
                    if at("life", other) != at("life", last) {
                        let what = format!("two lives, in {places}: give each edge a tool_id of its own");
                        return Err(DataError::Value { edge: name.to_owned(), what });
                    }
                    notes_of_lives
                        .push(format!("edge {name} stands twice with the same life, in {places}: it counts once"));
                }
                let stated = LifeStatement {
                    minutes: at("life", last) / 60.0,
                    censored: at("censored", last),
                    inspected: at("inspected", last) / 60.0,
                    end: (!word.is_empty()).then_some(end),
                };
                let (life, worn) = stated.life().map_err(|what| {
                    let what = format!("{}: {what}", treatment.place(last));
                    DataError::Value { edge: name.to_owned(), what }
                })?;
                unsaid -= i32::from(word.is_empty());
                measured.ends.push(if worn { End::Worn } else { end });
                Edge { name: name.to_owned(), stretches: Vec::new(), life: Some((condition(last), life)), begun: None }
            } else {
                let times = times(records, rows, name, &|row| treatment.place(row))?;
                loads = Channel::ALL.map(|channel| rows.iter().map(|row| load(channel, *row)).collect());
                forget_unread(&mut loads);
                let mut stretches = Vec::new();
                for (row, time) in rows.iter().zip(times) {
                    let wear = Some(at("flank_wear", *row) * 1e3).filter(|wear| wear.is_finite());
                    if let Some(wear) = wear.filter(|wear| *wear < BELOW) {
                        let what = format!(
                            "{}: a flank_wear of {} mm cannot be; leave the cell empty where wear was not read",
                            treatment.place(*row),
                            significant(wear)
                        );
                        return Err(DataError::Value { edge: name.to_owned(), what });
                    }
                    stretches.push(Stretch { condition: condition(*row), time, wear, block: None });
                }
                measured.ends.push(end);
                let mut begun = None;
                if treatment.start.is_unknown(&stretches, limit)
                    && let Some(first) = stretches.iter().position(|stretch| stretch.wear.is_some())
                {
                    begun = stretches[first].wear;
                    stretches.drain(..=first);
                    loads.iter_mut().filter(|loads| !loads.is_empty()).for_each(|loads| drop(loads.drain(..=first)));
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
        if let Some((edge, place, word)) = early.first() {
            let more =
                if early.len() > 1 { format!(", and of {} other edges", early.len() - 1) } else { String::new() };
            measured.notes.push(format!(
                "edge {edge}: edge_end is `{word}` in {place}{more}, and rows follow: only the word of the last row of an \
                 edge counts. Was the corner turned there? Then give what follows a tool_id of its own"
            ));
        }
        measured.notes.append(&mut notes_of_lives);
        if unsaid > 0 {
            measured.notes.push(format!("{unsaid} edges without edge_end: taken as stopped while still good"));
        }
        if measured.edges.is_empty() {
            return Err(DataError::Nothing);
        }
        let idle = |edge: &Edge| edge.life.is_none() && edge.stretches.iter().all(|stretch| stretch.time == 0.0);
        if let Some(edge) = measured.edges.first().filter(|_| measured.edges.iter().all(idle)) {
            let what = "no edge has cut for any time: every cutting_time is 0".to_owned();
            return Err(DataError::Value { edge: edge.name.clone(), what });
        }
        let greatest = measured.greatest();
        if measured.readings() > 0 && !(LEAST..=MOST).contains(&greatest) {
            return Err(DataError::Unit { greatest, unit: treatment.wear_unit.clone() });
        }
        if there("flank_wear").or(there("life")).is_none() {
            if measured.ends.iter().all(|end| *end != End::Worn) {
                return Err(DataError::NoWear);
            }
            measured.notes.push("no flank_wear: the time until edges were worn out is all that is used".to_owned());
        }
        let unused: Vec<&str> = match process {
            Process::Turning => Vec::new(),
            Process::Milling => {
                Channel::ALL.map(Channel::column).into_iter().filter(|name| there(name).is_some()).collect()
            }
        };
        let doubled = there(Channel::CuttingForce.column()).and(there(Channel::SpindlePower.column())).is_some();
        if doubled && process == Process::Turning {
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

    /// Whether wear was read, and never near a flank wear of `limit` mm, nor a life to the limit measured.
    pub(crate) fn ends_short_of(&self, limit: f64) -> bool {
        let lived = self.edges.iter().any(|edge| matches!(edge.life, Some((_, Life::Exact(_)))));
        self.readings() > 0 && !lived && self.greatest() < REACHED * limit
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
