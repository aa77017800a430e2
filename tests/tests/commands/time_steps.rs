//! Time steps that are too long, as the command says or refuses them.

use crate::cli::{CASE, bitgrain};

/// Above a fifth of the Rayleigh time, or a tenth of a collision, there is a warning; above one Rayleigh time the case
/// is refused, unless that is asked for by its name.
#[test]
fn a_long_time_step_of_a_case_is_said_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.json");
    let replayed = |from: &str, to: &str, more: &[&str]| {
        assert!(CASE.contains(from));
        std::fs::write(&file, CASE.replacen(from, to, 1)).unwrap();
        let args = [&["replay", "case.json", "--steps", "2"], more].concat();
        let out = bitgrain(folder.path(), &args);
        let said = String::from_utf8(out.stderr).unwrap();
        let lines = out.stdout.iter().filter(|&&b| b == b'\n').count();
        (out.status.code(), said, lines)
    };
    let dt = "\"dt\": 2e-4";
    let (status, said, lines) = replayed(dt, dt, &[]);
    assert_eq!((status, said.as_str(), lines), (Some(0), "", 2));
    let (status, said, lines) = replayed(dt, "\"dt\": 2e-3", &[]);
    assert_eq!((status, lines), (Some(0), 2), "{said}");
    let warned = "warning: case.json: `dt`: is 0.002, 0.380 of the shortest Rayleigh time";
    assert!(said.contains(warned), "{said}");
    let (status, said, lines) = replayed(dt, "\"dt\": 6e-3", &[]);
    assert_eq!((status, lines), (Some(2), 0), "{said}");
    assert!(
        said.contains("1.139 of") && said.contains("--beyond-rayleigh"),
        "{said}"
    );
    let (status, said, lines) = replayed(dt, "\"dt\": 6e-3", &["--beyond-rayleigh"]);
    assert_eq!((status, lines), (Some(0), 2), "{said}");
    assert!(said.contains("warning: case.json"), "{said}");
    // A free body that is light enough has a shorter Rayleigh time than any grain.
    let walls = "\"normal\": [0, 0, 1]}";
    let ball = r#"{"shape": "sphere", "center": [4, 4, 6], "diameter": 1, "density": 1e-4, "motion": "free"}"#;
    let (status, said, _) = replayed(walls, &format!("{walls}, {ball}"), &[]);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("shortest Rayleigh time"), "{said}");
    let fast = "\"position\": [1, 2, 3], \"velocity\": [0, 0, 160]";
    std::fs::write(&file, CASE.replacen(dt, "\"dt\": 9e-4", 1)).unwrap();
    let slow = bitgrain(folder.path(), &["replay", "case.json", "--steps", "1"]);
    assert!(slow.stderr.is_empty());
    let fast = CASE
        .replacen("\"position\": [1, 2, 3]", fast, 1)
        .replacen(dt, "\"dt\": 9e-4", 1);
    std::fs::write(&file, fast).unwrap();
    let out = bitgrain(folder.path(), &["replay", "case.json", "--steps", "1"]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(
        out.status.success() && said.contains("of the shortest collision"),
        "{said}"
    );
}
