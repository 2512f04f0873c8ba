//! Numbers on the command line, each within its range.

/// A relative accuracy.
pub fn parse_accuracy(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(part) if (0.0..=3.0).contains(&part) => Ok(part),
        _ => Err("give a fraction from 0 to 3, such as 0.1 for ten per cent".into()),
    }
}

/// A frequency (Hz).
pub fn parse_frequency(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(hertz) if (0.1..=1000.0).contains(&hertz) => Ok(hertz),
        _ => Err("give a frequency from 0.1 to 1000 Hz".into()),
    }
}

/// A lag (s).
pub fn parse_lag(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (-0.2..=0.2).contains(&seconds) => Ok(seconds),
        _ => Err("give a lag from -0.2 to 0.2 s".into()),
    }
}

/// The relative error of the inertial parameters of a URDF.
pub fn parse_urdf_error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(sigma) if (0.0..=1.0).contains(&sigma) => Ok(sigma),
        _ => Err("give a number from 0 (exact) to 1".into()),
    }
}
