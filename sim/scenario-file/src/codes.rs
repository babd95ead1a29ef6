//! Longer texts for the codes of faults that only scenarios have.

/// Every code of a [`ScenarioFault`](super::ScenarioFault), with its explanation.
pub const CODES: &[(&str, &str)] = &[
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
        "shifts-overlap",
        "The shifts of a calendar are in order, do not overlap and end within its period. A night shift over midnight is written as two.",
    ),
    (
        "schedule-cycle",
        "A machine that follows a schedule waits for the next operation of its sequence, whatever else is there. Where the sequences of several machines wait for each other in a circle, as when A comes before B on one machine and after it on another in the other order of their routings, none of them can ever begin. The message names the circle: each operation comes before the next, by the sequence of its machine or the routing of its order.",
    ),
    (
        "parameter-set",
        "The constants of a tool and work material come from a parameter set: the name of a shipped one, or the path of a file of your own, which has a / or ends in .toml and counts from the file that names it. `toolroom check SET.toml` lists every value with where it comes from, `toolroom schema parameter-set` the keys. What a file states goes before what its [handbook] constants give, and both go before the set of `based_on`. `parameters` in a tool changes single constants.",
    ),
    (
        "cycle",
        "No rough, finish and spark-out cycle keeps all the limits on this wheel: the message names those that conflict. Policies that design for a duller wheel need wider limits than the dressed one. `toolroom grind` shows a cycle file by itself.",
    ),
    (
        "contour",
        "The contour file is at fault, is drawn for another cutter than the tool, or has a section that no spindle speed and feed of this machine can mill within its limits; the message names the section and the limits that conflict. `toolroom contour` shows a contour file by itself.",
    ),
    (
        "program",
        "The part program is refused, its setup is at fault, or the setup's tools are not those of the shop: a [[tool]] of the setup wears the edges of the scenario's milling tool of the same name, diameter and number of teeth. `toolroom program FILE --setup SETUP` shows a program by itself.",
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
        "believed-model",
        "Policies find speeds, and predict when an edge is due, on a model of tool and work. A native tool has its parameter set for that; an imported unit tells nobody its parameters. `believed_model` in [[policy]] names the parameter set that the policy plans on; it need not be the truth. Speeds as programmed or given (`programmed`, `constant` with `cutting_speed`) need none.",
    ),
    (
        "unit",
        "An FMI unit can stand in for turning or milling where it has a Co-Simulation interface, a library for this computer and an input for the cutting speed. `toolroom fmu check` says what is wrong with a unit, docs/guide/fmu-import.md how it is wired.",
    ),
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
        "Dates count from the start of the scenario, which has none: write `start = \"2026-03-30 00:00\"` in [shop], or the time since the start, \"12 day\" or \"36 h\". The `from` and `until` of a scope always are such times.",
    ),
    (
        "no-date",
        "Dates are written \"2026-03-30\" or \"2026-03-30 06:00\", times of the day \"06:00\", shifts and breaks \"06:00-14:00\", holidays \"2026-04-03\" or \"2026-08-03..2026-08-14\", overtime \"2026-04-04 06:00-10:00\". They are local wall-clock time without zone and without daylight saving.",
    ),
    (
        "calendar-empty",
        "Nothing that has this calendar could ever work: its `week` has no shifts, or holidays take all of them out, and there is no overtime before the horizon.",
    ),
    (
        "order-beyond-horizon",
        "An order that is released before second 0 or after the horizon would silently be missing from the results. `start` in [shop] is the date of second 0, `horizon` the length of the run. What is in the shop at the start is said by a [[wip]], and may then be released before.",
    ),
    (
        "skill-nobody",
        "A step that needs a skill waits for somebody who has it. Skills are words of your own: those under `skills` of an [[operator]].",
    ),
    (
        "missing-pair",
        "A machine with a setup matrix takes every setup time from it, so that every setup group of its operations, and of `setup_at_start`, needs a row and a column. A machine that stands ready for nothing at the start (`setup_at_start = \"\"`) needs the row in front; one whose `setup_at_start` is left out stands ready for whatever comes first, so that its first setup costs nothing.",
    ),
    (
        "table-cell",
        "A row of a table that the scenario names under [tables] is at fault. The message names file, line and column; the keys are those of the section in the scenario, the first line names them.",
    ),
    (
        "draws",
        "`parameters_from` names draws of a posterior, a Parquet table that `toolroom calibrate --data` writes beside the set: a column `group.parameter [unit]` for each parameter of the process, `edge_scatter`, `law` and `weight`. The parameter set of the tool has the same wear law, `parameters` states none of the same values, and all draws have the same weight. Each replication takes one draw, the same under every policy; policies believe the set. docs/calibration.md shows the way.",
    ),
    (
        "fitted-law",
        "`distribution = \"fitted\"` takes a law of lives from the `summary.json` that `toolroom life` writes: `from` is its path from this file, `law` one of the laws under `fits`, `group` one of its groups. Lives are in a unit of time there, such as `life [min]`: cuts and parts are no time.",
    ),
    (
        "buffer-loop",
        "With blocking before service a machine begins only when a place for its part is reserved further on. Where two operations in a row share their only place, none is ever free: the part itself stands in it. A buffer with a place more, or blocking after service, lets it move.",
    ),
    (
        "buffer-lot",
        "A limited buffer takes jobs as a whole: parts of a source, or an order that moves together. An order with `transfer`, or one whose parts are cut piece by piece, moves in several jobs that wait for each other before an operation, and could fill the places that the rest of it needs.",
    ),
    (
        "arrangement",
        "What the flow of jobs is asked to do contradicts itself, could never work, or is not modelled together: batches of machines that also work on single jobs, an inspection that sends parts forward, a part that goes into itself or needs one that nobody makes, preemption in queues that do not go by priority. docs/guide/shops.md says what goes together.",
    ),
    (
        "calibration",
        "A calibration moves a constant of the process of a tool (`parameter = \"force.specific_force\"`, `target = \"tool insert\"`), or a value of the shop; the moved value stays within the range of the constant.",
    ),
];
