//! The outputs of the program: printed text, written files, and the checks before.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use anyhow::{Context, bail, ensure};
use serde::Serialize;

/// `text` with its control characters as `\u001b`, so that names from files cannot command a terminal; line breaks and tabs remain. So
/// do characters that reverse the direction of what is shown. JSON means the same afterwards.
fn visible(text: &str) -> Cow<'_, str> {
    let commands = |c: char| {
        (c.is_control() && c != '\n' && c != '\t') || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(commands) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if commands(c) {
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// A message as it is shown: as [`visible`] has it, and with each further line indented, so that a line break in a name from a file
/// does not begin a message of its own.
pub fn message(text: &str) -> String {
    let mut lines = text.lines();
    let mut shown = visible(lines.next().unwrap_or_default()).into_owned();
    for line in lines {
        let indent = if line.starts_with([' ', '\t']) || line.is_empty() { "" } else { "  " };
        let _ = write!(shown, "\n{indent}{}", visible(line));
    }
    shown
}

/// Prints a message (a note, a warning, an error) on standard error.
pub fn say(text: impl std::fmt::Display) {
    eprintln!("{}", message(&text.to_string()));
}

/// Prints `text` on standard output, with its control characters escaped. A reader that stops (`| head`) is no error.
///
/// # Errors
/// If it cannot be written for another reason.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(visible(text).as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(anyhow::Error::new(error).context("printing the result"))
        }
        _ => Ok(()),
    }
}

/// Writes `value` as JSON to `path`, completely or not at all, or prints it if `path` is `-`.
///
/// # Errors
/// If the file cannot be written.
pub fn write_json(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(value)?;
    if is_stdout(Some(path)) {
        return print(&(text + "\n"));
    }
    recording::write_whole(path, |file| writeln!(file, "{text}"))?;
    Ok(())
}

/// Whether `json` is standard output (`-`), on which nothing else is printed then.
pub fn is_stdout(json: Option<&Path>) -> bool {
    json == Some(Path::new("-"))
}

/// Prints `text`: on standard error if the JSON is printed on standard output.
///
/// # Errors
/// If it cannot be written.
pub fn print_beside(json: Option<&Path>, text: &str) -> anyhow::Result<()> {
    if is_stdout(json) {
        eprint!("{}", visible(text));
        return Ok(());
    }
    print(text)
}

/// Writes `text` to `path`, completely or not at all.
///
/// # Errors
/// If the file cannot be written.
pub fn write_text(path: &Path, text: &str) -> anyhow::Result<()> {
    recording::write_whole(path, |file| file.write_all(text.as_bytes()))?;
    Ok(())
}

/// The bytes at the beginning and at the end of a file among which its mark is looked for.
const MARKED: u64 = 1 << 16;

/// A file to write.
#[derive(Clone, Copy, Debug)]
pub struct OutputFile<'a> {
    /// The option that asks for it.
    pub option: &'static str,
    pub path: &'a Path,
    /// The endings of the file's name that are accepted, in lower case and without the dot.
    pub endings: &'static [&'static str],
    /// What each earlier output of this kind has at its beginning or end, by which a file is recognised that may be replaced. Empty: the
    /// command has its own check, or none.
    pub mark: &'static str,
}

impl<'a> OutputFile<'a> {
    /// The file at `path`, if the option was given.
    pub fn given(option: &'static str, path: Option<&'a Path>, endings: &'static [&'static str]) -> Option<Self> {
        path.map(|path| Self { option, path, endings, mark: "" })
    }

    /// The file, which replaces only files with this mark.
    pub fn marked(self, mark: &'static str) -> Self {
        Self { mark, ..self }
    }

    /// The file of `--json`, which replaces only files with this mark: the line of its schema.
    pub fn json(path: &'a Path, mark: &'static str) -> Self {
        let (option, endings) = ("--json", &["json"]);
        Self { option, path, endings, mark }
    }

    /// The file of `--markdown`.
    pub fn markdown(path: &'a Path) -> Self {
        let (option, endings, mark) = ("--markdown", &["md", "markdown"], "");
        Self { option, path, endings, mark }
    }

    /// The file of `--rerun save=FILE`.
    pub fn rerun(path: &'a Path) -> Self {
        // The name of the application stands uncompressed at the file's beginning.
        let (option, endings, mark) = ("--rerun save", &["rrd"], "testbed_");
        Self { option, path, endings, mark }
    }

    /// Refuses a name of another format, and a file of the user that would be replaced.
    ///
    /// # Errors
    /// If it is one.
    pub fn check(&self) -> anyhow::Result<()> {
        self.check_ending()?;
        self.check_replaceable()
    }

    /// Refuses to replace a file that is not an earlier output of this kind. Empty files, devices and pipes are accepted.
    ///
    /// # Errors
    /// If there is one, or if it cannot be read.
    fn check_replaceable(&self) -> anyhow::Result<()> {
        if self.mark.is_empty() || !self.path.is_file() || is_stdout(Some(self.path)) {
            return Ok(());
        }
        let is_earlier = has_mark(self.path, self.mark).with_context(|| self.path.display().to_string())?;
        ensure!(
            is_earlier,
            "{} {}: exists and was not written by this option; give another file, or remove it first",
            self.option,
            self.path.display()
        );
        Ok(())
    }

    /// Refuses a name with the ending of another format, which other programs would read as that format, and standard output
    /// (`-`), which only JSON is written to. A name without an ending is accepted, and so is an existing device or pipe.
    ///
    /// # Errors
    /// If the name has another ending, with those that it may have.
    fn check_ending(&self) -> anyhow::Result<()> {
        if self.path == Path::new("-") && self.option != "--json" {
            bail!("{} -: only --json writes to standard output; name a file", self.option);
        }
        let Some(ending) = self.path.extension().map(|ending| ending.to_string_lossy()) else {
            return Ok(());
        };
        let is_special = self.path.exists() && !self.path.is_file();
        if is_special || self.endings.contains(&ending.to_lowercase().as_str()) {
            return Ok(());
        }
        bail!(
            "{} {}: this option does not write .{ending} files; end the name in .{}",
            self.option,
            self.path.display(),
            self.endings.join(" or .")
        );
    }
}

/// Whether a file is empty, or has `mark` near its beginning or end.
///
/// # Errors
/// If it cannot be read.
pub fn has_mark(path: &Path, mark: &str) -> std::io::Result<bool> {
    let mut file = std::fs::File::open(path)?;
    let length = file.metadata()?.len();
    let mut has = |from: u64| -> std::io::Result<bool> {
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(from))?;
        Read::by_ref(&mut file).take(MARKED).read_to_end(&mut bytes)?;
        Ok(bytes.windows(mark.len()).any(|window| window == mark.as_bytes()))
    };
    Ok(length == 0 || has(0)? || has(length.saturating_sub(MARKED))?)
}

/// Refuses a file that could not be written, before any work is done for it.
///
/// # Errors
/// If its folder does not exist or cannot be written to, or the path is a folder.
pub fn check_writable(path: &Path) -> anyhow::Result<()> {
    if is_stdout(Some(path)) {
        return Ok(());
    }
    if path.is_dir() {
        bail!("{}: is a folder; give the name of a file", path.display());
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if let Err(error) = tempfile::tempfile_in(folder) {
        bail!("{}: cannot be written: {error}; {}", path.display(), recording::write_remedy(&error));
    }
    Ok(())
}

/// Refuses two outputs of the same file, of which one would be lost.
///
/// # Errors
/// If there are two.
pub fn check_distinct(outputs: &[OutputFile<'_>]) -> anyhow::Result<()> {
    for (k, output) in outputs.iter().enumerate() {
        if let Some(other) = outputs[..k].iter().find(|other| study::is_same(other.path, output.path)) {
            bail!("{}: is given for two outputs; give each output its own file", other.path.display());
        }
    }
    Ok(())
}

/// Refuses an output that is one of the `inputs`, which would be overwritten.
///
/// # Errors
/// If it is.
pub fn check_is_no_input<'a>(path: &Path, inputs: impl Iterator<Item = &'a Path>) -> anyhow::Result<()> {
    for input in inputs {
        if study::is_same(path, input) {
            let other_name = if path == input { String::new() } else { format!(" ({})", input.display()) };
            bail!("{} is an input of this command{other_name}; write to another file", path.display());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_and_further_lines_are_indented() {
        assert_eq!(visible("a\tb\n"), "a\tb\n");
        assert_eq!(visible("\u{1b}[31mq\r\u{9b}2J\u{202e}é"), "\\u001b[31mq\\u000d\\u009b2J\\u202eé");
        let json = serde_json::to_string("\u{1b}[31m\u{9b}\u{202e}").expect("it is a string");
        let read: String = serde_json::from_str(&visible(&json)).expect("it is still JSON");
        assert_eq!(read, "\u{1b}[31m\u{9b}\u{202e}");
        let name = "j\nerror: all is lost";
        assert_eq!(
            message(&format!("note: {name} is fixed; choose one:\n  --tip a")),
            "note: j\n  error: all is lost is fixed; choose one:\n  --tip a"
        );
    }

    #[test]
    fn an_ending_of_another_format_is_refused_with_the_possible_ones() {
        let check = |path: &str| {
            let path = Some(Path::new(path));
            let file = OutputFile::given("--report", path, &["html", "htm"]).expect("a path was given");
            file.check_ending().map_err(|error| error.to_string())
        };
        for accepted in ["r.html", "a.b/r.HTM", "r", ".pdf", "a.b/r", "/dev/null"] {
            assert_eq!(check(accepted), Ok(()));
        }
        for (refused, ending) in [("r.pdf", "pdf"), ("r.html.gz", "gz"), ("r.", "")] {
            let message = format!(
                "--report {refused}: this option does not write .{ending} files; end the name in .html or .htm"
            );
            assert_eq!(check(refused), Err(message));
        }
    }
}
