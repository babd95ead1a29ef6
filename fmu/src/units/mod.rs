//! The units that are shipped.

mod controller;
mod infeed;
mod machine;
mod milling;
mod turning;

pub use machine::{MillingMachine, TurningMachine};

/// A record of dual numbers: values of one record, derivatives of another.
macro_rules! seeded {
    ($value:expr, $slope:expr, $record:ident) => {{
        let mut slopes = [0.0; <$record as toolroom_process::Record>::LEN];
        toolroom_process::Record::write_to($slope, &mut slopes);
        let mut slopes = slopes.into_iter();
        $value.map(|value| Dual64::new(value, slopes.next().unwrap_or(0.0)))
    }};
}
use seeded;
