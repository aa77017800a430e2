//! Figures in the documents, and in the inputs of the reference codes, are those of the goldens and the code.

use bitgrain::bench::{SOFT_TIME_STEP, soft_law};
use bitgrain::claims::Verdict;
use bitgrain::claims::book::Book;
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

/// The counts of verdicts in the documents are those of the book.
#[test]
fn the_documents_have_the_books_counts() {
    let words = |name: &str| {
        let text = std::fs::read_to_string(root().join(name)).unwrap();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let book = Book::shipped();
    let count = |roots: bool| {
        let own = book.claim.iter();
        let own = own.filter(|c| !roots || c.follows_from.is_empty());
        let all: Vec<Verdict> = own.map(|c| c.verdict()).collect();
        let of = |wanted| all.iter().filter(|v| **v == wanted).count();
        let [a, d, o] = [Verdict::Agrees, Verdict::Disagrees, Verdict::NotResolved].map(of);
        (all.len(), [a, d, o])
    };
    let (all, [agree, disagree, open]) = count(false);
    let (roots, [a, d, o]) = count(true);
    let readme = words("README.md");
    for said in [
        format!(
            "Of {all} claims of the papers (`bitgrain claims`), {agree} agree, {disagree} disagree and {open} are"
        ),
        format!("of the {roots} that follow from no other {a}, {d} and {o}:"),
    ] {
        assert!(readme.contains(&said), "{said}");
    }
    let chapter = words("harness/guide/src/campaigns.md");
    for said in [
        format!("each of {all} claims"),
        format!("{agree} claims agree, {disagree} disagree and {open} are not resolved;"),
        format!("of the {roots} that follow from no other {a} agree, {d} disagree and {o} are not"),
    ] {
        assert!(chapter.contains(&said), "{said}");
    }
    assert!(words("harness/guide/src/validation.md").contains(&format!("holds {all} claims")));
    assert!(words("CHANGELOG.md").contains(&format!("book of {all} claims")));
}

/// The chapter on validation names each claim, and behind each the verdict of the book.
#[test]
fn the_guide_has_the_books_verdicts() {
    let page = std::fs::read_to_string(root().join("harness/guide/src/validation.md")).unwrap();
    let mut wrong = Vec::new();
    for claim in &Book::shipped().claim {
        let words = claim.verdict_words();
        let places: Vec<&str> = page
            .split(&format!("`{}` ", claim.id))
            .skip(1)
            .map(|rest| rest.split([';', '|']).next().unwrap().trim())
            .collect();
        if places.is_empty() || places.iter().any(|said| *said != words) {
            wrong.push(format!("{} {words}: {places:?}", claim.id));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
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
