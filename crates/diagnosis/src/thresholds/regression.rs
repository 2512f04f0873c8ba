//! Thresholds of phase 2: what counts as evidence, the prior of the background, systematic errors of the intervals.

/// Independent pieces of evidence in a second of a slow motion (1/s). Residuals of a wrong model are correlated over longer
/// than the filter.
pub const EVIDENCE_RATE: f64 = 4.0;
/// Independent pieces of evidence in a period of the motion, where that gives more than [`EVIDENCE_RATE`].
pub const EVIDENCE_PER_PERIOD: f64 = 8.0;
/// Independent pieces of evidence in a second of any motion, at most (1/s).
pub const MOST_EVIDENCE_RATE: f64 = 10.0;
/// Stretches of the only recording that moves a joint: each is predicted by the others.
pub const STRETCHES: usize = 4;
/// Groups of recordings, each of which is predicted by the others.
pub const RECORDING_GROUPS: usize = 6;
/// The prior standard deviation of friction's form, and of its change from recording to recording, at strength one, as a part of
/// the joint's torque.
pub const FRICTION_PRIOR: f64 = 0.015;
/// The prior standard deviation of a torque constant at strength one. Source: torque constants are accurate to about 5 %.
pub const GAIN_PRIOR: f64 = 0.05;
/// The standard deviation that is assumed of torque constants where the recordings need no correction of any constant or link.
pub const LEAST_TORQUE_ACCURACY: f64 = 0.015;
/// The deviation of a torque constant in the background from which it is an effect, in standard deviations of such
/// constants. Source: 96 simulated cases, in which all deviations from 1.5 on were true, and those beyond 2.5 were injected
/// faults.
pub const CONSTANT_TOLERANCE: f64 = 2.5;
/// The largest deviation of a torque constant in the background: a larger one is reported as an effect of its own, or as a
/// wrong torque constant.
pub const MOST_CONSTANT: f64 = 0.2;
/// The largest deviation of a torque constant in the background in standard deviations, where the user states an accuracy of
/// which this is more than [`MOST_CONSTANT`].
pub const MOST_DEVIATIONS: f64 = 4.0;
/// The deviation of a torque constant in the background, in standard deviations, beyond which a note reports it.
pub const MOST_USUAL: f64 = 2.0;
/// The evidence that a part of the background must bring (nats).
pub const PER_BACKGROUND_PART: f64 = 4.0;
/// The evidence that wrong torque constants must bring where all links are wrong (nats). Source: one of ten real robots (the Panda), on
/// which the evidence hardly decides, is predicted better with them; on the other nine, nothing depends on it.
pub const CONSTANTS_BESIDE_LINKS: f64 = 3.0;
/// The evidence that a separate strength of one link must bring (nats).
pub const PER_LINK_APART: f64 = 8.0;
/// The evidence by which two effects on a joint that imitate another body of its link must beat that body (nats).
pub const PER_IMITATION: f64 = 8.0;
/// The part of its largest share in any joint's torque that a payload has on one of the last two joints. Source: simulated
/// cases with wrong URDFs, 0.7 and more for true payloads, 0.43 and less for false ones that resembled a link before the
/// wrist.
pub const FELT: f64 = 0.55;
/// The prior standard deviation of the links' common strength: a URDF is seldom wrong by more than this part everywhere.
pub const USUAL_STRENGTH: f64 = 0.3;
/// The strengths of all links' inertial parameters that are tried.
pub const LINK_STRENGTHS: [f64; 7] = [0.0, 0.01, 0.03, 0.1, 0.2, 0.4, 1.0];
/// The strengths that are tried on one link in addition to the common one.
pub const OWN_STRENGTHS: [f64; 3] = [0.1, 0.3, 1.0];
/// The factor between the strengths that are tried in the end.
pub const FINER_STRENGTH: f64 = 1.4;
/// The strengths of friction's form that are tried.
pub const FRICTION_STRENGTHS: [f64; 3] = [0.0, 1.0, 3.0];
/// The strengths of the joints' constant torques that are tried, relative to [`FRICTION_PRIOR`].
pub const OFFSET_STRENGTHS: [f64; 3] = [0.0, 1.0, 3.0];
/// The largest constant torque, in standard deviations of the background's, that is left to the background instead of being
/// named. Source: 17 simulated cases in which constants replaced names; the small constants of all joints are up to 1.7 and the
/// injected one is 2.4.
pub const USUAL_CONSTANTS: f64 = 2.0;
/// The strengths of the torque constants that are tried.
pub const GAIN_STRENGTHS: [f64; 3] = [0.0, 1.0, 2.0];
/// The radius of gyration about which a body that is a point in the URDF may have (m).
pub const LEAST_BODY_RADIUS: f64 = 0.05;
/// The mass about which a link without mass in the URDF may have (kg).
pub const LEAST_BODY_MASS: f64 = 0.05;
/// The least eigenvalue of a body's pseudo-inertia relative to that of the URDF's body, so that a link never vanishes.
pub const LEAST_BODY_LEFT: f64 = 0.02;
/// The URDF may be wrong in a single direction by this multiple of the background's strength, which is a mean over all links and
/// directions: centres of mass more than moments of inertia, one link more than another.
pub const UNEVEN: f64 = 2.0;
/// The shortest block that is resampled (s); it is longer than the correlation of residuals.
pub const BLOCK: f64 = 2.5;
/// The factor on resampled standard deviations, because residuals are correlated over more than a block. Source: coverage
/// of the intervals on simulated cases.
pub const INFLATION: f64 = 1.25;
/// This factor where friction curves or torque constants differ from the model's: other parts of the drives, which are not modelled,
/// then do so, too, and their residuals do not vary from block to block. Source: coverage of the intervals on simulated cases.
pub const INFLATION_IN_DRIVES: f64 = 2.0;
/// The half-width of an interval, as a part of the value, due to filtering and to a form that is not exact.
pub const SYSTEMATIC: f64 = 0.01;
/// The half-width of an interval, as a part of the value, for a parameter that depends on a form that recordings hardly
/// show: the ends of a gap, friction near standstill, other lags of a drive. Source: the errors on simulated cases.
pub const OF_FORM: f64 = 0.05;
/// The half-width of an interval, as a part of the value and for a background of strength one, for a parameter that is
/// proportional to the links that a joint moves: a stiffness, which follows from the frequency at which the link
/// oscillates, or friction that depends on the load. Source: the errors on simulated cases with URDFs wrong by 3 to 30 %.
pub const OF_ARM: f64 = 0.3;
/// If only some links differ from the URDF, a background in which all links do explains nearly as much if its score is less than
/// this above (nats); intervals then hold those of both backgrounds. Source: a simulated arm whose links are all wrong by 3 %, where
/// the difference is 13.
pub const NEARLY_AS_LIKELY: f64 = 15.0;
/// A correction of the columns that has less evidence than another one by this much (nats), beside the background of the other one,
/// is not fitted further.
pub const FAR_LESS: f64 = 200.0;
/// Above the largest strength that is tried for the links, the interval of their error ends at this multiple of it.
pub const BEYOND_STRONGEST: f64 = 2.0;
