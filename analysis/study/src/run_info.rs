//! How a study came to be run.

use serde_json::Value;

/// How a study came to be run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunInfo {
    /// Version of the program.
    pub version: String,
    /// The command line as given.
    pub command: String,
    /// The command line without what does not change the results (threads, place), for the
    /// report.
    pub reproduce: String,
    /// Name and hash of each input, for example by [`fingerprint`](toolroom_shards::fingerprint).
    pub inputs: Vec<(String, String)>,
    /// Everything that the results depend on, in the words of whoever asked: kept in `run.json`
    /// for going on with the study.
    pub asked: Value,
    /// Part of the first run that `trace.json` shows, s from its start; `None`: its first week.
    pub trace: Option<[f64; 2]>,
    /// Why the study ended before its last replication, where a shop stopped.
    pub stopped: Option<String>,
}
