//! From records to edges: what is used, and what is said of it.

use crate::edge::{Edge, Life, Stretch};
use std::collections::BTreeMap;
use toolroom_records::Records;
use toolroom_wear::Cut;

/// Fall of wear from one reading to the next that is worth a line, in standard deviations of a reading.
const FALL: f64 = 3.0;
/// Usual standard deviation of a wear reading, mm (0.010 mm of reading, 0.005 mm of repeatability).
const READING: f64 = 0.011;
/// Share of the wear limit at a first reading beyond which the edge was probably not new when its record began.
const WORN_ALREADY: f64 = 0.5;
/// Share of the wear limit that readings have to reach for a life to be measured rather than extrapolated (assumption).
const REACHED: f64 = 0.8;
/// Flank wear in mm below which readings only show the run-in.
const RUN_IN: f64 = 0.1;

/// Flank wear in mm that a reading microscope just resolves (assumption: a third of the usual error of a reading). Where no
/// reading reaches it, the unit is wrong.
const LEAST: f64 = 0.003;
/// Flank wear in mm that no edge survives (assumption; the column of records has the same bound).
const MOST: f64 = 5.0;
/// Channels of records that speak of wear and are not used here.
const UNUSED: [&str; 4] = ["feed_force", "spindle_power", "temperature", "thermo_emf"];

/// Digits of a cutting speed and of feeds and depths that make two conditions different (assumption: machines hold a speed to
/// 0.1 % and lengths to 1 %; an exponent of 5 makes 0.3 % of a life of them). Each condition costs a wear curve.
const SPEED_DIGITS: usize = 4;
const LENGTH_DIGITS: usize = 3;

/// Conditions beyond which neighbours are joined (assumption): designed tests have fewer, recorded shops a new one with every
/// pass.
const MANY: usize = 24;
/// Ratio of the greatest to the least speed, feed and depth of joined conditions (assumption): at exponents of 5, 1.5 and 0.75
/// the rate of a pass then differs by at most 4 % from that of its condition, either way, which evens out over an edge.
const JOINED: [f64; 3] = [1.015, 1.05, 1.10];

/// A number to so many digits.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Why records cannot be calibrated on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataError {
    /// A column without which nothing can be told.
    #[error("the records have no column `{0}`")]
    NoColumn(&'static str),
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
        "the greatest reading of flank_wear is {greatest} mm, and flank wear lies between {LEAST} and {MOST} mm: check its unit"
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

/// Edges as they were measured, and what is to be said of the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Conditions that occur.
    pub conditions: Vec<Cut>,
    /// Edges in the order of the records.
    pub edges: Vec<Edge>,
    /// Cutting force in N at the end of each stretch of each edge, with the cut as it was recorded.
    pub forces: Vec<Vec<Option<(Cut, f64)>>>,
    /// How each ended.
    pub ends: Vec<End>,
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
        let number = |name: &'static str| records.numbers(name).ok_or(DataError::NoColumn(name));
        let (speed, feed, depth) = (number("cutting_speed")?, number("feed_per_rev")?, number("depth_of_cut")?);
        let names = records.texts("tool_id").ok_or(DataError::NoColumn("tool_id"))?;
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
            conditions: Vec::new(),
            edges: Vec::new(),
            forces: Vec::new(),
            ends: Vec::new(),
            notes: Vec::new(),
            refusals: Vec::new(),
        };
        let mut unsaid = 0;
        for name in order {
            let rows = &rows[name];
            let mut condition = |row: usize| {
                let cut = Cut::nominal(
                    rounded(speed[row] * 60.0, SPEED_DIGITS) / 60.0,
                    rounded(feed[row] * 1e3, LENGTH_DIGITS) * 1e-3,
                    rounded(depth[row] * 1e3, LENGTH_DIGITS) * 1e-3,
                );
                measured.conditions.iter().position(|known| *known == cut).unwrap_or_else(|| {
                    measured.conditions.push(cut);
                    measured.conditions.len() - 1
                })
            };
            let last = *rows.last().expect("an edge has a row");
            let word = records.texts("edge_end").map_or("", |ends| ends[last].trim());
            let end = match End::ALL.into_iter().find(|end| end.name() == word) {
                Some(end) => end,
                None if word.is_empty() => {
                    unsaid += 1;
                    End::Stopped
                }
                None => return Err(DataError::End { edge: name.to_owned(), read: word.to_owned() }),
            };
            let at = |column: &str, row: usize| records.numbers(column).map_or(f64::NAN, |values| values[row]);
            let force = |row: &usize| {
                let force = Some(at("cutting_force", *row)).filter(|force| force.is_finite() && *force > 0.0);
                force.map(|force| (Cut::nominal(speed[*row], feed[*row], depth[*row]), force))
            };
            let mut forces = Vec::new();
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
                Edge { name: name.to_owned(), stretches: Vec::new(), life: Some((condition(last), life)) }
            } else {
                let time = number("cutting_time")?;
                forces = rows.iter().map(force).collect();
                let mut stretches = Vec::new();
                for row in rows {
                    let minutes = time[*row] / 60.0;
                    if !(minutes >= 0.0 && minutes.is_finite()) {
                        let what = format!("a cutting time of {minutes} min cannot be used");
                        return Err(DataError::Value { edge: name.to_owned(), what });
                    }
                    let wear = Some(at("flank_wear", *row) * 1e3).filter(|wear| wear.is_finite());
                    stretches.push(Stretch { condition: condition(*row), time: minutes, wear });
                }
                measured.ends.push(end);
                let mut edge = Edge { name: name.to_owned(), stretches, life: None };
                if edge.readings() == 0 {
                    // Without readings the end of the edge is all there is.
                    let total: f64 = edge.stretches.iter().map(|stretch| stretch.time).sum();
                    let life = if end == End::Worn { Life::Exact(total) } else { Life::Censored(total) };
                    edge.life = Some((edge.stretches[0].condition, life));
                }
                edge
            };
            measured.edges.push(edge);
            measured.forces.push(forces);
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
        if !unused.is_empty() {
            measured.notes.push(format!("not used: {}", unused.join(", ")));
        }
        measured.remark(limit);
        measured.refuse(limit);
        measured.join();
        Ok(measured)
    }

    /// Number of wear readings.
    pub fn readings(&self) -> usize {
        self.edges.iter().map(Edge::readings).sum()
    }

    /// Greatest flank wear read, mm; zero without readings.
    fn greatest(&self) -> f64 {
        let stretches = self.edges.iter().flat_map(|edge| &edge.stretches);
        stretches.filter_map(|stretch| stretch.wear).fold(0.0, f64::max)
    }

    /// Cutting speeds, m/min.
    pub fn speeds(&self) -> Vec<f64> {
        self.conditions.iter().map(|cut| cut.cutting_speed * 60.0).collect()
    }

    /// Joins neighbouring conditions where there are many, each class at its mean over cutting time.
    fn join(&mut self) {
        if self.conditions.len() <= MANY {
            return;
        }
        let quantities = |cut: &Cut| [cut.cutting_speed, cut.feed_per_rev, cut.depth_of_cut];
        let least = self.conditions.iter().map(quantities).reduce(|a, b| [0, 1, 2].map(|i| a[i].min(b[i])));
        let most = self.conditions.iter().map(quantities).reduce(|a, b| [0, 1, 2].map(|i| a[i].max(b[i])));
        let (Some(least), Some(most)) = (least, most) else { return };
        // Classes of equal ratio between the least and the greatest value.
        let class = |cut: &Cut| {
            let values = quantities(cut);
            [0, 1, 2].map(|i| {
                let whole = (most[i] / least[i]).ln();
                let classes = (whole / JOINED[i].ln()).ceil().max(1.0);
                let place = if whole > 0.0 { (values[i] / least[i]).ln() / whole * classes } else { 0.0 };
                place.min(classes - 1.0) as usize
            })
        };
        let mut time = vec![0.0; self.conditions.len()];
        for edge in &self.edges {
            edge.stretches.iter().for_each(|stretch| time[stretch.condition] += stretch.time);
            if let Some((condition, Life::Exact(life) | Life::Censored(life) | Life::Between(_, life))) = edge.life {
                time[condition] += life;
            }
        }
        let mut classes: BTreeMap<[usize; 3], Vec<usize>> = BTreeMap::new();
        self.conditions.iter().enumerate().for_each(|(index, cut)| classes.entry(class(cut)).or_default().push(index));
        let mut joined = vec![0; self.conditions.len()];
        let mut conditions = Vec::new();
        for members in classes.into_values() {
            let total: f64 = members.iter().map(|member| time[*member]).sum();
            let weight = |member: usize| if total > 0.0 { time[member] / total } else { 1.0 / members.len() as f64 };
            let mean = |i: usize| {
                // From the first, so that equal values stay what they are.
                let first = quantities(&self.conditions[members[0]])[i];
                let off =
                    members.iter().map(|member| weight(*member) * (quantities(&self.conditions[*member])[i] - first));
                first + off.sum::<f64>()
            };
            members.iter().for_each(|member| joined[*member] = conditions.len());
            conditions.push(Cut::nominal(mean(0), mean(1), mean(2)));
        }
        for edge in &mut self.edges {
            edge.stretches.iter_mut().for_each(|stretch| stretch.condition = joined[stretch.condition]);
            if let Some((condition, _)) = &mut edge.life {
                *condition = joined[*condition];
            }
        }
        let (before, after) = (self.conditions.len(), conditions.len());
        self.notes.push(format!("{before} conditions were joined to {after}: neighbours wear at their mean"));
        self.conditions = conditions;
    }

    fn remark(&mut self, limit: f64) {
        for edge in &self.edges {
            let wear: Vec<f64> = edge.stretches.iter().filter_map(|stretch| stretch.wear).collect();
            if let Some(place) = wear.windows(2).position(|pair| pair[0] - pair[1] > FALL * READING) {
                let (from, to) = (wear[place], wear[place + 1]);
                self.notes.push(format!(
                    "edge {}: wear falls from {from:.3} to {to:.3} mm; the readings are kept. Was another edge or corner \
                     read? Then give it a tool_id of its own",
                    edge.name
                ));
            }
            if wear.first().is_some_and(|first| *first > WORN_ALREADY * limit) && wear.len() > 1 {
                let early = edge.stretches.first().is_some_and(|first| first.wear.is_some());
                if early && wear[1] - wear[0] < 0.5 * wear[0] {
                    self.notes.push(format!(
                        "edge {}: the first reading is {:.3} mm already and the next only {:.3} mm: it was probably not \
                         new when its record began, and its time before that is not known",
                        edge.name, wear[0], wear[1]
                    ));
                }
            }
        }
    }

    fn refuse(&mut self, limit: f64) {
        let span = |of: &dyn Fn(&Cut) -> f64| {
            let values = self.conditions.iter().map(of);
            values.fold((f64::INFINITY, 0.0_f64), |(a, b), value| (a.min(value), b.max(value)))
        };
        let (slow, fast) = span(&|cut| cut.cutting_speed * 60.0);
        let mut refusals = Vec::new();
        if fast < 1.2 * slow {
            refusals.push(format!(
                "one cutting speed ({slow:.0} m/min): no exponent of speed, no activation energy, no choice of a law; \
                 measure edges at a second speed, 1.2 times as fast or more"
            ));
        }
        for (name, (least, greatest)) in
            [("feed_per_rev", span(&|cut| cut.feed_per_rev)), ("depth_of_cut", span(&|cut| cut.depth_of_cut))]
        {
            if greatest < 1.05 * least {
                refusals.push(format!("one {name}: its exponent is the prior; vary {name}"));
            }
        }
        if self.edges.len() < 3 {
            let edges = self.edges.len();
            refusals.push(format!("{edges} edge(s): the scatter of edges is the prior; measure three or more"));
        }
        let lives: Vec<&Life> = self.edges.iter().filter_map(|edge| edge.life.as_ref().map(|(_, life)| life)).collect();
        if !lives.is_empty()
            && lives.len() == self.edges.len()
            && lives.iter().all(|life| matches!(life, Life::Censored(_)))
        {
            refusals.push(
                "every life is censored: only a lower bound of the level; wait until edges are worn out".to_owned(),
            );
        }
        let greatest = self.greatest();
        if self.readings() > 0 && greatest < RUN_IN {
            refusals.push(format!(
                "readings up to {greatest:.3} mm only show the run-in: the life is extrapolated; read edges beyond {RUN_IN} mm"
            ));
        } else if self.readings() > 0 && greatest < REACHED * limit {
            refusals.push(format!(
                "readings end at {greatest:.3} mm: the life to {limit:.3} mm is extrapolated; read edges up to the limit, or \
                 give the limit at which edges are changed (--limit)"
            ));
        }
        self.refusals = refusals;
    }
}
