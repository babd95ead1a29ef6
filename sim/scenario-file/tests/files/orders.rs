//! Orders, tables and dates: what is read, and what is told of bad ones.

use super::*;

/// A plain shop with dates and a calendar, to which orders are added.
const SHOP: &str = r#"schema = 1
[shop]
name = "dated"
start = "2026-03-30 00:00"
horizon = "1 week"
[[calendar]]
name = "early"
week = { mon-fri = ["06:00-14:00"], fri = ["06:00-12:00"] }
holidays = ["2026-04-02..2026-04-03"]
[[machine]]
name = "saw"
process = "plain"
calendar = "early"
[[part]]
name = "bar"
flow_allowance = "2 day"
operation = [{ name = "saw", machines = "saw", work = "5 min" }]
"#;

const ORDER: &str =
    "[[order]]\nid = \"A\"\npart = \"bar\"\nquantity = 4\nrelease = \"2026-03-30 06:00\"\ndue = \"2026-03-31\"\n";

fn read_with(order: &str) -> Vec<(&'static str, usize, String)> {
    faults_of(&format!("{SHOP}{order}"), &[])
}

#[test]
fn dates_count_from_the_start() {
    let file = parse("dated.toml", &format!("{SHOP}{ORDER}"), &[]).unwrap_or_else(|error| panic!("{error}"));
    let scenario = &file.scenario;
    let order = &scenario.orders[0];
    assert_eq!((order.release, order.due, order.quantity), (6.0 * 3600.0, 86_400.0, 4));
    // Four days, the last of them short, and the last two holidays.
    assert_eq!(scenario.calendars[0].working_time(0.0, 7.0 * 86_400.0), 24.0 * 3600.0);
    assert!(scenario.calendars[0].at_end == toolroom_scenario::Interruption::Resume);
    let later = parse("dated.toml", &format!("{SHOP}{}", ORDER.replace("due = \"2026-03-31\"\n", "")), &[]).unwrap();
    assert_eq!(later.scenario.orders[0].due, order.release + 2.0 * 86_400.0);
    let hours = parse("dated.toml", &format!("{SHOP}{}", ORDER.replace("2026-03-30 06:00", "6 h")), &[]).unwrap();
    assert_eq!(hours.scenario.orders, scenario.orders);
}

#[test]
fn bad_orders_and_dates_are_told_in_their_place() {
    let line = SHOP.lines().count();
    let cases = [
        ("part = \"bar\"", "part = \"bra\"", "unknown-name", line + 3, "did you mean `bar`"),
        ("quantity = 4", "quantity = 0", "out-of-range", line + 4, "quantity"),
        ("2026-03-30 06:00", "2026-02-30 06:00", "no-date", line + 5, "is no date"),
        ("2026-03-30 06:00", "2026-04-07 06:00", "order-beyond-horizon", line + 5, "2026-04-07 06:00"),
        ("2026-03-30 06:00", "2026-03-29 06:00", "order-beyond-horizon", line + 5, "2026-03-29 06:00"),
        ("2026-03-31", "2026-03-30", "contradiction", line + 6, "due after it is released"),
        ("2026-03-31", "soon", "quantity", line + 6, "due"),
        ("2026-03-30 06:00", "30.03.2026", "arrangement", line + 5, "write \"2026-03-30 00:00\""),
        ("2026-03-30 06:00", "30.3.2026 06:15", "arrangement", line + 5, "write \"2026-03-30 06:15\""),
    ];
    for (from, to, code, place, words) in cases {
        let message = read_with(&ORDER.replace(from, to));
        assert!(
            message.iter().any(|(own, at, text)| *own == code && *at == place && text.contains(words)),
            "{to}: {message:#?}"
        );
    }
    let twice = only(read_with(&format!("{ORDER}{ORDER}")));
    assert_eq!((twice.0, twice.1), ("duplicate-name", line + 8));
    let without = faults_of(&format!("{SHOP}{ORDER}").replace("start = \"2026-03-30 00:00\"\n", ""), &[]);
    assert!(without.iter().filter(|(code, ..)| *code == "date-without-start").count() == 3, "{without:#?}");
}

#[test]
fn a_run_may_end_at_a_date() {
    let until = |end: &str| format!("{SHOP}{ORDER}").replace("1 week", end);
    let file = parse("dated.toml", &until("2026-04-06 00:00"), &[]).unwrap_or_else(|error| panic!("{error}"));
    let week = parse("dated.toml", &until("1 week"), &[]).unwrap();
    assert_eq!((file.scenario.horizon, week.scenario.horizon), (7.0 * 86_400.0, 7.0 * 86_400.0));
    assert_eq!(file.scenario.calendars, week.scenario.calendars);
    let set = parse("dated.toml", &until("1 week"), &["shop.horizon=2026-04-01".to_owned()]).unwrap();
    assert_eq!(set.scenario.horizon, 2.0 * 86_400.0);
    for (end, code) in [("2026-03-29", "arrangement"), ("2126-04-06", "arrangement"), ("2026-02-30", "no-date")] {
        let told = faults_of(&until(end), &[]);
        assert!(told.iter().any(|(own, line, _)| *own == code && *line == 5), "{end}: {told:#?}");
    }
    let without = faults_of(&until("2026-04-06").replace("start = \"2026-03-30 00:00\"\n", ""), &[]);
    assert!(without.iter().any(|(own, line, _)| *own == "date-without-start" && *line == 4), "{without:#?}");
}

const WIP: &str = "[[wip]]\norder = \"A\"\noperation = \"saw\"\nmachine = \"saw\"\ndone = \"25 %\"\nsince = \"-2 h\"\n";

#[test]
fn work_in_the_shop_at_the_start_is_understood() {
    let early = ORDER.replace("2026-03-30 06:00", "2026-03-27 06:00");
    let file = parse("dated.toml", &format!("{SHOP}{early}{WIP}"), &[]).unwrap_or_else(|error| panic!("{error}"));
    let order = &file.scenario.orders[0];
    assert_eq!(order.release, -66.0 * 3600.0);
    let in_process = order.in_process.as_ref().expect("it is in the shop");
    assert_eq!(
        (in_process.operation, in_process.machine, in_process.done, in_process.since),
        (0, Some(0), 0.25, -7200.0)
    );
    let pieces = WIP.replace("done = \"25 %\"", "pieces = 1");
    let same = parse("dated.toml", &format!("{SHOP}{early}{pieces}"), &[]).unwrap().scenario;
    assert_eq!(same.orders, file.scenario.orders);
}

#[test]
fn impossible_work_at_the_start_is_told_in_its_place() {
    let early = ORDER.replace("2026-03-30 06:00", "2026-03-27 06:00");
    let line = SHOP.lines().count() + early.lines().count();
    let cases = [
        ("order = \"A\"", "order = \"B\"", "unknown-name", 2, "did you mean `A`"),
        ("operation = \"saw\"", "operation = \"sew\"", "unknown-name", 3, "did you mean `saw`"),
        ("machine = \"saw\"", "machine = \"lathe\"", "unknown-name", 4, "lathe"),
        ("machine = \"saw\"\n", "", "arrangement", 4, "waits as a whole"),
        ("25 %", "100 %", "arrangement", 5, "behind it"),
        ("25 %", "140 %", "out-of-range", 5, "done"),
        ("done = \"25 %\"", "pieces = 4", "arrangement", 5, "behind it"),
        ("done = \"25 %\"", "done = \"25 %\"\npieces = 1", "arrangement", 6, "say the same"),
        ("since", "setup_left = \"5 min\"\nsince", "arrangement", 6, "setup in progress"),
        ("-2 h", "2 h", "arrangement", 6, "after the start"),
    ];
    for (from, to, code, place, words) in cases {
        let message = faults_of(&format!("{SHOP}{early}{}", WIP.replace(from, to)), &[]);
        assert!(
            message.iter().any(|(own, at, text)| *own == code && *at == line + place && text.contains(words)),
            "{to}: {message:#?}"
        );
    }
    let twice = only(faults_of(&format!("{SHOP}{early}{WIP}{WIP}"), &[]).into_iter().take(1).collect());
    assert!(twice.2.contains("is in two places"), "{twice:?}");
    let late = only(faults_of(&format!("{SHOP}{ORDER}{WIP}"), &[]));
    assert_eq!((late.0, late.1), ("arrangement", SHOP.lines().count() + 5));
    assert!(late.2.contains("released at 2026-03-30 06:00"), "{late:?}");
}

#[test]
fn impossible_calendars_are_told() {
    let cases = [
        ("mon-fri = [\"06:00-14:00\"]", "mon-fry = [\"06:00-14:00\"]", "no-date", "weekday"),
        ("\"06:00-14:00\"", "\"6-14\"", "no-date", "shift"),
        ("\"06:00-14:00\"", "\"06:00-14:00\", \"13:00-22:00\"", "shifts-overlap", "shift 2"),
        ("2026-04-02..2026-04-03", "2026-04-03..2026-04-02", "no-date", "holiday"),
        ("2026-04-02..2026-04-03", "2026-03-01..2026-05-03", "calendar-empty", "no working time"),
        ("holidays", "period = \"1 week\"\nholidays", "not-applicable", "week"),
    ];
    for (from, to, code, words) in cases {
        let message = faults_of(&format!("{SHOP}{ORDER}").replacen(from, to, 1), &[]);
        assert!(message.iter().any(|(own, _, text)| *own == code && text.contains(words)), "{to}: {message:#?}");
    }
}

#[test]
fn what_never_acts_or_stands_twice_is_told() {
    let operation =
        |more: &str| format!("{SHOP}{ORDER}").replace("work = \"5 min\"", &format!("work = \"5 min\", {more}"));
    let outcomes = "outcomes = [{ share = 0.1, scrap = true }], rework_max = 2";
    for (text, words) in [
        (operation("rework_max = 2"), "sends no parts back"),
        (operation(outcomes), "sends no parts back"),
        (operation("setup_time = \"1 min\"").replace("machines = \"saw\"", "machines = []"), "names no machine"),
        (
            format!(
                "{SHOP}{ORDER}{0}{0}",
                "[[schedule]]\norder = \"A\"\noperation = \"saw\"\nmachine = \"saw\"\nposition = 1\n"
            ),
            "planned twice",
        ),
        (
            format!(
                "{SHOP}{ORDER}{}{}{}",
                ORDER.replace("\"A\"", "\"B\""),
                "[[schedule]]\norder = \"A\"\noperation = \"saw\"\nmachine = \"saw\"\nposition = 1\n",
                "[[schedule]]\norder = \"B\"\noperation = \"saw\"\nmachine = \"saw\"\nposition = 1\n"
            ),
            "position 1 of machine \"saw\" stands twice",
        ),
    ] {
        let message = faults_of(&text, &[]);
        assert!(
            message.iter().any(|(code, _, text)| *code == "arrangement" && text.contains(words)),
            "{words}: {message:#?}"
        );
    }
}

/// Orders or faults of a table of orders beside the scenario.
fn of_table(table: &str) -> Result<Vec<toolroom_scenario::Order>, Vec<String>> {
    orders_read(table, "orders = \"orders.csv\"\n")
}

/// Orders or faults of a table that `[tables]` names so.
fn orders_read(table: impl AsRef<[u8]>, tables: &str) -> Result<Vec<toolroom_scenario::Order>, Vec<String>> {
    // One folder a table: tests run side by side.
    static NUMBER: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let number = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("toolroom-orders-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("shop.toml");
    std::fs::write(&path, format!("{SHOP}[tables]\n{tables}")).expect("written");
    let name = tables.split('"').nth(1).expect("a file");
    std::fs::write(folder.join(name), table).expect("written");
    let read = read(&path, &[]);
    std::fs::remove_dir_all(&folder).expect("removed");
    match read {
        Ok(file) => Ok(file.scenario.orders),
        Err(ReadError::Faults(list)) => Err(list.problems.iter().map(|problem| problem.fault.to_string()).collect()),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn points_between_the_digits_of_pieces_are_refused_once_and_told() {
    let message = of_table("id;part;quantity\nA;bar;1.062,00\nB;bar;40\n").expect_err("a number as people write it");
    assert_eq!(message.len(), 1, "{message:?}");
    assert!(message[0].contains("line 2: `quantity` is \"1.062,00\""), "{message:?}");
    assert_eq!(of_table("id;part;quantity\nA;bar;1062\n").expect("what was told")[0].quantity, 1062);
}

#[test]
fn a_table_is_read_like_sections() {
    let table = "id,part,quantity,release,due,customer\n# a remark\nA,bar,4,2026-03-30 06:00,2026-03-31,\n7,bar,,6 h,,\"north, inc\"\n";
    let orders = of_table(table).expect("a good table");
    let section = parse("dated.toml", &format!("{SHOP}{ORDER}"), &[]).unwrap().scenario.orders;
    assert_eq!(orders[0], section[0]);
    assert_eq!((orders[1].id.as_str(), orders[1].quantity, orders[1].customer.as_str()), ("7", 1, "north, inc"));
    assert_eq!(of_table(&table.replace(',', ";").replace("north; inc", "north, inc")).expect("semicolons"), orders);
}

#[test]
fn faults_of_a_table_name_file_line_and_column() {
    let message =
        of_table("id,part,quantity\nA,bar,4\nB,bra,0\nA,bar,x\n").expect_err("three bad cells and a name twice");
    assert_eq!(message.len(), 4, "{message:#?}");
    assert!(message.iter().any(|text| text.starts_with("orders.csv, line 3:") && text.contains("bra")), "{message:#?}");
    assert!(
        message.iter().any(|text| text.starts_with("orders.csv, line 3:") && text.contains("quantity")),
        "{message:#?}"
    );
    assert!(
        message.iter().any(|text| text.starts_with("orders.csv, line 4:") && text.contains("quantity")),
        "{message:#?}"
    );
    assert!(
        message.iter().any(|text| text.starts_with("orders.csv, line 4:") && text.contains("\"A\"")),
        "{message:#?}"
    );
    let message = of_table("id,prat\nA,bar\n").expect_err("a column that is none, and one that is missing");
    assert!(message.iter().any(|text| text.contains("no column \"prat\"")), "{message:#?}");
    assert!(message.iter().any(|text| text.contains("`part` is missing")), "{message:#?}");
    let message = of_table("id,part\nA,bar,4\n").expect_err("a cell too many");
    assert_eq!(message, ["orders.csv, line 2: the row has 3 cells, but the first line 2"]);
    let message = of_table("id;part;quantity\nA;bar;4\n\nB\nC;bar;5\n").expect_err("cells that are missing");
    assert_eq!(message, ["orders.csv, line 4: the row has 1 cell, but the first line 3"]);
}

#[test]
fn a_table_is_read_in_the_encoding_that_is_named() {
    let text = "id,part,customer\nA,bar,Müller & Söhne\n";
    let latin: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
    let wide: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let named = |encoding: &str| format!("orders = \"orders.csv\"\nencoding = \"{encoding}\"\n");
    let customer = |table: &[u8], tables: &str| orders_read(table, tables).expect("a good table")[0].customer.clone();
    let plain = "orders = \"orders.csv\"\n";
    for (table, tables) in [
        (text.as_bytes(), plain),
        (&latin, &named("latin-1")),
        (&latin, &named("windows-1252")),
        (&wide, &named("utf-16")),
        (&wide, plain), // its byte order mark tells
    ] {
        assert_eq!(customer(table, tables), "Müller & Söhne", "{tables}");
    }
    // The line and what can be done are told.
    let refused = |table: &[u8], tables: &str| orders_read(table, tables).expect_err("no letters").concat();
    assert_eq!(refused(&latin, plain), "orders.csv, line 2: the byte 0xFC is no letter of utf-8");
    assert!(refused(b"id,part\nA,bar\n\x80,bar\n", &named("latin-1")).starts_with("orders.csv, line 3: the byte 0x80"));
    assert!(refused(text.as_bytes(), &named("utf-8x")).contains("utf-8x"));
}

/// What the table of an order system says, read by a mapping.
fn of_mapped(table: &str, columns: &str) -> Result<Vec<toolroom_scenario::Order>, Vec<String>> {
    orders_read(table, &format!("orders = \"erp.csv\"\ncolumn = {columns}\n"))
}

#[test]
fn a_mapping_says_what_the_columns_of_an_order_system_are() {
    let columns = r#"[{ name = "id", from = "Auftrag" }, { name = "part", from = "Teil" },
        { name = "due", from = "Termin", format = "%d.%m.%Y", at = "14:00" }, { name = "quantity", from = "Menge" }]"#
        .replace('\n', " ");
    let table = "Auftrag;Status;Teil;Menge;Termin\n4711;offen;bar;4;1.4.2026\n4712;offen;bar;2;\n";
    let orders = of_mapped(table, &columns).expect("a good table");
    let day = 86_400.0;
    assert_eq!((orders[0].id.as_str(), orders[0].quantity, orders[0].due), ("4711", 4, 2.0 * day + 14.0 * 3600.0));
    assert_eq!(
        orders[1].due,
        2.0 * day,
        "an empty cell is a date that is left out: the flow allowance of the part counts"
    );
    let cases = [
        (table.replace("1.4.2026", "31.4.2026"), columns.clone(), "erp.csv, line 2: ", "31.4.2026"),
        (table.replace("Termin", "Liefertermin"), columns.clone(), "erp.csv, line 1: ", "no column \"Termin\""),
        (table.to_owned(), columns.replace("%Y", "%J"), "", "%d.%m.%J"),
        (table.to_owned(), columns.replace("14:00", "25:00"), "", "25:00"),
        (table.to_owned(), columns.replace("\"due\"", "\"duo\""), "", "duo"),
        (table.to_owned(), columns.replace("\"Menge\"", "\"Menge\", at = \"14:00\""), "", "column `quantity`"),
    ];
    for (table, columns, place, words) in cases {
        let message = of_mapped(&table, &columns).expect_err(words);
        assert!(message.iter().any(|each| each.starts_with(place) && each.contains(words)), "{words}: {message:#?}");
    }
}

proptest! {
    #[test]
    fn any_table_is_read_or_refused(table in "(id,part,quantity,release\n)?([A-Za-z0-9 ,;:\"\n.-]{0,80})") {
        let _ = of_table(&table);
    }
}

/// A machine that needs a setter and has a setup matrix.
const PEOPLE: &str = r#"
[[operator]]
name = "setter"
skills = ["setup"]
[[setup_matrix]]
name = "chucks"
groups = ["a", "b"]
times = [["1 min", "2 min"], ["0 min", "3 min"], ["4 min", "0 min"]]
[[machine]]
name = "lathe"
process = "plain"
setup_matrix = "chucks"
setup_at_start = "a"
[[part]]
name = "bolt"
operation = [{ name = "turn", machines = "lathe", work = "5 min", setup_group = "b", operator = { setup = "setup" } }]
"#;

#[test]
fn people_and_setup_matrices_are_read_and_their_faults_told() {
    let text = format!("{SHOP}{PEOPLE}{ORDER}");
    let scenario = parse("people.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let matrix = &scenario.setup_matrices[0];
    assert_eq!(matrix.first.as_deref(), Some([60.0, 120.0].as_slice()));
    assert_eq!(matrix.times, [[0.0, 180.0], [240.0, 0.0]]);
    assert_eq!(scenario.parts[1].operations[0].attendance.setup, Some(0));
    let cases = [
        ("{ setup = \"setup\" }", "{ setup = \"setpu\" }", "skill-nobody", "did you mean `setup`"),
        ("setup_group = \"b\"", "setup_group = \"c\"", "missing-pair", "\"c\""),
        (", [\"4 min\", \"0 min\"]]", "]", "", ""),
        ("[[\"1 min\", \"2 min\"], [\"0 min\", \"3 min\"], ", "[", "contradiction", "1 rows"),
        ("[\"4 min\", \"0 min\"]", "[\"4 min\"]", "contradiction", "1 entries"),
        ("groups = [\"a\", \"b\"]", "groups = [\"a\", \"a\"]", "duplicate-name", "setup group"),
        ("setup_at_start = \"a\"", "setup_at_start = \"d\"", "missing-pair", "\"d\""),
        ("setup_matrix = \"chucks\"", "setup_matrix = \"chuck\"", "unknown-name", "chucks"),
    ];
    for (from, to, code, words) in cases {
        assert!(text.contains(from), "{from}");
        let message = faults_of(&text.replacen(from, to, 1), &[]);
        if code.is_empty() {
            assert!(message.is_empty(), "a matrix without the row in front: {message:#?}");
        } else {
            assert!(message.iter().any(|(own, _, text)| *own == code && text.contains(words)), "{to}: {message:#?}");
        }
    }
}
