//! Thresholds of phase 3: which candidates are tried, and which of them are taken.

/// Below this cut-off (Hz), delays, springs and gaps between drive and link cannot be distinguished. Source: first
/// diagnosis.
pub const LEAST_FOR_DYNAMICS: f64 = 5.0;
/// A candidate is impossible if its torque is this multiple of the torque to be explained, because it then only cancels
/// another one. Source: first diagnosis.
pub const LARGEST_TORQUE_SHARE: f64 = 3.0;
/// The largest part of a recording that contacts may cover. A contact is short in comparison with the recording. A longer
/// force is a load or another unmodelled effect, and a free force in a long window would explain any of these. Source:
/// contacts that are injected into simulated cases last 0.4 to 1.5 s of 25 s.
pub const MOST_OF_A_RECORDING: f64 = 0.15;
/// The time after the beginning of a recording in which a contact must not end (s). Source: six simulated arms with an elastic joint or
/// a flexible base, released at the beginning: three contacts were named at 0 to 0.3 s, with probabilities of 0.956 to 0.985.
pub const SHAKES_FOR: f64 = 0.5;
/// The durations of contact that are tried (s). Source: first diagnosis.
pub const CONTACT_DURATIONS: [f64; 7] = [0.2, 0.35, 0.6, 1.0, 1.6, 2.5, 4.0];
/// The largest number of windows of contact that a residual suggests. Source: first diagnosis.
pub const MOST_CONTACTS: usize = 4;
/// The length of the pieces of a contact's window of which every other is fitted (s). Source: first diagnosis.
pub const CONTACT_PIECE: f64 = 0.15;
/// The largest number of periods of a ripple that a residual suggests on a joint. Source: first diagnosis.
pub const MOST_RIPPLES: usize = 3;
/// The phase through which the slowest ripple passes over the joint's range (rad). Source: first diagnosis.
pub const LEAST_RIPPLE_PHASE: f64 = 16.0;
/// The periods of the quickest ripple (rad of phase per rad or m). Source: first diagnosis.
pub const MOST_RIPPLE_PERIODS: f64 = 400.0;
/// The part of the largest speed at which the filter must pass a ripple. Source: first diagnosis.
pub const RIPPLE_SPEED: f64 = 0.4;
/// The largest number of sinusoids in time that a residual suggests on a joint. Source: first diagnosis.
pub const MOST_WAVES: usize = 2;
/// The lowest and the highest frequency of a sinusoid in time (Hz). Source: first diagnosis.
pub const WAVE_FREQUENCIES: (f64, f64) = (0.3, 8.0);
/// The highest frequency of a sinusoid in time as a part of the cut-off. Source: first diagnosis.
pub const WAVE_CUTOFF: f64 = 0.7;
/// The time from either end of the recordings to the first onset that is tried (s). Source: selected on `prove`, seeds
/// 7 and 2026.
pub const ONSET_FROM_END: f64 = 2.0;
/// The time between the onsets that are tried (s).
pub const TRIED_ONSETS: f64 = 0.5;
/// The time between the onsets that are tried around the best one (s).
pub const FINE_ONSETS: f64 = 0.05;
/// If a model omits the inertias of this many drives, it probably omits those of all drives. Source: simulated cases of
/// `prove`, seeds 1 and 2, and of two sets made with MuJoCo.
pub const TELLING_DRIVES: usize = 2;
/// The reduction of the evidence that the inertia of each drive beyond [`TELLING_DRIVES`] must bring (nats). Without
/// it, a gap that is never crossed could replace an encoder offset with a drive inertia, which have the same torque.
/// Source: as for [`TELLING_DRIVES`].
pub const KNOWN_DRIVE: f64 = 3.0;
/// Springs and gaps between drive and link that are not selected are simulated again if the model's torque on their
/// joint has changed by more than this part of its standard deviation since. Source: 111 simulated cases, in which the
/// names are those without it; some number differs in 18.
pub const SIMULATED_ANEW: f64 = 0.03;
/// The final fit is repeated, at most [`MOST_SETTLING`] times, until the friction and the rotor's torque that a changed torque constant
/// multiplies change by less than this part of the torque's standard deviation. Source: a simulated case in which the two evaluations
/// of the search left 7 % of a friction, which was named a thermal drift.
pub const SETTLED: f64 = 0.002;
/// See [`SETTLED`].
pub const MOST_SETTLING: usize = 6;
/// The gain that an exchange of a candidate for another must bring (nats). Source: first diagnosis.
pub const SWAP_GAIN: f64 = 0.5;
/// A payload that seems to set in within this time of a load that was put down is a part of it (s). Source: a simulated SCARA, on which
/// both were 0.02 s apart.
pub const OF_THE_SAME_LOAD: f64 = 1.0;
/// In the search for another load of some recordings, the least standard deviation of a residual, as a part of that of the
/// joint's torque.
pub const LOAD_FLOOR: f64 = 0.01;
/// In the search for another load, the least effective number of rows from which a variance is estimated; with fewer, the joint
/// says nothing about a load.
pub const LEAST_LOAD_ROWS: f64 = 5.0;
/// The largest distance of a load's mass from the last link's frame that its moments of inertia suggest (m).
pub const LOAD_SIZE: f64 = 0.2;
/// The precision of such a load's parameters before the recordings are read: 10 kg and 10 kg m. Source: the inverse
/// square of 10.
pub const LOAD_PRECISION: f64 = 0.01;
/// The largest number of selected candidates. Source: first diagnosis.
pub const MOST_SELECTED: usize = 60;
/// The largest number of rounds of suggestion. Source: first diagnosis.
pub const MOST_SUGGESTIONS: usize = 3;
/// The largest number of rounds of refinement. Source: first diagnosis.
pub const MOST_REFINEMENTS: usize = 2;
/// The factors on a size in each round of its refinement.
pub const REFINED_SIZES: [[f64; 4]; 4] =
    [[0.75, 0.87, 1.15, 1.33], [0.9, 0.95, 1.05, 1.1], [0.965, 0.983, 1.017, 1.035], [0.988, 0.994, 1.006, 1.012]];
/// The steps of a second size, of a ripple's period and of an onset in the first round of refinement, relative to the largest one.
pub const REFINED_STEPS: [f64; 4] = [-1.0, -0.4, 0.4, 1.0];
/// The ratio of these steps to those of the round before.
pub const FINER_STEPS: f64 = 0.25;
/// The largest step of the logarithm of a second size: of a spring's damping, or of the stiffness of a gap's ends.
pub const SECOND_SIZE_STEP: f64 = 1.2;
/// The largest step of an onset (s).
pub const REFINED_ONSET: f64 = 0.4;
/// The factors on the size with which the other form of an effect is tried.
pub const OTHER_FORM_SIZES: [f64; 3] = [0.7, 1.0, 1.4];
/// The largest number of consecutive swaps. Source: first diagnosis.
pub const MOST_SWAPS: usize = 4;
/// The largest number of candidates that are added in the last round of the search. Source: `prove`, seeds 1, 2, 3, 7, 2026 and 2027.
pub const MOST_LAST: usize = 3;
/// The number of last joints on which the torque of a payload must show. There are two, because the axis of one may go
/// through its centre of mass. Source: as for `FELT`.
pub const PAYLOAD_JOINTS: usize = 2;
/// The number of times that the prior of the links is expanded about the fitted bodies.
pub const MOST_BODIES: usize = 2;
/// The largest number of further expansions, until the fitted bodies are those about which the prior is expanded. Source:
/// five simulated cases, in which two to eight suffice.
pub const MOST_BODY_STEPS: usize = 20;
/// A step of the bodies that is shorter than this in the metric of pseudo-inertias, relative to the prior's strength, is the last.
/// Source: as for [`MOST_BODY_STEPS`]; the last step changes the score by less than 0.1 nats.
pub const LAST_BODY_STEP: f64 = 0.01;
/// The number of the most promising candidates that are fitted in full each round. Source: first diagnosis.
pub const FITTED_AT_ONCE: usize = 8;
/// The number of forms of one effect on one joint that are fitted in full before other effects. Source: cases of
/// `prove` in which dozens of sizes of a gap kept the drive inertia that each contains from being tried.
pub const FORMS_AT_ONCE: usize = 3;
/// The number of candidates that are looked at in a step of a growth, before all are. Source: 47 simulated cases, of
/// which one has another answer (a true payload is found), in 6 to 20 % less time.
pub const MOST_PROMISING: usize = 150;
/// The number of times that the next most promising candidates are tried if the first do not pay. Source: first
/// diagnosis.
pub const MOST_BATCHES: usize = 6;
/// The score beyond that of the present background (nats) from which a smaller part of it cannot be replaced by a few effects, and neither
/// can a still smaller one. Source: 85 simulated cases, whose answers are the same to the byte without this limit.
pub const HOPELESS_EXCHANGE: f64 = 100.0;
/// The largest gain of a later effect in place of the background, relative to that of the one before it. Source: as for
/// [`HOPELESS_EXCHANGE`].
pub const MOST_LATER_GAIN: f64 = 2.0;
/// The evidence by which a factor of masses that changed since the recordings from before must be better than torque constants that all
/// changed (nats): masses do not change by a factor. Source: 129 simulated cases in which constants changed; in one, a factor of all
/// masses with friction on five joints was better by 5.
pub const FACTOR_OF_MASSES: f64 = 20.0;
/// The evidence that an effect of an unusual size requires in addition (nats). Source: torques of single joints in another unit bring more than
/// 100 nats; on recordings of a TIAGo and an iiwa 14, factors above 3 that were not real brought 5 to 13.
pub const UNUSUAL_SIZE: f64 = 30.0;
