//! The icon: a drawing, and the same as pixels.

use crate::description::Description;

/// Edge length of the pixel picture.
const SIZE: usize = 128;

/// What an icon shows, on a grid of 128 × 128: filled circles and quadrangles in their colours.
struct Shape {
    colour: [u8; 3],
    kind: Kind,
}

enum Kind {
    Circle { x: f64, y: f64, radius: f64 },
    Polygon(&'static [(f64, f64)]),
}

const fn circle(colour: [u8; 3], x: f64, y: f64, radius: f64) -> Shape {
    Shape { colour, kind: Kind::Circle { x, y, radius } }
}

const fn polygon(colour: [u8; 3], corners: &'static [(f64, f64)]) -> Shape {
    Shape { colour, kind: Kind::Polygon(corners) }
}

const WORK: [u8; 3] = [0x8a, 0x97, 0xa6];
const LIGHT: [u8; 3] = [0xd5, 0xdb, 0xe2];
const TOOL: [u8; 3] = [0xd5, 0x5e, 0x00];
const EDGE: [u8; 3] = [0x1b, 0x1f, 0x24];

/// A bar and an insert.
const TURNING: &[Shape] = &[
    circle(WORK, 52.0, 52.0, 44.0),
    circle(LIGHT, 52.0, 52.0, 34.0),
    circle(EDGE, 52.0, 52.0, 4.0),
    polygon(TOOL, &[(86.0, 62.0), (122.0, 74.0), (108.0, 112.0), (74.0, 98.0)]),
];

/// A cutter with four teeth in a wall.
const MILLING: &[Shape] = &[
    polygon(WORK, &[(4.0, 72.0), (124.0, 72.0), (124.0, 124.0), (4.0, 124.0)]),
    circle(LIGHT, 56.0, 54.0, 34.0),
    polygon(TOOL, &[(56.0, 8.0), (72.0, 24.0), (56.0, 30.0), (44.0, 20.0)]),
    polygon(TOOL, &[(102.0, 54.0), (86.0, 70.0), (80.0, 54.0), (90.0, 42.0)]),
    polygon(TOOL, &[(56.0, 100.0), (40.0, 84.0), (56.0, 78.0), (68.0, 88.0)]),
    polygon(TOOL, &[(10.0, 54.0), (26.0, 38.0), (32.0, 54.0), (22.0, 66.0)]),
    circle(EDGE, 56.0, 54.0, 4.0),
];

/// A wheel on a part.
const GRINDING: &[Shape] = &[
    circle(TOOL, 46.0, 56.0, 42.0),
    circle(LIGHT, 46.0, 56.0, 12.0),
    circle(WORK, 104.0, 72.0, 20.0),
    circle(EDGE, 104.0, 72.0, 4.0),
    circle(EDGE, 46.0, 56.0, 4.0),
];

fn shapes(description: &Description) -> &'static [Shape] {
    match description.identifier {
        "toolroom_turning" => TURNING,
        "toolroom_milling" => MILLING,
        _ => GRINDING,
    }
}

/// The drawing as SVG.
pub(super) fn svg(description: &Description) -> String {
    let mut text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIZE} {SIZE}\">\n");
    for Shape { colour: [r, g, b], kind } in shapes(description) {
        let fill = format!("fill=\"#{r:02x}{g:02x}{b:02x}\"");
        let element = match kind {
            Kind::Circle { x, y, radius } => format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {fill}/>\n"),
            Kind::Polygon(corners) => {
                let points: Vec<String> = corners.iter().map(|(x, y)| format!("{x},{y}")).collect();
                format!("<polygon points=\"{}\" {fill}/>\n", points.join(" "))
            }
        };
        text.push_str(&element);
    }
    text + "</svg>\n"
}

impl Kind {
    fn covers(&self, px: f64, py: f64) -> bool {
        match self {
            Self::Circle { x, y, radius } => (px - x).hypot(py - y) <= *radius,
            // Even-odd rule.
            Self::Polygon(corners) => {
                let next = corners.iter().cycle().skip(1);
                let crossed = corners.iter().zip(next).filter(|((x1, y1), (x2, y2))| {
                    (*y1 > py) != (*y2 > py) && px < (x2 - x1) * (py - y1) / (y2 - y1) + x1
                });
                crossed.count() % 2 == 1
            }
        }
    }
}

/// The drawing as PNG with transparent ground: stored blocks, no compression.
pub(super) fn png(description: &Description) -> Vec<u8> {
    let mut rows = Vec::with_capacity(SIZE * (4 * SIZE + 1));
    for y in 0..SIZE {
        rows.push(0); // no filter
        for x in 0..SIZE {
            let centre = (x as f64 + 0.5, y as f64 + 0.5);
            let top = shapes(description).iter().rev().find(|shape| shape.kind.covers(centre.0, centre.1));
            rows.extend(top.map_or([0; 4], |Shape { colour: [r, g, b], .. }| [*r, *g, *b, 255]));
        }
    }
    let mut image = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |name: &[u8; 4], content: &[u8]| {
        image.extend((content.len() as u32).to_be_bytes());
        let start = image.len();
        image.extend(name);
        image.extend(content);
        let check = crc32fast::hash(&image[start..]);
        image.extend(check.to_be_bytes());
    };
    let side = (SIZE as u32).to_be_bytes();
    chunk(b"IHDR", &[&side[..], &side[..], &[8, 6, 0, 0, 0]].concat());
    chunk(b"IDAT", &stored(&rows));
    chunk(b"IEND", &[]);
    image
}

/// A zlib stream of stored blocks.
fn stored(content: &[u8]) -> Vec<u8> {
    let mut stream = vec![0x78, 0x01];
    let blocks: Vec<&[u8]> = content.chunks(0xffff).collect();
    for (i, block) in blocks.iter().enumerate() {
        stream.push(u8::from(i + 1 == blocks.len()));
        let length = block.len() as u16;
        stream.extend(length.to_le_bytes());
        stream.extend((!length).to_le_bytes());
        stream.extend(*block);
    }
    let (a, b) = content
        .iter()
        .fold((1u32, 0u32), |(a, b), byte| ((a + u32::from(*byte)) % 65521, (b + a + u32::from(*byte)) % 65521));
    stream.extend((b << 16 | a).to_be_bytes());
    stream
}
