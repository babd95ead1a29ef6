//! Stability against literature, dense roots and simulations; what is refused.

mod convergence;
mod intervals;
mod literature;
mod refusals;
mod roots;
mod taper;
mod verdicts;

/// The study that `examples/consistency.rs` makes of more systems.
#[path = "../../examples/consistency.rs"]
#[allow(dead_code)]
mod consistency;

#[test]
fn charts_curves_intervals_and_verdicts_give_one_answer() {
    for found in consistency::counted([12, 4, 6, 20]).unwrap() {
        let consistency::Counts { points, refused, at, chart, curve, .. } = found;
        assert!(points > 100 && refused == 0 && [at, chart, curve] == [0; 3], "{found:?}");
    }
}
