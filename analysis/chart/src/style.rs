//! Colours, dashes, markers and hatches. Every style carries all four cues, so that colour is
//! never the only one.

use std::fmt::Write;

/// A colour of the Okabe–Ito palette, distinguishable with all common colour vision deficiencies.
///
/// # Source
/// Okabe and Ito, *Color Universal Design* (2008). The dark variants are the same hues, lightened
/// for contrast on a dark page: an assumption.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Blue.
    Blue,
    /// Vermillion.
    Vermillion,
    /// Bluish green.
    Green,
    /// Reddish purple.
    Purple,
    /// Orange.
    Orange,
    /// Sky blue.
    Sky,
    /// Yellow; for areas only, too faint for thin lines on white.
    Yellow,
    /// The colour of the text: black on a light page.
    Ink,
    /// Grey, for what is idle or in the background.
    Grey,
}

/// How a colour is written: a class that the page's style sheet colours, and the literal colour
/// for a picture that stands alone.
#[derive(Clone, Copy)]
pub(crate) struct Paint {
    pub class: &'static str,
    pub light: &'static str,
    dark: &'static str,
}

const fn paint(class: &'static str, light: &'static str, dark: &'static str) -> Paint {
    Paint { class, light, dark }
}

const BLUE: Paint = paint("tr-blue", "#0072b2", "#4fa8e0");
const VERMILLION: Paint = paint("tr-vermillion", "#d55e00", "#f0803c");
const GREEN: Paint = paint("tr-green", "#009e73", "#2cc79a");
const PURPLE: Paint = paint("tr-purple", "#cc79a7", "#dd94bd");
const ORANGE: Paint = paint("tr-orange", "#e69f00", "#f0b63c");
const SKY: Paint = paint("tr-sky", "#56b4e9", "#93d1f5");
const YELLOW: Paint = paint("tr-yellow", "#f0e442", "#f0e442");
const GREY: Paint = paint("tr-grey", "#a9afb6", "#6c747d");
pub(crate) const INK: Paint = paint("tr-ink", "#1d2126", "#e8eaed");
pub(crate) const MUTED: Paint = paint("tr-muted", "#5a626b", "#a4adb7");
pub(crate) const GRID: Paint = paint("tr-grid", "#e3e6ea", "#33393f");
pub(crate) const PAPER: Paint = paint("tr-paper", "#ffffff", "#171a1e");

const PAINTS: [Paint; 12] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, YELLOW, GREY, INK, MUTED, GRID, PAPER];

impl Colour {
    pub(crate) const fn paint(self) -> Paint {
        match self {
            Self::Blue => BLUE,
            Self::Vermillion => VERMILLION,
            Self::Green => GREEN,
            Self::Purple => PURPLE,
            Self::Orange => ORANGE,
            Self::Sky => SKY,
            Self::Yellow => YELLOW,
            Self::Ink => INK,
            Self::Grey => GREY,
        }
    }
}

/// The colour variables of all charts, `--tr-blue:#0072b2;…`, for the light or the dark page.
pub(crate) fn variables(dark: bool) -> String {
    PAINTS.iter().fold(String::new(), |mut css, p| {
        let _ = write!(css, "--{}:{};", p.class, if dark { p.dark } else { p.light });
        css
    })
}

/// The rules that let the variables override the literal colours of the pictures.
pub(crate) fn rules() -> String {
    PAINTS.iter().fold(String::new(), |mut css, p| {
        let _ = write!(css, ".{0}{{color:var(--{0})}}", p.class);
        css
    })
}

/// The pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// ────
    Solid,
    /// ─ ─ ─
    Dashed,
    /// · · ·
    Dotted,
    /// ─ · ─
    DashDot,
    /// ── ──
    LongDash,
}

impl Dash {
    /// The SVG attribute, empty for a solid line.
    pub(crate) const fn attribute(self) -> &'static str {
        match self {
            Self::Solid => "",
            Self::Dashed => " stroke-dasharray=\"6 4\"",
            Self::Dotted => " stroke-dasharray=\"1.5 3.5\"",
            Self::DashDot => " stroke-dasharray=\"8 3 1.5 3\"",
            Self::LongDash => " stroke-dasharray=\"12 4\"",
        }
    }
}

/// The shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A filled circle.
    Circle,
    /// A filled square.
    Square,
    /// A filled triangle, tip up.
    Triangle,
    /// A filled diamond.
    Diamond,
    /// ×
    Cross,
    /// +
    Plus,
}

impl Marker {
    /// True when the shape is filled rather than stroked.
    pub(crate) const fn filled(self) -> bool {
        !matches!(self, Self::Cross | Self::Plus)
    }

    /// Appends the shape at (`x`, `y`) to a path, `r` pixels from its centre to its rim.
    pub(crate) fn append(self, d: &mut String, x: f64, y: f64, r: f64) {
        use super::px::Px;
        let [x, y, side, tip] = [x, y, 1.8 * r, 1.3 * r].map(Px);
        let [half, wide, r2, low] = [0.9 * r, 2.4 * r, 2.0 * r, 2.1 * r].map(Px);
        let (base, cross, long) = (Px(1.2 * r), Px(1.94 * r), Px(2.4 * r));
        let (arm, reach, r) = (Px(0.97 * r), Px(1.2 * r), Px(r));
        let _ = match self {
            Self::Circle => write!(d, "M{x} {y}m-{r} 0a{r} {r} 0 1 0 {r2} 0a{r} {r} 0 1 0-{r2} 0z"),
            Self::Square => write!(d, "M{x} {y}m-{half}-{half}h{side}v{side}h-{side}z"),
            Self::Triangle => write!(d, "M{x} {y}m0-{tip}l{base} {low}h-{wide}z"),
            Self::Diamond => write!(d, "M{x} {y}m0-{tip}l{tip} {tip}l-{tip} {tip}l-{tip}-{tip}z"),
            Self::Cross => write!(d, "M{x} {y}m-{arm}-{arm}l{cross} {cross}m0-{cross}l-{cross} {cross}"),
            Self::Plus => write!(d, "M{x} {y}m-{reach} 0h{long}m-{reach}-{reach}v{long}"),
        };
    }
}

/// The hatch of an area.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hatch {
    /// Filled without a hatch.
    Solid,
    /// Lines rising to the right.
    Slash,
    /// Lines falling to the right.
    Backslash,
    /// Lines rising and falling.
    Crosshatch,
    /// Horizontal lines.
    Horizontal,
    /// Vertical lines.
    Vertical,
}

/// Colour, dash, marker and hatch of one series.
///
/// # Examples
/// ```
/// use toolroom_chart::{Colour, Style};
/// assert_eq!(Style::nth(0).colour, Colour::Blue);
/// assert_ne!(Style::nth(0).dash, Style::nth(1).dash);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// Colour of lines, points and areas.
    pub colour: Colour,
    /// Pattern of lines.
    pub dash: Dash,
    /// Shape of points.
    pub marker: Marker,
    /// Hatch of areas.
    pub hatch: Hatch,
}

impl Style {
    /// The `i`-th distinct style. Neighbours differ in every cue; the combination repeats after 30.
    #[must_use]
    pub const fn nth(i: usize) -> Self {
        const COLOURS: [Colour; 6] =
            [Colour::Blue, Colour::Vermillion, Colour::Green, Colour::Purple, Colour::Orange, Colour::Sky];
        const DASHES: [Dash; 5] = [Dash::Solid, Dash::Dashed, Dash::DashDot, Dash::Dotted, Dash::LongDash];
        const MARKERS: [Marker; 6] =
            [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Cross, Marker::Plus];
        const HATCHES: [Hatch; 6] =
            [Hatch::Solid, Hatch::Slash, Hatch::Backslash, Hatch::Vertical, Hatch::Crosshatch, Hatch::Horizontal];
        Self { colour: COLOURS[i % 6], dash: DASHES[i % 5], marker: MARKERS[i % 6], hatch: HATCHES[i % 6] }
    }

    /// Grey and solid: what is idle.
    pub const IDLE: Self = Self { colour: Colour::Grey, dash: Dash::Dotted, marker: Marker::Plus, hatch: Hatch::Solid };

    /// The same with another colour.
    #[must_use]
    pub const fn colour(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// The same with another dash.
    #[must_use]
    pub const fn dash(self, dash: Dash) -> Self {
        Self { dash, ..self }
    }

    /// The same with another marker.
    #[must_use]
    pub const fn marker(self, marker: Marker) -> Self {
        Self { marker, ..self }
    }

    /// The same with another hatch.
    #[must_use]
    pub const fn hatch(self, hatch: Hatch) -> Self {
        Self { hatch, ..self }
    }
}
