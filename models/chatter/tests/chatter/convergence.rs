//! How the methods converge, and that the documentation shows it.

#[path = "../../examples/convergence.rs"]
#[allow(dead_code)] // its main function
mod example;

use example::{NODES, STEPS, convergence, table};

#[test]
fn discretisations_converge_with_order_two_and_collocation_faster_than_any_power() {
    let errors = convergence().unwrap();
    for discretised in [&errors.semi, &errors.full] {
        for i in 2..STEPS.len() {
            let ratio = STEPS[i] as f64 / STEPS[i - 1] as f64;
            let order = (discretised[i - 1] / discretised[i]).ln() / ratio.ln();
            assert!((order - 2.0).abs() < 0.1, "{} steps: order {order}", STEPS[i]);
        }
    }
    // The order of the collocation grows with the nodes until rounding is reached.
    let order = |i: usize| {
        let ratio = NODES[i] as f64 / NODES[i - 1] as f64;
        (errors.collocation[i - 1] / errors.collocation[i]).ln() / ratio.ln()
    };
    assert!(order(1) > 10.0 && order(2) > 1.5 * order(1) && order(3) > 1.2 * order(2));
    assert!(errors.collocation[5..].iter().all(|error| *error < 1e-10));
}

#[test]
fn the_documentation_shows_the_table_that_the_example_prints() {
    let docs = include_str!("../../../../docs/chatter.md");
    for line in table(&convergence().unwrap()).lines() {
        assert!(docs.lines().any(|other| other == line), "docs/chatter.md lacks: {line}");
    }
}
