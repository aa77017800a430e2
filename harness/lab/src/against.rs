//! A run compared with what was kept of another: its folder, a table of links, or a link.

use std::path::{Path, PathBuf};

use bitgrain_kernel::BITS_VERSION;
use serde::{Deserialize, Serialize};

use crate::bisect::{Divergence, Side, bisect, chain_of};
use crate::confirm;
use crate::folder::Folder;
use crate::manifest::{Manifest, NAME};
use crate::progress::Progress;
use crate::replay::{Replay, Stretch, replay_run};
use crate::rerun::{RunArchive, RunPart};
use bitgrain_sim::below::Below;
use bitgrain_sim::chain::{Chain, Link, differing};
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk::{self, Kind, is_file, is_folder};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;

/// Names of the files that a failed comparison leaves in the run's folder: what differs, and the state to replay.
pub const DIFFERENCE: &str = "difference.json";
const STATE: &str = "difference.safetensors";

/// What a run is compared with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reference {
    /// Another run.
    Run(PathBuf),
    /// A table of links: the `chain.csv` of a stage.
    Chain(PathBuf),
    /// A closing hash or the last link of a stage.
    Link(String),
}

impl Reference {
    /// What a word of the command line stands for.
    ///
    /// # Errors
    /// [`Error::Input`] if it is not a folder, file or link.
    pub fn of(word: &str) -> Result<Self> {
        let path = Path::new(word);
        if is_link(word) {
            return Ok(Self::Link(word.into()));
        }
        if is_folder(path) {
            return Ok(Self::Run(path.into()));
        }
        if is_file(path) {
            return Ok(Self::Chain(path.into()));
        }
        let problem =
            "is neither the folder of a run, nor a chain.csv, nor a link of 64 hexadecimal digits";
        Err(Error::input(word, problem))
    }
}

/// What `difference.json` holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Difference {
    version: String,
    bits_version: u32,
    against: String,
    stage: String,
    /// The last step at which the states are known to be equal.
    equal: Option<u64>,
    /// The first at which they are known to differ: the very first one if `number` is known.
    differ: u64,
    parts: Vec<String>,
    number: Option<Number>,
    contact: Option<String>,
    /// Name of the checkpoint beside this file, of the last state that is known to be equal.
    state: Option<String>,
    /// Command that prints the state and the contacts at the step at which they differ; for a state, in its folder.
    replay: String,
    /// Why nothing more is known, if that is so.
    note: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Number {
    part: String,
    body: String,
    component: String,
    expected: String,
    found: String,
}

/// Whether a word is a link or a closing hash: 64 hexadecimal digits.
pub fn is_link(word: &str) -> bool {
    word.len() == 64 && word.chars().all(|c| matches!(c, '0'..='9' | 'a'..='f'))
}

/// Refuses a comparison of a run in `out` with itself, and one that would replace or remove a file there which no
/// comparison left. Nothing is written.
///
/// # Errors
/// [`Error::Input`].
pub fn check_before(out: &Path, reference: &Reference) -> Result<()> {
    let full = |path: &Path| path.canonicalize().ok();
    if let Reference::Run(path) | Reference::Chain(path) = reference
        && let (Some(own), Some(other)) = (full(out), full(path))
        && other.starts_with(own)
    {
        let problem = "is the run that it would be compared with: give the folder or the chain.csv of another run; \
                       `bitgrain verify` executes this one again";
        return Err(Error::input(path.display().to_string(), problem));
    }
    let left = || {
        let text = disk::read(&out.join(DIFFERENCE)).ok()?;
        serde_json::from_slice::<Difference>(&text).ok()
    };
    // A state is ours where an earlier comparison names it.
    let is_ours = |name: &str, bytes: &[u8]| match name {
        DIFFERENCE => left().is_some(),
        _ => left().is_some_and(|left| left.state.is_some()) && checkpoint::begins(bytes),
    };
    for name in [DIFFERENCE, STATE] {
        let path = out.join(name);
        let ours = match disk::kind(&path) {
            None => true,
            Some(Kind::File) => is_ours(name, &disk::read(&path)?),
            Some(_) => false,
        };
        if !ours {
            let problem = "has the name of a file that --against writes, and no comparison left it: move it away, or \
                           choose another --out";
            return Err(Error::input(path.display().to_string(), problem));
        }
    }
    Ok(())
}

/// Compares the run in `out` with a reference; `program` executes steps again. If they differ, says where and
/// writes `difference.json`.
///
/// # Errors
/// [`Error::Parted`] if any link differs, after that was reported; [`Error::Unverified`] if a link is not the run's.
pub fn check(
    out: &Path,
    reference: &Reference,
    program: &Path,
    progress: &Progress,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let place = out.display();
    check_before(out, reference)?;
    // From an earlier comparison.
    Below(out).remove(&out.join(STATE))?;
    Below(out).remove(&out.join(DIFFERENCE))?;
    match reference {
        Reference::Link(link) => {
            confirm::check_expected(out, std::slice::from_ref(link))?;
            say(&format!("{place}: has the link {link}"))
        }
        Reference::Chain(path) => {
            let wanted = Chain::parse(&read_text(path)?, &path.display().to_string())?.links;
            let (stage, made) = nearest(out, &wanted)?;
            match first(&wanted, &made) {
                None => say(&format!(
                    "{stage}: all {} links are those of {}",
                    made.len(),
                    path.display()
                )),
                Some(found) => {
                    let note = match found.0 {
                        None => {
                            "no stage of the run begins like this chain: its bed or its scenario differs. If that \
                             is intended, pin the new one; if not, give the folder of the other run to learn the first \
                             number"
                        }
                        Some(_) => {
                            "only links are known of the other run: give its folder to learn more"
                        }
                    };
                    let difference = by_links(out, path, stage, found, Some(note.into()));
                    report(out, difference, progress, &mut say)
                }
            }
        }
        Reference::Run(other) => {
            let mut stages = stages(other)?;
            for stage in self::stages(out)? {
                if !stages.contains(&stage) {
                    stages.push(stage);
                }
            }
            let mut count = 0;
            for stage in &stages {
                let (wanted, made) = (links(other, stage)?, links(out, stage)?);
                if let Some(found) = first(&wanted, &made) {
                    let difference = by_steps(out, other, stage, found, program, &mut say)?;
                    return report(out, difference, progress, &mut say);
                }
                count += made.len();
            }
            say(&format!(
                "all {count} links of {} stages are those of {}",
                stages.len(),
                other.display()
            ))
        }
    }
}

/// Stages of a run by its manifest.
fn stages(folder: &Path) -> Result<Vec<String>> {
    let manifest = Manifest::of(folder)?.ok_or_else(|| {
        let problem = format!("has no {NAME}: give the folder of a run");
        Error::input(folder.display().to_string(), problem)
    })?;
    Ok(manifest
        .stages
        .into_iter()
        .map(|stage| stage.name)
        .collect())
}

/// The links of a stage; none if it has no chain.
fn links(folder: &Path, stage: &str) -> Result<Vec<Link>> {
    Ok(chain_of(folder, stage)?.map_or(Vec::new(), |chain| chain.links))
}

/// The stage of a run that has most of these links, else one that is as long, and its own links.
fn nearest(out: &Path, wanted: &[Link]) -> Result<(String, Vec<Link>)> {
    let end = |links: &[Link]| links.last().map(|link| link.step);
    let mut best: Option<((usize, bool), String, Vec<Link>)> = None;
    for stage in stages(out)? {
        let made = links(out, &stage)?;
        let same = made.iter().zip(wanted).take_while(|(a, b)| a == b).count();
        let fit = (same, end(&made) == end(wanted));
        if best.as_ref().is_none_or(|(most, ..)| fit > *most) {
            best = Some((fit, stage, made));
        }
    }
    let (_, stage, made) = best.ok_or_else(|| {
        let problem = "has no stage that could be compared";
        Error::input(out.display().to_string(), problem)
    })?;
    Ok((stage, made))
}

/// Where two chains part: the last step with equal links, the next one's step, and the parts that differ there.
type Found = (Option<u64>, u64, Vec<String>);

fn first(a: &[Link], b: &[Link]) -> Option<Found> {
    let same = a.iter().zip(b).take_while(|(a, b)| a == b).count();
    if same == a.len() && same == b.len() {
        return None;
    }
    let equal = same.checked_sub(1).map(|last| a[last].step);
    let step = |link: Option<&Link>| link.map(|link| link.step);
    let at = step(b.get(same)).or(step(a.get(same))).unwrap_or(0);
    let parts = match (a.get(same), b.get(same)) {
        (Some(a), Some(b)) if a.step == b.step => differing(&a.parts, &b.parts),
        _ => Vec::new(),
    };
    Some((equal, at, parts.into_iter().map(String::from).collect()))
}

/// What the links say.
fn by_links(
    out: &Path,
    against: &Path,
    stage: String,
    (equal, differ, parts): Found,
    note: Option<String>,
) -> Difference {
    Difference {
        version: env!("CARGO_PKG_VERSION").into(),
        bits_version: BITS_VERSION,
        against: against.display().to_string(),
        replay: replay(out, &stage, differ),
        state: None,
        stage,
        equal,
        differ,
        parts,
        number: None,
        contact: None,
        note,
    }
}

fn replay(out: &Path, stage: &str, step: u64) -> String {
    let out = out.display();
    format!("bitgrain replay {out} --stage {stage} --from {step} --steps 0 --contacts")
}

/// What the steps say, executed again.
fn by_steps(
    out: &Path,
    other: &Path,
    stage: &str,
    found: Found,
    program: &Path,
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<Difference> {
    let side = |folder: &Path| Side {
        folder: folder.into(),
        program: program.into(),
    };
    match bisect(&[side(other), side(out)], true, say) {
        Ok(Some(parting)) => Ok(by_parting(out, other, parting)),
        Ok(None) => Ok(by_links(out, other, stage.into(), found, None)),
        Err(e @ (Error::Interrupted { .. } | Error::Output(_))) => Err(e),
        // For example if another build made the other run.
        Err(e) => Ok(by_links(
            out,
            other,
            stage.into(),
            found,
            Some(e.to_string()),
        )),
    }
}

fn by_parting(out: &Path, other: &Path, parting: Divergence) -> Difference {
    let number = parting.number.map(|number| Number {
        part: number.part.into(),
        body: number.body,
        component: number.component.into(),
        expected: bits(number.first),
        found: bits(number.second),
    });
    Difference {
        version: env!("CARGO_PKG_VERSION").into(),
        bits_version: BITS_VERSION,
        against: other.display().to_string(),
        replay: replay(out, &parting.stage, parting.step),
        state: None,
        stage: parting.stage,
        equal: parting.equal,
        differ: parting.step,
        parts: parting.parts.into_iter().map(String::from).collect(),
        number,
        contact: parting.contact,
        note: None,
    }
}

/// A number and its bits.
fn bits(x: f64) -> String {
    format!("{x} (0x{:016x})", x.to_bits())
}

/// Writes the last state of a drag that is known to be equal, from which plain steps lead to the difference. Says
/// whether there is one.
///
/// # Errors
/// Why it cannot be made again.
fn save_state(out: &Path, difference: &Difference, progress: &Progress) -> Result<bool> {
    let folder = Folder(out);
    let past = RunArchive::open(&folder)?;
    let (RunPart::Drag(_), Some(equal)) = (past.part(&difference.stage)?, difference.equal) else {
        return Ok(false);
    };
    let stretch = Stretch {
        stage: difference.stage.clone(),
        from: equal,
        save: Some(out.join(STATE)),
    };
    let what = Replay {
        steps: 0,
        every: 1,
        contacts: false,
        energy: false,
        digests: true,
        vtk: None,
        beyond_rayleigh: false,
    };
    let nothing = &mut std::io::sink();
    replay_run(&folder, &stretch, &what, progress, nothing)?;
    Ok(true)
}

/// Writes `difference.json`.
fn write(out: &Path, difference: &Difference) -> Result<PathBuf> {
    let path = out.join(DIFFERENCE);
    let mut text = serde_json::to_string_pretty(difference).expect("words and numbers are JSON");
    text.push('\n');
    Below(out).write(&path, text.as_bytes())?;
    Ok(path)
}

/// Writes `difference.json`, says what is in it, and keeps the state to replay.
fn report(
    out: &Path,
    mut difference: Difference,
    progress: &Progress,
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    // The state is named before it is there: one that nothing names is not ours.
    difference.state = Some(STATE.into());
    let path = write(out, &difference)?;
    let Difference { stage, differ, .. } = &difference;
    let equal = difference
        .equal
        .map(|step| format!("the same to step {step}, "));
    say(&format!(
        "{stage}: {}different at step {differ} ({})",
        equal.unwrap_or_default(),
        difference.parts.join(", ")
    ))?;
    if let Some(number) = &difference.number {
        let Number {
            part,
            body,
            component,
            expected,
            found,
        } = number;
        say(&format!(
            "{part} of {body}, {component}: expected {expected}, found {found}"
        ))?;
    }
    if let Some(note) = &difference.note {
        say(note)?;
    }
    say(&format!("written to {}", path.display()))?;
    let mut replay = difference.replay.clone();
    let saved = save_state(out, &difference, progress);
    if !matches!(saved, Ok(true)) {
        difference.state = None;
        write(out, &difference)?;
    }
    match saved {
        Err(e @ Error::Interrupted { .. }) => return Err(e),
        Err(e) => say(&format!("no state to replay was kept: {e}"))?,
        Ok(false) => {}
        Ok(true) => {
            let steps = difference.differ - difference.equal.unwrap_or_default();
            let command = |file: &Path| {
                format!(
                    "bitgrain replay {} --steps {steps} --contacts",
                    file.display()
                )
            };
            difference.replay = command(Path::new(STATE));
            write(out, &difference)?;
            let state = out.join(STATE);
            say(&format!("the last equal state is {}", state.display()))?;
            replay = command(&state);
        }
    }
    say(&format!("replay the difference with\n  {replay}"))?;
    Err(Error::Parted)
}
