//! The header of the library is what its sources say. With `INSTA_UPDATE=always` it is written anew.

use std::path::Path;

#[test]
fn the_header_is_up_to_date() {
    let library = Path::new(env!("CARGO_MANIFEST_DIR"));
    let settings = cbindgen::Config::from_file(library.join("cbindgen.toml")).unwrap();
    let mut made = Vec::new();
    let mut sources = cbindgen::Builder::new().with_config(settings);
    // It follows the modules from there.
    sources = sources.with_src(library.join("src/lib.rs"));
    sources.generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    let path = library.join("include/bitgrain.h");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, &made).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == made,
        "kernel/capi/include/bitgrain.h is not that of the sources: see kernel/capi/cbindgen.toml"
    );
}
