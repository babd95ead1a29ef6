//! Jobs that came to the shop, one row each.

use crate::Run;
use toolroom_records::{RecordKind, Records};

/// The jobs, in the order of their part and arrival. What an inspection divided from another one came with that.
pub fn orders(run: &Run<'_>) -> Records {
    let mut jobs: Vec<usize> =
        (0..run.log.jobs.len()).filter(|job| run.log.jobs[*job].divided_from.is_none()).collect();
    let part = |job: usize| run.scenario.parts[run.log.jobs[job].part as usize].name.as_str();
    jobs.sort_by(|a, b| part(*a).cmp(part(*b)).then(run.log.jobs[*a].arrival.total_cmp(&run.log.jobs[*b].arrival)));
    let rows = || jobs.iter().map(|job| &run.log.jobs[*job]);
    let name = |job: &usize| {
        let order = run.log.jobs[*job].order.and_then(|index| run.scenario.orders.get(index as usize));
        order.map_or_else(|| format!("J{job}"), |order| order.id.clone())
    };
    let mut records = Records::new(RecordKind::Orders, jobs.len());
    records.set_texts("order", jobs.iter().map(name).collect());
    records.set_texts("part_type", jobs.iter().map(|job| part(*job).to_owned()).collect());
    records.set_numbers("arrival_time", rows().map(|row| row.arrival).collect());
    records.set_numbers("start_time", rows().map(|row| row.start).collect());
    records.set_numbers("finish_time", rows().map(|row| row.finish).collect());
    records.set_numbers("quantity", rows().map(|row| f64::from(row.quantity)).collect());
    records
}
