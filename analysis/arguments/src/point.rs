//! One operating point.

use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct PointArgs {
    /// Process
    pub process: PointProcess,
    /// Parameter set of tool and work material, by name or path; the process's default, if left out
    #[arg(long, value_name = "SET")]
    pub tool: Option<String>,
    /// Input, state or group.parameter with its unit, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Effect switched on, id=size, repeatable
    #[arg(long, value_name = "ID=SIZE")]
    pub effect: Vec<String>,
    /// File of effects of your own, beside those of the catalogue, repeatable
    #[arg(long, value_name = "EFFECTS.toml")]
    pub effects: Vec<PathBuf>,
    /// Hold the input for this time first
    #[arg(long, value_name = "TIME")]
    pub advance: Option<String>,
    /// Tool body in the life of turning: warm at once, or warming up
    #[arg(long, value_enum, default_value_t = PointLife::QuasiSteady)]
    pub life_model: PointLife,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub enum PointProcess {
    Turning,
    Milling,
    Infeed,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
#[value(rename_all = "snake_case")]
pub enum PointLife {
    QuasiSteady,
    Ode,
}

impl From<PointProcess> for toolroom_planning::point::PointProcess {
    fn from(process: PointProcess) -> Self {
        match process {
            PointProcess::Turning => Self::Turning,
            PointProcess::Milling => Self::Milling,
            PointProcess::Infeed => Self::Infeed,
        }
    }
}

impl From<PointLife> for toolroom_cutting::LifeModel {
    fn from(life: PointLife) -> Self {
        match life {
            PointLife::QuasiSteady => Self::QuasiSteady,
            PointLife::Ode => Self::Ode,
        }
    }
}
