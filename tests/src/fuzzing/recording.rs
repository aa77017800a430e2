//! The fuzz target `recording`: what is accepted as a recording has one text alone, and frames are as long as they say.

use bitgrain::recording::Recording;
use bitgrain::recording::stream::Frames;
use bitgrain_kernel::record::{Chain, HEAD};

/// Reads bytes as the text of a recording, as they are and with the links that fit them, and as frames; returns whether
/// one of these is sound.
pub fn recording(data: &[u8]) -> bool {
    let text = std::str::from_utf8(data).ok();
    let read = text.is_some_and(is_read);
    let linked = text.is_some_and(|text| is_read(&with_links(text)));
    let mut frames = Frames::new(data, "fuzz");
    let mut count = 0;
    while let Ok(Some(frame)) = frames.next_frame() {
        for array in &frame.arrays {
            let elements: usize = array.shape.iter().product();
            assert_eq!(array.bytes.len(), elements * array.element.size());
        }
        count += 1;
    }
    read || linked || count > 0
}

fn is_read(text: &str) -> bool {
    let Ok(read) = Recording::parse(text, "fuzz") else {
        return false;
    };
    let (again, end) = written(&read);
    let end = if read.closed { end } else { String::new() };
    assert_eq!(again + &end, text, "another text passes for it");
    assert!(read.steps.is_sorted_by(|a, b| a.step < b.step));
    read.lines() > 0
}

/// The text of a recording, written anew, and its end.
fn written(read: &Recording) -> (String, String) {
    let mut chain = Chain::new();
    let mut text = HEAD.to_string();
    for step in &read.steps {
        for item in &step.arrays {
            let line = chain.add_digest(
                step.step,
                &item.name,
                item.element,
                &item.shape,
                &item.digest,
            );
            text += line.expect("it was read").text();
        }
    }
    (text, chain.end().text().to_string())
}

/// The same text with links that are computed as the guide says: a fuzzer finds no hash.
fn with_links(text: &str) -> String {
    let mut link = "0".repeat(64);
    let mut out = String::new();
    for line in text.split_inclusive('\n') {
        match line.rsplit_once(',') {
            Some((row, _)) if row.matches(',').count() == 4 && !row.starts_with("step") => {
                link = blake3_hex(&format!("{link},{row}"));
                out += &format!("{row},{link}\n");
            }
            _ if line.starts_with("# end") => out += &format!("# end {link}\n"),
            _ => out += line,
        }
    }
    out
}

fn blake3_hex(text: &str) -> String {
    let hash = bitgrain_kernel::blake3::Hasher::new().finish_with(text.as_bytes());
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}
