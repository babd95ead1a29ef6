//! What is said between the program and its workers, as bytes.
//!
//! A message is its length (4 bytes) and its content; numbers are little-endian. Both ends are the same program.

use crate::description::ValueType;
use crate::instance::{Action, Answer, CallError, Port, StartValue, StepResult};
use crate::unit::{Equations, Plan};
use std::ffi::CString;
use std::io::{self, Read, Write};

/// Longest message, bytes; assumption: states of units stay far below.
const LONGEST: u32 = 1 << 28;

/// What a worker is asked to do.
#[derive(Debug, PartialEq)]
pub(super) enum Request<'a> {
    /// Loads the library; `folder` is removed where the program dies, `progress` is the file of the progress.
    Load { plan: Plan, folder: String, progress: String },
    /// Makes an instance with this number.
    New { number: u32, start_values: Vec<(Port, StartValue)>, start: f64 },
    /// Lets an instance act.
    Act { number: u32, actions: Vec<Action<'a>> },
    /// Frees an instance.
    Free { number: u32 },
}

/// What a worker answers.
pub(super) type Reply = Result<Answer, CallError>;

/// Writes a message.
pub(super) fn send(stream: &mut impl Write, content: &Bytes) -> io::Result<()> {
    stream.write_all(&content.0)
}

/// Reads a message into `content`; false at the end of the stream. A stream with a time limit may run into it before the
/// first byte only: what has begun to come is waited for up to `patience` limits without a byte.
pub(super) fn receive(stream: &mut impl Read, content: &mut Vec<u8>, patience: u32) -> io::Result<bool> {
    let mut length = [0; 4];
    if stream.read(&mut length[..1])? == 0 {
        return Ok(false);
    }
    fill(stream, &mut length[1..], patience)?;
    let length = u32::from_le_bytes(length);
    if length > LONGEST {
        return Err(broken());
    }
    content.resize(length as usize, 0);
    fill(stream, content, patience)?;
    Ok(true)
}

/// Reads as many bytes as `rest` holds, over pauses of the stream.
fn fill(stream: &mut impl Read, mut rest: &mut [u8], patience: u32) -> io::Result<()> {
    let mut pauses = 0;
    while !rest.is_empty() {
        match stream.read(rest) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => (rest, pauses) = (&mut rest[count..], 0),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) if waits(&error) && pauses < patience => pauses += 1,
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Whether a time limit of a stream was met.
pub(super) fn waits(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}

fn broken() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "a message of a worker cannot be read")
}

/// A message that is being written, its length in front.
pub(super) struct Bytes(Vec<u8>);

impl Bytes {
    fn new(kind: u8) -> Self {
        Self(vec![0, 0, 0, 0, kind])
    }
    fn end(mut self) -> Self {
        let length = (self.0.len() - 4) as u32;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self
    }
    fn byte(&mut self, value: u8) {
        self.0.push(value);
    }
    fn whole(&mut self, value: u32) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }
    fn real(&mut self, value: f64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }
    fn bytes(&mut self, value: &[u8]) {
        self.whole(value.len() as u32);
        self.0.extend_from_slice(value);
    }
    fn port(&mut self, port: Port) {
        let (kind, detail) = match port.value_type {
            ValueType::Float64 => (0, 0),
            ValueType::Float32 => (1, 0),
            ValueType::Integer(bits, signed) => (if signed { 2 } else { 3 }, bits),
            ValueType::Boolean => (4, 0),
            ValueType::String => (5, 0),
            ValueType::Binary => (6, 0),
            ValueType::Enumeration => (7, 0),
            ValueType::Clock => (8, 0),
        };
        self.byte(kind);
        self.byte(detail);
        self.whole(port.reference);
        self.whole(port.count);
    }
    fn reals(&mut self, values: &[f64]) {
        self.whole(values.len() as u32);
        values.iter().for_each(|value| self.real(*value));
    }
    fn action(&mut self, action: &Action<'_>) {
        match *action {
            Action::Set(port, value) => {
                self.byte(0);
                self.port(port);
                self.real(value);
            }
            Action::SetArray(port, elements) => {
                self.byte(8);
                self.port(port);
                self.bytes(elements);
            }
            Action::Get(port) => {
                self.byte(1);
                self.port(port);
            }
            Action::GetText(port) => {
                self.byte(9);
                self.port(port);
            }
            Action::Step { time, duration } => {
                self.byte(2);
                self.real(time);
                self.real(duration);
            }
            Action::Save(place) => {
                self.byte(3);
                self.whole(place);
            }
            Action::Restore(place) => {
                self.byte(4);
                self.whole(place);
            }
            Action::Forget(place) => {
                self.byte(5);
                self.whole(place);
            }
            Action::Serialize => self.byte(6),
            Action::Deserialize(bytes) => {
                self.byte(7);
                self.bytes(bytes);
            }
            Action::Terminate => self.byte(10),
            Action::Locate { place, time, length, before, inputs, reads } => {
                self.byte(11);
                self.whole(place);
                self.real(time);
                self.real(length);
                self.bytes(before);
                self.whole(inputs);
                self.whole(reads);
            }
        }
    }
}

/// A message that is being read.
struct Content<'a>(&'a [u8]);

impl<'a> Content<'a> {
    fn take(&mut self, count: usize) -> io::Result<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count).ok_or_else(broken)?;
        self.0 = rest;
        Ok(head)
    }
    fn byte(&mut self) -> io::Result<u8> {
        Ok(self.take(1)?[0])
    }
    fn whole(&mut self) -> io::Result<u32> {
        Ok(u32::from_le_bytes(self.take(4)?.try_into().map_err(|_| broken())?))
    }
    fn real(&mut self) -> io::Result<f64> {
        Ok(f64::from_le_bytes(self.take(8)?.try_into().map_err(|_| broken())?))
    }
    fn bytes(&mut self) -> io::Result<&'a [u8]> {
        let count = self.whole()? as usize;
        self.take(count)
    }
    fn text(&mut self) -> io::Result<String> {
        String::from_utf8(self.bytes()?.to_vec()).map_err(|_| broken())
    }
    fn list<T>(&mut self, read: impl Fn(&mut Self) -> io::Result<T>) -> io::Result<Vec<T>> {
        let count = self.whole()?;
        (0..count).map(|_| read(self)).collect()
    }
    fn port(&mut self) -> io::Result<Port> {
        let (kind, detail) = (self.byte()?, self.byte()?);
        let value_type = match kind {
            0 => ValueType::Float64,
            1 => ValueType::Float32,
            2 | 3 => ValueType::Integer(detail, kind == 2),
            4 => ValueType::Boolean,
            5 => ValueType::String,
            6 => ValueType::Binary,
            7 => ValueType::Enumeration,
            8 => ValueType::Clock,
            9.. => return Err(broken()),
        };
        Ok(Port { value_type, reference: self.whole()?, count: self.whole()? })
    }
    fn action(&mut self) -> io::Result<Action<'a>> {
        Ok(match self.byte()? {
            0 => Action::Set(self.port()?, self.real()?),
            1 => Action::Get(self.port()?),
            2 => Action::Step { time: self.real()?, duration: self.real()? },
            3 => Action::Save(self.whole()?),
            4 => Action::Restore(self.whole()?),
            5 => Action::Forget(self.whole()?),
            6 => Action::Serialize,
            7 => Action::Deserialize(self.bytes()?),
            8 => Action::SetArray(self.port()?, self.bytes()?),
            9 => Action::GetText(self.port()?),
            10 => Action::Terminate,
            11 => Action::Locate {
                place: self.whole()?,
                time: self.real()?,
                length: self.real()?,
                before: self.bytes()?,
                inputs: self.whole()?,
                reads: self.whole()?,
            },
            12.. => return Err(broken()),
        })
    }
    fn start_value(&mut self) -> io::Result<(Port, StartValue)> {
        let port = self.port()?;
        let value = match self.byte()? {
            0 => StartValue::Structure(self.real()?),
            1 => StartValue::Numbers(self.list(Self::real)?),
            _ => StartValue::Text(CString::new(self.bytes()?).map_err(|_| broken())?),
        };
        Ok((port, value))
    }
}

impl<'a> Request<'a> {
    /// The message.
    pub fn write(&self) -> Bytes {
        let mut bytes;
        match self {
            Self::Load { plan, folder, progress } => {
                bytes = Bytes::new(0);
                bytes.whole(plan.major);
                for text in [&plan.file, &plan.name, &plan.token, folder, progress] {
                    bytes.bytes(text.as_bytes());
                }
                bytes.byte(u8::from(plan.resources.is_some()));
                bytes.bytes(plan.resources.as_deref().unwrap_or_default().as_bytes());
                bytes.byte(u8::from(plan.equations.is_some()));
                let none = Equations::default();
                let Equations { states, indicators, completed, names } = plan.equations.as_ref().unwrap_or(&none);
                bytes.byte(u8::from(states.is_some()));
                bytes.whole(states.unwrap_or_default());
                bytes.whole(*indicators);
                bytes.byte(u8::from(*completed));
                bytes.whole(names.len() as u32);
                names.iter().for_each(|name| bytes.bytes(name.as_bytes()));
            }
            Self::New { number, start_values, start } => {
                bytes = Bytes::new(1);
                bytes.whole(*number);
                bytes.whole(start_values.len() as u32);
                for (port, value) in start_values {
                    bytes.port(*port);
                    match value {
                        StartValue::Structure(number) => {
                            bytes.byte(0);
                            bytes.real(*number);
                        }
                        StartValue::Numbers(numbers) => {
                            bytes.byte(1);
                            bytes.reals(numbers);
                        }
                        StartValue::Text(text) => {
                            bytes.byte(2);
                            bytes.bytes(text.as_bytes());
                        }
                    }
                }
                bytes.real(*start);
            }
            Self::Act { number, actions } => return Self::act(*number, actions),
            Self::Free { number } => {
                bytes = Bytes::new(3);
                bytes.whole(*number);
            }
        }
        bytes.end()
    }

    /// The message of [`Request::Act`], of actions that are not owned.
    pub fn act(number: u32, actions: &[Action<'_>]) -> Bytes {
        let mut bytes = Bytes::new(2);
        bytes.whole(number);
        bytes.whole(actions.len() as u32);
        actions.iter().for_each(|action| bytes.action(action));
        bytes.end()
    }

    /// Reads the content of a message.
    pub fn read(content: &'a [u8]) -> io::Result<Self> {
        let mut content = Content(content);
        Ok(match content.byte()? {
            0 => {
                let (major, mut text) = (content.whole()?, || content.text());
                let (file, name, token) = (text()?, text()?, text()?);
                let (folder, progress) = (text()?, text()?);
                let (has, resources) = (content.byte()? > 0, content.text()?);
                let resources = has.then_some(resources);
                let exchange = content.byte()? > 0;
                let (known, states) = (content.byte()? > 0, content.whole()?);
                let states = known.then_some(states);
                let (indicators, completed) = (content.whole()?, content.byte()? > 0);
                let names = content.list(Content::text)?;
                let equations = exchange.then_some(Equations { states, indicators, completed, names });
                let plan = Plan { major, file, name, token, resources, equations };
                Self::Load { plan, folder, progress }
            }
            1 => Self::New {
                number: content.whole()?,
                start_values: content.list(Content::start_value)?,
                start: content.real()?,
            },
            2 => Self::Act { number: content.whole()?, actions: content.list(Content::action)? },
            3 => Self::Free { number: content.whole()? },
            4.. => return Err(broken()),
        })
    }
}

/// The message of a reply.
pub(super) fn write_reply(reply: &Reply) -> Bytes {
    let mut bytes;
    match reply {
        Ok(answer) => {
            bytes = Bytes::new(0);
            bytes.reals(&answer.values);
            bytes.whole(answer.texts.len() as u32);
            answer.texts.iter().for_each(|text| bytes.bytes(text.as_bytes()));
            let (kind, time) = match answer.stepped {
                StepResult::Whole => (0, 0.0),
                StepResult::Part(time) => (1, time),
                StepResult::Ended(time) => (2, time),
            };
            bytes.byte(kind);
            bytes.real(time);
            bytes.bytes(&answer.bytes);
        }
        Err(error) => {
            bytes = Bytes::new(1);
            bytes.bytes(error.function.as_bytes());
            bytes.bytes(error.status.as_bytes());
            bytes.whole(error.messages.len() as u32);
            error.messages.iter().for_each(|message| bytes.bytes(message.as_bytes()));
        }
    }
    bytes.end()
}

/// Reads the content of a reply.
pub(super) fn read_reply(content: &[u8]) -> io::Result<Reply> {
    let mut content = Content(content);
    if content.byte()? > 0 {
        let (function, status) = (content.text()?, content.text()?);
        return Ok(Err(CallError { function, status, messages: content.list(Content::text)? }));
    }
    let (values, texts) = (content.list(Content::real)?, content.list(Content::text)?);
    let stepped = match (content.byte()?, content.real()?) {
        (0, _) => StepResult::Whole,
        (1, time) => StepResult::Part(time),
        (2.., time) => StepResult::Ended(time),
    };
    Ok(Ok(Answer { values, texts, stepped, bytes: content.bytes()?.to_vec() }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn port() -> impl Strategy<Value = Port> {
        let types = [
            ValueType::Float64,
            ValueType::Float32,
            ValueType::Integer(16, true),
            ValueType::Integer(64, false),
            ValueType::Boolean,
            ValueType::Enumeration,
            ValueType::String,
        ];
        (prop::sample::select(types.to_vec()), any::<u32>(), any::<u32>())
            .prop_map(|(value_type, reference, count)| Port { value_type, reference, count })
    }

    fn content(bytes: &Bytes) -> Vec<u8> {
        let mut content = Vec::new();
        assert!(receive(&mut bytes.0.as_slice(), &mut content, 0).expect("whole"));
        content
    }

    #[test]
    fn a_plan_is_read_as_it_was_written() {
        let names = vec!["der(x)".to_owned(), "der(y)".to_owned()];
        for (resources, equations) in [
            (None, None),
            (None, Some(Equations::default())),
            (Some("r/".to_owned()), Some(Equations { states: Some(2), indicators: 3, completed: true, names })),
        ] {
            let [file, name, token] = ["a.so", "a", "{a}"].map(str::to_owned);
            let plan = Plan { major: 3, file, name, token, resources, equations };
            let request = Request::Load { plan, folder: "f".to_owned(), progress: "p".to_owned() };
            assert_eq!(Request::read(&content(&request.write())).expect("sound"), request);
        }
    }

    proptest! {
        #[test]
        fn a_request_is_read_as_it_was_written(
            number: u32, a in port(), b in port(), value in -1e9..1e9f64, place: u32, state: Vec<u8>,
        ) {
            let actions = vec![
                Action::Deserialize(&state), Action::Set(a, value), Action::Save(place),
                Action::Step { time: value, duration: 2.0 }, Action::Get(b), Action::Restore(place),
                Action::Forget(place), Action::Serialize, Action::SetArray(b, &state), Action::GetText(a),
                Action::Terminate,
                Action::Locate { place, time: value, length: 3.0, before: &state, inputs: number, reads: place },
            ];
            let request = Request::Act { number, actions };
            let written = content(&request.write());
            prop_assert_eq!(Request::read(&written).expect("sound"), request);
            let start_values = vec![
                (a, StartValue::Structure(value)),
                (b, StartValue::Numbers(vec![value, 1.0])),
                (b, StartValue::Text(c"set".to_owned())),
            ];
            let request = Request::New { number, start_values, start: value };
            let written = content(&request.write());
            prop_assert_eq!(Request::read(&written).expect("sound"), request);
        }

        #[test]
        fn a_reply_is_read_as_it_was_written(values: Vec<f32>, time in 0.0..1e9f64, bytes: Vec<u8>, text: String) {
            let values: Vec<f64> = values.into_iter().filter(|value| !value.is_nan()).map(f64::from).collect();
            let reply = Ok(Answer { values, texts: vec![text.clone()], stepped: StepResult::Part(time), bytes });
            prop_assert_eq!(read_reply(&content(&write_reply(&reply))).expect("sound"), reply);
            let reply = Err(CallError { function: text.clone(), status: "error".into(), messages: vec![text] });
            prop_assert_eq!(read_reply(&content(&write_reply(&reply))).expect("sound"), reply);
        }

        #[test]
        fn no_bytes_make_a_reader_panic(bytes: Vec<u8>) {
            let _ = (Request::read(&bytes), read_reply(&bytes));
        }
    }
}
