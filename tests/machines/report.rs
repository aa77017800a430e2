//! What is shown of the targets: a row for each, and a table of the firmware.

use super::compare::Difference;
use super::firmware::{Bounds, Image, faults};

/// What came of a target.
pub enum Outcome {
    /// The golden text.
    Same,
    /// Another text, and what the program said besides.
    Different(Difference, String),
    /// These packages are not here.
    Skipped(Vec<&'static str>),
    /// The kernel refuses the machine, as it must.
    Refused,
    /// The negative control's other text.
    Differs(Difference),
    /// It did not build, start or end as it must, and why.
    Failed(String),
}

/// A target's row.
pub struct Row {
    /// The target.
    pub name: &'static str,
    /// What ran it.
    pub ran: String,
    /// The first 16 digits of the last line's digest.
    pub digest: String,
    /// Time to build and run it.
    pub seconds: f64,
    /// What came of it.
    pub outcome: Outcome,
    /// A firmware's image.
    pub firmware: Option<Result<Image, String>>,
}

/// The heading of the rows.
pub fn heading() -> String {
    line("target", "ran by", "seconds", "digest", "outcome")
}

fn line(name: &str, ran: &str, seconds: &str, digest: &str, outcome: &str) -> String {
    format!("{name:<15} {ran:<23} {seconds:>7}  {digest:<16}  {outcome}")
}

impl Row {
    /// Whether the target holds what is asked of it, or could not be tried.
    pub fn is_good(&self) -> bool {
        !matches!(self.outcome, Outcome::Different(..) | Outcome::Failed(_))
    }

    /// Whether it could not be tried.
    pub fn is_skipped(&self) -> bool {
        matches!(self.outcome, Outcome::Skipped(_))
    }

    /// One line, and more where something is wrong.
    pub fn text(&self) -> String {
        let sides = |at: &Difference| {
            let show = |side: &str| match side {
                "" => "nothing".to_string(),
                line => line.to_string(),
            };
            format!(
                "\n    got:      {}\n    expected: {}",
                show(&at.got),
                show(&at.expected)
            )
        };
        let outcome = match &self.outcome {
            Outcome::Same => "same bits".into(),
            Outcome::Refused => "refused, as it must".into(),
            Outcome::Differs(at) => format!("different, as it must (from line {} on)", at.line),
            Outcome::Skipped(packages) => {
                format!("skipped: apt-get install {}", packages.join(" "))
            }
            Outcome::Different(at, errors) => {
                let errors = indented(errors);
                format!("DIFFERENT at line {}:{}{errors}", at.line, sides(at))
            }
            Outcome::Failed(why) => format!("FAILED: {}", indented(why).trim_start()),
        };
        let seconds = match self.is_skipped() {
            true => String::new(),
            false => format!("{:.1}", self.seconds),
        };
        line(self.name, &self.ran, &seconds, &self.digest, &outcome)
    }
}

fn indented(text: &str) -> String {
    let lines = text.trim_end().lines();
    lines.map(|line| format!("\n    {line}")).collect()
}

/// The table of the boards that ran, and whether each keeps its ranges and holds nothing banned.
pub fn firmware(rows: &[Row], golden: &[Bounds]) -> (String, bool) {
    let mut text = String::new();
    let mut good = true;
    for row in rows {
        let found = match &row.firmware {
            None => continue,
            Some(Ok(image)) => {
                let [flash, ram, stack] = image.bytes;
                text += &format!("{:<15} {flash:>8} {ram:>8} {stack:>8}", row.name);
                if image.banned.is_empty() {
                    text += "  cannot panic, allocates nothing, formats no float";
                }
                text += "\n";
                faults(row.name, image, golden)
            }
            Some(Err(why)) => {
                text += &format!("{:<15}\n", row.name);
                vec![why.clone()]
            }
        };
        good &= found.is_empty();
        for fault in found {
            text += &format!("    WRONG: {fault}\n");
        }
    }
    if !text.is_empty() {
        let [flash, ram, stack] = ["flash", "RAM", "stack"];
        let heading = format!("\n{:<15} {flash:>8} {ram:>8} {stack:>8}\n", "board, bytes");
        text.insert_str(0, &heading);
    }
    (text, good)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(outcome: Outcome) -> Row {
        Row {
            name: "s390x",
            ran: "qemu-s390x 7.2".into(),
            digest: "0123456789abcdef".into(),
            seconds: 1.26,
            outcome,
            firmware: None,
        }
    }

    fn at() -> Difference {
        Difference {
            line: 7,
            got: "a".into(),
            expected: String::new(),
        }
    }

    #[test]
    fn rows_say_what_came_of_a_target() {
        let same = row(Outcome::Same);
        let begin = "s390x           qemu-s390x 7.2              1.3  0123456789abcdef  ";
        assert_eq!(same.text(), format!("{begin}same bits"));
        assert_eq!(heading().find("outcome"), same.text().find("same"));
        let told = row(Outcome::Different(at(), "# a panic\n".into())).text();
        let end = "DIFFERENT at line 7:\n    got:      a\n    expected: nothing\n    # a panic";
        assert_eq!(told, format!("{begin}{end}"));
        let told = row(Outcome::Failed("it does not build:\nerror\n".into())).text();
        assert_eq!(
            told,
            format!("{begin}FAILED: it does not build:\n    error")
        );
        let told = row(Outcome::Skipped(vec!["gcc", "make"])).text();
        assert!(told.ends_with("skipped: apt-get install gcc make") && !told.contains("1.3"));
        assert!(
            row(Outcome::Differs(at()))
                .text()
                .ends_with("must (from line 7 on)")
        );
    }

    #[test]
    fn only_what_ran_and_failed_is_bad() {
        for good in [Outcome::Same, Outcome::Refused, Outcome::Differs(at())] {
            assert!(row(good).is_good());
        }
        assert!(row(Outcome::Skipped(vec![])).is_good());
        assert!(!row(Outcome::Different(at(), String::new())).is_good());
        assert!(!row(Outcome::Failed(String::new())).is_good());
    }

    #[test]
    fn boards_are_held_to_their_ranges() {
        let golden = super::super::firmware::bounds(
            "heading\ns390x,flash,1,3\ns390x,ram,1,3\ns390x,stack,1,3",
        );
        let golden = golden.unwrap();
        let board = |bytes| {
            let banned = vec![];
            let firmware = Some(Ok(Image { bytes, banned }));
            [Row {
                firmware,
                ..row(Outcome::Same)
            }]
        };
        let (text, good) = firmware(&board([1, 2, 3]), &golden);
        assert!(
            good && text.contains("\ns390x                  1        2        3  cannot panic"),
            "{text}"
        );
        let (text, good) = firmware(&board([4, 2, 3]), &golden);
        assert!(!good && text.contains("WRONG: flash is 4"), "{text}");
        let broken = [Row {
            firmware: Some(Err("no image".into())),
            ..row(Outcome::Same)
        }];
        assert!(!firmware(&broken, &golden).1);
        assert_eq!(
            firmware(&[row(Outcome::Same)], &golden),
            (String::new(), true)
        );
    }
}
