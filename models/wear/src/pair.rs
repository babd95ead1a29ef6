//! A tool–work pair: everything known about one tool material in one work material.

use crate::{Chipping, Cut, Emf, Force, Limits, Temperature, WearLaw};
use toolroom_process::parameters::{ParameterError, ParameterFile};
use toolroom_process::{AnyRecord, ModelError, Number};

/// Shipped parameter sets: name and file.
pub const PARAMETER_SETS: &[(&str, &str)] = &[
    ("ni_vk6om", include_str!("../../../scenarios/parameters/turning/ni_vk6om.toml")),
    ("ni_vk8", include_str!("../../../scenarios/parameters/turning/ni_vk8.toml")),
    ("ni_vk6om_hb", include_str!("../../../scenarios/parameters/turning/ni_vk6om_hb.toml")),
    ("c45_t15k6", include_str!("../../../scenarios/parameters/turning/c45_t15k6.toml")),
    ("ti_vk6", include_str!("../../../scenarios/parameters/turning/ti_vk6.toml")),
];

/// Tool and work material together: heat, force, EMF, wear, limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair<N: Copy = f64> {
    /// Name by which scenarios call it.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Contact temperature.
    pub temperature: Temperature<N>,
    /// Cutting and feed force.
    pub force: Force<N>,
    /// Thermo-EMF.
    pub emf: Emf<N>,
    /// Wear law.
    pub law: WearLaw<N>,
    /// Chipping of the edge.
    pub chipping: Chipping<N>,
    /// Wear limit and speed range.
    pub limits: Limits<N>,
}

/// Why a parameter set was not loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PairError {
    /// No shipped set has this name.
    #[error("no parameter set `{name}`; did you mean `{nearest}`? There are {known}")]
    UnknownSet {
        /// What was asked for.
        name: String,
        /// The most similar name.
        nearest: &'static str,
        /// All names.
        known: String,
    },
    /// The file does not name exactly one wear law.
    #[error(
        "{laws} wear laws given; one of [parameters.energy_balance], [parameters.extended_taylor], [parameters.takeyama_murata], [parameters.usui] is due"
    )]
    WearLaw {
        /// How many there are.
        laws: usize,
    },
    /// A group that a turning pair does not have.
    #[error("unknown group [parameters.{group}]; did you mean [parameters.{nearest}]?")]
    UnknownGroup {
        /// What was read.
        group: String,
        /// The most similar name.
        nearest: &'static str,
    },
    /// A faulty entry.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Values that contradict each other.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Groups that every pair has, besides its wear law.
const GROUPS: [&str; 5] = ["temperature", "force", "emf", "chipping", "limits"];
const LAWS: [&str; 4] = ["energy_balance", "extended_taylor", "takeyama_murata", "usui"];

impl Default for Pair {
    /// The record defaults, which are the set `ni_vk6om`.
    fn default() -> Self {
        Self {
            name: "ni_vk6om".to_owned(),
            title: "Nickel alloy with VK6OM carbide".to_owned(),
            temperature: Temperature::default(),
            force: Force::default(),
            emf: Emf::default(),
            law: WearLaw::default(),
            chipping: Chipping::default(),
            limits: Limits::default(),
        }
    }
}

impl Pair {
    /// A shipped set.
    ///
    /// # Errors
    /// [`PairError::UnknownSet`] with the nearest name.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// assert_eq!(Pair::named("c45_t15k6").unwrap().limits.wear_limit, 0.8e-3);
    /// assert!(Pair::named("ni_vk6").unwrap_err().to_string().contains("did you mean `ni_vk"));
    /// ```
    pub fn named(name: &str) -> Result<Self, PairError> {
        match PARAMETER_SETS.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => Self::read(text),
            None => {
                let names = PARAMETER_SETS.iter().map(|(known, _)| *known);
                let known = names.clone().collect::<Vec<_>>().join(", ");
                Err(PairError::UnknownSet { name: name.to_owned(), nearest: nearest(name, names), known })
            }
        }
    }

    /// Reads a parameter file.
    ///
    /// # Errors
    /// [`PairError`], with the line where the file is at fault.
    pub fn read(text: &str) -> Result<Self, PairError> {
        let file = ParameterFile::read(text)?;
        let known = || GROUPS.into_iter().chain(LAWS);
        if let Some(group) = file.groups.keys().find(|group| known().all(|each| each != group.as_str())) {
            return Err(PairError::UnknownGroup { group: group.clone(), nearest: nearest(group, known()) });
        }
        let mut laws = file.groups.keys().filter_map(|group| WearLaw::of_group(group));
        let (Some(law), None) = (laws.next(), laws.next()) else {
            let laws = LAWS.iter().filter(|law| file.groups.contains_key(**law)).count();
            return Err(PairError::WearLaw { laws });
        };
        let mut pair = Self { name: file.name.clone(), title: file.title.clone(), law, ..Self::default() };
        for (group, record) in pair.parameters_mut() {
            let optional = if group == law.group() { law.optional() } else { &[] };
            file.fill_beside(text, group, record, optional)?;
        }
        pair.law.check()?;
        Ok(pair)
    }

    /// Parameter groups by name.
    pub fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        vec![
            ("temperature", &mut self.temperature),
            (self.law.group(), self.law.record_mut()),
            ("force", &mut self.force),
            ("emf", &mut self.emf),
            ("chipping", &mut self.chipping),
            ("limits", &mut self.limits),
        ]
    }

    /// The nominal cut for which the set was made: reference speed, feed and depth.
    pub fn reference_cut(&self) -> Cut {
        let Temperature { reference_feed, reference_depth, .. } = self.temperature;
        Cut::nominal(self.limits.reference_speed, reference_feed, reference_depth)
    }
}

impl<N: Number> Pair<N> {
    /// The same pair over another number type, for derivatives by parameters, states, inputs.
    pub fn map<M: Copy>(&self, mut convert: impl FnMut(N) -> M) -> Pair<M> {
        Pair {
            name: self.name.clone(),
            title: self.title.clone(),
            temperature: self.temperature.map(&mut convert),
            force: self.force.map(&mut convert),
            emf: self.emf.map(&mut convert),
            law: self.law.map(&mut convert),
            chipping: self.chipping.map(&mut convert),
            limits: self.limits.map(&mut convert),
        }
    }

    /// Rate and gain of thermal damage under `cut`; both 0 for laws without heredity.
    pub(crate) fn damage_terms(&self, cut: &Cut<N>) -> (N, N) {
        match &self.law {
            WearLaw::EnergyBalance(law) => (law.damage_rate + cut.damage_rate, law.damage_gain + cut.damage_gain),
            WearLaw::ExtendedTaylor(_) | WearLaw::TakeyamaMurata(_) | WearLaw::Usui(_) => (N::from(0.0), N::from(0.0)),
        }
    }
}

/// The most similar of some names; the first where several are.
fn nearest(name: &str, known: impl Iterator<Item = &'static str>) -> &'static str {
    let mut best = ("", f64::NEG_INFINITY);
    for each in known {
        let similarity = strsim::normalized_damerau_levenshtein(name, each);
        if similarity > best.1 {
            best = (each, similarity);
        }
    }
    best.0
}
