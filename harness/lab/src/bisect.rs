//! Where two runs part: the chains of digests say between which links, the runs executed again say at
//! which step, and their states and contacts say where.
//!
//! Each run is executed again by its own program, so that two builds can be compared; by this program
//! if none is named.

mod builds;
mod contact;

pub use builds::run_both;

use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde::Deserialize;

use crate::compare::{Difference, first_difference};
use crate::folder::Folder;
use crate::manifest::{self, Departure, Manifest};
use crate::recording::command::last_words;
use crate::replay::{ContactState, Digests};
use bitgrain_sim::chain::{Chain, Link, differing};
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::{read_text, text_of};
use bitgrain_sim::parts::alone;
use contact::first_contact;

/// The name of a temporary file of ours in errors.
const TEMPORARY: &str = "a temporary file";

/// A run and the program that executes it again.
#[derive(Clone, Debug)]
pub struct Side {
    /// The run directory.
    pub folder: PathBuf,
    /// The program.
    pub program: PathBuf,
}

/// Where two runs first differ.
#[derive(Clone, Debug)]
pub struct Divergence {
    /// The stage.
    pub stage: String,
    /// Its last step with equal states; none if they differ from the beginning.
    pub equal: Option<u64>,
    /// Its first step with different ones.
    pub step: u64,
    /// Parts of the state that differ there.
    pub parts: Vec<&'static str>,
    /// The first number that differs, in the order of the parts.
    pub number: Option<Difference>,
    /// The first contact that differs: which, and how.
    pub contact: Option<String>,
    /// Which run has less of the stage, if no state is known to differ.
    pub ends: Option<String>,
}

/// Finds where two runs part; `None` if every link that both have is the same, and both are finished, with the same
/// stages of the same steps. With `prefix` one may have less than the other. `say` reports what is being done.
///
/// # Errors
/// Runs that have no link in common, a program that does not do as it should, and runs whose own records are not what
/// their programs give.
pub fn bisect(
    sides: &[Side; 2],
    prefix: bool,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<Option<Divergence>> {
    let [one, other] = sides;
    let mut stages = one.stages()?;
    for stage in other.stages()? {
        if !stages.contains(&stage) {
            stages.push(stage);
        }
    }
    let (mut links, mut uneven) = (0, None);
    for stage in stages {
        let chain = |side: &Side| chain_of(&side.folder, &stage);
        let chains = [chain(one)?, chain(other)?];
        let [a, b] = chains.each_ref().map(links_of);
        let common = common(a, b);
        links += common.len();
        let parted = common.iter().position(|(a, b)| a.parts != b.parts);
        if let Some(at) = parted {
            let equal = at.checked_sub(1).map(|before| common[before].0.step);
            let (a, b) = common[at];
            let from = equal.unwrap_or(a.step);
            say(&format!(
                "{stage}: the links at step {} differ; steps {from} to {} again",
                a.step, a.step
            ))?;
            let step = first_step(sides, &stage, from, [a, b])?;
            return parting(sides, stage, step, equal).map(Some);
        }
        let (count, equal) = (common.len(), common.last().map(|(link, _)| link.step));
        if count > 0 {
            say(&format!("{stage}: the same at all {count} common links"))?;
        }
        match uneven_ends([a, b]) {
            None => {}
            Some(ends) if prefix || uneven.is_some() => say(&format!("{stage}: {ends}"))?,
            Some(ends) => uneven = Some(Divergence::uneven(stage, equal, ends)),
        }
    }
    if links == 0 {
        let problem = format!(
            "has no link of any stage in common with {}",
            other.folder.display()
        );
        return Err(Error::input(one.folder.display().to_string(), problem));
    }
    if uneven.is_some() || prefix {
        return Ok(uneven);
    }
    for (side, which) in [(one, "the first run"), (other, "the second run")] {
        // With all its chains, but stopped before its end.
        if !Manifest::of(&side.folder)?.is_some_and(|manifest| manifest.finished) {
            let path = side.folder.join(manifest::NAME);
            let ends = format!("{} does not say that it is finished", path.display());
            return Ok(Some(Divergence::uneven(which.into(), None, ends)));
        }
    }
    Ok(None)
}

/// The links of a chain; none if there is no chain.
fn links_of(chain: &Option<Chain>) -> &[Link] {
    chain.as_ref().map_or(&[], |chain| &chain.links)
}

/// Which of two runs has less of a stage.
fn uneven_ends(links: [&[Link]; 2]) -> Option<String> {
    match links.map(|links| links.last().map(|link| link.step)) {
        [Some(a), Some(b)] if a == b => None,
        [Some(a), Some(b)] => Some(format!(
            "the first run ends at step {a}, the second at step {b}"
        )),
        [Some(_), None] => Some("the second run has none".into()),
        [None, _] => Some("the first run has none".into()),
    }
}

impl Divergence {
    fn uneven(stage: String, equal: Option<u64>, ends: String) -> Self {
        Self {
            stage,
            equal,
            step: equal.unwrap_or(0),
            parts: Vec::new(),
            number: None,
            contact: None,
            ends: Some(ends),
        }
    }
}

/// The chain of digests of a stage, as the run's manifest vouches for it; `None` if there is none. A chain of
/// another run is no record of this one.
///
/// # Errors
/// If it is not as it was written, or cannot be read.
pub(crate) fn chain_of(root: &Path, stage: &str) -> Result<Option<Chain>> {
    let folder = Folder(root);
    let paths = [folder.bed_chain(stage), folder.chain(stage)];
    let manifest = Manifest::of(root)?;
    let listed = |path: &&PathBuf| {
        let name = manifest::relative(root, path)?;
        manifest.as_ref()?.entry(&name).cloned()
    };
    let there = paths
        .iter()
        .filter(|path| disk::is_there(path) || listed(path).is_some());
    let path = match &there.collect::<Vec<_>>()[..] {
        [] => return Ok(None),
        [path] => *path,
        [one, other, ..] => {
            let problem = format!("is beside {}: a stage has one chain", other.display());
            return Err(Error::input(one.display().to_string(), problem));
        }
    };
    let text = match listed(&path) {
        Some(entry) => {
            let place = path.display().to_string();
            let bytes = entry.read(root).map_err(|what| match what {
                Departure::Changed(how) => Error::input(&place, how),
                Departure::Unreadable(e) => e,
            })?;
            text_of(bytes, &place)?
        }
        None if manifest.is_some() => {
            let problem = format!("{} has no entry of it", manifest::NAME);
            return Err(Error::input(path.display().to_string(), problem));
        }
        None => read_text(path)?,
    };
    let place = path.display().to_string();
    let chain = Chain::parse(&text, &place)?;
    let ends = manifest.as_ref().and_then(|own| own.link(stage));
    if ends.is_some_and(|link| link != chain.end()) {
        let problem = format!(
            "does not end with the link that {} has of {stage}",
            manifest::NAME
        );
        return Err(Error::input(place, problem));
    }
    Ok(Some(chain))
}

/// Links of two chains at equal steps.
fn common<'a>(a: &'a [Link], b: &'a [Link]) -> Vec<(&'a Link, &'a Link)> {
    let other = |link: &Link| b.binary_search_by_key(&link.step, |one| one.step);
    let pairs = a
        .iter()
        .filter_map(|link| Some((link, &b[other(link).ok()?])));
    pairs.collect()
}

impl Side {
    /// Names of the stages that have a chain: beds first.
    fn stages(&self) -> Result<Vec<String>> {
        let folder = Folder(&self.folder);
        let names = |path: PathBuf| -> Result<Vec<String>> {
            let names = disk::list(&path)?.into_iter();
            let mut names: Vec<String> = names.map(|(name, _)| name).collect();
            // What lies below lids comes before them, run-2 before run-10.
            names.sort_by_key(|name| (!name.contains("-bare"), name.len(), name.clone()));
            Ok(names)
        };
        let beds = names(self.folder.join("beds"))?.into_iter();
        let beds = beds.filter_map(|name| name.strip_suffix(".chain.csv").map(String::from));
        let runs = names(self.folder.join("runs"))?.into_iter();
        let runs = runs.filter(|run| disk::is_there(&folder.chain(run)));
        let mut stages: Vec<String> = beds.chain(runs).collect();
        // A finished stage has a chain, and if that is missing it is reported.
        let ended = Manifest::of(&self.folder)?.map_or(Vec::new(), |manifest| manifest.stages);
        for stage in ended.into_iter().filter(|stage| stage.finished) {
            if !stages.contains(&stage.name) {
                stages.push(stage.name);
            }
        }
        if stages.is_empty() {
            let problem =
                "holds no chain of digests: it is not a run directory, or its run has just begun";
            return Err(Error::input(self.folder.display().to_string(), problem));
        }
        Ok(stages)
    }

    /// Has the program replay a stretch of a stage, and gives each of its lines to `take`, which says
    /// whether it wants more.
    fn replay(&self, stage: &str, more: &[impl AsRef<OsStr>]) -> Result<Replaying> {
        let mut command = alone(&self.program);
        command.arg("replay").arg(&self.folder);
        command.args(["--stage", stage]).args(more);
        // Into a file: a pipe that nobody empties would block a program that prints much.
        let told = tempfile::tempfile().map_err(|e| Error::write(Path::new(TEMPORARY), e))?;
        let stderr = told.try_clone();
        let stderr = stderr.map_err(|e| Error::write(Path::new(TEMPORARY), e))?;
        command.stdout(Stdio::piped()).stderr(stderr);
        let mut child = command
            .spawn()
            .map_err(|e| Error::read(&self.program, &e))?;
        let out = child.stdout.take().map(BufReader::new);
        Ok(Replaying {
            side: self.clone(),
            child,
            out,
            told,
        })
    }
}

/// A program at work on a stretch.
struct Replaying {
    side: Side,
    child: std::process::Child,
    out: Option<BufReader<std::process::ChildStdout>>,
    told: File,
}

impl Replaying {
    /// The next line; if there is none the program must have ended well.
    fn next<T: for<'a> Deserialize<'a>>(&mut self) -> Result<T> {
        let mut line = String::new();
        if let Some(out) = &mut self.out {
            out.read_line(&mut line).map_err(Error::Output)?;
        }
        if line.is_empty() {
            return Err(self.failed());
        }
        let place = self.side.program.display().to_string();
        let wrong = |e: serde_json::Error| Error::input(place, format!("printed no sample: {e}"));
        serde_json::from_str(&line).map_err(wrong)
    }
}

impl Replaying {
    /// The program did not do what it was asked, in its own words.
    fn failed(&mut self) -> Error {
        let ended = self.child.wait();
        let ended = ended.map_or(String::new(), |status| format!("{status}; "));
        let (told, folder) = (last_words(&mut self.told), self.side.folder.display());
        let problem = format!("did not run {folder} again: {ended}{told}");
        Error::input(self.side.program.display().to_string(), problem)
    }
}

impl Drop for Replaying {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The first step of the stretch up to two differing links at which the states differ.
fn first_step(sides: &[Side; 2], stage: &str, from: u64, links: [&Link; 2]) -> Result<u64> {
    let to = links[0].step;
    let (begin, count) = (from.to_string(), (to - from).to_string());
    let more = [
        "--from",
        &begin,
        "--steps",
        &count,
        "--every",
        "1",
        "--digests",
    ];
    let mut replays = [
        sides[0].replay(stage, &more)?,
        sides[1].replay(stage, &more)?,
    ];
    for step in from..=to {
        let states: [Digests; 2] = [replays[0].next()?, replays[1].next()?];
        if states[0].parts != states[1].parts {
            return Ok(step);
        }
        for (k, link) in links.iter().enumerate() {
            if step == to && states[k].parts != link.parts {
                let side = &sides[k];
                let differ: Vec<&str> = differing(&states[k].parts, &link.parts);
                let problem = format!(
                    "has a link at step {step} of {stage} that {} does not reproduce from the state \
                     before ({} differ): it was made by another build, which can be named with --program-a or \
                     --program-b, or on a machine that does not keep the bit contract",
                    side.program.display(),
                    differ.join(", ")
                );
                return Err(Error::input(side.folder.display().to_string(), problem));
            }
        }
    }
    Err(Error::input(
        stage,
        "differs in its links, but not in any of its states",
    ))
}

/// A sample's contacts; the rest is not read here.
#[derive(Deserialize)]
struct Sample {
    contacts: Vec<ContactState>,
}

/// What differs at a step.
fn parting(sides: &[Side; 2], stage: String, step: u64, equal: Option<u64>) -> Result<Divergence> {
    let room = tempfile::tempdir().map_err(|e| Error::write(Path::new(TEMPORARY), e))?;
    let at = step.to_string();
    let mut digests = Vec::new();
    let mut contacts = Vec::new();
    let mut states = Vec::new();
    for (side, name) in sides.iter().zip(["a", "b"]) {
        let path = room.path().join(name);
        let more = ["--from", &at, "--steps", "0"].map(OsStr::new);
        let digest = ["--digests"].map(OsStr::new);
        let mut digest = side.replay(&stage, &[&more[..], &digest].concat())?;
        digests.push(digest.next::<Digests>()?);
        let whole = ["--contacts".as_ref(), "--save".as_ref(), path.as_os_str()];
        let mut sample = side.replay(&stage, &[&more[..], &whole].concat())?;
        contacts.push(sample.next::<Sample>()?.contacts);
        // Written before the program ends, after the line.
        let ended = sample.child.wait();
        let bytes = match (ended, disk::read(&path)) {
            (Ok(status), Ok(bytes)) if status.success() => bytes,
            _ => return Err(sample.failed()),
        };
        states.push(checkpoint::unpack_foreign(
            &bytes,
            &path.display().to_string(),
        )?);
    }
    let [one, other] = &mut states[..] else {
        unreachable!("two sides have two states");
    };
    Ok(Divergence {
        stage,
        equal: equal.map(|_| step.saturating_sub(1)),
        step,
        parts: differing(&digests[0].parts, &digests[1].parts),
        number: first_difference(one, other),
        contact: first_contact(&contacts[0], &contacts[1]),
        ends: None,
    })
}

impl std::fmt::Display for Divergence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(ends) = &self.ends {
            return write!(f, "{}: {ends}", self.stage);
        }
        match self.equal {
            Some(equal) => write!(
                f,
                "{}: the same to step {equal}, different at step {}",
                self.stage, self.step
            )?,
            None => write!(
                f,
                "{}: different from the beginning, step {}",
                self.stage, self.step
            )?,
        }
        if !self.parts.is_empty() {
            write!(f, "\n  parts: {}", self.parts.join(", "))?;
        }
        match &self.number {
            Some(number) => write!(f, "\n  first number: {number}")?,
            None => write!(f, "\n  no number of the states differs")?,
        }
        match &self.contact {
            Some(contact) => write!(f, "\n  first contact: {contact}"),
            None if self.equal.is_none() => {
                write!(
                    f,
                    "\n  no contact is evaluated in the state a stage begins with"
                )
            }
            None => write!(
                f,
                "\n  first contact: none; the forces of all contacts are the same"
            ),
        }
    }
}
