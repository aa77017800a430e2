//! Every call to the file system fails once, or is the last before a kill or a power loss; then the
//! same command ends with the bytes of an undisturbed run.
//!
//! The whole of it: `cargo test -p bitgrain-tests --release --test alone disk:: -- --ignored --nocapture`

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use bitgrain::bed::library::BedCache;
use bitgrain::campaign::only::Only;
use bitgrain::campaign::sweep::{Sweep, sweep};
use bitgrain::disk::{self, Call, CallOutcome, Watch};
use bitgrain::error::Result;
use bitgrain::progress::Progress;
use bitgrain::run::SaveEvery;
use bitgrain::scenario::CheckedScenario;
use bitgrain_tests::results;
use bitgrain_tests::wee::{WEE, WEE_CAMPAIGN};

use crate::alone;

/// How a call is disturbed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spoil {
    /// It fails; the process goes on.
    Error,
    /// Half of its bytes arrive.
    Short,
    /// The process is killed before it: no call after it is made.
    Kill,
    /// Power is lost before it: what was not synced is lost too.
    PowerLoss,
}

const SPOILS: [Spoil; 4] = [Spoil::Error, Spoil::Short, Spoil::Kill, Spoil::PowerLoss];

/// Disturbs one call, and keeps what a disk without power would have kept.
struct Spoiler {
    at: usize,
    spoil: Spoil,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    calls: usize,
    spoilt: bool,
    /// Whether the disturbed call reads.
    read: bool,
    /// The last calls that saved an unfinished bed and drag.
    saves: [usize; 2],
    disk: FakeDisk,
}

impl Watch for Spoiler {
    fn before(&self, call: &Call<'_>) -> CallOutcome {
        let mut state = self.state.lock().unwrap();
        let (now, dead) = (
            state.calls,
            matches!(self.spoil, Spoil::Kill | Spoil::PowerLoss),
        );
        state.calls += 1;
        if let Call::Rename(_, path) = call {
            let name = path.to_str().expect("text");
            for (save, end) in state.saves.iter_mut().zip(PASSING) {
                if name.ends_with(end) {
                    *save = now;
                }
            }
        }
        if now == self.at || now > self.at && dead {
            if now == self.at {
                state.read = matches!(call, Call::Read(_) | Call::List(_) | Call::Lock(_));
            }
            state.spoilt = true;
            return match (self.spoil, call) {
                (Spoil::Short, Call::Write(_, bytes) | Call::Append(_, bytes)) => {
                    CallOutcome::Short(bytes.len() / 2)
                }
                (Spoil::Error, _) => CallOutcome::Fail(ErrorKind::Other),
                _ => CallOutcome::Fail(ErrorKind::StorageFull),
            };
        }
        state.disk.made(call);
        CallOutcome::Go
    }
}

/// Endings of the files that only an unfinished run has: of a bed, and of a drag.
const PASSING: [&str; 2] = [".pouring.safetensors", "latest.safetensors"];

/// A disk that forgets what was not synced: names by folder, as they are and as they last.
#[derive(Default)]
struct FakeDisk {
    files: Vec<File>,
    now: BTreeMap<PathBuf, Node>,
    lasting: BTreeMap<PathBuf, Node>,
}

#[derive(Clone, Copy, PartialEq)]
enum Node {
    Folder,
    File(usize),
}

#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    lasting: Vec<u8>,
}

impl FakeDisk {
    fn made(&mut self, call: &Call<'_>) {
        match *call {
            Call::Read(_) | Call::List(_) | Call::Lock(_) => {}
            Call::MakeFolder(path) => {
                self.now.insert(path.into(), Node::Folder);
            }
            Call::Create(path) => {
                self.files.push(File::default());
                self.now
                    .insert(path.into(), Node::File(self.files.len() - 1));
            }
            Call::Write(path, bytes) => self.file(path).bytes = bytes.to_vec(),
            Call::Append(path, bytes) => self.file(path).bytes.extend(bytes),
            Call::Sync(path) => {
                let file = self.file(path);
                file.lasting = file.bytes.clone();
            }
            Call::Rename(from, to) => {
                let node = self.now.remove(from).expect("what is renamed was made");
                self.now.insert(to.into(), node);
            }
            Call::Remove(path) | Call::RemoveFolder(path) => {
                self.now.remove(path);
            }
            Call::SyncFolder(folder) => {
                let in_it = |path: &&PathBuf| path.parent() == Some(folder);
                self.lasting.retain(|path, _| !in_it(&path));
                let names = self.now.iter().filter(|(path, _)| in_it(path));
                let names: Vec<_> = names.map(|(path, node)| (path.clone(), *node)).collect();
                self.lasting.extend(names);
            }
        }
    }

    fn file(&mut self, path: &Path) -> &mut File {
        match self.now.get(path) {
            Some(Node::File(k)) => &mut self.files[*k],
            _ => panic!("{} was not made", path.display()),
        }
    }

    /// Puts what lasts, and nothing else, into a folder.
    fn restore(&self, room: &Path) {
        for item in std::fs::read_dir(room).unwrap() {
            let path = item.unwrap().path();
            let _ = std::fs::remove_dir_all(&path);
        }
        for (path, node) in &self.lasting {
            // A name in a folder that is gone is gone.
            let whole = path.ancestors().skip(1).take_while(|up| *up != room);
            if !whole.clone().all(|up| self.lasting.contains_key(up)) {
                continue;
            }
            match node {
                Node::Folder => std::fs::create_dir_all(path).unwrap(),
                Node::File(k) => std::fs::write(path, &self.files[*k].lasting).unwrap(),
            }
        }
    }
}

/// What is run: into `out`, with its beds in `beds`, both in a room.
pub trait Work {
    fn go(&self, room: &Path) -> Result<()>;
}

struct Run(CheckedScenario);

impl Work for Run {
    fn go(&self, room: &Path) -> Result<()> {
        let library = BedCache::new(room.join("beds"));
        let setting = bitgrain::run::Setting {
            scenario: &self.0,
            folder: &bitgrain::folder::Folder(&room.join("out")),
            library: &library,
            threads: 1,
            save: SaveEvery::Steps(900),
            frames: true,
            only: &[],
            write_report: bitgrain::present::write_report,
            progress: &Progress::new(false),
        };
        bitgrain::run::run_in(setting).map(|_| ())
    }
}

pub struct Campaign(pub bitgrain::campaign::plan::Plan);

impl Work for Campaign {
    fn go(&self, room: &Path) -> Result<()> {
        sweep(&Sweep {
            plan: &self.0,
            only: &Only::new(vec![], &self.0)?,
            out: &room.join("out"),
            library: &BedCache::new(room.join("beds")),
            threads: 1,
            jobs: 1,
            save: SaveEvery::Steps(5000),
            retry: false,
            merge: false,
            write_report: bitgrain::present::write_report,
            progress: &Progress::new(false),
        })
        .map(|_| ())
    }
}

fn run() -> Run {
    Run(bitgrain::scenario::parse(WEE, "wee", &[], Path::new("")).unwrap())
}

pub fn campaign() -> Campaign {
    let room = tempfile::tempdir().unwrap();
    std::fs::write(room.path().join("wee.toml"), WEE).unwrap();
    let plan = bitgrain::campaign::plan::parse(WEE_CAMPAIGN, "weecamp", &[], room.path());
    Campaign(plan.unwrap())
}

fn spoiler(at: usize, spoil: Spoil) -> Arc<Spoiler> {
    let state = Mutex::new(State::default());
    Arc::new(Spoiler { at, spoil, state })
}

/// Runs it with one call disturbed, then again undisturbed; returns how many calls the first one made.
pub fn spoilt(work: &impl Work, at: usize, spoil: Spoil, want: Option<&Files>) -> (usize, Files) {
    let folder = tempfile::tempdir().unwrap();
    let room = folder.path();
    let spoiler = spoiler(at, spoil);
    disk::watch(Some(spoiler.clone()));
    let ended = work.go(room);
    disk::watch(None);
    let state = spoiler.state.lock().unwrap();
    if spoil == Spoil::PowerLoss && state.spoilt {
        state.disk.restore(room);
    }
    // Failures to remove, and of trials, may go unreported; no others may.
    if let Err(error) = ended {
        assert!(state.spoilt, "call {at}: {error}");
        let status = error.exit_status();
        // Failed writing is an error, failed reading a refusal: in a dead process whichever comes first.
        let refused = state.read || matches!(spoil, Spoil::Kill | Spoil::PowerLoss);
        assert!(
            status == 1 || refused && status == 2,
            "call {at}, {spoil:?}: {status}, {error}"
        );
    }
    if let Some(want) = want {
        let again = work.go(room);
        assert!(again.is_ok(), "call {at}, {spoil:?}: {:?}", again.err());
        let got = results(&room.join("out"));
        let differ = |name: &&String| got.get(*name) != want.get(*name);
        let wrong: Vec<&String> = got.keys().chain(want.keys()).filter(differ).collect();
        assert!(wrong.is_empty(), "call {at}, {spoil:?}: {wrong:?} differ");
    }
    (state.calls, results(&room.join("out")))
}

pub type Files = BTreeMap<String, Vec<u8>>;

/// Disturbs every `nth` call in every way.
pub fn spoil_all(work: &impl Work, nth: usize) {
    let _alone = alone();
    let (calls, want) = spoilt(work, usize::MAX, Spoil::Kill, None);
    let mut tried = 0;
    for (k, spoil) in SPOILS.into_iter().enumerate() {
        // Not the same calls in each way.
        for at in (k * nth / SPOILS.len()..calls).step_by(nth) {
            spoilt(work, at, spoil, Some(&want));
            tried += 1;
        }
    }
    println!("{calls} calls, {tried} of them spoilt");
    assert!(tried >= SPOILS.len());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_survives_a_call_that_fails() {
    spoil_all(&run(), 197);
}

/// Ten seconds, because the campaign is begun anew for each call that is failed, and the files are really synced.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_survives_a_call_that_fails() {
    spoil_all(&campaign(), 401);
}

#[test]
#[ignore = "a quarter of an hour"]
fn a_run_survives_every_call_that_fails() {
    spoil_all(&run(), 1);
}

#[test]
#[ignore = "half an hour"]
fn a_campaign_survives_every_call_that_fails() {
    spoil_all(&campaign(), 1);
}

/// Whatever is damaged of a run that was killed in the middle of a bed or a drag is made again, or named and left as
/// it is. A quarter of a minute, because each kind of file is damaged in each way and gone on from.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn an_interrupted_run_mends_what_is_damaged() {
    let _alone = alone();
    let work = run();
    let folder = tempfile::tempdir().unwrap();
    let counter = spoiler(usize::MAX, Spoil::Kill);
    disk::watch(Some(counter.clone()));
    work.go(folder.path()).unwrap();
    disk::watch(None);
    let want = results(&folder.path().join("out"));
    let (saves, calls) = {
        let state = counter.state.lock().unwrap();
        (state.saves, state.calls)
    };
    let (mut mended, mut named) = (0, 0);
    // In the middle of the bed, of the first drag, and of the second.
    let points = [saves[0] + 2, saves[1] + 2, calls * 5 / 6];
    for (at, end) in points
        .into_iter()
        .zip([PASSING[0], PASSING[1], "run-1/summary.json"])
    {
        let folder = tempfile::tempdir().unwrap();
        disk::watch(Some(spoiler(at, Spoil::Kill)));
        let ended = work.go(folder.path());
        disk::watch(None);
        assert!(ended.is_err());
        let killed = results(&folder.path().join("out"));
        assert!(killed.keys().any(|name| name.ends_with(end)), "no {end}");
        let files = killed.keys().filter(|name| !name.ends_with(disk::PARTIAL));
        for (name, spoil) in files.flat_map(|name| ways(name)) {
            match mend(&work, &killed, name, spoil, &want) {
                true => mended += 1,
                false => named += 1,
            }
        }
    }
    println!("{mended} mended, {named} named");
    assert!(mended > 36 && named <= 4, "{mended} mended, {named} named");
}

/// A way to damage the bytes of a file.
type Way = fn(&mut Vec<u8>);

/// Every file is damaged by a bit; those that only an unfinished run has in more ways.
fn ways(name: &str) -> Vec<(&str, Way)> {
    let mut ways: Vec<(&str, Way)> = vec![(name, |bytes| {
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
    })];
    if PASSING.iter().any(|end| name.ends_with(end)) {
        ways.push((name, |bytes| bytes.truncate(bytes.len() / 2)));
        ways.push((name, |bytes| bytes.push(7)));
        ways.push((name, Vec::clear));
    }
    ways
}

/// Goes on with a killed run of which one file is damaged; returns whether all came out as it should, and not that
/// the file was named.
fn mend(work: &Run, killed: &Files, name: &str, spoil: Way, want: &Files) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let room = folder.path();
    for (file, bytes) in killed {
        let path = room.join("out").join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let mut bytes = bytes.clone();
        if file == name {
            spoil(&mut bytes);
        }
        std::fs::write(path, bytes).unwrap();
    }
    let path = room.join("out").join(name);
    let damaged = std::fs::read(&path).unwrap();
    let went = work.go(room);
    let Err(error) = went else {
        assert!(results(&room.join("out")) == *want, "{name}");
        return true;
    };
    assert!(error.to_string().contains("out"), "{name}: {error}");
    assert!(std::fs::read(path).unwrap() == damaged, "{name}");
    false
}

/// Fails every write below a folder.
struct ReadOnly(PathBuf);

impl Watch for ReadOnly {
    fn before(&self, call: &Call<'_>) -> CallOutcome {
        let (Call::Create(path) | Call::MakeFolder(path) | Call::Remove(path)) = call else {
            return CallOutcome::Go;
        };
        match path.starts_with(&self.0) {
            true => CallOutcome::Fail(ErrorKind::ReadOnlyFilesystem),
            false => CallOutcome::Go,
        }
    }
}

/// A library that cannot be written to suffices as long as it holds the beds.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_library_that_is_read_only_serves() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let room = folder.path();
    let watch = || disk::watch(Some(Arc::new(ReadOnly(room.join("beds")))));
    for work in [&run() as &dyn Work, &campaign()] {
        watch();
        let refused = work.go(room).unwrap_err();
        assert_eq!(refused.exit_status(), 1, "{refused}");
        disk::watch(None);
        work.go(room).unwrap();
        std::fs::remove_dir_all(room.join("out")).unwrap();
        watch();
        let done = work.go(room);
        disk::watch(None);
        done.unwrap();
        std::fs::remove_dir_all(room.join("out")).unwrap();
    }
}
