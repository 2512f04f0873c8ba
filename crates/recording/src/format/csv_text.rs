//! The beginning of a text file: whether it is a table, its separator, and whether it has a header.

use std::io::Read;

/// The separator of cells in a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// One byte.
    Byte(u8),
    /// Spaces; several of them are one separator.
    Spaces,
}

/// The reason why a file with this beginning is not a table of text, with the line.
pub fn no_table(start: &[u8]) -> Option<(u64, String)> {
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start);
    let said = |reason: &str| Some((1, reason.to_owned()));
    if text.trim_ascii().is_empty() {
        return said(
            "the file is empty; a recording has a header (t, q_<joint>, tau_<joint>, ...) and a row per sample",
        );
    }
    if text.starts_with(b"\xFF\xFE") || text.starts_with(b"\xFE\xFF") {
        return said(
            "the text is UTF-16; save it as UTF-8 (in spreadsheets \"CSV UTF-8\"; or iconv -f UTF-16 -t UTF-8)",
        );
    }
    if let Some(at) = text.iter().position(|&byte| byte == 0) {
        let line = 1 + text[..at].iter().filter(|&&byte| byte == b'\n').count() as u64;
        let reason =
            "there is a zero byte: this is a binary file of no format that is known here, or UTF-16; give CSV in \
                      UTF-8, or a format of docs/recordings.md"
                .to_owned();
        return Some((line, reason));
    }
    if text.trim_ascii().starts_with(b"<") {
        return said("this is XML (a URDF?), not CSV; give a recording here, and the robot's URDF with --robot");
    }
    above_header(text).map(|reason| (1, reason))
}

/// What lines above the header are; `None` if there are none. They have no separators, and lines after them have several.
fn above_header(text: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(text);
    let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    let (first, _) = lines.next().filter(|(line, _)| !line.starts_with('#'))?;
    if first.to_lowercase().starts_with("sep=") {
        return Some(format!("\"{}\" is a line for spreadsheets; delete it", first.trim()));
    }
    let cells = |line: &str| [',', ';', '\t'].map(|separator| line.matches(separator).count() + 1);
    if cells(first) != [1; 3] {
        return None;
    }
    // Numbers with decimal commas are no header.
    let is_name = |cell: &&str| cell.contains(|letter: char| letter.is_alphabetic());
    let names = |line: &str| [',', ';', '\t'].map(|separator| line.split(separator).filter(is_name).count());
    let is_header = |line: &str| names(line).into_iter().any(|count| count >= LEAST_COLUMNS);
    let (_, header) = lines.take(MOST_TITLE_LINES).find(|(line, _)| is_header(line))?;
    let shown: String = first.trim().chars().take(40).collect();
    Some(format!("\"{shown}\" is no header, and line {header} may be one; delete the lines above it"))
}

/// The least number of columns of a recording, and the largest number of lines of text above a header that are recognised.
const LEAST_COLUMNS: usize = 3;
const MOST_TITLE_LINES: usize = 10;

/// What lines that begin with `#` above the table are.
#[derive(Debug, PartialEq, Eq)]
pub enum Comments {
    /// There are none.
    None,
    /// They are above the header.
    AboveHeader,
    /// The last of them is the header, as numpy.savetxt writes it.
    HeaderIsLast(Vec<String>),
}

/// What the lines at the beginning that begin with `#` are, and the text after them.
pub fn comments(start: &[u8]) -> (Comments, &[u8]) {
    let mut rest = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start);
    let mut last: Option<&[u8]> = None;
    while rest.starts_with(b"#") {
        let end = rest.iter().position(|&byte| byte == b'\n').map_or(rest.len(), |end| end + 1);
        last = Some(&rest[1..end]);
        rest = &rest[end..];
    }
    let Some(last) = last else {
        return (Comments::None, start);
    };
    let separator = find_separator(rest);
    let cells = |line: &[u8]| -> Vec<String> {
        let line = String::from_utf8_lossy(line);
        let cells: Vec<&str> = match separator {
            Separator::Byte(byte) => line.trim().split(char::from(byte)).collect(),
            Separator::Spaces => line.split_whitespace().collect(),
        };
        cells.into_iter().map(|cell| cell.trim().to_owned()).collect()
    };
    let (names, values) = (cells(last), cells(first_line(rest)));
    let are_numbers = values.iter().all(|cell| cell.parse::<f64>().is_ok());
    if are_numbers && names.len() == values.len() {
        (Comments::HeaderIsLast(names), rest)
    } else {
        (Comments::AboveHeader, rest)
    }
}

/// The separator of the cells: a semicolon, a tab or spaces where the header has no comma.
pub fn find_separator(start: &[u8]) -> Separator {
    let header = first_line(start).trim_ascii();
    let has = |byte: u8| header.contains(&byte);
    match (has(b','), has(b';'), has(b'\t')) {
        // Numbers contain commas as well.
        (true, true, _) if header.first().is_some_and(u8::is_ascii_digit) => Separator::Byte(b';'),
        (false, true, _) => Separator::Byte(b';'),
        (false, false, true) => Separator::Byte(b'\t'),
        (false, false, false) if has(b' ') => Separator::Spaces,
        _ => Separator::Byte(b','),
    }
}

fn first_line(start: &[u8]) -> &[u8] {
    let text = start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start);
    text.split(|&byte| byte == b'\n').next().unwrap_or_default()
}

/// The columns of `ros2 topic echo --csv` of a joint state, which writes no header: the stamp's seconds and nanoseconds,
/// the frame, and as many names as positions, velocities and efforts.
pub fn headless(start: &[u8], separator: Separator) -> Option<Vec<String>> {
    if separator != Separator::Byte(b',') {
        return None;
    }
    let line = std::str::from_utf8(first_line(start)).ok()?;
    let cells: Vec<&str> = line.split(',').map(str::trim).collect();
    let is_number = |cell: &str| cell.parse::<f64>().is_ok();
    cells.first()?.parse::<i64>().ok()?;
    cells.get(1)?.parse::<u32>().ok()?;
    let names = cells.iter().skip(3).take_while(|cell| !is_number(cell)).count();
    let numbers = cells.len().checked_sub(3 + names)?;
    if names == 0 || is_number(cells[2]) || numbers != 3 * names {
        return None;
    }
    let stamp = ["sec", "nanosec", "frame_id"].map(str::to_owned).into_iter();
    let fields = ["name", "position", "velocity", "effort"].into_iter();
    let columns = fields.flat_map(|field| (0..names).map(move |joint| format!("{field}[{joint}]")));
    Some(stamp.chain(columns).collect())
}

/// Text in which several spaces are replaced by one, and spaces at the ends of lines are removed.
pub struct Squeezed<R> {
    inner: R,
    /// Whether a space is to be written before the next byte, and whether the line has begun.
    due: bool,
    begun: bool,
    buffer: Vec<u8>,
    given: usize,
}

impl<R: Read> Squeezed<R> {
    /// The reader of the original text.
    pub fn new(inner: R) -> Self {
        Self { inner, due: false, begun: false, buffer: Vec::new(), given: 0 }
    }

    fn take(&mut self, byte: u8) {
        match byte {
            b' ' => self.due = self.begun,
            b'\n' | b'\r' => {
                (self.due, self.begun) = (false, false);
                self.buffer.push(byte);
            }
            _ => {
                if self.due {
                    self.buffer.push(b' ');
                }
                (self.due, self.begun) = (false, true);
                self.buffer.push(byte);
            }
        }
    }
}

impl<R: Read> Read for Squeezed<R> {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let mut chunk = [0; 1 << 14];
        while self.given == self.buffer.len() {
            self.buffer.clear();
            self.given = 0;
            let read = self.inner.read(&mut chunk)?;
            if read == 0 {
                return Ok(0);
            }
            for &byte in &chunk[..read] {
                self.take(byte);
            }
        }
        let count = out.len().min(self.buffer.len() - self.given);
        out[..count].copy_from_slice(&self.buffer[self.given..self.given + count]);
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_above_the_header_are_named() {
        let reason = |text: &str| no_table(text.as_bytes()).map(|(_, reason)| reason);
        let table = "t,q_a,tau_a\n0,1,2\n1,1,2\n";
        assert_eq!(reason(table), None);
        assert_eq!(reason(&format!("# a comment\n{table}")), None);
        assert_eq!(reason("t q_a tau_a\n0 1 2\n1 1 2\n"), None);
        assert_eq!(reason("t q_a tau_a\n0,5 1,5 2,5\n1,5 1,5 2,5\n"), None);
        let sep = reason(&format!("sep=,\n{table}"));
        assert_eq!(sep.as_deref(), Some("\"sep=,\" is a line for spreadsheets; delete it"));
        let title = reason(&format!("Robot 7, no load\n\n{table}").replace(", ", " "));
        assert_eq!(
            title.as_deref(),
            Some("\"Robot 7 no load\" is no header, and line 3 may be one; delete the lines above it")
        );
    }
}
