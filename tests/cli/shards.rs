//! Comparisons cut into shards.

use super::resumed::assert_same;
use super::*;

/// A cell with its policies, and two variants of it.
fn varied(name: &str) -> String {
    let cell = fs::read_to_string(shipped("template")).expect("a scenario");
    let variants = "\n[[variant]]\nname = \"quick change\"\nset = { \"machine.L.tool_change_time\" = \"10 s\" }\n\n\
                    [[variant]]\nname = \"later\"\nfrom = \"2 h\"\nset = { \"dispatch.rule\" = \"spt\" }\n";
    file(name, cell + variants)
}

#[test]
fn policies_and_variants_in_shards_are_those_of_one_piece() {
    let scenario = varied("shards_scenario");
    let dir = directory("cli", "shards");
    let place = |name: &str| dir.join(name).display().to_string();
    let ran = |arguments: &[&str]| {
        let output = toolroom(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
    };
    let changes = ["--set", "shop.horizon=4 h", "--replications", "5", "--policy", "constant"];
    for axis in [&[][..], &["--axis", "variant"], &["--axis", "both", "--policy", "best constant"]] {
        let ask = [&["compare", &scenario], &changes[..], axis].concat();
        let (whole, merged) = (place("whole"), place("merged"));
        ran(&[&ask[..], &["--out", &whole]].concat());
        for shards in [1u32, 2, 5] {
            let (plan, parts) = (place("plan.json"), place(&format!("parts-{shards}-{}", axis.len())));
            ran(&[&ask[..], &["--plan", &plan, "--shards", &shards.to_string()]].concat());
            let checked = stderr(&toolroom(&["check", &plan]));
            assert!(checked.contains("5 pieces of work"), "{checked}");
            for shard in (0..shards).rev() {
                ran(&["shard", &plan, &shard.to_string(), "--out", &parts]);
            }
            ran(&["merge", &parts, "--out", &merged]);
            assert_same(Path::new(&whole), Path::new(&merged));
            assert!(Path::new(&merged).join("variants.csv").is_file());
        }
    }
    let none = place("none.json");
    let alone = [&["compare", &scenario, "--axis", "policy", "--plan", &none], &changes[..]].concat();
    let refused = toolroom(&alone);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("nothing to compare"), "{}", stderr(&refused));
    // A part that lacks the runs of a variant is refused by name.
    let part = dir.join("parts-1-0/part-000000.json");
    let text = fs::read_to_string(&part).expect("a part");
    fs::write(&part, text.replacen("\"shop\":2", "\"shop\":1", 1)).expect("writable");
    let refused = toolroom(&["merge", &place("parts-1-0"), "--out", &place("refused")]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("part-000000.json"), "{}", stderr(&refused));
}
