//! Where the decision of a sweep turns, and between which policies.

use crate::compare::Crossing;
use serde_json::Value;

/// Confidence of the value at which a decision turns (assumption: that of other intervals of the report).
const CONFIDENCE: f64 = 0.90;
/// Values without which there is no line (two are joined by one, whatever they are).
const LEAST: usize = 3;

/// Where a line through the differences of the decision is zero: a line through those of each replication, as all values see
/// the same random numbers, and of these lines the ratio of means with its interval.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Turn {
    /// `None` where fewer than three values have a decision.
    pub crossing: Option<Crossing>,
    /// The adaptive or later policy and its rival at each value; null where there is no decision.
    pub between: Vec<Option<[String; 2]>>,
}

impl Turn {
    /// From the numbers of the values, the differences of the decision at each by replication (none where it has no decision), and
    /// the summaries.
    pub fn new(numbers: &[f64], pairs: &[Vec<f64>], summaries: &[Value]) -> Self {
        let decided: Vec<(f64, &Vec<f64>)> =
            numbers.iter().copied().zip(pairs).filter(|(_, pairs)| !pairs.is_empty()).collect();
        let replications = decided.iter().map(|(_, pairs)| pairs.len()).min().filter(|_| decided.len() >= LEAST);
        let count = decided.len() as f64;
        let mean = decided.iter().map(|(number, _)| number).sum::<f64>() / count;
        let spread = decided.iter().map(|(number, _)| (number - mean).powi(2)).sum::<f64>();
        let line = |replication: usize| {
            let slope = decided.iter().map(|(x, y)| (x - mean) * y[replication]).sum::<f64>() / spread;
            (decided.iter().map(|(_, y)| y[replication]).sum::<f64>() / count - slope * mean, slope)
        };
        let crossing = replications.map(|replications| {
            let (a, b): (Vec<f64>, Vec<f64>) = (0..replications).map(line).unzip();
            Crossing::of(&a, &b, CONFIDENCE)
        });
        let name = |summary: &Value, key: &str| Some(summary["decision"][key].as_str()?.to_owned());
        let rivals = |(place, summary): (usize, &Value)| {
            let decided = pairs.get(place).is_some_and(|pairs| !pairs.is_empty());
            decided.then(|| Some([name(summary, "adaptive")?, name(summary, "rival")?])).flatten()
        };
        Self { crossing, between: summaries.iter().enumerate().map(rivals).collect() }
    }

    /// What the line does not say by itself: values without a decision, and other policies along the way.
    pub fn notes(&self, key: &str, values: &[String]) -> Vec<String> {
        let mut notes = Vec::new();
        let mut kinds: Vec<(&[String; 2], Vec<&str>)> = Vec::new();
        let mut without: Vec<&str> = Vec::new();
        for (value, rivals) in values.iter().zip(&self.between) {
            let Some(rivals) = rivals else {
                without.push(value);
                continue;
            };
            match kinds.iter_mut().find(|(known, _)| *known == rivals) {
                Some((_, at)) => at.push(value),
                None => kinds.push((rivals, vec![value])),
            }
        }
        let decided = self.between.len() - without.len();
        // Where nothing is compared anywhere there is no decision to miss.
        if decided > 0 && !without.is_empty() {
            let missed = if self.crossing.is_some() {
                "the line leaves them out".to_owned()
            } else {
                format!("with {decided} of {} values there is no line", self.between.len())
            };
            notes.push(format!("no decision at {key} = {}: {missed}", without.join(", ")));
        }
        if kinds.len() > 1 {
            let told = kinds.iter().map(|([one, other], at)| format!("{one} against {other} at {}", at.join(", ")));
            let told: Vec<String> = told.collect();
            let line = if self.crossing.is_some() { ", and the line runs through all of them" } else { "" };
            notes.push(format!(
                "the decision is not between the same policies at every value{line}: {}",
                told.join("; ")
            ));
        }
        notes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn summary(adaptive: &str, rival: &str) -> Value {
        json!({ "decision": { "adaptive": adaptive, "rival": rival } })
    }

    #[test]
    fn a_line_through_other_policies_says_which_and_one_without_a_decision_says_where() {
        let values = ["1 min", "2 min", "3 min", "4 min"].map(str::to_owned);
        let numbers = [1.0, 2.0, 3.0, 4.0];
        // One EUR a minute, zero at 2.5 min.
        let pairs = |x: f64| vec![x - 2.4, x - 2.5, x - 2.6];
        let mut summaries = vec![summary("a", "c"), summary("a", "c"), summary("b", "c"), summary("b", "c")];
        let all = Turn::new(&numbers, &numbers.map(pairs), &summaries);
        assert!((all.crossing.expect("a line").at - 2.5).abs() < 1e-12);
        assert_eq!(
            all.notes("key", &values),
            ["the decision is not between the same policies at every value, and the line runs through all of them: \
              a against c at 1 min, 2 min; b against c at 3 min, 4 min"]
        );
        summaries[2] = json!({ "decision": { "adaptive": null, "rival": null } });
        summaries[3] = summary("a", "c");
        let three = [pairs(1.0), pairs(2.0), Vec::new(), pairs(4.0)];
        let some = Turn::new(&numbers, &three, &summaries);
        assert!((some.crossing.expect("a line").at - 2.5).abs() < 1e-12);
        assert_eq!(some.notes("key", &values), ["no decision at key = 3 min: the line leaves them out"]);
        let two = [pairs(1.0), Vec::new(), Vec::new(), pairs(4.0)];
        summaries[1] = summaries[2].clone();
        let few = Turn::new(&numbers, &two, &summaries);
        assert_eq!(few.crossing, None);
        assert_eq!(
            few.notes("key", &values),
            ["no decision at key = 2 min, 3 min: with 2 of 4 values there is no line"]
        );
        let none = Turn::new(&numbers, &vec![Vec::new(); 4], &vec![summaries[2].clone(); 4]);
        assert!(none.notes("key", &values).is_empty() && none.crossing.is_none());
    }
}
