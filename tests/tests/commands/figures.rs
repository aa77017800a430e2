//! Figures in the documents, and in the inputs of the reference codes, are those of the goldens and the code.

use bitgrain::bench::{SOFT_TIME_STEP, soft_law};
use bitgrain_tests::{golden, hertz_history, root};

/// The guide states the reference digest and sizes of firmware that lie within the golden ranges.
#[test]
fn the_guide_has_the_goldens_numbers() {
    let page =
        |name: &str| std::fs::read_to_string(root().join("harness/guide/src").join(name)).unwrap();
    let readme = page("determinism.md") + &page("embedding.md");
    let lines = std::fs::read_to_string(golden("digests/reference.snap.txt")).unwrap();
    let digest = lines.split_whitespace().last().unwrap();
    assert!(readme.contains(&format!("`{digest}`")), "{digest}");
    let ranges = std::fs::read_to_string(golden("firmware.csv")).unwrap();
    for (board, row) in [
        ("cortex-m4f", "| Cortex-M4F | "),
        ("cortex-m0", "| Cortex-M0 | "),
    ] {
        let row = readme.lines().find(|line| line.starts_with(row)).unwrap();
        let cells = row
            .split('|')
            .skip(2)
            .map(|cell| cell.trim().replace(',', ""));
        let told: Vec<u32> = cells.filter_map(|cell| cell.parse().ok()).collect();
        let held = ranges
            .lines()
            .filter(|line| line.starts_with(&format!("{board},")));
        let held: Vec<(u32, u32)> = held
            .map(|line| {
                let mut words = line.split(',').skip(2).map(|word| word.parse().unwrap());
                (words.next().unwrap(), words.next().unwrap())
            })
            .collect();
        assert_eq!((told.len(), held.len()), (3, 3), "{row}");
        let within = told
            .iter()
            .zip(&held)
            .all(|(t, (least, most))| least <= t && t <= most);
        assert!(within, "{row} in {held:?}");
    }
}

/// The reference codes are timed under the law and the time step that `bitgrain bench` uses.
#[test]
fn the_peers_inputs_have_our_numbers() {
    let [kn, kt, gamma_n, gamma_t, mu] = hertz_history(&soft_law());
    assert_eq!((kn, kt, mu), (2e5, 1.225 * 2e5, 0.5));
    // The same power, but for how it was rounded.
    let gamma = 50000.0 * (kn / 2e8f64).powf(0.6);
    assert!([gamma_n, gamma_t].map(|g| (g / gamma - 1.0).abs() < 1e-15) == [true; 2]);
    let lammps = std::fs::read_to_string(golden("peers/speed.lmp")).unwrap();
    for line in [
        "variable    kn equal 2.0e5",
        "variable    kt equal 1.225*${kn}",
        "variable    gamma equal 50000.0*(${kn}/2.0e8)^0.6",
        "gran/hertz/history ${kn} ${kt} ${gamma} ${gamma} 0.5 1",
    ] {
        assert!(lammps.contains(line), "{line}");
    }
    let liggghts = std::fs::read_to_string(golden("peers/speed.liggghts")).unwrap();
    let material = |name: &str| -> f64 {
        let line = liggghts.lines().find(|line| line.contains(name)).unwrap();
        let mut words = line
            .split_whitespace()
            .skip_while(|word| *word != "peratomtype");
        words.nth(1).unwrap().parse().unwrap()
    };
    // K_n = (2/3) E / (1 - nu^2), and K_t / K_n = 3 (1 - nu) / (2 - nu), within 1 %.
    let (young, poisson) = (material("youngsModulus"), material("poissonsRatio"));
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
    assert!(near(2.0 / 3.0 * young / (1.0 - poisson * poisson), kn));
    assert!(near(3.0 * (1.0 - poisson) / (2.0 - poisson), kt / kn));
    for input in [lammps, liggghts] {
        assert!(input.contains("timestep    1.5e-4"));
    }
    assert_eq!(SOFT_TIME_STEP, 1.5e-4);
}
