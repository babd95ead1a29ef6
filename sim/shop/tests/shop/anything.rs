//! Random shops with samples, stocks, pegging, lost pieces that begin anew, people, vehicles and shifts of different pace: no piece
//! is lost, and a branch goes on as the run did.

use proptest::prelude::*;
use std::fmt::Write;
use toolroom_kernel::SimTime;
use toolroom_scenario_file::parse;
use toolroom_shop::runlog::{JobOutcome, LogEvent};
use toolroom_shop::{Origin, Shop};

/// The file of a random shop.
fn random_text(seed: u64) -> String {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut pick = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let mut head = format!(
        "schema = 1\n[shop]\nname = \"anything\"\nseed = {}\nhorizon = \"60 h\"\n[dispatch]\nrule = [\"priority\", \"{}\"]\n",
        seed + 1,
        ["fifo", "spt", "edd", "winq"][pick(4) as usize],
    );
    let at_end = ["resume", "repeat", "scrap", "finish"][pick(4) as usize];
    let factor = ["0.5", "0.8", "1.5"][pick(3) as usize];
    write!(
        head,
        "[[calendar]]\nname = \"day\"\nperiod = \"12 h\"\nat_end = \"{at_end}\"\n\
         shift = [{{ start = \"1 h\", end = \"6 h\" }}, {{ start = \"6 h\", end = \"10 h\", factor = {factor} }}]\n\
         [[operator]]\nname = \"hand\"\ncount = {}\nskills = [\"set\", \"tend\"]\n\
         [[operator]]\nname = \"helper\"\nskills = [\"tend\"]\n",
        1 + pick(2),
    )
    .unwrap();
    let machines = (0..5).map(|machine| {
        let calendar = if pick(2) == 0 { "calendar = \"day\"\n" } else { "" };
        format!(
            "[[machine]]\nname = \"M{machine}\"\nprocess = \"plain\"\nlocation = \"{}\"\nsetup_time = \"{} min\"\nsetup_at_start = \"\"\n{calendar}",
            ["hall", "yard"][machine % 2],
            pick(5),
        )
    });
    let machines: String = machines.collect();
    let mut tail = String::new();
    if pick(2) == 0 {
        write!(
            tail,
            "[[transport]]\nname = \"cart\"\ncapacity = {}\nlocations = [\"hall\", \"yard\"]\ntimes = [[\"0 min\", \"3 min\"], [\"4 min\", \"0 min\"]]\n",
            1 + pick(3)
        )
        .unwrap();
    }
    // A component from stock and one that is made for an order go into a product; another part goes alone.
    for part in ["bolt", "frame", "product", "lone"] {
        writeln!(tail, "[[part]]\nname = \"{part}\"\nflow_allowance = \"9 h\"").unwrap();
        match part {
            "product" => tail.push_str("components = [{ part = \"bolt\", quantity = 2 }]\n"),
            "lone" if pick(2) == 0 => tail.push_str("components = [{ part = \"frame\" }]\npegging = \"order\"\n"),
            "lone" => tail.push_str("components = [{ part = \"bolt\" }]\n"),
            _ => {}
        }
        tail.push_str(
            ["", "replenish = \"new_order\"\nreplenish_priority = -1\n", "replenish = { overrun = 0.3 }\n"]
                [pick(3) as usize],
        );
        for operation in 0..1 + pick(3) {
            let assembles = operation == 0 && ["product", "lone"].contains(&part);
            writeln!(
                tail,
                "[[part.operation]]\nname = \"{operation}\"\nmachines = \"M{}\"\nassemble = {assembles}\ndraw = \"{}\"\n\
                 work = {{ distribution = \"exponential\", mean = \"{} min\" }}",
                pick(5),
                ["lot", "part"][pick(2) as usize],
                2 + pick(9),
            )
            .unwrap();
            tail.push_str(
                [
                    "",
                    "operator = { setup = \"set\" }\n",
                    "operator = { setup = \"set\", run = { skill = \"tend\", share = 0.5 } }\n",
                ][pick(3) as usize],
            );
            let outcomes = "outcomes = [{ share = 0.2, go = \"0\" }, { share = 0.15, scrap = true }]\nrework_max = 2\n";
            match pick(4) {
                0 => tail.push_str(outcomes),
                1 => writeln!(tail, "{outcomes}sample = {{ every = 3 }}").unwrap(),
                2 if !assembles => tail.push_str("sample = { every = 2, others = \"pass\" }\n"),
                _ => {}
            }
        }
    }
    let lead = ["", ", lead = \"4 h\""][pick(2) as usize];
    write!(
        tail,
        "[[stock]]\npart = \"bolt\"\nquantity = {}\nreorder = {{ below = {}, lot = {}{lead} }}\n\
         [[arrivals]]\npart_mix = {{ product = 0.7, bolt = 0.3 }}\nquantity = {{ low = 1, high = 4 }}\npattern = \"poisson\"\nrate = \"0.7 1/h\"\n",
        pick(6),
        1 + pick(9),
        1 + pick(9),
    )
    .unwrap();
    let pegged = tail.contains("pegging = \"order\"");
    let mut orders = Vec::new();
    for number in 0..4 {
        // Released at instants of their own, so that no tie is broken by their place.
        let (quantity, release) = (1 + pick(5), 7 * number + pick(6));
        let transfer = if pick(2) == 0 { "transfer = 2\n" } else { "" };
        orders.push(format!(
            "[[order]]\nid = \"L{number}\"\npart = \"lone\"\nquantity = {quantity}\nrelease = \"{release}.{number} h\"\npriority = {}\n{transfer}",
            pick(3)
        ));
        let parent = if pegged { format!("parent = \"L{number}\"\n") } else { String::new() };
        // Its overrun may be a third more.
        orders.push(format!(
            "[[order]]\nid = \"F{number}\"\npart = \"frame\"\nquantity = {}\nrelease = \"{release}.{number}5 h\"\n{parent}",
            2 * quantity
        ));
    }
    if !pegged {
        orders.retain(|order| !order.contains("frame"));
        orders.push("[[order]]\nid = \"F\"\npart = \"frame\"\nquantity = 3\nrelease = \"50.7 h\"\n".to_owned());
    }
    format!("{head}{machines}{tail}{}", orders.concat())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]
    #[test]
    fn nothing_is_lost_and_a_branch_goes_on_as_the_run_did(seed in 0u64..1_000_000) {
        let text = random_text(seed);
        let scenario = parse("anything.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario;
        let mut shop = Shop::new(&scenario, 0, 0).unwrap();
        shop.run_until(SimTime::from_seconds(0.5 * scenario.horizon).unwrap()).unwrap();
        let branch = shop.clone();
        shop.run_until(SimTime::from_seconds(scenario.horizon).unwrap()).unwrap();
        let world = shop.world();
        let from_sources: u64 = world.sources.iter().map(|source| source.pieces).sum();
        let ordered: u64 = scenario.orders.iter().map(|order| u64::from(order.pieces())).sum();
        let reorder = scenario.shared.stocks[0].reorder.unwrap();
        let made = if reorder.lead.is_none() { world.stocks[0].lots * u64::from(reorder.lot) } else { 0 };
        let inside: u64 = world.jobs.iter().map(|job| u64::from(job.row.quantity)).sum();
        let of_stock = |job: &&toolroom_shop::Job| matches!(job.origin, Origin::Stock(_));
        let on_the_way: u64 = world.jobs.iter().filter(of_stock).map(|job| u64::from(job.row.quantity)).sum();
        // What is on order is in the shop, unless it is bought or let in within this instant.
        if reorder.lead.is_none() {
            prop_assert_eq!(world.stocks[0].on_order, on_the_way);
        }
        let log = shop.run().unwrap();
        let branch = branch.run().unwrap();
        prop_assert_eq!(branch.digest, log.digest);
        prop_assert!(format!("{branch:?}") == format!("{log:?}"), "a branch goes on as the run did");
        let pieces = |of: &dyn Fn(&toolroom_shop::runlog::JobRow) -> bool| -> u64 {
            log.jobs.iter().filter(|job| of(job)).map(|job| u64::from(job.quantity)).sum()
        };
        let anew: u64 = log.events.iter().filter(|row| row.event == LogEvent::Replenish).filter_map(|row| row.job)
            .map(|job| {
                // Pieces of a job that an inspection has divided since came with it.
                let mut all = vec![job];
                let mut next = 0;
                while let Some(&parent) = all.get(next) {
                    next += 1;
                    all.extend((0..log.jobs.len() as u32).filter(|own| log.jobs[*own as usize].divided_from == Some(parent)));
                }
                all.iter().map(|own| u64::from(log.jobs[*own as usize].quantity)).sum::<u64>()
            })
            .sum();
        prop_assert_eq!(pieces(&|_| true), from_sources + ordered + made + anew);
        prop_assert_eq!(pieces(&|job| job.outcome == JobOutcome::InProcess), inside);
        for machine in 0..scenario.machines.len() as u32 {
            let mut end = 0.0;
            for row in log.states.iter().filter(|row| row.machine == machine) {
                prop_assert_eq!(row.start, end);
                end = row.end;
            }
            prop_assert_eq!(end, scenario.horizon);
        }
        // Nobody is at two machines with more than all of themselves.
        for operator in 0..scenario.operators.len() as u32 {
            let own: Vec<_> = log.attendances.iter().filter(|row| row.operator == operator).collect();
            for row in &own {
                let at_once = own.iter().filter(|other| other.start <= row.start && row.start < other.end);
                let load: f32 = at_once.map(|other| other.share).sum();
                prop_assert!(load <= 1.0 + 1e-5, "{}", load);
            }
        }
    }
}
