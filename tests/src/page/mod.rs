//! The live page as one file: put together from its sources and from what is kept packed in it, and taken apart again.

use std::fmt::Write as _;
use std::io::{Read, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use bitgrain::replay::Digests;
use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;

use crate::root;

pub mod start;

/// The page, from the repository's root.
pub const PAGE: &str = "harness/page/bitgrain.html";

/// Scripts in the order in which they stand in the page; the first one reports have too.
const SCRIPTS: [&str; 7] = [
    "analysis/src/report/viewer.js",
    "page/page/module.js",
    "page/page/cases.js",
    "page/page/chart.js",
    "page/page/picture.js",
    "page/page/main.js",
    "page/page/controls.js",
];

/// What a page keeps beside its scripts, in its order; all but the last is packed.
pub const PARTS: [&str; 6] = [
    "module-plain",
    "module-wide",
    "bed-ball",
    "bed-cylinder",
    "notices-packed",
    "digests",
];

/// Steps of the beds at which the page knows the digests of the command, and up to which.
pub const KNOWN: [u64; 2] = [500, 10_000];

fn source(name: &str) -> String {
    let path = root().join("harness").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The page around the texts of its parts.
pub fn assembled(parts: &[String; 6]) -> String {
    let mut data = String::new();
    for (name, text) in PARTS.iter().zip(parts) {
        let kind = if *name == "digests" {
            "application/json"
        } else {
            "text/plain"
        };
        let _ = writeln!(
            data,
            "<script type=\"{kind}\" id=\"{name}\">{text}</script>"
        );
    }
    let scripts = SCRIPTS.map(source).concat();
    // Each script asks for the strict rules; the page asks once, and keeps their names to itself.
    let scripts = scripts.replace("\"use strict\";\n", "");
    let style = source("page/page/page.css");
    let page = source("page/page/page.html");
    page.replace("<!-- STYLE -->\n", &style)
        .replace("<!-- DATA -->\n", &data)
        .replace(
            "<!-- SCRIPT -->\n",
            &format!("\"use strict\";\n{{\n{scripts}}}\n"),
        )
}

/// The texts of the parts of a page.
///
/// # Panics
/// If it is no such page.
pub fn parts(page: &str) -> [String; 6] {
    PARTS.map(|name| {
        let begin = format!("id=\"{name}\">");
        let (_, rest) = page.split_once(&begin).expect("a part of the page");
        rest.split_once("</script>").expect("its end").0.to_string()
    })
}

/// Bytes as a part.
pub fn packed(bytes: &[u8]) -> String {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).expect("memory takes it");
    STANDARD.encode(encoder.finish().expect("memory takes it"))
}

/// The bytes of a part.
///
/// # Panics
/// If it was not packed.
pub fn unpacked(part: &str) -> Vec<u8> {
    let bytes = STANDARD.decode(part).expect("letters of base 64");
    let mut out = Vec::new();
    DeflateDecoder::new(&bytes[..])
        .read_to_end(&mut out)
        .expect("what was packed");
    out
}

/// What `bitgrain replay CASE --digests` prints of the beds in `cases`, as the page keeps it.
///
/// # Panics
/// If a case is refused.
pub fn known_digests(cases: &[String; 2]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let lines = start::BODIES.iter().zip(cases).map(|(kind, text)| {
        let path = folder.path().join("case.json");
        std::fs::write(&path, text).expect("room for a case");
        let what = bitgrain::replay::Replay {
            steps: KNOWN[1],
            every: KNOWN[0],
            contacts: false,
            energy: false,
            digests: true,
            vtk: None,
            beyond_rayleigh: false,
        };
        let mut out = Vec::new();
        let progress = bitgrain::progress::Progress::new(false);
        bitgrain::replay::replay(&path, &what, &progress, &mut out).expect("a sound case");
        let lines = out
            .split(|byte| *byte == b'\n')
            .filter(|line| !line.is_empty());
        let read = |line| serde_json::from_slice::<Digests>(line).expect("a line of digests");
        let kept = lines.map(read).map(|of| {
            let Digests { step, digest, .. } = of;
            serde_json::json!({"step": step, "digest": digest})
        });
        (kind.to_string(), serde_json::Value::from_iter(kept))
    });
    serde_json::Value::Object(lines.collect()).to_string()
}
