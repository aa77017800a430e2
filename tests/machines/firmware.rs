//! A firmware's image: what it takes of flash and RAM, and what it must not hold.

use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf};

/// Parts of the names of functions that firmware must do without, and why.
const BANNED: &[(&str, &str)] = &[
    ("panicking", "can panic"),
    ("rust_begin_unwind", "can panic"),
    ("unwrap_failed", "can panic"),
    ("expect_failed", "can panic"),
    ("index_fail", "can panic"),
    ("len_fail", "can panic"),
    ("len_mismatch_fail", "can panic"),
    ("flt2dec", "formats floats"),
    ("grisu", "formats floats"),
    ("dragon", "formats floats"),
    ("float_to_", "formats floats"),
    ("3fmt5float", "formats floats"),
    ("__rust_alloc", "allocates"),
    ("__rg_alloc", "allocates"),
    ("malloc", "allocates"),
];

/// What a board has of each, in the order of the table.
pub const QUANTITIES: [&str; 3] = ["flash", "ram", "stack"];

/// What an image takes and holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Bytes of flash, static RAM and stack, as in [`QUANTITIES`].
    pub bytes: [u64; 3],
    /// Symbols that must not be there, each with the reason.
    pub banned: Vec<String>,
}

/// A golden range, both ends included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Name of the target.
    pub board: String,
    /// One of [`QUANTITIES`].
    pub what: String,
    /// Fewest bytes.
    pub least: u64,
    /// Most bytes.
    pub most: u64,
}

/// Measures an image and the stack that its output tells of.
///
/// # Errors
/// What is wrong with the file, or that the output tells of no stack.
pub fn inspect(program: &Path, output: &str, no_floats: bool) -> Result<Image, String> {
    let bytes = std::fs::read(program).map_err(|why| format!("no image: {why}"))?;
    let (flash, ram) = sizes(&bytes)?;
    let names = symbols(&bytes)?;
    let mut banned = banned(&names);
    if no_floats {
        let floats = names.iter().filter(|name| is_soft_float(name));
        banned.extend(floats.map(|name| format!("computes with floats: {name}")));
        banned.extend(float_instructions(&bytes)?);
    }
    Ok(Image {
        bytes: [flash, ram, stack(output)?],
        banned,
    })
}

/// Whether a symbol is one of the compiler's functions for floats, by the names of ARM's ABI or those of its own.
fn is_soft_float(name: &str) -> bool {
    let begins = ["d", "f", "i2", "ui2", "l2", "ul2"].map(|rest| format!("__aeabi_{rest}"));
    let ends = [
        "df2", "sf2", "df3", "sf3", "sidf", "sisf", "didf", "disf", "dfsi", "sfsi", "dfdi", "sfdi",
    ];
    let ours = name.starts_with("__") && ends.iter().any(|end| name.ends_with(end));
    begins.iter().any(|begin| name.starts_with(begin)) || ours || name.contains("4libm")
}

/// Thumb instructions of the floating-point coprocessors, 10 and 11, in the code of an image; where code and data are
/// the image's mapping symbols say.
fn float_instructions(bytes: &[u8]) -> Result<Vec<String>, String> {
    let file = parse(bytes)?;
    let mut marks: Vec<(u64, bool)> = Vec::new();
    for symbol in file.symbols() {
        match symbol.name().unwrap_or_default() {
            name if name.starts_with("$t") => marks.push((symbol.address(), true)),
            name if name.starts_with("$d") => marks.push((symbol.address(), false)),
            _ => {}
        }
    }
    marks.sort_unstable();
    let (mut found, mut read) = (Vec::new(), 0);
    for section in file.sections().filter(|s| s.kind() == SectionKind::Text) {
        let data = section.data().map_err(|why| why.to_string())?;
        let half = |at: usize| {
            data.get(at..at + 2)
                .map(|two| u16::from_le_bytes([two[0], two[1]]))
        };
        let mut at = 0;
        while let Some(first) = half(at) {
            let place = section.address() + at as u64;
            let mark = marks.partition_point(|(from, _)| *from <= place);
            let code = mark.checked_sub(1).is_some_and(|mark| marks[mark].1);
            let is_long = first >> 11 >= 0b11101;
            if !code || !is_long {
                at += 2;
                read += usize::from(code);
                continue;
            }
            let second = half(at + 2).unwrap_or(0);
            if first & 0xec00 == 0xec00 && matches!(second >> 8 & 15, 10 | 11) {
                found.push(format!(
                    "computes with floats: {first:04x} {second:04x} at {place:#x}"
                ));
            }
            at += 4;
            read += 1;
        }
    }
    match read > 1000 {
        true => Ok(found),
        false => Err(format!("only {read} instructions were found in the image")),
    }
}

fn parse(bytes: &[u8]) -> Result<object::File<'_>, String> {
    object::File::parse(bytes).map_err(|why| format!("no ELF file: {why}"))
}

/// Bytes of flash and of static RAM. Initialised data takes both: it is copied at the start.
fn sizes(bytes: &[u8]) -> Result<(u64, u64), String> {
    let (mut flash, mut ram) = (0, 0);
    for section in parse(bytes)?.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        let has = |flag: u32| sh_flags & u64::from(flag) != 0;
        if has(elf::SHF_ALLOC) && has(elf::SHF_WRITE) {
            ram += section.size();
        }
        if has(elf::SHF_ALLOC) && section.kind() != SectionKind::UninitializedData {
            flash += section.size();
        }
    }
    Ok((flash, ram))
}

fn symbols(bytes: &[u8]) -> Result<Vec<String>, String> {
    let file = parse(bytes)?;
    let names = file.symbols().filter_map(|symbol| symbol.name().ok());
    let names: Vec<String> = names.map(str::to_string).collect();
    // A stripped image would hold nothing that is banned, whatever it does.
    if !names.iter().any(|name| name == "Reset") {
        return Err("the image has no symbols".into());
    }
    Ok(names)
}

/// Symbols that a library takes from elsewhere, and those that it offers.
///
/// # Errors
/// What is wrong with the file, or that it exports nothing.
pub fn asked_and_offered(library: &[u8]) -> Result<[Vec<String>; 2], String> {
    let file = parse(library)?;
    let (asked, given): (Vec<_>, Vec<_>) = file.dynamic_symbols().partition(|s| s.is_undefined());
    if given.is_empty() {
        return Err("the library exports nothing".into());
    }
    Ok([asked, given].map(|symbols| {
        let names = symbols.iter().filter_map(|symbol| symbol.name().ok());
        names.map(str::to_string).collect()
    }))
}

fn banned(names: &[String]) -> Vec<String> {
    let why = |name: &String| {
        let found = BANNED.iter().find(|(part, _)| name.contains(part));
        found.map(|(_, why)| format!("{why}: {name}"))
    };
    names.iter().filter_map(why).collect()
}

/// `# stack BYTES of BYTES` in a firmware's output: the deepest that it has been.
fn stack(output: &str) -> Result<u64, String> {
    let line = output
        .lines()
        .find_map(|line| line.strip_prefix("# stack "));
    let line = line.ok_or("it tells of no stack")?;
    let numbers = line.split_once(" of ");
    let parsed: Option<(u64, u64)> =
        numbers.and_then(|(deep, all)| Some((deep.parse().ok()?, all.parse().ok()?)));
    match parsed {
        Some((deep, all)) if deep < all => Ok(deep),
        Some((deep, _)) => Err(format!("all {deep} bytes of the stack were used")),
        None => Err(format!("no stack in `{line}`")),
    }
}

/// Reads the golden ranges, `board,what,least,most` under a heading.
///
/// # Errors
/// The line that is none.
pub fn bounds(text: &str) -> Result<Vec<Bounds>, String> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [board, what, least, most] = cells[..] else {
            return None;
        };
        QUANTITIES.contains(&what).then_some(())?;
        Some(Bounds {
            board: board.into(),
            what: what.into(),
            least: least.parse().ok()?,
            most: most.parse().ok()?,
        })
    };
    let rows = text.lines().skip(1);
    let read = rows.map(|line| row(line).ok_or_else(|| format!("no range in `{line}`")));
    read.collect()
}

/// What is wrong with an image: what is out of its range, with the line that would allow it and a
/// tenth more or less, and what it must not hold.
pub fn faults(board: &str, image: &Image, golden: &[Bounds]) -> Vec<String> {
    let mut found = Vec::new();
    for (what, &bytes) in QUANTITIES.iter().zip(&image.bytes) {
        let range = golden.iter().find(|b| b.board == board && b.what == *what);
        let held = range.is_some_and(|b| (b.least..=b.most).contains(&bytes));
        if !held {
            let told = range.map_or("no range".into(), |b| format!("{} to {}", b.least, b.most));
            let (least, most) = (bytes - bytes / 10, bytes + bytes / 10);
            found.push(format!(
                "{what} is {bytes} and golden/firmware.csv has {told}; `{board},{what},{least},{most}` would hold it"
            ));
        }
    }
    found.extend(image.banned.iter().cloned());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stack_is_read() {
        assert_eq!(stack("a\n# stack 12 of 40\n"), Ok(12));
        for (output, told) in [
            ("a\n", "it tells of no stack"),
            ("# stack 40 of 40\n", "all 40 bytes of the stack were used"),
            ("# stack twelve of 40\n", "no stack in `twelve of 40`"),
            ("# stack 12\n", "no stack in `12`"),
        ] {
            assert_eq!(stack(output).err().unwrap(), told);
        }
    }

    #[test]
    fn ranges_are_read_and_held() {
        let golden = bounds("board,what,least,most\nb,flash,90,110\nb,ram,5,5\n").unwrap();
        for wrong in ["b,flash,1", "b,flash,1,2,3", "b,height,1,2", "b,ram,1,x"] {
            assert!(bounds(&format!("heading\n{wrong}\n")).is_err());
        }
        let image = |bytes, banned| Image { bytes, banned };
        let told = faults("b", &image([110, 5, 7], vec![]), &golden);
        assert_eq!(
            told,
            ["stack is 7 and golden/firmware.csv has no range; `b,stack,7,7` would hold it"]
        );
        let told = faults(
            "b",
            &image([111, 4, 7], vec!["can panic: x".into()]),
            &golden,
        );
        assert!(
            told[0].starts_with(
                "flash is 111 and golden/firmware.csv has 90 to 110; `b,flash,100,122`"
            )
        );
        assert!(told[1].starts_with("ram is 4 ") && told[3] == "can panic: x");
        assert_eq!(faults("c", &image([1; 3], vec![]), &golden).len(), 3);
    }

    #[test]
    fn banned_symbols_are_found() {
        let names = [
            "_RNvNtCs1_4core9panicking9panic_fmt",
            "_ZN4core9panicking18panic_bounds_check17h0123456789abcdefE",
            "_RNvCs2_7___rustc17rust_begin_unwind",
            "_RNvNtCs1_4core6option13unwrap_failed",
            "_RNvNtNtCs1_4core5slice5index16slice_index_fail",
            "_RNvNtNtNtNtCs1_4core3num7flt2dec8strategy5grisu12format_exact",
            "_RNvNtNtCs1_4core3fmt5float29float_to_decimal_common_exact",
            "__rust_alloc",
        ];
        let sound = [
            "Reset",
            "_RNvNtCs1_15bitgrain_kernel6motion5blame",
            "__adddf3",
        ];
        let all = |names: &[&str]| names.iter().map(|n| n.to_string()).collect::<Vec<_>>();
        assert_eq!(banned(&all(&names)).len(), names.len());
        assert!(banned(&all(&sound)).is_empty());
    }

    /// Sizes and symbols of a program that is certainly here: this test.
    #[test]
    fn an_image_is_measured() {
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let (flash, ram) = sizes(&own).unwrap();
        let whole = own.len() as u64;
        assert!(flash > 100_000 && flash < whole, "{flash} of {whole}");
        assert!(ram > 1000 && ram < flash, "{ram}");
        assert!(symbols(&own).unwrap_err().contains("no symbols"));
        assert!(sizes(b"no image").is_err() && sizes(&own[..1000]).is_err());
    }
}
