//! Structural dynamics: which waves on the part die out, and which grow to chatter.

use crate::{Infeed, Input, State};
use toolroom_process::{ModelError, Record, record};

record! {
    /// One vibration mode of machine and work.
    ///
    /// # Source
    /// Assumption; measure by a hammer test on the wheel head.
    pub struct Structure {
        /// Natural frequency of the mode, wheel out of contact.
        natural_frequency: Real["Hz" => "Hz"] = 120.0, 1.0..=1e5;
        /// Damping ratio ζ of the mode.
        damping_ratio: Real = 0.05, 1e-4..=1.0;
        /// Share of the static compliance 1/J that vibrates with the mode; the rest (wheel contact,
        /// bearings, high modes) follows at once.
        modal_share: Real = 0.2, 0.0..=1.0;
    }
}

/// What one work revolution makes of a wave on the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Frequency at which the wheel meets it, Hz.
    pub frequency: f64,
    /// Waves around the circumference.
    pub lobes: f64,
    /// Amplitude after a revolution over that before: A(ω), at low frequency the lag K. Above 1
    /// the wave grows.
    pub growth: f64,
    /// Angle by which the wave is turned back each revolution, rad of the wave.
    pub phase: f64,
}

/// The amplitude–frequency characteristic of plunge grinding.
///
/// A wave `e cos ωt` that the last revolution left makes the wheel yield by
/// `d = Cp G/(1 + Cp G) e` with the compliance `G = ((1 − s) + s/(1 − β² + 2iζβ))/J`,
/// `β = ω/ω_n` and modal share s; that yielding is the wave that this revolution leaves. Hence
/// `A(ω) = |Cp G/(1 + Cp G)|` is the factor by which waves change each revolution, with
/// `A(0) = K`. The recursion takes A for K at all frequencies.
///
/// # Validity
/// Waves longer than the contact and shallower than the depth of cut; whole numbers of lobes, or
/// slow growth. Regeneration by waves on the wheel, which takes minutes, is left out.
///
/// # Errors
/// [`ModelError::OutOfRange`] for a structure or input outside its ranges; [`ModelError::NoSolution`]
/// for work that does not rotate.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, A(ω) = d/Δh; its form with one mode: assumption.
///
/// ```
/// use toolroom_infeed::{Infeed, Input, State, Structure, wave};
/// let (grinding, input) = (Infeed::default(), Input::default());
/// let slow = wave(&grinding, &State::default(), &input, &Structure::default(), 3.0).unwrap();
/// assert!((slow.growth - 0.553).abs() < 3e-3);
/// ```
pub fn wave(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    structure: &Structure,
    lobes: f64,
) -> Result<Wave, ModelError> {
    structure.check()?;
    input.check()?;
    if input.work_rotation_speed == 0.0 {
        return Err(ModelError::NoSolution { quantity: "wave", reason: "the work does not rotate" });
    }
    let [ratio, ..] = grinding.shares(wheel, input);
    let frequency = lobes * input.work_rotation_speed / std::f64::consts::TAU;
    let beta = frequency / structure.natural_frequency;
    let (real, imaginary) = (1.0 - beta * beta, 2.0 * structure.damping_ratio * beta);
    let share = structure.modal_share / (real * real + imaginary * imaginary);
    // Cp G as a complex number, then Cp G/(1 + Cp G).
    let (a, b) = (ratio * (1.0 - structure.modal_share + share * real), -ratio * share * imaginary);
    let below = (1.0 + a).hypot(b);
    Ok(Wave { frequency, lobes, growth: a.hypot(b) / below, phase: b.atan2(1.0 + a) - b.atan2(a) })
}

/// The whole number of lobes, from 1 to `most_lobes`, that grows most or dies out slowest.
///
/// # Errors
/// Those of [`wave`]; [`ModelError::NoSolution`] for no lobes at all.
///
/// ```
/// use toolroom_infeed::{Infeed, Input, State, Structure, fastest_growing_wave};
/// let structure = Structure { modal_share: 0.8, ..Structure::default() };
/// let chatter = fastest_growing_wave(&Infeed::default(), &State::default(), &Input::default(), &structure, 200).unwrap();
/// assert!(chatter.growth > 1.0 && chatter.frequency > structure.natural_frequency);
/// ```
pub fn fastest_growing_wave(
    grinding: &Infeed,
    wheel: &State,
    input: &Input,
    structure: &Structure,
    most_lobes: u32,
) -> Result<Wave, ModelError> {
    let mut fastest: Option<Wave> = None;
    for lobes in 1..=most_lobes {
        let wave = wave(grinding, wheel, input, structure, lobes.into())?;
        if fastest.is_none_or(|fastest| wave.growth > fastest.growth) {
            fastest = Some(wave);
        }
    }
    fastest.ok_or(ModelError::NoSolution { quantity: "wave", reason: "request at least one lobe" })
}
