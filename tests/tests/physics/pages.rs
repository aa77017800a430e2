//! The pages of tables and summaries that ship draw our points on the laws of the papers.

use bitgrain::claims::evidence::Evidence;
use bitgrain::report::campaign_page;
use bitgrain_tests::golden;

fn page(of: &str) -> String {
    campaign_page(&Evidence::read(&golden(of), false).unwrap())
}

/// A page of a cylinder or a bar has Guillard's laws, and none of Kumar's, which are of spheres.
#[test]
fn pages_of_cylinders_and_bars_have_guillards_laws() {
    let cylinder = [
        ">Drag and lift against depth</h2>",
        "Thin line: C<sub>d</sub>&nbsp;=&nbsp;10, as in the paper.",
        "Thin line: 30, as in the paper",
        ">Load on the cylinder</h2>",
    ];
    let bar = [
        ">Bars in tanks: drag and lift against depth</h2>",
        "Line: 13, as in",
    ];
    let pages = [
        ("guillard-medium/summary.json.gz", &cylinder[..], 10),
        ("guillard-deep/summary.json.gz", &cylinder[..], 4),
        ("guillard-tanks/results.csv.gz", &bar[..], 2),
    ];
    for (of, parts, charts) in pages {
        let page = page(of);
        for part in parts
            .iter()
            .chain(&[">Beside the paper</h2>", ">The runs</h2>"])
        {
            assert!(page.contains(part), "{of}: {part}");
        }
        let drawn = page.matches("<svg class=\"chart\"").count();
        assert!(drawn >= charts, "{of}: {drawn}");
        for part in ["Round the intruder", "Every fit", "NaN"] {
            assert!(!page.contains(part), "{of}: {part}");
        }
    }
}

/// The page of Fig. 5 has eq. 9 through the drags that it is of: with friction and nothing cut.
#[test]
fn the_page_of_fig_5_has_eq_9() {
    let law = "law (eq. 9) through these points";
    assert_eq!(page("kumar-fig-5/results.csv.gz").matches(law).count(), 2);
    assert!(!page("kumar-table-1/results.csv.gz").contains(law));
}
