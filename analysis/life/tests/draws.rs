//! Studies of tool lives whose edges are draws of a calibration.

use std::path::Path;
use toolroom_form::{FormFile, ReadError};
use toolroom_life::file::{StudyFile, parse};
use toolroom_life::study::edge::Draws;
use toolroom_scenario::{DrawTable, set_draw_reader};

const STUDY: &str = "schema = 1\nname = \"lives\"\nlives = 40\nparameter_set = \"c45_t15k6\"\n\
                     parameters_from = \"draws.parquet\"\nscatter = { allowance = \"0 mm\", piece_hardness = \"0\" }\n\
                     [[condition]]\ncutting_speed = \"220 m/min\"\n";

/// Three draws of which the fastest wears half as fast again by heat as the slowest.
fn draws(path: &Path) -> Result<DrawTable, String> {
    let rows = match path.file_name().and_then(|name| name.to_str()) {
        Some("draws.parquet") => ["1.0", "1.2", "1.5"],
        _ => return Err("cannot be read".to_owned()),
    };
    let header = ["energy_balance.thermal_wear_rate [um/min]", "edge_scatter", "law", "weight"];
    let row = |rate: &str| [rate, "0.2", "energy_balance", "1"].map(str::to_owned).to_vec();
    Ok(DrawTable { header: header.map(str::to_owned).to_vec(), rows: rows.map(row).to_vec() })
}

fn read(text: &str) -> Result<FormFile<StudyFile>, ReadError> {
    set_draw_reader(draws);
    parse("study.toml", text, Path::new(""), &[])
}

#[test]
fn each_edge_is_one_draw_the_same_under_every_condition() {
    let study = read(STUDY).expect("a study").content.study;
    assert_eq!(study.worlds.len(), 3);
    let point = vec![0.5; study.dimensions()];
    let life = |index: u64| study.live(&study.cells[0], index, &point, &mut Draws::of(study.seed, 7)).life;
    let mut lives = [0, 1, 2].map(life);
    assert_eq!(lives.map(f64::to_bits), [3, 4, 5].map(life).map(f64::to_bits), "draws are reused in order");
    lives.sort_by(f64::total_cmp);
    assert!(lives[0] < lives[1] && lives[1] < lives[2], "{lives:?}");
    // The slowest draw is near the set's own rate, so that all lives are of its order.
    let plain = read(&STUDY.replace("parameters_from = \"draws.parquet\"\n", "")).expect("a study").content.study;
    let life = plain.live(&plain.cells[0], 0, &point, &mut Draws::of(study.seed, 7)).life;
    assert!(lives[0] < life && life < lives[2], "{life} among {lives:?}");
}

#[test]
fn what_does_not_go_with_draws_is_refused() {
    for (text, reason) in [
        (STUDY.replace("draws.parquet", "none.parquet"), "cannot be read"),
        (format!("{STUDY}[early]\nage = \"8 min\"\nwear_shift = 3\nchipping_rate = 30\n"), "parameters_from"),
        (
            STUDY.replace(
                "scatter = ",
                "parameters = { energy_balance = { thermal_wear_rate = \"1 um/min\" } }\nscatter = ",
            ),
            "which the draws hold as well",
        ),
    ] {
        let refused = read(&text).expect_err("a refusal");
        let message = format!("{refused:?}");
        assert!(message.contains(reason), "{reason}: {message}");
    }
}
