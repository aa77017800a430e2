//! Every kind of file of a run, a campaign and a library, damaged in every way, before every command: what is
//! damaged is made again or named, and foreign files are not touched.
//!
//! The whole of it: `cargo test -p bitgrain-tests --release --test commands damage:: -- --ignored --nocapture`

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use bitgrain_tests::damage::{CAMPAIGN, DAMAGES, Damage, Kind, RUN, kind, spoil};
use bitgrain_tests::wee::Room;

/// A finished run, another one, a finished campaign and their library, to be copied.
static FURNISHED: LazyLock<Room> = LazyLock::new(|| {
    let room = crate::FURNISHED.copy();
    room.done("run wee.toml --out other --beds other-beds --set seed=2");
    room.write("others/canary.txt", "mine");
    room
});

/// A command, what it may write, and whether it makes again what it needs.
struct Verb {
    words: &'static str,
    writes: &'static [&'static str],
    repairs: bool,
    /// Whether every file that is covered must be as it was.
    checks_all: bool,
}

const RUN_VERBS: [Verb; 6] = [
    Verb {
        words: "run --resume run",
        writes: &["run/"],
        repairs: true,
        checks_all: false,
    },
    Verb {
        words: "verify run",
        writes: &[],
        repairs: false,
        checks_all: true,
    },
    Verb {
        words: "report run",
        writes: &["run/report.html"],
        repairs: false,
        checks_all: false,
    },
    Verb {
        words: "analyse run",
        writes: &["run/analysis.json"],
        repairs: false,
        checks_all: false,
    },
    Verb {
        words: "bisect run twin",
        writes: &[],
        repairs: false,
        checks_all: false,
    },
    Verb {
        words: "claims run",
        writes: &[],
        repairs: false,
        checks_all: false,
    },
];

const CAMPAIGN_VERBS: [Verb; 4] = [
    Verb {
        words: "sweep weecamp.toml --out camp",
        writes: &["camp/"],
        repairs: true,
        checks_all: false,
    },
    Verb {
        words: "verify camp",
        writes: &[],
        repairs: false,
        checks_all: true,
    },
    Verb {
        words: "analyse camp",
        writes: &["camp/report.html", "camp/analysis.json"],
        repairs: false,
        checks_all: false,
    },
    Verb {
        words: "claims camp",
        writes: &[],
        repairs: false,
        checks_all: false,
    },
];

/// Everything below a folder: files by their bytes, others by their kind.
pub fn inventory(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![root.to_path_buf()];
    while let Some(next) = open.pop() {
        for item in std::fs::read_dir(next).unwrap() {
            let path = item.unwrap().path();
            let kind = std::fs::symlink_metadata(&path).unwrap().file_type();
            let name = path
                .strip_prefix(root)
                .unwrap()
                .to_str()
                .unwrap()
                .to_string();
            let what = if kind.is_dir() {
                open.push(path.clone());
                b"folder".to_vec()
            } else if kind.is_symlink() {
                b"link".to_vec()
            } else if kind.is_file() {
                std::fs::read(&path).unwrap()
            } else {
                b"pipe".to_vec()
            };
            found.insert(name, what);
        }
    }
    found
}

/// What commands print of an untouched room, and what the room is then.
struct Untouched {
    said: BTreeMap<&'static str, String>,
    room: BTreeMap<String, Vec<u8>>,
}

static UNTOUCHED: LazyLock<Untouched> = LazyLock::new(|| {
    let room = FURNISHED.copy();
    let said = RUN_VERBS.iter().chain(&CAMPAIGN_VERBS).map(|verb| {
        give_twin(&room, verb);
        (verb.words, printed(&room.done(verb.words)))
    });
    Untouched {
        said: said.collect(),
        room: inventory(FURNISHED.folder.path()),
    }
});

/// The output, without what differs from run to run.
fn printed(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with("seed "));
    lines.collect::<Vec<_>>().join("\n")
}

/// `bisect` compares with an undamaged run.
fn give_twin(room: &Room, verb: &Verb) {
    let twin = room.path("twin");
    if verb.words.ends_with("twin") && !twin.exists() {
        bitgrain_tests::wee::copy_all(&FURNISHED.path("run"), &twin);
    }
}

/// How a command treated a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    /// Made again, with the bytes it had.
    Repaired,
    /// Refused or reported by name.
    Named,
    /// Irrelevant to the command, which printed the same as for an untouched room.
    Unused,
}

/// Whether what a command said names the file, or the one that it was swapped with.
fn names_it(text: &str, kind: &Kind, damage: Damage) -> bool {
    // Names are printed as paths or relative to their folder.
    let short = kind
        .name
        .split_once('/')
        .map_or(kind.name, |(_, rest)| rest);
    let member = short.strip_prefix("members/mu0.3/").unwrap_or(short);
    let twin = kind
        .twin
        .split_once('/')
        .map_or(kind.twin, |(_, rest)| rest);
    let folder = kind.name.split('/').next().unwrap_or_default();
    text.contains(member)
        || damage == Damage::Swap && text.contains(twin)
        // A message that names a manifest names its folder.
        || member == "manifest.json" && text.contains(folder)
}

fn try_one(kind: &Kind, damage: Damage, verb: &Verb) -> Option<End> {
    let room = FURNISHED.copy();
    if !spoil(&room, kind, damage) {
        return None;
    }
    give_twin(&room, verb);
    let what = format!(
        "{} of {} before `{}`",
        format!("{damage:?}").to_lowercase(),
        kind.name,
        verb.words
    );
    let before = inventory(room.folder.path());
    let out = room.told(verb.words);
    let after = inventory(room.folder.path());
    let text =
        String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    let status = out
        .status
        .code()
        .unwrap_or_else(|| panic!("{what}: killed by a signal: {text}"));
    assert!(
        !text.contains("panicked") && [0, 1, 2, 3].contains(&status),
        "{what}: {status}: {text}"
    );
    // Nothing that the command does not write was touched, and of what it writes only what it then names.
    let mine = |name: &str| {
        let writes = |prefix: &&str| name.starts_with(*prefix);
        verb.writes.iter().any(writes)
    };
    let names = before.keys().chain(after.keys());
    for name in names.filter(|name| !mine(name)) {
        assert_eq!(
            before.get(name),
            after.get(name),
            "{what}: {name} was touched: {text}"
        );
    }
    let named = names_it(&text, kind, damage);
    let machine = kind.name.ends_with("performance.json");
    if status != 0 {
        assert!(named, "{what}: not named: {text}");
        if verb.repairs {
            // What could not be repaired is as it was; so is everything that was sound.
            let spoilt = before.get(kind.name);
            assert_eq!(
                after.get(kind.name),
                spoilt,
                "{what}: changed and refused: {text}"
            );
            for name in before.keys().filter(|name| *name != kind.name) {
                let now = after.get(name);
                assert!(
                    now == before.get(name) || now == UNTOUCHED.room.get(name),
                    "{what}: {name} was spoilt: {text}"
                );
            }
        }
        return Some(End::Named);
    }
    if verb.repairs {
        let wrong: Vec<&String> = UNTOUCHED
            .room
            .iter()
            .filter(|(name, bytes)| {
                mine(name)
                    && !name.ends_with("performance.json")
                    && after.get(*name) != Some(*bytes)
            })
            .map(|(name, _)| name)
            .collect();
        assert!(
            wrong.is_empty(),
            "{what}: ended well, but {wrong:?} differ: {text}"
        );
        return Some(End::Repaired);
    }
    let page = ["report.html", "analysis.json"]
        .iter()
        .any(|end| kind.name.ends_with(end));
    assert!(
        !verb.checks_all || machine || page,
        "{what}: verified: {text}"
    );
    let said = printed(&text);
    // The place of results is printed, whatever they are.
    let same = said == UNTOUCHED.said[verb.words] || verb.checks_all && (machine || page);
    assert!(same || named, "{what}: silent: {said}");
    Some(if same { End::Unused } else { End::Named })
}

/// All cases, or every `nth` of them, on all processors.
fn matrix(nth: usize) {
    LazyLock::force(&UNTOUCHED);
    let mut cases = Vec::new();
    for (kinds, verbs) in [
        (&RUN[..], &RUN_VERBS[..]),
        (&CAMPAIGN[..], &CAMPAIGN_VERBS[..]),
    ] {
        for kind in kinds {
            for damage in DAMAGES {
                cases.extend(verbs.iter().map(|verb| (kind, damage, verb)));
            }
        }
    }
    let cases: Vec<_> = cases.into_iter().step_by(nth).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut ends = BTreeMap::new();
        while let Some((kind, damage, verb)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Some(end) = try_one(kind, *damage, verb) {
                *ends.entry((verb.words, end)).or_insert(0) += 1;
            }
        }
        ends
    };
    let mut all: BTreeMap<(&str, End), usize> = BTreeMap::new();
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let working: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        for one in working {
            for (key, count) in one.join().unwrap_or_else(|e| std::panic::resume_unwind(e)) {
                *all.entry(key).or_insert(0) += count;
            }
        }
    });
    for ((words, end), count) in &all {
        println!("{words}: {end:?} {count}");
    }
    let tried: usize = all.values().sum();
    println!("{tried} cases");
    assert!(tried * 2 > cases.len(), "{tried} of {}", cases.len());
}

#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_is_spoilt_is_repaired_or_named() {
    matrix(23);
}

#[test]
#[cfg(unix)]
#[ignore = "minutes"]
fn whatever_is_spoilt_is_repaired_or_named() {
    matrix(1);
}

/// A bed of the library, damaged in every way: a run refuses it by name or pours it again, and ends the same.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_spoilt_library_is_refused_or_of_no_concern() {
    let want = FURNISHED.files("run");
    let library = |room: &Room, name: &str| {
        let recipe = |bed: &std::path::PathBuf| {
            let text = std::fs::read_to_string(bed.join("recipe.toml")).unwrap();
            text.contains("mu = 0.5")
        };
        let beds = std::fs::read_dir(room.path(name)).unwrap();
        let mut beds = beds.map(|bed| bed.unwrap().path());
        let bed = beds.find(recipe).expect("the run's bed");
        bed.strip_prefix(room.folder.path())
            .unwrap()
            .to_str()
            .unwrap()
            .to_string()
    };
    let own = library(&FURNISHED, "beds");
    let other = library(&FURNISHED, "other-beds");
    for file in ["bed.safetensors", "recipe.toml"] {
        let leak = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
        let kind = kind(
            leak(format!("{own}/{file}")),
            leak(format!("{other}/{file}")),
            leak(format!("{other}/{file}")),
        );
        for damage in DAMAGES {
            let room = FURNISHED.copy();
            spoil(&room, &kind, damage);
            let canary = room.read("others/canary.txt");
            let out = room.told("run wee.toml --out new");
            let text = String::from_utf8_lossy(&out.stderr).into_owned();
            match out.status.code() {
                Some(0) => assert!(room.files("new") == want, "{file}, {damage:?}"),
                Some(1 | 2) => assert!(text.contains(file), "{file}, {damage:?}: {text}"),
                other => panic!("{file}, {damage:?}: {other:?}: {text}"),
            }
            room.told("bed list");
            assert_eq!(room.read("others/canary.txt"), canary);
        }
    }
}
