//! Ends of elements that are meant to be one point.

use super::JOIN;
use super::elements::Element;
use crate::Point;

/// Makes neighbours of a chain meet whose ends lie apart by less than the drawing's tolerance: a line goes on to the end of the arc
/// beside it, lines and arcs among themselves meet halfway. The centre of an arc stays as near as its ends allow.
pub(super) fn close_gaps(chain: &mut [Element], is_closed: bool) {
    let count = chain.len();
    let ends = if is_closed && count > 1 { count } else { count.saturating_sub(1) };
    for index in 0..ends {
        let next = (index + 1) % count;
        let (before, after) = (chain[index], chain[next]);
        if before.end.distance(after.start) < JOIN {
            continue;
        }
        let halfway = Point { x: 0.5 * (before.end.x + after.start.x), y: 0.5 * (before.end.y + after.start.y) };
        let meet = match (before.arc, after.arc) {
            (None, Some(_)) => after.start,
            (Some(_), None) => before.end,
            (None, None) | (Some(_), Some(_)) => halfway,
        };
        chain[index] = moved(before, before.start, meet);
        chain[next] = moved(after, meet, after.end);
    }
}

/// An element between other ends.
fn moved(element: Element, start: Point, end: Point) -> Element {
    if element.start == start && element.end == end {
        return element;
    }
    let arc = element.arc.map(|(centre, left)| {
        // The point between both ends that is nearest to the old centre: it moves by no more than the ends do.
        let middle = Point { x: 0.5 * (start.x + end.x), y: 0.5 * (start.y + end.y) };
        let (sin, cos) = start.heading_to(end).sin_cos();
        let away = (centre.y - middle.y) * cos - (centre.x - middle.x) * sin;
        (Point { x: middle.x - away * sin, y: middle.y + away * cos }, left)
    });
    Element { start, end, arc, ..element }
}
