//! Ways to damage the files of a room, and which files there are.

use crate::wee::Room;

/// A way to damage a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damage {
    /// A bit in its middle is flipped.
    BitFlip,
    /// Its second half is gone.
    Truncate,
    /// It is empty.
    Empty,
    /// Something follows its end.
    Append,
    /// It is another file of the same folder.
    Swap,
    /// It is the same file of another run.
    Foreign,
    /// It is gone.
    Missing,
    /// A folder has its name.
    Folder,
    /// A pipe has its name.
    Pipe,
    /// A link to a foreign file has its name.
    Link,
}

/// All of them.
pub const DAMAGES: [Damage; 10] = [
    Damage::BitFlip,
    Damage::Truncate,
    Damage::Empty,
    Damage::Append,
    Damage::Swap,
    Damage::Foreign,
    Damage::Missing,
    Damage::Folder,
    Damage::Pipe,
    Damage::Link,
];

/// A kind of file: its name in the room, another of its kind, and the same file of another run.
pub struct Kind {
    /// Its name in the room.
    pub name: &'static str,
    /// Another file of its kind.
    pub twin: &'static str,
    /// The same file of another run.
    pub foreign: &'static str,
}

/// A kind of file, by the three names.
pub const fn kind(name: &'static str, twin: &'static str, foreign: &'static str) -> Kind {
    Kind {
        name,
        twin,
        foreign,
    }
}

/// Those of a run.
pub const RUN: [Kind; 18] = [
    kind(
        "run/scenario.toml",
        "run/manifest.json",
        "other/scenario.toml",
    ),
    kind(
        "run/manifest.json",
        "run/summary.json",
        "other/manifest.json",
    ),
    kind(
        "run/summary.json",
        "run/runs/run-1/summary.json",
        "other/summary.json",
    ),
    kind("run/report.html", "run/summary.json", "other/report.html"),
    kind(
        "run/performance.json",
        "run/summary.json",
        "other/performance.json",
    ),
    kind(
        "run/beds/bed.safetensors",
        "run/runs/run-1/checkpoints/000000004167.safetensors",
        "other/beds/bed.safetensors",
    ),
    kind(
        "run/beds/bed.chain.csv",
        "run/runs/run-1/chain.csv",
        "other/beds/bed.chain.csv",
    ),
    kind(
        "run/beds/bed.data",
        "run/beds/bed.chain.csv",
        "other/beds/bed.data",
    ),
    kind(
        "run/runs/run-1/forces.csv",
        "run/runs/run-2/forces.csv",
        "other/runs/run-1/forces.csv",
    ),
    kind(
        "run/runs/run-1/angles.csv",
        "run/runs/run-2/angles.csv",
        "other/runs/run-1/angles.csv",
    ),
    kind(
        "run/runs/run-1/coordination.csv",
        "run/runs/run-2/coordination.csv",
        "other/runs/run-1/coordination.csv",
    ),
    kind(
        "run/runs/run-1/chain.csv",
        "run/runs/run-2/chain.csv",
        "other/runs/run-1/chain.csv",
    ),
    kind(
        "run/runs/run-1/summary.json",
        "run/runs/run-2/summary.json",
        "other/runs/run-1/summary.json",
    ),
    kind(
        "run/runs/run-1/checkpoints/000000001389.safetensors",
        "run/runs/run-1/checkpoints/000000002778.safetensors",
        "other/runs/run-1/checkpoints/000000001389.safetensors",
    ),
    kind(
        "run/runs/run-1/checkpoints/000000004167.safetensors",
        "run/runs/run-1/checkpoints/000000002778.safetensors",
        "other/runs/run-1/checkpoints/000000004167.safetensors",
    ),
    kind(
        "run/runs/run-1/snapshots/grains.000000002084.dump",
        "run/runs/run-1/snapshots/grains.000000004167.dump",
        "other/runs/run-1/snapshots/grains.000000002084.dump",
    ),
    kind(
        "run/runs/run-1/snapshots/contacts.000000002084.vtk",
        "run/runs/run-1/snapshots/grains.000000002084.vtk",
        "other/runs/run-1/snapshots/contacts.000000002084.vtk",
    ),
    kind(
        "run/runs/run-1/frames/000000001389.csv",
        "run/runs/run-1/frames/000000002778.csv",
        "other/runs/run-1/frames/000000001389.csv",
    ),
];

/// Those of a campaign.
pub const CAMPAIGN: [Kind; 9] = [
    kind("camp/campaign.toml", "camp/manifest.json", "wee.toml"),
    kind(
        "camp/manifest.json",
        "camp/analysis.json",
        "run/manifest.json",
    ),
    kind(
        "camp/results.csv",
        "camp/results.parquet",
        "camp/analysis.json",
    ),
    kind(
        "camp/results.parquet",
        "camp/results.csv",
        "camp/analysis.json",
    ),
    kind(
        "camp/analysis.json",
        "camp/manifest.json",
        "run/summary.json",
    ),
    kind(
        "camp/members/mu0.3/manifest.json",
        "camp/members/mu0.5/manifest.json",
        "run/manifest.json",
    ),
    kind(
        "camp/members/mu0.3/runs/run-1/summary.json",
        "camp/members/mu0.3/runs/run-2/summary.json",
        "camp/members/mu0.5/runs/run-1/summary.json",
    ),
    kind(
        "camp/members/mu0.3/beds/bed.safetensors",
        "camp/members/mu0.5/beds/bed.safetensors",
        "other/beds/bed.safetensors",
    ),
    kind(
        "camp/members/mu0.3/runs/run-2/forces.csv",
        "camp/members/mu0.3/runs/run-1/forces.csv",
        "run/runs/run-2/forces.csv",
    ),
];

/// Damages a file; returns whether that changed anything.
#[cfg(unix)]
pub fn spoil(room: &Room, kind: &Kind, damage: Damage) -> bool {
    let path = room.path(kind.name);
    let whole = room.read(kind.name);
    let put = |bytes: &[u8]| std::fs::write(&path, bytes).expect("a file of the room");
    let remove = || std::fs::remove_file(&path).expect("a file of the room");
    match damage {
        Damage::BitFlip => {
            let mut bytes = whole.clone();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            put(&bytes);
        }
        Damage::Truncate => put(&whole[..whole.len() / 2]),
        Damage::Empty => put(b""),
        Damage::Append => put(&[&whole[..], b"\n\n"].concat()),
        Damage::Swap => {
            let twin = room.read(kind.twin);
            put(&twin);
            if kind.twin.starts_with("run/runs") {
                room.write(kind.twin, &whole);
            }
            return twin != whole;
        }
        Damage::Foreign => {
            let foreign = room.read(kind.foreign);
            put(&foreign);
            return foreign != whole;
        }
        Damage::Missing => remove(),
        Damage::Folder => {
            remove();
            std::fs::create_dir(&path).expect("a file of the room");
            std::fs::write(path.join("mine.txt"), "mine").expect("a file of the room");
        }
        Damage::Pipe => {
            remove();
            let made = std::process::Command::new("mkfifo").arg(&path).status();
            assert!(made.expect("it starts").success());
        }
        Damage::Link => {
            remove();
            room.write("others/copy", &whole);
            std::os::unix::fs::symlink(room.path("others/copy"), &path)
                .expect("a file of the room");
        }
    }
    true
}
