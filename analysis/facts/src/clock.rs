//! What the clock of a log rounds away.

/// Steps of clocks that are looked for, s, the coarsest first (assumption): what people and controls round to.
const STEPS: [f64; 9] = [600.0, 300.0, 60.0, 30.0, 15.0, 10.0, 5.0, 2.0, 1.0];

/// Standard deviation of the error that the clock leaves in times (s) of a log, each the sum of so many `differences` of two
/// rounded instants: √(step²/6) a difference, of the coarsest step of which all are whole multiples; 0 where there is none.
///
/// Times that do not scatter may be such multiples by themselves, which nothing here can know.
pub(crate) fn clock_error<'a>(times: impl Iterator<Item = &'a f64> + Clone, differences: usize) -> f64 {
    let whole = |step: f64| times.clone().all(|time| (time / step).fract().abs() < 1e-9);
    let step = STEPS.into_iter().find(|step| whole(*step)).unwrap_or(0.0);
    step * (differences as f64 / 6.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarsest_step_of_all_times_counts() {
        assert_eq!(clock_error([40.0, 70.0, 110.0].iter(), 6), 10.0);
        assert_eq!(clock_error([40.0, 71.0].iter(), 6), 1.0);
        assert_eq!(clock_error([40.0, 71.25].iter(), 6), 0.0);
    }
}
