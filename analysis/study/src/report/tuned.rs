//! Settings that were found for the policies.

use super::Source;
use crate::figure::{decimals, plain};
use crate::kpi::Better;
use crate::tune::{TunedPolicy, TunedSetting, Tuning};
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Cell, HeatMap, Style, Table};

/// Settings of the policies, and how they were found.
pub(super) fn section(tuning: &Tuning, source: &Source<'_>) -> Section {
    let intro = format!(
        "Before the comparison every policy was tuned for {} with {} simulated replications on seed {}; the comparison \
         judges it on seed {}. What a policy costs more when it is judged than it did while it was tuned is optimism.",
        tuning.objective, tuning.budget, tuning.seed, source.scenario.seed
    );
    let mut table = Table::new(["policy", "settings", "nearly as good", "tuned", "judged", "edges lost, %"]);
    let index = source.study.index(&tuning.objective);
    let more = index.is_some_and(|index| source.study.kpis[index].definition.better == Better::More);
    for (position, policy) in source.comparison.policies.iter().enumerate() {
        let Some(tuned) = tuning.of(&policy.name) else { continue };
        let list =
            |text: &dyn Fn(&TunedSetting) -> String| tuned.settings.iter().map(text).collect::<Vec<_>>().join(", ");
        let settings = match &tuned.given {
            Some(reason) => format!("as given: {reason}"),
            None => {
                let rule = tuned.tool_changes.first().map(|chosen| format!(", changed by {}", chosen.rule));
                list(&|setting| format!("{} {}", setting.key, setting.value)) + &rule.unwrap_or_default()
            }
        };
        let judged = index.map(|index| {
            let kpi = &source.study.kpis[index];
            source.comparison.policies[position].kpis[index].scaled(kpi.definition.file_scale())
        });
        let digits = decimals(tuned.objective.unwrap_or(0.0), tuned.standard_error.unwrap_or(f64::NAN));
        let shown = |value: Option<f64>, digits: usize| value.map_or_else(String::new, |value| plain(value, digits));
        table.push([
            policy.name.as_str().into(),
            Cell::Text(settings),
            Cell::Text(list(&nearly_as_good)),
            Cell::Text(shown(tuned.objective, digits)),
            Cell::Text(shown(judged.filter(|_| tuned.is_tuned()).map(|judged| judged.mean), digits)),
            Cell::Text(shown(tuned.failed.map(|share| 100.0 * share), 1)),
        ]);
    }
    let maps =
        tuning.policies.iter().filter_map(|policy| Some((policy.name.clone(), settings_map(tuning, policy, more)?)));
    // Nothing stands between the table and the maps, so that they share a row of a wide screen.
    let mut section =
        Section::new("Settings that were compared").paragraph(intro).table("Tuned settings", table).choice(maps);
    if let Some(verdict) = &tuning.without_guard {
        section = section.note(format!(
            "The guard excludes settings that would cost less. Without it the verdict is: {}.",
            verdict.line.trim_end_matches('.')
        ));
    }
    for price in source.comparison.turning_prices() {
        section = section.note(super::sentence(&price.describe()));
    }
    section
}

/// The range of a setting within which the objective is nearly as good; the value alone where no other one is.
fn nearly_as_good(setting: &TunedSetting) -> String {
    let (low, high) = &setting.flat;
    if low == high { low.clone() } else { format!("{low} … {high}") }
}

/// How much worse the objective of one policy is over its two settings than at the best of the first grid, in per cent; `more` says
/// that a greater one is better.
fn settings_map(tuning: &Tuning, policy: &TunedPolicy, more: bool) -> Option<Figure> {
    let map = policy.map.as_ref()?;
    let known = || map.objective.iter().flatten().copied();
    let axis = |(key, unit): &(String, String)| Axis::linear(key.as_str(), if unit == "1" { "" } else { unit });
    let axes = [axis(&map.settings[0]), axis(&map.settings[1]), Axis::linear("Worse than the best", "%")];
    let best = known().reduce(if more { f64::max } else { f64::min })?;
    let worse = |value: &Option<f64>| value.map_or(f64::NAN, |value| 100.0 * ((value - best) / best).abs());
    let [columns, rows] = map.values.clone();
    let width = columns.len();
    let excluded: Vec<(f64, f64)> = (0..map.excluded.len())
        .filter(|place| map.excluded[*place])
        .map(|place| (map.values[0][place % width], map.values[1][place / width]))
        .collect();
    let mut chart = HeatMap::new(
        format!("{} of {} over its settings", tuning.objective, policy.name),
        axes,
        columns,
        rows,
        map.objective.iter().map(worse),
    )
    .scatter("chosen", [(map.chosen[0], map.chosen[1])], Style::nth(1));
    if !excluded.is_empty() {
        chart = chart.scatter("excluded by the guard", excluded, Style::IDLE);
    }
    let caption = format!(
        "Estimates from the replications of the tuning: how much worse each setting of the grid is than the best of them. The \
         settings that were chosen for {} lie on a finer grid around the least of the surface through all of them.",
        policy.name
    );
    Some(Figure::new(&chart, caption).data_in("summary.json"))
}
