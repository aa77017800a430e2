//! The smallest runs that have everything: half a second each, so that they can be damaged in every way.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use bitgrain::manifest::{self, FileRecord, FolderKind, Manifest};

use crate::results;

/// One bed of 130 grains and two drags with tables, checkpoints and snapshots.
pub const WEE: &str = r#"
name = "wee"
units = "reduced"

[bed]
box = [5.0, 5.0, 6.0]
grains = 130
settled = 1e-1

[law]
kind = "hertz_history"
kn = 1e5
kt = 1.2e5
gamma_n = 560.0
gamma_t = 560.0
mu = 0.5

[intruder]
diameter = 1.0
height = 3.0
speed = [0.6, 1.2]

[drag]
dt = 6e-4
distance = 1.5

[measure]
every = 5
digest_every = 200
checkpoints = 3
snapshots = 2
"#;

/// Two frictions of it: two members with two drags each.
pub const WEE_CAMPAIGN: &str = r#"
name = "weecamp"
base = "wee.toml"

[[grid]]
name = "friction"
mu = [0.3, 0.5]
speed = [0.6, 1.2]
"#;

/// How long a command on such a run may take before it is taken to hang.
pub const DEADLINE: Duration = Duration::from_secs(120);

/// A folder to work in: `wee.toml` and `weecamp.toml` lie in it.
pub struct Room {
    /// The folder.
    pub folder: tempfile::TempDir,
    program: &'static str,
}

impl Room {
    /// With the two files in it.
    pub fn new(program: &'static str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let room = Self { folder, program };
        room.write("wee.toml", WEE);
        room.write("weecamp.toml", WEE_CAMPAIGN);
        room
    }

    /// With a finished run in `run`, a finished campaign in `camp` and their beds in `beds`.
    pub fn furnished(program: &'static str) -> Self {
        let room = Self::new(program);
        room.done("run wee.toml --out run");
        room.done("sweep weecamp.toml --out camp");
        room
    }

    /// A copy of it, to be changed.
    pub fn copy(&self) -> Self {
        let room = Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
            program: self.program,
        };
        copy_all(self.folder.path(), room.folder.path());
        room
    }

    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file, and the folders above it.
    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        let path = self.path(name);
        let above = path.parent().expect("it lies below");
        std::fs::create_dir_all(above).expect("a folder can be made");
        std::fs::write(path, text).expect("a file can be written");
    }

    /// Reads a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Changes the text of a file, which must change.
    pub fn edit(&self, name: &str, from: &str, to: &str) {
        let text = String::from_utf8(self.read(name)).expect("text");
        let new = text.replace(from, to);
        assert_ne!(new, text, "{name} has no {from}");
        self.write(name, new);
    }

    /// A command, its words separated by spaces.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(self.program);
        command
            .args(words.split(' '))
            .current_dir(self.folder.path());
        command
    }

    /// Begins a command that is not waited for.
    pub fn begin(&self, words: &str) -> Child {
        let mut command = self.command(words);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().expect("the command starts")
    }

    /// Runs a command to its end, which must come before the deadline.
    pub fn told(&self, words: &str) -> Output {
        let mut command = self.command(words);
        command.stdin(Stdio::null());
        let out = tempfile::NamedTempFile::new().expect("a temporary file");
        let err = tempfile::NamedTempFile::new().expect("a temporary file");
        command.stdout(out.reopen().expect("it is there"));
        command.stderr(err.reopen().expect("it is there"));
        let mut child = command.spawn().expect("the command starts");
        let began = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().expect("it can be waited for") {
                break status;
            }
            if began.elapsed() > DEADLINE {
                let _ = child.kill();
                panic!("{words} hangs");
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        let read =
            |file: &tempfile::NamedTempFile| std::fs::read(file.path()).expect("it is there");
        Output {
            status,
            stdout: read(&out),
            stderr: read(&err),
        }
    }

    /// What a command said on both its channels, which must end with this status.
    pub fn says(&self, words: &str, status: i32) -> String {
        let out = self.told(words);
        let text = String::from_utf8_lossy(&out.stdout).into_owned()
            + &String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(status), "{words}: {text}");
        text
    }

    /// The same of a command that must end well.
    pub fn done(&self, words: &str) -> String {
        self.says(words, 0)
    }

    /// Every file below a folder of it.
    pub fn files(&self, name: &str) -> std::collections::BTreeMap<String, Vec<u8>> {
        results(&self.path(name))
    }
}

/// Makes a folder's manifest so that it vouches for whatever lies there, as a forger would, or as it is
/// if results come from elsewhere: finished, with these stages.
pub fn forge_manifest(root: &Path, of: FolderKind, stages: &[&str]) {
    let names: Vec<String> = stages.iter().map(|name| name.to_string()).collect();
    let mut manifest = Manifest::new(of, &names);
    manifest.finished = true;
    manifest
        .stages
        .iter_mut()
        .for_each(|stage| stage.finished = true);
    let files = results(root).into_iter();
    let files = files.filter(|(name, _)| !name.ends_with(manifest::NAME));
    manifest.files = files
        .map(|(name, bytes)| FileRecord::of(&name, &bytes))
        .collect();
    std::fs::write(root.join(manifest::NAME), manifest.text()).expect("a file can be written");
}

/// Copies everything below a folder.
pub fn copy_all(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder can be made");
    for item in std::fs::read_dir(from).expect("a readable folder") {
        let path = item.expect("a readable entry").path();
        let copy = to.join(path.file_name().expect("it has a name"));
        if path.is_dir() {
            copy_all(&path, &copy);
        } else {
            std::fs::copy(&path, &copy).expect("a file can be copied");
        }
    }
}
