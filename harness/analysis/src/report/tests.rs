//! Properties of the page, on made-up numbers.

use super::*;
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::simulation::Role;
use bitgrain_sim::units::Units;

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
        chain: String::new(),
        digest: "0123abcd".into(),
        rig: None,
    }
}

pub fn run(x: f64) -> DragSummary {
    DragSummary {
        tank: None,
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
        new_contact_angle: Some(mean(x, x)),
        floating: None,
        kappa: Some(x),
        kappa_error: Some(x),
        moving: None,
        drift: Some(mean(x, x)),
        coordination: None,
        drag_uncut: x,
        drag_uncut_error: None,
        drag_by_travel: vec![],
        reaches: vec![],
        large_overlaps: None,
        plug_ratio: x,
        plug: bitgrain_lab::plug_flow::PlugFlow::Sound,
        coordination_shares: vec![],
        released: None,
        flow: None,
        overlap_max: 0.01,
        energy: None,
        chain: String::new(),
        digest: "89ef".into(),
        digest_parts: vec![("grains".into(), "4567".into())],
    }
}

/// One bed and two drags, all of whose measured numbers are `x`.
pub fn summary(x: f64) -> Summary {
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
        inputs: bitgrain_lab::scenario::load("quick", &[]).unwrap(),
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
        role: if z < 1.0 { Role::Base } else { Role::Free },
    };
    BedPicture {
        name: "bed".into(),
        lo: [0.0; 3],
        hi: [10.0; 3],
        surface: x,
        grains: vec![grain(0.5), grain(1.5), grain(x)],
        intruder: ([5.0, 3.0, 4.0], 1.0),
        half_length: None,
        moves: Moves::Intruder,
        arrow: true,
    }
}

/// Three frames of one grain.
fn film(x: f64) -> Film {
    let frame = |step: u64| bitgrain_lab::frames::Frame {
        step,
        travel: step as f64,
        cuts: vec![bitgrain_lab::frames::Slice {
            x,
            z: 0.5,
            radius: 0.4,
            u: 0.1,
            w: 0.1,
            speed: 0.2,
            role: Role::Free,
        }],
    };
    Film {
        run: "fr".into(),
        radius: 1.0,
        floor: 4.0,
        moves: Moves::Intruder,
        frames: (1..4).map(frame).collect(),
    }
}

fn drawn<'a>(
    series: &'a [Vec<SeriesRow>],
    beds: &'a [BedPicture],
    flows: &'a [FlowPicture],
    films: &'a [Film],
) -> Drawings<'a> {
    Drawings {
        series,
        beds,
        flows,
        films,
        ..Drawings::default()
    }
}

fn flow(x: f64) -> FlowPicture {
    let grain = |z| FlowGrain {
        position: [2.0, 3.0, z],
        radius: 0.5,
        velocity: [x, 0.0, z],
        role: if z < 1.0 { Role::Base } else { Role::Free },
    };
    FlowPicture {
        run: "fr".into(),
        froude: x,
        speed: 2.0,
        travel: x,
        lo: [0.0; 3],
        hi: [10.0; 3],
        intruder: ([5.0, 3.0, 4.0], 1.0),
        reach: 7.0,
        moves: Moves::Intruder,
        grains: vec![grain(0.5), grain(1.5), grain(x)],
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let make = || {
        page(
            &summary(0.5),
            "a = 1",
            &drawn(&series(0.1), &[picture(5.0)], &[flow(5.0)], &[film(1.0)]),
        )
    };
    assert_eq!(make(), make());
}

#[test]
fn the_page_is_self_contained_small_and_complete() {
    let text = page(
        &summary(0.5),
        "a = 1",
        &drawn(&series(0.1), &[picture(5.0)], &[flow(5.0)], &[film(1.0)]),
    );
    assert!(!text.contains("http") && !text.contains("src=") && !text.contains("import"));
    assert_eq!(text.matches("<figure class=\"played").count(), 2);
    assert!(text.len() < 200_000, "{}", text.len());
    let parts = ["0123abcd", "89ef", "4567", "1.2.3", "value=\"12345\""];
    assert!(parts.iter().all(|part| text.contains(part)));
}

/// A page that has nothing to play but its bed has the script too.
#[test]
fn what_can_be_played_has_its_script() {
    let plays = |beds: &[BedPicture]| {
        let page = page(&summary(0.5), "a = 1", &drawn(&[], beds, &[], &[]));
        (
            page.contains("<figure class=\"played"),
            page.contains("\"use strict\""),
        )
    };
    assert_eq!(plays(&[picture(5.0)]), (true, true));
    assert_eq!(plays(&[]), (false, false));
}

#[test]
fn nothing_in_the_text_is_taken_for_html() {
    let text = page(&summary(0.5), "x = \"<script>&\"", &Drawings::default());
    assert!(text.contains("x = &quot;&lt;script&gt;&amp;&quot;"));
    assert!(text.contains("a &lt;b&gt; &amp; c") && !text.contains("a <b>"));
}

#[test]
fn what_is_no_number_is_a_dash() {
    for x in [f64::NAN, f64::INFINITY, -0.0, 1e-300, 1e300] {
        let text = page(
            &summary(x),
            "",
            &drawn(&series(x), &[picture(x)], &[flow(x)], &[film(x)]),
        );
        assert!(
            !text.contains("NaN") && !text.contains("inf"),
            "{x}: {text}"
        );
    }
}

#[test]
fn a_page_of_nothing_is_a_page() {
    let mut empty = summary(1.0);
    page(&empty, "", &Drawings::default());
    empty.runs.clear();
    page(&empty, "", &Drawings::default());
    empty.beds.clear();
    assert!(page(&empty, "", &Drawings::default()).ends_with("</html>\n"));
}

#[test]
fn runs_without_a_picture_of_their_grains_are_named() {
    let mut two = summary(0.5);
    two.runs[1].name = "other".into();
    let text = page(&two, "", &drawn(&[], &[], &[flow(5.0)], &[]));
    assert_eq!(text.matches("class=\"flow\"").count(), 1);
    assert!(text.contains("No picture of other."));
    assert!(page(&two, "", &Drawings::default()).contains("No run has a picture of its grains."));
}

/// A page of flowing beds as [`crate::claims`] makes them up, with one picture of each kind.
fn flowing(change: impl Fn(&mut Summary)) -> String {
    flowing_of(&Default::default(), change)
}

fn flowing_of(asked: &crate::claims::synthetic::Asked, change: impl Fn(&mut Summary)) -> String {
    let mut whole = crate::claims::synthetic::summary(asked);
    change(&mut whole);
    let mut picture = picture(5.0);
    picture.name = whole.beds[0].name.clone();
    picture.moves = Moves::Bed;
    picture.grains[2].role = Role::Lid;
    let mut flow = flow(5.0);
    flow.run = whole.runs[0].name.clone();
    flow.moves = Moves::Bed;
    let row = |k: u32| bitgrain_lab::flow::FlowRow {
        distance: f64::from(k),
        packing: 0.6,
        pressure: 2.0,
        drag: 1.0,
        ..bitgrain_lab::flow::FlowRow::default()
    };
    let course = FlowSeries {
        rows: (1..30).map(row).collect(),
        profile: vec![(0.0, 1.0, 0.99), (1.0, 2.0, 0.98)],
    };
    let text = whole.inputs.to_toml();
    flowing_page(
        &whole,
        &text,
        &Drawings {
            courses: &[course],
            ..drawn(&series(0.1), &[picture], &[flow], &[])
        },
    )
}

#[test]
fn a_flowing_bed_has_a_page_of_its_own() {
    let page = flowing(|_| ());
    let parts = [
        "Drag and lift on a cylinder in a flowing bed",
        ">Beside the paper</h2>",
        "C<sub>d</sub>&nbsp;=&nbsp;10",
        "<b>agrees</b>",
        "86162",
        "D of the cylinder",
        "through the bed moves to the left",
        "Carried by the lid",
    ];
    for part in parts {
        assert!(page.contains(part), "{part}");
    }
    for part in [
        "Froude",
        "Plug ratio",
        "of a sphere",
        "NaN",
        "http",
        "did not converge.</b>",
    ] {
        let inputs = page.find("id=\"inputs\"").unwrap();
        assert!(!page[..inputs].contains(part), "{part}");
    }
    assert_eq!(page, flowing(|_| ()));
}

/// Means over the seeds stand over both pressures, and lifts by the place of the axis.
#[test]
fn means_over_the_seeds_have_both_pressures_and_the_places() {
    let asked = crate::claims::synthetic::Asked {
        heights: vec![0.024, 0.03],
        depths: vec![0.099],
        change: |flow| flow.pressure_measured = 0.8 * flow.pressure,
        ..Default::default()
    };
    let page = flowing_of(&asked, |_| ());
    let from = page.find(">Means over the seeds</h2>").unwrap();
    let part = &page[from..from + page[from..].find("</section>").unwrap()];
    assert_eq!(part.matches("scope=\"rowgroup\"").count(), 2, "{part}");
    assert_eq!(part.matches("scope=\"row\"").count(), 4);
    for cell in [
        "4.848&nbsp;D above",
        ">7.273</td>",
        "<td>10.00",
        "<td>12.50",
    ] {
        assert!(part.contains(cell), "{cell}: {part}");
    }
    // One place alone needs no name in captions.
    assert!(page.contains(", axis 6.061&nbsp;D above the floor, without pressure"));
    let one = flowing(|_| ());
    assert!(!one.contains("above the floor, without pressure"));
    let cell = |name: &str| {
        let row = page.find(&format!("<b>{name}</b>")).unwrap();
        let cell = page[row..].find("<td>").unwrap() + row + 4;
        page[cell..cell + page[cell..].find("</td>").unwrap()].to_owned()
    };
    // Of the settled beds the weight of the synthetic ones is rho g h~.
    let pressure = 1500.0 * 9.81 * 0.099;
    assert!(cell("Pressure").contains(&bitgrain_sim::format::number(pressure)));
    assert!(cell("Drag coefficient of the weight").starts_with("12.75"));
    assert!(cell("Drag coefficient").starts_with("10.20"));
}

#[test]
fn what_spoils_a_flowing_bed_is_remarked_on() {
    let page = flowing(|whole| {
        let flow = whole.runs[2].flow.as_mut().unwrap();
        (flow.far_field, flow.packing_fraction, flow.floating) = (0.9, 0.65, 3);
    });
    for part in [
        "The bed slips",
        "The bed crystallises",
        "Grains above the lid",
    ] {
        assert!(page.contains(&format!("<b>{part}.</b>")), "{part}");
    }
}

#[test]
fn a_flowing_page_of_nothing_is_a_page() {
    let page = |whole: &Summary| flowing_page(whole, "", &Drawings::default());
    let mut whole = crate::claims::synthetic::summary(&Default::default());
    assert!(page(&whole).contains("No series of the flow."));
    for run in &mut whole.runs {
        run.drag.mean = f64::NAN;
        run.flow.as_mut().unwrap().lift_over_buoyancy = f64::INFINITY;
    }
    let text = page(&whole);
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    whole.runs.clear();
    whole.beds.clear();
    assert!(page(&whole).ends_with("</html>\n"));
}
