//! Writes the live page from its sources and two builds of its module, without and with 128-bit instructions:
//! `harness/page/build` calls it. Without arguments it puts new scripts around the modules that the page has.

use bitgrain_tests::notices;
use bitgrain_tests::page::{PAGE, assembled, known_digests, packed, parts, start};
use bitgrain_tests::root;

fn main() -> std::io::Result<()> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let file = root().join(PAGE);
    let parts = match &files[..] {
        [] => parts(&std::fs::read_to_string(&file)?),
        [plain, wide] => {
            let text = |kind| serde_json::to_string(&start::start(kind)).expect("a case is text");
            let beds = start::BODIES.map(text);
            [
                packed(&std::fs::read(plain)?),
                packed(&std::fs::read(wide)?),
                packed(beds[0].as_bytes()),
                packed(beds[1].as_bytes()),
                packed(&std::fs::read(root().join(notices::PAGE.file))?),
                known_digests(&beds),
            ]
        }
        _ => {
            eprintln!(
                "expected two files, the module without and with 128-bit instructions, or none"
            );
            std::process::exit(2);
        }
    };
    let page = assembled(&parts);
    println!("{PAGE}: {} bytes", page.len());
    std::fs::write(file, page)
}
