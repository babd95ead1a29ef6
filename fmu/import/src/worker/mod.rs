//! Units in worker processes: what happens to a worker does not happen to the program.
//!
//! The program starts itself with a hidden verb, or any program that calls [`serve`]. Messages go over a socket, one
//! for each batch of actions; how far a batch came stands in shared memory, so that the call is known in which a
//! worker hangs or dies. A worker ends with the program, however that ends, and removes the unit's folder then.

mod group;
mod message;
mod progress;
mod serve;

pub use serve::serve;

use crate::description::ValueType;
use crate::instance::{Action, Answer, Body, CallError, Port, StartValue};
use crate::unit::{Plan, WorkerProgram};
use message::{Bytes, Request, read_reply, receive, send, waits};
use progress::Progress;
use std::collections::BTreeMap;
use std::io::{self, BufReader};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

/// Time that a worker has to end by itself (assumption).
const PATIENCE: Duration = Duration::from_millis(200);

/// Looks at a worker within its time limit: one is noticed to be late by so small a part of it.
const LOOKS: u32 = 16;

/// Shortest time between two looks (assumption: what the clock of a socket resolves).
const LEAST_LOOK: Duration = Duration::from_millis(1);

/// Function of FMI that an action calls, for messages.
fn function(action: &Action<'_>, major: u32, exchange: bool) -> String {
    let typed = |verb: &str, port: &Port| match (major, port.value_type) {
        (2, ValueType::Boolean) => format!("fmi2{verb}Boolean"),
        (2, ValueType::Integer(..) | ValueType::Enumeration) => format!("fmi2{verb}Integer"),
        (2, _) => format!("fmi2{verb}Real"),
        (_, ValueType::Integer(bits, signed)) => format!("fmi3{verb}{}Int{bits}", if signed { "" } else { "U" }),
        (_, ValueType::Enumeration) => format!("fmi3{verb}Int64"),
        (_, value_type) => format!("fmi3{verb}{value_type:?}"),
    };
    let state = if major == 2 { "FMUstate" } else { "FMUState" };
    match action {
        Action::Set(port, _) | Action::SetArray(port, _) => typed("Set", port),
        Action::Get(port) => typed("Get", port),
        Action::GetText(_) => format!("fmi{major}GetString"),
        Action::Step { .. } | Action::Locate { .. } if exchange => "the integration of its equations".to_owned(),
        Action::Step { .. } | Action::Locate { .. } => format!("fmi{major}DoStep"),
        Action::Save(_) => format!("fmi{major}Get{state}"),
        Action::Restore(_) => format!("fmi{major}Set{state}"),
        Action::Forget(_) => format!("fmi{major}Free{state}"),
        Action::Serialize => format!("fmi{major}Serialize{state}"),
        Action::Terminate => format!("fmi{major}Terminate"),
        Action::Deserialize(_) => format!("fmi{major}De{}erialize{state}", if major == 2 { "S" } else { "s" }),
    }
}

/// The workers of a unit.
pub(crate) struct Workers {
    plan: Plan,
    program: WorkerProgram,
    folder: PathBuf,
    shelf: Mutex<Shelf>,
}

/// Workers that are there.
#[derive(Default)]
struct Shelf {
    started: u32,
    /// One that nobody uses.
    spare: Option<Worker>,
    /// Those whose instances share a process, by the thread that made them.
    shared: BTreeMap<u64, (ThreadId, Arc<Mutex<Worker>>)>,
}

impl Workers {
    /// Starts the first worker, which shows whether the library can be loaded.
    pub fn start(plan: Plan, program: WorkerProgram, folder: &Path) -> Result<Self, String> {
        let workers = Self { plan, program, folder: folder.to_owned(), shelf: Mutex::default() };
        let first = workers.worker()?;
        workers.shelf().spare = Some(first);
        Ok(workers)
    }

    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A worker with the library.
    fn worker(&self) -> Result<Worker, String> {
        let number = {
            let mut shelf = self.shelf();
            if let Some(spare) = shelf.spare.take() {
                return Ok(spare);
            }
            shelf.started += 1;
            shelf.started
        };
        let mut worker = Worker::start(&self.program, &self.folder.join(format!("progress-{number}")))
            .map_err(|error| format!("{} cannot be started for it: {error}", self.program.program.display()))?;
        let request = Request::Load {
            plan: self.plan.clone(),
            folder: self.folder.display().to_string(),
            progress: worker.file.display().to_string(),
        };
        match worker.ask(&request.write(), &|_| "loading".to_owned()) {
            Ok(_) => Ok(worker),
            Err(error) if error.function == "loading" => Err(error.status),
            Err(error) => Err(error.to_string()),
        }
    }

    /// A new instance, `alone` in its process or with the others of this thread.
    pub fn instantiate(
        &self,
        alone: bool,
        start_values: &[(Port, StartValue)],
        start: f64,
    ) -> Result<Box<dyn Body>, CallError> {
        let failed = |status| CallError { function: "the worker".to_owned(), status, messages: Vec::new() };
        let worker = if alone {
            Arc::new(Mutex::new(self.worker().map_err(failed)?))
        } else {
            let current = std::thread::current().id();
            let known = {
                let mut shelf = self.shelf();
                // Workers of threads that have gone hold no instance any more.
                shelf.shared.retain(|_, (thread, worker)| {
                    (*thread == current || Arc::strong_count(worker) > 1) && locked(worker).dead.is_none()
                });
                shelf.shared.values().find(|(thread, _)| *thread == current).map(|(_, worker)| Arc::clone(worker))
            };
            match known {
                Some(worker) => worker,
                None => {
                    let worker = Arc::new(Mutex::new(self.worker().map_err(failed)?));
                    let mut shelf = self.shelf();
                    let key = shelf.shared.last_key_value().map_or(0, |(key, _)| key + 1);
                    shelf.shared.insert(key, (current, Arc::clone(&worker)));
                    worker
                }
            }
        };
        let (major, exchange) = (self.plan.major, self.plan.equations.is_some());
        let number = {
            let mut worker = locked(&worker);
            worker.instances += 1;
            let number = worker.instances;
            let request = Request::New { number, start_values: start_values.to_vec(), start };
            let named = |call: usize| match call {
                0 if major == 2 => "fmi2Instantiate".to_owned(),
                0 if exchange => "fmi3InstantiateModelExchange".to_owned(),
                0 => "fmi3InstantiateCoSimulation".to_owned(),
                call if call <= start_values.len() => "setting a start value".to_owned(),
                call if call == start_values.len() + 1 => format!("fmi{major}EnterInitializationMode"),
                _ => format!("fmi{major}ExitInitializationMode"),
            };
            worker.ask(&request.write(), &named)?;
            number
        };
        Ok(Box::new(Remote { worker, number, major, exchange }))
    }
}

fn locked(worker: &Mutex<Worker>) -> MutexGuard<'_, Worker> {
    worker.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A worker process.
struct Worker {
    child: Child,
    stream: UnixStream,
    reader: BufReader<UnixStream>,
    progress: Progress,
    file: PathBuf,
    limit: Duration,
    content: Vec<u8>,
    instances: u32,
    /// Why it can no longer be asked.
    dead: Option<String>,
}

impl Worker {
    fn start(program: &WorkerProgram, file: &Path) -> io::Result<Self> {
        let progress = Progress::create(file)?;
        let (stream, other) = UnixStream::pair()?;
        let child = Command::new(&program.program)
            .args(&program.arguments)
            .stdin(Stdio::piped()) // open as long as this process lives
            .stdout(Stdio::from(OwnedFd::from(other)))
            .process_group(0) // Ctrl-C is for the program
            .spawn()?;
        stream.set_read_timeout(Some((program.call_limit / LOOKS).max(LEAST_LOOK)))?;
        Ok(Self {
            child,
            reader: BufReader::new(stream.try_clone()?),
            stream,
            progress,
            file: file.to_owned(),
            limit: program.call_limit,
            content: Vec::new(),
            instances: 0,
            dead: None,
        })
    }

    /// Asks and waits for the reply. `named` gives the function of an action.
    fn ask(&mut self, request: &Bytes, named: &dyn Fn(usize) -> String) -> Result<Answer, CallError> {
        let failed = |function, status: String| CallError { function, status, messages: Vec::new() };
        if let Some(reason) = &self.dead {
            return Err(failed("the worker".to_owned(), format!("no more: {reason}")));
        }
        let (mut seen, mut since) = (self.progress.look(), Instant::now());
        let (mut result, mut ended) = (send(&mut self.stream, request), false);
        while result.is_ok() {
            match receive(&mut self.reader, &mut self.content, LOOKS) {
                Ok(true) => match read_reply(&self.content) {
                    Ok(reply) => return reply,
                    Err(error) => result = Err(error),
                },
                Ok(false) => result = Err(io::ErrorKind::UnexpectedEof.into()),
                // What a unit started may hold the stream open when its worker is gone, which may have answered before.
                Err(error) if waits(&error) && !matches!(self.child.try_wait(), Ok(None)) => {
                    if std::mem::replace(&mut ended, true) {
                        result = Err(io::ErrorKind::UnexpectedEof.into());
                    }
                }
                // A call that began since the last look has its own time.
                Err(error) if waits(&error) && (self.progress.look() != seen || since.elapsed() < self.limit) => {
                    let now = self.progress.look();
                    if now != seen {
                        (seen, since) = (now, Instant::now());
                    }
                }
                Err(error) => result = Err(error),
            }
        }
        let error = result.err().unwrap_or_else(|| io::ErrorKind::UnexpectedEof.into());
        let (late, broken) = (waits(&error), error.kind() == io::ErrorKind::InvalidData);
        let function = named(self.progress.look() as u32 as usize);
        let status = self.end(late || broken);
        let reason = if late {
            format!("nothing within {} s (call_limit); its process was ended", self.limit.as_secs_f64())
        } else if broken {
            "what cannot be read: the unit wrote to its worker's stream; its process was ended".to_owned()
        } else {
            format!("nothing: its process ended {}", status.map_or("somehow".to_owned(), how))
        };
        self.dead = Some(reason.clone());
        Err(failed(function, reason))
    }

    /// Ends the process, and what the unit started in it, and says how it ended.
    fn end(&mut self, at_once: bool) -> Option<ExitStatus> {
        let (begin, mut patience) = (Instant::now(), if at_once { Duration::ZERO } else { PATIENCE });
        while begin.elapsed() < patience {
            if !matches!(self.child.try_wait(), Ok(None)) {
                patience = Duration::ZERO;
            } else {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
        let _ = self.child.kill();
        let status = self.child.wait().ok();
        group::end(self.child.id());
        status
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        if self.dead.is_none() {
            // The end of the stream is the end of its work.
            let _ = self.stream.shutdown(std::net::Shutdown::Both);
            self.end(false);
        }
        let _ = std::fs::remove_file(&self.file);
    }
}

fn how(status: ExitStatus) -> String {
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("with exit code {code}"),
        (None, Some(4)) => "by signal 4 (illegal instruction)".to_owned(),
        (None, Some(6)) => "by signal 6 (abort)".to_owned(),
        (None, Some(8)) => "by signal 8 (arithmetic)".to_owned(),
        (None, Some(9)) => "by signal 9 (killed)".to_owned(),
        (None, Some(11)) => "by signal 11 (segmentation fault)".to_owned(),
        (None, Some(signal)) => format!("by signal {signal}"),
        (None, None) => status.to_string(),
    }
}

/// An instance in a worker.
struct Remote {
    worker: Arc<Mutex<Worker>>,
    number: u32,
    major: u32,
    exchange: bool,
}

impl std::fmt::Debug for Remote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Remote").field("number", &self.number).finish_non_exhaustive()
    }
}

impl Body for Remote {
    fn act(&mut self, actions: &[Action<'_>], answer: &mut Answer) -> Result<(), CallError> {
        let named = |call: usize| {
            // A worker that died while it was idle has called none of them.
            actions
                .get(call)
                .map_or_else(|| "the worker".to_owned(), |action| function(action, self.major, self.exchange))
        };
        *answer = locked(&self.worker).ask(&Request::act(self.number, actions), &named)?;
        Ok(())
    }

    fn alive(&self) -> bool {
        locked(&self.worker).dead.is_none()
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        let mut worker = locked(&self.worker);
        if worker.dead.is_none() {
            let free = Request::Free { number: self.number };
            // A worker that dies of it is replaced by the next one who needs it.
            let _ = worker.ask(&free.write(), &|_| "freeing an instance".to_owned());
        }
    }
}
