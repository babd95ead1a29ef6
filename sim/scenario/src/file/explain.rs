//! Longer texts for the codes of faults.

/// Every code that [`Fault::code`](super::Fault::code) returns, with its explanation.
pub const CODES: &[(&str, &str)] = &[
    (
        "syntax",
        "The file is not TOML. Text stands in quotes, lists in brackets, one `key = value` stands on a line, and `[[machine]]` (two brackets) opens one of several entries. Nothing else is checked until the file is TOML.",
    ),
    ("schema", "`schema` is the version of the file format. This program reads version 1."),
    (
        "unknown-key",
        "The section has no such key. Keys are never ignored, because a mistyped key would silently leave its default in force. `toolroom schema` prints every key; editors use that schema for completion.",
    ),
    ("missing-key", "The key has no default, because a wrong guess would change the result."),
    (
        "not-applicable",
        "The key belongs to another variant of the section: `interval` says nothing about a Poisson source. It is refused because it would be without effect.",
    ),
    (
        "wrong-type",
        "The value is of another kind than the key takes, such as a bare number where a quantity with its unit is due.",
    ),
    (
        "quantity",
        "A quantity is a number with its unit in quotes: \"60 m/min\", \"0.12 mm/rev\", \"1.5 min\". Units of the same dimension are converted (\"2.4 in\" is a length); a unit of another dimension is refused. Decimals take a point. Ratios may stand without unit or in \"%\".",
    ),
    (
        "out-of-range",
        "The number is outside the range in which the value makes sense, or is not finite. The usual cause is a slip of the unit: mm for um, m/s for m/min.",
    ),
    ("unknown-choice", "The key takes one word of a list, which the message and `toolroom schema` give."),
    (
        "unknown-name",
        "The name refers to an entry (machine, tool, part, calendar, parameter set) that is not there. Names are compared letter by letter, case included.",
    ),
    (
        "duplicate-name",
        "Names tell entries apart in references and tables, so each occurs once. `count = 3` makes three machines L1, L2, L3 of one entry.",
    ),
    ("nothing-there", "A shop needs at least one machine, tool, part, source of arrivals and policy."),
    (
        "unused-tool",
        "No operation uses the tool. That is nearly always a mistyped name in an operation; otherwise remove the tool.",
    ),
    (
        "wrong-process",
        "A turning tool runs on turning machines, a milling cutter on milling machines, a wheel on infeed machines.",
    ),
    (
        "no-machine",
        "None of the machines listed for the operation exists with the process of its tool, so its jobs would wait for ever.",
    ),
    ("no-operation", "A part needs at least one [[part.operation]]."),
    (
        "mixed-currency",
        "Amounts of different currencies cannot be added. `shop.currency` says which one the file uses; nothing is converted.",
    ),
    (
        "shifts-overlap",
        "The shifts of a calendar are in order, do not overlap and end within its period. A night shift over midnight is written as two.",
    ),
    ("contradiction", "Each of the two values may stand alone, but not both together."),
    (
        "parameter-set",
        "The constants of a tool and work material come from a named parameter set. `toolroom schema` and the manual list them; `parameters` in a tool changes single constants.",
    ),
    (
        "file",
        "An operation may take its cycle or contour from a file of its own. Its path counts from the folder of the scenario file.",
    ),
    (
        "cycle",
        "No rough, finish and spark-out cycle keeps all the limits on this wheel: the message names those that conflict. Policies that design for a duller wheel need wider limits than the dressed one. `toolroom grind` shows a cycle file by itself.",
    ),
    (
        "part-program",
        "A part program named in the file has a block whose time cannot be told: a subprogram, a variable, a motion at feed without F, an arc that misses its end. `toolroom program` reads it by itself.",
    ),
    (
        "contour",
        "The contour file is at fault, is drawn for another cutter than the tool, or has a section that no spindle speed and feed of this machine can mill within its limits; the message names the section and the limits that conflict. `toolroom contour` shows a contour file by itself.",
    ),
    (
        "policy",
        "The work itself can be planned, but not as this policy asks: a cycle designed for a duller wheel may have no solution within the limits, a contour no handbook regime.",
    ),
    (
        "structure",
        "The vibration modes around a cut come from a lobes file, named from the folder of the scenario. `toolroom lobes FILE` draws it and tells its faults with their places.",
    ),
    (
        "unit",
        "An FMI unit can stand in for turning or milling where it has a Co-Simulation interface, a library for this computer and an input for the cutting speed. `toolroom fmu check` says what is wrong with a unit, docs/guide/fmu-import.md how it is wired.",
    ),
    ("beside", "Two keys of which only one can be followed; the message says which one to remove and why."),
    ("model", "The process model refuses the value: it is outside the range for which its equations hold."),
    (
        "effect",
        "Effects are named by their id, with a size in the unit of the catalogue; `toolroom effects` lists them. Each acts on some processes only and is given at most once with one shape and scope; entries whose scopes meet in an operation multiply their factors and add their summands in the order of the file.",
    ),
    (
        "scope-name",
        "A scope names machines, tools, parts and operations of the scenario; lots, shifts, materials, operators, coolants and edges are named as the records name them and are not checked.",
    ),
    (
        "date-without-start",
        "A scope counts `from` and `until` from the start of the scenario, which has no date: write \"12 day\" or \"36 h\".",
    ),
    (
        "calibration",
        "A calibration moves a constant of the process of a tool (`parameter = \"force.specific_force\"`, `target = \"tool insert\"`), or a value of the shop; the moved value stays within the range of the constant.",
    ),
    (
        "override",
        "`--set` takes a path to a value and the value: `--set machine.L1.tool_change_time=\"1 min\"`. Entries of a list are called by name, or by number from 1.",
    ),
];

/// The explanation of a code.
///
/// ```
/// assert!(toolroom_scenario::file::explain("quantity").unwrap().contains("m/min"));
/// ```
pub fn explain(code: &str) -> Option<&'static str> {
    CODES.iter().find(|(known, _)| *known == code).map(|(_, text)| *text)
}
