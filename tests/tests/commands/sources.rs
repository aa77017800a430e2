//! The sources of a crate as trees, module by module. Code under `#[cfg(test)]` is left out.

use std::fs;
use std::path::Path;

use syn::{Attribute, Expr, ExprLit, Item, ItemMod, Lit, Meta, UseTree};

/// A module's name or a path, from the root of its crate.
pub type Name = Vec<String>;

/// Shows each module of the crate whose root is in `file`, by its name and its items but for its modules.
pub fn each_module(file: &Path, see: &mut dyn FnMut(&[String], &[Item])) {
    let folder = file.parent().expect("a file has a folder");
    read(file, folder, &[], see);
}

fn read(file: &Path, folder: &Path, name: &[String], see: &mut dyn FnMut(&[String], &[Item])) {
    let text = fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let parsed = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    read_items(parsed.items, folder, name, see);
}

fn read_items(
    items: Vec<Item>,
    folder: &Path,
    name: &[String],
    see: &mut dyn FnMut(&[String], &[Item]),
) {
    let (children, own): (Vec<Item>, Vec<Item>) = items
        .into_iter()
        .filter(|item| !attributes(item).iter().any(is_for_tests))
        .partition(|item| matches!(item, Item::Mod(_)));
    see(name, &own);
    for child in children {
        let Item::Mod(child) = child else {
            continue;
        };
        let shared = shared_file(&child);
        let ItemMod { ident, content, .. } = child;
        let ident = ident.to_string();
        let below = folder.join(&ident);
        let own = [name, std::slice::from_ref(&ident)].concat();
        match content {
            Some((_, items)) => read_items(items, &below, &own, see),
            None => {
                let flat = folder.join(format!("{ident}.rs"));
                let file = match shared {
                    Some(path) => folder.join(path),
                    None if flat.exists() => flat,
                    None => below.join("mod.rs"),
                };
                read(&file, &below, &own, see);
            }
        }
    }
}

/// The file that a module shares with another crate, from the folder of its parent.
fn shared_file(module: &ItemMod) -> Option<String> {
    let path = module.attrs.iter().find(|a| a.path().is_ident("path"))?;
    let Meta::NameValue(path) = &path.meta else {
        return None;
    };
    match &path.value {
        Expr::Lit(ExprLit {
            lit: Lit::Str(path),
            ..
        }) => Some(path.value()),
        _ => None,
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}

fn is_for_tests(attribute: &Attribute) -> bool {
    match &attribute.meta {
        Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string() == "test",
        _ => false,
    }
}

/// The paths of a `use` item with the names that they bind; a glob binds none.
pub fn flatten(tree: &UseTree, before: &[String], out: &mut Vec<(Name, Option<String>)>) {
    let with = |part: &syn::Ident| [before, &[part.to_string()]].concat();
    match tree {
        UseTree::Path(path) => flatten(&path.tree, &with(&path.ident), out),
        UseTree::Name(leaf) if leaf.ident == "self" => {
            out.push((before.to_vec(), before.last().cloned()));
        }
        UseTree::Name(leaf) => out.push((with(&leaf.ident), Some(leaf.ident.to_string()))),
        UseTree::Rename(leaf) => out.push((with(&leaf.ident), Some(leaf.rename.to_string()))),
        UseTree::Glob(_) => out.push((before.to_vec(), None)),
        UseTree::Group(group) => group.items.iter().for_each(|t| flatten(t, before, out)),
    }
}
