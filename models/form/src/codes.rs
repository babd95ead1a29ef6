//! Longer texts for the codes of faults that every kind of file can have.

/// Every code of a [`Fault`](crate::Fault) of this crate, with its explanation.
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
        "mixed-currency",
        "Amounts of different currencies cannot be added. `shop.currency` says which one the file uses; nothing is converted.",
    ),
    ("contradiction", "Each of the two values may stand alone, but not both together."),
    (
        "file",
        "An operation may take its cycle or contour from a file of its own. Its path counts from the folder of the scenario file.",
    ),
    ("beside", "Two keys of which only one can be followed; the message says which one to remove and why."),
    ("model", "The process model refuses the value: it is outside the range for which its equations hold."),
    (
        "override",
        "`--set` takes a path to a value and the value: `--set machine.L1.tool_change_time=\"1 min\"`. Entries of a list are called by name, or by number from 1.",
    ),
];
