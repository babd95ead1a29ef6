//! A file that its reader accepts.

use crate::KindError;
use crate::warning::{Warning, unusual};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::Path;
use toolroom_form::Echo;

/// Reads a file with the values of `--set`.
pub type Reader = fn(&Path, &[String]) -> Result<CheckResult, KindError>;

/// A file that its reader accepts.
#[derive(Clone, Debug)]
pub struct CheckResult {
    /// Its values as they were understood, where the reader tells them.
    pub echo: Vec<Echo>,
    /// What programs are told beside file and verdict.
    pub result: Map<String, Value>,
    /// What people are told.
    pub summary: String,
}

/// What a reader found in a file of a kind: `name` is its own, if it has one.
pub fn checked(word: &str, name: Option<&str>, echo: Vec<Echo>, more: &str) -> CheckResult {
    let mut result = Map::new();
    result.insert("kind".to_owned(), json!(word));
    result.extend(name.map(|name| ("name".to_owned(), json!(name))));
    if !echo.is_empty() {
        result.insert("values".to_owned(), json!(echo));
    }
    let warnings = unusual(&echo);
    CheckResult { echo, result, summary: format!("valid: {more}") }.warned(&warnings)
}

impl CheckResult {
    /// The same with warnings, for people and programs.
    pub(crate) fn warned(mut self, warnings: &[Warning]) -> Self {
        if warnings.is_empty() {
            return self;
        }
        for warning in warnings {
            let _ = write!(self.summary, "\nwarning[{}]: {}", warning.code, warning.message);
        }
        let texts: Vec<&str> = warnings.iter().map(|warning| warning.message.as_str()).collect();
        let codes: Vec<&str> = warnings.iter().map(|warning| warning.code).collect();
        self.result.insert("warnings".to_owned(), json!(texts));
        self.result.insert("warning_codes".to_owned(), json!(codes));
        self
    }
}
