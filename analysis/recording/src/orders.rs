//! Jobs that came to the shop, one row each.

use crate::Run;
use toolroom_records::{RecordKind, Records};
use toolroom_shop::runlog::WholeJob;

/// The jobs, in the order of their part and arrival. What an inspection divided from one belongs to it.
pub fn orders(run: &Run<'_>) -> Records {
    let mut jobs: Vec<WholeJob> = run.log.whole_jobs();
    let row = |job: &WholeJob| &run.log.jobs[job.number];
    let part = |job: &WholeJob| run.scenario.parts[row(job).part as usize].name.as_str();
    jobs.sort_by(|a, b| part(a).cmp(part(b)).then(row(a).arrival.total_cmp(&row(b).arrival)));
    let name = |job: &WholeJob| {
        let order = row(job).order.and_then(|index| run.scenario.orders.get(index as usize));
        order.map_or_else(|| format!("J{}", job.number), |order| order.id.clone())
    };
    let mut records = Records::new(RecordKind::Orders, jobs.len());
    records.set_texts("order", jobs.iter().map(name).collect());
    records.set_texts("part_type", jobs.iter().map(|job| part(job).to_owned()).collect());
    records.set_numbers("arrival_time", jobs.iter().map(|job| row(job).arrival).collect());
    records.set_numbers("start_time", jobs.iter().map(|job| row(job).start).collect());
    records.set_numbers("finish_time", jobs.iter().map(|job| job.finish).collect());
    records.set_numbers("quantity", jobs.iter().map(|job| f64::from(job.quantity)).collect());
    records.set_numbers("scrapped_quantity", jobs.iter().map(|job| f64::from(job.scrapped)).collect());
    records
}
