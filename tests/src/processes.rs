//! Processes of this machine: what tests look for and send signals to.

use std::path::PathBuf;
use std::process::{Command, Stdio};

/// What Open MPI asks of root, which CI is.
pub const MPI_AS_ROOT: [(&str, &str); 2] = [
    ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
    ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
];

/// A process.
pub struct Process {
    /// Its number.
    pub id: u32,
    /// Its parent's.
    pub parent: u32,
    /// Where it works.
    pub folder: PathBuf,
    /// What its environment says: `NAME=VALUE`.
    pub environment: Vec<String>,
}

/// All processes that this user may look at, as Linux lists them.
pub fn processes() -> Vec<Process> {
    let entries = std::fs::read_dir("/proc").expect("Linux").flatten();
    let ids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    let process = |id: u32| {
        let environment = std::fs::read(format!("/proc/{id}/environ")).ok()?;
        let words = environment.split(|byte| *byte == 0);
        let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
        let parent = status.lines().find_map(|line| line.strip_prefix("PPid:"))?;
        Some(Process {
            id,
            parent: parent.trim().parse().ok()?,
            folder: std::fs::read_link(format!("/proc/{id}/cwd")).ok()?,
            environment: words
                .map(|word| String::from_utf8_lossy(word).into_owned())
                .collect(),
        })
    };
    ids.filter_map(process).collect()
}

/// Sends a process a signal by name; it may be gone already.
pub fn signal(id: u32, name: &str) {
    let kill = format!("kill -{name} {id}");
    let mut command = Command::new("sh");
    let _ = command.args(["-c", &kill]).stderr(Stdio::null()).status();
}
