//! What may be chosen in a scenario and in how it is run: each option with its keys, at the smallest size.

use toml::{Table, Value};

/// The scenario that every choice changes: 64 grains, of which a drag takes half a second of a step's work.
const BASE: &str = r#"
name = "joint"
units = "reduced"
gravity = 1.0

[bed]
box = [4.0, 3.0, 8.0]
grains = 64
diameters = [0.9, 1.1]
density = 1.0
base = 1.1
settled = 1e-1

[law]
kind = "hertz_history"
kn = 1e4
kt = 1.2e4
gamma_n = 600.0
gamma_t = 600.0
mu = 0.5

[intruder]
diameter = 1.0
density = 1.0
height = 3.4
speed = 1.0

[drag]
dt = 2e-3
distance = 2.6

[measure]
every = 5
digest_every = 200
checkpoints = 2
snapshots = 1
"#;

/// Something that may be chosen.
#[derive(Debug)]
pub struct Choice {
    /// Only one choice of an axis can be taken.
    pub axis: &'static str,
    /// What the guide calls it.
    pub name: &'static str,
    /// Keys that it leaves out.
    cuts: &'static str,
    /// Keys that it sets, as TOML writes them.
    keys: &'static str,
}

const fn choice(
    axis: &'static str,
    name: &'static str,
    cuts: &'static str,
    keys: &'static str,
) -> Choice {
    Choice {
        axis,
        name,
        cuts,
        keys,
    }
}

/// Of how a scenario is run: these change no key.
pub const NO_FRAMES: &str = "no frames (from Rust)";
pub const ONLY: &str = "`run --only`";
pub const SWEEP: &str = "`sweep`, `--task`";

/// Places of the intruder cut out, and what moves it.
const PLACE: &str = "intruder.height";
const DRAGGED: &str = "intruder.speed drag.distance";
const DROPPED: &str = "intruder.height intruder.speed drag.distance";

/// All choices; those that others build on come first.
pub const CHOICES: [Choice; 55] = [
    choice(
        "file",
        "`bed.file`",
        "bed.box bed.grains bed.base intruder.diameter intruder.density intruder.height",
        "bed.file = 'bed.data'",
    ),
    choice(
        "shape",
        "`shape = \"cylinder\"`",
        "intruder.density",
        "intruder.shape = 'cylinder'\nintruder.diameter = 0.4\nintruder.speed = 0.5\n\
         bed.box = [11.0, 3.0, 8.0]\nbed.grains = 176",
    ),
    choice(
        "shape",
        "`shape = \"bar\"`, `container = \"tank\"`",
        "intruder.density",
        "intruder.shape = 'bar'\nintruder.diameter = 0.5\nintruder.length = 0.6\nintruder.height = 4.5\n\
         bed.container = 'tank'\nbed.box = [9.0, 9.0, 8.0]\nbed.grains = 340\nbed.base = 0.3\n\
         drag.distance = 0.94\ndrag.discard = 0.25",
    ),
    choice(
        "motion",
        "`motion = \"dropped\"`",
        DROPPED,
        "intruder.motion = 'dropped'\nintruder.drop_height = 0.5\ndrag.duration = 2.0",
    ),
    choice(
        "motion",
        "`motion = \"pulled\"`",
        DRAGGED,
        "intruder.motion = 'pulled'\nintruder.force = 3.0\ndrag.duration = 2.0",
    ),
    choice(
        "motion",
        "`motion = \"pulled\"`, `rises`",
        DRAGGED,
        "intruder.motion = 'pulled'\nintruder.force = 3.0\ndrag.duration = 2.0\nintruder.rises = true",
    ),
    choice(
        "motion",
        "`motion = \"pulled\"`, `spins`",
        DRAGGED,
        "intruder.motion = 'pulled'\nintruder.force = 3.0\ndrag.duration = 2.0\nintruder.spins = true",
    ),
    choice(
        "motion",
        "`motion = \"floating\"`",
        "",
        "intruder.motion = 'floating'",
    ),
    choice(
        "motion",
        "`motion = \"floating\"`, `spins`",
        "",
        "intruder.motion = 'floating'\nintruder.spins = true",
    ),
    choice("moves", "`moves = \"bed\"`", "", "drag.moves = 'bed'"),
    choice(
        "law",
        "`hertz_tsuji`",
        "law",
        "law = { kind = 'hertz_tsuji', young = 1.4e4, poisson = 0.3, restitution = 0.3, mu = 0.5 }",
    ),
    choice(
        "law",
        "`hertz_tsuji`, `poisson = 0.5`",
        "law",
        "law = { kind = 'hertz_tsuji', young = 1.2e4, poisson = 0.5, restitution = 0.3, mu = 0.5 }",
    ),
    choice(
        "law",
        "`hertz_history`, `gamma_t = 0`",
        "",
        "law.gamma_t = 0.0",
    ),
    choice("friction", "little friction", "", "law.mu = 0.1"),
    choice(
        "rolling",
        "`rolling` `sds`",
        "",
        "law.rolling = { kind = 'sds', k = 60.0, gamma = 0.3, mu = 0.1 }",
    ),
    choice(
        "rolling",
        "`rolling` `sds`, `k = 0`",
        "",
        "law.rolling = { kind = 'sds', k = 0.0, gamma = 0.3, mu = 0.1 }",
    ),
    choice(
        "rolling",
        "`rolling` `epsd2`",
        "",
        "law.rolling = { kind = 'epsd2', mu = 0.1 }",
    ),
    choice(
        "rolling",
        "`rolling` `epsd2`, `mu = 0`",
        "",
        "law.rolling = { kind = 'epsd2', mu = 0.0 }",
    ),
    choice("units", "`units = \"si\"`", "", "units = 'si'"),
    choice("seed", "`seed`", "", "seed = 7"),
    choice("seed", "`seeds`", "", "seeds = [1, 2]"),
    choice(
        "filling",
        "`fill_height`",
        "bed.grains",
        "bed.fill_height = 4.6",
    ),
    choice(
        "diameters",
        "equal `diameters`",
        "",
        "bed.diameters = [1.0, 1.0]",
    ),
    choice("base", "`base = 0`", "", "bed.base = 0.0"),
    choice("floor", "`floor = false`", "", "bed.floor = false"),
    choice(
        "pouring",
        "`pouring = \"in_turn\"`",
        "",
        "bed.pouring = 'in_turn'",
    ),
    choice("pouring_mu", "`pouring_mu`", "", "bed.pouring_mu = 0.2"),
    choice("halting", "`halting = true`", "", "bed.halting = true"),
    choice("halting", "`halting = false`", "", "bed.halting = false"),
    choice("place", "`depth`", PLACE, "intruder.depth = 1.3"),
    choice(
        "place",
        "several `height`",
        PLACE,
        "intruder.height = [3.3, 3.6]",
    ),
    choice(
        "diameter",
        "several `diameter`",
        "",
        "intruder.diameter = [0.9, 1.0]",
    ),
    choice(
        "speed",
        "`froude`",
        "intruder.speed",
        "intruder.froude = 1.4\ndrag.distance = 2.6",
    ),
    choice(
        "speed",
        "several `speed`",
        "",
        "intruder.speed = [1.0, 1.2]\ndrag.distance = [2.6, 2.7]",
    ),
    choice(
        "lid",
        "`lid.effective_depth`",
        "",
        "lid.effective_depth = 4.0",
    ),
    choice("lid", "`lid.density`", "", "lid.density = 2.0"),
    choice(
        "lid",
        "`lid`, `pressure_gradient = \"without\"`",
        "",
        "lid.density = 2.0\nlid.pressure_gradient = 'without'",
    ),
    choice(
        "lid",
        "`lid`, `pressure_gradient = \"both\"`",
        "",
        "lid.density = 2.0\nlid.pressure_gradient = 'both'",
    ),
    choice(
        "history",
        "`history = \"kept\"`",
        "",
        "drag.history = 'kept'",
    ),
    choice(
        "history",
        "`history = \"empty\"`",
        "",
        "drag.history = 'empty'",
    ),
    choice(
        "own_wake",
        "`own_wake`",
        "",
        "drag.own_wake = true\ndrag.distance = 4.2",
    ),
    choice("discard", "`discard`", "", "drag.discard = 1.0"),
    choice("torque", "`torque = false`", "", "measure.torque = false"),
    choice(
        "contacts",
        "`contacts = false`",
        "",
        "measure.contacts = false",
    ),
    choice("snapshots", "`snapshots = 0`", "", "measure.snapshots = 0"),
    choice("energy", "`energy`", "", "measure.energy = true"),
    choice("gzip", "`gzip`", "", "measure.gzip = true"),
    choice(
        "checkpoints",
        "`checkpoints = 1`",
        "",
        "measure.checkpoints = 1",
    ),
    choice("reaches", "`reaches`", "", "measure.reaches = [0.5, 1.0]"),
    choice(
        "fields",
        "`[measure.fields]`",
        "",
        "measure.fields = { grid = [4, 2, 4], window = 0.9, every = 20 }",
    ),
    choice("every", "`every`", "", "measure.every = 3"),
    choice(
        "digest_every",
        "`digest_every`",
        "",
        "measure.digest_every = 7",
    ),
    choice("way", NO_FRAMES, "", ""),
    choice("way", ONLY, "", ""),
    choice("way", SWEEP, "", ""),
];

/// The keys that a choice sets beside these shapes and motions, where other values suit them.
fn suited(choice: &Choice, table: &Table) -> &'static str {
    let text = |key: &str| get(table, key).and_then(Value::as_str).unwrap_or_default();
    let base = get(table, "bed.base").and_then(Value::as_float);
    match (choice.axis, choice.name, text("intruder.shape")) {
        ("place", "`depth`", "bar") => "intruder.depth = 0.3",
        ("place", "several `height`", "bar") => "intruder.height = [4.5, 4.6]",
        ("filling", _, "bar") => "bed.fill_height = 4.8",
        ("diameter", _, "cylinder") => "intruder.diameter = [0.38, 0.4]",
        ("diameter", _, "bar") => "intruder.diameter = [0.5, 0.55]",
        ("speed", "several `speed`", "cylinder") => "intruder.speed = [0.5, 0.6]",
        ("speed", _, "cylinder") => "intruder.froude = 0.6",
        ("speed", "several `speed`", "bar") => "intruder.speed = [1.0, 0.9]",
        ("speed", _, "bar") => "intruder.froude = 1.2",
        ("own_wake", _, "bar") => "drag.own_wake = true\ndrag.distance = 1.2",
        ("discard", _, "bar") => "drag.discard = 0.3",
        // Soft grains that fall pass between those of a thin base.
        ("floor", ..) if base.is_some_and(|base| base > 1.0) => "bed.floor = false\nbed.base = 1.5",
        ("own_wake", ..) if get(table, "drag.distance").is_none() => "drag.own_wake = true",
        _ => choice.keys,
    }
}

fn get<'a>(table: &'a Table, key: &str) -> Option<&'a Value> {
    match key.split_once('.') {
        None => table.get(key),
        Some((outer, inner)) => table.get(outer)?.as_table()?.get(inner),
    }
}

/// A scenario with these choices, which are in the order of the list.
pub fn scenario(choices: &[&Choice]) -> Table {
    let mut table: Table = toml::from_str(BASE).unwrap();
    for choice in choices {
        let mut keys: Table = toml::from_str(suited(choice, &table)).unwrap();
        // A bed's file has its own sizes.
        if let Some(intruder) = keys.get_mut("intruder").and_then(Value::as_table_mut)
            && choice.axis == "shape"
            && get(&table, "bed.file").is_some()
        {
            intruder.remove("diameter");
            intruder.remove("speed");
            intruder.remove("height");
            if let Some(bed) = keys.get_mut("bed").and_then(Value::as_table_mut) {
                bed.retain(|key, _| key == "container");
            }
        }
        for key in choice.cuts.split_whitespace() {
            match key.split_once('.') {
                None => drop(table.remove(key)),
                Some((outer, inner)) => drop(table[outer].as_table_mut().unwrap().remove(inner)),
            }
        }
        merge(&mut table, keys);
    }
    table
}

fn merge(table: &mut Table, keys: Table) {
    for (key, value) in keys {
        match (table.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) => merge(old, new),
            (_, value) => drop(table.insert(key, value)),
        }
    }
}

/// The choices of these names, in the order of the list.
pub fn named(names: &str) -> Vec<&'static Choice> {
    let names: Vec<&str> = names.split(" + ").map(str::trim).collect();
    let unknown = names
        .iter()
        .find(|name| CHOICES.iter().all(|c| c.name != **name));
    assert_eq!(unknown, None, "no such choice");
    let chosen = CHOICES.iter().filter(|choice| names.contains(&choice.name));
    chosen.collect()
}

/// Their names as [`named`] reads them.
pub fn names(choices: &[&Choice]) -> String {
    let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
    names.join(" + ")
}
