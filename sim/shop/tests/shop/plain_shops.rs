//! Shops of nothing but plain machines, which have an engine of their own for a run from time zero to the horizon: it leaves the
//! log of the one for all shops, which a run in pieces has.

use toolroom_kernel::SimTime;
use toolroom_scenario::Scenario;
use toolroom_shop::Shop;

/// A shop of four plain machines with all that such a shop may have, in one of several mixtures.
fn shop(rule: &str, mixture: usize) -> Scenario {
    let mut text = format!(
        "schema = 1\n[shop]\nname = \"plain\"\nhorizon = \"60 h\"\nwarm_up = \"3 h\"\nseed = {mixture}\n\
         [dispatch]\nrule = {rule}\n"
    );
    for machine in 0..4 {
        text += &format!("[[machine]]\nname = \"M{machine}\"\nprocess = \"plain\"\n");
        match (mixture + machine) % 4 {
            1 => text += "setup_time = \"2 min\"\n",
            2 => text += "setup_matrix = \"m\"\nsetup_at_start = \"1\"\n",
            3 => text += "setup_at_start = \"\"\nsetup_time = \"0 min\"\n",
            _ => {}
        }
    }
    let row = |from: usize| format!("[{}]", [0, 1, 2].map(|to| format!("\"{} min\"", from + 2 * to)).join(", "));
    text += &format!(
        "[[setup_matrix]]\nname = \"m\"\ngroups = [\"0\", \"1\", \"2\"]\ntimes = [{}]\n",
        [0, 0, 1, 2].map(row).join(", ")
    );
    for part in 0..4 {
        text += &format!("[[part]]\nname = \"P{part}\"\nbatch_size = {}\noperation = [\n", 1 + part % 2);
        for step in 0..4 {
            let (machine, mean) = ((part * 3 + step * (part % 2 + 1)) % 4, 2 + (part + step) % 3);
            let work = match (step + mixture) % 4 {
                2 => "\"3 min\"".to_owned(),
                3 if part == 3 => "\"0 min\"".to_owned(),
                _ => format!("{{ distribution = \"exponential\", mean = \"{mean} min\" }}"),
            };
            let more = ["", ", work_per = \"lot\"", ", setup_time = \"1 min\"", ""][(part + step + mixture) % 4];
            let pace = if step == 1 { format!(", time_on = {{ M{machine} = 1.25 }}") } else { String::new() };
            text += &format!(
                "{{ name = \"{step}\", machines = \"M{machine}\", work = {work}, \
                 setup_group = \"{}\"{more}{pace} }},\n",
                (part + step) % 3
            );
        }
        text += "]\n";
    }
    let due = ["", "due = { rule = \"TWK\", k = 4 }\n", "due = { rule = \"slack\", slack = \"1 h\" }\n"];
    let patterns = [
        "pattern = \"poisson\"\nrate = \"3 1/h\"\n",
        "pattern = \"renewal\"\ntime_between = { distribution = \"uniform\", low = \"10 min\", high = \"50 min\" }\n",
        "pattern = \"batch\"\ninterval = \"2 h\"\nsize = 4\n",
        "pattern = \"schedule\"\nlot = [{ time = \"5 h\", size = 3 }, { time = \"1 h\", size = 2 }]\n",
        "pattern = \"constant_work\"\njobs = 3\n",
    ];
    for source in 0..3 {
        let part = if source == 1 {
            "part_mix = { P1 = 0.3, P2 = 0.7 }\n"
        } else {
            ["part = \"P0\"\n", "", "part = \"P3\"\n"][source]
        };
        let quantity = if source == mixture % 3 { "quantity = { low = 1, high = 3 }\n" } else { "" };
        text += &format!(
            "[[arrivals]]\nname = \"S{source}\"\npriority = {source}\nweight = 1.5\n{part}{quantity}{}{}",
            patterns[(source + mixture) % 5],
            due[(source + mixture) % 3]
        );
    }
    let file = toolroom_scenario_file::parse("plain.toml", &text, &[]);
    file.unwrap_or_else(|error| panic!("{error:?}\n{text}")).scenario
}

#[test]
fn a_plain_shop_leaves_the_log_of_any_other() {
    let standing =
        ["\"fifo\"", "\"spt\"", "[\"priority\", \"edd\"]", "\"srpt\"", "\"odd\"", "\"most_operations\"", "\"lifo\""];
    let moving = [
        "\"cr\"",
        "\"atc\"",
        "\"pt_winq\"",
        "\"covert\"",
        "\"s_ro\"",
        "[\"priority\", \"mdd\"]",
        "[\"winq\", \"spt\"]",
        "\"mod\"",
        "\"pt_winq_npt\"",
        "\"pt_winq_sl\"",
    ];
    for mixture in 0..72 {
        let rule = if mixture < 42 { standing[mixture % 7] } else { moving[mixture % 10] };
        let scenario = shop(rule, mixture);
        let plain = Shop::new(&scenario, 0, 0).unwrap();
        let mut whole = plain.clone();
        whole.run_until(SimTime::from_seconds(scenario.horizon).unwrap()).unwrap();
        let (plain, whole) = (plain.run().unwrap(), whole.run().unwrap());
        assert!(plain.operations.len() > 500, "{}", plain.operations.len());
        // NaN in rows: compared as they are written.
        assert_eq!(format!("{plain:?}"), format!("{whole:?}"), "{mixture}");
    }
}
