//! The header of the C library is what its sources say.

use bitgrain_tests::root;

#[test]
fn the_c_header_is_up_to_date() {
    let library = root().join("kernel/capi");
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
    // Every function of every file is there, once.
    for file in std::fs::read_dir(library.join("src")).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        for after in text.split("pub extern \"C\" fn ").skip(1) {
            let name = after.split('(').next().unwrap();
            let count = made.matches(&format!(" {name}(")).count()
                + made.matches(&format!("*{name}(")).count();
            assert_eq!(count, 1, "{name}");
        }
    }
}

/// The page for C shows the example that is compiled and run.
#[test]
fn the_page_shows_the_example() {
    let read = |name: &str| std::fs::read_to_string(root().join(name)).unwrap();
    let example = read("kernel/capi/examples/drop.c");
    let page = read("harness/guide/src/c-and-cpp.md");
    assert!(page.contains(&format!("```c\n{example}```")));
}
