//! Normal times that are cut off at their least: what their mean truly is.

use crate::Warning;
use toolroom_scenario::{ArrivalPattern, Distribution, Scenario, Work};

/// Deviation of the true mean from the one that is written from which it is told, 1 (assumption: what nobody would see in a
/// result is not worth a line).
const TOLD: f64 = 1e-3;

/// One line for every normal time whose true mean is another than the one that is written.
pub(crate) fn truncated(scenario: &Scenario) -> Vec<Warning> {
    let mut times: Vec<(String, &Distribution)> = Vec::new();
    for part in &scenario.parts {
        for operation in &part.operations {
            let of = format!("operation \"{}\" of part \"{}\"", operation.name, part.name);
            if let Work::Plain(work) = &operation.work {
                times.push((format!("the work of {of}"), work));
            }
            times.extend(operation.setup_spread.iter().map(|spread| (format!("the setup of {of}"), spread)));
        }
    }
    for machine in &scenario.machines {
        times.push((format!("loading machine \"{}\"", machine.name), &machine.load_time));
        times.push((format!("unloading machine \"{}\"", machine.name), &machine.unload_time));
    }
    for failure in &scenario.failures {
        let machine = &scenario.machines[failure.machine].name;
        times.push((format!("the time between failures of \"{machine}\""), &failure.time_between));
        times.push((format!("the repair of \"{machine}\""), &failure.time_to_repair));
    }
    for arrival in &scenario.arrivals {
        if let ArrivalPattern::Renewal(between) = &arrival.pattern {
            times.push((format!("the time between arrivals of \"{}\"", arrival.parts_named(&scenario.parts)), between));
        }
    }
    let told = |(what, time): (String, &Distribution)| {
        let Distribution::Normal { mean, .. } = time else { return None };
        let truly = time.mean();
        let message = format!(
            "{what} is normal with mean {:.4} min and cut off at its ends: its true mean is {:.4} min",
            mean / 60.0,
            truly / 60.0
        );
        ((truly / mean - 1.0).abs() > TOLD).then_some(Warning { code: "true-mean", message })
    };
    times.into_iter().filter_map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_true_mean_of_a_normal_time_is_told() {
        let told = |sd: &str| {
            let text = format!(
                "schema = 1\n[shop]\nname = \"x\"\nhorizon = \"10 h\"\n[[machine]]\nname = \"A\"\nprocess = \"plain\"\n\
                 [[part]]\nname = \"p\"\noperation = [{{ name = \"o\", machines = \"A\", work = {{ distribution = \"normal\", \
                 mean = \"10 min\", sd = \"{sd}\" }} }}]\n[[order]]\nid = \"1\"\npart = \"p\"\n"
            );
            truncated(&toolroom_scenario_file::parse("x.toml", &text, &[]).unwrap().scenario)
        };
        // Mean 10 and standard deviation 4 above 0: 10.0705513.
        assert!(told("4 min")[0].message.ends_with("its true mean is 10.0706 min"), "{:?}", told("4 min"));
        assert!(told("2 min").is_empty());
    }
}
