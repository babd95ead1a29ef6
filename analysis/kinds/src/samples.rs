//! What `toolroom new KIND DIR` writes: a commented example of each kind, with sample data. A plan of shards
//! holds the version of its program, so its example is made when it is wanted.

use std::path::Path;
use std::sync::LazyLock;
use toolroom_life::file::StudyText;
use toolroom_life::study::shard;

/// Files to begin with.
#[derive(Debug)]
pub struct Sample {
    /// Name and text of each file; the first is of the kind.
    pub files: &'static [(&'static str, &'static str)],
    /// Commands that take them, as typed in their folder.
    pub next: &'static [&'static str],
}

/// The example of each kind but plans, by the word of the kind.
pub(crate) static SAMPLES: &[(&str, &Sample)] = &[
    ("scenario", &SCENARIO),
    ("effects", &EFFECTS),
    ("structure", &STRUCTURE),
    ("coefficients", &COEFFICIENTS),
    ("tool", &TOOL),
    ("lobes", &LOBES),
    ("life", &LIFE),
    ("cycle", &CYCLE),
    ("contour", &CONTOUR),
    ("setup", &SETUP),
    ("program-setup", &PROGRAM_SETUP),
    ("mapping", &MAPPING),
    ("shop-mapping", &SHOP_MAPPING),
    ("gap", &GAP),
    ("machine", &MACHINE),
    ("parameter-set", &PARAMETER_SET),
    ("diagnosis", &DIAGNOSIS),
    ("records", &RECORDS),
];

/// A study of tool lives in two shards. Few lives: it shows how a plan is run, and is no basis of a decision.
pub(crate) fn plan() -> &'static Sample {
    static PLAN: LazyLock<Sample> = LazyLock::new(|| {
        let planned = || -> Result<String, Box<dyn std::error::Error>> {
            let changes = vec!["lives=2000".to_owned()];
            let text = StudyText::open(Path::new("builtin:policies"))?;
            let file = text.parse(&changes)?;
            let plan = shard::plan(env!("CARGO_PKG_VERSION"), text, &file, changes, Some(2))?;
            Ok(serde_json::to_string_pretty(&plan)? + "\n")
        };
        let text = planned().expect("a shipped study can be planned, which a test asks");
        // One text for the life of the program.
        let files: &[_] = Box::leak(Box::new([("plan.json", &*Box::leak(text.into_boxed_str()))]));
        Sample {
            files,
            next: &[
                "toolroom check plan.json",
                "toolroom shard plan.json 0 --out parts",
                "toolroom shard plan.json 1 --out parts",
                "toolroom merge parts --out lives",
            ],
        }
    });
    &PLAN
}

/// A file of the scenarios, by its path there.
macro_rules! scenarios {
    ($path:literal) => {
        include_str!(concat!("../../../scenarios/", $path))
    };
}

static SCENARIO: Sample = Sample {
    files: &[("scenario.toml", scenarios!("template.toml"))],
    next: &["toolroom check scenario.toml", "toolroom compare scenario.toml"],
};

static EFFECTS: Sample = Sample {
    files: &[("effects.toml", scenarios!("new/effects.toml"))],
    next: &[
        "toolroom effects --context",
        "toolroom check effects.toml",
        "toolroom point turning --effects effects.toml --effect my.crater=0.1 --set \"flank_wear=0.2 mm\"",
    ],
};

static STRUCTURE: Sample = Sample {
    files: &[
        ("structure.toml", scenarios!("chatter/spindle.toml")),
        ("endmill12.toml", scenarios!("chatter/endmill12.toml")),
    ],
    next: &["toolroom swap structure.toml --tool endmill12.toml --out structure-d12.toml"],
};

static COEFFICIENTS: Sample = Sample {
    files: &[
        ("al7075.toml", scenarios!("new/coefficients.toml")),
        ("side-milling.toml", scenarios!("chatter/side-milling.toml")),
        ("slot.csv", scenarios!("data/slot-al7075.csv")),
    ],
    next: &[
        "toolroom lobes side-milling.toml",
        "toolroom coefficients slot.csv --teeth 2 --depth \"2 mm\" --out measured.toml",
        "toolroom lobes side-milling.toml --set force.coefficients=measured.toml --at \"8000 rpm\" \"1.5 mm\"",
    ],
};

static TOOL: Sample = Sample {
    files: &[("tool.toml", scenarios!("chatter/endmill12.toml")), ("spindle.toml", scenarios!("chatter/spindle.toml"))],
    next: &["toolroom swap spindle.toml --tool tool.toml --out structure-d12.toml"],
};

static LOBES: Sample = Sample {
    files: &[("chart.toml", scenarios!("chatter/milling-slot.toml"))],
    next: &["toolroom lobes chart.toml", "toolroom lobes chart.toml --at \"5000 rpm\" \"0.5 mm\""],
};

static LIFE: Sample =
    Sample { files: &[("study.toml", scenarios!("life/policies.toml"))], next: &["toolroom life study.toml"] };

static CYCLE: Sample =
    Sample { files: &[("cycle.toml", scenarios!("grinding/cycle.toml"))], next: &["toolroom grind cycle.toml"] };

static CONTOUR: Sample =
    Sample { files: &[("contour.toml", scenarios!("contour/rk3.toml"))], next: &["toolroom contour contour.toml"] };

static SETUP: Sample = Sample {
    files: &[("setup.toml", scenarios!("new/setup.toml")), ("part.nc", scenarios!("new/part.nc"))],
    next: &["toolroom contour setup.toml --gcode part.nc"],
};

static PROGRAM_SETUP: Sample = Sample {
    files: &[("setup.toml", scenarios!("programs/plate-setup.toml")), ("plate.nc", scenarios!("programs/plate.nc"))],
    next: &["toolroom program plate.nc --setup setup.toml"],
};

static MAPPING: Sample = Sample {
    files: &[("map.toml", scenarios!("new/map.toml")), ("log.csv", scenarios!("new/log.csv"))],
    next: &["toolroom import csv log.csv --map map.toml --out records"],
};

static SHOP_MAPPING: Sample = Sample {
    files: &[
        ("map.toml", scenarios!("new/shop/map.toml")),
        ("base.toml", scenarios!("new/shop/base.toml")),
        ("orders.csv", scenarios!("new/shop/orders.csv")),
        ("routings.csv", scenarios!("new/shop/routings.csv")),
        ("machines.csv", scenarios!("new/shop/machines.csv")),
        ("people.csv", scenarios!("new/shop/people.csv")),
    ],
    next: &[
        "toolroom import shop --map map.toml --out shop.toml --check",
        "toolroom run shop.toml",
        "toolroom compare shop.toml",
    ],
};

static GAP: Sample = Sample {
    files: &[
        ("turning.toml", scenarios!("gap/turning.toml")),
        ("map.toml", scenarios!("new/map.toml")),
        ("log.csv", scenarios!("new/log.csv")),
    ],
    next: &[
        "toolroom import csv log.csv --map map.toml --out records",
        "toolroom gap diagnose --model turning.toml --data records --out gap",
        "toolroom gap apply --model turning.toml --diagnosis gap/diagnosis.json --out better.toml",
    ],
};

static MACHINE: Sample = Sample {
    files: &[("machine.toml", scenarios!("machines/vmc.toml")), ("plate.nc", scenarios!("programs/plate.nc"))],
    next: &["toolroom program plate.nc --drives machine.toml"],
};

/// What `gap diagnose` answers of the records of [`GAP`].
static DIAGNOSIS: Sample = Sample {
    files: &[("diagnosis.json", scenarios!("new/diagnosis.json")), ("turning.toml", scenarios!("gap/turning.toml"))],
    next: &["toolroom gap apply --model turning.toml --diagnosis diagnosis.json --out better.toml"],
};

static RECORDS: Sample = Sample {
    files: &[("operations.csv", scenarios!("new/wear.csv"))],
    next: &[
        "toolroom check operations.csv",
        "toolroom calibrate turning --model c45_t15k6 --data operations.csv --limit \"0.3 mm\" --out my.toml",
    ],
};

static PARAMETER_SET: Sample = Sample {
    files: &[("set.toml", scenarios!("parameters/own/our-42crmo4.toml")), ("wear.csv", scenarios!("new/wear.csv"))],
    next: &[
        "toolroom point turning --tool ./set.toml --set cutting_speed=\"200 m/min\"",
        "toolroom calibrate turning --model c45_t15k6 --data wear.csv --limit \"0.3 mm\" --out my.toml",
    ],
};
