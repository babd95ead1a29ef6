//! Units as machines of the shop: the importer that scenario files call.

use crate::archive::ArchiveError;
use crate::machine::UnitProcess;
use crate::unit::{CALL_LIMIT, Isolation, LoadError, Unit, WorkerProgram};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use toolroom_process::{MachineProcess, UnitIsolation};
use toolroom_scenario::{UnitRefusal, UnitRequest, set_importer};

/// Whether this process answers the verb of a worker.
static SERVES: AtomicBool = AtomicBool::new(false);

/// Makes `fmu = "…"` in scenarios work, for every scenario that this process reads from then on.
pub fn register() {
    set_importer(import);
}

/// [`register`] in the program `toolroom` itself, which is its own worker under whatever name it was installed.
pub fn register_program() {
    SERVES.store(true, Ordering::Relaxed);
    register();
}

fn import(request: &UnitRequest<'_>) -> Result<Arc<dyn MachineProcess>, UnitRefusal> {
    let path = tidy(request.path);
    let wiring = request.wiring;
    let unit = Unit::load(&path, &Isolation::from_unit_isolation(wiring.isolation, wiring.call_limit))
        .map_err(|error| UnitRefusal { reason: error.to_string(), fix: fix(&error).unwrap_or_else(|| ask(&path)) })?;
    let process = UnitProcess::new(Arc::new(unit), request.process, request.inputs, request.outputs, request.wiring);
    let process = process.map_err(|error| UnitRefusal {
        reason: error.to_string(),
        fix: format!("`toolroom fmu info {}` lists its variables; see [tool.wiring]", path.display()),
    })?;
    Ok(Arc::new(process))
}

impl Isolation {
    /// Where the code of a unit runs, as a scenario says it. Workers are this program with a verb of its own; a program
    /// that only uses the library, such as Python, has the installed `toolroom` beside it.
    pub fn from_unit_isolation(isolation: UnitIsolation, call_limit: Option<f64>) -> Self {
        match isolation {
            UnitIsolation::None => Self::None,
            UnitIsolation::Process => {
                let own = std::env::current_exe().ok();
                let program = own.filter(|_| SERVES.load(Ordering::Relaxed));
                Self::Process(WorkerProgram {
                    program: program.unwrap_or_else(|| PathBuf::from("toolroom")),
                    arguments: vec!["fmu".to_owned(), "worker".to_owned()],
                    call_limit: Duration::from_secs_f64(call_limit.unwrap_or(CALL_LIMIT)),
                })
            }
        }
    }
}

fn ask(path: &Path) -> String {
    format!("ask `toolroom fmu check {}` what is wrong with it", path.display())
}

/// What to do about a unit that does not load, where it is not a matter of its inside.
fn fix(error: &LoadError) -> Option<String> {
    match error {
        LoadError::Archive(ArchiveError::Unreadable { path, .. }) => Some(export(path).unwrap_or_else(|| {
            "check path and permissions; in a scenario the path counts from the folder of the file".to_owned()
        })),
        LoadError::Archive(ArchiveError::NoZip { path, .. } | ArchiveError::Damaged { path, .. }) => {
            Some(export(path).unwrap_or_else(|| "copy or export the unit again: it is damaged".to_owned()))
        }
        LoadError::Archive(ArchiveError::Traversal { .. }) => {
            Some("do not use it: such an archive writes over files of its choice".to_owned())
        }
        LoadError::Platform { .. } => {
            Some("get the unit with a library for this computer; its exporter names the platforms".to_owned())
        }
        LoadError::Archive(_)
        | LoadError::Description { .. }
        | LoadError::Interface { .. }
        | LoadError::Clock { .. }
        | LoadError::Symbols { .. }
        | LoadError::Library { .. } => None,
    }
}

/// The command that makes one of toolroom's own units, told by the name of its file.
fn export(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let unit = toolroom_fmu::units().find(|unit| name.starts_with(&format!("toolroom_{}_fmi", unit.name)))?;
    let out = path.parent()?.display().to_string();
    let out = match out.as_str() {
        "" => ".".to_owned(),
        spaced if spaced.contains(char::is_whitespace) => format!("{spaced:?}"),
        plain => plain.to_owned(),
    };
    Some(format!("make it with `toolroom fmu export {} --out {out}`", unit.name))
}

/// The path without `NAME/..`, as people write it.
fn tidy(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for component in path.components() {
        let last = tidy.components().next_back();
        // Behind a symbolic link `..` is another folder: then the path stays as it is.
        if component == Component::ParentDir && matches!(last, Some(Component::Normal(_))) && !tidy.is_symlink() {
            tidy.pop();
        } else {
            tidy.push(component);
        }
    }
    tidy
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_told_without_detours() {
        assert_eq!(tidy(Path::new("scenarios/../out/fmu/x.fmu")), Path::new("out/fmu/x.fmu"));
        assert_eq!(tidy(Path::new("../a/./b/../../c.fmu")), Path::new("../c.fmu"));
        assert_eq!(tidy(Path::new("/../x.fmu")), Path::new("/../x.fmu"));
    }

    #[test]
    fn a_missing_unit_of_toolroom_is_made_by_its_command() {
        let advice = export(Path::new("out/fmu/toolroom_milling_fmi2.fmu"));
        assert_eq!(advice.as_deref(), Some("make it with `toolroom fmu export milling --out out/fmu`"));
        assert_eq!(export(Path::new("lathe.fmu")), None);
    }
}
