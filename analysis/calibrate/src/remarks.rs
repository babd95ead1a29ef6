//! What is to be said of data before anything is fitted.

use crate::base::{Base, Condition, Process};
use crate::edge::{Edge, Life, Stretch};
use crate::edge_start::worn_already;
use crate::treatment::{Clock, Measured};
use crate::wear_model::{ONE_SPEED, ONE_VALUE};

/// Fall of wear from one reading to the next that is worth a line, in standard deviations of a reading.
const FALL: f64 = 3.0;
/// Usual standard deviation of a wear reading, mm (0.010 mm of reading, 0.005 mm of repeatability).
const READING: f64 = 0.011;
/// Readings of an edge that tell whether its wear grows (assumption).
const EVEN: usize = 4;
/// Factor by which the second half of a column on an edge is above the first where it grows as wear does (assumption).
const GROWS: f64 = 1.2;
/// Rows of an edge whose times may be compared, and rows of one edge alone that tell a running total (assumption: five times in
/// rising order are one chance in 120).
const TIMED: (usize, usize) = (3, 5);
/// Factor beyond the range of speeds of a set from which speeds look like those of another unit: m/s under m/min is a factor of 60
/// (assumption).
const ANOTHER_UNIT: f64 = 4.0;
/// Flank wear in mm below which readings only show the run-in.
const RUN_IN: f64 = 0.1;

impl Measured {
    pub(crate) fn remark(&mut self, limit: f64) {
        let (mut notes, mut used, mut fallen) = (Vec::new(), Vec::new(), Vec::new());
        let mut even = Vec::new();
        for edge in &self.edges {
            let wear: Vec<f64> = edge.stretches.iter().filter_map(|stretch| stretch.wear).collect();
            if wear.len() >= EVEN && wear.iter().all(|each| (each - wear[0]).abs() < READING) {
                even.push(edge.name.as_str());
            }
            let falls: Vec<&[f64]> = wear.windows(2).filter(|pair| pair[0] - pair[1] > FALL * READING).collect();
            if let Some(first) = falls.first() {
                fallen.push((edge.name.as_str(), first[0], first[1], falls.len()));
            }
            if let Some(first) = worn_already(&edge.stretches, limit).filter(|_| edge.begun.is_none()) {
                used.push((edge.name.as_str(), first));
            }
        }
        if let Some((name, from, to, count)) = fallen.first() {
            let who = match fallen.len() {
                1 => format!("edge {name}"),
                many => format!("{many} edges, {name} first"),
            };
            let times = if *count > 1 { format!(" and {} times more", count - 1) } else { String::new() };
            notes.push(format!(
                "{who}: wear falls from {from:.3} to {to:.3} mm{times}; the readings are kept. Was another edge or corner \
                 read? Then give it a tool_id of its own"
            ));
        }
        if let Some(name) = even.first() {
            let (count, all) = (even.len(), self.edges.len());
            let instead = self.grows_instead().map_or_else(
                || "Is the column that of flank wear?".to_owned(),
                |column| format!("{column} grows on every edge as wear does: are the two columns exchanged?"),
            );
            notes.push(format!(
                "wear does not grow on {count} of {all} edges, {name} first: all its readings are the same within the error of one. \
                 {instead}"
            ));
        }
        let begun: Vec<&Edge> = self.edges.iter().filter(|edge| edge.begun.is_some()).collect();
        if let Some(first) = begun.first() {
            let who = if begun.len() > 1 {
                format!("{} edges, {} first, begin at their first readings", begun.len(), first.name)
            } else {
                format!("edge {} begins at its first reading", first.name)
            };
            notes.push(format!(
                "{who} ({:.3} mm): nothing is supposed of the wear and the time before; --start new takes every edge for new",
                first.begun.unwrap_or(0.0)
            ));
        }
        if let Some((name, wear)) = used.first().filter(|_| begun.is_empty()) {
            let who = match used.len() {
                1 => format!("edge {name}"),
                many => format!("{many} edges, {name} first"),
            };
            self.refusals.push(format!(
                "{who}: the first reading is {wear:.3} mm already and wear rises slowly from there: probably not new when the \
                 record began, and the time before that is not known; with --start unknown nothing is supposed of it"
            ));
        }
        notes.extend(self.times_without_cutting());
        if self.clock == Clock::Minutes && self.times_look_running() {
            self.refusals.push(
                "whether the time is counted from the beginning of each edge: it grows from row to row on every edge, and is taken \
                 as the time of each row alone. If it is a running total, map its column with running = true (--map)"
                    .to_owned(),
            );
        }
        notes.append(&mut self.notes);
        self.notes = notes;
    }

    /// What is to be said of rows in which nothing was cut though wear was read; the reading of a new edge is as it should be.
    fn times_without_cutting(&self) -> Option<String> {
        let (mut count, mut first, mut most) = (0, None, 0.0_f64);
        for edge in &self.edges {
            let mut before = 0.0;
            for stretch in &edge.stretches {
                let Some(wear) = stretch.wear else { continue };
                let new = before == 0.0 && wear < FALL * READING;
                if stretch.time == 0.0 && !new {
                    count += 1;
                    first = first.or(Some(edge.name.as_str()));
                    most = most.max(wear - before);
                }
                before = wear;
            }
        }
        let first = first?;
        let rises = if most > FALL * READING {
            format!(", though wear rises by up to {most:.3} mm in them: was their time not recorded?")
        } else {
            String::new()
        };
        Some(format!(
            "{count} rows have no cutting time, edge {first} first: they are taken as wear that was read again without cutting{rises}"
        ))
    }

    /// The column that rises on every edge, where wear itself does not.
    fn grows_instead(&self) -> Option<&'static str> {
        type Read = fn(&Measured, &Stretch) -> f64;
        let columns: [(&str, Read); 3] = [
            ("cutting_time", |_, stretch| stretch.time),
            ("the feed", |measured, stretch| measured.conditions[stretch.condition].cut.feed_per_rev),
            ("depth_of_cut", |measured, stretch| measured.conditions[stretch.condition].cut.depth_of_cut),
        ];
        let grows = |read: &Read| {
            self.edges.iter().all(|edge| {
                let values: Vec<f64> = edge.stretches.iter().map(|stretch| read(self, stretch)).collect();
                // Neighbouring conditions may have been joined, and a reading may fall a little: the halves are compared.
                let (first, last) = values.split_at(values.len() / 2);
                let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
                values.len() >= EVEN && mean(last) > GROWS * mean(first)
            })
        };
        columns.iter().find(|(_, read)| grows(read)).map(|(name, _)| *name)
    }

    /// Says where every feed is larger than its depth of cut.
    fn feeds_fit(&mut self) {
        let cuts = || self.conditions.iter().map(|condition| &condition.cut);
        let least = cuts().map(|cut| cut.feed_per_rev).fold(f64::INFINITY, f64::min);
        if !self.conditions.is_empty() && cuts().all(|cut| cut.feed_per_rev > cut.depth_of_cut) {
            let most = cuts().map(|cut| cut.depth_of_cut).fold(0.0, f64::max);
            self.notes.push(format!(
                "every feed is larger than its depth of cut (feeds from {:.3} mm, depths up to {:.3} mm), which turning rarely has: \
                 are the two columns exchanged?",
                least * 1e3,
                most * 1e3
            ));
        }
    }

    /// Whether the times of rows rise on every edge, as a running total does.
    fn times_look_running(&self) -> bool {
        let times = |edge: &Edge| -> Vec<f64> {
            edge.stretches.iter().map(|stretch| stretch.time).filter(|time| *time > 0.0).collect()
        };
        let timed: Vec<Vec<f64>> =
            self.edges.iter().map(times).filter(|times: &Vec<f64>| times.len() >= TIMED.0).collect();
        let rising = |times: &Vec<f64>| times.windows(2).all(|pair| pair[1] > pair[0]);
        let many = timed.len() > 1 || timed.first().is_some_and(|times| times.len() >= TIMED.1);
        many && timed.iter().all(rising)
    }

    /// Says where the cuts are far from what the set is for.
    pub(crate) fn fit_into(&mut self, base: &Base) {
        match base {
            Base::Turning { pair, .. } => {
                self.speeds_fit(pair.limits.lowest_speed, pair.limits.highest_speed);
                self.feeds_fit();
            }
            Base::Milling { diameter, .. } => self.widths_fit(*diameter),
        }
    }

    /// Says where every cutting speed is far from those of the set, m/s.
    fn speeds_fit(&mut self, lowest: f64, highest: f64) {
        let speeds = self.conditions.iter().map(|condition| condition.cut.cutting_speed);
        let (slow, fast) = speeds.fold((f64::INFINITY, 0.0_f64), |(a, b), speed| (a.min(speed), b.max(speed)));
        let (below, above) = (fast * ANOTHER_UNIT < lowest, slow > ANOTHER_UNIT * highest);
        if below || above {
            let ask = if below { "are they in m/s? Then write cutting_speed [m/s]" } else { "is their unit right?" };
            self.notes.push(format!(
                "cutting speeds from {:.3} to {:.3} m/min, and the set is for {:.0} to {:.0} m/min: {ask}",
                slow * 60.0,
                fast * 60.0,
                lowest * 60.0,
                highest * 60.0
            ));
        }
    }

    /// Says where a cut was wider than the cutter of the set, in whose shops such a cut cannot be made.
    fn widths_fit(&mut self, diameter: f64) {
        let widest = self.conditions.iter().filter_map(|condition| condition.width).fold(0.0, f64::max);
        if widest > diameter * (1.0 + 1e-9) {
            self.notes.push(format!(
                "width_of_cut up to {:.0} mm, and the cutter of the set has {:.0} mm: its cuts are taken as full slots, and scenarios refuse \
                 them; give --model a set with the diameter of your cutter",
                widest * 1e3,
                diameter * 1e3
            ));
        }
    }

    pub(crate) fn refuse(&mut self, limit: f64) {
        let span = |of: &dyn Fn(&Condition) -> f64| {
            let values = self.conditions.iter().map(of);
            values.fold((f64::INFINITY, 0.0_f64), |(a, b), value| (a.min(value), b.max(value)))
        };
        let (slow, fast) = span(&|condition| condition.cut.cutting_speed * 60.0);
        // What was worn already comes first: every answer below depends on it.
        let mut refusals = std::mem::take(&mut self.refusals);
        if fast < ONE_SPEED * slow {
            let what = match self.process {
                Process::Turning => "no exponent of speed, no activation energy, no choice of a law",
                Process::Milling => "no exponent of speed",
            };
            refusals.push(format!(
                "one cutting speed ({slow:.0} m/min): {what}; measure edges at a second speed, 1.2 times as fast or more"
            ));
        } else if self.clock == Clock::Operations {
            refusals.push(
                "the records have no cutting_time, so that lives count operations: how they fall with speed is no exponent \
                 of Taylor's law until the time of an operation is known; give cutting_time, or map one from the length of \
                 an operation"
                    .to_owned(),
            );
        }
        let feed = span(&|condition| condition.cut.feed_per_rev);
        let depth = span(&|condition| condition.cut.depth_of_cut);
        let width = self.conditions.iter().any(|condition| condition.width.is_some());
        let width = width.then(|| ("width_of_cut", span(&|condition| condition.width.unwrap_or(1.0))));
        for (name, (least, greatest)) in [(self.process.feed(), feed), ("depth_of_cut", depth)].into_iter().chain(width)
        {
            if greatest < ONE_VALUE * least {
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
        } else if self.ends_short_of(limit) {
            refusals.push(format!(
                "readings end at {greatest:.3} mm: the life to {limit:.3} mm is extrapolated; read edges up to the limit, or \
                 give the limit at which edges are changed (--limit)"
            ));
        }
        self.refusals = refusals;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_records::{RecordKind, parse_csv};
    use toolroom_wear::Pair;

    const HEADER: &str = "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],\
                          cutting_time [min],flank_wear [mm]\n";

    /// What is said of two edges with five readings each, `row` by edge and reading.
    fn told(row: impl Fn(usize, usize) -> String + Copy) -> String {
        let rows: String = (0..2).flat_map(|edge| (1..=5).map(move |reading| row(edge, reading))).collect();
        let table = format!("{HEADER}{rows}");
        let (records, _) = parse_csv("wear.csv", table.as_bytes(), RecordKind::Turning).expect("records");
        let mut measured = Measured::of(&records, 0.3).expect("edges");
        measured.fit_into(&Base::from(&Pair::named("c45_t15k6").expect("a shipped set")));
        measured.notes.join("; ")
    }

    /// What is said of two edges at two speeds whose wear grows by `step` mm from reading to reading.
    fn notes(speeds: [f64; 2], step: f64) -> String {
        let row = |edge: usize, reading: usize| {
            let wear = step.mul_add(reading as f64, 0.1);
            format!("O{edge}{reading},L1,E{edge},{reading},{},0.3,1.5,5,{wear:.3}\n", speeds[edge])
        };
        told(row)
    }

    #[test]
    fn speeds_of_another_unit_are_told() {
        let far = notes([3.0, 4.0], 0.02);
        assert!(
            far.contains("cutting speeds from 3.000 to 4.000 m/min") && far.contains("cutting_speed [m/s]"),
            "{far}"
        );
        assert!(notes([2000.0, 2500.0], 0.02).contains("is their unit right?"));
        assert!(!notes([200.0, 240.0], 0.02).contains("cutting speeds from"));
    }

    #[test]
    fn exchanged_columns_are_told() {
        let of = |cut: fn(usize) -> (f64, f64, f64)| {
            let row = |edge: usize, reading: usize| {
                let (feed, depth, wear) = cut(reading);
                format!("O{edge}{reading},L1,E{edge},{reading},{},{feed},{depth},5,{wear:.3}\n", 200 + 40 * edge)
            };
            told(row)
        };
        assert!(!of(|reading| (0.3, 1.5, 0.04 * reading as f64)).contains("exchanged"));
        assert!(of(|reading| (1.5, 0.3, 0.04 * reading as f64)).contains("every feed is larger than its depth"));
        let swapped = of(|reading| (0.04 * reading as f64 + 0.02, 1.5, 0.3));
        assert!(swapped.contains("the feed grows on every edge as wear does"), "{swapped}");
    }

    #[test]
    fn wear_that_does_not_grow_is_told() {
        let even = notes([200.0, 240.0], 0.0);
        assert!(even.contains("wear does not grow on 2 of 2 edges, E0 first"), "{even}");
        assert!(!notes([200.0, 240.0], 0.02).contains("does not grow"));
    }
}
