//! From a campaign's file to its members: a scenario each, whose runs share what they can.

use std::path::Path;

use toml::Value;

use super::base::base_table;
use super::keys::{Axis, Base, Campaign, ParameterGrid};
use super::rules::{Rule, damping, followers};
use crate::parse_errors::wrong_toml;
use crate::scenario::{self, BedFile, CheckedScenario, DragPlan, IntruderMotion, Scenario};
use bitgrain_sim::error::{Error, Result};

/// Most members: a guard against typing errors.
const MEMBERS_MAX: usize = 10_000;
/// Most drags of all members together: the same.
const RUNS_MAX: usize = 100_000;
/// Longest name of a grid or a member, in bytes: it names a folder.
const NAME_MAX: usize = 200;
/// The largest whole number that a seed of a campaign may be: a double holds all below.
const SEED_MAX: u64 = 1 << 53;

/// A campaign ready to be run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Its file, base written out.
    pub campaign: Campaign,
    /// Its runs, by the bed they share.
    pub members: Vec<Member>,
}

/// Runs that share a bed and differ by their speed: one run directory.
#[derive(Clone, Debug)]
pub struct Member {
    /// Name, of its folder too: what is varied, with its values.
    pub name: String,
    /// All of it.
    pub scenario: CheckedScenario,
}

impl Plan {
    /// The file with its base written out, as it lies in the campaign's folder.
    pub fn text(&self) -> String {
        toml::to_string(&self.campaign).expect("a campaign has only string keys and finite numbers")
    }
}

/// One combination of a grid's values.
struct Cell<'a> {
    grid: &'a ParameterGrid,
    name: String,
    /// `key=value` of what the grid sets, speeds left out.
    sets: Vec<String>,
}

/// Parses the text of a campaign and plans it; `place` is what errors call it, `sets` change its base, and
/// `folder` is where files that it names are looked for; one that `sets` name is looked for in the current folder.
///
/// # Errors
/// [`Error::Input`] with line, grid or key, and what was expected.
pub fn parse(text: &str, place: &str, sets: &[String], folder: &Path) -> Result<Plan> {
    let mut campaign = parse_campaign(text, place)?;
    campaign.base = Base::Written(base_table(&campaign.base, place, folder)?);
    let files = Files::From(scenario::bed_folder(sets, folder));
    plan_of(campaign, place, sets, files)
}

/// Where the files of imported beds are looked for.
#[derive(Clone, Copy)]
pub(super) enum Files<'a> {
    /// Where the campaign says, from this folder on.
    From(&'a Path),
    /// In the members of the campaign's own folder alone.
    CopiedIn(&'a Path),
}

/// The keys of a campaign's file, not yet looked at.
pub(super) fn parse_campaign(text: &str, place: &str) -> Result<Campaign> {
    toml::from_str(text).map_err(|e| wrong_toml(place, text, &e))
}

/// Checks a campaign and plans it, as [`parse`].
pub(super) fn plan_of(
    mut campaign: Campaign,
    place: &str,
    sets: &[String],
    files: Files<'_>,
) -> Result<Plan> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if campaign.name.is_empty() || !campaign.name.chars().all(plain) {
        let problem = "expected letters, digits, `-` and `_`: it names a folder";
        return Err(Error::input(format!("{place}: `name`"), problem));
    }
    let (Files::From(folder) | Files::CopiedIn(folder)) = files;
    let mut base = base_table(&campaign.base, place, folder)?;
    for set in sets {
        scenario::apply(&mut base, set)?;
    }
    campaign.base = Base::Written(base.clone());
    if campaign.grid.is_empty() {
        let problem = "is empty; give at least one [[grid]] with the quantities that vary";
        return Err(Error::input(format!("{place}: `grid`"), problem));
    }
    let mut cells: Vec<Cell> = Vec::new();
    for grid in &campaign.grid {
        if !is_folder_name(&grid.name) {
            let problem = format!(
                "expected a word or two of at most {NAME_MAX} bytes without / and \\: it may name a folder"
            );
            return Err(Error::input(format!("{place}: `grid.name`"), problem));
        }
        let place = format!("{place}: grid `{}`", grid.name);
        check(grid, &place)?;
        cells.extend(cells_of(grid, &place)?);
        if cells.len() > MEMBERS_MAX {
            let problem = format!("makes more than {MEMBERS_MAX} beds: give fewer values");
            return Err(Error::input(place, problem));
        }
    }
    let maker = Maker {
        base: &toml::to_string(&base).map_err(|e| Error::input(place, e.to_string()))?,
        campaign: &campaign,
        place,
        files,
    };
    let mut members: Vec<Member> = Vec::new();
    let mut runs = 0;
    for cell in &cells {
        let scenario = maker.scenario(cell)?;
        runs += scenario.drags().len();
        if runs > RUNS_MAX {
            let problem = format!("makes more than {RUNS_MAX} drags: give fewer values");
            return Err(Error::input(place, problem));
        }
        match members.iter_mut().find(|m| m.name == cell.name) {
            Some(member) => maker.merge(member, scenario)?,
            None => members.push(Member {
                name: cell.name.clone(),
                scenario,
            }),
        }
    }
    Ok(Plan { campaign, members })
}

/// Whether a name is that of a folder right here, on any system.
fn is_folder_name(name: &str) -> bool {
    let plain = |c: char| !c.is_control() && !"/\\:*?\"<>|".contains(c);
    !name.is_empty()
        && name.len() <= NAME_MAX
        && !name.starts_with(['.', ' ', '-'])
        && !name.ends_with(['.', ' '])
        && name.chars().all(plain)
}

/// Refuses what is given twice, or not at all.
fn check(grid: &ParameterGrid, place: &str) -> Result<()> {
    let refuse = |problem: String| Err(Error::input(place, problem));
    let axes = grid.axes();
    let mut given: Vec<(&str, &str)> = axes.iter().map(|a| (a.name, a.key)).collect();
    given.extend(grid.froude.is_some().then_some(("froude", "speed")));
    given.extend(grid.speed.is_some().then_some(("speed", "speed")));
    // Two keys for one quantity.
    for pair in [
        ["depth", "height"],
        ["froude", "speed"],
        ["gamma_n", "gamma_n/kn^0.6"],
    ] {
        if pair.iter().all(|name| given.iter().any(|g| g.0 == *name)) {
            return refuse(format!(
                "varies one quantity twice, as `{}` and as `{}`; give one of them",
                pair[0], pair[1]
            ));
        }
    }
    for (name, key) in &given {
        let spellings: &[&str] = match *name {
            "froude" | "speed" => &["intruder.froude", "intruder.speed"],
            "depth" | "height" => &["intruder.depth", "intruder.height"],
            _ => &[key],
        };
        if let Some(set) = spellings.iter().find(|key| grid.set.contains_key(**key)) {
            return refuse(format!(
                "varies `{name}` and sets `{set}`, the same quantity; give one of them"
            ));
        }
    }
    let rules = grid.keep.as_deref().unwrap_or_default();
    let damped = given.iter().any(|g| g.1 == "law.gamma_n");
    if damped && rules.contains(&Rule::Restitution) {
        return refuse("varies gamma_n and keeps `gamma_n/kn^0.6`; give one of them".into());
    }
    let speeds = [
        ("froude", &grid.froude),
        ("speed", &grid.speed),
        ("distance", &grid.distance),
    ];
    let speeds = speeds
        .iter()
        .filter_map(|(name, values)| Some((*name, values.as_ref()?.values())));
    for (name, values) in axes
        .iter()
        .map(|a| (a.name, a.values.clone()))
        .chain(speeds)
    {
        if values.is_empty() {
            return refuse(format!(
                "`{name}` has no values; give at least one, or leave it out"
            ));
        }
        if values.len() > MEMBERS_MAX {
            return refuse(format!(
                "`{name}` has {} values; expected at most {MEMBERS_MAX}",
                values.len()
            ));
        }
        let twice = (1..values.len()).find(|&k| values[..k].contains(&values[k]));
        if let Some(k) = twice.filter(|_| name != "distance") {
            return refuse(format!("`{name}` has the value {} twice", values[k]));
        }
        if let Some(bad) = values.iter().find(|x| !x.is_finite()) {
            return refuse(format!("`{name}` is {bad}; expected a number"));
        }
    }
    let large = grid.seed.iter().flatten().find(|seed| **seed > SEED_MAX);
    large.map_or(Ok(()), |seed| {
        refuse(format!("`seed` is {seed}; expected at most {SEED_MAX}"))
    })
}

/// A value as names have it.
fn word(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e4).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// Every combination of a grid's values, the last axis fastest.
fn cells_of<'a>(grid: &'a ParameterGrid, place: &str) -> Result<Vec<Cell<'a>>> {
    let mut fixed = Vec::new();
    for (key, value) in &grid.set {
        if matches!(value, Value::Table(_)) {
            let problem = format!("`set`: write keys with dots and in quotes, as \"{key}.key\"");
            return Err(Error::input(place, problem));
        }
        fixed.push(format!("{key}={value}"));
    }
    let mut cells = vec![(Vec::<String>::new(), fixed)];
    for axis in grid.axes() {
        if cells.len() * axis.values.len() > MEMBERS_MAX {
            let problem = format!("makes more than {MEMBERS_MAX} beds: give fewer values");
            return Err(Error::input(place, problem));
        }
        let mut more = Vec::with_capacity(cells.len() * axis.values.len());
        for (name, sets) in &cells {
            for &value in &axis.values {
                let (mut name, mut sets) = (name.clone(), sets.clone());
                name.push(format!("{}{}", axis.short, word(value)));
                sets.push(set_of(&axis, value));
                more.push((name, sets));
            }
        }
        cells = more;
    }
    let cell = |(name, sets): (Vec<String>, Vec<String>)| Cell {
        grid,
        name: if name.is_empty() {
            grid.name.clone()
        } else {
            name.join("-")
        },
        sets,
    };
    Ok(cells.into_iter().map(cell).collect())
}

fn set_of(axis: &Axis, value: f64) -> String {
    match axis.name {
        "seed" => format!("seed={}", value as u64),
        // If the stiffness is varied too, another follows it later.
        "gamma_n/kn^0.6" => format!("{DAMPING}={value:?}"),
        _ => format!("{}={value:?}", axis.key),
    }
}

/// Stands for a damping that is given over a power of the stiffness.
const DAMPING: &str = "gamma_n/kn^0.6";

/// What every member is made from.
struct Maker<'a> {
    base: &'a str,
    campaign: &'a Campaign,
    place: &'a str,
    files: Files<'a>,
}

impl Maker<'_> {
    fn parse(&self, name: &str, sets: &[String]) -> Result<CheckedScenario> {
        let place = format!("{}: member `{name}`", self.place);
        let run;
        let from = match self.files {
            Files::From(folder) => BedFile::From(folder),
            Files::CopiedIn(folder) => {
                run = folder.join("members").join(name);
                BedFile::CopiedIn(&run)
            }
        };
        let member = scenario::parse_from(self.base, &place, sets, from)?;
        if member.intruder.motion != IntruderMotion::Dragged {
            let problem = "expected \"dragged\": a campaign's table is of drags at constant speed";
            let place = format!("{place}: `intruder.motion`");
            return Err(Error::input(place, problem));
        }
        Ok(member)
    }

    /// The scenario of one combination.
    fn scenario(&self, cell: &Cell) -> Result<CheckedScenario> {
        let grid = cell.grid;
        let listed = |key: &str, values: &Option<scenario::OneOrMany>| {
            values.as_ref().map(|v| format!("{key}={:?}", v.values()))
        };
        let mut sets = vec![format!("name={}", scenario_name(&cell.name))];
        sets.extend(listed("intruder.froude", &grid.froude));
        sets.extend(listed("intruder.speed", &grid.speed));
        sets.extend(listed("drag.distance", &grid.distance));
        let stiff = |set: &&String| {
            ["law.kn=", "law.gamma_n=", DAMPING]
                .iter()
                .any(|key| set.starts_with(key))
        };
        sets.extend(cell.sets.iter().filter(|set| !stiff(set)).cloned());
        if !cell.sets.iter().any(|set| stiff(&set)) {
            return self.parse(&cell.name, &sets);
        }
        let base = self.parse(&cell.name, &sets)?;
        let value = |key: &str| {
            let mut found = cell
                .sets
                .iter()
                .filter_map(|set| set.strip_prefix(key)?.strip_prefix('='));
            found.next().and_then(|text| text.parse::<f64>().ok())
        };
        let own = base.law.value("kn").unwrap_or(f64::NAN);
        let kn = value("law.kn").unwrap_or(own);
        let asked = value("law.gamma_n").or(value(DAMPING).map(|ratio| damping(ratio, kn)));
        let rules = grid.keep.as_ref().unwrap_or(&self.campaign.keep);
        sets.push(format!("law.kn={kn:?}"));
        sets.extend(asked.map(|gamma| format!("law.gamma_n={gamma:?}")));
        let follow = followers(&base, rules, kn, asked);
        sets.extend(follow.iter().map(|(key, value)| format!("{key}={value:?}")));
        self.parse(&cell.name, &sets)
    }

    /// Adds the speeds of another grid's member to the one of the same name.
    fn merge(&self, member: &mut Member, other: CheckedScenario) -> Result<()> {
        let refuse = |problem: String| {
            Err(Error::input(
                format!("{}: member `{}`", self.place, member.name),
                problem,
            ))
        };
        let bare = |s: &CheckedScenario| {
            let mut s = s.edit();
            (s.intruder.froude, s.intruder.speed) = (None, None);
            s.drag.distance = scenario::OneOrMany::One(0.0);
            s
        };
        if let Some(line) = difference(&bare(&member.scenario), &bare(&other)) {
            return refuse(format!("two grids make it, but they differ: {line}"));
        }
        // If one gives speeds and another Froude numbers, these become speeds, of the one diameter.
        let froude = [&member.scenario, &other].map(|s| s.intruder.froude.is_some());
        if froude[0] != froude[1] && other.intruder.diameter.values().len() > 1 {
            return refuse(
                "one grid gives speeds and another Froude numbers of several diameters; give one kind"
                    .into(),
            );
        }
        let by_froude = froude == [true; 2];
        let speeds = |s: &CheckedScenario| -> Vec<(f64, f64)> {
            // The runs of every bed are alike: those of the first bed suffice.
            let runs = s.drags().iter().filter(|run| run.bed == 0);
            let speed = |run: &DragPlan| {
                if by_froude {
                    run.froude
                } else {
                    run.motion.speed
                }
            };
            runs.map(|run| (speed(run), run.distance)).collect()
        };
        let mut all = speeds(&member.scenario);
        for (speed, distance) in speeds(&other) {
            match all.iter().find(|known| known.0 == speed) {
                Some(known) if known.1 != distance => {
                    return refuse(format!(
                        "two grids drag it at speed {speed}, over {} and over {distance}; give one distance",
                        known.1
                    ));
                }
                Some(_) => {}
                None => all.push((speed, distance)),
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (speeds, distances): (Vec<f64>, Vec<f64>) = all.into_iter().unzip();
        let speeds = Some(scenario::OneOrMany::Many(speeds));
        let mut both = member.scenario.edit();
        let intruder = &mut both.intruder;
        (intruder.froude, intruder.speed) = match by_froude {
            true => (speeds, None),
            false => (None, speeds),
        };
        both.drag.distance = scenario::OneOrMany::Many(distances);
        // Together they may be too many.
        let place = format!("{}: member `{}`", self.place, member.name);
        member.scenario = both
            .check()
            .map_err(|wrong| scenario::refused(&place, wrong))?;
        Ok(())
    }
}

/// A name that a scenario may have.
fn scenario_name(member: &str) -> String {
    member.replace(['.', '+', ' ', '/'], "_")
}

/// The first line in which two scenarios differ.
fn difference(a: &Scenario, b: &Scenario) -> Option<String> {
    let (a, b) = (a.to_toml(), b.to_toml());
    let mut lines = a.lines().zip(b.lines());
    let (x, y) = lines.find(|(x, y)| x != y)?;
    Some(format!("`{x}` and `{y}`"))
}
