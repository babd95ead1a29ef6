//! A tool–work pair: everything known about one tool material in one work material.

use crate::{Chipping, Cut, Emf, Force, Group, Limits, ParameterSet, SetError, TURNING_SETS, Temperature, WearLaw};
use std::path::Path;
use toolroom_process::{AnyRecord, Number};

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
    /// [`SetError::Unknown`] with the nearest name.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// assert_eq!(Pair::named("c45_t15k6").unwrap().limits.wear_limit, 0.8e-3);
    /// assert!(Pair::named("ni_vk6").unwrap_err().to_string().contains("did you mean `ni_vk"));
    /// ```
    pub fn named(name: &str) -> Result<Self, SetError> {
        Self::load(name, Path::new(""))
    }

    /// The pair of a shipped name, or of a parameter set file whose path counts from `folder`.
    ///
    /// # Errors
    /// [`SetError`].
    pub fn load(reference: &str, folder: &Path) -> Result<Self, SetError> {
        Self::of_set(&ParameterSet::load(reference, folder, &TURNING_SETS)?)
    }

    /// Reads the text of a parameter set.
    ///
    /// # Errors
    /// [`SetError`], with the lines where the text is at fault.
    pub fn read(text: &str) -> Result<Self, SetError> {
        Self::of_set(&ParameterSet::parse("the parameter set", text, &TURNING_SETS)?)
    }

    /// The pair that a parameter set of turning describes.
    ///
    /// # Errors
    /// [`SetError::Model`] where values contradict each other.
    pub fn of_set(set: &ParameterSet) -> Result<Self, SetError> {
        let law = set.law.and_then(WearLaw::of_group).unwrap_or_default();
        let mut pair = Self { name: set.name.clone(), title: set.title.clone(), law, ..Self::default() };
        for (group, record) in pair.parameters_mut() {
            set.fill(group, record);
        }
        pair.law.check()?;
        Ok(pair)
    }

    /// The wear laws that a set states beside the one that it uses.
    pub fn other_laws(set: &ParameterSet) -> Vec<WearLaw> {
        let stated = |group: &&Group| set.unused.iter().any(|value| value.group == group.name);
        let laws = TURNING_SETS.groups.iter().filter(stated).filter_map(|group| WearLaw::of_group(group.name));
        laws.map(|mut law| {
            set.fill_unused(law.group(), law.record_mut());
            law
        })
        .collect()
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
