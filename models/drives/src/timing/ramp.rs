//! Changes of speed of an axis with limited acceleration and jerk.

/// How a drive changes its speed.
#[derive(Clone, Copy)]
pub(super) struct Ramp {
    /// m/s².
    pub acceleration: f64,
    /// s.
    pub jerk_time: f64,
}

/// Halvings of the interval of a peak speed: to a part in a thousand million, so that the time is that of the closed form within a
/// microsecond.
const HALVINGS: usize = 30;

impl Ramp {
    /// Time of a change of speed by `change` m/s, s.
    fn time(&self, change: f64) -> f64 {
        let full = self.acceleration * self.jerk_time;
        if change >= full {
            change / self.acceleration + self.jerk_time
        } else {
            2.0 * (change * self.jerk_time / self.acceleration).sqrt()
        }
    }

    /// Time, s, and way, m, of the ramps from `start` over `peak` to `end`; their speed is symmetric.
    fn both(&self, start: f64, peak: f64, end: f64) -> (f64, f64) {
        let (up, down) = (self.time((peak - start).max(0.0)), self.time((peak - end).max(0.0)));
        (up + down, 0.5 * (start + peak) * up + 0.5 * (peak + end) * down)
    }

    /// Time of a `way`, m, from speed `start` over at most `top` to `end`, m/s, in s.
    pub fn time_of(&self, way: f64, top: f64, start: f64, end: f64) -> f64 {
        let squares = start * start + end * end;
        let mut peak = top.min((self.acceleration * way + 0.5 * squares).sqrt());
        if self.jerk_time > 0.0 && self.both(start, peak, end).1 > way {
            let (mut low, mut high) = (start.max(end), peak);
            for _ in 0..HALVINGS {
                peak = 0.5 * (low + high);
                if self.both(start, peak, end).1 > way { high = peak } else { low = peak }
            }
        }
        let (time, ramps) = self.both(start, peak, end);
        if ramps > way {
            // The look-ahead knows no jerk: ramps that are too long are taken at their mean speed.
            return time * way / ramps;
        }
        time + if peak > 0.0 { (way - ramps) / peak } else { 0.0 }
    }
}
