//! Short names of tasks.

use std::path::Path;

/// Tasks and their short names, which are different for each.
pub struct Labels(Vec<(String, String)>);

impl Labels {
    /// The file's name without its folder and "task", or the whole path where two tasks have the same.
    pub fn new(tasks: &[String]) -> Self {
        let shared = |task: &String| tasks.iter().filter(|other| short(other) == short(task)).count() > 1;
        let label = |task: &String| if shared(task) { task.clone() } else { short(task) };
        Self(tasks.iter().map(|task| (task.clone(), label(task))).collect())
    }

    /// The short name of `task`.
    pub fn of<'a>(&'a self, task: &'a str) -> &'a str {
        self.0.iter().find(|(known, _)| known == task).map_or(task, |(_, label)| label)
    }

    /// The short names as names of files, in the order of the tasks.
    pub fn files(&self) -> Vec<String> {
        self.0.iter().map(|(_, label)| label.replace(['/', '\\'], "-")).collect()
    }
}

fn short(task: &str) -> String {
    let name = Path::new(task).file_stem().map_or(task.into(), |stem| stem.to_string_lossy());
    name.trim_start_matches("task").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_of_the_same_name_are_told_apart_by_their_paths() {
        let labels = Labels::new(&["taskA", "real/lwr4.csv", "real/lwr4.toml"].map(str::to_owned));
        assert_eq!(["taskA", "real/lwr4.csv"].map(|task| labels.of(task)), ["A", "real/lwr4.csv"]);
        assert_eq!(labels.files(), ["A", "real-lwr4.csv", "real-lwr4.toml"]);
    }
}
