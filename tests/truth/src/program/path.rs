//! A reading of the three programs: millimetres, absolute but for the way home, arcs in the plane.

use std::f64::consts::TAU;

/// A motion of the tool.
pub(super) struct Move {
    pub way: f64,
    /// mm/s; of no meaning in rapid motion.
    pub feed: f64,
    pub rapid: bool,
    pub enters: [f64; 3],
    pub leaves: [f64; 3],
}

impl Move {
    pub fn speed(&self, rapid: f64) -> f64 {
        if self.rapid { rapid } else { self.feed }
    }
}

/// A line of a program.
pub(super) struct Line {
    /// In the file, from 1.
    pub number: usize,
    pub moves: Vec<Move>,
    pub dwell: f64,
    /// M codes: the axes rest.
    pub stops: bool,
    pub change: bool,
    pub holes: u32,
    pub tool: u32,
    pub characters: usize,
}

fn words(text: &str) -> Vec<(char, f64)> {
    let mut list: Vec<(char, String)> = Vec::new();
    for sign in text.split('(').next().unwrap_or_default().chars().filter(|sign| !sign.is_whitespace()) {
        if sign.is_ascii_alphabetic() {
            list.push((sign, String::new()));
        } else if let Some((_, number)) = list.last_mut() {
            number.push(sign);
        }
    }
    list.into_iter().filter_map(|(letter, number)| Some((letter, number.parse().ok()?))).collect()
}

/// Lines that say something to the machine.
pub(super) fn read(text: &str) -> Vec<Line> {
    let mut position: [Option<f64>; 3] = [None; 3];
    let (mut mode, mut feed, mut tool) = (0, 0.0, 0);
    let (mut bottom, mut level, mut peck, mut wait) = (0.0, 0.0, f64::INFINITY, 0.0);
    let mut to_initial = true;
    let mut lines = Vec::new();
    for (index, text) in text.lines().enumerate() {
        let list: Vec<(char, f64)> =
            words(text).into_iter().filter(|(letter, _)| !matches!(letter, 'N' | 'O')).collect();
        if list.is_empty() {
            continue;
        }
        let value = |wanted: char| list.iter().find(|(letter, _)| *letter == wanted).map(|(_, value)| *value);
        let g = |wanted: f64| list.iter().any(|(letter, value)| *letter == 'G' && *value == wanted);
        let m = list.iter().any(|(letter, _)| *letter == 'M');
        let change = list.contains(&('M', 6.0));
        for (letter, value) in &list {
            match (*letter, *value as i64) {
                ('G', code @ (0..=3 | 81..=85)) => mode = code,
                ('G', 80) => mode = 0,
                ('G', 98) => to_initial = true,
                ('G', 99) => to_initial = false,
                ('T', number) => tool = number as u32,
                ('F', _) => feed = *value / 60.0,
                ('R', _) => level = *value,
                ('Q', _) => peck = *value,
                ('P', _) => wait = *value / 1e3,
                ('Z', _) if mode > 80 => bottom = *value,
                _ => {}
            }
        }
        if g(81.0) || g(82.0) || g(84.0) {
            peck = f64::INFINITY;
        }
        let mut line = Line {
            number: index + 1,
            moves: Vec::new(),
            dwell: 0.0,
            stops: m,
            change,
            holes: 0,
            tool,
            characters: text.len(),
        };
        if g(28.0) {
            position[2] = None;
        } else if mode > 80 {
            if value('X').is_some() || value('Y').is_some() {
                bore(
                    &mut line,
                    &mut position,
                    [value('X'), value('Y')],
                    (bottom, level, peck),
                    (mode, feed, to_initial),
                );
                line.dwell = if mode == 82 { wait } else { 0.0 };
                line.holes = 1;
            }
        } else {
            let to = [value('X'), value('Y'), value('Z')];
            if let Some(travelled) = travel(&mut position, to, [value('I'), value('J')], mode, feed) {
                line.moves.push(travelled);
            }
        }
        lines.push(line);
    }
    lines
}

fn straight(start: [f64; 3], end: [f64; 3], rapid: bool, feed: f64) -> Option<Move> {
    let span = [end[0] - start[0], end[1] - start[1], end[2] - start[2]];
    let length = (span[0] * span[0] + span[1] * span[1] + span[2] * span[2]).sqrt();
    let direction = span.map(|part| part / length);
    let longest = span.iter().fold(0.0_f64, |longest, part| longest.max(part.abs()));
    let way = if rapid { longest } else { length };
    (length > 0.0).then_some(Move { way, feed, rapid, enters: direction, leaves: direction })
}

fn travel(
    position: &mut [Option<f64>; 3],
    to: [Option<f64>; 3],
    center: [Option<f64>; 2],
    mode: i64,
    feed: f64,
) -> Option<Move> {
    let from: [f64; 3] = std::array::from_fn(|axis| position[axis].or(to[axis]).unwrap_or(0.0));
    let end: [f64; 3] = std::array::from_fn(|axis| to[axis].or(position[axis]).unwrap_or(0.0));
    for axis in 0..3 {
        position[axis] = to[axis].or(position[axis]);
    }
    if mode < 2 {
        return straight(from, end, mode == 0, feed);
    }
    let middle = [from[0] + center[0].unwrap_or(0.0), from[1] + center[1].unwrap_or(0.0)];
    let (a, b) = ([from[0] - middle[0], from[1] - middle[1]], [end[0] - middle[0], end[1] - middle[1]]);
    let sign = if mode == 3 { 1.0 } else { -1.0 };
    let turn = (sign * (b[1].atan2(b[0]) - a[1].atan2(a[0]))).rem_euclid(TAU);
    let radius = a[0].hypot(a[1]);
    let tangent = |arm: [f64; 2]| [-sign * arm[1] / radius, sign * arm[0] / radius, 0.0];
    Some(Move { way: radius * turn, feed, rapid: false, enters: tangent(a), leaves: tangent(b) })
}

/// Distance above the last depth at which a control begins the next peck at feed, mm: a common setting (assumption).
const PECK_CLEARANCE: f64 = 1.0;

fn bore(
    line: &mut Line,
    position: &mut [Option<f64>; 3],
    place: [Option<f64>; 2],
    (bottom, level, peck): (f64, f64, f64),
    (mode, feed, to_initial): (i64, f64, bool),
) {
    let mut here: [f64; 3] = position.map(|value| value.unwrap_or(0.0));
    let initial = here[2];
    let over = [place[0].unwrap_or(here[0]), place[1].unwrap_or(here[1]), here[2]];
    let mut go = |to: [f64; 3], rapid: bool| {
        line.moves.extend(straight(here, to, rapid, feed));
        here = to;
    };
    go(over, true);
    let height = |z: f64| [over[0], over[1], z];
    go(height(level), true);
    let mut depth = level;
    while depth > bottom {
        go(height((depth + PECK_CLEARANCE).min(level)), true);
        depth = (depth - peck).max(bottom);
        go(height(depth), false);
        // A tap leaves as it came.
        go(height(level), mode != 84);
    }
    if to_initial {
        go(height(initial.max(level)), true);
    }
    *position = here.map(Some);
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn ways_and_holes_are_read() {
        let lines = read(
            "(START)\nT1 M6\nG0 X0 Y0 Z10.\nG1 Z0. F600.\nX30. Y40.\nG3 X30. Y60. I0. J10.\nG0 Z10.\nG98 G83 Z-4. R2. Q3. F60. X0. Y0.\nG80\nM30\n",
        );
        let ways: Vec<f64> = lines.iter().map(|line| line.moves.iter().map(|own| own.way).sum()).collect();
        assert!((ways[2] - 10.0).abs() < 1e-9 && (ways[3] - 50.0).abs() < 1e-9, "{ways:?}");
        assert!((ways[4] - 10.0 * std::f64::consts::PI).abs() < 1e-9);
        // Over, to R, down 3 and out, back to 1 above, down 4 and out, up.
        let hole = &lines[6];
        let feed: f64 = hole.moves.iter().filter(|own| !own.rapid).map(|own| own.way).sum();
        assert!((feed - 7.0).abs() < 1e-9 && hole.holes == 1, "{feed}");
        assert!(lines[0].change && lines[8].stops && lines[7].moves.is_empty());
    }
}
