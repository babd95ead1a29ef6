//! Coordinates as pictures hold them.

use std::fmt::{self, Display};

/// A coordinate with at most two decimals; what is not finite is written as 0.
pub(crate) struct Px(pub f64);

impl Display for Px {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.0.is_finite() {
            return f.write_str("0");
        }
        let text = format!("{:.2}", self.0.clamp(-1e6, 1e6));
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}
