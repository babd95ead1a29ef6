//! Constants by which the diagnosis decides: what is named, what counts as unknown or masked, and
//! which channels count at all.
//!
//! Every constant says what it decides, in which unit it counts, and why it has its value. Where no
//! source or derivation is known, the reason is the word "assumption"; the blind benchmark checks all
//! of them together. Constants of numerical methods (steps, rounds, draws) stand where they are used.

// Gains: what a name has to be worth.

/// Gain that a named effect needs beside the price of having been chosen, in log posterior density (1).
/// Assumption: odds of e⁴ ≈ 55 to 1, and a name without cause costs more than a missed one; the row "gain" of the
/// ablation.
pub const GATE: f64 = 4.0;
/// Gain with which fewer groups than [`FEWEST_GROUPS`] ask for an effect that calibration may have taken up, in log
/// posterior density (1). Assumption: twice [`GATE`], since neither their agreement nor a score can be asked.
pub(super) const FEW_GROUPS_GATE: f64 = 8.0;
/// Lead of a pair over its best single effect that names both, the choice among pairs paid for, in log
/// posterior density (1). Assumption: twice [`GATE`], since the second effect may only mend the form of the
/// first; the row "lead" of the ablation.
pub(super) const PAIR_GATE: f64 = 8.0;
/// Further lead of a second effect that moves the same readings, as a share of the gain of the first (1).
/// Assumption: the occurrences of a cause scatter, and what they leave looks like something else; the row "closure"
/// of the ablation.
pub(super) const SCATTERED: f64 = 0.05;
/// Share of its own gain by which an effect may fall behind a generic signature before that takes probability from its
/// name (1). Assumption: the function of an effect is as little exact as any other.
pub(super) const FORM: f64 = 0.1;
/// Greatest structure beside a named effect, as a share of the gain of the effect (1). Assumption: what
/// leaves half as much as it explains is not the whole cause; the row "remainder" of the ablation.
pub(super) const REMAINDER: f64 = 0.5;
/// Share of a signature that the form allowance imitates, above which an effect has to close the gap for certain
/// (1). Assumption: the allowance imitates most of it; the row "closure" of the ablation.
pub(super) const IMITATED: f64 = 0.5;

/// Least share of the gap of left-out groups that a name closes (1). Assumption: two hundredths of a root mean square
/// are of no use to anybody, and with many groups every form error is significant; the row "closure" of the ablation.
pub(super) const LEAST_CLOSED: f64 = 0.02;
/// Least share of the mean square above the noise that a name closes, on the channels that it touches (1). Assumption:
/// less than a tenth of what can be closed is not the cause of the gap; the row "closure" of the ablation.
pub(super) const LEAST_OF_CLOSABLE: f64 = 0.1;
/// Least size of a name, in ordinary sizes (1). Assumption: a quarter of what is usual makes no difference to a plan;
/// the row "size" of the ablation.
pub(super) const LEAST_SIZE: f64 = 0.25;

// Probabilities.

/// Greatest probability of a name (1). Assumption: the blind benchmark has too few names to show that more than
/// ninety-nine of a hundred are right.
pub(super) const PROBABLE: f64 = 0.99;
/// Greatest probability of a name where the equations are off by more than was thought of (1). Assumption: form errors of
/// that size were blamed on an effect in a few of a hundred shops that hid nothing.
pub(super) const PROBABLE_THOUGH_OFF: f64 = 0.9;

// Scores and agreement: how strongly, and by how many groups, the data ask for an effect.

/// Score from which an effect counts as detectable, in standard deviations (1). Assumption: five standard
/// deviations leave room for the choice among many candidates.
pub(super) const DETECTABLE: f64 = 5.0;
/// Score at its fitted size that a named effect needs, in standard deviations (1). Assumption: smaller ones
/// are as often the work of causes that no catalogue has, as blind checks on shops that were used for
/// development showed; the row "score" of the ablation.
pub(super) const CONVINCING: f64 = 4.5;
/// Size over its standard error between groups that a named effect needs, and lead of a proposed term over its standard
/// error (1). Assumption: about 95 %, so that all groups say
/// so and not one; the row "agreement" of the ablation.
pub(super) const AGREED: f64 = 2.0;
/// Fewest fitted groups that can name an effect (count). Assumption: the agreement of fewer groups cannot be
/// judged; the row "groups" of the ablation.
pub const FEWEST_GROUPS: usize = 5;
/// Move of a constant that is named, in prior standard deviations (1). Assumption: what was believed of it is wrong
/// then.
pub(super) const FAR_CONSTANT: f64 = 3.0;
/// Level of the tests of generic signatures against their null distribution, as a probability (1).
/// Assumption: one in a hundred data sets without a gap shows structure by chance.
pub(super) const NULL_LEVEL: f64 = 0.01;

// The search: which models get the chance to be named.

/// Single effects that are fitted anew (count). Assumption: a cause that ranks lower is hidden by others
/// anyway, and every fit costs time.
pub(super) const REFITTED: usize = 5;
/// Least score of a single effect that is fitted anew, in standard deviations (1). Assumption: about 95 %;
/// a fit does not lift less than that to [`CONVINCING`].
pub(super) const REFITTED_SCORE: f64 = 2.0;
/// Shapes of one effect among those that are fitted anew (count). Assumption: more would crowd out other
/// effects.
pub(super) const SHAPES: usize = 2;
/// Single effects to which a second one is sought (count). Assumption: the cause that explains most is among
/// the best three.
pub(super) const PAIRED: usize = 3;
/// Least score of a second effect beside the first, in standard deviations (1). Assumption: it lies above
/// [`REFITTED_SCORE`], since a pair has more to choose from.
pub(super) const PAIRED_SCORE: f64 = 2.5;
/// Least lead, before the pair is fitted, of a second effect beside the first, in log posterior density
/// (1). Assumption: a quarter of [`PAIR_GATE`], since a fit may raise it.
pub(super) const PAIRED_LEAD: f64 = 2.0;
/// Effects that are named together at most (count). Assumption: more than five causes at a time are a model that is
/// wrong in general.
pub(super) const MOST_EFFECTS: usize = 5;
/// Further effects that are fitted beside a chosen model (count). Assumption: as for [`PAIRED`].
pub(super) const FURTHER: usize = 3;
/// Single effects that are fitted anew because the scores at the nominal point ask for them (count).
/// Assumption: this is only a supplement where the calibrated nominal model is strained.
pub(super) const EARLY: usize = 2;

// Form: how far equations may be off.

/// Prior standard deviation of the exponent of an effect's function, and of its share in one channel
/// against the others (1). Assumption: a catalogue function is exact to about a quarter of an exponent; the row
/// "form tolerance" of the ablation.
pub(super) const TOLERANCE: f64 = 0.25;
/// Move of a form allowance beside a named effect above which the equations are not believed, in prior
/// standard deviations (1). Assumption: no honest form error is five standard deviations; the row "strain" of the
/// ablation.
pub(super) const STRAINED: f64 = 5.0;

/// Length scales of a discrepancy that are tried, in standard deviations of the conditions (1). Assumption: shorter
/// than most of the range, and so long that it is nearly a polynomial.
pub(super) const LENGTHS: [f64; 3] = [0.9, 1.5, 2.5];
/// Log posterior density that a discrepancy gains before it takes part (1). Assumption: odds of e² ≈ 7 to 1; without it
/// every diagnosis would pay in time and power for an amplitude that noise alone asks for.
pub(super) const DISCREPANT: f64 = 2.0;

/// Factors on the prior standard deviation of constants of one kind that are tried (1). Assumption: what records have not
/// shown may still be off, so that no constant counts as known better than to two fifths of what was believed of it.
pub(super) const SCALES_OF_CONSTANTS: [f64; 2] = [0.6, 0.4];
/// Log marginal likelihood that a smaller spread of constants gains before it counts (1). Assumption: as [`DISCREPANT`].
pub(super) const NARROWER: f64 = 2.0;

// Classes: which effects the data cannot tell apart.

/// Cosine of projected signatures above which two effects are the same to the data (1). Assumption: less
/// than a third of the length of one is then its own, √(1 − 0.95²) = 0.31.
pub(super) const SAME: f64 = 0.95;
/// Lead over another effect above which left-out groups need not agree, in log posterior density (1).
/// Assumption: twice [`GATE`].
pub(super) const CLEAR: f64 = 8.0;
/// Lead on left-out groups over its standard error below which another effect still counts as near (1).
/// Assumption: about 95 %.
pub(super) const CLEARLY_LEFT_OUT: f64 = 2.0;
/// Gain of an effect over that of another below which the other is no rival of it (1). The gain of a rival
/// is more than a third of it. Assumption.
pub(super) const RIVAL: f64 = 3.0;
/// Cosine of projected signatures from which two effects count as confused in a plan (1). Assumption: it
/// lies below [`SAME`], since a plan has to warn early.
pub(super) const CONFUSED: f64 = 0.9;

/// Share of the gain that is asked of a rival by which a score of it may fall short before its evidence is worked out (1).
/// Assumption: gain and half the square of a score differ by the prior of sizes alone.
pub(super) const ROUGHLY: f64 = 0.8;

// Masking: what a design cannot show.

/// Move of a calibration from which a masked effect may have pushed it, in prior standard deviations (1).
/// Assumption: priors are rarely off by more.
pub(super) const PUSHED: f64 = 4.0;
/// Ordinary sizes that a masked effect may have (1). Assumption: larger ones do not occur.
pub(super) const LARGE: f64 = 4.0;
/// Share of a squared signature that the projection takes, above which next to nothing of it is left (1).
/// Assumption: 17 % of the length is left.
pub(super) const WHOLLY: f64 = 0.97;
/// Standard deviations of form and noise by which an effect may be unlucky and still keep what is promised
/// (1). Derivation: the one-sided normal quantile of nineteen in twenty.
pub(super) const UNLUCKY: f64 = 1.645;
/// Share of a score that no form takes away (1). Assumption: some of an effect always shows.
pub(super) const ANYHOW: f64 = 0.1;
/// Cosine of two signatures before any projection, from which shapes of an effect are neighbours (1).
/// Assumption: a cause may then lie between them; lots and coolants act on rows of their own and are none.
pub(super) const NEIGHBOURS: f64 = 0.5;

// Intervals of closure.

/// Normal quantile of a 90 % interval, in standard deviations (1). Derivation: 5 % lie beyond each end.
pub const NINETY: f64 = 1.645;
/// Factor on an interval of closure where the groups are too few for Student's quantile (1). Assumption: it is
/// wide enough that one group decides nothing.
pub(super) const TOO_FEW: f64 = 3.0;

// What matters: where a rejected model is good enough all the same.

/// Share of a channel's value below which structure does not matter (1). Assumption: nobody acts on one per cent.
pub(super) const MATTERING_SHARE: f64 = 0.01;
/// The same in standard deviations of its sensor (1). Assumption: less is not seen in a single reading.
pub(super) const MATTERING_SENSORS: f64 = 0.5;
/// The same in least steps of its readings (1). Derivation: what is less than half a step leaves most readings as they are.
pub(super) const MATTERING_STEPS: f64 = 0.5;
/// Score of a queue beyond which it is not what the model says, however few its days are, in standard errors over days (1).
/// Assumption: at three or four days as many as one in forty right files are beyond it, which costs an answer of
/// `small` or `unknown` instead of `no_gap`.
pub(super) const UNEXPLAINED_QUEUE: f64 = 5.0;
/// Calibration that is reported although it is a form allowance, in prior standard deviations (1). Assumption: one of twenty goes
/// as far by chance.
pub(super) const REPORTED_ALLOWANCE: f64 = 2.0;

// Readings that stand apart.

/// Residual in standard deviations beyond which a reading stands apart, before and after (1). Assumption: no reading of
/// noise lies there.
pub(super) const FAR_READING: f64 = 6.0;
/// Residual of such a reading over what is usual of its like (1). Assumption: where all readings are far off, none of them
/// stands apart.
pub(super) const BEYOND_ALIKE: f64 = 5.0;
/// Fewest readings of the same thing that say what is usual of it (count). Derivation: the median of three does not follow
/// one of them.
pub(super) const FEWEST_ALIKE: usize = 3;
/// Share of the mean square above the floor of noise, below which a share of it says nothing (1). Assumption: the floor
/// is known to a tenth.
pub(super) const CLOSABLE: f64 = 0.2;

// Proposals: terms that are no cause.

/// Terms that are proposed together at most (count). Assumption: more would be a model of their own.
pub(super) const MOST_TERMS: usize = 2;
/// Terms that are fitted anew in a step (count). Assumption: the best is among them.
pub(super) const REFITTED_TERMS: usize = 6;
/// Terms that count as one choice (count). Assumption: neighbouring powers of a quantity are nearly the same term.
pub(super) const ALIKE_TERMS: f64 = 10.0;
/// Log posterior density by which a term of several quantities has to lead over one of a single quantity (1). Assumption: odds
/// of e² ≈ 7 to 1, since whoever reads it has to look for one cause more.
pub(super) const SIMPLER_TERM: f64 = 2.0;

// Enough data, and channels that count.

/// Fewest groups that are fitted for any answer (count). Derivation: one group says nothing about the scatter
/// between groups.
pub(super) const FEWEST_FITTED: usize = 2;
/// Fewest values of one channel in the fitted groups for any answer (count). Assumption: the noise of a
/// channel is read off its values.
pub(super) const FEWEST_VALUES: usize = 8;
