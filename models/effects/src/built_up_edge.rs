//! Work material builds up on the edge in a window of speeds.

use crate::catalogue::{CatalogueEntry, falls, rises};
use crate::{Context, Search, Terms};
use toolroom_process::{Number, Record, record};

record! {
    /// Work material builds up on the edge in a window of speeds: there the wear rate is
    /// `× (1 + size·w)` and the specific cutting force `× (1 - 0.3·size·w)`, with
    /// `w = exp(-ln(v/speed)²/(2 width²))`.
    ///
    /// # Source
    /// Trent & Wright, Metal Cutting (2000): a built-up edge forms in a range of low speeds, raises
    /// the effective rake (less force) and tears off the edge (more wear). Gaussian window, its
    /// place and the ratio 0.3 are assumptions.
    pub struct BuiltUpEdge {
        /// Share by which the wear rate has grown at the centre of the window.
        size: Real = 0.0, 0.0..=3.0;
        /// Cutting speed at the centre of the window, v_b; assumption.
        speed: Real["m/s" => "m/min"] = 1.5, 0.01..=20.0;
        /// Width of the window in ln v, one standard deviation; assumption.
        width: Real = 0.3, 0.01..=3.0;
    }
}

/// Windows that are tried over the range of recorded speeds; the narrow width is one of the logarithm of speed.
const WINDOWS: Search =
    Search::Window { column: "cutting_speed", centre: "speed", width: ("width", 0.08), count: 5, size: 0.5 };

pub(crate) const ENTRY: CatalogueEntry = CatalogueEntry {
    id: "built_up_edge",
    title: "a built-up edge in a window of speeds",
    size: &BuiltUpEdge::<f64>::FIELDS[0],
    channels: &[falls("cutting_force"), falls("spindle_power"), rises("flank_wear")],
    regime: "cutting_speed near v_b",
    confounder: "the wear law's dependence on speed",
    separating_test: "sweep the speed in 14 steps across the window, three edges",
    source: "Trent & Wright, Metal Cutting; window and ratio are assumptions",
    processes: &[("turning", WINDOWS), ("milling", WINDOWS)],
};

impl<N: Number> BuiltUpEdge<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        if context.cutting_speed.re() > 0.0 {
            let away = (context.cutting_speed / self.speed).ln() / self.width;
            let window = (-(away * away) * 0.5).exp();
            terms.wear_rate *= self.size * window + 1.0;
            terms.specific_cutting_force *= -(self.size * window * 0.3) + 1.0;
        }
    }
}
