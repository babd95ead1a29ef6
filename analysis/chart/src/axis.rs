//! Axes: scale, range, ticks and the words beside them.

/// How values become distances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Linear,
    Log,
}

/// An axis: label, unit, scale and, if wanted, a fixed range or fixed ticks.
///
/// Values are in the display unit that the label names.
///
/// # Examples
/// ```
/// use toolroom_chart::Axis;
/// let axis = Axis::linear("Flank wear VB", "mm").range(0.0, 0.3);
/// assert_eq!(axis.caption(), "Flank wear VB [mm]");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    label: String,
    unit: String,
    kind: Kind,
    include: Option<f64>,
    range: Option<(f64, f64)>,
    ticks: Option<Vec<(f64, String)>>,
}

impl Axis {
    /// A linear axis. An empty unit marks a dimensionless quantity.
    #[must_use]
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), kind: Kind::Linear, include: None, range: None, ticks: None }
    }

    /// A logarithmic axis; values that are not positive cannot be drawn on it and are counted.
    #[must_use]
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { kind: Kind::Log, ..Self::linear(label, unit) }
    }

    /// Fixes the range. Bounds that are not finite and increasing are ignored.
    #[must_use]
    pub fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// Widens the range of the data so that it contains `value`.
    #[must_use]
    pub fn include(mut self, value: f64) -> Self {
        self.include = Some(value);
        self
    }

    /// Replaces the ticks by labelled values, for example of a probability paper.
    #[must_use]
    pub fn ticks(mut self, ticks: impl IntoIterator<Item = (f64, String)>) -> Self {
        self.ticks = Some(ticks.into_iter().collect());
        self
    }

    /// `label [unit]`, as printed beside the axis and over columns of data.
    #[must_use]
    pub fn caption(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} [{}]", self.label, self.unit) }
    }

    pub(crate) fn unit(&self) -> &str {
        &self.unit
    }

    /// Sets the range unless the caller has.
    pub(crate) fn default_range(mut self, low: f64, high: f64) -> Self {
        self.range = self.range.or(Some((low, high)));
        self
    }

    /// The axis of `count` equal cells whose first and last centres are given: it ends at their
    /// outer borders, unless the caller has set a range.
    pub(crate) fn around(self, [first, last]: [f64; 2], count: usize) -> Self {
        if count < 2 {
            return self;
        }
        let parts = 2.0 * (count - 1) as f64;
        if self.kind == Kind::Log {
            let half = (last / first).powf(1.0 / parts);
            return self.default_range(first / half, last * half);
        }
        let half = last / parts - first / parts;
        self.default_range(first - half, last + half)
    }

    /// Whether a value has a place on the axis.
    pub(crate) fn holds(&self, value: f64) -> bool {
        value.is_finite() && (self.kind == Kind::Linear || value > 0.0)
    }

    /// The scale over the given values; `None` when none of them can be drawn.
    pub(crate) fn scale(&self, values: impl IntoIterator<Item = f64>) -> Option<Scale> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in values.into_iter().filter(|&v| self.holds(v)).map(|v| v.clamp(-LARGEST, LARGEST)) {
            low = low.min(v);
            high = high.max(v);
        }
        if low > high {
            return None;
        }
        if let Some(v) = self.include.filter(|&v| self.holds(v)) {
            low = low.min(v);
            high = high.max(v);
        }
        let bounds = match self.range {
            Some((a, b)) if self.holds(a) && self.holds(b) && a < b && b - a < 2.0 * LARGEST => (a, b),
            _ => self.padded(low, high),
        };
        Some(Scale { kind: self.kind, low: bounds.0, high: bounds.1, start: 0.0, end: 1.0 })
    }

    fn padded(&self, low: f64, high: f64) -> (f64, f64) {
        if self.kind == Kind::Log {
            let low = low.max(1.0 / LARGEST);
            let high = high.max(low);
            let margin = if high / low < 1.0 + 1e-9 { 2.0 } else { (high / low).powf(0.03).max(1.02) };
            return (low / margin, high * margin);
        }
        let span = high - low;
        if span <= 1e-9 * low.abs().max(high.abs()) {
            let margin = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
            return (low - margin, high + margin);
        }
        // An axis that nearly reaches zero, or stands on it, starts at zero.
        let below = if (0.0..0.25 * high.max(0.0)).contains(&low) { low } else { 0.04 * span };
        let above = if high <= 0.0 && high > 0.25 * low { -high } else { 0.04 * span };
        (low - below, high + above)
    }

    /// The ticks within the scale, about `wanted` of them, and the power of ten taken out of
    /// their labels.
    pub(crate) fn marks(&self, scale: &Scale, wanted: usize) -> Ticks {
        if let Some(ticks) = &self.ticks {
            let inside = ticks.iter().filter(|(v, _)| self.holds(*v) && (scale.low..=scale.high).contains(v));
            return Ticks { major: inside.cloned().collect(), minor: Vec::new(), exponent: 0 };
        }
        match self.kind {
            Kind::Linear => linear_ticks(scale.low, scale.high, wanted),
            Kind::Log => log_ticks(scale.low, scale.high, wanted),
        }
    }

    /// The caption with the power of ten that the tick labels leave out.
    pub(crate) fn caption_with(&self, exponent: i32) -> String {
        if exponent == 0 { self.caption() } else { format!("{} ×10{}", self.caption(), superscript(exponent)) }
    }
}

/// Values beyond this are drawn at the border: their differences must not overflow.
const LARGEST: f64 = 1e150;

/// A mapping of values to pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    kind: Kind,
    pub low: f64,
    pub high: f64,
    start: f64,
    end: f64,
}

impl Scale {
    /// The same range between two pixel positions.
    pub fn on(self, start: f64, end: f64) -> Self {
        Self { start, end, ..self }
    }

    /// The pixel of a value, `None` when it has no place on the axis.
    pub fn at(&self, value: f64) -> Option<f64> {
        let share = match self.kind {
            Kind::Linear => (value.clamp(-LARGEST, LARGEST) - self.low) / (self.high - self.low),
            Kind::Log if value > 0.0 => (value / self.low).ln() / (self.high / self.low).ln(),
            Kind::Log => return None,
        };
        value.is_finite().then(|| self.start + share.clamp(-20.0, 21.0) * (self.end - self.start))
    }
}

/// Ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ticks {
    pub major: Vec<(f64, String)>,
    pub minor: Vec<f64>,
    pub exponent: i32,
}

/// The step 1, 2, 2.5 or 5 × 10ⁿ that divides `span` into about `wanted` parts.
fn nice_step(span: f64, wanted: usize) -> f64 {
    let raw = span / wanted.max(1) as f64;
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|m| m * power >= raw * 0.999).unwrap_or(10.0);
    step * power
}

fn linear_ticks(low: f64, high: f64, wanted: usize) -> Ticks {
    let step = nice_step(high - low, wanted);
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    if !(step.is_finite() && step > 0.0 && last - first < 100.0) {
        return Ticks::default();
    }
    let largest = low.abs().max(high.abs());
    let exponent = if (1e-3..1e5).contains(&largest) { 0 } else { (largest.log10().floor() / 3.0).floor() as i32 * 3 };
    // Two factors: 10^-exponent alone overflows for the largest values.
    let shorten = |v: f64| v / 10f64.powi(exponent / 2) / 10f64.powi(exponent - exponent / 2);
    let digits = decimals(shorten(step));
    let count = (last - first).max(-1.0) as i64;
    let major = (0..=count)
        .map(|i| {
            let v = (first + i as f64) * step;
            (v, minus(format!("{:.digits$}", shorten(v))))
        })
        .collect();
    Ticks { major, minor: Vec::new(), exponent }
}

/// Decimals that write multiples of `step` exactly: 0.25 needs two.
fn decimals(step: f64) -> usize {
    (0..12)
        .find(|&d| {
            let scaled = step * 10f64.powi(d);
            (scaled - scaled.round()).abs() < 1e-6 * scaled
        })
        .unwrap_or(12) as usize
}

fn log_ticks(low: f64, high: f64, wanted: usize) -> Ticks {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let inside = |v: f64| v >= low * (1.0 - 1e-9) && v <= high * (1.0 + 1e-9);
    let decades = (last - first).max(1) as usize;
    let stride = decades.div_ceil(wanted.max(1)) as i32;
    let multiples =
        |list: &'static [u8]| (first..=last).flat_map(move |n| list.iter().map(move |&m| f64::from(m) * 10f64.powi(n)));
    let mut major: Vec<f64> =
        (first..=last).filter(|n| n.rem_euclid(stride) == 0).map(|n| 10f64.powi(n)).filter(|&v| inside(v)).collect();
    if major.len() < 3 {
        major = multiples(&[1, 2, 5]).filter(|&v| inside(v)).collect();
    }
    if major.len() < 3 {
        major = multiples(&[1, 2, 3, 4, 5, 6, 7, 8, 9]).filter(|&v| inside(v)).collect();
    }

    if major.len() < 3 {
        // Hardly a factor of two: as on a linear axis.
        return linear_ticks(low, high, wanted);
    }
    let minor = if stride == 1 && decades <= 8 {
        multiples(&[1, 2, 3, 4, 5, 6, 7, 8, 9]).filter(|&v| inside(v)).collect()
    } else {
        Vec::new()
    };
    Ticks { major: major.into_iter().map(|v| (v, power_label(v))).collect(), minor, exponent: 0 }
}

/// `0.02`, `500`, `10⁵`, `2×10⁻⁴`.
fn power_label(v: f64) -> String {
    if (0.999e-3..1.001e4).contains(&v) {
        return number(v, 3);
    }
    let n = (v * 1.000_001).log10().floor() as i32;
    let m = (v / 10f64.powi(n / 2) / 10f64.powi(n - n / 2)).round();
    if m == 1.0 { format!("10{}", superscript(n)) } else { format!("{m}×10{}", superscript(n)) }
}

fn superscript(n: i32) -> String {
    n.to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            c => char::from_u32('⁰' as u32 + (c as u32 - '0' as u32)).unwrap_or(c),
        })
        .collect()
}

/// The typographic minus; a negative zero loses its sign.
fn minus(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Numbers of one picture: as many decimals for all as give the largest three significant digits.
pub(crate) fn alike(values: impl IntoIterator<Item = f64>) -> impl Fn(f64) -> String {
    let largest = values.into_iter().filter(|v| v.is_finite()).fold(0.0, |m: f64, v| m.max(v.abs()));
    let plain = (1e-2..1e5).contains(&largest);
    let digits = if plain { (2 - largest.log10().floor() as i32).max(0) as usize } else { 0 };
    move |v| if plain && v.is_finite() { minus(format!("{v:.digits$}")) } else { number(v, 3) }
}

/// A number for people: so many significant digits, a power of ten when it is very large or small.
///
/// # Examples
/// ```
/// use toolroom_chart::number;
/// assert_eq!(number(0.123_46, 3), "0.123");
/// assert_eq!(number(-1.234_56e-7, 3), "−1.23×10⁻⁷");
/// ```
#[must_use]
pub fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.clamp(1, 17);
    let rounded = format!("{:.*e}", digits - 1, value);
    let Some((mantissa, exponent)) = rounded.split_once('e') else { return rounded };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trim =
        |s: &str| if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').to_owned() } else { s.to_owned() };
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        let rounded: f64 = rounded.parse().unwrap_or(value);
        return minus(trim(&format!("{rounded:.decimals$}")));
    }
    minus(format!("{}×10{}", trim(mantissa), superscript(exponent)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64], wanted: usize) -> Vec<String> {
        let scale = axis.scale(values.iter().copied()).expect("values can be drawn");
        axis.marks(&scale, wanted).major.into_iter().map(|(_, l)| l).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_the_decimals_that_they_need() {
        let axis = Axis::linear("x", "").range(0.0, 0.3);
        assert_eq!(labels(&axis, &[0.1], 6), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"]);
        let axis = Axis::linear("x", "").range(-1.0, 1.0);
        assert_eq!(labels(&axis, &[0.1], 4), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        let axis = Axis::linear("x", "").range(0.0, 1.0);
        assert_eq!(labels(&axis, &[0.1], 4), ["0.00", "0.25", "0.50", "0.75", "1.00"]);
    }

    #[test]
    fn large_values_leave_their_power_of_ten_to_the_caption() {
        let axis = Axis::linear("Stress", "Pa").range(0.0, 4e9);
        let scale = axis.scale([1.0]).expect("drawable");
        let ticks = axis.marks(&scale, 4);
        assert_eq!(ticks.exponent, 9);
        assert_eq!(ticks.major.last().map(|(_, l)| l.as_str()), Some("4"));
        assert_eq!(axis.caption_with(ticks.exponent), "Stress [Pa] ×10⁹");
    }

    #[test]
    fn log_ticks_are_decades_or_one_two_five() {
        assert_eq!(
            labels(&Axis::log("x", "").range(0.01, 1e6), &[1.0], 10),
            ["0.01", "0.1", "1", "10", "100", "1000", "10000", "10⁵", "10⁶"]
        );
        assert_eq!(labels(&Axis::log("x", "").range(10.0, 100.0), &[20.0], 6), ["10", "20", "50", "100"]);
        assert_eq!(labels(&Axis::log("x", "").range(30.0, 40.0), &[31.0], 5), ["30", "32", "34", "36", "38", "40"]);
    }

    #[test]
    fn a_scale_needs_a_value_that_can_be_drawn() {
        assert!(Axis::linear("x", "").scale([f64::NAN, f64::INFINITY]).is_none());
        assert!(Axis::log("x", "").scale([0.0, -1.0]).is_none());
        assert!(Axis::linear("x", "").scale([]).is_none());
    }

    #[test]
    fn ticks_lie_inside_the_range_whatever_it_is() {
        for (a, b) in [(1e-300, 1e-299), (-1e308, 1e308), (5.0, 5.0), (0.0, 0.0), (1e16, 1e16 + 2.0), (0.0, 5e-324)] {
            for axis in [Axis::linear("x", ""), Axis::log("x", "")] {
                let Some(scale) = axis.scale([a, b]) else { continue };
                let ticks = axis.marks(&scale, 6).major;
                assert!(ticks.len() < 60, "{a} {b}: {} ticks", ticks.len());
                for (v, _) in ticks {
                    let place = scale.at(v).expect("a tick has a place");
                    assert!((-1e-6..=1.0 + 1e-6).contains(&place), "{a} {b}: tick {v} at {place}");
                }
            }
        }
    }

    #[test]
    fn axes_of_positive_values_start_at_zero_when_that_costs_little() {
        let scale = Axis::linear("x", "").scale([0.1, 1.0]).expect("drawable");
        assert_eq!(scale.low, 0.0);
        let scale = Axis::linear("x", "").scale([0.9, 1.0]).expect("drawable");
        assert!(scale.low > 0.8);
    }

    #[test]
    fn numbers_of_one_picture_have_the_same_decimals() {
        let text = alike([-81.0, 9.4, 0.4]);
        assert_eq!([text(-44.0), text(9.4), text(0.0)], ["−44.0", "9.4", "0.0"]);
        assert_eq!(alike([1e-9])(2.5e-9), "2.5×10⁻⁹");
    }

    #[test]
    fn numbers_keep_their_significant_digits() {
        assert_eq!(number(201.649, 4), "201.6");
        assert_eq!(number(999.96, 4), "1000");
        assert_eq!(number(123_456.0, 4), "123500");
        assert_eq!(number(1.5e7, 4), "1.5×10⁷");
        assert_eq!(number(-0.53, 2), "−0.53");
        assert_eq!(number(f64::NAN, 2), "–");
    }
}
