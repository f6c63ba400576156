//! Decks of runs that a program drove: what they say of it.

/// A line of the deck in the folder of a run whose bodies had loads or velocities of a program.
const MARK: &str = "# A program gave loads or velocities to the run of this deck (`driven` in summary.json): by itself the deck is another run.";

/// The text with a line that says so, once; behind the line that tells editors the schema, which is the first.
pub fn marked_as_driven(text: &str) -> String {
    if is_marked_as_driven(text) {
        return text.to_owned();
    }
    match text.split_once('\n') {
        Some((schema, rest)) if schema.starts_with("#:") => format!("{schema}\n{MARK}\n{rest}"),
        _ => format!("{MARK}\n{text}"),
    }
}

/// The text without that line.
pub fn without_driven_mark(text: &str) -> String {
    text.replacen(&format!("{MARK}\n"), "", 1)
}

/// Whether the text says so.
pub fn is_marked_as_driven(text: &str) -> bool {
    text.lines().any(|line| line == MARK)
}

/// What whoever runs such a deck should know, unless a program drives it again.
pub(crate) fn note(text: &str) -> Option<String> {
    is_marked_as_driven(text).then(|| {
        "the deck is of a run to which a program gave loads or velocities: without that program this is another run"
            .to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{decks, load_text};

    #[test]
    fn the_mark_is_there_once_and_comes_off() {
        for text in ["title = \"a\"\n", "#:schema x.json\ntitle = \"a\"\n", ""] {
            let marked = marked_as_driven(text);
            assert!(is_marked_as_driven(&marked) && !is_marked_as_driven(text));
            assert_eq!(marked_as_driven(&marked), marked);
            assert_eq!(without_driven_mark(&marked), text);
        }
        assert!(marked_as_driven("#:schema x.json\na = 1\n").starts_with("#:schema x.json\n# A program"));
    }

    #[test]
    fn a_marked_deck_is_told_to_be_another_run() {
        let text = decks::find("iron-plate").unwrap().text;
        assert_eq!(load_text("a", text, &[]).unwrap().notes_unless_driven, [""; 0]);
        let marked = load_text("a", &marked_as_driven(text), &[("time.end".to_owned(), "1 us".to_owned())]).unwrap();
        assert!(marked.notes_unless_driven[0].contains("without that program"), "{:?}", marked.notes_unless_driven);
        assert!(is_marked_as_driven(&marked.deck_text));
    }
}
