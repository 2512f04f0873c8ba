//! One clock for recordings whose stamps are calendar times.

use super::Prepared;

/// Stamps below this (s since 1970, a date in 1973) are not dates but the running time of a controller.
const DATE: i64 = 100_000_000;

/// Puts the recordings whose stamps are dates on one clock, which begins with the whole second of the earliest; those with
/// another clock are unchanged.
pub(super) fn share(recordings: &mut [Prepared]) {
    let epochs: Vec<Option<i64>> = recordings.iter().map(|recording| recording.epoch).collect();
    for (recording, later) in recordings.iter_mut().zip(delays(&epochs)) {
        recording.regular.delay(later);
    }
}

/// The time that must be added to each recording's clock to obtain the common clock (s). `epochs` are the whole seconds
/// that the reader subtracted.
fn delays(epochs: &[Option<i64>]) -> Vec<f64> {
    let dates = epochs.iter().flatten().filter(|&&epoch| epoch >= DATE);
    let begins = dates.min().copied().unwrap_or(0);
    // The reader subtracts the leading digits of a controller's clock, but only from recordings late enough to have them.
    let small: Vec<i64> = epochs.iter().flatten().filter(|&&epoch| epoch < DATE).copied().collect();
    let is_alone = small.len() == epochs.len();
    let begins_small = if is_alone { small.iter().min().copied().unwrap_or(0) } else { 0 };
    let delay = |epoch: &Option<i64>| match *epoch {
        None => 0.0,
        Some(epoch) if epoch >= DATE => (epoch - begins) as f64,
        Some(epoch) => (epoch - begins_small) as f64,
    };
    epochs.iter().map(delay).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_share_a_clock_and_other_clocks_are_unchanged() {
        let noon = 1_709_294_400;
        assert_eq!(delays(&[Some(noon + 3600), Some(noon), None]), [3600.0, 0.0, 0.0]);
        assert_eq!(delays(&[None, None]), [0.0, 0.0]);
        assert_eq!(delays(&[Some(noon)]), [0.0]);
        // A machine that has run for twelve days.
        assert_eq!(delays(&[Some(1_000_060), Some(1_000_001)]), [59.0, 0.0]);
        assert_eq!(delays(&[None, Some(1_000_001)]), [0.0, 1_000_001.0]);
    }
}
