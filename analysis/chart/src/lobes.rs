//! Stability boundaries and the operating points about them.

use super::layer::{Form, Layer};
use super::style::{Colour, Dash, Marker, Style};

/// Margin below which a stable point is called close: the constants of a cut are rarely known
/// better (assumption).
const CLOSE: f64 = 0.1;

/// How an operating point stands to its boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PointStability {
    /// Stable with a margin of a tenth at least, or without any limit.
    Stable,
    /// Stable, by less.
    Close,
    /// Unstable.
    Unstable,
}

impl PointStability {
    /// All, the best first.
    pub const ALL: [Self; 3] = [Self::Stable, Self::Close, Self::Unstable];

    /// Of a point with `margin`, 1 − depth/limit, where there is a limit.
    ///
    /// # Examples
    /// ```
    /// use toolroom_chart::PointStability;
    /// assert_eq!(PointStability::from_stable(true, Some(0.05)), PointStability::Close);
    /// ```
    #[must_use]
    pub fn from_stable(stable: bool, margin: Option<f64>) -> Self {
        match (stable, margin) {
            (false, _) => Self::Unstable,
            (true, Some(margin)) if margin < CLOSE => Self::Close,
            (true, _) => Self::Stable,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Stable => "stable",
            Self::Close => "stable, margin below 10 %",
            Self::Unstable => "unstable",
        }
    }

    fn style(self) -> Style {
        let (colour, marker) = match self {
            Self::Stable => (Colour::Green, Marker::Circle),
            Self::Close => (Colour::Orange, Marker::Triangle),
            Self::Unstable => (Colour::Purple, Marker::Square),
        };
        Style::nth(0).colour(colour).marker(marker)
    }
}

/// Boundaries of stability in ink and operating points coloured by their margin, to be laid on a
/// [`Plot`](super::Plot) or a [`HeatMap`](super::HeatMap).
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Chart, Plot, PointStability, StabilityLobes};
/// let lobes = StabilityLobes::default()
///     .boundary("stability limit", [(1000.0, 0.5), (2000.0, 0.8)])
///     .point("", (1500.0, 0.9), PointStability::Unstable);
/// let plot = Plot::new("Lobes", Axis::linear("Speed", "rpm"), Axis::linear("Depth of cut", "mm")).lobes(&lobes);
/// assert_eq!(plot.data().rows().len(), 3);
/// ```
#[derive(Clone, Debug, Default)]
pub struct StabilityLobes {
    boundaries: Vec<Layer>,
    count: usize,
    groups: Vec<(String, [Points; 3])>,
}

/// Speed and depth of each.
type Points = Vec<(f64, f64)>;

impl StabilityLobes {
    /// Adds a boundary; where a depth is no number it has a gap. Each one has a dash of its own.
    #[must_use]
    pub fn boundary(mut self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDot];
        let style = Style::nth(0).colour(Colour::Ink).dash(DASHES[self.count % DASHES.len()]);
        self.count += 1;
        let points: Vec<_> = points.into_iter().collect();
        let mut label = label.into();
        // A single point is no line.
        for stretch in points.split(|(_, depth)| !depth.is_finite()).filter(|stretch| stretch.len() > 1) {
            let points = stretch.to_vec();
            self.boundaries.push(Layer::Points { label, points, form: Form::Line, style });
            // The first stretch carries the label.
            label = String::new();
        }
        self
    }

    /// Adds single places of a boundary.
    #[must_use]
    pub fn places(mut self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let points: Vec<_> = points.into_iter().collect();
        if !points.is_empty() {
            let style = Style::nth(0).colour(Colour::Ink).marker(Marker::Plus);
            self.boundaries.push(Layer::Points { label: label.into(), points, form: Form::Scatter, style });
        }
        self
    }

    /// Adds an operating point of a group. Named groups have a marker each and stand in the legend
    /// once, with the worst of their points.
    #[must_use]
    pub fn point(mut self, group: &str, at: (f64, f64), standing: PointStability) -> Self {
        let position = self.groups.iter().position(|(name, _)| name == group);
        let index = position.unwrap_or_else(|| {
            self.groups.push((group.to_owned(), Default::default()));
            self.groups.len() - 1
        });
        self.groups[index].1[standing as usize].push(at);
        self
    }

    /// The boundaries, then the points on top of them.
    pub(super) fn layers(&self) -> impl Iterator<Item = Layer> {
        let points = self.groups.iter().enumerate().flat_map(|(i, (name, standings))| {
            let mut shown: Vec<_> = PointStability::ALL.into_iter().zip(standings).collect();
            shown.retain(|(_, points)| !points.is_empty());
            let worst = shown.last().map(|(standing, _)| *standing);
            shown.into_iter().map(move |(standing, points)| {
                let (label, style) = match name.as_str() {
                    "" => (standing.label().to_owned(), standing.style()),
                    name => {
                        let label = format!("{name}: {}", standing.label());
                        let label = if Some(standing) == worst { label } else { String::new() };
                        (label, standing.style().marker(Style::nth(i).marker))
                    }
                };
                Layer::Points { label, points: points.clone(), form: Form::Scatter, style }
            })
        });
        self.boundaries.iter().cloned().chain(points)
    }
}
