//! What the first rank tells the others to do.

use sphorge_engine::RunFailure;
use sphorge_engine::persist::{Archive, ArchiveError, Fixed};
use sphorge_engine::ranks::Ranks;
use std::collections::BTreeMap;

/// What all ranks do next, together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Command {
    /// Take over the particles of a deck, with its name.
    Start {
        /// Name of the deck.
        name: String,
        /// Its text.
        deck: String,
    },
    /// Take a step of this size, s.
    Step(f64),
    /// Sum what is conserved.
    Ledger,
    /// Bring the values of a field to the first rank.
    Collect(String),
    /// Bring the state to the first rank.
    Save,
    /// Take the state back from the first rank.
    Load,
    /// There is nothing more to do.
    End,
}

/// Kind, number, lengths of two texts.
type Header = (u8, (f64, [usize; 2]));

impl Command {
    /// Kind, number and texts.
    fn parts(&self) -> (u8, f64, [&str; 2]) {
        match self {
            Self::Start { name, deck } => (0, 0.0, [name, deck]),
            Self::Step(dt) => (1, *dt, ["", ""]),
            Self::Ledger => (2, 0.0, ["", ""]),
            Self::Collect(field) => (3, 0.0, [field, ""]),
            Self::Save => (4, 0.0, ["", ""]),
            Self::Load => (5, 0.0, ["", ""]),
            Self::End => (6, 0.0, ["", ""]),
        }
    }

    fn of(kind: u8, number: f64, [first, second]: [String; 2]) -> Option<Self> {
        Some(match kind {
            0 => Self::Start { name: first, deck: second },
            1 => Self::Step(number),
            2 => Self::Ledger,
            3 => Self::Collect(first),
            4 => Self::Save,
            5 => Self::Load,
            6 => Self::End,
            _ => return None,
        })
    }

    /// Sends the command to the other ranks; the first rank alone does.
    pub(crate) fn broadcast(&self, ranks: &Ranks) -> Result<(), RunFailure> {
        let (kind, number, texts) = self.parts();
        let header: Header = (kind, (number, texts.map(str::len)));
        let mut bytes = Vec::new();
        header.write(&mut bytes);
        ranks.broadcast(&bytes, Header::SIZE)?;
        for text in texts.into_iter().filter(|text| !text.is_empty()) {
            ranks.broadcast(text.as_bytes(), text.len())?;
        }
        Ok(())
    }

    /// Waits for a command of the first rank.
    pub(crate) fn receive(ranks: &Ranks) -> Result<Self, RunFailure> {
        let unknown = || {
            let message = "the first rank asks for what there is not; all ranks must be of one program";
            RunFailure::of_engine(message.to_owned())
        };
        let bytes = ranks.broadcast(&[], Header::SIZE)?;
        let (kind, (number, lengths)) = Header::read(&bytes).ok_or_else(unknown)?;
        let mut texts = [String::new(), String::new()];
        for (text, length) in texts.iter_mut().zip(lengths).filter(|(_, length)| *length > 0) {
            *text = String::from_utf8(ranks.broadcast(&[], length)?).map_err(|_| unknown())?;
        }
        Self::of(kind, number, texts).ok_or_else(unknown)
    }
}

/// The state of one rank as bytes, to be sent: name and value, each behind its length.
#[derive(Debug, Default)]
pub(crate) struct State {
    pub(crate) bytes: Vec<u8>,
    loaded: Option<BTreeMap<String, Vec<u8>>>,
}

impl State {
    /// A state to load from.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        let mut rest = bytes;
        let mut take = || {
            let (length, behind) = rest.split_at_checked(usize::SIZE)?;
            let (taken, behind) = behind.split_at_checked(usize::read(length)?)?;
            rest = behind;
            Some(taken)
        };
        let mut values = BTreeMap::new();
        while let Some(name) = take() {
            values.insert(std::str::from_utf8(name).ok()?.to_owned(), take()?.to_vec());
        }
        rest.is_empty().then_some(Self { bytes: Vec::new(), loaded: Some(values) })
    }
}

impl Archive for State {
    fn is_saving(&self) -> bool {
        self.loaded.is_none()
    }
    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        for part in [name.as_bytes(), &bytes] {
            part.len().write(&mut self.bytes);
            self.bytes.extend_from_slice(part);
        }
    }
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        let value = self.loaded.as_mut().and_then(|values| values.remove(name));
        value.ok_or_else(|| ArchiveError::Missing(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::threads;

    #[test]
    fn a_broadcast_command_is_received() {
        let start = Command::Start { name: "a".to_owned(), deck: "title = \"A\"".to_owned() };
        let told = [start, Command::Step(-0.1), Command::Collect("density".to_owned()), Command::Save, Command::End];
        let [first, second]: [Ranks; 2] =
            threads(2).into_iter().map(Ranks::new).collect::<Vec<_>>().try_into().unwrap();
        std::thread::scope(|scope| {
            scope.spawn(|| told.iter().for_each(|command| command.broadcast(&first).unwrap()));
            for command in &told {
                assert_eq!(Command::receive(&second).as_ref(), Ok(command));
            }
        });
    }

    #[test]
    fn a_state_is_sent_as_bytes_and_one_that_is_cut_is_none() {
        let mut state = State::default();
        state.save("a", vec![1, 2, 3]);
        state.save("b", Vec::new());
        let bytes = state.bytes.clone();
        let mut loaded = State::of(&bytes).unwrap();
        assert!(state.is_saving() && !loaded.is_saving());
        assert_eq!((loaded.load("a"), loaded.load("b")), (Ok(vec![1, 2, 3]), Ok(vec![])));
        assert_eq!(loaded.load("a"), Err(ArchiveError::Missing("a".to_owned())));
        assert!(State::of(&bytes[..bytes.len() - 1]).is_none());
    }
}
