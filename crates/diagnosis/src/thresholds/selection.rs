//! Thresholds of phase 4: which effects keep their name.

/// The part of `least_beyond` that suffices where the background needs no friction curves: dry and viscous friction are otherwise as
/// modelled. Source: 435 simulated cases, in which it added two true names and no false one.
pub const OF_BEYOND: f64 = 2.0 / 3.0;
/// The least share of a drive's inertia, which every drive has, in the joint's torque. Source: `prove`, seeds 1, 2, 3,
/// 7, 2026 and 2027.
pub const LEAST_DRIVE: f64 = 0.01;
/// The part of the variance of a spring's column that may be noise of the positions. Source: 33 springs that were named on simulated rigid
/// joints of an iiwa, a Panda, an xArm, an excavator and a heavy arm (0.058 to 0.69), and 23 true ones of `prove`, seeds 28112026 to
/// 28112030 (one 0.060, the others 0.042 at most).
pub const NOISE_OF_A_SPRING: f64 = 0.055;
/// The torque of a swaying base on a joint, relative to that of the noise of the positions, that it must have on one joint at least. Source: ten
/// of 128 simulated real arms with a firm base, on which it was 0.5 to 1.0 times the noise, and gone with finer encoders.
pub const NOISE_OF_A_BASE: f64 = 1.5;
/// The part with which a spring is not named, whatever the evidence. Source: the same cases; a false one of the heavy arm has 0.39 and 337
/// nats.
pub const MUCH_NOISE: f64 = 0.25;
/// The evidence with which a spring with a smaller part is named nevertheless (nats). Source: as for [`NOISE_OF_A_SPRING`]; the other
/// false ones had 289 at most.
pub const BEYOND_NOISE: f64 = 300.0;
/// The least share of an unmodelled form in the nominal residual of a joint. Source: first diagnosis.
pub const LEAST_OF_MISMATCH: f64 = 0.05;
/// A torque that varies by less than this part of its mean is nearly constant, so that its size counts instead of its
/// standard deviation: an offset, or friction of a joint that never reverses. Source: first diagnosis.
pub const NEARLY_CONSTANT: f64 = 0.2;
/// A recording does not test an effect that is below this part of the joint's torque in it. Source: `prove`, seeds 1
/// and 2, and two sets made with MuJoCo.
pub const IDLE_EFFECT: f64 = 0.002;
/// The part of its torque's standard deviation by which an effect of another joint may increase the error of a joint.
/// Source: first diagnosis.
pub const HARMLESS: f64 = 0.001;
/// The relative increase of a joint's held-out error from which the joint counts as predicted worse. Source: first
/// background.
pub const WORSE: f64 = 0.01;
/// An effect that may be a part of the background may predict worse than the background by this part. Source: first
/// background.
pub const AS_WELL: f64 = 0.1;
/// The length of the pieces of recordings of which every other one is fitted, if the held-out recordings do not test an
/// effect (s). Source: as for [`IDLE_EFFECT`].
pub const GAIN_PIECE: f64 = 2.0;
/// The least part of an effect's power that every other piece must hold; otherwise the pieces are equal parts of its
/// power. Source: `prove`, seed 5901, in which a torque limit was refused because every other piece of 2 s held nothing
/// of it.
pub const LEAST_OF_HALF: f64 = 0.1;
/// The number of such parts. Source: as for [`LEAST_OF_HALF`].
pub const POWER_PIECES: f64 = 8.0;
/// With fewer moving rows, the error is computed over all rows. Source: first diagnosis.
pub const LEAST_ROWS: usize = 10;
/// The lag of the residual's autocorrelation (s), which is longer than the reach of the filter. Source: first
/// diagnosis.
pub const RESIDUAL_LAG: f64 = 0.1;
/// A joint with a larger error (NRMSE) than this is predicted worse than by a constant. Source: definition of the
/// NRMSE.
pub const HOPELESS: f64 = 1.0;
/// An error (NRMSE) below this means that a part of the torque is explained. Source: first background.
pub const PARTLY: f64 = 0.8;
/// The least share of an effect in the joint's torque with which it is named although another explains nearly as much in its place.
/// Source: simulated cases of four sets; of twelve such names below 3 %, none was right.
pub const LEAST_UNDECIDED: f64 = 0.03;
/// Stribeck friction that only the rows near reversals show must explain this much more than Coulomb friction (nats). Source: `prove`,
/// seeds 28113003 and 28113004.
pub const LEAST_AT_REVERSALS: f64 = 15.0;
/// Such friction has at least this Stribeck velocity, in multiples of the velocity deadband. Source: `prove`, seeds 28113003 and 28113004: ten
/// false ones with 0.6 to 1.1, an examiner's false one with 2.0, true ones with 2.0, 4.4 and 5.5.
pub const SLOWEST_AT_REVERSALS: f64 = 2.5;
/// Friction that falls with time must explain this much more than another level of friction in each recording (nats). Source: an examiner's
/// simulated cases.
pub const LEAST_WITHIN_RECORDINGS: f64 = 0.0;
/// How much more than its best alternative a smaller effect explains at least (nats), and a payload or a factor on inertials of any
/// size. Source: simulated cases of seven sets; of six such payloads and factors, none was right.
pub const UNDECIDED_NATS: f64 = 2.0;
/// A constant beside unmodelled structure on its joint must be at least this multiple of the residual of the named effects
/// there. Source: constants that were a part of such structure reached 0.9 in five simulated cases; the offset of joint 1
/// of an iiwa 14 has 3.3.
pub const ABOVE_RESIDUAL: f64 = 2.5;
/// The evidence of a rotor inertia from which its prediction is also tested without refitting the other effects (nats).
/// Source: 180 simulated cases and 15 others; eight true ones from 28 nats on were refused otherwise, and a false one had
/// 12.
pub const CLEAR_DRIVE: f64 = 20.0;
/// The least share of an effect in the joint's torque in the final fit, where the background may have taken most of it.
pub const LEAST_FINAL_SHARE: f64 = 0.01;
/// The evidence for a torque on one joint alone, against a coupling of it with another joint, with which the coupling is refused
/// (nats). Source: of 19 couplings of three proofs, the evidence is at least 3 nats against it; a torque on one joint that
/// follows the speed of another has 19 nats for it. Between, neither can be told from the other, and the probability is one half.
pub const AGAINST_BOTH: f64 = 3.0;
/// The evidence of an effect, beside the background that is best without it, with which it is named although its main
/// parameter may be that of no effect (nats). Source: simulated cases with wrong URDFs, in which effects of up to 1300
/// nats were dropped because an interval held zero.
pub const CLEAR_THOUGH_UNDETERMINED: f64 = 20.0;
/// The most evidence against wrong inertial parameters that an effect needs if it acts only since a change, or only before it (nats).
/// Source: changes of 12 kinds that were added to recordings of ten real robots, and 58 pairs of their recordings without a change.
pub const MOST_FOR_A_CHANGE: f64 = 24.0;
/// The multiple of a joint's unexplained residual that a change since the recordings from before must exceed. Source: recordings of a
/// double pendulum that did not change, in which four changes of 0.1 to 0.6 times the residual were named.
pub const CHANGE_BESIDE_RESIDUAL: f64 = 1.0;
/// The largest number of stretches on each side of a change, between which its size may differ. Source: the
/// time that a payload's ten terms take.
pub const BLOCKS_A_SIDE: usize = 4;
/// The least mean square of a change over that which the differences between stretches of the same side would give. Source:
/// recordings of three real robots that did not change (up to 15), and simulated pairs: the effects that changed have 14 000 and more, one that
/// did not 21.
pub const CHANGE_OVER_VARIATION: f64 = 30.0;
/// The part of a joint's friction that a change of friction must exceed where one side has only one recording. Source: simulated pairs of
/// recordings between which the friction of every joint differs by 4 to 6 %.
pub const USUAL_VARIATION: f64 = 0.2;
/// The evidence of a payload beside links of which only some differ from the URDF, compared with links that all do (nats). Source: two
/// simulated arms without a payload whose links are all wrong, where it was 6 and 22.
pub const LEAST_BESIDE_SOME_LINKS: f64 = 30.0;
/// The evidence that effects which resemble wrong inertial parameters need together where not all links differ from the URDF, compared with
/// the best background without them (nats). Source: 43 such cases of `prove` (three seeds) and of two other simulators: false ones have 3.3,
/// 9.2, 10.7 and 12.8; true ones have 3.7 and 11.5, which are lost, and 17.1 or more.
pub const LEAST_BESIDE_EXACT_LINKS: f64 = 13.0;
/// The search is not repeated once the final fit has refused more than this number of names. Source: none; it bounds the time.
pub const MOST_REFUSED: usize = 3;
/// A time is outside the 95 % interval of an onset if the fit is worse by this with an onset at that time (nats). Source:
/// half the square of 1.96, doubled because of the correlation of residuals and the reach of the filter.
pub const ONSET_INTERVAL: f64 = 2.0 * 1.92;
/// The largest part of the fitted rows that the interval of an onset may contain. Source: `prove`, seed 5501, in which a false drag
/// set in somewhere between the first row and the last.
pub const MOST_OF_AN_ONSET: f64 = 0.5;
/// The part of its duration by which a contact that begins gently seems to begin later. Source: `prove`, seeds 1, 2, 3,
/// 7, 2026 and 2027.
pub const PUSH_START: f64 = 0.1;
/// The part of the evidence for the background of all links (nats) from which one missing body that brings it alone may
/// take the place of that background with somewhat less evidence. A body that brings less needs
/// [`LEAST_BESIDE_SOME_LINKS`] more. Source: the Panda, whose URDF draws a hand that was not mounted, and a simulated
/// arm of seven axes.
pub const NEARLY_ALL: f64 = 0.7;
/// The least mass of a missing tool, as a part of the last link's mass in the URDF with its tool. A URDF may be wrong
/// by less without a missing tool. Source: the shared lifelike cases with URDFs made wrong by `as_built.py`, seed 3, in which a smaller one was named falsely.
pub const LEAST_OF_THE_LINK: f64 = 0.3;
/// The mass of a payload, as a part of the last link's mass in the URDF, below which it needs [`LEAST_BESIDE_SOME_LINKS`]. Source: of
/// thirteen payloads in simulated cases, the smallest true one is 0.17 of it, and a false one 0.10.
pub const LEAST_MOUNTED: f64 = 0.125;
/// The Coulomb level over a constant torque from which the two may be friction in one direction only: below one, because the fit of a
/// friction that is zero in the other direction may be negative. Source: choice.
pub const LEAST_LEVEL: f64 = 0.9;
/// The number of the most promising alternatives that are fitted in full. Source: first diagnosis.
pub const TRIED_RIVALS: usize = 8;
/// The number of effects that explain too little alone and are tried in pairs. Source: as for [`PARTNERS`].
pub const PAIRED_RIVALS: usize = 3;
/// The number of partners with which each of them is tried. Source: on 15 hard and 8 lifelike cases, pairs cost 3 % of the time, and
/// four are listed.
pub const PARTNERS: usize = 2;
/// The number of resamplings of an interval. Source: first diagnosis.
pub const DRAWS: usize = 120;
/// The standard deviation of the correction of a size in the final fit, relative to the size that the search found. Source: definition; a
/// correction by more is beyond the linearisation.
pub const LARGEST_CORRECTION: f64 = 1.0;
/// The largest number of blocks of a resampling. Source: first diagnosis.
pub const MOST_BLOCKS: usize = 80;
/// The least number of torque constants, more than half of all, that deviate alike if they have one common cause and
/// are not named one by one. Source: a simulated case with five false constants at a probability of 0.985, whose sixth
/// joint had an effect outside the catalogue.
pub const LEAST_ALIKE: usize = 2;
/// The largest ratio of torque constants that agree, so that those of the other joints may be wrong instead. Source: a simulated Panda whose
/// last three torques were in amperes; the named constants of the other four had a ratio of 1.003.
pub const ALIKE_CONSTANTS: f64 = 1.15;
/// The evidence from the constant torques of single recordings that decides between the offset of a sensor and friction that depends on
/// the direction (nats). Source: nine such constants in six sets of simulated cases, of which it decides five, all rightly.
pub const DIRECTION_NATS: f64 = 1.0;
/// The least payload beside a link as it is in the URDF, as a part of the last link's mass. Source: 131 simulated recordings of arms whose links
/// are wrong by 3 %, in three of which a payload of −8 to 7 g was named.
pub const LEAST_PAYLOAD: f64 = 0.03;
/// The radius of gyration of a body on the tool (m) beyond which its moments are taken for those of drives. Source: choice; a bar of 1 m has 0.29 m, and most tools are
/// smaller.
pub const LARGEST_BODY: f64 = 0.3;
/// The most joints of an arm on which wrong links explain most of what a payload does. Source: simulated cases of ten such
/// arms; nine false payloads have 6 to 52 nats more than wrong links, one has 93, and 21 true ones on seven of these arms have 14 to 289.
pub const FEW_JOINTS: usize = 4;
/// What is subtracted on such an arm from the evidence of a payload against wrong links (nats). Source: as for [`FEW_JOINTS`].
pub const BESIDE_FEW_LINKS: f64 = 40.0;
/// The difference from one of a factor of a joint's friction in the held-out recordings from which it is other friction than that of the training
/// recordings. Source: as for `OF_OTHER_FRICTION`.
pub const OTHER_HELD_OUT_FRICTION: f64 = 0.15;
/// The largest such factor; its inverse is the smallest. Drives that warm up do not change their friction by more. Source: as for
/// `OF_OTHER_FRICTION`.
pub const MOST_HELD_OUT_FRICTION: f64 = 2.0;
