//! A page as a whole: its head, what to know before its numbers are believed, where they come from, its
//! contents, its sections.

use super::player;
use super::scene;
use super::text::escape;

const CSS: &str = include_str!("style.css");

/// The part above the sections of a page. All but the name is HTML.
pub(super) struct Top<'a> {
    /// Of the scenario or campaign, plain text.
    pub name: &'a str,
    /// What the page is, beginning with a capital.
    pub kind: &'a str,
    /// Its own style rules besides those of all pages.
    pub style: &'a str,
    /// The main numbers as a paragraph.
    pub lead: String,
    /// Remarks on the numbers: [`remark`]s.
    pub remarks: Vec<String>,
    /// Names and what they stand for: [`row`]s.
    pub about: String,
}

/// Something to know before numbers are believed: its name and what it means, as HTML.
pub(super) fn remark(title: &str, words: &str) -> String {
    format!("<li><b>{title}.</b> {words}</li>\n")
}

/// A name and what it stands for, as HTML.
pub(super) fn row(name: &str, what: &str) -> String {
    format!("<dt>{name}</dt><dd>{what}</dd>\n")
}

/// The page, of sections that each begin with an `<h2>`.
pub(super) fn assembled(top: &Top<'_>, sections: &str) -> String {
    let (name, kind) = (escape(top.name), top.kind);
    let (first, rest) = kind.split_at(1);
    let title = first.to_lowercase() + rest;
    let (contents, sections) = with_contents(sections);
    let remarks = match top.remarks.is_empty() {
        true => "<p>No check found anything against these numbers.</p>\n".to_owned(),
        false => format!("<ul>\n{}</ul>\n", top.remarks.concat()),
    };
    let mut script = match sections.contains("<figure class=\"played") {
        true => player::script(),
        false => String::new(),
    };
    if sections.contains("<figure class=\"scene") {
        script.push_str(&scene::script());
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name}: {title}</title>\n\
         <style>{CSS}{}</style>\n</head>\n<body>\n<main>\n\
         <header><h1>{name}</h1>\n\
         <p class=\"kind\">{kind}</p></header>\n{}\
         <aside class=\"before\">\n<h2>Before you believe these numbers</h2>\n{remarks}</aside>\n\
         <dl class=\"about\">\n{}</dl>\n{contents}{sections}</main>\n{script}</body>\n</html>\n",
        top.style, top.lead, top.about,
    )
}

/// The contents of a page, and its sections with a place to go to on each heading.
fn with_contents(sections: &str) -> (String, String) {
    let (mut links, mut out) = (String::new(), String::new());
    let mut parts = sections.split("<h2>");
    out.push_str(parts.next().unwrap_or_default());
    for part in parts {
        let title = part.split("</h2>").next().unwrap_or_default();
        let letters = title.chars().map(|c| match c {
            c if c.is_ascii_alphanumeric() => c.to_ascii_lowercase(),
            _ => '-',
        });
        let place: String = letters.collect();
        links.push_str(&format!("<a href=\"#{place}\">{title}</a>\n"));
        out.push_str(&format!("<h2 id=\"{place}\">{part}"));
    }
    let contents = format!("<nav aria-label=\"Contents\">\n{links}</nav>\n");
    (contents, out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_heading_is_in_the_contents() {
        let (contents, sections) = with_contents("<h2>A b</h2>x<h2>C?</h2>");
        assert_eq!(sections, "<h2 id=\"a-b\">A b</h2>x<h2 id=\"c-\">C?</h2>");
        assert!(contents.contains("<a href=\"#a-b\">A b</a>\n<a href=\"#c-\">C?</a>"));
    }
}
