//! Notes on decks of which pieces are replaced, for the tests of modules that tell them.

use crate::load_text;

/// Notes on a deck with each of these pieces, which are in it, replaced.
#[track_caller]
pub(crate) fn notes_on(deck: &str, replaced: &[(&str, &str)]) -> Vec<String> {
    let mut deck = deck.to_owned();
    for (old, new) in replaced {
        assert!(deck.contains(old), "{old}");
        deck = deck.replace(old, new);
    }
    load_text("deck", &deck, &[]).unwrap().all_notes()
}

/// There is one note, with these words.
#[track_caller]
pub(crate) fn one_note_says(notes: &[String], words: &str) {
    assert!(notes.len() == 1 && notes[0].contains(words), "{notes:?}");
}
