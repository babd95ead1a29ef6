//! Messages to the importer.

/// What a call returned; the numbers are those of both standards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum Status {
    /// All went well.
    Ok = 0,
    /// It went, with a remark in the log.
    Warning = 1,
    /// FMI 2.0 and 3.0: the step was not taken, another may be tried.
    Discard = 2,
    /// The call was refused and changed nothing.
    Error = 3,
    /// The unit has stopped.
    Fatal = 4,
}

/// A declared category of messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// Events of the process.
    Events,
    /// Remarks on a call that was carried out.
    Warning,
    /// Why a call was refused.
    Error,
    /// Why the unit stopped.
    Fatal,
}

impl Category {
    /// All of them, in the order of the model description.
    pub const ALL: [Self; 4] = [Self::Events, Self::Warning, Self::Error, Self::Fatal];

    /// Name in the model description; those that FMI 2.0 has standardised.
    pub fn name(self) -> &'static str {
        match self {
            Self::Events => "logEvents",
            Self::Warning => "logStatusWarning",
            Self::Error => "logStatusError",
            Self::Fatal => "logStatusFatal",
        }
    }

    /// Meaning, for people.
    pub fn doc(self) -> &'static str {
        match self {
            Self::Events => "Events of the process",
            Self::Warning => "Remarks on calls that were carried out",
            Self::Error => "Why a call was refused",
            Self::Fatal => "Why the unit stopped",
        }
    }
}

/// Where messages go: the importer's callback.
pub trait Sink: Send {
    /// Hands one message on.
    fn message(&self, status: Status, category: Category, text: &str);
}

/// The importer's callback with what it wants to hear.
pub struct Log {
    sink: Option<Box<dyn Sink>>,
    on: bool,
    /// Categories wanted.
    wanted: [bool; Category::ALL.len()],
}

impl Log {
    /// A log of all categories, silent unless `on`.
    pub fn new(sink: Option<Box<dyn Sink>>, on: bool) -> Self {
        Self { sink, on, wanted: [true; Category::ALL.len()] }
    }

    /// Chooses what is logged; no category at all means every one. False where a category is
    /// not known, which changes nothing.
    pub fn choose(&mut self, on: bool, categories: &[&str]) -> bool {
        let known = |name: &str| name == "logAll" || Category::ALL.iter().any(|each| each.name() == name);
        if !categories.iter().all(|name| known(name)) {
            return false;
        }
        self.on = on;
        let wants = |category: Category| categories.iter().any(|name| *name == "logAll" || *name == category.name());
        self.wanted = Category::ALL.map(|category| categories.is_empty() || wants(category));
        true
    }

    /// Says `text`, if it is wanted.
    pub fn say(&self, status: Status, category: Category, text: &str) {
        if let Some(sink) = &self.sink
            && self.on
            && self.wanted[category as usize]
        {
            sink.message(status, category, text);
        }
    }

    /// Whether a message of this category would be heard.
    pub fn hears(&self, category: Category) -> bool {
        self.on && self.sink.is_some() && self.wanted[category as usize]
    }
}
