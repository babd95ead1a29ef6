//! A snapshot read back is the shop that was taken, and every other one is refused.

use tempfile::TempDir;
use toolroom_scenario_file::read;
use toolroom_snapshot::{Snapshot, SnapshotError, instant};

const SHOP: &str = "schema = 1\n[shop]\nname = \"q\"\nhorizon = \"100 h\"\nreplications = 3\n\
    [[machine]]\nname = \"M\"\nprocess = \"plain\"\n[[part]]\nname = \"p\"\n\
    [[part.operation]]\nname = \"work\"\nmachines = [\"M\"]\nwork = { distribution = \"exponential\", mean = \"8 min\" }\n\
    [[arrivals]]\npart = \"p\"\npattern = \"poisson\"\nrate = \"6 1/h\"\n";

fn taken(folder: &TempDir) -> Snapshot {
    let path = folder.path().join("shop.toml");
    std::fs::write(&path, SHOP).unwrap();
    let file = read(&path, &[]).unwrap();
    Snapshot::take("1.0", &path, &file, Vec::new(), &[0], instant(&file.scenario, "40 h").unwrap()).unwrap()
}

#[test]
fn the_same_shop_is_recognised_and_another_one_is_not() {
    let folder = TempDir::new().unwrap();
    let snapshot = taken(&folder);
    let path = folder.path().join("s.trs");
    std::fs::write(&path, snapshot.text().unwrap()).unwrap();
    let read_back = Snapshot::read(&path, "1.0").unwrap();
    assert_eq!(read_back, snapshot);
    let file = read_back.scenario(&["shop.horizon=\"200 h\"".to_owned()]).unwrap();
    read_back.verify(&file.scenario, &[0]).expect("a later end changes nothing before");
    let scenario = read_back.scenario(&["shop.seed=2".to_owned()]).unwrap();
    let told = read_back.verify(&scenario.scenario, &[0]).unwrap_err().to_string();
    assert_eq!(told, "replication 0 under policy \"programmed\" is not the run of the snapshot");
}

#[test]
fn another_version_a_changed_scenario_and_a_wrong_instant_are_refused() {
    let folder = TempDir::new().unwrap();
    let snapshot = taken(&folder);
    let path = folder.path().join("s.trs");
    std::fs::write(&path, snapshot.text().unwrap()).unwrap();
    let told = Snapshot::read(&path, "1.1").unwrap_err().to_string();
    assert!(told.contains("version 1.0") && told.contains("version 1.1"), "{told}");
    std::fs::write(&path, "{}").unwrap();
    assert!(Snapshot::read(&path, "1.0").unwrap_err().to_string().contains("no snapshot"));
    std::fs::write(&snapshot.file, SHOP.replace("8 min", "7 min")).unwrap();
    assert!(matches!(snapshot.scenario(&[]), Err(SnapshotError::Changed { .. })));
    std::fs::write(&snapshot.file, SHOP).unwrap();
    let scenario = snapshot.scenario(&[]).unwrap().scenario;
    for text in ["2026-04-01 06:00", "100 h", "-1 h", "soon"] {
        assert!(matches!(instant(&scenario, text), Err(SnapshotError::Instant { .. })), "{text}");
    }
}
