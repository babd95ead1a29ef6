//! Nominal models from files, and the choice of groups.

use super::cutting::Cutting;
use super::empirical::{self, Empirical};
use super::given::FileNominal;
use super::grinding::Grinding;
use super::model_file_error::ModelFileError;
use super::program::{self, ProgramModel, Stretches};
use super::sheet::{randomness, settings};
use super::shop::{Shop, ShopModel};
use super::{Candidate, Declarations, EffectId, EffectRefusal, Forward, Point, Settings};
use std::path::Path;
use toolroom_cutting::{Milling, Turning};
use toolroom_effects::Definition;
use toolroom_form::{Form, Key, Kind, Outline, Section, Walk};
use toolroom_infeed::Infeed;
use toolroom_records::{RecordKind, Records};
use toolroom_scenario::{Calibration, GapSection, ProcessModel, Scenario, ToolType};
use toolroom_scenario_file::{self as file, GAP};

/// Stretches of part programs that are reported by name.
const PLACES: usize = 6;

/// The process behind a nominal model.
#[derive(Clone, Debug)]
pub enum NominalProcess {
    /// Turning.
    Turning(Box<Turning>),
    /// Milling.
    Milling(Box<Milling>),
    /// Plunge grinding.
    Grinding(Box<Infeed>),
    /// Power laws.
    Empirical,
    /// Part programs.
    Program(Box<ProgramModel>),
    /// The events of a shop.
    Shop(Box<Shop>),
}

/// A nominal model with its priors and sensors.
#[derive(Clone, Debug)]
pub struct NominalModel {
    /// The process.
    pub process: NominalProcess,
    /// Priors and sensors.
    pub settings: Settings,
    /// Effects, deviations and calibration of the file.
    pub stated: Declarations,
}

/// A process of a data set with its nominal model over its table.
pub struct ProcessData {
    /// `turning`, `grinding` …
    pub process: &'static str,
    /// The model, in parts that know nothing of each other; none where no row is of use.
    pub parts: Vec<Box<dyn Forward>>,
    /// What is said of the records whatever is found.
    pub notes: Vec<String>,
    /// Channels that were left out because no cut gives their numbers.
    pub impossible: usize,
}

impl ProcessData {
    /// The first row of the records in which an effect of a user gives no value, in the model as its file states it or at
    /// an ordinary size that the diagnosis tries.
    pub fn refusal(&self) -> Option<EffectRefusal> {
        let of_part = |part: &dyn Forward| {
            let frame = part.frame();
            let nominal = Point::nominal(part);
            let tried = |(index, own): (usize, &Candidate)| {
                let defined = frame.defined.iter().any(|definition| EffectId::from(*definition) == own.id);
                let sizes = [own.typical.min(own.greatest), (-own.typical).max(own.least)];
                let sized = |size: f64| {
                    let mut point = nominal.clone();
                    point.effects[index] = size;
                    point
                };
                sizes.into_iter().filter(|size| defined && *size != 0.0).map(sized).collect::<Vec<_>>()
            };
            let points = frame.candidates.iter().enumerate().flat_map(tried);
            let refusal = std::iter::once(nominal.clone()).chain(points).find_map(|point| part.refusal(&point))?;
            Some(EffectRefusal { row: frame.record_of(refusal.row), ..refusal })
        };
        self.parts.iter().find_map(|part| of_part(part.as_ref()))
    }
}

/// The form of a file of nothing but priors and sensors.
static PLAIN: Form = Form {
    title: "the nominal model",
    doc: "An empirical nominal model",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("gap", Kind::Table(&GAP), "Priors and sensors"),
    ],
};

impl NominalModel {
    /// Forms of files that are nominal models and nothing else: of power laws, and of part programs.
    pub const FORMS: [&'static Form; 2] = [&PLAIN, &program::FORM];

    /// The model in which these effects, by id and shape of a candidate, are tried on each machine, part, material, lot,
    /// shift and operator of the records by itself as well, and from dates on, and every effect on the `places`, each a
    /// level of a column. Turning and milling only: shops try them
    /// always, other processes never.
    #[must_use]
    pub fn splitting(mut self, effects: Vec<(EffectId, String)>, places: Vec<(String, String)>) -> Self {
        (self.stated.split, self.stated.places) = (effects, places);
        self
    }

    /// The model with effects that a user has defined beside its file, from other files.
    ///
    /// # Errors
    /// [`ModelFileError::Defined`] where two of them have one id.
    pub fn with_effects(mut self, file: &Path, defined: &[&'static Definition]) -> Result<Self, ModelFileError> {
        for definition in defined {
            let known = self.stated.defined.iter().find(|known| known.entry().id == definition.entry().id);
            match known {
                None => self.stated.defined.push(definition),
                Some(known) if *known == *definition => {}
                Some(_) => {
                    return Err(ModelFileError::Defined {
                        file: file.display().to_string(),
                        id: definition.entry().id.to_owned(),
                    });
                }
            }
        }
        Ok(self)
    }

    /// Reads a scenario with a section `[gap]`, or a file of nothing but that section.
    ///
    /// # Errors
    /// [`ModelFileError`]: every fault of the file, no tool of the process, a sensor's unit.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, ModelFileError> {
        let path = &*toolroom_form::place_of(path);
        let file = path.display().to_string();
        // A file that cannot be read is refused by the reader of scenarios.
        let outline = Outline::read(path).ok();
        if outline.as_ref().is_some_and(is_program) {
            let directory = path.parent().unwrap_or(Path::new("."));
            let resolve = |walk: &mut Walk, root: &Section<'_>| Some(of_program(walk, root, directory));
            let (section, model) = toolroom_form::read(path, overrides, &program::FORM, resolve)?.content;
            return Self::of_programs(&file, section, model);
        }
        if outline.as_ref().is_some_and(is_plain) {
            let read = toolroom_form::read(path, overrides, &PLAIN, file::gap_section)?;
            return Self::from_file(file, Some(read.content), None);
        }
        let read = file::read(path, overrides)?;
        Self::from_file(file, read.gap, Some(&read.scenario))
    }

    /// [`NominalModel::read`] of a text; `file` is its name in messages.
    ///
    /// # Errors
    /// As [`NominalModel::read`].
    pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<Self, ModelFileError> {
        let outline = Outline::of(text);
        if is_program(&outline) {
            let resolve = |walk: &mut Walk, root: &Section<'_>| Some(of_program(walk, root, Path::new(".")));
            let (section, model) = toolroom_form::parse(file, text, overrides, &program::FORM, resolve)?.content;
            return Self::of_programs(file, section, model);
        }
        if is_plain(&outline) {
            let read = toolroom_form::parse(file, text, overrides, &PLAIN, file::gap_section)?;
            return Self::from_file(file.to_owned(), Some(read.content), None);
        }
        let read = file::parse(file, text, overrides)?;
        Self::from_file(file.to_owned(), read.gap, Some(&read.scenario))
    }

    fn from_file(
        file: String,
        section: Option<GapSection>,
        scenario: Option<&Scenario>,
    ) -> Result<Self, ModelFileError> {
        let tools = scenario.map_or(&[][..], |scenario| &scenario.tools);
        let wanted = section.as_ref().and_then(|section| section.process.clone());
        let simulated = |tool: &&ToolType| match tool.bare() {
            ProcessModel::Turning(_) | ProcessModel::Milling(_) | ProcessModel::Infeed(_) => true,
            ProcessModel::Other(_) => false,
        };
        let wanted = wanted.or_else(|| tools.iter().find(simulated).map(|tool| tool.process.name().to_owned()));
        // A shop without a process of ours is diagnosed by the log of its machines.
        let wanted = wanted.unwrap_or_else(|| if scenario.is_some() { "shop" } else { "empirical" }.to_owned());
        let process = if wanted == "empirical" {
            NominalProcess::Empirical
        } else if let ("shop", Some(scenario)) = (wanted.as_str(), scenario) {
            NominalProcess::Shop(Box::new(Shop::of(scenario)))
        } else {
            let tool = tools.iter().find(|tool| tool.process.name() == wanted);
            match tool.map(|tool| tool.bare()) {
                Some(ProcessModel::Turning(turning)) => NominalProcess::Turning(Box::new((**turning).clone())),
                Some(ProcessModel::Milling(milling)) => NominalProcess::Milling(Box::new((**milling).clone())),
                Some(ProcessModel::Infeed(infeed)) => NominalProcess::Grinding(Box::new((**infeed).clone())),
                // The equations of an imported unit are nobody's to calibrate.
                Some(ProcessModel::Other(_)) | None => return Err(ModelFileError::NoTool { file, process: wanted }),
            }
        };
        let tool = tools.iter().position(|tool| tool.process.name() == wanted);
        let stated =
            scenario.map_or_else(Declarations::default, |scenario| Declarations::from_scenario(scenario, tool));
        let mut model = Self { process, settings: Settings::default(), stated };
        if let Some(section) = section {
            model.stated.seen.clone_from(&section.seen);
            model.settings = settings(&file, &section, model.kind())?;
        }
        if let Some(scenario) = scenario {
            randomness(&mut model.settings, scenario, &wanted);
        }
        Ok(model)
    }

    fn of_programs(file: &str, section: Option<GapSection>, programs: ProgramModel) -> Result<Self, ModelFileError> {
        let process = NominalProcess::Program(Box::new(programs));
        let settings =
            section.map_or_else(|| Ok(Settings::default()), |own| settings(file, &own, RecordKind::Program))?;
        Ok(Self { process, settings, stated: Declarations::default() })
    }

    /// The same model for records that its calibration has seen: what `gap apply` wrote is not counted, so that the
    /// records count once. What was set aside comes with it. A rate of wear of a part of the records was named, and is
    /// counted from as effects are: such parts are not looked for again in the same records.
    pub fn set_aside(&self) -> (Self, Vec<Calibration>) {
        let mut model = self.clone();
        let of_part = |own: &Calibration| own.parameter == "wear_rate" && !own.scope.is_everywhere();
        let calibrated = |own: &Calibration| own.by.starts_with("diagnosis ") && !of_part(own);
        let (aside, kept) = model.stated.calibrations.drain(..).partition(calibrated);
        model.stated.calibrations = kept;
        (model, aside)
    }

    /// What its constants and effects belong to, as a file names it.
    pub fn target(&self) -> String {
        self.stated.tool.as_ref().map_or_else(|| "shop".to_owned(), |tool| format!("tool {tool}"))
    }

    /// The records that it can be held against.
    pub fn kind(&self) -> RecordKind {
        match self.process {
            NominalProcess::Turning(_) => RecordKind::Turning,
            NominalProcess::Milling(_) => RecordKind::Milling,
            NominalProcess::Grinding(_) => RecordKind::Grinding,
            NominalProcess::Empirical => RecordKind::Empirical,
            NominalProcess::Program(_) => RecordKind::Program,
            NominalProcess::Shop(_) => RecordKind::Shop,
        }
    }

    /// The model over `records`, grouped by the column `group` (edges or dressing cycles, if
    /// none); groups for which `held` is true are kept out of the fit. Channels that are impossible
    /// multiples of the nominal model, as in a wrong unit, are left out; the notes say so. Of an
    /// empirical model this is the first channel.
    pub fn over(
        &self,
        records: &Records,
        group: Option<&str>,
        held: impl Fn(usize, &str) -> bool,
    ) -> (Box<dyn Forward>, Vec<String>) {
        let mut asked = self.asked(records, group, held);
        (asked.parts.swap_remove(0), asked.notes)
    }

    /// The same in parts that know nothing of each other, at least one: the channels of an
    /// empirical model, or the whole.
    pub fn asked(&self, records: &Records, group: Option<&str>, held: impl Fn(usize, &str) -> bool) -> ProcessData {
        let asked = |parts, notes| ProcessData { process: self.kind().name(), parts, notes, impossible: 0 };
        if let NominalProcess::Program(model) = &self.process {
            let groups = self.groups(records, group, &held);
            let stretches = Stretches::new((**model).clone(), records, groups, &self.settings);
            let notes = [stretches.totals(), stretches.places(PLACES)].concat();
            return asked(vec![Box::new(stretches)], notes);
        }
        if let NominalProcess::Shop(shop) = &self.process {
            let (model, notes) = ShopModel::new(shop, records, group, &held, &self.settings, &self.stated);
            return asked(vec![FileNominal::around(Box::new(model))], notes);
        }
        let all = self.parts_of_all(records, group, &held);
        let mut suspicious: Vec<_> = all.iter().flat_map(|part| super::units::suspicious(part.as_ref())).collect();
        if matches!(self.process, NominalProcess::Empirical) {
            suspicious = super::plausible::suspicious(records);
        }
        let mut possible = records.clone();
        suspicious.iter().for_each(|(channel, _)| possible.remove(channel.word()));
        let parts = if suspicious.is_empty() { all } else { self.parts_of_all(&possible, group, &held) };
        let impossible = suspicious.len();
        let assumed = parts.iter().flat_map(|part| part.frame().notes.clone());
        let notes = suspicious.into_iter().map(|(_, note)| note).chain(assumed).collect();
        ProcessData { impossible, ..asked(parts, notes) }
    }

    /// Names of the groups, that of each row, and which of them are fitted.
    fn groups(
        &self,
        records: &Records,
        group: Option<&str>,
        held: &dyn Fn(usize, &str) -> bool,
    ) -> (Vec<String>, Vec<usize>, Vec<bool>) {
        let asked = group.and_then(|column| records.levels(column));
        let whole = || (vec!["all".to_owned()], vec![0; records.len()]);
        let (names, of_row) = asked.unwrap_or_else(|| match self.process {
            NominalProcess::Grinding(_) => super::grinding::dressings(records),
            NominalProcess::Program(_) => {
                records.levels("section").or_else(|| records.levels("operation_id")).unwrap_or_else(whole)
            }
            NominalProcess::Turning(_)
            | NominalProcess::Milling(_)
            | NominalProcess::Empirical
            | NominalProcess::Shop(_) => records.levels("tool_id").unwrap_or_else(whole),
        });
        let fitted = names.iter().enumerate().map(|(i, name)| !held(i, name)).collect();
        (names, of_row, fitted)
    }

    fn parts_of_all(
        &self,
        records: &Records,
        group: Option<&str>,
        held: &dyn Fn(usize, &str) -> bool,
    ) -> Vec<Box<dyn Forward>> {
        let groups = self.groups(records, group, held);
        let (settings, stated) = (&self.settings, &self.stated);
        match &self.process {
            NominalProcess::Turning(turning) => {
                vec![FileNominal::around(Box::new(Cutting::new(
                    (**turning).clone(),
                    records,
                    groups,
                    settings,
                    stated,
                )))]
            }
            NominalProcess::Milling(milling) => {
                vec![FileNominal::around(Box::new(Cutting::new(
                    (**milling).clone(),
                    records,
                    groups,
                    settings,
                    stated,
                )))]
            }
            NominalProcess::Grinding(infeed) => {
                vec![FileNominal::around(Box::new(Grinding::new(
                    (**infeed).clone(),
                    records,
                    groups,
                    settings,
                    stated,
                )))]
            }
            NominalProcess::Empirical => {
                let part = |column| -> Box<dyn Forward> {
                    Box::new(Empirical::new(records, column, groups.clone(), settings))
                };
                empirical::channels(records, settings).into_iter().map(part).collect()
            }
            NominalProcess::Program(model) => {
                vec![Box::new(Stretches::new((**model).clone(), records, groups, settings))]
            }
            NominalProcess::Shop(shop) => {
                vec![Box::new(ShopModel::new(shop, records, group, held, settings, stated).0)]
            }
        }
    }
}

/// Whether a file describes part programs.
fn is_program(outline: &Outline) -> bool {
    outline.text("gap", "process") == Some("program")
}

fn of_program(walk: &mut Walk, root: &Section<'_>, directory: &Path) -> (Option<GapSection>, ProgramModel) {
    (file::gap_section(walk, root), program::section(walk, root, directory))
}

/// Whether a file has no shop: nothing but priors and sensors of an empirical model.
fn is_plain(outline: &Outline) -> bool {
    !outline.has("shop")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHOP: &str = include_str!("../../../scenarios/gap/turning.toml");
    const EMPTY: &str = "schema = 1\n[gap]\nprocess = \"empirical\"\nchannels = [\"flank_wear\"]\n";

    #[test]
    fn a_shop_is_told_by_its_table_however_it_is_written() {
        for header in ["[shop]", "[shop] # comment", "[ shop ]", "[\"shop\"]", "  [shop]"] {
            let text = SHOP.replacen("[shop]", header, 1);
            let model = NominalModel::parse("turning.toml", &text, &[]).expect(header);
            assert_eq!(model.kind(), RecordKind::Turning, "{header}");
        }
    }

    #[test]
    fn words_in_comments_and_texts_tell_nothing() {
        for text in ["# [shop]\n", "# process = \"program\"\n"] {
            let model = NominalModel::parse("model.toml", &format!("{text}{EMPTY}"), &[]).expect(text);
            assert_eq!(model.kind(), RecordKind::Empirical, "{text}");
        }
        let title = "title = \"\"\"\nprocess = \"program\"\n\"\"\"";
        let text = SHOP.replacen("title = \"Nominal model of turning C45 with T15K6\"", title, 1);
        assert!(text.contains(title));
        assert_eq!(NominalModel::parse("turning.toml", &text, &[]).expect("a shop").kind(), RecordKind::Turning);
        // A header within a text is no table: the faults are those of a file without shop.
        let text = EMPTY.replacen("[gap]", "title = \"\"\"\n[shop]\n\"\"\"\n[gap]", 1);
        let error = NominalModel::parse("model.toml", &text, &[]).expect_err("no key title").to_string();
        assert!(error.contains("`title`") && !error.contains("machine"), "{error}");
    }

    #[test]
    fn part_programs_are_told_by_the_process_of_the_section() {
        for process in ["process = 'program'", "\"process\" = \"program\"", "process=\"program\" # runs"] {
            let text = format!("schema = 1\n[gap] # priors\n{process}\n[drives]\nrapid_speed = \"30 m/min\"\n");
            let model = NominalModel::parse("model.toml", &text, &[]).expect(process);
            assert_eq!(model.kind(), RecordKind::Program, "{process}");
        }
    }
}
