use super::*;
use crate::sidecar::{TAIL, part, read_sidecar, sealed};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::path::{Path, PathBuf};

/// A directory of its own for each test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("toolroom-shards-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn plan() -> Plan {
    Plan {
        schema: 1,
        kind: Work::Life,
        version: "0".to_owned(),
        name: "small".to_owned(),
        file: "small.toml".to_owned(),
        directory: String::new(),
        text: "schema = 1".to_owned(),
        files: Vec::new(),
        overrides: Vec::new(),
        seed: 7,
        policies: Vec::new(),
        axis: None,
        pieces: 5,
        shards: 2,
    }
}

/// One number a piece, whose bits add up to the digest.
fn digest(content: &[f64], (from, to): (u64, u64)) -> Result<u64, String> {
    if content.len() as u64 != to - from {
        return Err(format!("it holds {} numbers, not {}", content.len(), to - from));
    }
    Ok(content.iter().fold(0, |sum: u64, value| sum.wrapping_add(value.to_bits())))
}

fn fill(plan: &Plan, folder: &Folder, rows: bool) {
    for shard in 0..plan.shards {
        let compute = |(from, to): (u64, u64), draft: &Path| {
            let content: Vec<f64> = (from..to).map(|piece| 0.1 + piece as f64).collect();
            if rows {
                fs::write(draft, format!("rows {from} to {to}")).map_err(at(draft))?;
            }
            let digest = digest(&content, (from, to)).expect("its own content");
            Ok(Computed { content, digest, rows })
        };
        run(plan, shard, &folder.0, compute).expect("a part");
    }
}

fn merged(plan: &Plan, folder: &Folder) -> Result<Vec<Vec<f64>>, ShardError> {
    parts(plan, &folder.0, |content: &Vec<f64>, range| digest(content, range))
}

#[test]
fn a_part_with_a_changed_byte_or_a_cut_end_is_refused_by_its_name() {
    let (plan, folder) = (plan(), Folder::new("bytes"));
    fill(&plan, &folder, false);
    assert_eq!(merged(&plan, &folder).expect("whole parts").concat(), [0.1, 1.1, 2.1, 3.1, 4.1]);
    let path = part(&folder.0, 1, "json");
    let whole = fs::read(&path).expect("a part");
    let refused = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("a file");
        let error = merged(&plan, &folder).expect_err("a changed part");
        assert!(error.to_string().contains("part-000001.json"), "{error}");
        assert!(!is_done::<Vec<f64>>(&plan, 1, &folder.0));
    };
    let mut random = ChaCha8Rng::seed_from_u64(11);
    for end in 0..whole.len() {
        refused(&whole[..end]);
        let mut changed = whole.clone();
        changed[end] ^= random.random_range(1..=255_u8);
        refused(&changed);
        changed = whole.clone();
        changed.remove(end);
        refused(&changed);
        changed = whole.clone();
        changed.insert(end, random.random());
        refused(&changed);
    }
    refused(&[&whole[..], b"\n"].concat());
    // Its shard run again is the part that it was.
    fill(&plan, &folder, false);
    assert_eq!(fs::read(&path).expect("a part"), whole);
    assert!(merged(&plan, &folder).is_ok());
}

#[test]
fn a_whole_part_that_is_not_that_of_its_shard_is_refused_by_its_name() {
    let (plan, folder) = (plan(), Folder::new("content"));
    fill(&plan, &folder, false);
    let path = part(&folder.0, 1, "json");
    let original: Sidecar<Vec<f64>> = read_sidecar(&path).expect("a part");
    type Change = fn(&mut Sidecar<Vec<f64>>);
    let said = |change: Change| {
        let mut sidecar = original.clone();
        change(&mut sidecar);
        fs::write(&path, sealed(&sidecar).expect("JSON")).expect("a file");
        merged(&plan, &folder).expect_err("another part").to_string()
    };
    let faults: [(&str, Change); 10] = [
        ("schema", |part| part.schema = 1),
        ("another plan", |part| part.plan = "0".to_owned()),
        ("version", |part| part.version = "1".to_owned()),
        ("number of shards", |part| part.shards = 3),
        ("seed", |part| part.seed = 8),
        ("pieces", |part| part.range = (2, 4)),
        ("digest", |part| part.digest = String::new()),
        ("digest", |part| part.content[0] += 1e-12),
        ("it holds 2 numbers, not 3", |part| part.content.truncate(2)),
        ("it holds 4 numbers, not 3", |part| part.content.push(0.0)),
    ];
    for (word, change) in faults {
        let said = said(change);
        assert!(said.contains(word) && said.contains("part-000001.json"), "{word}: {said}");
    }
    assert!(said(|part| part.shard = u64::MAX).contains("does not exist"));
    assert!(said(|part| part.shard = 0).contains("twice"));
    // Content of another kind of work.
    let text = sealed(&original).expect("JSON").replace("[2.1,", "[{},");
    let other = resealed(&text);
    fs::write(&path, other).expect("a file");
    let error = merged(&plan, &folder).expect_err("another kind");
    assert!(matches!(error, ShardError::Malformed { .. }), "{error}");
}

/// The text with the hash that it should have.
fn resealed(text: &str) -> String {
    let body = &text[..text.len() - TAIL[0].len() - 16 - TAIL[1].len()];
    format!("{body}{}{}{}", TAIL[0], fingerprint(body.as_bytes()), TAIL[1])
}

#[test]
fn rows_that_are_changed_cut_or_gone_are_refused_by_their_name() {
    let (plan, folder) = (plan(), Folder::new("rows"));
    fill(&plan, &folder, true);
    assert!(merged(&plan, &folder).is_ok());
    let path = part(&folder.0, 0, "parquet");
    let whole = fs::read(&path).expect("rows");
    for offset in 0..whole.len() {
        let mut changed = whole.clone();
        changed[offset] ^= 1;
        for bytes in [&whole[..offset], &changed] {
            fs::write(&path, bytes).expect("a file");
            let error = merged(&plan, &folder).expect_err("changed rows");
            assert!(error.to_string().contains("part-000000.parquet"), "{error}");
        }
    }
    fs::remove_file(&path).expect("a file");
    assert!(matches!(merged(&plan, &folder), Err(ShardError::Changed { shard: 0, .. })));
}

#[test]
fn a_plan_of_no_shards_or_of_very_many_is_no_panic() {
    let folder = Folder::new("plans");
    fill(&plan(), &folder, false);
    for shards in [0, u64::MAX] {
        let other = Plan { shards, ..plan() };
        assert!(matches!(merged(&other, &folder), Err(ShardError::OtherPlan { .. })));
    }
}

#[test]
fn a_file_of_somebody_in_the_place_of_a_part_stays() {
    let (plan, folder) = (plan(), Folder::new("somebody"));
    let path = part(&folder.0, 1, "json");
    for text in ["my notes", "{\"recipe\": 7}"] {
        fs::write(&path, text).expect("a file");
        let compute = |_: (u64, u64), _: &Path| Ok(Computed { content: vec![0.0], digest: 0, rows: false });
        let error = run(&plan, 1, &folder.0, compute).expect_err("a file that is no part");
        assert!(matches!(error, ShardError::NoPart { .. }), "{error}");
        assert_eq!(fs::read_to_string(&path).expect("the file"), text);
    }
}
