//! `toolroom life`: tool lives, measured or simulated.

mod fit;

use crate::args::{LifeArgs, Statistics};
use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_analysis::life::analysis::Request;
use toolroom_analysis::life::replacement::Costs;

pub fn run(args: &LifeArgs, voice: &Voice) -> Result<(), Failure> {
    fit::run(args, voice)
}

/// A confidence between 50 and 99.9 %: `0.9`, `90 %`.
pub fn confidence(text: &str) -> Result<f64, String> {
    let share = match text.trim().strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().map(|percent| percent / 100.0),
        None => text.trim().parse(),
    };
    match share {
        Ok(share) if (0.5..=0.999).contains(&share) => Ok(share),
        _ => Err("a confidence from 0.5 to 0.999 is due, such as 0.9 or 90%".to_owned()),
    }
}

/// What the arguments ask for.
fn request(statistics: &Statistics) -> Result<Request, Failure> {
    let [planned, failure] = statistics.costs[..] else {
        return Err(Failure::argument("--costs takes two numbers", "write for example --costs 1 5"));
    };
    if !(planned > 0.0 && failure.is_finite() && failure >= planned) {
        let message = format!("--costs {planned} {failure}: a failure costs at least as much as a planned replacement");
        return Err(Failure::argument(message, "write both in one money, for example --costs 1 5"));
    }
    Ok(Request {
        confidence: statistics.confidence,
        bootstrap: statistics.bootstrap,
        goodness: statistics.goodness,
        costs: Costs { planned, failure },
        seed: statistics.seed.unwrap_or(1),
        ..Request::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_confidence_is_read_as_people_write_it() {
        assert_eq!([confidence("0.9"), confidence("90%"), confidence("90 %")], [Ok(0.9), Ok(0.9), Ok(0.9)]);
        assert!(["0", "1", "9", "x"].iter().all(|text| confidence(text).is_err()));
    }
}
