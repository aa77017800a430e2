//! No module of any crate uses, by way of others, a module that uses it.
//!
//! Counted are `use` items, and paths in code and in arguments of macros that begin with `crate`, `self`, `super` or
//! the name of a child module; names are followed through re-exports to the module that they come from. Code under
//! `#[cfg(test)]` is not counted.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use bitgrain_tests::root;
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::Item;

use crate::sources::{Name, each_module, flatten};

/// What a module's code names, and what its `use` items bind.
#[derive(Default)]
struct Module {
    paths: BTreeSet<Name>,
    bound: BTreeMap<String, Name>,
}

/// The modules of a crate; the root's name is empty.
type Modules = BTreeMap<Name, Module>;

/// From modules to those that they use.
type Uses = BTreeMap<Name, BTreeSet<Name>>;

/// The modules of the crate whose root is in `file`.
fn modules(file: &Path) -> Modules {
    let mut out = Modules::new();
    each_module(file, &mut |name, items| {
        let mut module = Module::default();
        for item in items {
            let Item::Use(used) = item else {
                collect(item.to_token_stream(), name, &mut module.paths);
                continue;
            };
            let mut leaves = Vec::new();
            flatten(&used.tree, &[], &mut leaves);
            for (path, binds) in leaves {
                let path = absolute(&path, name);
                module
                    .bound
                    .extend(binds.map(|bound| (bound, path.clone())));
                module.paths.insert(path);
            }
        }
        out.insert(name.to_vec(), module);
    });
    out
}

/// A path as it is from the root; what begins with none of the words may begin with a child of the module.
fn absolute(path: &[String], module: &[String]) -> Name {
    let up = path.iter().take_while(|part| *part == "super").count();
    match path.first().map(String::as_str) {
        Some("crate") => path[1..].to_vec(),
        Some("self") => [module, &path[1..]].concat(),
        _ => [&module[..module.len().saturating_sub(up)], &path[up..]].concat(),
    }
}

/// The paths in code.
fn collect(tokens: TokenStream, module: &[String], out: &mut BTreeSet<Name>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let is_colon =
        |k: usize| matches!(tokens.get(k), Some(TokenTree::Punct(p)) if p.as_char() == ':');
    let mut k = 0;
    while k < tokens.len() {
        match &tokens[k] {
            TokenTree::Group(group) => collect(group.stream(), module, out),
            TokenTree::Ident(first) if k == 0 || !is_colon(k - 1) => {
                let mut path = vec![first.to_string()];
                while is_colon(k + 1)
                    && is_colon(k + 2)
                    && let Some(TokenTree::Ident(part)) = tokens.get(k + 3)
                {
                    path.push(part.to_string());
                    k += 3;
                }
                if path.len() > 1 {
                    out.insert(absolute(&path, module));
                }
            }
            _ => {}
        }
        k += 1;
    }
}

/// The module that the item of a path stands in, followed through `use` items.
fn home(modules: &Modules, path: &[String], depth: usize) -> Name {
    let mut at = Vec::new();
    for (k, part) in path.iter().enumerate() {
        let inner = [&at[..], std::slice::from_ref(part)].concat();
        if modules.contains_key(&inner) {
            at = inner;
            continue;
        }
        let bound = modules.get(&at).and_then(|module| module.bound.get(part));
        return match bound {
            Some(target) if depth < 16 => {
                home(modules, &[target, &path[k + 1..]].concat(), depth + 1)
            }
            _ => at,
        };
    }
    at
}

/// Which modules use which; and folders with all that is in them, beside each other.
fn uses(modules: &Modules) -> Uses {
    let mut uses = Uses::new();
    for (from, module) in modules {
        for path in &module.paths {
            let to = home(modules, path, 0);
            if to == *from {
                continue;
            }
            let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
            if common < from.len() && common < to.len() {
                let folder = |name: &Name| name[..=common].to_vec();
                let below = uses.entry(folder(from)).or_default();
                below.insert(folder(&to));
            }
            uses.entry(from.clone()).or_default().insert(to);
        }
    }
    uses
}

/// The modules that use themselves by way of others.
fn in_circles(uses: &Uses) -> Vec<String> {
    let returns = |name: &Name| {
        let mut seen = BTreeSet::new();
        let mut left: Vec<&Name> = uses[name].iter().collect();
        while let Some(at) = left.pop() {
            if seen.insert(at) {
                left.extend(uses.get(at).into_iter().flatten());
            }
        }
        seen.contains(name)
    };
    let circular = uses.keys().filter(|name| returns(name));
    circular.map(|name| name.join("::")).collect()
}

fn circles_of(file: &Path) -> Vec<String> {
    in_circles(&uses(&modules(file)))
}

#[test]
fn modules_form_no_circles() {
    let crates = [
        "kernel",
        "harness/sim",
        "harness/lab",
        "harness/fit",
        "harness/analysis",
        "harness",
        "tests",
    ];
    for name in crates {
        let circles = circles_of(&root().join(name).join("src/lib.rs"));
        assert!(circles.is_empty(), "{name}: {}", circles.join(", "));
    }
}

/// Each way in which a module can name another closes a circle.
#[test]
fn a_circle_is_found_however_it_is_written() {
    let ways = [
        ("use crate::b::f;", "use super::a::g;"),
        ("fn x() { crate::b::f(); }", "fn y() { super::a::g(); }"),
        ("use crate::f;", "use crate::a::{self, g};"),
        (
            "fn x() { println!(\"{}\", crate::b::f()); }",
            "fn y() { crate::a::g(); }",
        ),
    ];
    for (a, b) in ways {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("lib.rs", "mod a;\nmod b;\npub use b::f;\n");
        write("a.rs", &format!("{a}\npub fn g() {{}}\n"));
        write("b.rs", &format!("{b}\npub fn f() {{}}\n"));
        assert_eq!(
            circles_of(&folder.path().join("lib.rs")),
            ["a", "b"],
            "{a} {b}"
        );
        // Without one half there is none, and tests may name what they test.
        write(
            "b.rs",
            "#[cfg(test)]\nmod tests { use super::*; use crate::a::g; }\npub fn f() {}\n",
        );
        assert!(circles_of(&folder.path().join("lib.rs")).is_empty(), "{a}");
    }
    // A parent that calls its child, and a child that takes what stands in its parent's own file.
    let folder = tempfile::tempdir().unwrap();
    let lib = folder.path().join("lib.rs");
    let text = "pub mod p { pub struct S; pub mod c { use super::S; pub fn f(_: S) {} } fn g() { c::f(S); } }";
    fs::write(&lib, text).unwrap();
    assert_eq!(circles_of(&lib), ["p", "p::c"]);
}
