//! The header of the C library names its functions; that it is made of its sources, word for word, is tested beside
//! them (`.ci/run c`).

use bitgrain_tests::root;

/// Every function of every file is there, once.
#[test]
fn the_c_header_has_every_function() {
    let library = root().join("kernel/capi");
    let header = std::fs::read_to_string(library.join("include/bitgrain.h")).unwrap();
    let mut count = 0;
    for file in std::fs::read_dir(library.join("src")).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        for after in text.split("pub extern \"C\" fn ").skip(1) {
            let name = after.split('(').next().unwrap();
            let times = header.matches(&format!(" {name}(")).count()
                + header.matches(&format!("*{name}(")).count();
            assert_eq!(times, 1, "{name}");
            count += 1;
        }
    }
    let declares = |line: &&str| {
        line.starts_with(char::is_alphabetic) && !line.starts_with("typedef") && line.contains('(')
    };
    assert_eq!(header.lines().filter(declares).count(), count);
}

/// The page for C shows the example that is compiled and run.
#[test]
fn the_page_shows_the_example() {
    let read = |name: &str| std::fs::read_to_string(root().join(name)).unwrap();
    let example = read("kernel/capi/examples/drop.c");
    let page = read("harness/guide/src/c-and-cpp.md");
    assert!(page.contains(&format!("```c\n{example}```")));
}
