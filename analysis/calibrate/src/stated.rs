//! A life that a table states.

use crate::edge::Life;
use crate::end::End;

/// What the row of an edge says of its life.
pub(crate) struct LifeStatement {
    /// Its life, min.
    pub minutes: f64,
    /// 1 where the edge was still good, 0 where it was not; NaN where nothing is said.
    pub censored: f64,
    /// Time at which the edge was found good, min; NaN where nothing is said.
    pub inspected: f64,
    /// How it ended, where a word says so.
    pub end: Option<End>,
}

impl LifeStatement {
    /// The life, and whether the edge was worn out then; what is wrong otherwise.
    pub(crate) fn life(&self) -> Result<(Life, bool), String> {
        let Self { minutes, censored, inspected, end } = *self;
        if minutes <= 0.0 {
            return Err(format!("a life of {minutes} min is none"));
        }
        if !(censored.is_nan() || censored == 0.0 || censored == 1.0) {
            return Err(format!("censored is {censored}; write 1 where the edge was still good, else 0"));
        }
        let lasted = censored != 1.0;
        if !lasted && end == Some(End::Worn) {
            let reason =
                "censored is 1, by which the edge was still good, but edge_end is `worn`: one of both is wrong";
            return Err(reason.to_owned());
        }
        let worn = lasted && end.is_none_or(|end| end == End::Worn);
        let life = match (worn, inspected.is_finite() && inspected > 0.0) {
            (false, _) => Life::Censored(minutes),
            (true, false) => Life::Exact(minutes),
            (true, true) if inspected < minutes => Life::Between(inspected, minutes),
            (true, true) => return Err(format!("inspected at {inspected} min, after its life of {minutes} min")),
        };
        Ok((life, worn))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROW: LifeStatement = LifeStatement { minutes: 40.0, censored: f64::NAN, inspected: f64::NAN, end: None };

    #[test]
    fn edges_that_did_not_wear_out_lasted_at_least_so_long() {
        assert_eq!(ROW.life(), Ok((Life::Exact(40.0), true)));
        assert_eq!(LifeStatement { end: Some(End::Chipped), ..ROW }.life(), Ok((Life::Censored(40.0), false)));
        assert_eq!(LifeStatement { censored: 1.0, ..ROW }.life(), Ok((Life::Censored(40.0), false)));
        assert_eq!(LifeStatement { inspected: 30.0, ..ROW }.life(), Ok((Life::Between(30.0, 40.0), true)));
    }

    #[test]
    fn rows_that_contradict_themselves_are_refused() {
        let worn_though_good = LifeStatement { censored: 1.0, end: Some(End::Worn), ..ROW };
        for row in [worn_though_good, LifeStatement { inspected: 50.0, ..ROW }, LifeStatement { minutes: 0.0, ..ROW }] {
            assert!(row.life().is_err());
        }
    }
}
