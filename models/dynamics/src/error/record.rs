//! Why a record over time is refused.

/// What is wrong with a record over time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordProblem {
    /// Too few samples.
    #[error("the record has {samples} samples, at least {least} are needed")]
    Short {
        /// Samples that it has.
        samples: usize,
        /// Samples that are needed.
        least: usize,
    },
    /// Time that does not go on in even steps.
    #[error("the time is uneven: sample {sample} is at {time} s; export evenly sampled signals")]
    Uneven {
        /// Number of the sample, from 1.
        sample: usize,
        /// Its time (s).
        time: f64,
    },
    /// A hammer test without its channels.
    #[error(
        "the record has {forces} channels of force and {responses} of a response; one `force [N]` and at least one `acceleration [m/s2]` are needed"
    )]
    Channels {
        /// Channels of force.
        forces: usize,
        /// Channels of a response.
        responses: usize,
    },
    /// Channels stored for different numbers of hits.
    #[error("one channel is stored {one} times and another {other} times; export every hit with all its channels")]
    Hits {
        /// How often one channel is there.
        one: usize,
        /// How often another one is.
        other: usize,
    },
    /// A hammer test without a hit, or with hits that leave no room.
    #[error(
        "there is no hit with an eighth of a second behind it in the record; hit, wait until it is quiet, and hit again"
    )]
    NoHits,
    /// A hammer test of which every hit is left out.
    #[error("none of {hits} hits can be used: {reasons}")]
    NoUsableHit {
        /// Hits that were found.
        hits: usize,
        /// What is wrong with each.
        reasons: String,
    },
    /// A sound too short for its lines.
    #[error("the record lasts {duration:.3} s, at least {least:.3} s are needed at this speed, sixteen revolutions")]
    Brief {
        /// Its duration (s).
        duration: f64,
        /// The least duration (s).
        least: f64,
    },
    /// A sound in which the teeth are not heard.
    #[error(
        "no harmonics of spindle and teeth within 3 % of {speed:.0} rpm; check speed and number of teeth, and record nearer to the cut"
    )]
    NoComb {
        /// The commanded speed (rpm).
        speed: f64,
    },
    /// A sampling rate that holds too few harmonics of the teeth.
    #[error(
        "{rate:.0} samples a second hold fewer than {harmonics} harmonics of the teeth at this speed; record with {least:.0} a \
         second and more"
    )]
    Slow {
        /// Samples in a second (Hz).
        rate: f64,
        /// Harmonics of the teeth that are needed.
        harmonics: u32,
        /// Samples in a second that would do (Hz).
        least: f64,
    },
    /// A record whose signal never changes.
    #[error(
        "the record is constant: no sample of its {channels} channels differs from the one before; check sensor and cable, and record again"
    )]
    Constant {
        /// Channels of the record.
        channels: usize,
    },
    /// A sound that is that of another speed.
    #[error(
        "the lines between the harmonics of spindle and teeth at {commanded:.0} rpm are harmonics of {heard:.1} rpm; check --speed and \
         --teeth and the sampling rate of the file; if they are right, record again with the speed changed by 2 %"
    )]
    OtherSpeed {
        /// The speed near the commanded one (rpm).
        commanded: f64,
        /// The speed whose harmonics all lines are (rpm).
        heard: f64,
    },
    /// A sound file whose channels are not all explained.
    #[error(
        "the sound file has {channels} channels and {scales} of them have a full scale; give one for each, in their order"
    )]
    Scales {
        /// Channels of the file.
        channels: usize,
        /// Full scales that were given.
        scales: usize,
    },
}
