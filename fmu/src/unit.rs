//! What a process adds to be shipped as a unit.

use toolroom_cutting::Regeneration;
use toolroom_effects::Effects;
use toolroom_process::{Advance, ModelError, Process, Record, record};

/// A [`Process`] with what its description needs and its records do not say.
///
/// Names of variables: inputs and outputs `process.FIELD`, states `STATE_GROUP.FIELD`, parameters
/// `GROUP.FIELD`, effects `effect.ID` for the size and `shape.ID.FIELD` for the rest.
pub trait Unit: Process + Clone + 'static {
    /// What vibrates around the cut: parameters `machine.FIELD`. The first field says whether the
    /// cut is judged for chatter at all.
    type Machine: Record;

    /// What [`Unit::step`] keeps from one step to the next.
    type Memory: Default + Send;

    /// Model identifier: name of the package and of its shared library.
    const IDENTIFIER: &'static str;
    /// One line for people.
    const TITLE: &'static str;
    /// What the unit computes, a few sentences.
    const ABSTRACT: &'static str;
    /// Equations of the model, name and formula in field names.
    const EQUATIONS: &'static [(&'static str, &'static str)];
    /// Where the model holds, and what it leaves out.
    const VALIDITY: &'static [&'static str];
    /// First part of the names of states.
    const STATE_GROUP: &'static str;
    /// Shipped parameter sets, name and file; the first is the default.
    const SETS: &'static [(&'static str, &'static str)];
    /// Parameters that choose one of several: name, and names of the choices from the least value on.
    const ENUMERATIONS: &'static [(&'static str, &'static [&'static str])] = &[];
    /// Boolean inputs whose rising edge renews a part of the state.
    const RENEWALS: &'static [Renewal<Self>];
    /// Whether the unit is an ordinary differential equation and offers Model Exchange.
    const CONTINUOUS: bool;
    /// Whether [`Unit::mount`] has an effect.
    const VIBRATES: bool;
    /// Whether [`Unit::commanded_speed`] gives a speed.
    const ADAPTIVE: bool;
    /// End and step of the default experiment, s.
    const EXPERIMENT: (f64, f64);

    /// The process of a parameter file, without effects.
    ///
    /// # Errors
    /// What is wrong with the file, in words.
    fn read(text: &str) -> Result<Self, String>;

    /// Name under which [`Effects::every`] lists the effects.
    const EFFECTS_OF: &'static str = Self::NAME;

    /// The effects of the process.
    fn effects_mut(&mut self) -> &mut Effects;

    /// [`Process::advance`] with a memory of the step before, which makes the next one cheaper and
    /// changes no result. It is forgotten where a parameter changes.
    ///
    /// # Errors
    /// As [`Process::advance`].
    fn step(
        &self,
        x: &mut Self::State,
        u: &Self::Input,
        dt: f64,
        _memory: &mut Self::Memory,
    ) -> Result<Advance, ModelError> {
        self.advance(x, u, dt)
    }

    /// [`Process::output`] with what the last step kept, which makes it cheaper and changes no result.
    fn observe(&self, x: &Self::State, u: &Self::Input, _memory: &Self::Memory) -> Self::Output {
        self.output(x, u)
    }

    /// One real output by its place among the fields, where it costs less by itself than [`Unit::observe`] costs; the same to the bit. It is
    /// asked for the first value that an importer reads after a step.
    fn observe_one(&self, _output: usize, _x: &Self::State, _u: &Self::Input, _memory: &Self::Memory) -> Option<f64> {
        None
    }

    /// Longest step under input `u` that is worked out within a second, s, and what takes the time.
    fn longest_step(&self, _u: &Self::Input) -> (f64, &'static str) {
        (f64::INFINITY, "")
    }

    /// Whether the edge is worn beyond what the model knows: it cuts no more from then on.
    fn worn_out(&self, _x: &Self::State) -> bool {
        false
    }

    /// Puts the process on a machine that may chatter.
    ///
    /// # Errors
    /// What the stability model refuses, in words.
    fn mount(&mut self, _machine: &Self::Machine, _regeneration: Regeneration) -> Result<(), String> {
        Ok(())
    }

    /// Exact derivatives of rates and outputs along (`dx`, `du`), where the equations are written
    /// over dual numbers.
    fn linearise(
        &self,
        _x: &Self::State,
        _u: &Self::Input,
        _dx: &Self::State,
        _du: &Self::Input,
    ) -> Option<(Self::State, Self::Output)> {
        None
    }

    /// Cutting speed that the built-in policy commands, m/s. It sees the true state.
    fn commanded_speed(&self, _policy: &AdaptivePolicy, _x: &Self::State, _u: &Self::Input) -> f64 {
        f64::NAN
    }
}

/// A Boolean input that renews a part of the state on its rising edge, and the count of it.
pub struct Renewal<U: Process> {
    /// Name of the input.
    pub name: &'static str,
    /// Name of the output that counts.
    pub count: &'static str,
    /// Meaning of the input.
    pub doc: &'static str,
    /// Meaning of the count.
    pub count_doc: &'static str,
    /// The state after it.
    pub renew: fn(&U, &U::State) -> U::State,
}

record! {
    /// The built-in policy of cutting speed; it sees the true wear of the edge.
    ///
    /// # Source
    /// Postnov & Shafikov, section 3 (least wear, set increment); productivity as least time for
    /// given path and wear, see the wear model.
    pub struct AdaptivePolicy {
        /// Whether the policy commands the speed instead of the input process.cutting_speed.
        enable: Boolean = 0.0;
        /// 1: least wear per path; 2: productivity at a shadow price of path; 3: set wear per path.
        mode: Integer = 1.0, 1.0..=3.0;
        /// Worth of a metre of path in mode 2; 1.29 s/m is the optimum of the default set with
        /// edge changes of two minutes.
        shadow_price: Real["s/m" => "s/m"] = 1.29, 1e-6..=1e6;
        /// Wear per path in mode 3.
        wear_intensity: Real["1" => "um/m"] = 0.5e-6, 1e-12..=1e-2;
        /// Time between two commands; the speed is held between them.
        sampling_period: Real["s" => "s"] = 6.0, 1e-3..=1e6;
    }
}
