//! When an order is finished if nothing else is in the shop.

use super::{Shop, sampled};
use toolroom_scenario::{Interruption, Order, Part, ShiftCalendar, Work, WorkPer};

impl Shop<'_> {
    /// A due date that cannot be met even if nothing else is in the shop and every machine stands ready.
    pub(super) fn unreachable(&self, order: &Order) -> Option<String> {
        let finish = self.earliest(order);
        // Sums of times round differently than the simulation: a second is no delay.
        if finish <= order.due + 1.0 {
            return None;
        }
        let (due, finish) = (self.shown(order.due), self.shown(finish));
        Some(format!(
            "order {} cannot be finished before {finish}, and is due {due} (mean times, nothing else in the shop, no setups)",
            order.id
        ))
    }

    /// When an order is finished if nothing else is in the shop, s.
    fn earliest(&self, order: &Order) -> f64 {
        let part: &Part = &self.scenario.parts[order.part];
        let pieces = f64::from(order.pieces());
        let batch = f64::from(order.transfer.unwrap_or(order.pieces()).min(order.pieces()));
        let last = pieces - batch * ((pieces / batch).ceil() - 1.0);
        // Pieces of a routing that cuts are worked on one by one, on several machines at once.
        let one_by_one = part.operations.iter().any(|own| !matches!(own.work, Work::Plain(_)));
        // What was in the shop before the run begins now.
        let (mut begun, mut finished) = (order.release.max(0.0), order.release.max(0.0));
        for (number, operation) in part.operations.iter().enumerate() {
            let left = order.share_left(number);
            if left == 0.0 {
                continue;
            }
            let handling = self.need(order.part, number).handling;
            let batch_machine =
                operation.machines.iter().any(|machine| self.scenario.machines[*machine].batch.is_some());
            let once = batch_machine || operation.work_per != WorkPer::Part;
            let able = operation.machines.len() as f64;
            let together = if one_by_one { able } else { f64::from(order.split.unwrap_or(1)).min(able) };
            let after = |time: f64, pieces: f64| {
                // Rounding of a share makes no further piece.
                let pieces = (sampled(operation, pieces) / together - 1e-9).ceil();
                let ends = operation.machines.iter().map(|&machine| {
                    let calendar = self.scenario.machines[machine].calendar;
                    worked(
                        calendar.map(|index| &self.scenario.calendars[index]),
                        (time, matches!(operation.work, Work::Plain(_))),
                        pieces * handling
                            + if once { left } else { pieces } * self.alone_on(order.part, number, machine),
                    )
                });
                ends.fold(f64::INFINITY, f64::min)
            };
            // Of an operation that some have passed the next one may begin at once.
            let first = if left < 1.0 && batch < pieces { begun } else { after(begun, batch.min(left * pieces)) };
            finished = after(begun, left * pieces).max(after(finished, last.min(left * pieces)));
            begun = first;
        }
        finished
    }
}

/// When work of `need`, s, ends that begins at `time` or when the calendar works next, s; whether it goes at the pace of the
/// shift.
fn worked(calendar: Option<&ShiftCalendar>, (time, paced): (f64, bool), need: f64) -> f64 {
    let Some(calendar) = calendar else { return time + need };
    let (mut now, mut left) = (time, need);
    loop {
        if calendar.works_at(now) {
            let boundary = calendar.next_boundary(now);
            let end = boundary.map_or(f64::INFINITY, |boundary| boundary.time);
            let finishes = calendar.at_end == Interruption::Finish && !boundary.is_some_and(|boundary| boundary.pauses);
            let pace = if paced { calendar.paces.factor_at(now) } else { 1.0 };
            let change = calendar.paces.next_change(now).filter(|change| paced && *change < end);
            // What is finished at the end of a shift is never later than this.
            let over = if finishes { left / pace } else { calendar.finish_within };
            let until = change.unwrap_or(end);
            if left <= pace * (until - now) || change.is_none() && left / pace <= end - now + over {
                return now + left / pace;
            }
            left -= pace * (until - now);
            now = until;
        } else {
            match calendar.next_boundary(now) {
                Some(boundary) => now = boundary.time,
                None => return f64::INFINITY,
            }
        }
    }
}
