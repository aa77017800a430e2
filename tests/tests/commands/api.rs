//! The public interface of each library: a change of it is seen, and must be in the changelog.
//!
//! Listed are public functions, types with their public fields, variants, methods and traits, and what is exported
//! again, as they stand in the sources; the kernel's list is the interface for embedders.

use std::collections::BTreeSet;

use bitgrain_tests::root;
use quote::ToTokens;
use syn::{Fields, ImplItem, Item, Visibility};

use crate::sources::{each_module, flatten};

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// Tokens as they are usually written.
fn text(tokens: &impl ToTokens) -> String {
    let mut text = tokens.to_token_stream().to_string();
    for (from, to) in [
        (" :: ", "::"),
        (" : ", ": "),
        (" , ", ", "),
        (" < ", "<"),
        (" >", ">"),
        ("& ", "&"),
        (" (", "("),
        ("( ", "("),
        (" )", ")"),
        ("[ ", "["),
        (" ]", "]"),
        (" ;", ";"),
        ("' ", "'"),
        ("& mut", "&mut"),
        (" ,", ","),
        (":: <", "::<"),
        ("->(", "-> ("),
        ("< '", "<'"),
    ] {
        text = text.replace(from, to);
    }
    text
}

/// The lines of the crate whose root is this file.
fn api(file: &str) -> String {
    let mut lines = BTreeSet::new();
    each_module(&root().join(file), &mut |name, items| {
        let place = |item: &str| [name, &[item.to_string()]].concat().join("::");
        for item in items {
            match item {
                Item::Use(item) if is_public(&item.vis) => {
                    let mut leaves = Vec::new();
                    flatten(&item.tree, &[], &mut leaves);
                    for (path, bound) in leaves {
                        let what = bound.unwrap_or_else(|| "*".into());
                        lines.insert(format!("{} = {}", place(&what), path.join("::")));
                    }
                }
                Item::Fn(item) if is_public(&item.vis) => {
                    let place = place("");
                    lines.insert(format!("{place}{}", text(&item.sig)));
                }
                Item::Const(item) if is_public(&item.vis) => {
                    let (name, ty) = (place(&item.ident.to_string()), text(&item.ty));
                    lines.insert(format!("{name}: const {ty}"));
                }
                Item::Type(item) if is_public(&item.vis) => {
                    let name = place(&item.ident.to_string());
                    lines.insert(format!("{name}: type {}", text(&item.ty)));
                }
                Item::Struct(item) if is_public(&item.vis) => {
                    let name = place(&item.ident.to_string());
                    lines.insert(format!("{name}: struct{}", text(&item.generics)));
                    if let Fields::Named(fields) = &item.fields {
                        for field in fields.named.iter().filter(|field| is_public(&field.vis)) {
                            let own = field.ident.as_ref().expect("it is named");
                            lines.insert(format!("{name}.{own}: {}", text(&field.ty)));
                        }
                    }
                }
                Item::Enum(item) if is_public(&item.vis) => {
                    let name = place(&item.ident.to_string());
                    lines.insert(format!("{name}: enum{}", text(&item.generics)));
                    for variant in &item.variants {
                        let fields = variant.fields.iter().map(|field| match &field.ident {
                            Some(own) => format!("{own}: {}", text(&field.ty)),
                            None => text(&field.ty),
                        });
                        let fields = fields.collect::<Vec<_>>().join(", ");
                        lines.insert(format!("{name}::{}({fields})", variant.ident));
                    }
                }
                Item::Trait(item) if is_public(&item.vis) => {
                    let name = place(&item.ident.to_string());
                    lines.insert(format!("{name}: trait{}", text(&item.generics)));
                    for member in &item.items {
                        if let syn::TraitItem::Fn(own) = member {
                            lines.insert(format!("{name}::{}", text(&own.sig)));
                        }
                    }
                }
                Item::Impl(item) if item.trait_.is_none() => {
                    let name = place(&text(&item.self_ty));
                    for member in &item.items {
                        if let ImplItem::Fn(own) = member
                            && is_public(&own.vis)
                        {
                            lines.insert(format!("{name}::{}", text(&own.sig)));
                        }
                    }
                }
                _ => {}
            }
        }
    });
    lines.into_iter().map(|line| line + "\n").collect()
}

#[test]
fn libraries_offer_what_they_offered() {
    for (name, file) in [
        ("kernel", "kernel/src/lib.rs"),
        ("sim", "harness/sim/src/lib.rs"),
        ("lab", "harness/lab/src/lib.rs"),
        ("fit", "harness/fit/src/lib.rs"),
        ("analysis", "harness/analysis/src/lib.rs"),
        ("bitgrain", "harness/src/lib.rs"),
    ] {
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path(root().join("golden/api"));
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.set_description("cargo test -p bitgrain-tests --release --test commands api::");
        settings.bind(|| insta::assert_snapshot!(name, api(file)));
    }
}
