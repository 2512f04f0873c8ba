//! Time stamps: floating-point numbers, large integers, seconds with nanoseconds, ISO 8601.

use chrono::{DateTime, NaiveDateTime};

use crate::header::TimeColumn;
use crate::table::{Cell, Row};

/// Stamps after this time (s) are dates. They are counted from the whole second of the first one, because a double
/// cannot hold both the date and its fraction exactly.
pub const CALENDAR: i64 = 1_000_000;
const NANOS: i64 = 1_000_000_000;

/// The stamps of one file, in the order of its rows.
#[derive(Debug, Default)]
pub struct Stamps {
    /// The offset that is subtracted (s); `None` before the first stamp.
    origin: Option<i64>,
}

impl Stamps {
    /// The second since 1970 from which the stamps are counted, if they are dates.
    pub fn epoch(&self) -> Option<i64> {
        self.origin.filter(|&origin| origin != 0)
    }

    /// The time of `row` (s), if it has a stamp.
    pub fn seconds(&mut self, row: &Row<'_>, time: &TimeColumn) -> Option<f64> {
        let cell = row.cell(time.index);
        if let Some((nanos, _)) = &time.nanos {
            let (whole, nanos) = (cell.number()?, row.cell(*nanos).number()?);
            return Some(self.from(whole as i64, (whole - whole.trunc()) + nanos * 1e-9));
        }
        let nanos = match cell {
            Cell::Nanos(nanos) => Some(nanos),
            Cell::Text(text) if cell.number().is_none() => Some(iso(std::str::from_utf8(text.trim_ascii()).ok()?)?),
            _ => None,
        };
        if let Some(nanos) = nanos {
            return Some(self.from(nanos.div_euclid(NANOS), nanos.rem_euclid(NANOS) as f64 * 1e-9));
        }
        let value = cell.number()?;
        let seconds = value * time.factor;
        if seconds.abs() <= CALENDAR as f64 || seconds.abs() >= i64::MAX as f64 {
            let origin = *self.origin.get_or_insert(0);
            return Some(seconds - origin as f64);
        }
        // Text and integers contain digits that a double cannot hold.
        let per_second = (1.0 / time.factor).round().max(1.0) as i64;
        let text = match cell {
            Cell::Text(text) => std::str::from_utf8(text.trim_ascii()).ok(),
            _ => None,
        };
        let whole = match cell {
            Cell::Integer(whole) => Some(whole),
            _ => text.and_then(|text| text.parse::<i64>().ok()),
        };
        if let Some(whole) = whole {
            let rest = whole.rem_euclid(per_second) as f64 * time.factor;
            return Some(self.from(whole.div_euclid(per_second), rest));
        }
        if let Some((whole, rest)) = text.filter(|_| per_second == 1).and_then(parted) {
            return Some(self.from(whole, rest));
        }
        Some(self.from(seconds.floor() as i64, seconds - seconds.floor()))
    }

    /// The time of a stamp of `whole` seconds plus a `rest`.
    fn from(&mut self, whole: i64, rest: f64) -> f64 {
        let origin = *self.origin.get_or_insert(if whole.abs() > CALENDAR { whole } else { 0 });
        whole.saturating_sub(origin) as f64 + rest
    }
}

/// The whole seconds and the fraction of a non-negative decimal number.
fn parted(text: &str) -> Option<(i64, f64)> {
    let (whole, rest) = text.split_once('.')?;
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|letter| letter.is_ascii_digit());
    if !is_digits(whole) || !is_digits(rest) {
        return None;
    }
    Some((whole.parse().ok()?, format!("0.{rest}").parse().ok()?))
}

/// The time of an ISO 8601 text (ns since 1970; UTC if it has no time zone).
fn iso(text: &str) -> Option<i64> {
    if let Ok(time) = text.parse::<DateTime<chrono::FixedOffset>>() {
        return time.timestamp_nanos_opt();
    }
    let time = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%d %H:%M:%S%.f"]
        .into_iter()
        .find_map(|format| NaiveDateTime::parse_from_str(text, format).ok())?;
    time.and_utc().timestamp_nanos_opt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_calendars_seconds_keep_their_nanoseconds() {
        assert_eq!(parted("1709294400.000000001"), Some((1_709_294_400, 1e-9)));
        for text in ["1709294400", "-1709294400.5", "1.7e9", "17.0e9", "1709294400."] {
            assert_eq!(parted(text), None, "{text}");
        }
        let mut stamps = Stamps::default();
        assert_eq!(stamps.from(1_709_294_400, 0.25), 0.25);
        assert_eq!(stamps.from(1_709_294_402, 1e-9), 2.000_000_001);
        assert_eq!(stamps.epoch(), Some(1_709_294_400));
        let mut stamps = Stamps::default();
        assert_eq!(stamps.from(900_000, 0.5), 900_000.5);
        assert_eq!(stamps.epoch(), None);
    }

    #[test]
    fn iso_8601_is_read_with_and_without_a_zone() {
        let base = iso("2024-03-01T12:00:00Z").expect("it is a time");
        for (text, after) in [
            ("2024-03-01T12:00:00.004Z", 4_000_000),
            ("2024-03-01 12:00:00.004", 4_000_000),
            ("2024-03-01T12:00:00,5", 0),
            ("2024-03-01T13:00:01.25+01:00", 1_250_000_000),
            ("2024-03-01 12:00:00.000001+00:00", 1_000),
            ("2024-03-01T12:00:02", 2 * NANOS),
        ] {
            if text.contains(',') {
                assert_eq!(iso(text), None);
            } else {
                assert_eq!(iso(text), Some(base + after), "{text}");
            }
        }
        assert!(iso("yesterday").is_none() && iso("12:00").is_none());
    }
}
