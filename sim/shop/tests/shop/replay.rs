//! The same run gives the same bytes; a branch goes on like the trunk; policies meet the same chance.

use crate::scenarios::{self, Rubbing, jobs_at, operation, policy, scenario, tool};
use toolroom_kernel::SimTime;
use toolroom_scenario::policies::ResolveError;
use toolroom_scenario::*;
use toolroom_shop::{Refusal, Shop, ShopError, run};
use toolroom_wear::Scatter;

/// Random arrivals, handling, breakdowns and edges on two machines, two policies.
fn shop() -> Scenario {
    let mut shop = scenario();
    let mut second = scenarios::machine("second");
    second.load_time = Distribution::Exponential { mean: 3.0 };
    shop.machines.push(second);
    shop.tools = vec![tool(Rubbing { wear_per_path: 0.01, wear_limit: 0.5, breaks_at: 0.7 })];
    shop.tools[0].scatter = Scatter { initial_wear: 0.0, ..Scatter::shop() };
    shop.parts[0].operations = vec![operation(&[0, 1], &[10.0, 5.0]), operation(&[1], &[8.0])];
    shop.arrivals[0].pattern = ArrivalPattern::Poisson { rate: 0.02 };
    shop.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Exponential { mean: 200.0 },
        time_to_repair: Distribution::Exponential { mean: 20.0 },
        clock: FailureClock::Busy,
        crew: None,
        part: Interruption::Resume,
    }];
    let slow = SpeedRule::Constant { cutting_speed: 0.5 };
    shop.policies.push(policy("changed early", SpeedRule::Programmed, ToolChangeRule::PartCount { parts: 2 }));
    shop.policies.push(policy("slow", slow, ToolChangeRule::PartCount { parts: 2 }));
    shop.horizon = 20_000.0;
    shop
}

#[test]
fn the_same_run_gives_the_same_bits() {
    let shop = shop();
    let (a, b) = (run(&shop, 0, 3).unwrap(), run(&shop, 0, 3).unwrap());
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
    assert_ne!(a.digest, run(&shop, 0, 4).unwrap().digest);
    assert_ne!(a.digest, run(&shop, 1, 3).unwrap().digest);
    assert_ne!(a.digest, run(&Scenario { seed: 12, ..shop.clone() }, 0, 3).unwrap().digest);
}

#[test]
fn threads_change_nothing() {
    let shop = shop();
    let alone: Vec<u64> = (0..8).map(|replication| run(&shop, 0, replication).unwrap().digest).collect();
    let together: Vec<u64> = std::thread::scope(|scope| {
        let shop = &shop;
        let runs: Vec<_> = (0..8).map(|each| scope.spawn(move || run(shop, 0, each).unwrap().digest)).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    assert_eq!(alone, together);
}

#[test]
fn a_branch_without_change_goes_on_like_the_trunk() {
    let shop = shop();
    let whole = run(&shop, 0, 0).unwrap();
    let mut trunk = Shop::new(&shop, 0, 0).unwrap();
    for time in [1.0, 777.7, 9000.0] {
        trunk.run_until(SimTime::from_seconds(time).unwrap()).unwrap();
        let mut branch = trunk.clone();
        branch.set_policy(0).unwrap();
        assert_eq!(format!("{:?}", branch.run().unwrap()), format!("{whole:?}"));
    }
    assert_eq!(format!("{:?}", trunk.run().unwrap()), format!("{whole:?}"));
}

#[test]
fn a_branch_under_another_policy_shares_the_past() {
    let shop = shop();
    let mut trunk = Shop::new(&shop, 0, 0).unwrap();
    trunk.run_until(SimTime::from_seconds(5000.0).unwrap()).unwrap();
    let past = trunk.recorder().passes.len();
    let mut branch = trunk.clone();
    branch.set_policy(2).unwrap();
    let (a, b) = (trunk.run().unwrap(), branch.run().unwrap());
    assert_eq!(format!("{:?}", a.passes[..past].to_vec()), format!("{:?}", b.passes[..past].to_vec()));
    assert!(b.passes[past + 2..].iter().all(|row| row.speed_start == 0.5));
    assert!(matches!(
        Shop::new(&shop, 0, 0).unwrap().set_policy(9),
        Err(ShopError::Policy(ResolveError::UnknownPolicy { index: 9, count: 3 }))
    ));
}

#[test]
fn policies_meet_the_same_edges_arrivals_and_breakdowns() {
    let shop = shop();
    let logs: Vec<_> = (0..3).map(|policy| run(&shop, policy, 5).unwrap()).collect();
    for other in &logs[1..] {
        assert_eq!(logs[0].jobs.len(), other.jobs.len());
        assert!(logs[0].jobs.iter().zip(&other.jobs).all(|(a, b)| a.arrival == b.arrival));
        // The k-th edge of a machine is the same edge, whenever it is mounted.
        for machine in 0..2 {
            let factors = |log: &toolroom_shop::runlog::RunLog| -> Vec<f64> {
                let rows = log.edges.iter().filter(|row| row.machine == machine);
                rows.map(|row| row.mechanical_wear_factor).collect()
            };
            let (a, b) = (factors(&logs[0]), factors(other));
            let shared = a.len().min(b.len());
            assert!(shared > 5 && a[..shared] == b[..shared]);
            assert!(a.windows(2).all(|pair| pair[0] != pair[1]));
        }
    }
    assert_ne!(logs[0].edges.len(), logs[1].edges.len());
}

#[test]
fn another_replication_meets_other_chance() {
    let shop = shop();
    let first = |replication| run(&shop, 0, replication).unwrap().edges[0].mechanical_wear_factor;
    assert_ne!(first(0), first(1));
}

#[test]
fn a_shop_without_durations_is_stopped() {
    let mut shop = scenario();
    shop.parts[0].operations = vec![operation(&[0], &[])];
    shop.arrivals[0].pattern = ArrivalPattern::ConstantWork { jobs: 1 };
    let error = run(&shop, 0, 0).unwrap_err();
    assert!(matches!(error, ShopError::NoProgress { time: 0.0, .. }), "{error}");
}

#[test]
fn an_operation_without_any_duration_takes_none() {
    let mut shop = scenario();
    shop.parts[0].operations = vec![operation(&[0], &[]), operation(&[0], &[4.0]), operation(&[0], &[])];
    shop.arrivals[0] = jobs_at(&[(3.0, 2)]);
    let log = run(&shop, 0, 0).unwrap();
    let finish: Vec<f64> = log.jobs.iter().map(|job| job.finish).collect();
    assert_eq!(finish, [7.0, 11.0]);
}

#[test]
fn a_model_that_refuses_stops_the_run_and_says_where() {
    let mut shop = scenario();
    shop.machines[0].speed_range = (0.1, 100.0);
    let mut fast = operation(&[0], &[4.0, 4.0]);
    if let Work::Cutting(cuts) = &mut fast.work {
        cuts[1].cutting_speed = 50.0; // the test process takes 10 m/s at most
    }
    shop.parts[0].operations = vec![fast];
    let error = run(&shop, 0, 0).unwrap_err();
    let ShopError::Model(refusal) = error else { panic!("{error}") };
    let Refusal { time, machine, part, operation, pass, inputs, .. } = *refusal;
    assert_eq!((time, machine.as_str(), part.as_str(), operation.as_str(), pass), (4.0, "lathe", "shaft", "turn", 1));
    assert!(inputs.contains(&("cutting_speed", 50.0)));
}

#[test]
fn indices_that_point_nowhere_are_refused() {
    let broken = |change: fn(&mut Scenario)| {
        let mut shop = scenario();
        change(&mut shop);
        run(&shop, 0, 0).unwrap_err().to_string()
    };
    assert!(broken(|shop| shop.parts[0].operations[0].tool = Some(5)).contains("tool 5"));
    assert!(broken(|shop| shop.parts[0].operations[0].machines = vec![7]).contains("machine 7"));
    assert!(broken(|shop| shop.parts[0].operations[0].machines = vec![]).contains("has no machine"));
    assert!(broken(|shop| shop.arrivals[0].parts = vec![(4, 1.0)]).contains("part 4"));
    assert!(broken(|shop| shop.machines[0].calendar = Some(2)).contains("calendar 2"));
    assert!(broken(|shop| shop.policies.clear()).contains("policy 0"));
}
