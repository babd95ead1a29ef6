//! A machine of a shop with its controller as a system of units: an SSP package.
//!
//! ```text
//!   scenario, machine, policy ──► Cell ──► cell.ssp: controller.fmu + turning.fmu, signals, parameter values
//! ```
//! The lathe is the process of the tool with which the machine cuts an operation; the controller is the policy, worked out
//! for that cut. Every parameter in which they differ from the units' own start values stands in one file of parameter
//! values, as a number with its unit, so that tools without strings can read it.
//!
//! # What is not modelled
//! The cell cuts without pause: loading, edge changes and breakdowns take no time. Edges are nominal and sensors exact.
//! Cells of milling and grinding, chatter, and schedules of speed against path are refused.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod structure;
mod values;

use toolroom_cutting::Turning;
use toolroom_fmu::{Binary, PackageError, Version, archive, package, package_without_enumerations, units};
use toolroom_scenario::policies::{ChangeRule, ResolveError, ResolvedPolicy, SpeedSetting};
use toolroom_scenario::{Cut, Knowledge, ProcessModel, Scenario, Work};
use toolroom_wear::SpeedLaw;
use values::{Start, differing};

use toolroom_control::{Change, Operation, Rule, Sensing, SpeedController};

/// Why there is no such cell.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CellError {
    /// A name that the scenario does not have.
    #[error("there is no {kind} `{name}`; there are {}", .known.join(", "))]
    Unknown {
        /// What was looked for.
        kind: &'static str,
        /// Its name.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A policy that cannot be worked out.
    #[error(transparent)]
    Policy(#[from] ResolveError),
    /// A machine, policy or effect that no unit stands for.
    #[error("{what}: {reason}")]
    NotOffered {
        /// Machine, tool, policy or effect.
        what: String,
        /// Why not.
        reason: &'static str,
    },
}

/// Which cell of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// Machine.
    pub machine: String,
    /// Policy; the first one, if left out.
    pub policy: Option<String>,
    /// Operation, `part.operation` or its name alone; the first one that the machine cuts, if left out.
    pub operation: Option<String>,
}

/// How much of the standard a package asks of its readers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// The system has connectors and parameter values of its own; parameters that choose are enumerations.
    #[default]
    Whole,
    /// Everything stands at the components, and parameters that choose are integers: what Ecos and libcosim read. The units
    /// are of FMI 2.0.
    Flat,
}

/// A lathe with its controller.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Name of the system.
    pub name: String,
    /// What it is, one line.
    pub title: String,
    /// What differs from the scenario, a sentence each.
    pub notes: Vec<String>,
    start: Vec<Start>,
}

impl Cell {
    /// The cell of a machine under a policy.
    ///
    /// # Errors
    /// [`CellError`].
    pub fn of(scenario: &Scenario, choice: &Choice) -> Result<Self, CellError> {
        let named = |kind, name: &str, known: Vec<&String>| {
            let index = known.iter().position(|known| *known == name);
            index.ok_or_else(|| CellError::Unknown {
                kind,
                name: name.to_owned(),
                known: known.into_iter().cloned().collect(),
            })
        };
        let machines = scenario.machines.iter().map(|each| &each.name).collect();
        let machine = named("machine", &choice.machine, machines)?;
        let policies = scenario.policies.iter().map(|each| &each.name).collect();
        let policy = choice.policy.as_ref().map_or(Ok(0), |name| named("policy", name, policies))?;
        let (part, operation, pass, cuts, tool) = operation(scenario, machine, choice)?;
        let tool = &scenario.tools[tool];
        let refused = |what: String, reason| Err(CellError::NotOffered { what, reason });
        let turning = match &tool.process {
            ProcessModel::Turning(turning) => turning,
            ProcessModel::Milling(_) | ProcessModel::Infeed(_) | ProcessModel::Other(_) => {
                let reason = "only tools of turning with a parameter set of toolroom make a cell";
                return refused(format!("tool `{}`", tool.name), reason);
            }
        };
        if turning.structure.is_some() {
            return refused(format!("tool `{}`", tool.name), "a structure that vibrates is not exported");
        }
        if turning.pair.law.group() != "energy_balance" {
            return refused(format!("tool `{}`", tool.name), "the unit of turning wears by energy_balance");
        }
        let cut = cuts[0];
        if let Some(own) = tool.variants.effects.iter().find(|own| own.effect.definition().is_some()) {
            let what = format!("effect `{}` of tool `{}`", own.effect.entry().id, tool.name);
            return refused(what, "a unit has the effects of the catalogue and none of your own; export without it");
        }
        let resolved = ResolvedPolicy::from_scenario(scenario, policy)?;
        let name = &scenario.policies[policy].name;
        let controller = controller(&resolved, (machine, pass), cut, cuts.len(), turning)
            .map_err(|reason| CellError::NotOffered { what: format!("policy `{name}`"), reason })?;
        let mut start = differing("controller", "controller", &controller);
        start.extend(differing("lathe", "turning", &**turning));
        let mut set = |name: &str, value: f64| start.extend(Start::of("lathe", "turning", name, value));
        set("process.feed_per_rev", cut.feed);
        set("process.depth_of_cut", cut.depth_of_cut);
        set("process.position", cut.position);
        if cut.diameter > 0.0 {
            set("process.workpiece_diameter", cut.diameter);
        }
        let mut notes = vec!["edges are nominal and sensors exact; nothing takes time but cutting".to_owned()];
        if cuts.iter().any(|other| *other != cut) {
            notes.push(format!("the passes of `{operation}` differ; the cell cuts as the first one"));
        }
        for own in tool.variants.effects.iter().filter(|own| !own.scope.is_everywhere()) {
            notes.push(format!("effect `{}` has a scope and is left out", own.effect.entry().id));
        }
        let title = format!("{} on {}: {part}.{operation}, policy {name}", scenario.name, choice.machine);
        Ok(Self { name: format!("{}-{}", scenario.name, choice.machine), title, notes, start })
    }

    /// The package of the cell: units of a version of FMI with the libraries of some platforms, and a default experiment
    /// up to `stop` seconds. The same cell gives the same bytes.
    ///
    /// # Errors
    /// [`PackageError`].
    pub fn package(&self, version: Version, binaries: &[Binary], stop: f64) -> Result<Vec<u8>, PackageError> {
        self.in_form(Form::Whole, version, binaries, stop)
    }

    /// [`Cell::package`] in a form: [`Form::Flat`] makes units of FMI 2.0, whatever `version` says.
    ///
    /// # Errors
    /// [`PackageError`].
    pub fn in_form(
        &self,
        form: Form,
        version: Version,
        binaries: &[Binary],
        stop: f64,
    ) -> Result<Vec<u8>, PackageError> {
        let description = structure::description(self, form, stop);
        let mut entries = vec![("SystemStructure.ssd".to_owned(), description.into_bytes())];
        match form {
            Form::Whole => {
                entries.push((structure::VALUES.to_owned(), values::file(&self.name, &self.start).into_bytes()));
            }
            Form::Flat => {
                for (component, _) in structure::COMPONENTS {
                    let file = values::file(FLAT_SET, &values::within(component, &self.start));
                    entries.push((structure::values_of(component), file.into_bytes()));
                }
            }
        }
        for (component, model) in structure::COMPONENTS {
            let Some(unit) = units().find(|unit| unit.name == model) else { continue };
            let packed = match form {
                Form::Whole => package(unit, version, binaries, &[])?,
                Form::Flat => package_without_enumerations(unit, binaries)?,
            };
            entries.push((structure::source(component), packed));
        }
        archive(&entries)
    }
}

/// Name of the sets of parameter values of a flat system, by which Ecos is asked for them.
pub const FLAT_SET: &str = "initialValues";

/// Part, operation, number of its first pass, its passes and tool.
type Chosen<'s> = (&'s str, &'s str, u32, &'s [Cut], usize);

/// The operation that the cell cuts.
fn operation<'s>(scenario: &'s Scenario, machine: usize, choice: &Choice) -> Result<Chosen<'s>, CellError> {
    let mut pass = 0;
    let mut known = Vec::new();
    for part in &scenario.parts {
        for operation in &part.operations {
            let name = format!("{}.{}", part.name, operation.name);
            // Passes are counted over everything that has a tool, as a resolved policy does.
            let first = pass;
            pass += operation.tool.map_or(0, |_| operation.work.passes() as u32);
            let cuts = match &operation.work {
                Work::Cutting(cuts) => cuts,
                Work::Plain(_) | Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_) | Work::Program(_) => {
                    continue;
                }
            };
            let Some(tool) = operation.tool.filter(|_| operation.machines.contains(&machine)) else { continue };
            let wanted = choice.operation.as_ref().is_none_or(|wanted| *wanted == name || *wanted == operation.name);
            if wanted && !cuts.is_empty() {
                return Ok((&part.name, &operation.name, first, cuts, tool));
            }
            known.push(name);
        }
    }
    match &choice.operation {
        Some(wanted) => Err(CellError::Unknown { kind: "operation of the machine", name: wanted.clone(), known }),
        None => Err(CellError::NotOffered {
            what: format!("machine `{}`", choice.machine),
            reason: "it cuts no operation of turning or milling",
        }),
    }
}

/// The policy for a cut as a controller; the reason where no unit stands for it.
fn controller(
    resolved_policy: &ResolvedPolicy,
    (machine, pass): (usize, u32),
    cut: Cut,
    passes: usize,
    turning: &Turning,
) -> Result<SpeedController, &'static str> {
    let settings = resolved_policy.of_pass(machine, pass).settings();
    if settings.acts_on_chatter {
        return Err("what it does about chatter is not exported");
    }
    let mut made = SpeedController {
        pair: settings.believed.map_or(&turning.pair, |(pair, _)| pair).clone(),
        operation: Operation {
            cutting_speed: cut.cutting_speed,
            feed_per_rev: cut.feed,
            depth_of_cut: cut.depth_of_cut,
            path_length: cut.path_length,
        },
        ..SpeedController::default()
    };
    if made.pair.law.group() != "energy_balance" {
        return Err("it believes in another wear law than energy_balance, the one of the unit");
    }
    let (lowest_speed, highest_speed) = settings.range;
    made.rule = Rule { lowest_speed, highest_speed: highest_speed.min(50.0), speed_factor: 1.0, ..Rule::default() };
    match settings.speed {
        SpeedSetting::Fixed(speed) => {
            made.rule.speed_rule = 0.0;
            made.rule.speed_factor = speed / cut.cutting_speed;
        }
        SpeedSetting::Law(law, factor) => {
            made.rule.speed_factor = factor;
            match law {
                SpeedLaw::MinimumWear => made.rule.speed_rule = 1.0,
                SpeedLaw::ShadowPrice(price) => (made.rule.speed_rule, made.rule.shadow_price) = (2.0, price),
                SpeedLaw::LiteralBalance => made.rule.speed_rule = 4.0,
                SpeedLaw::Other(_) => return Err("the exported controller does not have this law of speed"),
            }
        }
        SpeedSetting::PathPerEdge(path, factor) => {
            (made.rule.speed_rule, made.rule.path_per_edge, made.rule.speed_factor) = (3.0, path, factor);
        }
        SpeedSetting::Schedule => return Err("a schedule of speed against path is not exported"),
    }
    let mut change = Change::default();
    match settings.change {
        ChangeRule::WearLimit(limit) => (change.change_rule, change.flank_wear) = (1.0, limit),
        ChangeRule::PartCount(parts) => (change.change_rule, change.passes) = (2.0, f64::from(parts) * passes as f64),
        ChangeRule::CuttingTime(time) => (change.change_rule, change.cutting_time) = (3.0, time),
        ChangeRule::Predicted(limit) => (change.change_rule, change.flank_wear) = (4.0, limit),
    }
    made.change = change;
    made.sensing = Sensing {
        sampling_period: settings.sensors.sampling_period,
        knows_wear: match settings.knows {
            Knowledge::Edge => return Err("what it knows of the edge itself no unit tells"),
            Knowledge::Wear => 1.0,
            // Who estimates nothing looks at what is read.
            Knowledge::Sensors => f64::from(u8::from(settings.noise.is_none())),
        },
        read_every: f64::from(settings.sensors.read_every),
        reading_error: settings.reading_error,
    };
    if let Some(noise) = settings.noise {
        made.observer = noise;
    }
    Ok(made)
}
