//! Charts as PNG: the few elements of which a chart's SVG consists, drawn into pixels.
//!
//! Letters come with the program, so that a picture has the same bytes on every machine, also on
//! one without fonts.

use super::Chart;
use super::svg::{FONT, WIDTH};
use roxmltree::{Document, Node};
use std::fmt::Write as _;
use std::io::Write as _;
use std::str::FromStr;
use ttf_parser::{Face, GlyphId, OutlineBuilder};
use zeno::{Cap, Join, Mask, Stroke, Style, Transform};

/// Latin, Greek, Cyrillic and the signs of charts.
const LETTERS: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");

/// The picture of a chart as PNG, `width` pixels wide (80 to 8000) on white paper.
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Plot, Style, png};
/// let plot = Plot::new("Wear", Axis::linear("Time", "min"), Axis::linear("Flank wear VB", "mm"))
///     .line("median", [(0.0, 0.0), (9.0, 0.3)], Style::nth(0));
/// assert_eq!(png(&plot, 800)[16..20], 800_u32.to_be_bytes());
/// ```
#[must_use]
pub fn png(chart: &dyn Chart, width: u32) -> Vec<u8> {
    let svg = chart.svg();
    let document = Document::parse(&svg).expect("a chart is well-formed");
    let height = numbers(document.root_element().attribute("viewBox").unwrap_or_default()).nth(3).unwrap_or(WIDTH);
    let scale = width.clamp(80, 8000) as f32 / WIDTH as f32;
    let mut paper = Paper::new(scale, height as f32);
    let face = Face::parse(LETTERS, 0).expect("the font is part of the program");
    let whole = [0, 0, paper.width as i32, paper.height as i32];
    let pen = Pen { colour: [0; 3], clip: whole, face: &face };
    paper.draw(document.root_element(), &pen);
    paper.encode()
}

/// What an element inherits.
#[derive(Clone, Copy)]
struct Pen<'a> {
    /// `currentColor`.
    colour: [u8; 3],
    /// Left, top, right and bottom pixel of the window.
    clip: [i32; 4],
    face: &'a Face<'a>,
}

struct Paper {
    scale: f32,
    width: u32,
    height: u32,
    /// Red, green and blue, row by row.
    pixels: Vec<u8>,
}

/// How an area is laid on the paper.
struct Coat {
    colour: [u8; 3],
    opacity: f32,
    /// Pixels are covered or not, so that neighbours meet without a seam.
    crisp: bool,
}

impl Paper {
    fn new(scale: f32, height: f32) -> Self {
        let [width, height] = [WIDTH as f32, height].map(|length| (length * scale).ceil() as u32);
        Self { scale, width, height, pixels: vec![255; (3 * width * height) as usize] }
    }

    fn draw(&mut self, node: Node<'_, '_>, inherited: &Pen<'_>) {
        let mut pen = *inherited;
        if let Some(colour) = node.attribute("color").and_then(colour) {
            pen.colour = colour;
        }
        match node.tag_name().name() {
            "path" => return self.path(node, &pen),
            "text" => return self.text(node, &pen),
            "title" | "desc" => return,
            "svg" if node.has_attribute("x") => {
                let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| number(node, name, 0.0));
                let window = [x, y, x + w, y + h].map(|edge| (edge * self.scale).round() as i32);
                let [left, top, right, bottom] = pen.clip;
                pen.clip = [window[0].max(left), window[1].max(top), window[2].min(right), window[3].min(bottom)];
            }
            _ => {}
        }
        for child in node.children().filter(Node::is_element) {
            self.draw(child, &pen);
        }
    }

    fn path(&mut self, node: Node<'_, '_>, pen: &Pen<'_>) {
        let d = node.attribute("d").unwrap_or_default();
        let coat = |colour| Coat {
            colour,
            opacity: number(node, "opacity", 1.0),
            crisp: node.attribute("shape-rendering") == Some("crispEdges"),
        };
        match node.attribute("fill") {
            Some("none") => {}
            literal => self.fill(d, None, &coat(literal.and_then(colour).unwrap_or(pen.colour)), pen),
        }
        if node.has_attribute("stroke") {
            let dashes: Vec<f32> =
                numbers(node.attribute("stroke-dasharray").unwrap_or_default()).map(|dash| dash as f32).collect();
            let round = node.attribute("stroke-linejoin") == Some("round");
            let line = Line { width: number(node, "stroke-width", 1.0), dashes: &dashes, round };
            self.stroke(d, None, &line, &coat(pen.colour), pen);
        }
    }

    fn text(&mut self, node: Node<'_, '_>, pen: &Pen<'_>) {
        let size = number(node, "font-size", FONT as f32);
        let outline = outline(node.text().unwrap_or_default(), node.attribute("text-anchor"), pen.face, size);
        let (x, y) = (number(node, "x", 0.0), number(node, "y", 0.0));
        let turned = node.attribute("transform").is_some_and(|text| text.starts_with("rotate(-90"));
        let turn = zeno::Angle::from_degrees(if turned { -90.0 } else { 0.0 });
        let place = Transform::rotation(turn).then_translate(x, y);
        let coat = Coat { colour: pen.colour, opacity: 1.0, crisp: false };
        // A heavy weight is the one weight there is, with a rim.
        let rim = if node.has_attribute("font-weight") { 0.04 * size } else { 0.0 };
        let width = if node.has_attribute("stroke") { number(node, "stroke-width", 1.0) } else { rim };
        if width > 0.0 {
            self.stroke(&outline, Some(place), &Line { width, dashes: &[], round: true }, &coat, pen);
        }
        self.fill(&outline, Some(place), &coat, pen);
    }

    fn fill(&mut self, d: &str, place: Option<Transform>, coat: &Coat, pen: &Pen<'_>) {
        self.lay(d, place, Style::Fill(zeno::Fill::NonZero), coat, pen);
    }

    fn stroke(&mut self, d: &str, place: Option<Transform>, line: &Line<'_>, coat: &Coat, pen: &Pen<'_>) {
        let mut stroke = Stroke::new(line.width);
        stroke.cap(Cap::Butt).join(if line.round { Join::Round } else { Join::Miter });
        if !line.dashes.is_empty() {
            stroke.dash(line.dashes, 0.0);
        }
        self.lay(d, place, Style::Stroke(stroke), coat, pen);
    }

    /// Lays a coat over what the style makes of a path.
    fn lay(&mut self, d: &str, place: Option<Transform>, style: Style<'_>, coat: &Coat, pen: &Pen<'_>) {
        let scale = Transform::scale(self.scale, self.scale);
        let whole = place.map_or(scale, |place| place.then(&scale));
        // Only what shows is worked out: a line may leave its window by a million pixels.
        let bounds = zeno::bounds(d, style, Some(whole));
        let [left, top, right, bottom] = pen.clip;
        let (left, right) = (left.max(bounds.min.x.floor() as i32), right.min(bounds.max.x.ceil() as i32));
        let (top, bottom) = (top.max(bounds.min.y.floor() as i32), bottom.min(bounds.max.y.ceil() as i32));
        if left >= right || top >= bottom {
            return;
        }
        let (width, height) = ((right - left) as u32, (bottom - top) as u32);
        let mut mask = Mask::new(d);
        mask.style(style).transform(Some(whole)).offset((-left as f32, -top as f32)).size(width, height);
        for (row, covers) in mask.render().0.chunks_exact(width as usize).enumerate() {
            for (column, cover) in covers.iter().enumerate().filter(|(_, cover)| **cover != 0) {
                let (x, y) = (left as usize + column, top as usize + row);
                // Where four cells meet, each covers a quarter of the pixel.
                let cover = if coat.crisp { f32::from(u8::from(*cover > 63)) } else { f32::from(*cover) / 255.0 };
                let start = 3 * (y * self.width as usize + x);
                for (pixel, colour) in self.pixels[start..start + 3].iter_mut().zip(coat.colour) {
                    let (below, above) = (f32::from(*pixel), f32::from(colour));
                    *pixel = (below + cover * coat.opacity * (above - below)).round() as u8;
                }
            }
        }
    }

    /// PNG of eight bits a channel, without filters.
    fn encode(&self) -> Vec<u8> {
        let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        let rows = self.pixels.chunks_exact(3 * self.width as usize);
        let written = rows.into_iter().try_for_each(|row| packed.write_all(&[0]).and_then(|()| packed.write_all(row)));
        let packed = written.and_then(|()| packed.finish()).expect("memory takes what is written");
        let mut header = [self.width.to_be_bytes(), self.height.to_be_bytes()].concat();
        // Bits a channel, colour without alpha; the only methods of packing, filtering, interlacing.
        header.extend([8, 2, 0, 0, 0]);
        let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
        for (kind, data) in [(b"IHDR", header), (b"IDAT", packed), (b"IEND", Vec::new())] {
            out.extend((data.len() as u32).to_be_bytes());
            let start = out.len();
            out.extend(kind);
            out.extend(data);
            let check = crc32fast::hash(&out[start..]);
            out.extend(check.to_be_bytes());
        }
        out
    }
}

/// How a path is stroked.
struct Line<'a> {
    width: f32,
    dashes: &'a [f32],
    round: bool,
}

/// The outline of a line of text anchored at the origin, as path data.
fn outline(text: &str, anchor: Option<&str>, face: &Face<'_>, size: f32) -> String {
    let scale = size / f32::from(face.units_per_em());
    let glyph = |c| face.glyph_index(c).or_else(|| face.glyph_index('\u{fffd}')).unwrap_or_default();
    let glyphs: Vec<_> = text.chars().map(glyph).collect();
    let advance = |glyph: &GlyphId| scale * f32::from(face.glyph_hor_advance(*glyph).unwrap_or(0));
    let length: f32 = glyphs.iter().map(advance).sum();
    let start = match anchor {
        Some("middle") => -0.5 * length,
        Some("end") => -length,
        _ => 0.0,
    };
    let mut pen = Outline { d: String::new(), x: start, scale };
    for glyph in &glyphs {
        face.outline_glyph(*glyph, &mut pen);
        pen.x += advance(glyph);
    }
    pen.d
}

/// Path data of glyphs, whose axis points up.
struct Outline {
    d: String,
    x: f32,
    scale: f32,
}

impl Outline {
    fn add<const N: usize>(&mut self, command: char, points: [(f32, f32); N]) {
        self.d.push(command);
        for (x, y) in points {
            let _ = write!(self.d, "{} {} ", self.x + self.scale * x, -self.scale * y);
        }
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.add('M', [(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.add('L', [(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.add('Q', [(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.add('C', [(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.d.push('Z');
    }
}

/// `#rrggbb`.
fn colour(text: &str) -> Option<[u8; 3]> {
    let value = u32::from_str_radix(text.strip_prefix('#')?, 16).ok()?;
    let [_, red, green, blue] = value.to_be_bytes();
    Some([red, green, blue])
}

fn number(node: Node<'_, '_>, name: &str, otherwise: f32) -> f32 {
    node.attribute(name).and_then(|text| f32::from_str(text).ok()).unwrap_or(otherwise)
}

fn numbers(text: &str) -> impl Iterator<Item = f64> {
    text.split_whitespace().filter_map(|word| word.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Colour, Plot, Style as Look};

    /// Pixels of a PNG, after its checks.
    fn decoded(png: &[u8]) -> (usize, Vec<u8>) {
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        let word = |at: usize| u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]);
        let (width, length) = (word(16) as usize, word(33) as usize);
        assert_eq!(crc32fast::hash(&png[37..41 + length]), word(41 + length));
        let mut pixels = Vec::new();
        let mut unpacked = flate2::write::ZlibDecoder::new(&mut pixels);
        unpacked.write_all(&png[41..41 + length]).expect("a zlib stream");
        unpacked.finish().expect("a whole stream");
        (width, pixels.chunks_exact(3 * width + 1).flat_map(|row| row[1..].to_vec()).collect())
    }

    fn plot(title: &str) -> Plot {
        let points = [(0.0, 0.0), (1.0, 1.0)];
        Plot::new(title, Axis::linear("", ""), Axis::linear("", "")).line(
            "",
            points,
            Look::nth(0).colour(Colour::Green),
        )
    }

    /// Pixels of the title that are not white.
    fn title_ink(title: &str) -> usize {
        let (width, pixels) = decoded(&png(&plot(title), 800));
        pixels[..3 * 32 * width].chunks_exact(3).filter(|pixel| *pixel != [255; 3]).count()
    }

    #[test]
    fn letters_appear_without_any_font_of_the_system() {
        assert_eq!(title_ink(""), 0);
        let one = title_ink("Врезание");
        assert!(one > 200, "{one}");
        assert!((title_ink("Врезание Врезание") as f64 / one as f64 - 2.0).abs() < 0.1);
    }

    #[test]
    fn a_line_has_the_colour_of_its_style() {
        let (_, pixels) = decoded(&png(&plot("t"), 1600));
        let green = pixels.chunks_exact(3).filter(|pixel| *pixel == [0x00, 0x9e, 0x73]).count();
        assert!(green > 1000, "{green}");
    }

    #[test]
    fn what_lies_outside_the_plot_is_cut_off() {
        let steep = Plot::new("t", Axis::linear("x", ""), Axis::linear("y", "").range(0.0, 1.0)).line(
            "",
            [(0.0, -9.0), (1.0, 9.0)],
            Look::nth(0).colour(Colour::Green),
        );
        let (width, pixels) = decoded(&png(&steep, 800));
        let green = |row: &[u8]| row.chunks_exact(3).any(|pixel| pixel == [0x00, 0x9e, 0x73]);
        let rows: Vec<bool> = pixels.chunks_exact(3 * width).map(green).collect();
        let (first, last) = (rows.iter().position(|hit| *hit), rows.iter().rposition(|hit| *hit));
        assert!(first > Some(20) && last < Some(rows.len() - 20), "{first:?} {last:?} of {}", rows.len());
    }

    #[test]
    fn the_same_chart_gives_the_same_bytes() {
        assert_eq!(png(&plot("t"), 800), png(&plot("t"), 800));
    }
}
