//! Infeed, force, size and temperature of a cycle over time, and the report around them.

use super::CycleDesign;
use super::text::phase_names;
use crate::tables::{input_table, push_record};
use toolroom_chart::page::{Figure, Provenance, Report, Section, Tile};
use toolroom_chart::{Axis, Colour, Dash, Plot, Style, Table};
use toolroom_infeed::CyclePoint;

const UM: f64 = 1e6;

/// The report of a cycle design.
pub(super) fn report(design: &CycleDesign, provenance: Provenance) -> Report {
    let (cycle, limits) = (&design.cycle, &design.file.limits);
    let title = if design.file.title.is_empty() { design.name.as_str() } else { design.file.title.as_str() };
    let mut report = Report::new(title)
        .lead(format!(
            "The fastest cycle within the limits takes {} work revolutions, {:.2} s. It is exact: every finish infeed the \
             machine can set and every number of rough and finish revolutions was compared.",
            cycle.revolutions, cycle.time
        ))
        .tile(Tile::new("cycle", format!("{:.2} s", cycle.time), format!("{} revolutions", cycle.revolutions)))
        .tile(Tile::new(
            "size error",
            format!("{:.3} um", cycle.size_error * UM),
            format!("at most {:.3}", limits.size_error * UM),
        ))
        .tile(Tile::new(
            "last depth",
            format!("{:.3} um", cycle.last_depth * UM),
            format!("at most {:.3}", limits.last_depth * UM),
        ))
        .tile(Tile::new(
            "temperature rise",
            format!("{:.0} K", cycle.peak_temperature_rise),
            format!("at most {:.0}", limits.rough_temperature_rise),
        ));
    if let Some([_, exact]) = &design.dressing {
        let note = format!("{:.2} s a part with its share", exact.time_per_part);
        report = report.tile(Tile::new("dress after", format!("{} parts", exact.parts), note));
    }
    let [infeed, size, force, temperature, power] = courses(design);
    let mut section = Section::new("The cycle").table("Phases", phases(design));
    for warning in design.warnings() {
        section = section.warning(warning);
    }
    report = report.section(
        section
            .figure(Figure::new(&infeed, "The stock follows the command and catches up in spark-out.").data_in("cycle.csv"))
            .figure(Figure::new(&size, "Radius left above the command: deflection, wheel wear and threshold force.").data_in("cycle.csv"))
            .figure(Figure::new(&force, "Normal force at the end of each revolution.").data_in("cycle.csv"))
            .figure(Figure::new(&power, "Power of the wheel spindle at the end of each revolution.").data_in("cycle.csv"))
            .figure(
                Figure::new(
                    &temperature,
                    "Temperature rise of the grinding zone. The finish limit holds for the depth to which the finish phase \
                     tends: what roughing heats beyond it, the finish stock takes away.",
                )
                .data_in("cycle.csv"),
            ),
    );
    if let Some(intervals) = &design.dressing {
        let [estimate, exact] = intervals;
        let over =
            |course: &[f64]| (1u32..).zip(course).map(|(parts, time)| (f64::from(parts), *time)).collect::<Vec<_>>();
        // One part between dressings costs a dressing each: the scale is that of the rest.
        let top = 2.0 * exact.time_per_part;
        let plot = Plot::new(
            "Time of a part against the dressing interval",
            Axis::linear("Parts between dressings", ""),
            Axis::linear("Time of a part", "s").range(0.0, top),
        )
        .line("with its share of the dressing, exact cycles", over(&exact.course), Style::nth(0))
        .line("with its share of the dressing, estimated cycles", over(&estimate.course), Style::nth(1))
        .line("cycle of that part", over(&exact.cycle_times), Style::nth(0).colour(Colour::Ink).dash(Dash::Dotted))
        .vertical(f64::from(exact.parts), format!("best: {}", exact.parts))
        .describe("Mean time of a part with its share of the dressing over the number of parts between dressings.");
        report = report.section(
            Section::new("When to dress")
                .paragraph(
                    "A dull wheel cuts hotter and lags more, so each part takes longer than the one before; a dressing \
                     takes its time too. Estimated cycles have broken numbers of revolutions, exact cycles whole ones.",
                )
                .figure(
                    Figure::new(&plot, "The least is flat: a few parts more or less cost little.")
                        .data_in("dressing.csv"),
                ),
        );
    }
    report
        .section(Section::new("Inputs").table("Every value as it was understood", inputs(design)))
        .provenance(provenance)
}

/// Infeed, size, force, temperature and power over time.
fn courses(design: &CycleDesign) -> [Plot; 5] {
    let (cycle, limits) = (&design.cycle, &design.file.limits);
    let over = |value: fn(&CyclePoint) -> f64| cycle.course.iter().map(move |point| (point.time, value(point)));
    let time = || Axis::linear("Time since first contact", "s");
    let phased = |plot: Plot| {
        let names = phase_names(cycle);
        let kinds = names.iter().enumerate().map(|(i, name)| ((*name).to_owned(), Style::nth(i + 3)));
        let mut start = 0;
        let intervals = cycle.phases.iter().enumerate().map(|(i, phase)| {
            let from = cycle.course[start].time;
            start += phase.revolutions as usize;
            (from, cycle.course[start].time, i)
        });
        plot.strip("phase", kinds, intervals.collect::<Vec<_>>())
    };
    let infeed = Plot::new("Infeed and stock", time(), Axis::linear("Radius", "um"))
        .line(
            "commanded",
            over(|point| point.commanded_infeed * UM),
            Style::nth(0).colour(Colour::Ink).dash(Dash::Dashed),
        )
        .step("stock removed", over(|point| point.stock_removed * UM), Style::nth(0))
        .describe("Commanded infeed and stock removed over time, with the phases.");
    let size = Plot::new("Size error and depth of cut", time(), Axis::linear("Length", "um").include(0.0))
        .height(240.0)
        .step("size error", over(|point| point.size_error * UM), Style::nth(0))
        .step("depth of cut", over(|point| point.depth_of_cut * UM), Style::nth(1))
        .horizontal(limits.size_error * UM, "size limit at the end")
        .describe("Radius left above the commanded size, and depth of cut, over time.");
    let force = Plot::new("Normal force", time(), Axis::linear("Normal force", "N").include(0.0))
        .height(200.0)
        .step("normal force", over(|point| point.load.normal_force), Style::nth(0))
        .describe("Normal force over time.");
    let temperature = Plot::new("Temperature rise", time(), Axis::linear("Temperature rise", "K").include(0.0))
        .height(240.0)
        .step("grinding zone", over(|point| point.load.temperature_rise), Style::nth(1).dash(Dash::Solid))
        .horizontal(limits.rough_temperature_rise, "rough limit")
        .horizontal(limits.finish_temperature_rise, "finish limit")
        .describe("Temperature rise of the grinding zone over time, with both limits.");
    let power = Plot::new("Power", time(), Axis::linear("Power of the wheel spindle", "kW").include(0.0))
        .height(200.0)
        .step("power", over(|point| point.load.power * 1e-3), Style::nth(2))
        .describe("Power of the wheel spindle over time.");
    // A limit that limits nothing would only flatten the picture.
    let power = if limits.power < 1e6 { power.horizontal(limits.power * 1e-3, "limit") } else { power };
    [infeed, size, force, temperature, power].map(phased)
}

fn phases(design: &CycleDesign) -> Table {
    let cycle = &design.cycle;
    let period = std::f64::consts::TAU / design.file.input.work_rotation_speed;
    let mut table = Table::new([
        "phase",
        "infeed per revolution [um]",
        "revolutions",
        "time [s]",
        "feed [mm/min]",
        "stock at its end [um]",
    ]);
    let mut start = 0;
    for (name, phase) in phase_names(cycle).into_iter().zip(&cycle.phases) {
        start += phase.revolutions as usize;
        table.push([
            name.into(),
            (phase.infeed_per_rev * UM).into(),
            f64::from(phase.revolutions).into(),
            (f64::from(phase.revolutions) * period).into(),
            (phase.infeed_per_rev / period * 60e3).into(),
            (cycle.course[start].stock_removed * UM).into(),
        ]);
    }
    table
}

fn inputs(design: &CycleDesign) -> Table {
    let file = &design.file;
    let mut table = input_table();
    push_record(&mut table, "parameters", &file.grinding.parameters);
    push_record(&mut table, "conditions", &file.input);
    push_record(&mut table, "limits", &file.limits);
    if let Some(dressing) = &file.dressing {
        push_record(&mut table, "dressing", dressing);
    }
    if let Some(surface) = &file.surface {
        push_record(&mut table, "roughness", surface);
    }
    for effect in file.grinding.effects.iter() {
        push_record(&mut table, &format!("effect {}", effect.entry().id), effect.parameters());
    }
    table
}
