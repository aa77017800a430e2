//! LAMMPS' drags through beds of 70,000 grains that bitgrain poured (`golden/peers/drag`), against ours through the
//! same beds in the tables of the campaigns.
//!
//! LAMMPS reads a bed without the histories of its contacts: without friction it has none, and both begin from the same
//! state; with friction it begins from one whose tangential forces are let go.

use std::fmt::Write;

use bitgrain::campaign::table::CampaignTable;
use bitgrain_tests::drags::{blocks, series, spread};
use bitgrain_tests::golden;

/// A drag that both did.
struct Both {
    campaign: &'static str,
    member: &'static str,
    run: &'static str,
    series: &'static str,
}

const FAST: [Both; 3] = [
    Both {
        campaign: "kumar-fig-5",
        member: "D4-z13.5",
        run: "run-9",
        series: "bitgrain_D4_mu0.5_Fr5.csv",
    },
    Both {
        campaign: "kumar-fig-5",
        member: "D4-z13.5",
        run: "run-12",
        series: "bitgrain_D4_mu0.5_Fr8.csv",
    },
    Both {
        campaign: "kumar-fig-5",
        member: "D4-z13.5",
        run: "run-14",
        series: "bitgrain_D4_mu0.5_Fr10.csv",
    },
];

const FRICTIONLESS: Both = Both {
    campaign: "kumar-table-1",
    member: "D5-z13.5",
    run: "run-5",
    series: "bitgrain_D5_mu0_Fr1.csv",
};

/// A mean drag and its error.
type Mean = [f64; 2];

impl Both {
    /// The table of the campaign and the row in it.
    fn row(&self) -> (CampaignTable, usize) {
        let table = CampaignTable::read(&golden(self.campaign).join("results.csv.gz")).unwrap();
        let is = |k: &usize| {
            table.text(*k, "member") == self.member && table.text(*k, "run") == self.run
        };
        let row = (0..table.len()).find(is).unwrap();
        (table, row)
    }

    fn froude(&self) -> f64 {
        let (table, row) = self.row();
        table.real(row, "froude").unwrap()
    }

    /// Ours: from the start of the motion, and without what is cut.
    fn ours(&self) -> [Mean; 2] {
        let (table, row) = self.row();
        let of = |column: &str| table.real(row, column).unwrap();
        [
            [of("drag_uncut"), of("drag_uncut_error")],
            [of("drag"), of("drag_error")],
        ]
    }

    /// LAMMPS': each from the means of eight parts of the same path.
    fn theirs(&self) -> [Mean; 2] {
        let (table, row) = self.row();
        let (_, rows) = series(self.series);
        let travel =
            |step: f64| step * table.real(row, "dt").unwrap() * table.real(row, "speed").unwrap();
        let cut = table.real(row, "discard").unwrap();
        [0.0, cut].map(|from| {
            let kept: Vec<f64> = rows
                .iter()
                .filter(|r| travel(r[0]) > from)
                .map(|r| -r[1])
                .collect();
            let (mean, deviation) = spread(&blocks(&kept, 8));
            [mean, deviation / 8f64.sqrt()]
        })
    }
}

/// The heads of LAMMPS' series say what our rows say.
#[test]
fn both_programs_were_asked_the_same() {
    for both in FAST.iter().chain([&FRICTIONLESS]) {
        let (table, row) = both.row();
        let (head, rows) = series(both.series);
        let of = |column: &str| table.real(row, column).unwrap();
        let words = [
            ("D", "diameter"),
            ("mu", "mu"),
            ("Fr", "froude"),
            ("dt", "dt"),
            ("kn", "kn"),
            ("kt", "kt"),
            ("gamma", "gamma_n"),
        ];
        for (word, column) in words {
            let told = head
                .split_whitespace()
                .find_map(|w| w.strip_prefix(&format!("{word}=")));
            assert_eq!(
                told.unwrap().parse::<f64>().unwrap(),
                of(column),
                "{word}: {head}"
            );
        }
        assert_eq!(of("kn"), 2e6);
        let end = rows.last().unwrap()[0];
        // The last row of LAMMPS' series ends at most one row before the drag's end.
        assert!((of("steps") - end).abs() <= rows[0][0], "{end}");
    }
}

/// A line of the guide's table: both with their errors, from the start and without it.
fn line(both: &Both) -> (String, [f64; 2]) {
    let (ours, theirs) = (both.ours(), both.theirs());
    let off = [0, 1].map(|k| (ours[k][0] - theirs[k][0]) / ours[k][1].hypot(theirs[k][1]));
    let (table, row) = both.row();
    let of = |column: &str| table.real(row, column).unwrap();
    let mut text = format!("| {} | {} | {} |", of("mu"), of("diameter"), of("froude"));
    for k in 0..2 {
        let ([l, le], [b, be]) = (theirs[k], ours[k]);
        write!(
            text,
            " {l:.0} ± {le:.0} | {b:.0} ± {be:.0} | {:+.1} σ |",
            off[k]
        )
        .unwrap();
    }
    (text, off)
}

/// Growth of the drag with the Froude number, and its error: a line through drags that weigh by their errors.
fn growth(points: &[(f64, Mean)]) -> Mean {
    let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        points.iter().map(|(x, [y, e])| of(*x, *y) / (e * e)).sum()
    };
    let (w, x, y) = (sum(&|_, _| 1.0), sum(&|x, _| x), sum(&|_, y| y));
    let (xx, xy) = (sum(&|x, _| x * x), sum(&|x, y| x * y));
    let d = w * xx - x * x;
    [(w * xy - x * y) / d, (w / d).sqrt()]
}

fn guide() -> String {
    std::fs::read_to_string(golden("../harness/guide/src/validation.md")).unwrap()
}

/// Each mean within three combined errors, and the growth of the drag above Fr = 5 too: what is not seen of a quadratic
/// regime here is not seen by LAMMPS either.
#[test]
fn fast_drags_agree_with_lammps() {
    let mut table = String::new();
    for both in &FAST {
        let (line, off) = line(both);
        writeln!(table, "{line}").unwrap();
        assert!(off.iter().all(|off| off.abs() < 3.0), "{line}");
    }
    let of = |drags: fn(&Both) -> [Mean; 2], k: usize| {
        growth(&FAST.each_ref().map(|both| (both.froude(), drags(both)[k])))
    };
    let [theirs, ours] = [Both::theirs, Both::ours].map(|drags| [0, 1].map(|k| of(drags, k)));
    for k in 0..2 {
        let off = (ours[k][0] - theirs[k][0]) / ours[k][1].hypot(theirs[k][1]);
        assert!(off.abs() < 3.0, "{off}");
    }
    let told = [theirs[0], ours[0], theirs[1], ours[1]].map(|[m, e]| format!("{m:.0} ± {e:.0}"));
    for words in [&table, &told[0], &told[1], &told[2], &told[3]] {
        assert!(
            guide().contains(words),
            "the guide should say\n{words}\nof\n{table}{told:?}"
        );
    }
}

/// Without friction LAMMPS begins from the same state: over the first diameter of travel the drags are the same but for
/// what chaos has made of the last digits, and the means agree within three combined errors.
#[test]
fn a_frictionless_drag_agrees_with_lammps() {
    let (text, off) = line(&FRICTIONLESS);
    assert!(off.iter().all(|off| off.abs() < 3.0), "{text}");
    assert!(guide().contains(&text), "the guide should say\n{text}");
    let (table, row) = FRICTIONLESS.row();
    let of = |column: &str| table.real(row, column).unwrap();
    let (_, rows) = series(FRICTIONLESS.series);
    let end = 1.0 / (of("dt") * of("speed"));
    let first: Vec<f64> = rows.iter().filter(|r| r[0] <= end).map(|r| -r[1]).collect();
    let (mean, _) = spread(&first);
    let ours = of("drag_travel_1");
    // LAMMPS' rows end a tenth of a row before the diameter does; neighbours differ by a tenth at most.
    assert!((mean / ours - 1.0).abs() < 1e-3, "{mean} {ours}");
}
