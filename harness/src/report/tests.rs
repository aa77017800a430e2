//! What the page promises, on made-up numbers.

use super::*;
use crate::blocks::Mean;
use crate::units::Units;

fn mean(mean: f64, standard_error: f64) -> Mean {
    Mean {
        mean,
        standard_error,
        ..Mean::default()
    }
}

fn bed(x: f64) -> BedSummary {
    BedSummary {
        name: "bed".into(),
        grains: 12_345,
        frozen: 3,
        steps: 1_000_000,
        surface: x,
        depth: x,
        packing_fraction: x,
        coordination_number: x,
        overlap_max: x,
        kinetic_energy_over_weight_d: x,
        weight: x,
        support: x,
        digest: "0123abcd".into(),
    }
}

pub fn run(x: f64) -> RunSummary {
    RunSummary {
        name: "fr".into(),
        bed: "bed".into(),
        froude: x,
        speed: x,
        diameter: x,
        depth: x,
        distance: x,
        steps: 7,
        window_start: x,
        window_end: x,
        window_steps: 5,
        drag: mean(x, x),
        lift: mean(x, x),
        side: mean(-x, x),
        contacts: mean(x, x),
        contact_angle: Some(mean(x, x)),
        coordination: None,
        drag_uncut: x,
        plug_ratio: x,
        digest: "89ef".into(),
        digest_parts: vec![("grains".into(), "4567".into())],
    }
}

/// One bed and two drags, all of whose measured numbers are `x`.
fn summary(x: f64) -> Summary {
    Summary {
        version: "1.2.3".into(),
        bits_version: 9,
        scenario: "a <b> & c".into(),
        units: Units {
            length: "d".into(),
            time: "sqrt(d/g)".into(),
            speed: "sqrt(g d)".into(),
            force: "rho d^3 g".into(),
            torque: "rho d^4 g".into(),
            energy: "rho d^4 g".into(),
        },
        inputs: crate::scenario::load("quick", &[]).unwrap(),
        standard_error_method: String::new(),
        beds: vec![bed(x)],
        runs: vec![run(x), run(x)],
    }
}

fn series(x: f64) -> Vec<Vec<SeriesRow>> {
    let row = |k: u64| SeriesRow {
        step: k,
        time: x * k as f64,
        distance: x * k as f64,
        force_mean: [x * (k % 7) as f64, 0.0, 0.0],
        ..SeriesRow::default()
    };
    vec![(1..2000).map(row).collect(), Vec::new()]
}

fn picture(x: f64) -> BedPicture {
    let grain = |z| PictureGrain {
        position: [2.0, 3.0, z],
        radius: 0.5,
        frozen: z < 1.0,
    };
    BedPicture {
        name: "bed".into(),
        lo: [0.0; 3],
        hi: [10.0; 3],
        surface: x,
        grains: vec![grain(0.5), grain(1.5), grain(x)],
        intruder: ([5.0, 3.0, 4.0], 1.0),
    }
}

fn flow(x: f64) -> FlowPicture {
    let grain = |z| FlowGrain {
        position: [2.0, 3.0, z],
        radius: 0.5,
        velocity: [x, 0.0, z],
        frozen: z < 1.0,
    };
    FlowPicture {
        run: "fr".into(),
        froude: x,
        speed: 2.0,
        travel: x,
        lo: [0.0; 3],
        hi: [10.0; 3],
        intruder: ([5.0, 3.0, 4.0], 1.0),
        grains: vec![grain(0.5), grain(1.5), grain(x)],
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let make = || {
        page(
            &summary(0.5),
            "a = 1",
            &series(0.1),
            &[picture(5.0)],
            &[flow(5.0)],
        )
    };
    assert_eq!(make(), make());
}

#[test]
fn the_page_is_self_contained_small_and_complete() {
    let text = page(
        &summary(0.5),
        "a = 1",
        &series(0.1),
        &[picture(5.0)],
        &[flow(5.0)],
    );
    assert!(!text.contains("http") && !text.contains("<script") && !text.contains("src="));
    assert!(text.len() < 200_000, "{}", text.len());
    let parts = ["0123abcd", "89ef", "4567", "1.2.3", "value=\"12345\""];
    assert!(parts.iter().all(|part| text.contains(part)));
}

#[test]
fn nothing_in_the_text_is_taken_for_html() {
    let text = page(&summary(0.5), "x = \"<script>&\"", &[], &[], &[]);
    assert!(text.contains("x = &quot;&lt;script&gt;&amp;&quot;"));
    assert!(text.contains("a &lt;b&gt; &amp; c") && !text.contains("a <b>"));
}

#[test]
fn what_is_no_number_is_a_dash() {
    for x in [f64::NAN, f64::INFINITY, -0.0, 1e-300, 1e300] {
        let text = page(&summary(x), "", &series(x), &[picture(x)], &[flow(x)]);
        assert!(
            !text.contains("NaN") && !text.contains("inf"),
            "{x}: {text}"
        );
    }
}

#[test]
fn a_page_of_nothing_is_a_page() {
    let mut empty = summary(1.0);
    page(&empty, "", &[], &[], &[]);
    empty.runs.clear();
    page(&empty, "", &[], &[], &[]);
    empty.beds.clear();
    assert!(page(&empty, "", &[], &[], &[]).ends_with("</html>\n"));
}

#[test]
fn runs_without_a_picture_of_their_grains_are_named() {
    let mut two = summary(0.5);
    two.runs[1].name = "other".into();
    let text = page(&two, "", &[], &[], &[flow(5.0)]);
    assert_eq!(text.matches("class=\"flow\"").count(), 1);
    assert!(text.contains("No picture of other."));
    assert!(page(&two, "", &[], &[], &[]).contains("No run has a picture of its grains."));
}
