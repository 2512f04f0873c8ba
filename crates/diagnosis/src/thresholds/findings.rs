//! Thresholds of phase 5: alternatives, effects that are not testable, contacts, second sensors, unexplained residuals.

/// An alternative explains nearly as much if it loses at most this part of what the finding explains. Source: first
/// diagnosis.
pub const NEARLY: f64 = 0.08;
/// An alternative also explains nearly as much if it loses at most this evidence (nats). Source: first diagnosis.
pub const NEARLY_NATS: f64 = 4.0;
/// The margin that divides the doubt about a name by e (nats). Source: calibrated on simulated cases.
pub const MARGIN_SCALE: f64 = 8.0;
/// The largest probability of a name, because the catalogue may lack the right one even if the evidence is clear.
/// Source: first diagnosis.
pub const SUREST: f64 = 0.985;
/// A linear effect is listed as not testable if it could reach this part of the joint's torque undetected. Source:
/// first diagnosis.
pub const HIDDEN: f64 = 0.06;
/// An effect is detectable at no size if it would need this multiple of the standard deviation of the joint's torque.
/// Source: detectable sizes that no robot can have were listed without it, such as an encoder offset of 75 rad.
pub const BEYOND: f64 = 3.0;
/// A link is named separately if its strength is at least this multiple of that of most links. Source: first
/// background.
pub const LINK_STANDS_OUT: f64 = 2.0;
/// The relative error of all links from which the URDF is reported as wrong. No CAD model is better, and a smaller
/// correction may explain something else. Source: `prove`, seeds 9173 and 5521: 0.042 and more in 59 cases whose URDF is wrong by 3 %; 0.021
/// and 0.042 where two are exact.
pub const LEAST_WRONG_EVERYWHERE: f64 = 0.03;
/// The least share of that error in the torque of a joint: a smaller correction may explain what is wrong in the form of other effects.
/// Source: as for [`LEAST_WRONG_EVERYWHERE`]; 0.048 and more in all but one of the 59 cases, 0.019 and 0.035 in the two exact ones.
pub const LEAST_SHARE_EVERYWHERE: f64 = 0.04;
/// A transient exceeds the median of all windows of its length, and the usual residual of the model, by this factor.
/// Source: first diagnosis.
pub const ABOVE_USUAL: f64 = 6.0;
/// One force on the tool must explain this part of a transient's power, on pieces it was not fitted to. Source: first
/// diagnosis, with the recordings of the iiwa 14 in view.
pub const ONE_FORCE: f64 = 0.8;
/// More transients than this in the held-out recordings are an error of the model. Source: first diagnosis.
pub const MOST_TRANSIENTS: usize = 4;
/// The usual residual of a joint that moves on fewer training rows is not known. Source: first diagnosis.
pub const LEAST_TRANSIENT_ROWS: usize = 50;
/// The length of the stretches whose residuals are compared with a transient (s). Source: first diagnosis.
pub const TRANSIENT_STRETCH: f64 = 0.4;
/// A held-out recording with fewer stretches of motion has no usual residual of its own. Source: 68 simulated cases of
/// six real arms made with MuJoCo, in 17 of which friction that was larger that day, or a standstill, was reported
/// without it and [`LEAST_MOVING`].
pub const LEAST_STRETCHES: usize = 8;
/// A joint takes part in a transient if it moves on this part of the transient's rows. Source: as for
/// [`LEAST_STRETCHES`].
pub const LEAST_MOVING: f64 = 0.5;
/// The length of the pieces of a transient of which every other is fitted (s). Source: first diagnosis.
pub const TRANSIENT_PIECE: f64 = 0.1;
/// A contact acts on at least this many joints, if the arm has more.
pub const LEAST_PUSHED: usize = 2;
/// A regression between two sensors needs this many rows per coefficient, and as many held-out rows. Source: first
/// diagnosis.
pub const SENSOR_ROWS: usize = 10;
/// The factor on the standard errors of a regression between two sensors. Neighbouring rows are correlated: only one in
/// four counts as independent. Source: the square root of four.
pub const SENSOR_ERRORS: f64 = 2.0;
/// The least share of a joint that is listed with a finding that acts on several joints.
pub const LISTED_SHARE: f64 = 1e-4;
/// Two sensors are compared where the joint exceeds this multiple of the velocity deadband. Source: first diagnosis.
pub const SENSORS_MOVE: f64 = 2.0;
/// A deflection must follow the torque to this part of its power, on recordings it was fitted to and on others. Source:
/// first diagnosis.
pub const FOLLOWS: f64 = 0.5;
/// A difference of encoders beyond this part of the joint's range is not a deflection, because the encoders measure
/// different quantities. Source: first diagnosis.
pub const LARGEST_DEFLECTION: f64 = 0.05;
/// The least part of the difference of two encoders that must be proportional to the torque. Source: first diagnosis.
pub const LEAST_BEND: f64 = 0.4;
/// A compliance must exceed this multiple of its standard error. Source: first diagnosis.
pub const CLEAR_COMPLIANCE: f64 = 4.0;
/// Friction between the sensors must explain this part of their difference's power, as a deflection must ([`FOLLOWS`]).
/// Source: first diagnosis.
pub const FRICTION_EXPLAINS: f64 = 0.5;
/// A friction between the sensors must exceed this multiple of its standard error. Source: first diagnosis.
pub const CLEAR_FRICTION: f64 = 3.0;
/// A joint is located if its nominal residual exceeds the errors of noise and filtering by this factor. Source: first
/// diagnosis.
pub const OVER_NOISE: f64 = 2.0;
/// A region of state is reported if its residual exceeds the joint's by this factor. Source: first diagnosis.
pub const REGION_STANDS_OUT: f64 = 1.3;
/// A stretch of time is reported if its residual exceeds the joint's by this factor. Source: first diagnosis.
pub const WINDOW_STANDS_OUT: f64 = 1.5;
/// The length of the stretches of time that are reported (s). Source: first diagnosis.
pub const WINDOW: f64 = 1.0;
/// Motions are the same within this part of each range. Source: first diagnosis.
pub const SAME_MOTION: f64 = 0.04;
/// An error (NRMSE) above this is not explained if it also exceeds the noise ([`POOR_ABOVE_NOISE`]); on held-out
/// recordings if there are any. Source: first diagnosis.
pub const POOR: f64 = 0.35;
/// The ratio to the noise that a poor error ([`POOR`]) exceeds. Source: first diagnosis.
pub const POOR_ABOVE_NOISE: f64 = 3.0;
/// An error (NRMSE) above this, on training and on held-out recordings, is not explained if it is also structured. Source: of 1666
/// joints in 250 simulated cases and those of 110 others, the structured errors from 0.045 to 0.09 on joints with an unknown effect
/// are 0.057, 0.063, 0.073 and more; there is none on other joints.
pub const STRUCTURED: f64 = 0.05;
/// A known gap or spring between drive and link and the one that is found have the same size if they differ by less than this
/// part.
pub const ALIKE_SIZES: f64 = 0.2;
/// A structured error above this on the training recordings, outside contacts, is not explained even if the held-out
/// recordings do not show it: they may not reach the states in which it arises. Source: 241 simulated cases of eight
/// sets, in which it changes one verdict: a dead band that left 17 %.
pub const STRUCTURED_IN_TRAINING: f64 = 0.12;
/// The number of joints whose residuals change with time from which they have a cause in common. Source: simulated arms on a rolling base, and
/// with a load that decreases.
pub const LEAST_WITH_COMMON_CAUSE: usize = 3;
/// An unmodelled form of the whole arm is reported on the joints on which its share is this part of its largest one. Source: simulated
/// hoses and drag on the tool, whose small shares on the first joints are no sign of a fault there.
pub const LEAST_OF_ARM: f64 = 0.25;
/// The ratio to the noise that a structured error ([`STRUCTURED`]) exceeds. Source: simulated cases made with MuJoCo,
/// in which three of 30 effects outside the catalogue were not reported without it.
pub const STRUCTURED_ABOVE_NOISE: f64 = 4.0;
/// The autocorrelation from row to row that a structured error exceeds. Neither noise nor the filter causes such an
/// autocorrelation. Source: as for [`STRUCTURED_ABOVE_NOISE`].
pub const REMEMBERS: f64 = 0.6;
/// An error (NRMSE) above this, on training and on held-out recordings, that exceeds the noise ([`SWINGS_ABOVE_NOISE`]) and has lost its
/// memory ([`SWINGS`]) is that of a link that swings behind its drive. Source: `prove`, seven seeds of 120 cases; of nine such joints
/// that were called explained, seven have a gap, one a spring, and one moves with a joint that has a gap.
pub const SWINGING: f64 = 0.06;
/// The ratio to the noise that the error of a swinging link ([`SWINGING`]) exceeds. Source: as for [`SWINGING`].
pub const SWINGS_ABOVE_NOISE: f64 = 6.0;
/// The autocorrelation over [`RESIDUAL_LAG`](super::RESIDUAL_LAG) below which a residual has lost its memory. Source: as for
/// [`SWINGING`], where it is between -0.17 and -0.03.
pub const SWINGS: f64 = 0.1;
/// The error (NRMSE) that a joint has at least where the ends of a gap are not those of the model. Source: as for
/// [`OTHER_ENDS_ABOVE_NOISE`], and simulated gaps with rounded ends, which leave 0.046 and more.
pub const OTHER_ENDS: f64 = 0.03;
/// The ratio to the noise that a residual exceeds where the ends of a gap are not those of the model. Source: `prove`, seven seeds; the
/// residuals of 27 of 29 named gaps are below 3.6 times the noise, with sizes within 20 %, the two others at 6.5.
pub const OTHER_ENDS_ABOVE_NOISE: f64 = 4.0;
/// The size that such a gap may have over the size that is found, at least. Source: `prove`, where a gap in which the link bounces was found
/// with 1.27 times its size.
pub const LEAST_OF_SEEN_GAP: f64 = 0.6;
/// The size that such a gap may have over the size that is found, at most. Source: simulated gaps of 3 to 10 mrad whose ends become stiff
/// within 10 to 25 % of the gap, which were named with 0.19 to 0.74 of their size.
pub const LARGEST_OF_SEEN_GAP: f64 = 6.0;
/// The part of the error of a joint with known effects that full identification leaves at most where these effects are too large. Source: an
/// arm whose Coulomb friction had fallen by half, where it leaves 0.12; on its other joints 0.7 and more.
pub const WITHOUT_KNOWN: f64 = 0.5;
/// The probability below which a change since the recordings from before is stated with it. Source: choice.
pub const SURE_CHANGE: f64 = 0.9;
/// The least time in motion that a diagnosis needs on some joint (s). Source: first diagnosis.
pub const LEAST_MOTION: f64 = 4.0;
/// A recording has another load than the others if this load explains this part of its residual, at rest, too. Source: ten real
/// robots and 120 simulated cases; 0.77 to 0.98 in the three recordings of the iiwa14 with another load.
pub const LEAST_OF_RECORDING: f64 = 0.5;
/// That load must also explain this part of the residual of all recordings.
pub const LEAST_OF_RESIDUAL: f64 = 0.1;
/// The least difference of two loads (kg).
pub const LEAST_LOAD: f64 = 0.02;
/// The rows of a regression between two sensors are this part of a period of the cut-off apart. Source: first
/// diagnosis.
pub const SENSOR_SPACING: f64 = 0.4;
/// The number of bins of an axis of state. Source: first diagnosis.
pub const REGION_BINS: usize = 6;
/// A stretch of time with fewer rows is not reported. Source: first diagnosis.
pub const LEAST_WINDOW_ROWS: usize = 5;
/// The largest number of stretches of time that are reported on a joint. Source: first diagnosis.
pub const MOST_WINDOWS: usize = 3;
/// Loads and accelerations are the same within [`SAME_MOTION`] times this multiple of their typical values. Source:
/// first diagnosis.
pub const SAME_LOAD: f64 = 4.0;
/// The part of the residual that repeats is known from this many pairs of rows with the same motion in two recordings.
/// Source: first diagnosis.
pub const LEAST_PAIRS: usize = 30;
/// The largest number of transients that are searched. Source: first diagnosis.
pub const SEARCHED_TRANSIENTS: usize = 12;
/// The least length of the stretches whose residuals are compared with a transient (rows). A joint must move on half of
/// them. Source: first diagnosis.
pub const STRETCH_ROWS: usize = 3;
/// The resolution at which the start of a contact is found (s), given as its interval. Source: first diagnosis.
pub const CONTACT_START: f64 = 0.1;
/// The resolution at which the duration of a contact is found (s), given as its interval. Source: first diagnosis.
pub const CONTACT_DURATION: f64 = 0.2;
/// The number of effects that are fitted beside each smaller correction of the links, as alternatives of links that are
/// all wrong. Source: 48 simulated cases made with MuJoCo, in which the truth is a finding or an alternative in 39 of
/// 49 (36 without these alternatives).
pub const SPECIAL_FORMS_TRIED: usize = 4;
/// The largest number of these alternatives. Source: as for [`SPECIAL_FORMS_TRIED`].
pub const MOST_SPECIAL_FORMS: usize = 3;
/// In the control by full identification, the standard deviation of the prior on inertial parameters, in multiples of their size. It is so
/// wide that it only regularises the normal equations.
pub const FREE_INERTIALS: f64 = 3.0;
/// The part of what a wrong link explains that must be lost with any other link in its place; only what is lost beyond it counts towards the
/// probability. Source: three simulated arms with one centre of mass in the wrong frame, whose true link loses 1.5 to 2.9 % in the place
/// of a false neighbour; the neighbours of six true links lose 7 % and more.
pub const OF_NEIGHBOUR: f64 = 0.04;
/// The number of last links of which a wrong one resembles a payload, half of the links at most. Source: a simulated arm whose last link but one has a mirrored centre
/// of mass.
pub const WRIST: usize = 3;
/// A link that differs from the URDF more than most is named if deviating torque constants explain less in its place, by this evidence
/// (nats). Source: two arms simulated with another engine, whose URDFs are exact: torque constants that deviate by 1 to 3 % were called a
/// wrong link (−1.5 nats); two links that are wrong have 141 and 350.
pub const LINK_OVER_CONSTANTS: f64 = 2.0;
/// The part of the simulated torque of a spring, a gap or a delay, or of the torque that a limit removes, that must suffice for its name,
/// where the diagnosis says from which size on it would be seen. Source: fifteen springs and gaps of up to 4.5 % of the torque, simulated with another engine, that were not
/// named although they were up to 6.3 times as large as the stated size; of two more, one has 36 times it (an encoder offset explains
/// it) and one 10.5 times.
pub const SURELY_SEEN: f64 = 1.0 / 6.0;
/// The multiple of [`REST`](crate::thresholds::REST) above which the deadband of a joint's velocity is said to come from the noise of its
/// positions: twice, so that the noise and not the speed decides. Source: none.
pub const NOISY_REST: f64 = 2.0;
/// The least torque at rest that neither the model nor dry friction explains, as a part of the torque's standard deviation, that is noted.
/// Source: pushes on standing simulated arms (1.2 and more).
pub const LEAST_AT_REST: f64 = 0.5;
/// The shortest time for which it must last (s). Source: the same.
pub const LEAST_REST: f64 = 0.4;
/// The largest error in motion of a joint, as a part of the torque's standard deviation, beside which its torque at rest is noted. Source: the
/// same.
pub const MOST_IN_MOTION: f64 = 0.3;
/// The relative deviation of all links from the URDF from which a body of undetermined mass may be a part of them. Source: `prove`, seeds
/// 28113003 to 28113005, and an examiner's cases: from 0.56 on, three of six payloads with a probability above 0.9 were none; below, none of 10.
pub const MUCH_WRONG_LINKS: f64 = 0.4;
/// A payload's mass is undetermined if half of its interval is larger than this part of it. Source: the same; the three had 0.58, 0.61 and 0.85.
pub const UNSURE_MASS: f64 = 0.5;
/// The least held-out gain of a payload with an undetermined mass beside such links. Source: the same; the three had 0.22 at most, two true ones
/// 0.73 and 0.74.
pub const GAIN_BESIDE_LINKS: f64 = 0.25;
/// The least difference of a joint's dry friction in one recording from that in most others, relative to its torque, that is noted. Source: as for
/// `VARIED_FRICTION`.
pub const OTHER_FRICTION: f64 = 0.04;
/// The part of a joint's held-out error that remains with other friction, if this is the reason for the error. Source: two simulated arms whose
/// friction was 0.6 times as large in the held-out recordings.
pub const OF_OTHER_FRICTION: f64 = 0.7;
