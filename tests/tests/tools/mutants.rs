//! The kernel's tests catch what they should: each named mutant is one wrong piece of
//! source, and the tests named beside it must fail on it, while the unchanged copy passes.
//!
//! The kernel is copied into its own folder with a workspace that builds fast; the build
//! is kept in `target/mutants`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// One wrong piece of source.
struct Mutant {
    /// What is wrong.
    name: &'static str,
    /// File under `kernel/src`.
    file: &'static str,
    /// Text that occurs there once.
    from: &'static str,
    /// Text in its place.
    to: &'static str,
    /// The target that must catch it: a module of `kernel/tests/kernel`, or [`UNIT`].
    target: &'static str,
    /// Tests of that target that must fail.
    red: &'static [&'static str],
}

/// The tests inside the kernel's sources.
const UNIT: &str = "unit tests";

const MUTANTS: &[Mutant] = &[
    Mutant {
        name: "what was written to between two steps goes unseen",
        file: "phases.rs",
        from: "whole(world, sealed) != world.clock.seal",
        to: "whole(world, sealed) == 0",
        target: "edits",
        red: &[
            "what_is_written_between_two_steps_is_refused_at_every_skin",
            "every_edit_is_found_in_both_precisions",
            "another_table_or_box_is_found",
        ],
    },
    Mutant {
        name: "rows are sealed wherever they stand",
        file: "digest/seal.rs",
        from: "place = place.wrapping_add(1);",
        to: "let _ = place.wrapping_add(1);",
        target: "edits",
        red: &["every_edit_is_found_in_both_precisions"],
    },
    Mutant {
        name: "sum order: partners as the cells hold them",
        file: "neighbors/cell_list.rs",
        from: "            sort(row);",
        to: "            let _ = row;",
        target: "sums",
        red: &[
            "forces_are_summed_in_the_contracts_order_hertz_history",
            "forces_are_summed_in_the_contracts_order_hertz_tsuji",
        ],
    },
    Mutant {
        name: "sum order: what lower ranges send comes backwards",
        file: "forces/accumulate.rs",
        from: "for one in lower {",
        to: "let mut sent = [CrossRangeForce::default(); 999];\n    let mut count = 0;\n    \
             for one in lower {\n        (sent[count], count) = (*one, count + 1);\n    }\n    \
             for one in sent[..count].iter().rev() {",
        target: "sums",
        red: &["any_cut_into_ranges_gives_the_same_steps"],
    },
    Mutant {
        name: "sum order: obstacles by descending number",
        file: "neighbors/cell_list.rs",
        from: "in obstacles.iter().enumerate() {",
        to: "in obstacles.iter().enumerate().rev() {",
        target: "sums",
        red: &["a_grain_in_a_corner_hears_obstacles_by_number"],
    },
    Mutant {
        name: "a grain goes on before its last pair was heard",
        file: "forces/accumulate.rs",
        from: "|&i| (i as usize).wrapping_sub(first));",
        to: "|&i| (i as usize + 1).wrapping_sub(first));",
        target: "sums",
        red: &["any_cut_into_ranges_gives_the_same_steps"],
    },
    Mutant {
        name: "what higher ranges give comes a grain late",
        file: "forces/accumulate.rs",
        from: "        if i >= next {",
        to: "        if i + 1 >= next {",
        target: "sums",
        red: &["any_cut_into_ranges_gives_the_same_steps"],
    },
    Mutant {
        name: "a list cut elsewhere counts as cut here",
        file: "phases.rs",
        from: "travel > world.clock.budget || world.clock.partition_mark != mark(range_bounds)",
        to: "travel > world.clock.budget",
        target: "sums",
        red: &["any_cut_into_ranges_gives_the_same_steps"],
    },
    Mutant {
        name: "candidates are trusted for ever",
        file: "phases.rs",
        from: "if world.clock.far < skin {",
        to: "if world.clock.far < R::ZERO {",
        target: "search",
        red: &["two_that_fly_at_each_other_meet_in_time"],
    },
    Mutant {
        name: "third law: the partner is pulled along",
        file: "forces/accumulate.rs",
        from: "sub_at(grains.force, j, push);",
        to: "add_at(grains.force, j, push);",
        target: "sums",
        red: &["forces_are_summed_in_the_contracts_order_hertz_history"],
    },
    Mutant {
        name: "third law: the partner's torque with the other lever's sign",
        file: "forces/accumulate.rs",
        from: "sub_at(grains.torque, j, &times(couple, lever_arm_j));",
        to: "add_at(grains.torque, j, &times(couple, lever_arm_j));",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "skipped projection",
        file: "contact/law.rs",
        from: "spring: sub(grown, scale(normal, dot(grown, normal))),",
        to: "spring: grown,",
        target: UNIT,
        red: &[
            "contact::law::tests::springs_lie_in_the_tangent_plane_hertz_history",
            "contact::law::tests::springs_lie_in_the_tangent_plane_hertz_tsuji",
        ],
    },
    Mutant {
        name: "cap not applied: hertz_history",
        file: "contact/hertz_history.rs",
        from: "let slides = ft > cap;",
        to: "let slides = ft > cap + R::MAX;",
        target: UNIT,
        red: &["contact::law::tests::friction_is_capped_hertz_history"],
    },
    Mutant {
        name: "cap not applied: hertz_tsuji",
        file: "contact/hertz_tsuji.rs",
        from: "let slides = pull > cap;",
        to: "let slides = pull > cap + R::MAX;",
        target: UNIT,
        red: &["contact::law::tests::friction_is_capped_hertz_tsuji"],
    },
    Mutant {
        name: "damping puts energy in",
        file: "contact/hertz_tsuji.rs",
        from: "* c.overlap - (self.cn * damp) * c.speed",
        to: "* c.overlap + (self.cn * damp) * c.speed",
        target: UNIT,
        red: &["contact::law::tests::damping_takes_energy_out_hertz_tsuji"],
    },
    Mutant {
        name: "lost history: a pair's spring at a rebuild",
        file: "neighbors/prune.rs",
        from: "|(_, _, from)| old.spring_of(from)",
        to: "|_| [R::ZERO; 3]",
        target: "search",
        red: &[
            "springs_survive_a_rebuild_hertz_history",
            "springs_survive_a_rebuild_hertz_tsuji",
        ],
    },
    Mutant {
        name: "lost history: an obstacle's spring at a rebuild",
        file: "neighbors/cell_list.rs",
        from: "get_or_default(old.obstacle_contact_spring, from)",
        to: "[R::ZERO; 4]",
        target: "search",
        red: &[
            "springs_survive_a_rebuild_hertz_history",
            "springs_survive_a_rebuild_hertz_tsuji",
        ],
    },
    Mutant {
        name: "kept history: who parted remembers",
        file: "contact/block.rs",
        from: "either(touches, tangential_force.spring, [R::ZERO; 3])",
        to: "either(touches, tangential_force.spring, state.spring)",
        target: "images",
        red: &["a_contact_that_parted_begins_anew"],
    },
    Mutant {
        name: "shifted image: half a period in a separation",
        file: "state/domain.rs",
        from: "let up = raw + self.period[k];",
        to: "let up = raw + self.half[k];",
        target: "images",
        red: &["where_the_box_is_cut_does_not_matter"],
    },
    Mutant {
        name: "shifted image: a crossing is not counted",
        file: "state/domain.rs",
        from: "crossing = -1;",
        to: "crossing = 0;",
        target: "images",
        red: &["places_and_crossings_give_the_path"],
    },
    Mutant {
        name: "cells do not close across a period",
        file: "neighbors/grid.rs",
        from: "let after = if k + 1 < n { k + 1 } else { 0 };",
        to: "let after = if k + 1 < n { k + 1 } else { n - 3 };",
        target: "search",
        red: &["every_near_pair_is_listed"],
    },
    Mutant {
        name: "list too short by rounding",
        file: "phases.rs",
        from: "near: skin + world.clock.slack,",
        to: "near: skin - world.clock.slack,",
        target: "search",
        red: &["the_filter_drops_no_touching_pair"],
    },
    Mutant {
        name: "the list ignores the step's own travel",
        file: "phases.rs",
        from: "let need = travel + travel;",
        to: "let need = R::ZERO * travel;",
        target: "search",
        red: &["two_that_fly_at_each_other_meet_in_time"],
    },
    Mutant {
        name: "the list is trusted for the whole skin",
        file: "phases.rs",
        from: "clock.budget = skin * R::HALF;",
        to: "clock.budget = skin;",
        target: "search",
        red: &["two_that_fly_at_each_other_meet_in_time"],
    },
    Mutant {
        name: "a lid gives way along x",
        file: "integrate.rs",
        from: "if !group.integrates[a] {",
        to: "if !group.integrates[2] {",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "all weigh alike, whatever their group",
        file: "integrate.rs",
        from: "&plus(&times(force, per_mass), &gravity)",
        to: "&plus(&times(force, per_mass), &addend([-R::ONE; 3]))",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "a bar is as curved as a ball",
        file: "state/obstacle.rs",
        from: "overlap: (radius + own) - distance,\n                    radius: R::ZERO,",
        to: "overlap: (radius + own) - distance,\n                    radius: own,",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_tsuji"],
    },
    Mutant {
        name: "a hollow ball's moment of inertia",
        file: "integrate.rs",
        from: "R::from_f64(0.4)",
        to: "R::from_f64(2.0 / 3.0)",
        target: "oracle",
        red: &["the_step_equals_its_definition_hertz_history"],
    },
    Mutant {
        name: "a removed grain leaves the places of the others",
        file: "edit/remove.rs",
        from: "if goes { GONE } else { left as u32 }",
        to: "if goes { GONE } else { i as u32 }",
        target: "comings",
        red: &["histories_of_others_stay"],
    },
    Mutant {
        name: "springs stay where they were when pairs move",
        file: "edit/renumber.rs",
        from: "list.set_spring(to, spring);",
        to: "list.set_spring(p, spring);",
        target: "comings",
        red: &["histories_of_others_stay"],
    },
    Mutant {
        name: "an insertion does not look how deep it overlaps",
        file: "edit/settle.rs",
        from: "check_depths(world)\n}",
        to: "Ok(())\n}",
        target: "comings",
        red: &["edits_that_cannot_be_change_nothing"],
    },
    Mutant {
        name: "a drain takes from the wrong side",
        file: "state/losses.rs",
        from: "self.normal) < R::ZERO",
        to: "self.normal) > R::ZERO",
        target: "comings",
        red: &["losses_are_the_same_at_every_skin_and_cut"],
    },
    Mutant {
        name: "a saved world is not compared with what it became",
        file: "saved/read.rs",
        from: "match saved.checksum() == hasher.finish() {",
        to: "match true {",
        target: "saved",
        red: &["changed_bytes_are_refused_and_nothing_is_lost"],
    },
    Mutant {
        name: "cells at the ends of a trimmed axis lose the strays",
        file: "neighbors/grid.rs",
        from: "let within = smaller(larger(x[a], self.lo[a]), self.hi[a]);",
        to: "let within = x[a] + (self.hi[a] - self.lo[a]);",
        target: "search",
        red: &["strays_hide_no_pair"],
    },
];

/// A workspace with what the kernel's manifest takes from its own, built fast: a little
/// optimisation, as the tests step whole worlds, and no debug information.
const WORKSPACE: &str = r#"
[workspace]
resolver = "3"
members = ["kernel"]

[workspace.package]
version = "0.1.0"
edition = "2024"
rust-version = "1.95"
license = "MIT OR Apache-2.0"
publish = false

[workspace.lints.rust]
unsafe_code = "deny"
unexpected_cfgs = { level = "warn", check-cfg = ["cfg(bitgrain_negative_control)"] }

[profile.dev]
opt-level = 1
debug = false
debug-assertions = true
"#;

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a new folder");
    for entry in fs::read_dir(from).expect("a folder of the kernel") {
        let entry = entry.expect("a readable entry");
        let (path, copy) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_folder(&path, &copy);
        } else {
            // Rewritten rather than copied, so that it is newer than what was built before.
            let text = fs::read(&path).expect("a readable file");
            fs::write(copy, text).expect("a new file");
        }
    }
}

/// The kernel in its own workspace.
struct Copy {
    folder: PathBuf,
    build: PathBuf,
}

impl Copy {
    fn new() -> Self {
        let root = bitgrain_tests::root();
        let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let build = tmp.parent().expect("it lies in target").join("mutants");
        // Always at one place: to cargo a package elsewhere is another, and is built beside the old.
        let folder = build.join("source");
        let _ = fs::remove_dir_all(&folder);
        for part in ["src", "tests", "examples"] {
            let to = folder.join("kernel").join(part);
            copy_folder(&root.join("kernel").join(part), &to);
        }
        for file in ["kernel/Cargo.toml", "Cargo.lock"] {
            fs::copy(root.join(file), folder.join(file)).expect("a readable file");
        }
        fs::write(folder.join("Cargo.toml"), WORKSPACE).expect("a new file");
        Self { folder, build }
    }

    fn source(&self, file: &str) -> PathBuf {
        self.folder.join("kernel/src").join(file)
    }

    /// Runs `cargo test` on some targets, with random cases that are the same every time.
    fn test(&self, arguments: &[&str]) -> Output {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| env!("CARGO").into());
        Command::new(cargo)
            .args(["test", "--offline", "--quiet", "-p", "bitgrain-kernel"])
            .args(arguments)
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", &self.build)
            .env("CARGO_TERM_COLOR", "never")
            .env("RUST_BACKTRACE", "0")
            .env("PROPTEST_CASES", "16")
            .env("PROPTEST_MAX_SHRINK_ITERS", "0")
            .env("PROPTEST_RNG_SEED", "1")
            .env_remove("RUSTFLAGS")
            .output()
            .expect("cargo starts")
    }

    /// What is wrong with the tests on this mutant, if anything.
    fn check(&self, mutant: &Mutant) -> Option<String> {
        let path = self.source(mutant.file);
        let whole = fs::read_to_string(&path).expect("a source of the kernel");
        let count = whole.matches(mutant.from).count();
        if count != 1 {
            return Some(format!("its text occurs {count} times in {}", mutant.file));
        }
        fs::write(&path, whole.replace(mutant.from, mutant.to)).expect("a writable copy");
        let found = self.run(mutant);
        fs::write(&path, whole).expect("a writable copy");
        found
    }

    fn run(&self, mutant: &Mutant) -> Option<String> {
        let (target, module) = match mutant.target {
            UNIT => (vec!["--lib"], String::new()),
            module => (vec!["--test", "kernel"], format!("{module}::")),
        };
        let red: Vec<String> = mutant
            .red
            .iter()
            .map(|test| format!("{module}{test}"))
            .collect();
        let built = self.test(&[target.as_slice(), &["--no-run"]].concat());
        if !built.status.success() {
            let why = String::from_utf8_lossy(&built.stderr);
            return Some(format!("it does not compile:\n{why}"));
        }
        let mut chosen = vec!["--no-fail-fast", "--", "--exact", "--format=pretty"];
        chosen.extend(red.iter().map(String::as_str));
        let ran = self.test(&[target, chosen].concat());
        let text = String::from_utf8_lossy(&ran.stdout);
        let survived = red
            .iter()
            .find(|test| !text.contains(&format!("test {test} ... FAILED\n")));
        survived.map(|test| format!("{test} does not fail:\n{text}"))
    }
}

/// Found in seconds: a change of the kernel that removes a mutant's text.
#[test]
fn every_mutant_has_its_text() {
    let kernel = bitgrain_tests::root().join("kernel/src");
    for mutant in MUTANTS {
        let whole = fs::read_to_string(kernel.join(mutant.file)).expect("a source of the kernel");
        assert_eq!(whole.matches(mutant.from).count(), 1, "{}", mutant.name);
    }
}

#[test]
#[ignore = "builds the kernel some fifty times: `.ci/run mutants`, two minutes"]
fn every_mutant_is_caught_and_the_kernel_itself_passes() {
    let copy = Copy::new();
    let whole = copy.test(&["--lib", "--tests"]);
    assert!(
        whole.status.success(),
        "the unchanged kernel fails:\n{}{}",
        String::from_utf8_lossy(&whole.stdout),
        String::from_utf8_lossy(&whole.stderr)
    );
    let survivors: Vec<String> = MUTANTS
        .iter()
        .filter_map(|mutant| {
            let problem = copy.check(mutant)?;
            Some(format!("{}: {problem}", mutant.name))
        })
        .collect();
    assert!(
        survivors.is_empty(),
        "not caught:\n{}",
        survivors.join("\n")
    );
}
