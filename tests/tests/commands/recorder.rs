//! Recordings, written and read again, and spoilt.

use std::path::Path;

use bitgrain::error::Result;
use bitgrain::recording::array::{Element, little_endian};
use bitgrain::recording::parting::Parting;
use bitgrain::recording::read::{ARRAYS, FILE, Recorded};
use bitgrain::recording::{Array, ArrayRef, Keep, Recorder, Recording, part};

fn array(name: &str, shape: &[usize], numbers: &[f64]) -> Array {
    Array {
        name: name.into(),
        element: Element::F64,
        shape: shape.to_vec(),
        bytes: little_endian(numbers),
    }
}

/// The arrays of a step of an orbit; `nudge` is added to one number from step 3 on.
fn orbit(step: u64, nudge: f64) -> Vec<Array> {
    let x = step as f64;
    let nudge = if step < 3 { 0.0 } else { nudge };
    vec![
        array("positions", &[2, 2], &[x, 1.0 / (x + 1.0), -x, 0.1 + nudge]),
        array("time", &[], &[0.01 * x]),
    ]
}

fn write(folder: &Path, keep: Keep, steps: impl Iterator<Item = (u64, Vec<Array>)>) -> Recorded {
    let mut recorder = Recorder::create(folder, keep).unwrap();
    for (step, arrays) in steps {
        record(&mut recorder, step, &arrays).unwrap();
    }
    let link = recorder.close().unwrap();
    let read = Recorded::open(folder).unwrap();
    assert_eq!((&read.recording.link, read.recording.closed), (&link, true));
    read
}

fn record(recorder: &mut Recorder, step: u64, arrays: &[Array]) -> Result<()> {
    let lent: Vec<(&str, ArrayRef<'_>)> = arrays.iter().map(|a| (&a.name[..], a.lent())).collect();
    recorder.record(step, &lent)
}

fn orbits(nudge: f64) -> impl Iterator<Item = (u64, Vec<Array>)> {
    (0..6).map(move |step| (step, orbit(step, nudge)))
}

fn parting(a: &Recorded, b: &Recorded) -> (Option<Parting>, String) {
    let mut said = String::new();
    let parting = part(&[a.clone(), b.clone()], false, |line| {
        said += line;
        Ok(())
    });
    (parting.unwrap(), said)
}

#[test]
fn arrays_read_back_as_they_were_kept() {
    let room = tempfile::tempdir().unwrap();
    for keep in [
        Keep::Digests,
        Keep::All,
        Keep::Every(2),
        Keep::Last(2),
        Keep::Range(1, 3),
    ] {
        let read = write(
            &room.path().join(keep.to_string().replace(':', "-")),
            keep,
            orbits(0.0),
        );
        let kept: Vec<u64> = (0..6)
            .filter(|step| {
                let step = &read.recording.steps[*step as usize];
                let arrays = read.arrays(step).unwrap();
                assert!(
                    arrays
                        .as_ref()
                        .is_none_or(|arrays| *arrays == orbit(step.step, 0.0))
                );
                arrays.is_some()
            })
            .collect();
        let wanted: &[u64] = match keep {
            Keep::Digests => &[],
            Keep::All => &[0, 1, 2, 3, 4, 5],
            Keep::Every(_) => &[0, 2, 4],
            Keep::Last(_) => &[4, 5],
            Keep::Range(..) => &[1, 2, 3],
        };
        assert_eq!(kept, wanted, "{keep}");
    }
}

/// Every element type is written and read, with the bits that it had.
#[test]
fn every_type_reads_back() {
    let room = tempfile::tempdir().unwrap();
    let arrays = Element::ALL.map(|element| Array {
        name: element.name().into(),
        element,
        shape: vec![3, 1],
        bytes: (0..3 * element.size())
            .map(|k| {
                if element == Element::Bool {
                    1
                } else {
                    250 - k as u8
                }
            })
            .collect(),
    });
    let read = write(
        &room.path().join("all"),
        Keep::All,
        [(9, arrays.to_vec())].into_iter(),
    );
    assert_eq!(
        read.arrays(&read.recording.steps[0]).unwrap().unwrap(),
        arrays
    );
}

/// Every bit counts, of the lines and of the arrays; and no line can be taken away without notice but those at the end.
#[test]
fn every_flipped_bit_is_seen() {
    let room = tempfile::tempdir().unwrap();
    let folder = room.path().join("it");
    let read = write(&folder, Keep::Last(1), orbits(0.0));
    let text = std::fs::read_to_string(folder.join(FILE)).unwrap();
    for at in 0..text.len() {
        for bit in 0..8 {
            let mut bytes = text.clone().into_bytes();
            bytes[at] ^= 1 << bit;
            let Ok(flipped) = String::from_utf8(bytes) else {
                continue;
            };
            let told = Recording::parse(&flipped, "it").unwrap_err().to_string();
            // The line with the bit is named; that after it if the bit ended or joined lines.
            let line = text[..at].matches('\n').count() + 1;
            let named = [line, line + 1]
                .iter()
                .any(|line| told.starts_with(&format!("it:{line}: ")));
            assert!(named, "byte {at}, bit {bit}: {told}");
        }
    }
    let path = folder.join(ARRAYS).join("000000000005.safetensors");
    let bytes = std::fs::read(&path).unwrap();
    for at in 0..8 * bytes.len() {
        let mut flipped = bytes.clone();
        flipped[at / 8] ^= 1 << (at % 8);
        std::fs::write(&path, flipped).unwrap();
        assert!(read.arrays(&read.recording.steps[5]).is_err(), "bit {at}");
    }
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    assert!(read.arrays(&read.recording.steps[5]).is_err());
}

#[test]
fn missing_lines_and_cuts_are_seen() {
    let room = tempfile::tempdir().unwrap();
    let folder = room.path().join("it");
    write(&folder, Keep::Digests, orbits(0.0));
    let text = std::fs::read_to_string(folder.join(FILE)).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    for gone in 0..lines.len() - 1 {
        let kept = lines.iter().enumerate().filter(|(k, _)| *k != gone);
        let kept: String = kept.map(|(_, line)| *line).collect();
        let told = Recording::parse(&kept, "it").unwrap_err().to_string();
        assert!(
            told.starts_with(&format!("it:{}: ", gone + 1)),
            "{gone}: {told}"
        );
    }
    for cut in 0..text.len() {
        let cut_text = &text[..cut];
        match Recording::parse(cut_text, "it") {
            // Whole lines are what a program that was stopped leaves.
            Ok(read) => assert!(cut_text.ends_with('\n') && !read.closed, "{cut}"),
            Err(e) => {
                let whole = cut_text.ends_with('\n') && cut_text.lines().count() >= 2;
                assert!(!whole, "{cut}: {e}");
            }
        }
    }
    let twice = format!("{text}{}", lines[2]);
    assert!(
        Recording::parse(&twice, "it")
            .unwrap_err()
            .to_string()
            .contains("follows the end")
    );
}

#[test]
fn equal_recordings_do_not_part() {
    let room = tempfile::tempdir().unwrap();
    let one = write(&room.path().join("one"), Keep::All, orbits(0.0));
    let other = write(&room.path().join("other"), Keep::Digests, orbits(0.0));
    assert_eq!(parting(&one, &other), (None, String::new()));
    assert_eq!(one.recording.link, other.recording.link);
}

/// One bit of one number, in any place and of any kind, is found where it is.
#[test]
fn every_bit_that_differs_is_found() {
    let room = tempfile::tempdir().unwrap();
    let bits = [
        0,
        1,
        0x8000_0000_0000_0000,
        0x7ff8_0000_0000_0000,
        0x7ff0_0000_0000_0001,
        0xfff8_0000_0000_0000,
    ];
    let state = |bits: &[u64]| {
        let bytes = bits.iter().flat_map(|word| word.to_le_bytes()).collect();
        [("x".to_string(), bytes)].map(|(name, bytes): (_, Vec<u8>)| Array {
            name,
            element: Element::F64,
            shape: vec![3, 2],
            bytes,
        })
    };
    let steps = |flip: Option<(usize, u32)>| {
        [
            (0, state(&bits).to_vec()),
            (7, {
                let mut bits = bits;
                if let Some((place, bit)) = flip {
                    bits[place] ^= 1 << bit;
                }
                state(&bits).to_vec()
            }),
        ]
        .into_iter()
    };
    let one = write(&room.path().join("one"), Keep::All, steps(None));
    for place in 0..6 {
        for bit in 0..64 {
            let folder = room.path().join("other");
            let other = write(&folder, Keep::All, steps(Some((place, bit))));
            let found = parting(&one, &other).0.unwrap();
            assert_eq!((found.equal, found.step), (Some(0), 7));
            let told = found.to_string();
            let index = format!("x[{}, {}]: ", place / 2, place % 2);
            let one_bit = format!("bits: one differs, bit {bit}");
            assert!(told.contains(&index) && told.contains(&one_bit), "{told}");
            assert!(told.contains("elements: 1 of 6 differ"), "{told}");
            std::fs::remove_dir_all(&folder).unwrap();
        }
    }
}

#[test]
fn what_was_not_kept_is_asked_for() {
    let room = tempfile::tempdir().unwrap();
    let one = write(&room.path().join("one"), Keep::All, orbits(0.0));
    let other = write(&room.path().join("other"), Keep::Digests, orbits(1e-16));
    let told = parting(&one, &other).0.unwrap().to_string();
    let begins =
        "the same to step 2, different at step 3\n  arrays: positions\n  the second did not keep";
    assert!(
        told.starts_with(begins) && told.contains("--keep 3-3,"),
        "{told}"
    );
    let every = |step: &(u64, Vec<Array>)| step.0.is_multiple_of(4);
    let rare = [0.0, 1e-16].map(|nudge| {
        write(
            &room.path().join(nudge.to_string()),
            Keep::Digests,
            orbits(nudge).filter(every),
        )
    });
    let told = parting(&rare[0], &rare[1]).0.unwrap().to_string();
    assert!(
        told.contains("neither kept") && told.contains("--keep 1-4, with every step between"),
        "{told}"
    );
}

#[test]
fn other_shapes_arrays_and_steps_are_named() {
    let room = tempfile::tempdir().unwrap();
    let base = write(&room.path().join("base"), Keep::All, orbits(0.0));
    let against = |name: &str, change: &dyn Fn(u64, &mut Vec<Array>)| {
        let steps = orbits(0.0).map(|(step, mut arrays)| {
            change(step, &mut arrays);
            (step, arrays)
        });
        let other = write(&room.path().join(name), Keep::All, steps);
        parting(&base, &other).0.map(|parting| parting.to_string())
    };
    let shape = against("shape", &|_, arrays| arrays[0].shape = vec![4, 1]).unwrap();
    assert_eq!(
        shape,
        "different from the beginning, step 0\n  arrays: positions\n  positions: f64 2x2 against f64 4x1"
    );
    let kind = against("kind", &|step, arrays| {
        if step == 5 {
            arrays[1].element = Element::I64;
        }
    });
    let kind = kind.unwrap();
    assert!(
        kind.ends_with(
            "step 5\n  arrays: time\n  time: f64, a single number against i64, a single number"
        ),
        "{kind}"
    );
    let gone = against("gone", &|_, arrays| drop(arrays.remove(0))).unwrap();
    assert!(
        gone.ends_with("arrays: positions\n  positions: only the first has it"),
        "{gone}"
    );
    let more = against("more", &|_, arrays| {
        arrays.push(array("spins", &[1], &[0.0]))
    })
    .unwrap();
    assert!(
        more.ends_with("arrays: spins\n  spins: only the second has it"),
        "{more}"
    );
    // Their order is no difference.
    assert_eq!(against("order", &|_, arrays| arrays.reverse()), None);

    let even = write(
        &room.path().join("even"),
        Keep::All,
        orbits(0.0).filter(|(step, _)| step % 2 == 0),
    );
    let told = |a, b| parting(a, b).0.unwrap().to_string();
    assert_eq!(
        told(&base, &even),
        "the same to step 0: the first goes on with step 1, the second goes on with step 2"
    );
    let late = write(
        &room.path().join("late"),
        Keep::All,
        orbits(0.0).map(|(step, arrays)| (step + 10, arrays)),
    );
    assert_eq!(
        told(&base, &late),
        "different from the beginning: the first begins with step 0, the second begins with step 10"
    );
}

/// That one may end before the other lets it leave out no step; of nothing nothing is compared.
#[test]
fn a_beginning_has_every_step() {
    let room = tempfile::tempdir().unwrap();
    let [base, gap, none] = ["012345", "013", ""].map(|steps| {
        let kept = orbits(0.0).filter(|(step, _)| steps.contains(&step.to_string()));
        write(&room.path().join(format!("of{steps}")), Keep::All, kept)
    });
    let part = |a: &Recorded, b: &Recorded| part(&[a.clone(), b.clone()], true, |_| Ok(()));
    assert_eq!(part(&base, &gap).unwrap().unwrap().step, 2);
    for (a, b) in [(&none, &none), (&base, &none), (&none, &base)] {
        let told = part(a, b).unwrap_err().to_string();
        assert!(
            told.contains("no element of a step of it was compared"),
            "{told}"
        );
    }
}

/// A program that is killed leaves a recording without an end, whose last step may lack arrays.
#[test]
fn a_recording_without_an_end_is_compared_to_its_last_whole_step() {
    let room = tempfile::tempdir().unwrap();
    let base = write(&room.path().join("base"), Keep::All, orbits(0.0));
    let folder = room.path().join("killed");
    let mut recorder = Recorder::create(&folder, Keep::All).unwrap();
    for (step, arrays) in orbits(0.0).take(3) {
        record(&mut recorder, step, &arrays).unwrap();
    }
    record(&mut recorder, 3, &orbit(3, 0.0)[..1]).unwrap();
    assert_eq!(recorder.last(), Some(3));
    drop(recorder);
    let killed = Recorded::open(&folder).unwrap();
    let (found, said) = parting(&base, &killed);
    assert!(said.starts_with("the second has no end"), "{said}");
    assert!(said.contains("its last step, 3, is not compared"), "{said}");
    let cut = "the first goes on with step 3, the second was cut off after step 2";
    assert_eq!(
        found.unwrap().to_string(),
        format!("the same to step 2: {cut}")
    );
    assert_eq!(
        part(&[base, killed.clone()], true, |_| Ok(())).unwrap(),
        None
    );
    // Nor is it the whole of itself.
    let told = parting(&killed, &killed).0.unwrap().to_string();
    assert!(
        told.contains("the second was cut off after step 2"),
        "{told}"
    );
}

/// What is refused leaves the recording as it was, and it goes on.
#[test]
fn what_cannot_be_recorded_is_refused() {
    let room = tempfile::tempdir().unwrap();
    let folder = room.path().join("it");
    let mut recorder = Recorder::create(&folder, Keep::All).unwrap();
    record(&mut recorder, 5, &orbit(5, 0.0)).unwrap();
    let mut refused = |step: u64, arrays: &[Array], why: &str| {
        let told = record(&mut recorder, step, arrays).unwrap_err();
        assert_eq!(told.exit_status(), 2);
        assert!(told.to_string().contains(why), "{told}");
    };
    refused(5, &orbit(5, 0.0), "step 5 does not come after step 5");
    refused(6, &[], "step 6 has no array");
    refused(
        6,
        &[array("x", &[1], &[0.0]), array("x", &[1], &[0.0])],
        "two arrays of the name `x`",
    );
    refused(
        6,
        &[array("time", &[1], &[0.0]), array("a b", &[1], &[0.0])],
        "array `a b` of step 6: the name of an array",
    );
    refused(
        6,
        &[array("x", &[3], &[0.0])],
        "has 8 bytes, and by its type and shape 24",
    );
    refused(6, &[array("x", &[1; 9], &[0.0])], "more than 8 axes");
    record(&mut recorder, 6, &orbit(6, 0.0)).unwrap();
    recorder.close().unwrap();
    assert_eq!(Recorded::open(&folder).unwrap().recording.lines(), 4);
    let told = Recorder::create(&folder, Keep::All)
        .err()
        .unwrap()
        .to_string();
    assert!(told.contains("has a recording already"), "{told}");
    let told = Recorder::create(&room.path().join("no"), Keep::Last(0))
        .err()
        .unwrap()
        .to_string();
    assert!(
        told.contains("at least 1") && !room.path().join("no").exists(),
        "{told}"
    );
}
