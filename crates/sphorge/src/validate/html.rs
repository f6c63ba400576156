//! The report as one page that needs no other file: the Markdown of the report with its pictures inside.

use super::report::Report;
use base64::{Engine, prelude::BASE64_STANDARD};
use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

/// What stands before the report: narrow screens scroll tables, not the page.
const HEAD: &str = r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8" />
<meta name="viewport" content="width=device-width, initial-scale=1" />
<title>Validation of Sphorge</title>
<style>
body { max-width: 60rem; margin: 0 auto; padding: 0 1rem 3rem; font: 1rem/1.5 system-ui, sans-serif; color: #1a1a1a; background: #fff; }
h1, h2 { line-height: 1.2; }
h2 { margin-top: 3rem; padding-top: 0.5rem; border-top: 1px solid #ccc; }
.table { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: 0.875rem; }
th, td { padding: 0.25rem 0.6rem; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top; }
td code { white-space: nowrap; }
img { display: block; max-width: 100%; height: auto; }
p, li { overflow-wrap: anywhere; }
.passed { color: #116329; }
.missed { color: #9a6700; font-weight: bold; }
.failed { color: #b00020; font-weight: bold; }
a { color: #0a4ea3; }
</style>
</head>
<body>
"#;

impl Report {
    /// The report as one HTML page, which is also well-formed XML; `picture` reads a picture of the report.
    pub fn html(&self, picture: &dyn Fn(&str) -> Option<Vec<u8>>) -> String {
        page(&self.markdown(), picture)
    }
}

/// A Markdown text as a page.
fn page(markdown: &str, picture: &dyn Fn(&str) -> Option<Vec<u8>>) -> String {
    let mut page = HEAD.to_owned();
    html::push_html(&mut page, for_a_page(markdown, picture).into_iter());
    page + "</body>\n</html>\n"
}

/// The parts of a Markdown text for a page of its own: pictures inside, headings that links reach, verdicts that show.
fn for_a_page<'a>(markdown: &'a str, picture: &dyn Fn(&str) -> Option<Vec<u8>>) -> Vec<Event<'a>> {
    let mut parts: Vec<Event<'a>> = Vec::new();
    let mut is_link_kept = Vec::new();
    for part in Parser::new_ext(markdown, Options::ENABLE_TABLES) {
        let part = match part {
            // Messages may hold what looks like markup.
            Event::Html(text) | Event::InlineHtml(text) => Event::Text(text),
            Event::Start(Tag::Image { link_type, dest_url, title, .. }) => {
                let inside = picture(&dest_url).map(|bytes| BASE64_STANDARD.encode(bytes));
                let dest_url = inside.map_or(dest_url, |text| format!("data:image/png;base64,{text}").into());
                Event::Start(Tag::Image { link_type, dest_url, title, id: CowStr::Borrowed("") })
            }
            // What is not in the page, such as the folders of runs, is named without a link.
            Event::Start(Tag::Link { ref dest_url, .. }) => {
                is_link_kept.push(dest_url.starts_with('#'));
                if !dest_url.starts_with('#') {
                    continue;
                }
                part
            }
            Event::End(TagEnd::Link) => {
                if !is_link_kept.pop().unwrap_or_default() {
                    continue;
                }
                part
            }
            Event::Start(Tag::Table(columns)) => {
                parts.push(Event::Html("<div class=\"table\">\n".into()));
                Event::Start(Tag::Table(columns))
            }
            Event::End(TagEnd::Table) => {
                parts.push(part);
                Event::Html("</div>\n".into())
            }
            Event::Text(text) => {
                if let Some(Event::Start(Tag::Heading { level: HeadingLevel::H2, id, .. })) = parts.last_mut() {
                    *id = Some(text.clone());
                }
                let is_cell = matches!(parts.last(), Some(Event::Start(Tag::TableCell)));
                match &*text {
                    "passed" | "missed" | "failed" if is_cell => {
                        Event::InlineHtml(format!("<span class=\"{text}\">{text}</span>").into())
                    }
                    _ => Event::Text(text),
                }
            }
            part => part,
        };
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# Title\n\n| case | verdict |\n|---|---|\n| [bar](#bar) | passed |\n| b | failed |\n\n## bar\n\n1 < 2 & 3, cannot write out/<b>/<script>\n\n\
                        ![caption](bar/1.png)\n\n![gone](bar/2.png)\n\n[run](bar/run) `sphorge run bar`\n";

    #[test]
    fn a_page_holds_its_pictures_and_its_links_lead_somewhere() {
        let picture = |file: &str| (file == "bar/1.png").then(|| vec![0, 1, 2, 253, 254, 255]);
        let page = page(TEXT, &picture);
        let tree = roxmltree::Document::parse_with_options(
            &page,
            roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() },
        )
        .unwrap();
        let all = |name: &str, attribute: &str| -> Vec<String> {
            let nodes = tree.descendants().filter(|node| node.has_tag_name(name));
            nodes.filter_map(|node| node.attribute(attribute)).map(ToOwned::to_owned).collect()
        };
        assert_eq!(all("img", "src"), ["data:image/png;base64,AAEC/f7/", "bar/2.png"]);
        assert_eq!((all("a", "href"), all("h2", "id")), (vec!["#bar".to_owned()], vec!["bar".to_owned()]));
        assert_eq!(all("span", "class"), ["passed", "failed"]);
        assert_eq!(all("div", "class"), ["table"]);
        assert!(
            page.contains("1 &lt; 2 &amp; 3, cannot write out/&lt;b&gt;/&lt;script&gt;")
                && page.contains("run <code>sphorge run bar</code>"),
            "{page}"
        );
    }
}
