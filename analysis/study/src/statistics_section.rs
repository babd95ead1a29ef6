//! The section `[statistics]` of a scenario: what the command line says in other words.

use crate::kpi::kpis;
use crate::study::{Precision, Study};
use crate::variants::{LATE_ORDERS, NoSelection, Wanted};
use toolroom_form::nearest;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::Statistics;
use toolroom_shop::{RunLog, ShopError};

/// A value of `[statistics]` that says nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("[statistics] {key}: {reason}")]
pub struct StatisticsError {
    key: String,
    reason: String,
    fix: String,
}

impl StatisticsError {
    /// The way out.
    pub fn fix(&self) -> &str {
        &self.fix
    }
}

/// What `[statistics]` wants, understood.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StatisticsWanted {
    /// The figure that matters most.
    pub primary: Option<String>,
    /// When a study stops.
    pub until: Vec<Precision>,
    /// By what the best shop is selected.
    pub select: Option<Wanted>,
}

impl StatisticsWanted {
    /// What the section of a scenario says.
    ///
    /// # Errors
    /// [`StatisticsError`]: a figure that is not known, a precision or a difference that is none.
    pub fn from_scenario(scenario: &Scenario, section: &Statistics) -> Result<Self, StatisticsError> {
        if let Some(primary) = &section.primary {
            check_figure(scenario, "primary", primary)?;
        }
        let mut until = Vec::new();
        for (figure, width) in &section.until {
            let key = format!("until.{figure}");
            check_figure(scenario, &key, figure)?;
            let text = if width.contains("half-width") { width.clone() } else { format!("half-width {width}") };
            until.push(format!("{figure} {text}").parse::<Precision>().map_err(|error| StatisticsError {
                key,
                reason: error.to_string(),
                fix: "write lead_time = \"half-width 2 %\", or a width with the unit of the figure".to_owned(),
            })?);
        }
        let select = section.select.as_ref().map(|select| {
            let wanted = Wanted::parse(scenario, &format!("{} {}", select.kpi, select.indifference))?;
            Ok(wanted.with_confidence(select.confidence))
        });
        let select = select.transpose().map_err(|error: NoSelection| StatisticsError {
            key: "select".to_owned(),
            reason: error.to_string(),
            fix: "write select = { kpi = \"lead_time\", indifference = \"15 min\" }, or \"0.5 %\" of the shop as it is"
                .to_owned(),
        })?;
        Ok(Self { primary: section.primary.clone(), until, select })
    }
}

fn check_figure(scenario: &Scenario, key: &str, id: &str) -> Result<(), StatisticsError> {
    let known: Vec<&str> =
        kpis(scenario).into_iter().filter(|kpi| kpi.machine.is_none()).map(|kpi| kpi.definition.id).collect();
    if known.contains(&id) || id == LATE_ORDERS && key == "primary" && !scenario.orders.is_empty() {
        return Ok(());
    }
    let near = nearest(id, known.iter().copied()).map(|near| format!("did you mean `{near}`? "));
    Err(StatisticsError {
        key: key.to_owned(),
        reason: format!("there is no figure \"{id}\" of the shop"),
        fix: format!("{}figures: {}", near.unwrap_or_default(), known.join(", ")),
    })
}

/// The run that schedule and sequences show: the first, or with a primary figure the one of the median of it.
#[derive(Clone, Debug)]
pub(crate) struct PicturedRun<'a> {
    /// Number of the replication, from 0.
    pub replication: u32,
    /// Its log.
    pub log: std::borrow::Cow<'a, RunLog>,
}

impl<'a> PicturedRun<'a> {
    /// That of a study; `None` where no run has a log.
    ///
    /// # Errors
    /// [`ShopError`] where the run, made again for its log, stops.
    pub fn from_scenario(scenario: &Scenario, study: &'a Study) -> Result<Option<Self>, ShopError> {
        let Some(first) = study.first_logs.first() else { return Ok(None) };
        let replication = study.primary.as_deref().and_then(|id| median_of(scenario, study, id)).unwrap_or(0);
        let log = if replication == 0 {
            std::borrow::Cow::Borrowed(first)
        } else {
            std::borrow::Cow::Owned(toolroom_shop::run(scenario, study.policies[0], replication)?)
        };
        Ok(Some(Self { replication, log }))
    }

    /// In words for the page: which run it is.
    pub fn words(&self, study: &Study) -> String {
        match &study.primary {
            None => "First replication".to_owned(),
            Some(id) => format!("Replication {} of {}, the median by {id}", self.replication + 1, study.replications),
        }
    }
}

/// The replication with the median of a figure under the first policy: of an even number the lower one, of several alike the
/// first.
fn median_of(scenario: &Scenario, study: &Study, id: &str) -> Option<u32> {
    let values: Vec<f64> = if id == LATE_ORDERS {
        study.planner_figures(0).map(|run| crate::planner::late_in(scenario, &run)).collect()
    } else {
        study.values(0, study.index(id)?)
    };
    let mut order: Vec<usize> = (0..values.len()).filter(|run| values[*run].is_finite()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]).then(a.cmp(b)));
    order.get(order.len().saturating_sub(1) / 2).map(|run| *run as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{StudyOptions, run_study};
    use std::sync::atomic::AtomicBool;
    use toolroom_scenario_file::{ScenarioFile, parse};

    const SHOP: &str = "schema = 1\n[shop]\nname = \"queue\"\nhorizon = \"40 h\"\nreplications = 5\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\n\
        [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"do\"\nmachines = \"M\"\nwork = { distribution = \"exponential\", mean = \"8 min\" }\n\
        [[arrivals]]\npart = \"p\"\npattern = \"poisson\"\nrate = \"6 1/h\"\n";

    fn file(section: &str) -> ScenarioFile {
        parse("queue.toml", &format!("{SHOP}[statistics]\n{section}"), &[]).unwrap_or_else(|error| panic!("{error}"))
    }

    fn wanted(section: &str) -> Result<StatisticsWanted, StatisticsError> {
        let file = file(section);
        StatisticsWanted::from_scenario(&file.scenario, &file.statistics)
    }

    #[test]
    fn the_section_says_what_the_command_line_says() {
        let read = wanted("until = { lead_time = \"half-width 2 %\", wip = \"0.5\" }\nselect = { kpi = \"lead_time\", indifference = \"0.5 %\", confidence = \"90 %\" }\n").expect("understood");
        let texts: Vec<String> = read.until.iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["lead_time half-width 2%", "wip half-width 0.5"]);
        let select = Wanted::parse(&file("").scenario, "lead_time 0.5 %").expect("a selection").with_confidence(0.9);
        assert_eq!(read.select, Some(select));
        for (section, words, fix) in [
            ("primary = \"lead_tine\"", "primary: there is no figure \"lead_tine\"", "did you mean `lead_time`"),
            ("primary = \"late_orders\"", "late_orders", "figures: "),
            ("until = { led_time = \"2 %\" }", "until.led_time", "did you mean `lead_time`"),
            ("until = { lead_time = \"half-width 0 %\" }", "until.lead_time", "half-width 2 %"),
            ("select = { kpi = \"lead_time\", indifference = \"soon\" }", "select: ", "0.5 %"),
            ("select = { kpi = \"lead_time\", indifference = \"-1 min\" }", "above zero", "indifference"),
        ] {
            let error = wanted(section).expect_err(section);
            assert!(error.to_string().contains(words) && error.fix().contains(fix), "{error}: {}", error.fix());
        }
    }

    #[test]
    fn the_run_of_the_median_is_pictured() {
        let scenario = file("").scenario;
        let study = |primary: Option<&str>| {
            let options = StudyOptions { primary: primary.map(str::to_owned), ..StudyOptions::of(&scenario) };
            run_study(&scenario, &options, None, &|_| {}, &AtomicBool::new(false)).expect("a study")
        };
        let first = study(None);
        let pictured = PicturedRun::from_scenario(&scenario, &first).expect("it runs").expect("a log");
        assert_eq!((pictured.replication, pictured.words(&first)), (0, "First replication".to_owned()));
        let by_time = study(Some("lead_time"));
        let pictured = PicturedRun::from_scenario(&scenario, &by_time).expect("it runs").expect("a log");
        let values = by_time.values(0, by_time.index("lead_time").expect("a figure"));
        let less = values.iter().filter(|value| **value < values[pictured.replication as usize]).count();
        assert_eq!((values.len(), less), (5, 2), "{values:?}");
        let again = toolroom_shop::run(&scenario, 0, pictured.replication).expect("it runs");
        assert_eq!(again.digest, pictured.log.digest);
        assert!(pictured.words(&by_time).ends_with("of 5, the median by lead_time"));
    }
}
