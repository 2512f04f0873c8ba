//! Thresholds of phase 1: the filters, which channels hold a torque, when a joint moves.

/// The cut-off of the second filter if the motion does not require another (Hz). Source: first diagnosis.
pub const CUTOFF: f64 = 12.0;
/// The second filter passes this many times the frequency of the motion. Source: first diagnosis.
pub const CUTOFF_PERIODS: f64 = 22.0;
/// The highest cut-off, for a quick motion (Hz). Source: first diagnosis.
pub const HIGHEST_CUTOFF: f64 = 40.0;
/// The largest cut-off as a share of the sampling rate. Source: at this cut-off, the kernel's width is one
/// sample.
pub const LARGEST_CUTOFF: f64 = 0.235;
/// The ratio of the first filter's cut-off to the second's; nonlinear functions are evaluated between the two. Source: first
/// diagnosis.
pub const WIDER: f64 = 3.0;
/// The least such ratio, for positions so coarse that the noise of the velocity would hide slow motion. Source: both filters are then alike.
pub const LEAST_WIDER: f64 = 1.0;
/// The largest velocity deadband, as a share of the joint's largest speed, with which the first filter stays as wide as it is.
/// Source: seven simulated recordings of an SO-101 with 4096 steps a turn; with 0.1, five of its 13 injected effects are found, and with 0.05
/// eight.
pub const MOST_DEADBAND: f64 = 0.05;
/// A joint whose largest speed is below this multiple of its noise may be at rest. Source: that quantile of white noise is 2.6.
pub const STANDS_OUT: f64 = 3.0;
/// A recording must be this multiple of the kernel's width long, in one piece. Source: the reach of both filters, and ten rows.
pub const LEAST_WIDTHS: f64 = 16.0;
/// A quick motion raises the cut-off if it requires at least this multiple of the present one. Source: first diagnosis.
pub const WORTH_RAISING: f64 = 1.15;
/// The largest part of a joint's torque that the noise of the positions may cause; otherwise the cut-off is lowered.
/// Source: first background, with the recordings of the Panda, on whose joint 1 the error is 0.81 with a cut-off of 12
/// Hz, 0.15 with 8 Hz and 0.10 with 5 Hz.
pub const MOST_NOISE: f64 = 0.05;
/// Noise does not lower the cut-off below this (Hz). Source: first background.
pub const LEAST_CUTOFF: f64 = 4.0;
/// Noise does not lower the cut-off below this multiple of the motion's frequency. Source: first background.
pub const LEAST_CUTOFF_PERIODS: f64 = 8.0;
/// A joint whose speed is less than this multiple of its noise holds still. Source: first diagnosis.
pub const STILL: f64 = 20.0;
/// The band, in cut-offs, whose power counts as noise of the positions. Source: first background.
pub const NOISE_BAND: (f64, f64) = (1.7, 3.4);
/// A channel is idle if it holds one and the same value in this part of the samples in motion. Source: recordings of real
/// drives; in the worst of them, which stand in their dry friction, the part stays below it.
pub const IDLE_CHANNEL: f64 = 0.6;
/// A channel is too coarse if it shows at most this number of values in [`COARSE_PART`] of the samples in motion. Source: a UR3 simulated with
/// another engine, whose wrists have torques of one to two steps: a torque limit of 0.4 to 4 mN m was named, and friction of 1.7 times the
/// true one.
pub const COARSE_CHANNEL: usize = 5;
/// Nearly all samples: this part of them. Source: as for [`COARSE_CHANNEL`].
pub const COARSE_PART: f64 = 0.98;
/// For the test of idle channels, a joint moves where it is faster than this part of its largest speed.
pub const CHANNEL_MOVES: f64 = 0.1;
/// A torque channel with fewer moving samples or rows is not judged.
pub const LEAST_CHANNEL_ROWS: usize = 200;
/// A torque that is below this part of what the model needs to hold and move the arm is in another unit, or is not the
/// drive's. Source: recordings of the TIAGo, of which four channels hold no torque.
pub const FAR_TOO_SMALL: f64 = 0.05;
/// A channel holds another signal if all models have at least this error (NRMSE) on stretches that they were not fitted
/// to. Source: as for [`FAR_TOO_SMALL`].
pub const UNRELATED: f64 = 0.97;
/// A channel whose values are clipped at some limit, or whose stretches are fitted one by one, is a torque if the models have at most this
/// error there (NRMSE).
pub const EXPLAINS_THE_LIMITED: f64 = 0.6;
/// The part of a channel's stretches that the models explain one by one, if it is a torque. Source: with 0.7, five of 13 joints of
/// simulated arms that put down a load were not diagnosed; with 0.5, none.
pub const EXPLAINED_STRETCHES: f64 = 0.5;
/// The ridge of these models, relative to columns of unit power, against collinear columns.
pub const CHANNEL_RIDGE: f64 = 1e-4;
/// A dead channel varies by less than this part of the variation of the model's torque, and by no more than [`NOISE_ALONE`]
/// allows.
pub const DEAD: f64 = 0.05;
/// A channel that varies by less than this part of the torque that varies most, of all joints, holds the rounding of numbers, and no
/// torque. Source: double precision rounds to 1e-16 of a number, and a model sums some hundred of them; no sensor resolves 1e-9 of
/// its range.
pub const ROUNDING: f64 = 1e-9;
/// A dead channel varies by no more than this multiple of its noise after both filters.
pub const NOISE_ALONE: f64 = 4.0;
/// The quantile of a joint's speeds that counts as its largest speed.
pub const SPEED_QUANTILE: f64 = 0.99;
/// The quantiles of a joint's positions that count as the ends of its range.
pub const RANGE_QUANTILES: (f64, f64) = (0.002, 0.998);
/// The quantile of the torque that the model needs, above which a torque limit cannot lie.
pub const NEEDED_QUANTILE: f64 = 0.999;
/// The velocity deadband as a share of the joint's largest speed: below it, the joint counts as resting. Source: first
/// diagnosis.
pub const REST: f64 = 0.015;
/// The velocity deadband is at least this multiple of the velocity's noise.
pub const REST_NOISE: f64 = 6.0;
/// The speed within which the sign of a velocity changes, as a share of the joint's largest speed. Source: Stribeck friction of simulated
/// cases, whose sizes are right to 10 %; with 0.0045, breakaway friction is 40 % too large.
pub const TURNING: f64 = 0.00045;
/// The speed within which the sign of a velocity changes is at least this multiple of the velocity's noise. Source: first diagnosis.
pub const TURNING_NOISE: f64 = 1.8;
/// A row moves steadily if the joint moves within this many widths of the second filter around it. Source: first
/// diagnosis, with the published friction of the TX40 in view.
pub const CORE: f64 = 1.2;
/// A row is in a fast reversal if the joint moves within [`CORE`] widths of it and reaches this multiple of that speed
/// there. Source: as for [`CORE`].
pub const REVERSAL: f64 = 4.0;
/// A joint that stays within this part of its range does not move. Source: first diagnosis, with the recordings of the
/// iiwa 14 in view.
pub const YIELDING: f64 = 0.02;
/// A row is at rest if the joint rests within this many widths of the second filter around it.
pub const RESTING_REACH: f64 = 3.0;
/// On a row at rest the joint is slower than this part of the velocity deadband.
pub const RESTING: f64 = 0.7;
/// A recording moves a joint that exceeds this multiple of the velocity deadband in it. Source: first background.
pub const MOVED: f64 = 4.0;
/// The total duration of the recordings of a role (training, held out) up to which they are used whole (s). Source:
/// first diagnosis.
pub const MOST_SECONDS: f64 = 900.0;
/// The total duration that is used of longer recordings (s). More would make the search slower, and the intervals
/// narrower than justified, because the errors of the catalogue's formulae do not decrease with more samples. Source:
/// an hour at 1 kHz, which takes 10 s and 0.87 GB; true sizes lie in the intervals more often than with 900 s.
pub const LONG_SECONDS: f64 = 240.0;
/// The length of a window, if the recording allows (s). Source: first diagnosis.
pub const USED_WINDOW: f64 = 20.0;
/// The length below which a window gives little after the filters (s).
pub const SHORTEST_WINDOW: f64 = 2.0;
/// The duration of one recording that is sufficient to hold in memory (s), as evenly spread windows. At least half of it is
/// held of a longer recording.
pub const WORTH_HOLDING: f64 = 1000.0;
/// A recording is short beside others that are at least this many times as long.
pub const SHORT_BESIDE: f64 = 4.0;
/// Rows per period of the cut-off. Source: first diagnosis.
pub const ROWS_PER_PERIOD: f64 = 2.5;
/// The largest number of rows; if there are more, rows are dropped evenly. Source: first diagnosis.
pub const MOST_ROWS: f64 = 12_000.0;
/// The least number of bins of a spectrum in the band of the noise; a stretch with fewer does not show the noise.
/// Source: first background.
pub const LEAST_NOISE_BINS: usize = 16;
/// The largest number of samples for which a logger holds a value. Source: first background.
pub const LONGEST_HOLD: usize = 20;
/// The number of changes of a value that show whether it is held. Source: first background.
pub const LEAST_CHANGES: usize = 20;
/// For the test of channels, positions are compared over this many samples on either side.
pub const CHANNEL_STEP: usize = 5;
/// The number of stretches of the cross-validation in the test of channels.
pub const CHANNEL_FOLDS: usize = 5;
/// The quantiles of the magnitudes of a torque channel that are tried as the drive's limit.
pub const CHANNEL_LIMITS: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
/// In the test of channels, the number of columns of a load on the tool: its mass and first moments. Source:
/// definition.
pub const CHANNEL_LOADS: usize = 4;
/// A slower filter is worth another diagnosis if its cut-off is at most this part of the present one. Source: a simulated gap of
/// 0.013 rad in a gear, which stays unexplained with 12 Hz and is found with 5 Hz.
pub const WORTH_SLOWING: f64 = 0.7;
/// The shortest lag of all torques that is removed (s). Source: recordings of ten robots and simulated cases without such a lag, in which
/// the joints agree on 1.6 ms at most.
pub const LEAST_LAG: f64 = 0.002;
/// The shortest lag of all torques that a note reports (s). Source: choice; a shorter one changes viscous friction by less than its
/// interval.
pub const LEAST_NOTED_LAG: f64 = 0.0005;
/// The number of joints that must show a common lag, because the lag of one or two joints may be a delay of their drives.
pub const LEAST_LAGGING: usize = 3;
/// The deviation of a joint's lag from zero, in standard deviations, with which the joint shows the sign of the common lag. Source: as for
/// [`LEAST_LAG_NATS`].
pub const SURE_OF_LAG: f64 = 1.0;
/// The evidence that a common lag must bring without each of the joints (nats). Source: 128 simulated real arms, on which a lag of 3.5 to 8 ms
/// has 10 and more, and torques without lag have 1.8 at most.
pub const LEAST_LAG_NATS: f64 = 8.0;
/// The evidence that a lag of a single recording must bring (nats). Source: simulated cases with torques behind filters at 12 to 20 Hz, in
/// which it has 48 and more.
pub const LEAST_OWN_LAG_NATS: f64 = 30.0;
/// The squared deviation of the joints' lags from a common one, over their variance and for each joint but one, that chance explains. Source:
/// the 99.5 % quantile of the chi-square distribution with six degrees of freedom is 3.1 times their number; with two, it is 95 %. On the
/// recordings of ten robots, nothing depends on it.
pub const MOST_BY_CHANCE: f64 = 3.0;
/// The part of the evidence for a lag of each joint that may contradict a common lag. Source: as for [`LEAST_OWN_LAG_NATS`] (at most
/// 0.001), and the recordings of an iiwa 14 (0.26) and a KR 300 (0.26), whose joints have different lags.
pub const MOST_OF_LAG: f64 = 0.1;
/// The shortest lag of a single recording beyond that of most others that is removed (s). Source: simulated cases, in which such lags had 8 to
/// 37 ms, and the recordings of ten robots, which have none.
pub const LEAST_OWN_LAG: f64 = 0.004;
/// The shortest part of such a lag that is removed in addition to a first one (s). Source: as for [`LEAST_OWN_LAG`].
pub const LEAST_MORE_OWN_LAG: f64 = 0.001;
/// The least number of recordings of which one may have a lag of its own: of two, none is the usual one.
pub const LEAST_WITH_OWN_LAG: usize = 3;
/// The number of times that a lag is removed: the first estimate takes its effect as proportional to it.
pub const MOST_LAGS: usize = 2;
/// The times by which dry friction may turn round late beside a lag of all torques (s): two, because it approaches its level slowly. Source:
/// a UR10 simulated with another engine, whose friction turns round over 0.3 to 1 mrad; a lag of 7 ms was found in all three.
pub const TURNS_LATE: [f64; 2] = [0.005, 0.04];
/// The least part of the model's torque that is gravity's (standard deviations), for a joint to show whether its measured torque contains
/// gravity.
pub const LEAST_GRAVITY: f64 = 0.3;
/// The gravity that measured torques show over the model's, below which they contain none. Source: five simulated recordings without gravity,
/// where it is up to 0.05, and ten real robots with it.
pub const NO_GRAVITY: f64 = 0.15;
/// The part of the model's torque that is gravity's (standard deviations) from which a joint is not diagnosed if the torques of those that
/// carry much weight contain no gravity. Source: choice; a smaller part hardly changes a diagnosis.
pub const SOME_GRAVITY: f64 = 0.03;
/// The gravity that the measured torque of such a joint shows over the model's, from which it is diagnosed nevertheless. Source: choice.
pub const SHOWS_GRAVITY: f64 = 0.5;
/// The inertia that such torques show at least over the model's: a torque in another unit shows little of both. Source: choice.
pub const LEAST_INERTIA: f64 = 0.5;
/// The ridge of that regression, over the mean square of each column.
pub const GRAVITY_RIDGE: f64 = 1e-4;
