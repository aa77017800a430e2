//! Scenarios whose spheres are dropped, pulled or float, and are wrong.

use bitgrain_tests::{SMALL, golden, output, told};

use crate::PROGRAM;

/// Refusals of spheres that are dropped, pulled or float.
#[test]
fn wrong_motions_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bed.toml");
    let lines = "height = 2.5\nspeed = 1.0";
    let dropped = "motion = \"dropped\"\ndrop_height = 1.0";
    let pulled = "motion = \"pulled\"\nheight = 2.5\nforce = 20.0";
    let floating = "motion = \"floating\"\nheight = 2.5\nspeed = 1.0";
    let (timed, far) = ("duration = 2.0", "distance = 4.0");
    let edits = [
        ("motion = \"thrown\"".to_string(), timed),
        (format!("{lines}\ndrop_height = 1.0"), far),
        (format!("{lines}\nforce = 1.0"), far),
        (format!("{lines}\nspins = true"), far),
        (lines.to_string(), timed),
        ("motion = \"dropped\"".to_string(), timed),
        (dropped.to_string(), far),
        (dropped.to_string(), "dt = 3e-4"),
        (dropped.to_string(), "duration = 1e-3"),
        (dropped.to_string(), "duration = [1.0, 2.0]"),
        (format!("{dropped}\nheight = 3.0"), timed),
        (format!("{dropped}\nspeed = 1.0"), timed),
        (format!("{dropped}\nspins = true"), timed),
        (dropped.replace("1.0", "[]"), timed),
        (dropped.replace("1.0", "-1.0"), timed),
        (dropped.replace("1.0", "1e7"), timed),
        ("motion = \"pulled\"\nheight = 2.5".to_string(), timed),
        (pulled.to_string(), far),
        (format!("{pulled}\nspeed = 1.0"), timed),
        (floating.replace("\nspeed = 1.0", ""), far),
        (format!("{floating}\nrises = true"), far),
        (format!("{floating}\nshape = \"cylinder\""), far),
        (floating.to_string(), "distance = 4.0\nmoves = \"bed\""),
    ];
    let args = ["run", "bed.toml"];
    let mut text = String::new();
    for (intruder, drag) in &edits {
        let small = SMALL.replacen("6.0, 6.0]", "6.0, 8.0]", 1);
        let small = small
            .replacen(lines, intruder, 1)
            .replacen("dt = 3e-4\n", "", 1);
        let drag = if drag.contains("dt") {
            drag.to_string()
        } else {
            format!("dt = 3e-4\n{drag}")
        };
        std::fs::write(&file, small.replacen(far, &drag, 1)).unwrap();
        text.push_str(&format!(
            "# {}; {}\n",
            intruder.replace('\n', "; "),
            drag.replace('\n', "; ")
        ));
        text.push_str(&told(&args, &output(PROGRAM, folder.path(), &args)));
    }
    let low = SMALL.replacen(lines, dropped, 1).replacen(far, timed, 1);
    std::fs::write(&file, low).unwrap();
    text.push_str("# a low box\n");
    text.push_str(&told(&args, &output(PROGRAM, folder.path(), &args)));
    assert_eq!(
        text.matches("[2]\n").count(),
        edits.len() + 1,
        "every one is refused with 2"
    );
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(
        "recipe: `cargo test -p bitgrain-tests --release --test commands releases::`",
    );
    settings.bind(|| insta::assert_snapshot!("releases", text));
}
