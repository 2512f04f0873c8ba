//! Time stamps: numbers, whole numbers too large for one, seconds with nanoseconds, ISO 8601.

use chrono::{DateTime, NaiveDateTime};

use crate::header::TimeColumn;
use crate::table::{Cell, Row};

/// Later stamps than this (s) are those of a calendar, and are counted from the first one's whole second: a number has
/// not the digits for both.
const CALENDAR: i64 = 1_000_000;
/// Whole numbers above this have more digits than a number keeps.
const EXACT: f64 = 9e15;
const NANOS: i64 = 1_000_000_000;

/// The stamps of one file, counted from where the first one says.
#[derive(Debug, Default)]
pub struct Stamps {
    /// What is subtracted, in the unit of the stamps (whole numbers) or in s; unknown before the first stamp.
    origin: Option<i64>,
}

impl Stamps {
    /// The time of `row` (s), if it has one.
    pub fn seconds(&mut self, row: &Row<'_>, time: &TimeColumn) -> Option<f64> {
        let cell = row.cell(time.index);
        if let Some((nanos, _)) = &time.nanos {
            let (whole, nanos) = (cell.number()?, row.cell(*nanos).number()?);
            let origin = *self.origin.get_or_insert(from_calendar(whole as i64));
            return Some((whole - origin as f64) + nanos * 1e-9);
        }
        if let Cell::Nanos(nanos) = cell {
            return Some(self.nanos(nanos));
        }
        let Some(value) = cell.number() else {
            let Cell::Text(text) = cell else { return None };
            let nanos = iso(std::str::from_utf8(text.trim_ascii()).ok()?)?;
            return Some(self.nanos(nanos));
        };
        let whole = match cell {
            _ if value.abs() < EXACT => None,
            Cell::Integer(whole) => Some(whole),
            Cell::Text(text) => std::str::from_utf8(text.trim_ascii()).ok()?.parse::<i64>().ok(),
            Cell::Number(_) | Cell::Nanos(_) => None,
        };
        Some(match whole {
            Some(whole) => {
                let origin = *self.origin.get_or_insert(whole);
                whole.saturating_sub(origin) as f64 * time.factor
            }
            None => value * time.factor,
        })
    }

    fn nanos(&mut self, nanos: i64) -> f64 {
        let origin = *self.origin.get_or_insert(from_calendar(nanos.div_euclid(NANOS)));
        let whole = nanos.div_euclid(NANOS) - origin;
        whole as f64 + nanos.rem_euclid(NANOS) as f64 * 1e-9
    }
}

/// What is subtracted from seconds of which the first are `whole`.
fn from_calendar(whole: i64) -> i64 {
    if whole.abs() > CALENDAR { whole } else { 0 }
}

/// The time that an ISO 8601 text is (ns since 1970, UTC where it names no zone).
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
