//! The strings of an SVG document: escaping, coordinates, text and shapes.

use super::px::Px;
use super::style::{Colour, GRID, Hatch, INK, MUTED, PAPER, Paint};
use std::fmt::Write;

/// Width of every chart in its own coordinates, in pixels at 100 %.
pub(crate) const WIDTH: f64 = 800.0;
/// Font size of ticks, labels and legends.
pub(crate) const FONT: f64 = 12.0;

const FAMILY: &str = "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif";

/// Text made safe for an element or a double-quoted attribute, in HTML and in XML alike.
/// Characters that XML forbids become the replacement character.
///
/// # Examples
/// ```
/// use toolroom_chart::escape;
/// assert_eq!(escape("<b> & \"c\""), "&lt;b&gt; &amp; &quot;c&quot;");
/// ```
#[must_use]
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            // Directional overrides could make a label read differently from what it is.
            '\u{0}'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}' | '\u{202a}'..='\u{202e}' => {
                out.push('\u{fffd}');
            }
            '\u{2066}'..='\u{2069}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Width of a text in a generous sans serif (the widths of DejaVu Sans, wider than most), in pixels.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | 'I' | ' ' => 0.32,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.41,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '−' | '×' | '±' => 0.92,
        'A'..='Z' => 0.71,
        '\u{300}'..='\u{36f}' => 0.0,
        '\u{400}'..='\u{4ff}' => 0.7,
        '\u{2e80}'.. => 1.05,
        _ => 0.62,
    };
    text.chars().map(em).sum::<f64>() * size
}

/// The text cut with an ellipsis so that it fits `width` pixels.
pub(crate) fn fit(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut out = String::new();
    for c in text.chars() {
        out.push(c);
        if text_width(&out, size) + 0.9 * size > width {
            out.pop();
            break;
        }
    }
    out.truncate(out.trim_end().len());
    out.push('…');
    out
}

/// The text on at most two lines of `width` pixels, broken at a space where there is one.
pub(crate) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    if text_width(text, size) <= width {
        return vec![text.to_owned()];
    }
    let space = text.match_indices(' ').map(|(i, _)| i).rfind(|&i| text_width(&text[..i], size) <= width);
    match space {
        Some(i) if i > 0 => vec![text[..i].to_owned(), fit(text[i..].trim_start(), size, width)],
        _ => vec![fit(text, size, width)],
    }
}

/// Where a text is anchored.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A rectangle in pixels.
#[derive(Clone, Copy)]
pub(crate) struct Area {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Area {
    pub const fn new(left: f64, top: f64, right: f64, bottom: f64) -> Self {
        Self { left, top, right, bottom }
    }
    /// True when the two have a point in common; either may be a line.
    pub fn touches(&self, o: &Self) -> bool {
        self.left <= o.right && o.left <= self.right && self.top <= o.bottom && o.top <= self.bottom
    }
    pub fn width(&self) -> f64 {
        self.right - self.left
    }
    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }
}

/// An SVG document being written.
pub(crate) struct Canvas {
    body: String,
}

impl Canvas {
    pub fn new() -> Self {
        Self { body: String::new() }
    }

    /// The finished document.
    pub fn finish(self, title: &str, description: &str, height: f64) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"{ink}\" color=\"{black}\" viewBox=\"0 0 {WIDTH} {h}\" \
             role=\"img\" aria-label=\"{label}\" font-family=\"{FAMILY}\" font-size=\"{FONT}\" fill=\"currentColor\">\
             <title>{label}</title><desc>{desc}</desc>\
             <g class=\"{paper}\" color=\"{white}\"><path d=\"M0 0H{WIDTH}V{h}H0z\"/></g>{body}</svg>",
            ink = INK.class,
            black = INK.light,
            h = Px(height),
            label = escape(title),
            desc = escape(description),
            paper = PAPER.class,
            white = PAPER.light,
            body = self.body,
        )
    }

    /// Opens a group in which `currentColor` is the paint. Close it with [`Canvas::close`].
    pub fn open(&mut self, paint: Paint) {
        let _ = write!(self.body, "<g class=\"{}\" color=\"{}\">", paint.class, paint.light);
    }

    /// Opens a group with a hover text.
    pub fn open_hint(&mut self, paint: Paint, hint: &str) {
        self.open(paint);
        if !hint.is_empty() {
            let _ = write!(self.body, "<title>{}</title>", escape(hint));
        }
    }

    pub fn close(&mut self) {
        self.body.push_str("</g>");
    }

    /// Opens a window: what lies outside is cut off. A nested `svg` needs no identifier, so that
    /// many charts can share one page.
    pub fn open_window(&mut self, a: Area) {
        let [x, y, w, h] = [Px(a.left), Px(a.top), Px(a.width()), Px(a.height())];
        let _ = write!(
            self.body,
            "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\" overflow=\"hidden\">"
        );
    }

    pub fn close_window(&mut self) {
        self.body.push_str("</svg>");
    }

    /// A filled path in the current colour, or in a literal one.
    pub fn fill(&mut self, d: &str, opacity: f64, literal: Option<&str>) {
        if d.is_empty() {
            return;
        }
        let _ = write!(self.body, "<path d=\"{d}\"");
        if opacity < 1.0 {
            let _ = write!(self.body, " opacity=\"{}\"", Px(opacity));
        }
        if let Some(colour) = literal {
            let _ = write!(self.body, " fill=\"{colour}\" shape-rendering=\"crispEdges\"");
        }
        self.body.push_str("/>");
    }

    /// A stroked path in the current colour. `attributes` is markup, never user text.
    pub fn stroke(&mut self, d: &str, width: f64, attributes: &str) {
        if !d.is_empty() {
            let _ = write!(
                self.body,
                "<path d=\"{d}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"{}\"{attributes}/>",
                Px(width)
            );
        }
    }

    /// A filled rectangle with its hatch, in the current colour.
    pub fn hatched(&mut self, a: Area, hatch: Hatch) {
        if hatch == Hatch::Solid {
            self.fill(&rectangle(a), 1.0, None);
            return;
        }
        self.fill(&rectangle(a), 0.35, None);
        self.stroke(&hatch_lines(a, hatch), 1.5, "");
        if a.width() > 3.0 && a.height() > 3.0 {
            self.stroke(&rectangle(Area::new(a.left + 0.5, a.top + 0.5, a.right - 0.5, a.bottom - 0.5)), 1.0, "");
        }
    }

    /// A rectangle in a colour of its own.
    pub fn block(&mut self, a: Area, colour: Colour, hatch: Hatch, hint: &str) {
        self.open_hint(colour.paint(), hint);
        self.hatched(a, hatch);
        self.close();
    }

    /// Text in the ink of the page.
    pub fn text(&mut self, x: f64, y: f64, anchor: Anchor, text: &str) {
        self.write_text(x, y, anchor, text, "");
    }

    /// Text in muted ink.
    pub fn muted(&mut self, x: f64, y: f64, anchor: Anchor, text: &str) {
        self.open(MUTED);
        self.write_text(x, y, anchor, text, "");
        self.close();
    }

    /// Text with a halo of paper, readable on top of data.
    pub fn halo(&mut self, x: f64, y: f64, anchor: Anchor, text: &str) {
        // The halo is drawn as its own copy: `paint-order` would need a second colour per element.
        self.open(PAPER);
        self.write_text(
            x,
            y,
            anchor,
            text,
            " stroke=\"currentColor\" stroke-width=\"3\" stroke-linejoin=\"round\" aria-hidden=\"true\"",
        );
        self.close();
        self.write_text(x, y, anchor, text, "");
    }

    /// Text inside a block of a style, in whatever colour is readable there.
    pub fn inside(&mut self, x: f64, y: f64, text: &str, colour: Colour, hatch: Hatch) {
        match (colour, hatch) {
            (Colour::Blue | Colour::Ink, Hatch::Solid) => {
                self.open(PAPER);
                self.text(x, y, Anchor::Middle, text);
                self.close();
            }
            (Colour::Grey, Hatch::Solid) => self.text(x, y, Anchor::Middle, text),
            _ => self.halo(x, y, Anchor::Middle, text),
        }
    }

    pub fn heading(&mut self, x: f64, y: f64, text: &str) {
        self.write_text(x, y, Anchor::Start, text, " font-size=\"15\" font-weight=\"600\"");
    }

    /// Text that reads upwards, centred on (`x`, `y`).
    pub fn upright(&mut self, x: f64, y: f64, text: &str) {
        let turn = format!(" transform=\"rotate(-90 {} {})\"", Px(x), Px(y));
        self.write_text(x, y, Anchor::Middle, text, &turn);
    }

    fn write_text(&mut self, x: f64, y: f64, anchor: Anchor, text: &str, attributes: &str) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let _ = write!(self.body, "<text x=\"{}\" y=\"{}\"{anchor}{attributes}>{}</text>", Px(x), Px(y), escape(text));
    }

    /// A thin line of the grid.
    pub fn grid(&mut self, d: &str) {
        self.open(GRID);
        self.stroke(d, 1.0, "");
        self.close();
    }
}

/// The path of a rectangle.
pub(crate) fn rectangle(a: Area) -> String {
    format!("M{} {}H{}V{}H{}z", Px(a.left), Px(a.top), Px(a.right), Px(a.bottom), Px(a.left))
}

/// Lines of a hatch, already cut to the rectangle: no pattern element, hence no identifier.
fn hatch_lines(a: Area, hatch: Hatch) -> String {
    const STEP: f64 = 6.0;
    let mut d = String::new();
    if a.width() < 2.0 || a.height() < 2.0 || a.width() * a.height() > 1e6 {
        return d;
    }
    let segment = |d: &mut String, x1: f64, y1: f64, x2: f64, y2: f64| {
        let _ = write!(d, "M{} {}L{} {}", Px(x1), Px(y1), Px(x2), Px(y2));
    };
    let horizontal = |d: &mut String| {
        let mut y = a.top + STEP / 2.0;
        while y < a.bottom {
            segment(d, a.left, y, a.right, y);
            y += STEP;
        }
    };
    // Diagonals x + y = c (slash) or x - y = c (backslash), phase fixed to the picture so that
    // neighbouring rectangles continue each other.
    let diagonal = |d: &mut String, sign: f64| {
        let corners =
            [a.left + sign * a.top, a.left + sign * a.bottom, a.right + sign * a.top, a.right + sign * a.bottom];
        let lowest = corners.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut c = (lowest / STEP).ceil() * STEP;
        while c < highest {
            let y_at = |x: f64| (c - x) / sign;
            let (mut x1, mut x2) = (a.left, a.right);
            let bounds = [c - sign * a.top, c - sign * a.bottom];
            x1 = x1.max(bounds[0].min(bounds[1]));
            x2 = x2.min(bounds[0].max(bounds[1]));
            if x2 > x1 {
                segment(d, x1, y_at(x1), x2, y_at(x2));
            }
            c += STEP;
        }
    };
    match hatch {
        Hatch::Solid => {}
        Hatch::Slash => diagonal(&mut d, 1.0),
        Hatch::Backslash => diagonal(&mut d, -1.0),
        Hatch::Crosshatch => {
            diagonal(&mut d, 1.0);
            diagonal(&mut d, -1.0);
        }
        Hatch::Horizontal => horizontal(&mut d),
        Hatch::Vertical => {
            let mut x = (a.left / STEP).ceil() * STEP;
            while x < a.right {
                segment(&mut d, x, a.top, x, a.bottom);
                x += STEP;
            }
        }
    }
    d
}
