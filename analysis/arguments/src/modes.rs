//! Arguments of `toolroom modes`, `swap`, `listen` and `coefficients`.

use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, disable_help_subcommand = true)]
pub struct ModesArgs {
    #[command(subcommand)]
    pub verb: Option<ModesVerb>,
    /// Frequency responses: a table (CSV) with units in its header, or a universal file (58, 58b); or hits over time: a table
    /// with time [s], force [N] and acceleration [m/s2], or a WAV file with --scale
    #[arg(required = true)]
    pub file: Option<PathBuf>,
    /// Coherence in a file of its own: a table with frequency [Hz] and coherence, or a universal file
    #[arg(long, value_name = "FILE")]
    pub coherence: Option<PathBuf>,
    /// Averages behind each response; left out, the residuals of the fit tell the noise
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub averages: Option<u32>,
    /// Direction of a measurement in one direction: feed, normal, or an angle from the feed such as "30 deg"
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true)]
    pub direction: Option<String>,
    /// Number of modes, instead of all that stand out of the noise
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=40), conflicts_with = "pick")]
    pub modes: Option<u32>,
    /// Frequency of a mode, such as "612 Hz", repeatable: these modes and no others
    #[arg(long, value_name = "FREQUENCY")]
    pub pick: Vec<String>,
    #[command(flatten)]
    pub taps: TapArgs,
    /// What changes from mounting to mounting, relative: f=SHARE, zeta=SHARE or k=SHARE, repeatable
    #[arg(long, value_name = "KEY=SHARE")]
    pub scatter: Vec<String>,
    /// Structure file to write
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Directory of tables, pictures and the report
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Write a structure file even where the fit must not be used
    #[arg(long)]
    pub accept_refused: bool,
    /// Say what the file holds, and fit nothing
    #[arg(long, conflicts_with_all = ["out", "report"])]
    pub read: bool,
    /// As `modes update`: cuts that bring the structure file up to date
    #[arg(long, value_name = "FILE", requires = "lobes", conflicts_with_all = ["read", "report"])]
    pub cuts: Option<PathBuf>,
    /// As `modes update`: machine of the records whose cuts count
    #[arg(long, value_name = "NAME", requires = "cuts")]
    pub machine: Option<String>,
    /// As `modes update`: lobes file of these cuts
    #[arg(long, value_name = "FILE", requires = "cuts")]
    pub lobes: Option<PathBuf>,
    /// As `modes update`: relative standard deviation of the cutting-force coefficients
    #[arg(long, value_name = "SHARE", requires = "cuts", default_value_t = 0.15)]
    pub coefficients: f64,
    /// As `modes update`: particles
    #[arg(long, value_name = "COUNT", requires = "cuts", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(64..=1_000_000))]
    pub particles: u32,
}

#[derive(Subcommand, Clone, Debug)]
pub enum ModesVerb {
    /// Bring the modes of a structure file up to date by cuts of the shop that chattered or did not
    #[command(before_help = "Examples:
  toolroom modes update spindle3-d12.toml --cuts cuts.csv --lobes chart.toml --out new.toml
  toolroom modes update spindle3-d12.toml --cuts out/records/cuts.csv --machine M1 --lobes chart.toml")]
    Update(ModesUpdateArgs),
}

#[derive(Args, Clone, Debug)]
pub struct ModesUpdateArgs {
    /// Structure file with what is known of the modes
    pub file: PathBuf,
    /// Cuts of the shop that chattered or did not (CSV), or records of a run
    #[arg(long, value_name = "FILE")]
    pub cuts: PathBuf,
    /// Machine of the records whose cuts count
    #[arg(long, value_name = "NAME")]
    pub machine: Option<String>,
    /// Lobes file with cutter, engagement and force of these cuts
    #[arg(long, value_name = "FILE")]
    pub lobes: PathBuf,
    /// Relative standard deviation of the cutting-force coefficients of that file
    #[arg(long, value_name = "SHARE", default_value_t = 0.15)]
    pub coefficients: f64,
    /// Particles that go from what is known to what the cuts say
    #[arg(long, value_name = "COUNT", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(64..=1_000_000))]
    pub particles: u32,
    /// Structure file to write
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

impl ModesArgs {
    /// What brings a structure file up to date, where that is wanted.
    pub fn update(&self) -> Option<ModesUpdateArgs> {
        let Some(ModesVerb::Update(update)) = &self.verb else {
            let (cuts, lobes) = (self.cuts.clone()?, self.lobes.clone()?);
            let Self { coefficients, particles, .. } = *self;
            let (file, machine, out) = (self.file.clone()?, self.machine.clone(), self.out.clone());
            return Some(ModesUpdateArgs { file, cuts, machine, lobes, coefficients, particles, out });
        };
        Some(update.clone())
    }

    /// The file; without one there is a verb.
    pub fn file(&self) -> &Path {
        self.file.as_deref().unwrap_or(Path::new(""))
    }

    /// Scatter and coherence as they have to be typed.
    pub fn typed(&self) -> Vec<String> {
        let scattered = self.scatter.iter().flat_map(|change| ["--scatter".to_owned(), change.clone()]);
        let coherence = self.coherence.iter().flat_map(|path| ["--coherence".to_owned(), path.display().to_string()]);
        scattered.chain(coherence).collect()
    }
}

impl ModesUpdateArgs {
    /// What changes the result beside the files, as it has to be typed.
    pub fn typed(&self) -> Vec<String> {
        let numbers = [("--coefficients", self.coefficients.to_string()), ("--particles", self.particles.to_string())];
        let machine = self.machine.iter().map(|name| ("--machine", name.clone()));
        numbers.into_iter().chain(machine).flat_map(|(flag, value)| [flag.to_owned(), value]).collect()
    }
}

// How responses are made of hits over time. A doc comment would become the help of the verbs.
#[derive(Args, Debug)]
pub struct TapArgs {
    /// How responses are estimated from hits over time: h1, h2 or hv
    #[arg(long, value_name = "NAME")]
    pub estimator: Option<String>,
    /// Highest frequency that every hit has to excite, such as "2000 Hz"
    #[arg(long, value_name = "FREQUENCY")]
    pub highest: Option<String>,
    /// Full scale of a channel of a WAV file, one for each in their order: "force=500 N", "acceleration=50 g"
    #[arg(long, value_name = "NAME=VALUE")]
    pub scale: Vec<String>,
}

impl TapArgs {
    /// Estimator, highest frequency and full scales, as they were typed.
    pub fn parts(&self) -> (Option<&str>, Option<&str>, &[String]) {
        (self.estimator.as_deref(), self.highest.as_deref(), &self.scale)
    }
}

#[derive(Args, Debug)]
pub struct ImportFrfArgs {
    /// Frequency responses or hits over time, as `toolroom modes` reads them
    pub file: PathBuf,
    /// Coherence in a file of its own: a table with frequency [Hz] and coherence, or a universal file
    #[arg(long, value_name = "FILE")]
    pub coherence: Option<PathBuf>,
    #[command(flatten)]
    pub taps: TapArgs,
    /// Table (CSV) of the responses in um/N with their coherence to write
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct SwapArgs {
    /// Structure file of the spindle at its face, each mode with its rotation; with --blank, taps of a blank in the spindle: a
    /// table or universal file with 11 (xx), 21 (yx) and better 22 (yy), of the tip and of a second point
    pub base: PathBuf,
    /// The blank that was tapped, outside of the spindle: a material, diameter and length such as "steel d=16 mm L=40 mm"
    #[arg(long, value_name = "BLANK", requires = "second")]
    pub blank: Option<String>,
    /// Distance of the second tapped point of the blank from its tip
    #[arg(long, value_name = "LENGTH", requires = "blank")]
    pub second: Option<String>,
    /// Averages behind each function of the taps
    #[arg(long, value_name = "COUNT", requires = "blank", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub averages: Option<u32>,
    /// Direction of the taps: feed, normal, or an angle from the feed such as "30 deg"
    #[arg(long, value_name = "DIRECTION", requires = "blank")]
    pub direction: Option<String>,
    /// Tool file: segments from the tip on, and the joint
    #[arg(long, value_name = "FILE")]
    pub tool: PathBuf,
    /// Responses of the same tool on the same spindle, measured: both are compared
    #[arg(long, value_name = "FILE")]
    pub measured: Option<PathBuf>,
    /// Find the springs of the joint with which the prediction is nearest to --measured
    #[arg(long, requires = "measured")]
    pub fit_joint: bool,
    /// Replace a value of the tool file: segment.1.length="30 mm", repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// First and last frequency at which the tip is computed
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], default_values = ["50 Hz", "6000 Hz"])]
    pub range: Vec<String>,
    /// Structure file to write
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Directory of tables, pictures and the report
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Write a structure file even where the fit must not be used
    #[arg(long)]
    pub accept_refused: bool,
}

#[derive(Args, Debug)]
pub struct ListenArgs {
    /// Sound of a milling cut: WAV, or a table (CSV) with time [s] and sound [Pa] or acceleration [g]; its first channel
    pub record: PathBuf,
    /// Teeth of the cutter
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=200))]
    pub teeth: u32,
    /// Spindle speed as commanded, such as "7500 rpm"; the true one is found within 3 %
    #[arg(long, value_name = "SPEED")]
    pub speed: String,
    /// Sound at the same speed without cutting: its lines are the machine's
    #[arg(long, value_name = "FILE")]
    pub air: Option<PathBuf>,
    /// Lobes file of the cut: modes, range of speeds, and limits at the quiet ones
    #[arg(long, value_name = "FILE")]
    pub lobes: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct CoefficientsArgs {
    /// Mean forces on the tool over the feed: a table (CSV) with feed_per_tooth [mm], mean_force_x [N], mean_force_y [N] and
    /// mean_force_z [N]; x along the feed, y normal to it, z along the axis
    #[arg(required_unless_present_any = ["group", "list"], conflicts_with_all = ["group", "list"])]
    pub file: Option<PathBuf>,
    /// Teeth of the cutter
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=200))]
    pub teeth: Option<u32>,
    /// Axial depth of cut, such as "2 mm"
    #[arg(long, value_name = "DEPTH")]
    pub depth: Option<String>,
    /// Radial width of cut over diameter; a slot is 1
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    pub immersion: f64,
    /// Conventional (up) milling instead of climb (down) milling
    #[arg(long)]
    pub up: bool,
    /// Columns that act on the tool along feed, normal and axis, with their signs; x,y,z if left out. Forces on the work:
    /// --axes=-x,-y,-z
    #[arg(long, value_name = "AXES", allow_hyphen_values = true)]
    pub axes: Option<String>,
    /// Number of a group of work materials (VDI 3323) instead of a test; see --list
    #[arg(long, value_name = "NUMBER", conflicts_with = "list")]
    pub group: Option<u32>,
    /// Chip thickness at which the specific cutting force of the group is taken
    #[arg(long, value_name = "LENGTH", default_value = "0.1 mm")]
    pub chip_thickness: String,
    /// Radial over tangential coefficient of the group, 0.4 if left out
    #[arg(long, value_name = "RATIO", requires = "group")]
    pub radial_ratio: Option<f64>,
    /// List the groups of work materials with their specific cutting forces
    #[arg(long)]
    pub list: bool,
    /// Coefficient file to write
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

impl SwapArgs {
    /// What changes the tip, as it has to be typed.
    pub fn typed(&self) -> impl Iterator<Item = String> {
        let averages = self.averages.map(|averages| averages.to_string());
        let measured = self.measured.as_ref().map(|path| path.display().to_string());
        let options = [
            ("--blank", self.blank.clone()),
            ("--second", self.second.clone()),
            ("--averages", averages),
            ("--direction", self.direction.clone()),
            ("--measured", measured),
        ];
        let given = options.into_iter().filter_map(|(flag, value)| Some([flag.to_owned(), value?])).flatten();
        let set = self.set.iter().flat_map(|change| ["--set".to_owned(), change.clone()]).collect::<Vec<_>>();
        given.chain(self.fit_joint.then(|| "--fit-joint".to_owned())).chain(set)
    }
}
