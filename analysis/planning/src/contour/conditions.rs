//! How the gains move when one condition is another.

use rayon::prelude::*;
use toolroom_contour::{ContourFile, FormError, Models, Objective, Parameters, Pass, PathError, Planner};
use toolroom_form::significant;
use toolroom_process::Record;

/// What a plan makes least, with its name.
pub const OBJECTIVES: [(&str, Objective); 2] = [("time", Objective::Time), ("cost", Objective::Cost)];

/// Gains in productivity that the dissertation abstract reports for profile holes.
///
/// # Source
/// Lukin, contour milling on NC machines (dissertation abstract, 1998), results.
pub const REPORTED_PRODUCTIVITY: [f64; 2] = [0.10, 0.14];
/// Its changes of cost.
pub const REPORTED_COST: [f64; 2] = [-0.18, -0.15];

/// What a plan gains over the handbook regime of the same conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Parts per time, as a share of the handbook regime.
    pub productivity: f64,
    /// Cost per part, as a share of the handbook regime; negative where the plan is cheaper.
    pub cost: f64,
}

impl Gain {
    /// Whether both lie where the paper's do.
    pub fn as_reported(&self) -> bool {
        let [low, high] = REPORTED_PRODUCTIVITY;
        let [cheap, dear] = REPORTED_COST;
        (low..=high).contains(&self.productivity) && (cheap..=dear).contains(&self.cost)
    }
}

/// Gains under one changed condition, one for each of [`OBJECTIVES`]; none where handbook regime
/// or plan do not exist.
pub struct Condition {
    /// The condition with its value.
    pub name: String,
    /// One for each of [`OBJECTIVES`]; `None` where there is no plan.
    pub gains: [Option<Gain>; 2],
}

/// What a condition is worked out with.
#[derive(Clone)]
struct Case {
    name: String,
    parameters: Parameters,
    pass: Pass,
    models: Models,
}

/// The conditions as given, then each with one change.
///
/// # Source
/// Which changes: assumption.
pub fn conditions(file: &ContourFile, pass: &Pass) -> Vec<Condition> {
    let given =
        Case { name: "as given".to_owned(), parameters: file.parameters.clone(), pass: *pass, models: file.models };
    let mut cases = vec![given.clone()];
    let mut change = |name: String, change: &dyn Fn(&mut Case)| {
        let mut case = Case { name, ..given.clone() };
        change(&mut case);
        // A change beyond the range of a value is none that could be studied.
        if case.pass.check().is_ok() && case.parameters.economics.check().is_ok() {
            cases.push(case);
        }
    };
    let mm = |value: f64| format!("{} mm", significant(round(value * 1e3)));
    for factor in [0.6, 1.6] {
        let value = pass.tolerance * factor;
        change(format!("tolerance {}", mm(value)), &|case| case.pass.tolerance = value);
    }
    for factor in [0.4, 2.0] {
        let value = pass.allowance * factor;
        change(format!("allowance {}", mm(value)), &|case| case.pass.allowance = value);
    }
    for factor in [0.8, 1.25] {
        let value = pass.table_feed * factor;
        change(format!("table feed {}/tooth", mm(value)), &|case| case.pass.table_feed = value);
    }
    for factor in [0.8, 1.25] {
        let value = pass.hardness_ratio * factor;
        change(format!("hardness × {}", significant(round(value))), &|case| case.pass.hardness_ratio = value);
    }
    for factor in [0.5, 2.5] {
        let value = file.parameters.economics.edge_cost * factor;
        change(format!("edge cost {} EUR", significant(round(value))), &|case| {
            case.parameters.economics.edge_cost = value
        });
    }
    if pass.deflection_compensation < 0.8 {
        change("80 % of the deflection compensated".to_owned(), &|case| case.pass.deflection_compensation = 0.8);
    }
    let laws = [
        ("path error by eq. (14)", PathError::Empirical),
        ("path error of ideal servos", PathError::default()),
        ("no path error", PathError::Off),
    ];
    for (name, law) in laws {
        if law != file.models.path_error {
            change(name.to_owned(), &|case| case.models.path_error = law);
        }
    }
    let (name, form) = match file.models.form_error {
        FormError::Mean => ("form judged over the height", FormError::Helical),
        FormError::Helical => ("form by the average force", FormError::Mean),
    };
    change(name.to_owned(), &|case| case.models.form_error = form);
    cases.into_par_iter().map(|case| worked_out(file, case)).collect()
}

/// Without the rounding of a product.
fn round(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

fn worked_out(file: &ContourFile, case: Case) -> Condition {
    let gain = |objective: Objective| {
        let planner = Planner::new(&file.contour, &case.parameters, &case.pass, &case.models).ok()?;
        let (handbook, plan) = (planner.handbook().ok()?, planner.optimal(objective).ok()?);
        Some(Gain { productivity: plan.productivity_gain(&handbook), cost: plan.cost_change(&handbook) })
    };
    let gains = OBJECTIVES.map(|(_, objective)| gain(objective));
    Condition { name: case.name, gains }
}
