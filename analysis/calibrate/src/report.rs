//! The report of a calibration.

use crate::calibration::Calibration;
use crate::model::Model;
use crate::summary::with_unit;
use crate::wear_model::WearModel;
use toolroom_chart::page::{Figure, Report, Section, Tile};
use toolroom_chart::{Axis, Cell, Estimate, Intervals, Plot, Style, Table, number};

/// Edges that are drawn one by one; the others are in the table.
const DRAWN: usize = 6;
/// Draws of a cloud.
const CLOUD: usize = 600;
/// Points of a curve.
const POINTS: usize = 60;

impl Calibration {
    /// The report; the caller adds where the numbers come from.
    pub fn report(&self) -> Report {
        let coverage = &self.coverage;
        let mut report = Report::new("Calibration of a wear law").lead(self.sentence()).tile(Tile::new(
            "edges",
            self.measured.edges.len().to_string(),
            format!("{} readings", self.measured.readings()),
        ));
        if let Some(life) = self.lives.get(self.lives.len() / 2) {
            let speed = number(life.condition.cut.cutting_speed * 60.0, 4);
            let band = format!("90 %: {} … {}", number(life.ci90[0], 3), number(life.ci90[1], 3));
            report = report.tile(Tile::new(
                format!("life at {speed} m/min"),
                format!("{} {}", number(life.median, 3), self.measured.clock.unit()),
                band,
            ));
        }
        if coverage.readings > 0 {
            let inside = format!("{:.0} %", 100.0 * coverage.inside90);
            report = report.tile(Tile::new(
                "left-out readings in their 90 % band",
                inside,
                format!("{} readings", coverage.readings),
            ));
        }
        report = report.section(self.answers()).section(self.life_section());
        if self.measured.readings() > 0 {
            report = report.section(self.edges_section());
        }
        report = report.section(self.parameter_section());
        if !self.channels.is_empty() {
            report = report.section(self.channels_section());
        }
        if self.choice.scores.len() > 1 { report.section(self.law_section()) } else { report }
    }

    fn answers(&self) -> Section {
        let mut section = Section::new("What the data determine, and what not");
        for warning in self.warnings() {
            section = section.warning(warning);
        }
        for refusal in &self.measured.refusals {
            section = section.note(format!("Cannot tell: {refusal}."));
        }
        for note in &self.measured.notes {
            section = section.note(note.clone());
        }
        let (speed, deviation) = self.best_known;
        section.paragraph(format!(
            "The life is known best at {speed:.0} m/min, where one standard deviation is {:.0} %.",
            100.0 * deviation
        ))
    }

    fn life_section(&self) -> Section {
        let model = &self.carried().model;
        let speeds: Vec<f64> = self.lives.iter().map(|life| life.condition.cut.cutting_speed * 60.0).collect();
        let (low, high) = (speeds[0], speeds[speeds.len() - 1]);
        let (from, to) = (low / 1.3, high * 1.3);
        let condition = self.lives[0].condition;
        let cut = condition.cut;
        let unit = self.measured.clock.unit();
        let steps: Vec<f64> = (0..=20).map(|step| from * (to / from).powf(f64::from(step) / 20.0)).collect();
        let at = |speed: &f64| {
            let life = crate::calibration::life_at(model, &self.posterior, condition.at_speed(speed / 60.0), false, 1);
            (*speed, life)
        };
        let lives: Vec<_> = steps.iter().map(at).collect();
        let plot = Plot::new(
            "Life of an edge against cutting speed",
            Axis::log("Cutting speed", "m/min"),
            Axis::log("Life", unit),
        )
        .describe("Median life with the 90 % bands of what is known and of the next edge; dotted lines bound the tested speeds.")
        .band("next edge, 90 %", lives.iter().map(|(v, life)| (*v, life.next_edge90[0], life.next_edge90[1])), Style::nth(2))
        .band("median, 90 %", lives.iter().map(|(v, life)| (*v, life.ci90[0], life.ci90[1])), Style::nth(1))
        .line("median", lives.iter().map(|(v, life)| (*v, life.median)), Style::nth(0));
        let plot = if high > low {
            plot.vertical(low, "slowest tested").vertical(high, "fastest tested")
        } else {
            plot.vertical(low, "tested")
        };
        let caption = format!(
            "At a feed of {} mm and a depth of {} mm. Outside the tested speeds the law extrapolates.",
            number(cut.feed_per_rev * 1e3, 3),
            number(cut.depth_of_cut * 1e3, 3)
        );
        Section::new("Life").figure(Figure::new(&plot, caption))
    }

    fn edges_section(&self) -> Section {
        let fit = self.carried();
        let mut section = Section::new("Wear of each edge").paragraph(
            "Each band is predicted by the other edges alone: the edge in the picture was left out of the fit. The first \
             edges are drawn.",
        );
        let read = fit.model.measured().iter().zip(&fit.left_out).filter(|(edge, _)| edge.readings() > 1);
        for (edge, left) in read.take(DRAWN) {
            let times = crate::edge::reading_times(edge);
            let values: Vec<f64> = edge.stretches.iter().filter_map(|stretch| stretch.wear).collect();
            let band = times.iter().zip(&left.bands).map(|(time, band)| (*time, band[0], band[2]));
            let fitted = fit.model.fitted(self.posterior.map.u.as_slice(), edge, POINTS);
            let plot = Plot::new(
                format!("Edge {}", edge.name),
                Axis::linear("Cutting time", self.measured.clock.unit()),
                Axis::linear("Flank wear VB", "mm"),
            )
            .height(180.0)
            .describe("Measured wear, the fit with the level of the edge, and the prediction without the edge.")
            .band("edge left out, 90 %", band, Style::nth(2))
            .line("fit", fitted, Style::nth(0))
            .scatter("measured", times.iter().copied().zip(values), Style::nth(1))
            .horizontal(self.request.limit, "limit");
            section = section.figure(Figure::new(&plot, format!("Log score of the edge left out: {:.1}.", left.score)));
        }
        section
    }

    fn parameter_section(&self) -> Section {
        let parameters = self.carried().model.parameters();
        let mut chart = Intervals::new("Parameters", Axis::linear("Distance from the prior mean", "prior deviations"))
            .reference(0.0, "prior mean");
        let mut table = Table::new(["parameter", "maximum", "5 %", "95 %", "prior left", "known"]);
        for (index, parameter) in parameters.iter().enumerate() {
            let prior = &parameter.prior;
            let distance = |u: f64| (u - prior.mean) / prior.deviation;
            let [map, low, high] = [
                self.posterior.map.u[index],
                self.posterior.quantile(index, 0.05),
                self.posterior.quantile(index, 0.95),
            ];
            chart = chart.row(parameter.name.clone(), Estimate::new(distance(map), distance(low), distance(high)));
            let value = |u: f64| Cell::from(parameter.scale.value(u));
            table.push([
                with_unit(parameter).into(),
                value(map),
                value(low),
                value(high),
                self.identifiability.shrink[index].into(),
                Cell::from(if self.identifiability.determined(index) { "yes" } else { "no: the prior" }),
            ]);
        }
        let caption =
            "90 % intervals; the prior reaches from −1.6 to 1.6. A parameter that fills it is not determined.";
        let mut section = Section::new("Parameters")
            .figure(Figure::new(&chart, caption))
            .table("In the units of the parameter file.", table);
        if let Some((a, b, correlation)) = self.identifiability.correlations.first() {
            let point = |index: usize, u: f64| parameters[index].scale.value(u);
            let cloud = self.posterior.draws.iter().take(CLOUD).map(|draw| (point(*a, draw[*a]), point(*b, draw[*b])));
            let axis = |index: usize| {
                let unit = parameters[index].unit;
                Axis::linear(parameters[index].name.clone(), if unit == "1" { "" } else { unit })
            };
            let plot = Plot::new("The most correlated pair", axis(*a), axis(*b))
                .describe("Draws of the posterior of two parameters.")
                .scatter("draws", cloud, Style::nth(0));
            section = section.figure(Figure::new(&plot, format!("Correlation {correlation:.2}.")));
        }
        section
    }

    /// Every channel against the wear that was fitted, over what a sharp edge shows under the same cut.
    fn channels_section(&self) -> Section {
        let mut section = Section::new("Forces and temperatures against wear").paragraph(
            "Each reading stands over what a sharp edge of usual level shows under the same cut, so that cuts of different speeds and feeds \
             lie on one picture. The wear is that of the fitted curve and not a reading, whose error would make the land look weaker.",
        );
        for fit in &self.channels {
            let model = &fit.model;
            let channel = model.channel().column().replace('_', " ");
            let points = model.over_sharp(fit.posterior.map.u.as_slice());
            let plot = Plot::new(
                format!("{channel} against wear"),
                Axis::linear("Flank wear VB, fitted", "mm"),
                Axis::linear(format!("{channel} over that of a sharp edge"), ""),
            )
            .describe("Readings and model, each over the model of a sharp edge.")
            .scatter("measured", points.iter().map(|(wear, read, _)| (*wear, *read)), Style::nth(1))
            .scatter("model", points.iter().map(|(wear, _, model)| (*wear, *model)), Style::nth(0))
            .horizontal(1.0, "sharp edge");
            let (gain, error) = fit.gain;
            let caption = format!(
                "Wear in the model predicts edges left out better by {} ± {} logarithms.",
                number(gain, 3),
                number(error, 2)
            );
            section = section.figure(Figure::new(&plot, caption));
            let mut table = Table::new(["parameter", "maximum", "5 %", "95 %", "prior left"]);
            for (index, parameter) in model.parameters().iter().enumerate() {
                let value = |u: f64| Cell::from(parameter.scale.value(u));
                table.push([
                    with_unit(parameter).into(),
                    value(fit.posterior.map.u[index]),
                    value(fit.posterior.quantile(index, 0.05)),
                    value(fit.posterior.quantile(index, 0.95)),
                    fit.identifiability.shrink[index].into(),
                ]);
            }
            section = section.table(format!("From {} edges.", model.edges()), table);
        }
        match self.temperatures() {
            Some(temperatures) => section.note(temperatures),
            None => section,
        }
    }

    fn law_section(&self) -> Section {
        let mut table = Table::new(["law", "score of edges left out", "behind the best", "standard error", "weight"]);
        for score in &self.choice.scores {
            table.push([
                score.candidate.name().into(),
                score.elpd.into(),
                score.margin.into(),
                score.error.into(),
                score.weight.into(),
            ]);
        }
        let mut chart =
            Intervals::new("How far each law is behind the best", Axis::linear("Logarithms of density", ""))
                .reference(0.0, "best");
        for score in &self.choice.scores {
            let half = 1.645 * score.error;
            chart = chart
                .row(score.candidate.name(), Estimate::new(score.margin, score.margin - half, score.margin + half));
        }
        Section::new("Choice of the law")
            .figure(Figure::new(
                &chart,
                "90 % intervals from the differences edge by edge; each edge was predicted by a fit without it.",
            ))
            .table("Joint log predictive density of all readings of each edge, summed over edges.", table)
    }
}

impl WearModel {
    /// Points of the wear curve of an edge at the level that fits it best, over its cutting time.
    fn fitted(&self, u: &[f64], edge: &crate::edge::Edge, points: usize) -> Vec<(f64, f64)> {
        let level = self.level(u, edge);
        let total: f64 = edge.stretches.iter().map(|stretch| stretch.time).sum();
        let mut fine = edge.clone();
        let pieces = points.div_ceil(edge.stretches.len()).max(1);
        fine.stretches = edge
            .stretches
            .iter()
            .flat_map(|stretch| {
                let part = crate::edge::Stretch { time: stretch.time / pieces as f64, wear: Some(0.0), ..*stretch };
                std::iter::repeat_n(part, pieces)
            })
            .collect();
        let wear = self.course(u, &fine, level);
        let times = crate::edge::reading_times(&fine);
        std::iter::once((0.0, 0.0))
            .chain(times.into_iter().zip(wear))
            .filter(|(time, _)| *time <= total * 1.001)
            .collect()
    }
}
