//! Arguments of `program`.

use clap::Args;
use std::path::PathBuf;
use std::sync::LazyLock;
use toolroom_planning::feeds::{FeedLimit, FeedObjective};
use toolroom_planning::program::drive_names;
use toolroom_program::{Dialect, Units};

/// What `--set` may change.
static SET: LazyLock<String> = LazyLock::new(|| format!("Replace a value of {}, repeatable", drive_names()));

/// What `--drives` takes.
static DRIVES: LazyLock<String> = LazyLock::new(|| {
    format!(
        "Machine that runs the program: a machine file, or one of the presets {}",
        toolroom_drives::PRESETS.join(", ")
    )
});

/// What `--limits` takes.
fn limits() -> Vec<&'static str> {
    std::iter::once("all").chain(FeedLimit::WORDS.iter().copied()).collect()
}

/// Languages that can be told; `auto`, as without the option, finds it from the words.
pub(crate) const READ: [&str; Dialect::NAMES.len() + 1] = {
    let mut names = ["auto"; Dialect::NAMES.len() + 1];
    let mut index = 0;
    while index < Dialect::NAMES.len() {
        names[index] = Dialect::NAMES[index];
        index += 1;
    }
    names
};

#[derive(Args, Debug)]
pub struct ProgramArgs {
    /// Part programs of machine tools, or folders of them: of one everything is told, of several a row of each
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Language of the program; found from its words where not given
    #[arg(long, value_name = "DIALECT", value_parser = READ)]
    pub dialect: Option<String>,
    /// Machine that runs it: a machine file, or a preset (see `toolroom schema machine`); without one no time is lost
    #[arg(long, value_name = "FILE|PRESET", long_help = DRIVES.as_str())]
    pub drives: Option<PathBuf>,
    #[arg(long, value_name = "KEY=VALUE", help = SET.as_str())]
    pub set: Vec<String>,
    /// Unit of lengths and feeds of a program that names none
    #[arg(long, value_name = "UNIT", value_parser = Units::NAMES)]
    pub units: Option<String>,
    /// Position of X, Y, Z at the start, such as "0,0,100 mm"; the other axes stand at 0 then
    #[arg(long, value_name = "POSITION", allow_hyphen_values = true)]
    pub start: Option<String>,
    /// Leave out blocks with this number of block skip (`/` is 1), repeatable
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=9))]
    pub skip: Vec<u8>,
    /// Diameter of a tool for the compensation of its radius, such as D1="10 mm", repeatable
    #[arg(long, value_name = "TOOL=DIAMETER")]
    pub tool: Vec<String>,
    /// Greatest number of blocks that may run
    #[arg(long, value_name = "COUNT", default_value_t = toolroom_program::Control::STEPS)]
    pub steps: u64,
    /// Write the motions for another control, to the file of --out
    #[arg(long, value_name = "DIALECT", value_parser = Dialect::WRITTEN, requires = "out")]
    pub post: Option<String>,
    /// Leave holes of canned cycles cycles of the control that --post writes for, where it has one of the same motions
    #[arg(long, requires = "post")]
    pub keep_cycles: bool,
    /// File of the program that --post writes
    #[arg(long, value_name = "FILE", requires = "post")]
    pub out: Option<PathBuf>,
    /// Stock and tools: the program is followed through its stock (see `toolroom schema program-setup`)
    #[arg(long, value_name = "FILE")]
    pub setup: Option<PathBuf>,
    /// Plan the feeds inside the limits of setup and parameter sets; --post writes the program with them
    #[arg(long, value_name = "OBJECTIVE", value_parser = FeedObjective::WORDS.to_vec(), requires = "setup")]
    pub objective: Option<String>,
    /// Plan the spindle speeds, too: one for every spindle command, among those of the machine of the tool's set
    #[arg(long, requires = "objective")]
    pub speeds: bool,
    /// Greatest number of motions of the plan over those of the program, from 1
    #[arg(long, value_name = "TIMES", requires = "objective", default_value_t = 3.0, value_parser = factor)]
    pub blocks_factor: f64,
    /// Limits that count, by commas, or all: without --objective how much of each the program uses
    #[arg(long, value_name = "LIMITS", value_delimiter = ',', value_parser = limits(), requires = "setup")]
    pub limits: Option<Vec<String>>,
    /// Table of every motion with its time, and with its engagement where there is a --setup (CSV)
    #[arg(long, value_name = "CSV")]
    pub motions: Option<PathBuf>,
    /// Report with pictures: the path coloured by load, feed, power, force and deflection over time, time by tool (HTML)
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Drawing of the path of the tool, a layer for every tool at feed and one for rapid motions (DXF)
    #[arg(long, value_name = "DXF")]
    pub drawing: Option<PathBuf>,
    /// End with an error where a rapid motion or the holder meets material, or a limit is broken
    #[arg(long, requires = "setup")]
    pub strict: bool,
    /// Table of every block (CSV)
    #[arg(long, value_name = "CSV")]
    pub blocks: Option<PathBuf>,
    /// Tell what this line of the file did: its motions, modes, variables and time
    #[arg(long, value_name = "LINE", value_parser = clap::value_parser!(u64).range(1..))]
    pub explain: Option<u64>,
}

impl ProgramArgs {
    /// The options that decide what is told of a program, as they have to be typed.
    pub fn words(&self) -> Vec<String> {
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        let limits = self.limits.as_ref().map(|limits| limits.join(","));
        let single = [
            ("--setup", path(&self.setup)),
            ("--drives", path(&self.drives)),
            ("--dialect", self.dialect.clone()),
            ("--units", self.units.clone()),
            ("--start", self.start.clone()),
            ("--objective", self.objective.clone()),
            ("--limits", limits),
        ];
        let single = single.into_iter().filter_map(|(option, value)| Some((option, value?)));
        let repeated = [("--set", &self.set), ("--tool", &self.tool)];
        let repeated =
            repeated.into_iter().flat_map(|(option, list)| list.iter().map(move |value| (option, value.clone())));
        let skip = self.skip.iter().map(|number| ("--skip", number.to_string()));
        single
            .chain(repeated)
            .chain(skip)
            .flat_map(|(option, value)| [option.to_owned(), value])
            .chain(self.speeds.then(|| "--speeds".to_owned()))
            .chain((self.blocks_factor != 3.0).then(|| format!("--blocks-factor={}", self.blocks_factor)))
            .collect()
    }
}

/// A number of motions over another, from 1 to 1000.
fn factor(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (1.0..=1000.0).contains(number));
    number.ok_or_else(|| "a number from 1 to 1000 is needed, such as 3".to_owned())
}
