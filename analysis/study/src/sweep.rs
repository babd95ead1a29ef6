//! The comparison at several values of one key.

mod turn;

use crate::figure::{decimals, plain};
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_chart::page::{Figure, Report, Section};
use toolroom_chart::{Axis, ColourMap, HeatMap, Plot, Style, number};
use toolroom_form::significant;
use turn::Turn;

/// Points of a sweep; more are a slip of the step.
const MOST: usize = 1000;
/// Factors on the present price of a map, evenly by their ratio.
const PRICES: [f64; 5] = [0.5, std::f64::consts::FRAC_1_SQRT_2, 1.0, std::f64::consts::SQRT_2, 2.0];

/// A key of a scenario and the values that it takes, each with its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// The key, `machine.L.tool_change_time`.
    pub key: String,
    /// Its values as text, such as `1.5 min`.
    pub values: Vec<String>,
}

/// The comparison at the first values of a sweep.
#[derive(Clone, Debug, Default)]
pub struct SweepResult {
    /// The [`summary`](crate::summary::summary) of each.
    pub summaries: Vec<Value>,
    /// The [`pairs`](crate::compare::Decision::pairs) of the decision of each. All values have the same random numbers.
    pub pairs: Vec<Vec<f64>>,
    /// Whether each value has settings of its own.
    pub retuned: bool,
}

/// Why there is no sweep.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// Ends and step are in different units.
    #[error("\"{low}\", \"{high}\" and \"{step}\" are not in one unit")]
    Units {
        /// The first value.
        low: String,
        /// The last value.
        high: String,
        /// The step.
        step: String,
    },
    /// No value, or too many.
    #[error("from {low} to {high} by {step} there are no points, or more than {MOST}")]
    Points {
        /// The first value.
        low: String,
        /// The last value.
        high: String,
        /// The step.
        step: String,
    },
    /// A text without a number.
    #[error("`{text}` does not start with a number")]
    NoNumber {
        /// The text.
        text: String,
    },
}

impl SweepError {
    /// The way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Units { .. } => "write all three in the same unit",
            Self::Points { .. } => "LO is at most HI and STEP is positive",
            Self::NoNumber { .. } => "such as \"1 min\"",
        }
    }
}

impl Sweep {
    /// `1 min`, `5 min`, `1 min` to every value between, in the unit as written.
    ///
    /// # Errors
    /// See [`SweepError`].
    pub fn new(key: &str, low: &str, high: &str, step: &str) -> Result<Self, SweepError> {
        let texts = || (low.to_owned(), high.to_owned(), step.to_owned());
        let [(start, unit), (end, end_unit), (width, step_unit)] = [split(low)?, split(high)?, split(step)?];
        if end_unit != unit || step_unit != unit {
            let (low, high, step) = texts();
            return Err(SweepError::Units { low, high, step });
        }
        let count = ((end - start) / width + 1e-9).floor();
        if !(width > 0.0 && count >= 0.0 && count < MOST as f64) {
            let (low, high, step) = texts();
            return Err(SweepError::Points { low, high, step });
        }
        let value = |i: usize| format!("{} {unit}", significant(start + width * i as f64)).trim_end().to_owned();
        Ok(Self { key: key.to_owned(), values: (0..=count as usize).map(value).collect() })
    }

    /// The results for programs.
    pub fn json(&self, result: &SweepResult) -> Value {
        let summaries = &result.summaries;
        let point = |(value, summary): (&String, &Value)| json!({ "value": value, "summary": summary });
        let points: Vec<Value> = self.values.iter().zip(summaries).map(point).collect();
        let map =
            |(price, rows): (String, Vec<Vec<f64>>)| json!({ "price": price, "factors": PRICES, "difference": rows });
        let maps: Vec<Value> = maps(summaries).into_iter().map(map).collect();
        let unit = self.unit();
        let turn = self.turn(result);
        let inside = turn.crossing.filter(|turn| self.holds(turn.at));
        let turns_at = inside.map(|turn| format!("{:.2} {unit}", turn.at).trim_end().to_owned());
        let break_even = json!([{
            "key": self.key,
            "unit": unit,
            "flips_at": inside.map(|turn| turn.at),
            "ci90": inside.and_then(|turn| turn.interval).map(|(low, high)| [low, high]),
            "retuned": result.retuned,
            "between": turn.between,
            "notes": turn.notes(&self.key, &self.values),
        }]);
        json!({ "schema": 1, "key": self.key, "points": points, "turns_at": turns_at, "break_even": break_even, "maps": maps })
    }

    /// The results for a terminal.
    pub fn text(&self, result: &SweepResult) -> String {
        let summaries = &result.summaries;
        let mut text = String::new();
        for (value, summary) in self.values.iter().zip(summaries) {
            let _ = writeln!(text, "{} = {value}", self.key);
            for policy in summary["policies"].as_array().into_iter().flatten() {
                let figure = |name: &str| figure(&policy["kpi"], name);
                let _ = writeln!(
                    text,
                    "  {:34} parts/shift {:>16}   cost/part {:>16}   edges/100 parts {:>16}",
                    policy["name"].as_str().unwrap_or_default(),
                    figure("parts_per_shift"),
                    figure("cost_per_part"),
                    figure("edges_per_100_parts"),
                );
            }
            if let Some(line) = summary["decision"]["line"].as_str() {
                let _ = writeln!(text, "  {line}");
            }
        }
        if let Some(line) = self.turning(result) {
            let _ = writeln!(text, "{line}");
        }
        for (price, rows) in maps(&summaries[..summaries.len().min(self.values.len())]) {
            let _ = writeln!(
                text,
                "difference of the decision over {price} (rows: times the present one) and {}",
                self.key
            );
            let columns = self.values.iter().take(summaries.len()).map(|value| format!("{value:>12}"));
            let _ = writeln!(text, "  {:>6}{}", "", columns.collect::<String>());
            for (factor, row) in PRICES.iter().zip(rows) {
                let cells: String = row.iter().map(|difference| format!("{difference:>12.4}")).collect();
                let _ = writeln!(text, "  {factor:>6.2}{cells}");
            }
        }
        text.trim_end().to_owned()
    }

    /// Cost of a part under every policy over the values of the key.
    fn costs(&self, summaries: &[Value], key: Axis) -> Plot {
        let unit = summaries.first().and_then(|summary| summary["currency"].as_str()).unwrap_or_default();
        let title = "Cost of a part";
        let mut plot = Plot::new(title, key, Axis::linear(title, unit))
            .describe("The cost of a part under each policy at each value of the key, with its 95 % interval.");
        let policies = summaries.first().and_then(|summary| summary["policies"].as_array()).map_or(0, Vec::len);
        for policy in 0..policies {
            let name = summaries[0]["policies"][policy]["name"].as_str().unwrap_or_default();
            let costs: Vec<(f64, f64, [Option<f64>; 2])> = self
                .values
                .iter()
                .zip(summaries)
                .filter_map(|(value, summary)| {
                    let cost = &summary["policies"][policy]["kpi"]["cost_per_part"];
                    let ends = [0, 1].map(|end| cost["ci95"][end].as_f64());
                    Some((split(value).ok()?.0, cost["mean"].as_f64()?, ends))
                })
                .collect();
            let band = costs.iter().filter_map(|(value, _, ends)| Some((*value, ends[0]?, ends[1]?)));
            plot = plot.band(format!("95 % of {name}"), band.collect::<Vec<_>>(), Style::nth(policy));
            let line = costs.iter().map(|(value, mean, _)| (*value, *mean));
            plot = plot.marked_line(name, line.collect::<Vec<_>>(), Style::nth(policy));
        }
        plot
    }

    /// The results as a page: the difference of the decision at each value, and its maps over prices.
    pub fn report(&self, result: &SweepResult) -> Report {
        let (summaries, unit) = (&result.summaries, self.unit());
        let key = || Axis::linear(self.key.as_str(), unit);
        let numbers = || self.values.iter().zip(summaries).filter_map(|(value, _)| Some(split(value).ok()?.0));
        let mut report = Report::new(format!("Comparison over {}", self.key));
        if let Some(line) = self.turning(result) {
            report = report.lead(crate::report::sentence(&line));
        }
        let end = |summary: &Value, place: usize| summary["decision"]["difference"]["ci95"][place].as_f64();
        let ends: Vec<(f64, f64, f64)> = numbers()
            .zip(summaries)
            .filter_map(|(value, summary)| Some((value, end(summary, 0)?, end(summary, 1)?)))
            .collect();
        let mean = |summary: &Value| summary["decision"]["difference"]["mean"].as_f64();
        let means: Vec<(f64, f64)> =
            numbers().zip(summaries).filter_map(|(value, summary)| Some((value, mean(summary)?))).collect();
        let compared = !means.is_empty();
        let plot = Plot::new("Difference of the decision", key(), Axis::linear("Difference of the cost of a part", ""))
            .describe(
                "The difference at each value of the key with its 95 % interval; zero is where the decision turns.",
            )
            .band("95 %", ends, Style::nth(1))
            .marked_line("difference", means, Style::nth(0))
            .horizontal(0.0, "both cost the same");
        let mut section = Section::new("Each value of the key");
        section = if compared {
            section.figure(Figure::new(
                &plot,
                "Below zero the adaptive or later policy is cheaper. Where policies are tuned, each value has settings of its own.",
            ))
        } else {
            section.figure(Figure::new(
                &self.costs(summaries, key()),
                "No policy is compared with another here: the cost of a part under each, with its 95 % interval.",
            ))
        };
        for (value, summary) in self.values.iter().zip(summaries) {
            if let Some(line) = summary["decision"]["line"].as_str() {
                section = section.paragraph(format!("{} = {value}: {line}", self.key));
            }
        }
        report = report.section(section);
        let charts = maps(&summaries[..summaries.len().min(self.values.len())]);
        if charts.is_empty() {
            return report;
        }
        let mut section = Section::new("Prices and the key together").paragraph(
            "Prices enter cost in proportion, so that the same runs tell what other prices would have made of them. Within a column \
             the settings of the policies are held.",
        );
        for (price, rows) in charts {
            let columns: Vec<f64> = numbers().collect();
            // Along a column the difference is a straight line of the factor.
            let (low, high) = (PRICES[0], PRICES[PRICES.len() - 1]);
            let turn = |column: usize| {
                let (below, above) = (rows[0][column], rows[PRICES.len() - 1][column]);
                let factor = low - below * (high - low) / (above - below);
                (low..=high).contains(&factor).then_some((columns[column], factor))
            };
            let turns: Vec<(f64, f64)> = (0..columns.len()).filter_map(turn).collect();
            let count = turns.len();
            let axes = [key(), Axis::log(format!("{price}, times the present"), ""), Axis::linear("Difference", "")];
            let mut chart = HeatMap::new(
                format!("Difference over {price} and {}", self.key),
                axes,
                columns.iter().copied(),
                PRICES,
                rows.iter().flatten().copied(),
            )
            .colours(ColourMap::Diverging)
            .describe("The difference of the decision by price and key; white is no difference.");
            if count > 0 {
                chart = chart.scatter("both cost the same", turns, Style::nth(1));
            }
            let least = rows.iter().flatten().copied().fold(f64::INFINITY, f64::min);
            let most = rows.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
            let turned = match count {
                0 => "nothing turns the decision within the map".to_owned(),
                _ => "the points are where it turns".to_owned(),
            };
            let caption = format!("From {} to {}: {turned}.", number(least, 3), number(most, 3));
            section = section.figure(Figure::new(&chart, caption).data_in("sweep.json"));
        }
        report.section(section)
    }

    /// The unit of the values.
    fn unit(&self) -> &str {
        self.values.first().and_then(|value| split(value).ok()).map_or("", |(_, unit)| unit)
    }

    /// Numbers of the values.
    fn numbers(&self) -> Vec<f64> {
        self.values.iter().filter_map(|value| Some(split(value).ok()?.0)).collect()
    }

    /// Whether a number lies within the values.
    fn holds(&self, number: f64) -> bool {
        let numbers = self.numbers();
        numbers.first().is_some_and(|first| number >= *first) && numbers.last().is_some_and(|last| number <= *last)
    }

    /// Where a line through the differences of the decision is zero ([`Turn`]).
    fn turn(&self, result: &SweepResult) -> Turn {
        Turn::new(&self.numbers(), &result.pairs, &result.summaries)
    }

    /// The same in words.
    fn turning(&self, result: &SweepResult) -> Option<String> {
        let turn = self.turn(result);
        let notes = turn.notes(&self.key, &self.values);
        let line = self.line(&turn, result.retuned);
        let said: Vec<String> = line.into_iter().chain(notes).collect();
        (!said.is_empty()).then(|| said.join("; "))
    }

    fn line(&self, turn: &Turn, retuned: bool) -> Option<String> {
        let (turn, unit) = (turn.crossing?, self.unit());
        let settings = if retuned { "tuned anew at each value" } else { "held" };
        if !self.holds(turn.at) {
            let (first, last) = (self.values.first()?, self.values.last()?);
            return Some(format!(
                "no {} from {first} to {last} turns the decision by a line through its differences (settings {settings})",
                self.key
            ));
        }
        let interval = match turn.interval {
            Some((low, high)) => format!("90 % {} … {}", plain(low, 2), plain(high, 2)),
            None => "90 % unbounded".to_owned(),
        };
        let at = format!("{} {unit}", plain(turn.at, 2));
        Some(format!(
            "a line through the differences is zero at {} = {} ({interval}; settings {settings})",
            self.key,
            at.trim_end()
        ))
    }
}

/// The difference of the decision over each price that moves it at every point: a row for each of [`PRICES`], a column a point,
/// settings held. Prices enter cost in proportion, so that two of them give all.
fn maps(summaries: &[Value]) -> Vec<(String, Vec<Vec<f64>>)> {
    if summaries.len() < 2 {
        return Vec::new();
    }
    let line = |summary: &Value, key: &Value| {
        let own = summary["tornado"].as_array()?.iter().find(|price| price["key"] == *key)?;
        let end = |place: usize| {
            let at = &own["at"][place];
            Some((at["factor"].as_f64()?, at["difference"].as_f64()?))
        };
        let ((from, low), (to, high)) = (end(0)?, end(1)?);
        let slope = (high - low) / (to - from);
        slope.is_finite().then_some((low - slope * from, slope))
    };
    let keys = summaries[0]["tornado"].as_array().into_iter().flatten().map(|price| &price["key"]);
    let map = |key: &Value| {
        let lines = summaries.iter().map(|summary| line(summary, key)).collect::<Option<Vec<(f64, f64)>>>()?;
        let row = |factor: &f64| lines.iter().map(|(base, slope)| base + slope * factor).collect();
        Some((key.as_str()?.to_owned(), PRICES.iter().map(row).collect()))
    };
    keys.filter_map(map).collect()
}

/// Mean and half-width; figures may carry their unit in the key.
fn figure(figures: &Value, name: &str) -> String {
    let found = figures.as_object().into_iter().flatten().find(|(key, _)| key.split(' ').next() == Some(name));
    let Some((_, value)) = found else { return "–".to_owned() };
    match (value["mean"].as_f64(), value["ci95"][1].as_f64()) {
        (Some(mean), Some(high)) => {
            let digits = decimals(mean, high - mean);
            format!("{} ± {}", plain(mean, digits), plain(high - mean, digits))
        }
        (Some(mean), None) => plain(mean, decimals(mean, f64::NAN)),
        _ => "–".to_owned(),
    }
}

/// A number and its unit.
fn split(text: &str) -> Result<(f64, &str), SweepError> {
    let text = text.trim();
    // The longest beginning that is a number: "1e3 mm" has an exponent, "1 e" a unit.
    let ends = text.char_indices().map(|(place, c)| place + c.len_utf8()).rev();
    let number = |end: usize| Some((text[..end].parse::<f64>().ok().filter(|number| number.is_finite())?, end));
    let (number, end) =
        ends.into_iter().find_map(number).ok_or_else(|| SweepError::NoNumber { text: text.to_owned() })?;
    Ok((number, text[end..].trim()))
}

#[cfg(test)]
mod tests {
    use super::{Sweep, SweepResult};

    #[test]
    fn a_line_through_the_differences_says_where_the_decision_turns() {
        assert_eq!(Sweep::new("key", "1e0 mm", "3e0 mm", "1").unwrap_err().fix(), "write all three in the same unit");
        assert_eq!(Sweep::new("key", "1e0", "5", "2").unwrap().values, ["1", "3", "5"]);
        let sweep = Sweep::new("key", "1 min", "3 min", "1 min").unwrap();
        // Three replications whose lines have slopes of 1, 0.8 and 1.2 and meet zero at 2, 2.1 and 1.9 min.
        let lines = [(1.0, 2.0), (0.8, 2.1), (1.2, 1.9)];
        let pairs = |x: f64| lines.map(|(slope, zero)| slope * (x - zero)).to_vec();
        let result =
            SweepResult { pairs: [1.0, 2.0, 3.0].map(pairs).to_vec(), retuned: true, ..SweepResult::default() };
        let json = sweep.json(&result);
        let turn = &json["break_even"][0];
        // The ratio of the means of intercepts and slopes: 5.96 over 3.
        assert!((turn["flips_at"].as_f64().expect("a number") - 5.96 / 3.0).abs() < 1e-12, "{json}");
        assert!(turn["ci90"][0].as_f64() < Some(1.95) && turn["ci90"][1].as_f64() > Some(2.05), "{json}");
        assert_eq!((turn["retuned"].as_bool(), json["turns_at"].as_str()), (Some(true), Some("1.99 min")));
        let far = SweepResult { pairs: [1.0, 2.0, 3.0].map(|x| pairs(x + 5.0)).to_vec(), ..SweepResult::default() };
        assert!(sweep.json(&far)["break_even"][0]["flips_at"].is_null(), "beyond what was looked at");
        assert!(sweep.text(&far).contains("no key from 1 min to 3 min turns"), "{}", sweep.text(&far));
        let few = SweepResult { pairs: vec![pairs(1.0), pairs(3.0)], ..SweepResult::default() };
        assert!(!sweep.text(&few).contains("turns"), "two values are no line");
    }

    #[test]
    fn prices_and_the_key_make_a_map_of_the_difference() {
        let sweep = Sweep::new("machine.L.tool_change_time", "1 min", "2 min", "1 min").unwrap();
        // 3 − 2 f at the first value, 3 − f at the second.
        let summary = |slope: f64| {
            let at =
                [0.5, 2.0].map(|factor| serde_json::json!({ "factor": factor, "difference": 3.0 - slope * factor }));
            serde_json::json!({ "tornado": [{ "key": "edge_cost", "at": at }] })
        };
        let summaries = [2.0, 1.0].map(summary).to_vec();
        let maps = super::maps(&summaries);
        assert_eq!((maps[0].0.as_str(), maps[0].1.len()), ("edge_cost", 5));
        assert!(maps[0].1[2] == [1.0, 2.0] && maps[0].1[4] == [-1.0, 1.0], "{maps:?}");
        let result = SweepResult { summaries: summaries.clone(), ..SweepResult::default() };
        let text = sweep.text(&result);
        assert!(text.contains("over edge_cost") && text.contains("  2.00     -1.0000      1.0000"), "{text}");
        assert_eq!(sweep.json(&result)["maps"][0]["price"], "edge_cost");
        // At the second value the decision turns at three times the price, beyond the map; at the first at 1.5 times.
        let page = sweep.report(&result).html();
        assert!(page.contains("Difference over edge_cost") && page.contains("both cost the same"), "{page}");
        assert!(super::maps(&summaries[..1]).is_empty(), "one value is no map");
        let silent = [summary(1.0), serde_json::json!({ "tornado": [] })];
        assert!(super::maps(&silent).is_empty(), "a price that one point does not know");
    }

    #[test]
    fn a_sweep_has_its_ends_and_its_unit() {
        let list = |low, high, step| Sweep::new("key", low, high, step).ok().map(|sweep| sweep.values);
        assert_eq!(list("1 min", "2 min", "0.5 min"), Some(vec!["1 min".into(), "1.5 min".into(), "2 min".into()]));
        assert_eq!(list("0.1", "0.3", "0.1"), Some(vec!["0.1".into(), "0.2".into(), "0.3".into()]));
        assert_eq!(list("3 min", "1 min", "1 min"), None);
        assert_eq!(list("1 min", "3 s", "1 min"), None);
        assert_eq!(list("1 min", "3 min", "0 min"), None);
        assert_eq!(list("x", "3 min", "1 min"), None);
    }
}
