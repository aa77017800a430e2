//! What `bitgrain bed` prints: the beds of a library, one of them in full, and what was removed.

use bitgrain_sim::disk::is_folder;
use std::fmt::Write;

use super::channels::{print, shown};
use bitgrain_lab::bed::library::{BedCache, CachedBed};
use bitgrain_lab::bed::{self, recipe::Recipe};
use bitgrain_lab::scenario::UnitSystem;
use bitgrain_sim::checkpoint;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::format::bytes;
use bitgrain_sim::format::short;
use clap::{Args, Subcommand};
use etcetera::{BaseStrategy, choose_base_strategy};
use std::path::{Path, PathBuf};

/// The beds as a table with the disk they use.
///
/// # Errors
/// [`Error::Input`] if the library cannot be read.
fn list(library: &BedCache) -> Result<String> {
    let beds = library.list()?;
    if beds.is_empty() {
        return Ok(format!("no beds in {}\n", library.folder().display()));
    }
    let mut out = String::from(
        "name              grains  box                 D     height  mu    K_n or E  seed  disk\n",
    );
    for bed in &beds {
        let row = match &bed.recipe {
            Some(recipe) => row(bed, recipe),
            None => format!("{}  its recipe cannot be read; {}", bed.name, disk(bed)),
        };
        let _ = writeln!(out, "{row}");
    }
    let all: u64 = beds.iter().map(|bed| bed.bytes).sum();
    let folder = library.folder().display();
    let _ = writeln!(
        out,
        "{} bed(s) in {folder}, {}",
        beds.len(),
        bytes(all as f64)
    );
    Ok(out)
}

fn disk(bed: &CachedBed) -> String {
    bytes(bed.bytes as f64)
}

fn row(bed: &CachedBed, recipe: &Recipe) -> String {
    let [x, y, z] = recipe.size.map(short);
    let stiffness = recipe.law.parameters().stated_stiffness();
    format!(
        "{}  {:<6}  {:<18}  {:<4}  {:<6}  {:<4}  {:<8}  {:<4}  {}",
        bed.name,
        recipe.grains,
        format!("{x} x {y} x {z}"),
        short(recipe.intruder.diameter),
        short(recipe.intruder.center[2]),
        recipe.law.mu(),
        format!("{stiffness:e}"),
        recipe.seed,
        disk(bed),
    ) + &pouring(recipe)
        + &lid(recipe)
}

/// The friction of the pouring, behind its row, if it is not that of the law.
fn pouring(recipe: &Recipe) -> String {
    let mu = recipe.pouring_mu;
    mu.map_or(String::new(), |mu| format!("  poured with mu {mu}"))
}

/// The lid of a bed, at the end of its row.
fn lid(recipe: &Recipe) -> String {
    let Some(lid) = &recipe.lid else {
        return String::new();
    };
    let size = match (lid.effective_depth, lid.density) {
        (Some(depth), _) => format!("effective depth {}", short(depth)),
        (None, density) => format!("density {}", short(density.unwrap_or(0.0))),
    };
    let weightless = if lid.pressure_gradient {
        ""
    } else {
        ", bed without weight"
    };
    format!("  lid: {size}{weightless}")
}

/// One bed: its recipe, what is measured on it, its files.
///
/// # Errors
/// [`Error::Input`] if there is no such bed, or it is damaged.
fn show(library: &BedCache, name: &str) -> Result<String> {
    let bed = library.entry(name)?;
    let path = bed.checkpoint.display().to_string();
    let Some(recipe) = &bed.recipe else {
        let problem = format!(
            "has no sound recipe.toml; `bitgrain bed remove {}` removes it",
            bed.name
        );
        return Err(Error::input(
            library.folder().join(&bed.name).display().to_string(),
            problem,
        ));
    };
    let data = bitgrain_sim::disk::read(&bed.checkpoint)?;
    let mut sim = checkpoint::parse(&data, &path, Some(&recipe.digest()))?;
    let found = bed::survey(&bed.name, &recipe.measures(), &mut sim)?;
    let length = match recipe.units {
        UnitSystem::Reduced => "d",
        UnitSystem::Si => "m",
    };
    let mut out = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(out, "{name:<26}{value}");
    };
    line("bed", bed.name.clone());
    line(
        "grains",
        format!("{}, {} of them frozen", found.grains, found.frozen),
    );
    line(
        "surface height",
        format!("{} {length}", short(found.surface)),
    );
    line(
        "depth of the intruder",
        format!("{} {length}", short(found.depth)),
    );
    line("packing fraction", format!("{:.4}", found.packing_fraction));
    line(
        "coordination number",
        format!("{:.3}", found.coordination_number),
    );
    line("deepest overlap / d", format!("{:.2e}", found.overlap_max));
    line(
        "kinetic energy/(weight d)",
        format!("{:.1e}", found.kinetic_energy_over_weight_d),
    );
    line(
        "weight carried",
        format!("{:.5}", found.support / found.weight),
    );
    line("settled in steps", found.steps.to_string());
    line("digest of the state", found.digest);
    line("digest of the recipe", recipe.digest());
    line("disk", disk(&bed));
    line("checkpoint", path);
    out.push_str("\n# recipe\n");
    out.push_str(&recipe.text());
    Ok(out)
}

/// Removes the named beds, or all of them.
///
/// # Errors
/// [`Error::Input`] for a name of no bed or of several, before any is removed;
/// [`Error::Write`].
fn remove(library: &BedCache, names: &[String], all: bool) -> Result<String> {
    let mut beds = if all {
        library.list()?
    } else {
        let named = names.iter().map(|name| library.entry(name));
        named.collect::<Result<Vec<CachedBed>>>()?
    };
    beds.sort_by(|a, b| a.name.cmp(&b.name));
    beds.dedup_by(|a, b| a.name == b.name);
    let mut out = String::new();
    let (mut count, mut all) = (0, 0);
    for bed in &beds {
        let (freed, gone) = library.remove(bed)?;
        let done = freed.map_or("nothing of".into(), |freed| {
            count += 1;
            all += freed;
            format!("{} of", bytes(freed as f64))
        });
        let stays = if gone {
            ""
        } else {
            "; its folder holds other files and stays"
        };
        let _ = writeln!(out, "removed {done} {}{stays}", bed.name);
    }
    let folder = library.folder().display();
    let all = bytes(all as f64);
    let _ = writeln!(out, "{count} bed(s) removed from {folder}, {all}");
    Ok(out)
}

/// Where settled beds are kept.
#[derive(Args)]
pub(super) struct Beds {
    /// Folder of the settled beds that runs share [default: bitgrain/beds in the folder where your system keeps
    /// caches, such as ~/.cache].
    #[arg(long = "beds", value_name = "DIR")]
    pub(super) folder: Option<PathBuf>,
}

impl Beds {
    /// The library of beds, which is at `home` if none is named.
    pub(super) fn library(self, home: &Path) -> BedCache {
        BedCache::new(self.folder.unwrap_or_else(|| home.to_path_buf()))
    }

    /// A note if there are beds in the place of earlier versions, which would not be found.
    pub(super) fn hint(&self, home: &Path) -> Option<String> {
        let here = Path::new("beds");
        let unseen = self.folder.is_none() && home != here;
        let beds = || BedCache::new(here.to_path_buf()).list();
        (unseen && is_folder(here) && beds().is_ok_and(|beds| !beds.is_empty())).then(|| {
            format!(
                "settled beds are kept in {}; those in the folder beds here are not used: --beds beds uses them",
                shown(home)
            )
        })
    }
}

/// Where settled beds are kept unless `--beds` says otherwise: in the user's cache, or, if the system names no
/// such folder, in `beds` here.
pub fn own_beds() -> PathBuf {
    match choose_base_strategy() {
        Ok(places) => places.cache_dir().join("bitgrain").join("beds"),
        Err(_) => "beds".into(),
    }
}

#[derive(Subcommand)]
pub(super) enum Bed {
    /// List the beds: name, what is in them, and the disk they use.
    #[command(after_help = "Example:\n  bitgrain bed list")]
    List {
        #[command(flatten)]
        beds: Beds,
    },
    /// Show a bed: its recipe, and what is measured on it.
    #[command(after_help = "Example:\n  bitgrain bed show db7e")]
    Show {
        /// Its name, or as much of the beginning as no other shares.
        name: String,
        #[command(flatten)]
        beds: Beds,
    },
    /// Remove beds.
    #[command(after_help = "Examples:\n  bitgrain bed remove db7e\n  bitgrain bed remove --all")]
    Remove {
        /// Names, or as much of the beginning of each as no other shares.
        #[arg(required_unless_present = "all")]
        names: Vec<String>,
        /// Remove every bed of the folder.
        #[arg(long, conflicts_with = "names")]
        all: bool,
        #[command(flatten)]
        beds: Beds,
    },
}

pub(super) fn run_bed(bed: Bed, home: &Path) -> Result<()> {
    match bed {
        Bed::List { beds } => print(&list(&beds.library(home))?),
        Bed::Show { name, beds } => print(&show(&beds.library(home), &name)?),
        Bed::Remove { names, all, beds } => print(&remove(&beds.library(home), &names, all)?),
    }
}
