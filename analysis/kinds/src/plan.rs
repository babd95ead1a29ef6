//! Plans of shards: JSON that `--plan` writes, and that `shard` and `merge` read.

use crate::places::{key, refused};
use crate::{CheckResult, FileKind, KindError, SchemaSource, checked};
use std::path::Path;
use toolroom_form::{ReadError, Refusal};
use toolroom_shards::{Plan, Work};

/// A text in JSON that is broken is taken for a plan.
pub const KIND: FileKind = FileKind {
    word: "plan",
    doc: "A plan of shards, which --plan of life, compare and lobes writes",
    signs: &["pieces", "shards"],
    read: Some(check),
    form: SchemaSource::Text(include_str!("../../../scenarios/schema/plan.schema.json")),
};

/// What `check` says of a plan: whether a shard of it would begin.
fn check(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    if !set.is_empty() {
        return Err(KindError::Unchangeable { kind: "plan" });
    }
    let text = toolroom_form::text(path)?;
    let plan: Plan = serde_json::from_str(&text).map_err(|error| {
        let place = (error.line().max(1), error.column().max(1));
        refused(path, &text, place, Refusal::new("plan", error))
    })?;
    plan.check(env!("CARGO_PKG_VERSION")).map_err(|error| {
        let refusal = Refusal::new("plan", format_args!("{error}; {}", error.fix()));
        refused(path, &text, key(&text, error.field()), refusal)
    })?;
    let work = content(&plan)?;
    let summary = format!("a plan of {} pieces of work in {} shards: {work}", plan.pieces, plan.shards);
    Ok(checked("plan", Some(&plan.name), Vec::new(), &summary))
}

/// What the work of a plan is, where the file that it holds can be read. Whether each variant of a comparison can be run, its
/// shards see.
fn content(plan: &Plan) -> Result<&'static str, ReadError> {
    match plan.kind {
        Work::Life => toolroom_life::study::shard::study(plan).map(|_| "lives of each cell of a study"),
        Work::Compare => toolroom_scenario_file::parse(&plan.file, &plan.text, &plan.overrides)
            .map(|_| "replications of a comparison"),
        Work::Lobes => toolroom_planning::lobes::chart(plan).map(|_| "columns of a stability chart"),
    }
}

#[cfg(test)]
mod tests {
    use crate::{FileKind, SchemaSource};
    use serde_json::{Value, json};
    use std::path::PathBuf;
    use toolroom_shards::{Axis, PLAN, Plan, Work};

    fn plan() -> Plan {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/life/policies.toml");
        let text = toolroom_life::file::StudyText::open(&path).expect("a study");
        let file = text.parse(&[]).expect("a study");
        toolroom_life::study::shard::plan(env!("CARGO_PKG_VERSION"), text, &file, Vec::new(), Some(4)).expect("a plan")
    }

    /// What `check` says of a plan as JSON.
    fn said(value: &Value) -> Result<String, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("plan.json");
        std::fs::write(&path, serde_json::to_string_pretty(value).expect("JSON")).expect("written");
        let kind = FileKind::from_path(&path).expect("a kind");
        assert_eq!(kind.word, "plan");
        (kind.read.expect("a reader"))(&path, &[]).map(|checked| checked.summary).map_err(|error| error.to_string())
    }

    #[test]
    fn a_plan_is_checked_as_its_shards_would_read_it() {
        let whole = json!(plan());
        assert!(said(&whole).expect("a plan").contains("4 shards"));
        let changed = |field: &str, value: Value| {
            let mut other = whole.clone();
            other[field] = value;
            said(&other).expect_err(field)
        };
        assert!(changed("kind", json!("lif")).contains("`lif`"));
        assert!(changed("version", json!("0.0.0")).contains("version 0.0.0"));
        assert!(changed("schema", json!(7)).contains("format 7"));
        assert!(changed("shards", json!(0)).contains("0 shards"));
        assert!(changed("text", json!("lives = -1")).contains("policies.toml"));
        assert!(changed("files", json!([["gone.csv", "0"]])).contains("gone.csv"));
        let mut short = whole.clone();
        short.as_object_mut().expect("an object").remove("text");
        assert!(said(&short).expect_err("a plan without text").contains("`text`"));
    }

    #[test]
    fn the_schema_of_plans_has_their_fields_and_words() {
        let kind = FileKind::named("plan").expect("plans");
        assert!(matches!(kind.form, SchemaSource::Text(_)));
        let schema = kind.schema();
        let fields = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
        let plan = Plan { schema: PLAN, ..plan() };
        assert_eq!(schema["required"].as_array().map(Vec::len), Some(fields(&json!(plan)).len()));
        let both = Plan { axis: Some(Axis::Both), ..plan };
        assert_eq!(fields(&schema["properties"]), fields(&json!(both)));
        assert_eq!(schema["properties"]["kind"]["enum"], json!([Work::Life, Work::Compare, Work::Lobes]));
    }
}
