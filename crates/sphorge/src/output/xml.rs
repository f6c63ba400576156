//! XML of the files of a run, read in a time that grows with their length.

use roxmltree::{Document, ParsingOptions};

/// Attributes of an element: no file of a run has more than 20, and the parser compares each with all before it.
const MOST_ATTRIBUTES: usize = 64;
/// Elements and texts: those of a list of 10⁵ frames, the most a deck can ask for, and some more.
const MOST_NODES: u32 = 1 << 20;

/// Parses a document.
///
/// # Errors
/// Why it is none of ours: not well-formed, with a DTD or entities of its own, or with more in it than files of a run have.
pub(super) fn parse(text: &str) -> Result<Document<'_>, String> {
    parse_within(text, MOST_NODES)
}

fn parse_within(text: &str, nodes_limit: u32) -> Result<Document<'_>, String> {
    // No `<` stands inside of an attribute, so each piece is a tag and the text behind it.
    let crowded = text.split('<').find(|tag| tag.matches('=').count() > MOST_ATTRIBUTES);
    if let Some(tag) = crowded {
        let name: String = tag.chars().take_while(|c| c.is_alphanumeric()).take(20).collect();
        return Err(format!("the element `{name}` has more than {MOST_ATTRIBUTES} attributes"));
    }
    let options = ParsingOptions { nodes_limit, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        parse(text).err().unwrap_or_else(|| panic!("it is read: {}", &text[..text.len().min(80)]))
    }

    #[test]
    fn what_no_run_writes_is_refused_with_the_reason() {
        let many: String = (0..60_000).map(|k| format!(" a{k}=\"1\"")).collect();
        assert_eq!(refused(&format!("<VTKFile{many}/>")), "the element `VTKFile` has more than 64 attributes");
        assert!(refused("<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>").contains("DTD"));
        assert!(refused("<a>&b;</a>").contains("unknown entity"));
        assert!(parse_within("<a><b/><b/></a>", 3).unwrap_err().to_string().contains("nodes limit"));
        assert!(refused(&"<a>".repeat(10_000)).contains("closed"));
        assert!(refused("").contains("root"));
    }

    #[test]
    fn what_a_run_writes_is_read() {
        let entry = "<DataSet timestep=\"1e-6\" part=\"0\" file=\"fields/000001.vtp\"/>\n";
        let list = format!("<?xml version=\"1.0\"?><Collection>{}</Collection>", entry.repeat(1000));
        let document = parse(&list).unwrap();
        assert_eq!(document.descendants().filter(|n| n.has_tag_name("DataSet")).count(), 1000);
        // A list of 10⁵ frames has a hundred times as many.
        assert!(100 * document.descendants().count() < MOST_NODES as usize);
    }
}
