//! Self-contained HTML pages.

use std::fmt::Display;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::frame::Size;

/// The style of all pages, light and dark.
const STYLE: &str = include_str!("page.css");

/// Escapes text for HTML and SVG, including attributes.
pub(super) fn escape(text: impl Display) -> String {
    let mut escaped = String::new();
    for character in text.to_string().chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(character),
        }
    }
    escaped
}

/// A page with a title, which is escaped here, and a body, which is not.
pub(super) fn page(title: &str, body: &str) -> String {
    page_with(title, "", body)
}

/// A page with additional elements in its head, such as a script, which are not escaped.
pub(super) fn page_with(title: &str, head: &str, body: &str) -> String {
    let title = escape(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{title}</title>\n\
         {head}<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n{body}</main>\n</body>\n</html>\n"
    )
}

/// The data URI of an embedded image, from its media type, such as `image/png`, and the file's bytes.
pub(super) fn data_uri(media_type: &str, bytes: &[u8]) -> String {
    format!("data:{media_type};base64,{}", STANDARD.encode(bytes))
}

/// An image with a caption. Both texts are escaped here. `alt` describes the image for those who cannot see it.
pub(super) fn figure(uri: &str, size: Size, alt: &str, caption: &str) -> String {
    let Size { width, height } = size;
    let (alt, caption) = (escape(alt), escape(caption));
    format!(
        "<figure><img src=\"{uri}\" width=\"{width}\" height=\"{height}\" alt=\"{alt}\"/>\
         <figcaption>{caption}</figcaption></figure>\n"
    )
}

/// A prominent figure: its name and value.
pub(super) fn tile(name: &str, value: impl Display, kind: &str) -> String {
    let (name, value, kind) = (escape(name), escape(value), escape(kind));
    format!("<div class=\"tile {kind}\"><span>{name}</span><b>{value}</b></div>\n")
}

/// A paragraph of text; empty if there is none.
pub(super) fn paragraph(text: impl Display) -> String {
    let text = escape(text);
    if text.is_empty() { text } else { format!("<p>{text}</p>\n") }
}

/// A section: a heading, a line about it, and the content, which is not escaped.
pub(super) fn section(heading: &str, about: &str, content: &str) -> String {
    format!("<section>\n<h2>{}</h2>\n{}{content}</section>\n", escape(heading), paragraph(about))
}

/// A table of this content, which is not escaped. On a narrow screen it scrolls in a box of its own, not with the page.
pub(super) fn table(content: &str) -> String {
    format!("<div class=\"wide\"><table>\n{content}</table></div>\n")
}

/// A table of names and values, all escaped here.
pub(super) fn figures(rows: &[(&str, String)]) -> String {
    let row = |(name, value): &(&str, String)| {
        format!("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape(name), escape(value))
    };
    format!("<table class=\"figures\">\n{}</table>\n", rows.iter().map(row).collect::<String>())
}

/// Checks that every element is closed in order, and that every `&` starts an entity: errors that a browser would
/// repair silently.
#[cfg(test)]
pub(super) fn check(page: &str) -> Result<(), String> {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = page.split_once("</style>").map_or(page, |(_, body)| body);
    if rest.len() < page.len() {
        open.extend(["html", "head"]);
    }
    for (at, _) in rest.match_indices('&') {
        let entity: String =
            rest[at + 1..].chars().take_while(|c| c.is_alphanumeric() || *c == '#').collect();
        if !["amp", "lt", "gt", "quot", "#39"].contains(&entity.as_str()) {
            return Err(format!("&{entity}"));
        }
    }
    while let Some((_, tail)) = rest.split_once('<') {
        let Some((tag, tail)) = tail.split_once('>') else { return Err(format!("<{tail}")) };
        rest = tail;
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name) {
                return Err(format!("</{name}> where {open:?} are open"));
            }
        } else if tag.matches('"').count() % 2 != 0 || tag.contains('<') {
            return Err(format!("<{tag}>"));
        } else if !tag.ends_with('/') && !tag.starts_with('!') {
            open.push(tag.split_whitespace().next().unwrap_or_default());
        }
    }
    if open.is_empty() { Ok(()) } else { Err(format!("{open:?} are not closed")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_become_markup() {
        let evil = "<script>alert(\"x\")</script> & 'more'";
        let text = page(evil, &figures(&[("a<b", evil.to_owned())]));
        assert!(!text.contains("<script") && text.contains("&lt;script&gt;alert(&quot;x&quot;)"), "{text}");
        assert_eq!(check(&text), Ok(()));
        assert_eq!(check(&page("a", &section("b", "c", &tile("d", 1, "good")))), Ok(()));
    }

    #[test]
    fn nothing_is_said_about_a_part_of_which_there_is_nothing_to_say() {
        assert_eq!(section("a", "", "b\n"), "<section>\n<h2>a</h2>\nb\n</section>\n");
    }

    #[test]
    fn what_is_not_closed_is_found() {
        for wrong in ["<p>", "<p></b></p>", "a & b", "<p class=\"a></p>", "</p>", "<a<b>"] {
            assert!(check(wrong).is_err(), "{wrong}");
        }
        assert_eq!(check("<p>a &lt; b<br/></p>"), Ok(()));
    }
}
