//! Folders of results stand alone: no file elsewhere is read because something in them names it.

use bitgrain::manifest::FolderKind;
use bitgrain_tests::wee::forge_manifest;
use bitgrain_tests::{CAMPAIGN, golden, output, small_from_file};

use crate::PROGRAM;

/// The file in a campaign's folder names nothing elsewhere: the base is written out, and of an imported bed the copy
/// in the folder is read.
#[test]
fn a_campaigns_folder_stands_alone() {
    let desk = tempfile::tempdir().unwrap();
    let out = desk.path().join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(
        desk.path().join("secret.toml"),
        "a line that is told = to nobody",
    )
    .unwrap();
    let text = CAMPAIGN.replacen("small.toml", "../secret.toml", 1);
    std::fs::write(out.join("campaign.toml"), text).unwrap();
    let table = "member,run,status,froude,drag,drag_error\n";
    std::fs::write(out.join("results.csv"), table).unwrap();
    let analyse = || {
        forge_manifest(&out, FolderKind::Campaign, &[]);
        let out = output(PROGRAM, desk.path(), &["analyse", "out"]);
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        (out.status.code(), told)
    };
    let (status, told) = analyse();
    assert_eq!(status, Some(2), "{told}");
    assert!(
        told.contains("campaign.toml: `base`") && !told.contains("nobody"),
        "{told}"
    );

    let bed = std::fs::read_to_string(golden("peers/bed200.data")).unwrap();
    let bed = bed.replacen("\n2 3 ", "\n2 2 ", 1);
    std::fs::write(desk.path().join("bed.data"), &bed).unwrap();
    let base = small_from_file("../bed.data", "speed = 1.0\n").replacen("speed = 1.0\n", "", 1);
    let base = format!("[base]\n{}", base.replace("\n[", "\n[base."));
    let campaign = CAMPAIGN.replacen("base = \"small.toml\"\n", "", 1) + &base;
    std::fs::write(out.join("campaign.toml"), campaign).unwrap();
    let (status, told) = analyse();
    assert_eq!(status, Some(2), "{told}");
    assert!(
        told.contains("`bed.file`") && told.contains("bed.data is not there"),
        "{told}"
    );
    for member in ["mu0.1", "mu0.5"] {
        let copies = out.join(format!("members/{member}/beds/imported"));
        std::fs::create_dir_all(&copies).unwrap();
        std::fs::write(copies.join("bed.data"), &bed).unwrap();
    }
    let (status, told) = analyse();
    assert!(!told.contains("`bed.file`"), "{status:?} {told}");
}

/// Files of beds that grids name lie beside the campaign, may have one name, and are taken over again for each member;
/// read from its folder, the campaign names no other file, however the key is written.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn grids_may_name_files_of_beds() {
    let desk = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = desk.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    let does = |args: &[&str]| {
        let out = output(PROGRAM, desk.path(), args);
        let told = String::from_utf8_lossy(&out.stdout) + String::from_utf8_lossy(&out.stderr);
        (out.status.code(), told.into_owned())
    };
    let bed = std::fs::read_to_string(golden("peers/bed200.data")).unwrap();
    let bed = bed.replacen("\n2 3 ", "\n2 2 ", 1);
    write("plans/a/bed.data", &bed);
    write("plans/b/bed.data", &bed.replacen('\n', " again\n", 1));
    write("secret", "a line that is told to nobody\n");
    let base = small_from_file("bed.data", "").replacen("file = \"bed.data\"", "settled = 1e-3", 1);
    let base = base.replacen("distance = 4.0", "distance = 0.4\ndiscard = 0.1", 1);
    let base = format!("[base]\n{}", base.replace("\n[", "\n[base."));
    let grid = |name: &str, file: &str, speed: &str| {
        let set = format!("set = {{ \"bed.file\" = \"{file}/bed.data\", \"measure.every\" = 1 }}");
        format!("[[grid]]\nname = \"{name}\"\n{set}\nspeed = {speed}\n")
    };
    let grids = [
        ("one", "a", "1.0"),
        ("two", "a", "1.2"),
        ("three", "b", "1.0"),
    ];
    let grids: String = grids
        .iter()
        .map(|(name, file, speed)| grid(name, file, speed))
        .collect();
    write(
        "plans/camp.toml",
        &format!("name = \"camp\"\n{base}{grids}"),
    );
    // One that the command line names lies where the command is given.
    write("here.data", &bed);
    let plain = "[[grid]]\nname = \"one\"\nset = { \"measure.every\" = 1 }\nspeed = 1.0\n";
    write(
        "plans/plain.toml",
        &format!("name = \"plain\"\n{base}{plain}"),
    );
    let dry = ["sweep", "plans/plain.toml", "--dry-run", "--set"];
    let (status, told) = does(&[&dry[..], &["bed.file=here.data"]].concat());
    assert_eq!(status, Some(0), "{told}");

    let (status, told) = does(&["sweep", "plans/camp.toml", "--out", "out"]);
    assert_eq!(status, Some(0), "{told}");
    let (status, told) = does(&["verify", "out"]);
    assert_eq!(status, Some(0), "{told}");
    assert_eq!(told.matches("taken over again").count(), 3, "{told}");
    let whole = std::fs::read_to_string(desk.path().join("out/campaign.toml")).unwrap();
    let secret = desk.path().join("secret");
    let secret = secret.to_str().unwrap();
    for key in ["bed.file", " bed.file", "bed .file"] {
        let set = format!("[grid.set]\n\"{key}\" = \"{secret}\"\n");
        let named = whole.replacen("[grid.set]\n\"bed.file\" = \"a/bed.data\"\n", &set, 1);
        assert_ne!(named, whole);
        write("out/campaign.toml", &named);
        let (status, told) = does(&["verify", "out"]);
        assert!(
            status == Some(2) && !told.contains("nobody"),
            "{key}: {told}"
        );
    }
}

/// A run's folder reads no file elsewhere, whatever its scenario names.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_runs_folder_stands_alone() {
    let room = crate::FURNISHED.copy();
    let secret = "a line that is told to nobody\n";
    room.write("secret", secret);
    room.write("run/beds/imported/sub/secret", secret);
    let here = room.path("secret");
    let whole = String::from_utf8(room.read("run/scenario.toml")).unwrap();
    for file in [
        here.to_str().unwrap(),
        "../secret",
        "beds/imported/../../../secret",
        "beds/imported/sub/secret",
        "beds/bed.data",
    ] {
        let named = whole.replacen("[bed]\n", &format!("[bed]\nfile = \"{file}\"\n"), 1);
        assert_ne!(named, whole);
        room.write("run/scenario.toml", named);
        for words in [
            "verify run",
            "run --resume run",
            "replay run --stage run-1 --steps 1",
        ] {
            let told = room.says(words, 2);
            assert!(!told.contains("nobody"), "{words}: {told}");
        }
    }
}
