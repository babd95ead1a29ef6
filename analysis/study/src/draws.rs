//! Draws of a posterior from Parquet files, for scenarios whose tools name them.

use std::path::Path;
use toolroom_scenario::{DrawTable, set_draw_reader};

/// Names the reader of this crate as the one of this program: from then on scenarios read `parameters_from`.
pub fn register() {
    set_draw_reader(read);
}

fn read(path: &Path) -> Result<DrawTable, String> {
    let table = toolroom_parquet::read_cells(path).map_err(|error| error.to_string())?;
    let rows = table.rows.into_iter().map(|(_, cells)| cells).collect();
    Ok(DrawTable { header: table.header, rows })
}
