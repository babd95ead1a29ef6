//! A stochastic job shop: exact flow time, snapshots, digests.

use crate::statistics::Estimate;
use crate::stochastic_shop::{Rule, Shop};

fn flow(rule: Rule) -> Estimate {
    let mut shop = Shop::new(rule, 85);
    shop.run_until(220_000);
    Estimate::of_series(&shop.flow_times[20_000..])
}

#[test]
fn first_come_first_served_has_the_flow_time_of_a_kelly_network() {
    flow(Rule::FirstComeFirstServed).assert_agrees("flow time", 40.0, 0.03);
}

#[test]
fn shortest_first_halves_the_flow_time() {
    let shortest = flow(Rule::ShortestFirst);
    assert!(shortest.mean < 20.0 && shortest.standard_error < 0.5, "{} ± {}", shortest.mean, shortest.standard_error);
}

#[test]
fn a_branch_repeats_the_original_until_the_rule_changes() {
    let mut original = Shop::new(Rule::FirstComeFirstServed, 3);
    original.run_until(2_000);
    let (mut same, mut other) = (original.clone(), original.clone());
    other.rule = Rule::ShortestFirst;
    for shop in [&mut original, &mut same, &mut other] {
        shop.run_until(10_000);
    }
    assert_eq!(original.digest, same.digest);
    assert_eq!(original.flow_times, same.flow_times);
    assert_ne!(original.digest, other.digest);
}

#[test]
fn digest_is_pinned_and_independent_of_the_thread() {
    let run = || {
        let mut shop = Shop::new(Rule::ShortestFirst, 11);
        shop.run_until(1_000);
        shop.digest.to_string()
    };
    let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(run)).collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), "a4b8767d0bc35cd2");
    }
}
