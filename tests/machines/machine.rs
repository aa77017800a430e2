//! What this machine has, and the building and running of a target on it.

use std::env;
use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::firmware;
use super::list::{self, Need, Rig, Target};
use bitgrain_tests::root;

/// Longest time that a build may take: a cold one takes half a minute of a quiet core.
const BUILD: Duration = Duration::from_secs(900);
/// Longest time that a program may run; the slowest, in software arithmetic, takes half a minute.
const RUN: Duration = Duration::from_secs(300);

/// How a program ended.
pub struct Ended {
    /// Whether its exit status was 0.
    pub success: bool,
    /// What it printed.
    pub output: String,
    /// What it said besides.
    pub errors: String,
}

/// The Debian packages that this machine lacks for a target; none if it can be tried.
pub fn missing(target: &Target) -> Vec<&'static str> {
    let path = env::var_os("PATH").unwrap_or_default();
    let lacks = |need: &Need| !is_here(need.0, &path);
    let mut lacking: Vec<Need> = target.all_needs().into_iter().filter(lacks).collect();
    // An older compiler at the same place cannot build the kernel.
    let first = list::CROSS[0];
    if !target.triple.is_empty() && !lacking.contains(&first) && !is_new(&cross_version()) {
        lacking.insert(0, first);
    }
    list::packages(&lacking)
}

/// A file by its whole name, or a command on the path.
fn is_here(name: &str, path: &OsString) -> bool {
    Path::new(name).is_file()
        || !name.contains('/') && env::split_paths(path).any(|folder| folder.join(name).is_file())
}

/// What Debian's compiler says of itself; empty if there is none.
pub fn cross_version() -> String {
    let out = Command::new(list::CROSS[0].0).arg("--version").output();
    let text = out.map(|out| out.stdout).unwrap_or_default();
    String::from_utf8_lossy(&text).trim().to_string()
}

/// Whether `rustc 1.96.0 ...` is at least the compiler that the workspace asks for.
fn is_new(version: &str) -> bool {
    let numbers = |text: &str| -> Option<(u32, u32)> {
        let mut parts = text.split('.');
        Some((parts.next()?.parse().ok()?, parts.next()?.parse().ok()?))
    };
    let ours = version.split(' ').nth(1).and_then(numbers);
    let least = numbers(env!("CARGO_PKG_RUST_VERSION"));
    ours >= least
}

fn folder(rig: Rig) -> PathBuf {
    root().join("tests/rigs").join(match rig {
        Rig::Linux => "linux",
        Rig::Wasm => "wasm",
        Rig::CortexM => "cortex-m",
    })
}

/// One folder for what all targets build.
fn products() -> PathBuf {
    root().join("target/rigs")
}

/// Builds a target's program and says where it is.
///
/// # Errors
/// What the compiler said.
pub fn build(target: &Target) -> Result<PathBuf, String> {
    let cross = !target.triple.is_empty();
    let mut command = cargo(cross);
    command.current_dir(folder(target.rig));
    command.args(["build", "--locked", "--quiet", "--color", "never"]);
    if cross {
        command.args(["-Zbuild-std=core", "--target", target.triple]);
    }
    if target.release {
        command.arg("--release");
    }
    if !target.features.is_empty() {
        command.args(["--features", target.features]);
    }
    command.env("CARGO_TARGET_DIR", products());
    command.env("RUSTFLAGS", target.flags);
    if !target.linker.is_empty() {
        let triple = target.triple.replace('-', "_").to_uppercase();
        command.env(format!("CARGO_TARGET_{triple}_LINKER"), target.linker);
    }
    let ended = with_limit(command, BUILD)?;
    if !ended.success {
        return Err(ended.errors);
    }
    let kind = if target.release { "release" } else { "debug" };
    let file = match target.rig {
        Rig::Linux => "bitgrain-rig-linux",
        Rig::Wasm => "bitgrain_rig_wasm.wasm",
        Rig::CortexM => "bitgrain-rig-cortex-m",
    };
    Ok(products().join(target.triple).join(kind).join(file))
}

/// Builds the library of `tests/rigs/panics`, with a feature or none, and says what it asks of others, and what it
/// offers.
///
/// # Errors
/// What the compiler said, or what is wrong with the library.
pub fn rig_of_the_kernel(features: &str) -> Result<[Vec<String>; 2], String> {
    let mut command = cargo(false);
    command.current_dir(root().join("tests/rigs/panics"));
    command.args([
        "build",
        "--locked",
        "--quiet",
        "--release",
        "--features",
        features,
    ]);
    command.env("CARGO_TARGET_DIR", products());
    let ended = with_limit(command, BUILD)?;
    if !ended.success {
        return Err(ended.errors);
    }
    let library = products().join("release/libbitgrain_rig_panics.so");
    let bytes = std::fs::read(library).map_err(|why| format!("no library: {why}"))?;
    firmware::asked_and_offered(&bytes)
}

/// The workspace's cargo, or Debian's. What the cargo that runs this program has set for it, and what
/// the user has set for other builds, would reach the rigs: it is taken away.
fn cargo(cross: bool) -> Command {
    let ours = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let name = if cross { list::CROSS[1].0.into() } else { ours };
    let mut command = Command::new(name);
    for (key, _) in env::vars_os() {
        let key = key.to_string_lossy();
        let ours = ["CARGO_HOME", "RUSTUP_HOME"].contains(&key.as_ref())
            || [
                "CARGO_HTTP_",
                "CARGO_NET_",
                "CARGO_REGISTR",
                "CARGO_SOURCE_",
            ]
            .iter()
            .any(|begin| key.starts_with(begin))
            || key == "RUSTUP_TOOLCHAIN" && !cross;
        let set = key.starts_with("CARGO") || key.starts_with("RUST") || key == "LD_LIBRARY_PATH";
        if set && !ours {
            command.env_remove(key.as_ref());
        }
    }
    if cross {
        let path = env::var_os("PATH").unwrap_or_default();
        let first = [PathBuf::from("/usr/bin")];
        let all = first.into_iter().chain(env::split_paths(&path));
        command.env("PATH", env::join_paths(all).unwrap_or(path));
        // To build `core` is not among what a stable compiler promises; Debian's can do it.
        command.env("RUSTC_BOOTSTRAP", "1");
    }
    command
}

/// Runs a built program to its end.
///
/// # Errors
/// It cannot be started, or does not end in time.
pub fn run(target: &Target, program: &Path) -> Result<Ended, String> {
    let word = |word: &&str| match *word {
        "{}" => program.as_os_str().to_os_string(),
        plain => plain.into(),
    };
    let words: Vec<OsString> = target.run.0.iter().map(word).collect();
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).current_dir(folder(target.rig));
    with_limit(command, RUN)
}

/// The machine or the emulator that runs a target, with the emulator's version.
pub fn ran_by(target: &Target) -> String {
    let first = target.run.0[0];
    if first.starts_with(['{', '/']) {
        return format!("this machine ({})", env::consts::ARCH);
    }
    let out = Command::new(first).arg("--version").output();
    let text = out.map(|out| out.stdout).unwrap_or_default();
    format!("{first} {}", version(&String::from_utf8_lossy(&text)))
}

/// The first two numbers of the first version in a text.
fn version(text: &str) -> String {
    let bare = |word: &str| word.trim_start_matches('v').to_string();
    let mut words = text.split_whitespace().map(bare);
    let found = words.find(|word| word.starts_with(|c: char| c.is_ascii_digit()));
    let found = found.unwrap_or_default();
    found.split('.').take(2).collect::<Vec<_>>().join(".")
}

/// Runs a command to its end, or stops it.
fn with_limit(mut command: Command, limit: Duration) -> Result<Ended, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    command.stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command
        .spawn()
        .map_err(|why| format!("{name} does not start: {why}"))?;
    let output = reader(child.stdout.take());
    let errors = reader(child.stderr.take());
    let ended = wait(&mut child, limit).map_err(|why| format!("{name}: {why}"))?;
    let text = |thread: thread::JoinHandle<Vec<u8>>| {
        let bytes = thread.join().unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    };
    let Some(success) = ended else {
        return Err(format!("{name} was stopped after {} s", limit.as_secs()));
    };
    Ok(Ended {
        success,
        output: text(output),
        errors: text(errors),
    })
}

/// Reads a stream as it comes, so that the program never waits for a full pipe.
fn reader(stream: Option<impl Read + Send + 'static>) -> thread::JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            // What came before an error is what there is.
            let _ = stream.read_to_end(&mut bytes);
        }
        bytes
    })
}

/// Whether it succeeded; none if it had to be stopped.
fn wait(child: &mut Child, limit: Duration) -> std::io::Result<Option<bool>> {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status.success()));
        }
        if begin.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(10));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_read() {
        assert_eq!(version("qemu-s390x version 7.2.22 (Debian 1:7.2)"), "7.2");
        assert_eq!(version("QEMU emulator version 7.2.22 (Debian"), "7.2");
        assert_eq!(version("v20.20.2\n"), "20.20");
        assert_eq!(version("none"), "");
        assert!(is_new("rustc 1.96.0 (ac68faa20 2026-05-25)"));
        assert!(is_new("rustc 2.0.0"));
        assert!(!is_new("rustc 1.63.0") && !is_new("") && !is_new("rustc"));
    }

    #[test]
    fn commands_are_looked_for_on_the_path() {
        let path = OsString::from("/nowhere:/bin:/usr/bin");
        assert!(is_here("sh", &path) && is_here("/bin/sh", &path));
        assert!(!is_here("sh", &OsString::from("/nowhere")) && !is_here("/nowhere/sh", &path));
    }

    #[test]
    fn what_takes_too_long_is_stopped() {
        let sleep = |seconds: &str| {
            let mut command = Command::new("sh");
            command.args([
                "-c",
                &format!("echo said; echo so >&2; exec sleep {seconds}"),
            ]);
            command
        };
        let told = with_limit(sleep("60"), Duration::from_millis(100));
        assert_eq!(told.err().unwrap(), "sh was stopped after 0 s");
        let ended = with_limit(sleep("0"), RUN).unwrap();
        assert!(ended.success && ended.output == "said\n" && ended.errors == "so\n");
        let none = with_limit(Command::new("/nowhere/sh"), RUN);
        assert!(
            none.err()
                .unwrap()
                .starts_with("/nowhere/sh does not start")
        );
    }
}
