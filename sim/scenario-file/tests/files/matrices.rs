//! Tables of setup times and of ways in files beside the scenario.

use super::*;
use toolroom_scenario::Scenario;

const SHOP: &str = r#"schema = 1
[shop]
name = "matrices"
horizon = "8 h"
[[machine]]
name = "saw"
process = "plain"
setup_matrix = "chucks"
[[machine]]
name = "bench"
process = "plain"
[[setup_matrix]]
name = "chucks"
groups = ["small", "large"]
times = [["30 min", "30 min"], ["0 min", "20 min"], ["45 min", "0 min"]]
[[transport]]
name = "AGV"
locations = ["saw", "bench"]
times = [["0 min", "3 min"], ["2 min", "0 min"]]
[[operator]]
name = "tender"
skills = ["tend"]
walk = { locations = ["saw", "bench"], times = [["0 min", "1 min"], ["1 min", "0 min"]] }
[[part]]
name = "bar"
operation = [
    { name = "cut", machines = "saw", work = "5 min", setup_group = "large" },
    { name = "join", machines = "bench", work = "5 min" },
]
[[arrivals]]
part = "bar"
pattern = "poisson"
rate = "6 1/h"
"#;

/// The shop with its lists in files, or what is told of these.
fn with_files(chucks: &str, ways: &str) -> Result<Scenario, Vec<String>> {
    static NUMBER: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let number = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("toolroom-matrices-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let text = SHOP
        .replace(
            "groups = [\"small\", \"large\"]\ntimes = [[\"30 min\", \"30 min\"], [\"0 min\", \"20 min\"], [\"45 min\", \"0 min\"]]",
            "file = \"chucks.csv\"",
        )
        .replace(
            "locations = [\"saw\", \"bench\"]\ntimes = [[\"0 min\", \"3 min\"], [\"2 min\", \"0 min\"]]",
            "file = \"ways.csv\"",
        );
    std::fs::write(folder.join("shop.toml"), text).expect("written");
    std::fs::write(folder.join("chucks.csv"), chucks).expect("written");
    std::fs::write(folder.join("ways.csv"), ways).expect("written");
    let read = read(&folder.join("shop.toml"), &[]);
    std::fs::remove_dir_all(&folder).expect("removed");
    match read {
        Ok(file) => Ok(file.scenario),
        Err(ReadError::Faults(list)) => Err(list.problems.iter().map(|problem| problem.fault.to_string()).collect()),
        Err(other) => panic!("{other}"),
    }
}

const CHUCKS: &str = "from,small,large\n,30 min,30 min\nsmall,0 min,20 min\nlarge,45 min,0 min\n";
const WAYS: &str = "from,saw,bench\nsaw,0 min,3 min\nbench,2 min,0 min\n";

#[test]
fn a_matrix_of_a_file_is_that_of_the_lists() {
    let listed = parse("shop.toml", SHOP, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    for (chucks, ways) in [
        (CHUCKS, WAYS),
        // Rows in any order, numbers in the unit of the first cell, semicolons, a remark.
        (
            "# chucks\nfrom [min];small;large\nlarge;45;0\nsmall;0;20\n;30;30\n",
            "[s],saw,bench\nbench,120,0\nsaw,0,3 min\n",
        ),
    ] {
        let read = with_files(chucks, ways).unwrap_or_else(|told| panic!("{told:?}"));
        assert_eq!(read.setup_matrices, listed.setup_matrices);
        assert_eq!(read.transports, listed.transports);
    }
    // Names that are listed beside a file give the order.
    let both = |groups: &str| {
        let text = SHOP.replace(
            "groups = [\"small\", \"large\"]\ntimes = [[\"30 min\", \"30 min\"], [\"0 min\", \"20 min\"], [\"45 min\", \"0 min\"]]",
            &format!("groups = {groups}\nfile = \"chucks.csv\""),
        );
        let folder = std::env::temp_dir().join(format!("toolroom-chucks-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("shop.toml"), text).expect("written");
        std::fs::write(folder.join("chucks.csv"), CHUCKS).expect("written");
        let read = read(&folder.join("shop.toml"), &[]);
        std::fs::remove_dir_all(&folder).expect("removed");
        read
    };
    let turned = both("[\"large\", \"small\"]").expect("a shop").scenario;
    let matrix = &turned.setup_matrices[0];
    assert_eq!(matrix.times, [[0.0, 2700.0], [1200.0, 0.0]]);
    assert_eq!((matrix.groups.join(" "), matrix.first.clone()), ("large small".to_owned(), Some(vec![1800.0, 1800.0])));
    let error = both("[\"large\", \"smal\"]").expect_err("other names").to_string();
    assert!(error.contains("the columns of chucks.csv are small, large"), "{error}");
    // Without a row in front nothing is said of a machine that was never set up.
    let bare = with_files(&CHUCKS.replace(",30 min,30 min\n", ""), WAYS).expect("a shop");
    assert_eq!((bare.setup_matrices[0].first.as_ref(), bare.setup_matrices[0].times.len()), (None, 2));
}

#[test]
fn what_is_wrong_in_a_file_is_told_with_its_line() {
    let mut wrong = Vec::new();
    for (chucks, ways, words) in [
        (CHUCKS.replace("20 min", "20"), WAYS.to_owned(), "chucks.csv, line 3"),
        (CHUCKS.replace("20 min", "-1 min"), WAYS.to_owned(), "is outside 0 to"),
        (CHUCKS.replace("large,45", "larg,45"), WAYS.to_owned(), "chucks.csv, line 4: there is no column \"larg\""),
        (CHUCKS.replace("large,45 min,0 min\n", ""), WAYS.to_owned(), "the row \"large\" is missing"),
        (CHUCKS.replace(",0 min\n", "\n"), WAYS.to_owned(), "has 2 cells"),
        (CHUCKS.replace("small,large", "small,small"), WAYS.to_owned(), "column 3 is called \"small\""),
        (format!("{CHUCKS}large,1 min,1 min\n"), WAYS.to_owned(), "two rows \"large\""),
        (CHUCKS.to_owned(), WAYS.replace("bench", "bank"), "\"bank\""),
        (CHUCKS.to_owned(), format!("{WAYS},1 min,1 min\n"), "ways.csv, line 4"),
    ] {
        let told = with_files(&chucks, &ways).expect_err(words);
        if !told.iter().any(|text| text.contains(words)) {
            wrong.push(format!("{words}: {told:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let told = |from: &str, to: &str| {
        assert!(SHOP.contains(from), "{from}");
        parse("shop.toml", &SHOP.replacen(from, to, 1), &[]).expect_err(to).to_string()
    };
    assert!(told("groups = [\"small\", \"large\"]\n", "").contains("lacks `groups`"));
    assert!(told("groups", "file = \"chucks.csv\"\ngroups").contains("`times` does not apply"));
}

#[test]
fn every_problem_of_a_section_is_told_once() {
    let text = format!("{SHOP}[dispatch]\nrule = \"fastest\"\n");
    let Err(ReadError::Faults(list)) = parse("shop.toml", &text, &[]) else { panic!("a fault") };
    assert_eq!(list.problems.len(), 1, "{list}");
    let text = format!("{SHOP}[tables]\norder = \"orders.csv\"\n");
    let Err(ReadError::Faults(list)) = parse("shop.toml", &text, &[]) else { panic!("a fault") };
    assert_eq!(list.problems.len(), 1, "{list}");
}

#[test]
fn due_dates_of_a_source_may_lie_a_constant_time_ahead() {
    let due = |words: &str| {
        let text = format!("{SHOP}due = {words}\n");
        let read = parse("shop.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
        format!("{:?}", read.arrivals[0].due)
    };
    assert_eq!(due("{ rule = \"constant\" }"), "Allowance");
    assert_eq!(due("{ rule = \"constant\", allowance = \"5 h\" }"), "Random(Constant(18000.0))");
}

#[test]
fn moves_take_time_and_have_no_buffers() {
    let text = SHOP.replace("horizon = \"8 h\"", "horizon = \"8 h\"\nmove_time = \"2 min\"");
    let read = parse("shop.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    assert_eq!(read.move_time.mean(), 120.0);
    let text = text.replace("name = \"bench\"\n", "name = \"bench\"\ninput_buffer = 3\n");
    assert!(parse("shop.toml", &text, &[]).expect_err("buffers").to_string().contains("limits of the buffers"));
}

#[test]
fn breakdowns_have_names_of_their_own() {
    let failure = "[[failure]]\nname = \"jam\"\nmachines = [\"saw\", \"bench\"]\ntime_between = \"5 h\"\ntime_to_repair = \"1 h\"\n";
    let read = parse("shop.toml", &format!("{SHOP}{failure}"), &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let names: Vec<Option<&str>> = read.failures.iter().map(|own| own.name.as_deref()).collect();
    assert_eq!(names, [Some("jam"), Some("jam")]);
    let error = parse("shop.toml", &format!("{SHOP}{failure}{failure}"), &[]).expect_err("two of a name").to_string();
    assert!(error.contains("jam"), "{error}");
}
