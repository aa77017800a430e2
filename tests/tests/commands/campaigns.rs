//! Campaigns that are wrong, and their messages.

use std::fmt::Write;

use bitgrain_tests::{CAMPAIGN, CampaignDesk, golden, output, results, told};

use crate::PROGRAM;

/// Campaigns that are refused before anything is begun, by what is wrong with them.
fn wrong() -> Vec<(&'static str, String)> {
    let grid = |lines: &str| CAMPAIGN.replace("mu = [0.1, 0.5]\nspeed = [1.0, 2.0]", lines);
    vec![
        ("an axis without values", grid("mu = []\nspeed = 1.0")),
        ("a value twice", grid("mu = [0.1, 0.1]\nspeed = 1.0")),
        (
            "speeds and Froude numbers",
            grid("speed = 1.0\nfroude = 1.0"),
        ),
        ("depth and height", grid("depth = 2.0\nheight = 2.0")),
        (
            "damping twice",
            grid("gamma_n = 800.0\n\"gamma_n/kn^0.6\" = 0.5"),
        ),
        (
            "an axis that is set too",
            grid("height = 2.0").replace("\"bed.settled\" = 1e-2", "\"intruder.height\" = 2.0"),
        ),
        (
            "damping that is kept",
            grid("gamma_n = [800.0, 900.0]\nkeep = [\"gamma_n/kn^0.6\"]"),
        ),
        ("a misspelt axis", grid("mus = [0.1]")),
        ("a misspelt rule", grid("mu = 0.1\nkeep = [\"kt/km\"]")),
        (
            "a misspelt key that is set",
            grid("mu = 0.1").replace("bed.settled", "bed.setled"),
        ),
        ("an impossible value", grid("mu = [0.1, -0.5]\nspeed = 1.0")),
        (
            "two grids that differ",
            CAMPAIGN.to_string()
                + "\n[[grid]]\nname = \"other\"\nmu = 0.5\nspeed = 3.0\n\
                   set = { \"bed.settled\" = 1e-3, \"measure.every\" = 10 }\n",
        ),
        (
            "two distances for one run",
            CAMPAIGN.to_string()
                + &CAMPAIGN[CAMPAIGN.find("[[grid]]").unwrap()..]
                    .replace("speed = [1.0, 2.0]", "speed = 2.0\ndistance = 3.0"),
        ),
        (
            "no grid",
            CAMPAIGN[..CAMPAIGN.find("[[grid]]").unwrap()].to_string(),
        ),
        ("no base", CAMPAIGN.replace("small.toml", "smal.toml")),
        (
            "a name that is no folder's",
            CAMPAIGN.replace("\"camp\"", "\"../camp\""),
        ),
        ("no TOML", "name = \n".to_string()),
    ]
}

/// The message on each kind of wrong campaign, for review.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn wrong_campaigns_are_told_what_is_wrong() {
    let desk = CampaignDesk::new(PROGRAM, CAMPAIGN);
    let mut text = String::new();
    for (name, campaign) in wrong() {
        desk.write("camp.toml", &campaign);
        let args = ["sweep", "camp.toml"];
        let out = desk.sweep(&[]);
        assert_eq!(
            out.status.code(),
            Some(2),
            "{name}: {}",
            String::from_utf8_lossy(&out.stderr)
        );
        write!(text, "# {name}\n{}", told(&args, &out)).unwrap();
        assert!(!desk.out().exists(), "{name}: nothing was begun");
    }
    let out = output(PROGRAM, desk.folder.path(), &["sweep", "kumar-smal"]);
    write!(
        text,
        "# a misspelt name\n{}",
        told(&["sweep", "kumar-smal"], &out)
    )
    .unwrap();
    desk.write("camp.toml", CAMPAIGN);
    let args = ["sweep", "camp.toml", "--only", "mu0.5/run-3"];
    write!(
        text,
        "# a run that is not there\n{}",
        told(&args, &desk.sweep(&args[2..]))
    )
    .unwrap();
    assert!(!desk.out().exists());
    // Changed after the campaign has begun.
    desk.write(
        "camp.toml",
        &CAMPAIGN.replace("mu = [0.1, 0.5]", "mu = 0.5"),
    );
    desk.done(&[]);
    let changed = CAMPAIGN.replace("speed = [1.0, 2.0]", "speed = [1.0, 2.5]");
    desk.write(
        "camp.toml",
        &changed.replace("\"measure.every\" = 20", "\"measure.every\" = 25"),
    );
    let before = results(&desk.out());
    let out = desk.sweep(&[]);
    assert_eq!(out.status.code(), Some(2));
    write!(
        text,
        "# changed under a campaign\n{}",
        told(&["sweep", "camp.toml"], &out)
    )
    .unwrap();
    assert!(results(&desk.out()) == before);
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("campaigns", text));
}
