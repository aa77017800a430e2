//! Foreign files stay as they are, and changed files are not trusted.

use std::io::Write;

use bitgrain::campaign::table::CampaignTable;
use bitgrain::checkpoint;
use bitgrain::manifest::Manifest;
use bitgrain_tests::wee::Room;

use crate::{FURNISHED, PROGRAM};

/// Foreign files with the ending of our half-written files, and files of other runs, stay where they are.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn files_of_others_are_not_removed() {
    let room = Room::new(PROGRAM);
    let others = [
        "home/downloads/film.mkv.partial",
        "home/downloads/forces.csv.12-3.bitgrain-partial",
        "home/film.mkv.partial",
        "home/notes.txt",
    ];
    for name in others {
        room.write(name, "mine");
    }
    // This one is a half file of ours in a folder of ours.
    room.write("home/runs.12-3.bitgrain-partial", "ours");
    room.done("run wee.toml --out home");
    for name in others {
        assert_eq!(room.read(name), b"mine", "{name}");
    }
    assert!(!room.path("home/runs.12-3.bitgrain-partial").exists());
    // It is a run all the same, and says what else lies there.
    let told = room.done("verify home");
    assert!(
        told.contains("not covered by manifest.json: downloads/film"),
        "{told}"
    );
}

/// A file that is named for output replaces no result, whatever the folder is called.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_named_file_replaces_no_result() {
    let room = FURNISHED.copy();
    let before = room.files("run");
    for command in [
        "analyse run --out run/summary.json",
        "analyse run --report run/manifest.json",
        "analyse run --out ./run/runs/../summary.json",
        "replay run --stage bed --steps 1 --save run/beds/bed.safetensors",
    ] {
        let told = room.says(command, 2);
        assert!(told.contains("is a result, which the manifest"), "{told}");
    }
    assert_eq!(room.files("run"), before);
    room.done("verify run");
}

/// A run in a folder above another's does not disturb it.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_in_a_folder_below_goes_on() {
    let room = Room::new(PROGRAM);
    let mut inner =
        room.begin("run wee.toml --out nest/inner --set bed.settled=1e-12 --save-every 1");
    while !room
        .path("nest/inner/beds/bed.pouring.safetensors")
        .exists()
    {
        assert!(inner.try_wait().unwrap().is_none(), "it is at work");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    for _ in 0..6 {
        room.done("run wee.toml --out nest");
        assert!(
            inner.try_wait().unwrap().is_none(),
            "the inner run was ended"
        );
    }
    inner.kill().unwrap();
    inner.wait().unwrap();
}

/// A folder that holds a name which would be written, and is not a run's, is refused and left as it is.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_folder_of_others_is_refused() {
    for name in [
        "scenario.toml",
        "summary.json",
        "report.html",
        "runs/mine",
        "beds/mine",
    ] {
        let room = Room::new(PROGRAM);
        room.write(&format!("home/{name}"), "mine");
        let told = room.says("run wee.toml --out home", 2);
        let word = name.split('/').next().unwrap();
        assert!(told.contains(&format!("holds `{word}`")), "{told}");
        assert_eq!(room.files("home").len(), 1);
    }
    for name in ["results.csv", "members/mine", "analysis.json"] {
        let room = Room::new(PROGRAM);
        room.write(&format!("home/{name}"), "mine");
        let told = room.says("sweep weecamp.toml --out home", 2);
        assert!(told.contains("not the folder of a campaign"), "{told}");
        assert_eq!(room.files("home").len(), 1);
    }
    let room = FURNISHED.copy();
    let told = room.says("run wee.toml --out run/runs/run-1", 2);
    assert!(told.contains("lies among the results"), "{told}");
    let told = room.says("run wee.toml --out camp", 2);
    assert!(told.contains("not the folder of a run"), "{told}");
    let told = room.says("run wee.toml --out new --beds new/beds", 2);
    assert!(told.contains("lies among the results"), "{told}");
}

/// A scenario or campaign that somebody wrote, from one that a command wrote, is not replaced in its own folder.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_copied_scenario_is_not_replaced() {
    let room = FURNISHED.copy();
    for (verb, name) in [
        ("run", "run/scenario.toml"),
        ("sweep", "camp/campaign.toml"),
    ] {
        let file = name.split('/').next_back().unwrap();
        let mut text = room.read(name);
        text.extend(b"# why the friction is 0.5\n");
        room.write(&format!("mine/{verb}/{file}"), text);
        let command = format!("{verb} mine/{verb}/{file} --out mine/{verb}");
        let told = room.says(&command, 2);
        assert!(told.contains("neither as bitgrain writes it"), "{told}");
        assert_eq!(room.files(&format!("mine/{verb}")).len(), 1);
    }
    // A manifest lists the file, and it is another one.
    room.done("run wee.toml --out r --submit slurm --dry-run");
    let mut text = b"# why the friction is 0.5\n".to_vec();
    text.extend(room.read("wee.toml"));
    room.write("r/scenario.toml", &text);
    let told = room.says("run r/scenario.toml --out r", 2);
    assert!(told.contains("neither as bitgrain writes it"), "{told}");
    assert_eq!(room.read("r/scenario.toml"), text);
}

/// What lies in the place of a result or state of any member is refused before a byte of the campaign is written.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_is_refused_as_a_whole() {
    for (manifest, name) in [(true, "latest.safetensors"), (false, "forces.csv")] {
        let room = FURNISHED.copy();
        std::fs::remove_dir_all(room.path("camp/members/mu0.3")).unwrap();
        if !manifest {
            std::fs::remove_file(room.path("camp/members/mu0.5/manifest.json")).unwrap();
        }
        room.write(&format!("camp/members/mu0.5/runs/run-1/{name}"), "mine");
        let before = room.files("camp");
        let told = room.says("sweep weecamp.toml --out camp", 2);
        assert!(told.contains("move it away"), "{told}");
        assert!(room.files("camp") == before, "{name}");
    }
}

/// A drag that begins anew because a state is gone keeps its other files until they are written again.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_drag_that_begins_anew_loses_nothing() {
    let room = FURNISHED.copy();
    std::fs::remove_dir_all(room.path("run/runs/run-1/checkpoints")).unwrap();
    let before = room.files("run/runs/run-1");
    let mut began = room.begin("run --resume run");
    // It is killed as soon as it has begun: the manifest says no more that all is finished.
    while Manifest::of(&room.path("run")).is_ok_and(|it| it.is_some_and(|it| it.finished)) {
        assert!(began.try_wait().unwrap().is_none());
    }
    began.kill().unwrap();
    began.wait().unwrap();
    let after = room.files("run/runs/run-1");
    assert!(before.keys().all(|name| after.contains_key(name)));
    room.done("run --resume run");
    assert!(room.files("run") == FURNISHED.files("run"));
}

/// `bed remove` takes the bed, and leaves foreign files beside it.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_bed_is_removed_without_what_lies_beside_it() {
    let room = FURNISHED.copy();
    let bed = std::fs::read_dir(room.path("beds"))
        .unwrap()
        .next()
        .unwrap();
    let name = bed.unwrap().file_name().into_string().unwrap();
    room.write(&format!("beds/{name}/thesis.tex"), "mine");
    room.write("beds/0123456789abcdef/thesis.tex", "mine");
    let told = room.done("bed remove --all");
    assert!(told.contains("holds other files"), "{told}");
    assert!(told.contains("\n2 bed(s) removed"), "{told}");
    assert_eq!(room.files("beds").len(), 2);
    // What is left is no bed, whatever it is called, and what others put there is not told to be removed as one.
    room.write(&format!("beds/{name}/bed.safetensors"), "mine too");
    assert!(room.done("bed list").starts_with("no beds in"));
    assert!(room.done("bed remove --all").starts_with("0 bed(s)"));
    let told = room.says("run wee.toml --out new", 2);
    assert!(told.contains("move it away"), "{told}");
}

/// With another seed, friction or speed in `scenario.toml` a finished run is refused before a byte of it is
/// written, with its manifest or without.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_changed_scenario_is_refused_before_anything_is_written() {
    for (from, to) in [
        ("mu = 0.5", "mu = 0.4"),
        ("seed = 0", "seed = 2"),
        ("0.6", "0.7"),
    ] {
        for manifest in [true, false] {
            let room = FURNISHED.copy();
            if !manifest {
                std::fs::remove_file(room.path("run/manifest.json")).unwrap();
            }
            room.edit("run/scenario.toml", from, to);
            let before = room.files("run");
            let told = room.says("run --resume run", 2);
            assert!(told.contains("another scenario"), "{told}");
            assert!(
                before == room.files("run"),
                "{from} to {to}, manifest {manifest}"
            );
        }
    }
}

/// A scenario with other spaces and comments is the same.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_space_more_is_no_other_scenario() {
    let room = FURNISHED.copy();
    for name in ["run/scenario.toml", "camp/campaign.toml"] {
        let mut text = room.read(name);
        text.extend(b"\n");
        room.write(name, text);
    }
    room.done("run --resume run");
    room.done("sweep weecamp.toml --out camp");
    assert!(room.files("run") == FURNISHED.files("run"));
    assert!(room.files("camp") == FURNISHED.files("camp"));
}

/// A run that has lost its ends, gained a drag, or has another series, is not verified.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_with_less_or_more_than_it_wrote_does_not_verify() {
    FURNISHED.done("verify run");
    let room = FURNISHED.copy();
    let last = "run/runs/run-1/checkpoints/000000004167.safetensors";
    for name in ["run/summary.json", "run/runs/run-1/summary.json", last] {
        std::fs::remove_file(room.path(name)).unwrap();
    }
    let series = String::from_utf8(room.read("run/runs/run-1/forces.csv")).unwrap();
    let forged = series.lines().map(|line| match line.split_once(',') {
        Some((step, rest)) if step.parse::<u64>().is_ok() => format!("{step},12345,{rest}\n"),
        _ => format!("{line}\n"),
    });
    room.write("run/runs/run-1/forces.csv", forged.collect::<String>());
    let told = room.says("verify run", 3);
    for word in [
        "summary.json is missing",
        "forces.csv has",
        "run-1/summary.json is missing",
    ] {
        assert!(told.contains(word), "{told}");
    }

    let room = FURNISHED.copy();
    std::fs::remove_dir_all(room.path("run/runs/run-2")).unwrap();
    assert!(
        room.says("verify run", 3)
            .contains("runs/run-2/forces.csv is missing")
    );

    let room = FURNISHED.copy();
    bitgrain_tests::wee::copy_all(&room.path("run/runs/run-1"), &room.path("run/runs/run-99"));
    let told = room.says("verify run", 3);
    assert!(told.contains("runs/run-99/forces.csv is extra"), "{told}");

    for (damage, word) in [("", "has no manifest.json"), ("{}", "is damaged")] {
        let room = FURNISHED.copy();
        match damage {
            "" => std::fs::remove_file(room.path("run/manifest.json")).unwrap(),
            text => room.write("run/manifest.json", text),
        }
        let told = room.says("verify run", 3);
        assert!(told.contains(word), "{told}");
    }

    // However much of a run is done, it is not whole.
    let room = FURNISHED.copy();
    room.done("run wee.toml --out part --only run-1");
    let told = room.says("verify part", 3);
    assert!(
        told.contains("unfinished: run-2") && told.contains("is not finished"),
        "{told}"
    );
}

/// A table holds what the members' manifests vouch for, and a campaign verifies as a whole.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_believes_no_edited_member() {
    let want = FURNISHED.files("camp");
    let told = FURNISHED.done("verify camp");
    assert!(
        told.contains("mu0.3: run-2: steps") && told.contains("links of"),
        "{told}"
    );
    FURNISHED.done("verify camp --sample 2");
    let member = "camp/members/mu0.3";
    let edits: [(&str, &str, &str); 5] = [
        ("runs/run-1/summary.json", "\"mean\": ", "\"mean\": 1"),
        ("runs/run-2/forces.csv", "1", "2"),
        ("beds/bed.data", "1", "2"),
        ("runs/run-1/snapshots/grains.000000002084.vtk", "0.5", "0.6"),
        ("scenario.toml", "mu = 0.3", "mu = 0.7"),
    ];
    for (name, from, to) in edits {
        let room = FURNISHED.copy();
        room.edit(&format!("{member}/{name}"), from, to);
        let told = room.says("verify camp --sample 1", 3);
        assert!(told.contains(name), "{told}");
        let before = room.files("camp");
        let out = room.told("sweep weecamp.toml --out camp");
        if out.status.success() {
            assert!(room.files("camp") == want, "{name}");
        } else {
            let told = String::from_utf8_lossy(&out.stderr);
            assert!(told.contains("mu0.3"), "{told}");
            assert!(room.files("camp") == before, "{name}");
        }
    }
    for name in [
        "beds/bed.safetensors",
        "runs/run-1/checkpoints/000000002778.safetensors",
    ] {
        let room = FURNISHED.copy();
        let name = format!("{member}/{name}");
        let mut bytes = room.read(&name);
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        room.write(&name, bytes);
        room.done("sweep weecamp.toml --out camp");
        assert!(room.files("camp") == want, "{name}");
    }
    let room = FURNISHED.copy();
    let text = String::from_utf8(room.read("camp/results.csv")).unwrap();
    let table = CampaignTable::parse(&text, "results.csv").unwrap();
    let drag = table.text(0, "drag");
    room.edit("camp/results.csv", drag, &format!("1{drag}"));
    let told = room.says("verify camp --sample 1", 3);
    assert!(
        told.contains("does not follow from the results of its members"),
        "{told}"
    );
    let told = room.says("analyse camp", 2);
    assert!(told.contains("results.csv"), "{told}");
}

/// A report draws nothing that is not of its run.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_report_mixes_no_runs() {
    let room = FURNISHED.copy();
    room.done("run wee.toml --out other --set seed=2");
    for name in [
        "scenario.toml",
        "runs/run-1/forces.csv",
        "runs/run-2/frames/000000000695.csv",
        "beds/bed.safetensors",
        "summary.json",
    ] {
        let room = room.copy();
        room.write(&format!("run/{name}"), room.read(&format!("other/{name}")));
        let before = room.files("run");
        let told = room.says("report run", 2);
        assert!(told.contains(name), "{told}");
        assert!(room.files("run") == before);
    }
}

/// A bed of the library whose state was changed and sealed again is not used.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_resealed_bed_of_the_library_is_not_used() {
    let room = Room::new(PROGRAM);
    room.done("run wee.toml --out run");
    let bed = std::fs::read_dir(room.path("beds"))
        .unwrap()
        .next()
        .unwrap();
    let path = bed.unwrap().path().join("bed.safetensors");
    let (mut sim, note) = checkpoint::read_noted(&path).unwrap();
    sim.velocity[7][0] += 1e-3;
    std::fs::write(&path, checkpoint::pack(&mut sim, &note).unwrap()).unwrap();
    checkpoint::read_noted(&path).expect("its seal holds");
    let told = room.says("run wee.toml --out new", 2);
    assert!(
        told.contains("not the one that its chain of digests ends with"),
        "{told}"
    );
    assert!(told.contains("bitgrain bed remove"), "{told}");
}

/// A small file that unpacks to more than is read is refused, and more is read if that is asked for.
#[test]
fn what_unpacks_beyond_its_budget_is_refused() {
    let room = Room::new(PROGRAM);
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let zeros = vec![b'0'; 1 << 20];
    for _ in 0..513 {
        gzip.write_all(&zeros).unwrap();
    }
    room.write("big.csv.gz", gzip.finish().unwrap());
    assert!(std::fs::metadata(room.path("big.csv.gz")).unwrap().len() < 4 << 20);
    let told = room.says("analyse big.csv.gz", 2);
    assert!(
        told.contains("more than 512 MiB, unpacked") && told.contains("--max-input"),
        "{told}"
    );
    let told = room.says("analyse big.csv.gz --max-input 600", 2);
    assert!(told.contains("no column `member`"), "{told}");
    let told = room.says("run wee.toml --max-input 0", 2);
    assert!(told.contains("--max-input"), "{told}");
}
