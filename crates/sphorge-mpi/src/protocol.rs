//! What the first rank tells the others to do.

use sphorge_engine::RunFailure;
use sphorge_engine::persist::{Fixed, Parts};
use sphorge_engine::ranks::Ranks;

/// What all ranks do next, together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Command {
    /// Take over the particles of a deck, with its name.
    Start {
        /// Name of the engine.
        engine: String,
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
    /// Take a sum, mean or extremum, as a [`sphorge_engine::reduction::ReductionMessage`] says.
    Reduce(Vec<u8>),
    /// Sum the force through a section, by its number among those of the model.
    Section(usize),
    /// Bring the state to the first rank.
    Save,
    /// Save the state, each its part.
    SaveParts(Parts),
    /// Take the state back from the first rank.
    Load,
    /// Load the state from what each has of it.
    LoadParts(Parts),
    /// Write the particles, each its own, as these words ask for.
    Write(String),
    /// There is nothing more to do.
    End,
}

/// Kind, number, lengths of three texts or other bytes.
type Header = (u8, (f64, [usize; 3]));

impl Command {
    /// Kind, number and texts.
    fn parts(&self) -> (u8, f64, [&[u8]; 3]) {
        match self {
            Self::Start { engine, name, deck } => (0, 0.0, [engine.as_bytes(), name.as_bytes(), deck.as_bytes()]),
            Self::Step(dt) => (1, *dt, [&[], &[], &[]]),
            Self::Ledger => (2, 0.0, [&[], &[], &[]]),
            Self::Collect(field) => (3, 0.0, [field.as_bytes(), &[], &[]]),
            Self::Save => (4, 0.0, [&[], &[], &[]]),
            Self::Load => (5, 0.0, [&[], &[], &[]]),
            Self::End => (6, 0.0, [&[], &[], &[]]),
            // Exact: there are not so many.
            Self::Section(section) => (7, *section as f64, [&[], &[], &[]]),
            Self::SaveParts(Parts::Memory) => (8, 0.0, [&[], &[], &[]]),
            Self::SaveParts(Parts::Files(files)) => (9, 0.0, [files.as_bytes(), &[], &[]]),
            Self::LoadParts(Parts::Memory) => (10, 0.0, [&[], &[], &[]]),
            Self::LoadParts(Parts::Files(files)) => (11, 0.0, [files.as_bytes(), &[], &[]]),
            Self::Write(request) => (12, 0.0, [request.as_bytes(), &[], &[]]),
            Self::Reduce(message) => (13, 0.0, [message, &[], &[]]),
        }
    }

    fn of(kind: u8, number: f64, [first, second, third]: [Vec<u8>; 3]) -> Option<Self> {
        let text = |bytes| String::from_utf8(bytes).ok();
        Some(match kind {
            0 => Self::Start { engine: text(first)?, name: text(second)?, deck: text(third)? },
            1 => Self::Step(number),
            2 => Self::Ledger,
            3 => Self::Collect(text(first)?),
            4 => Self::Save,
            5 => Self::Load,
            6 => Self::End,
            7 => Self::Section(number as usize),
            8 => Self::SaveParts(Parts::Memory),
            9 => Self::SaveParts(Parts::Files(text(first)?)),
            10 => Self::LoadParts(Parts::Memory),
            11 => Self::LoadParts(Parts::Files(text(first)?)),
            12 => Self::Write(text(first)?),
            13 => Self::Reduce(first),
            _ => return None,
        })
    }

    /// Sends the command to the other ranks; the first rank alone does.
    pub(crate) fn broadcast(&self, ranks: &Ranks) -> Result<(), RunFailure> {
        let (kind, number, texts) = self.parts();
        let header: Header = (kind, (number, texts.map(<[u8]>::len)));
        let mut bytes = Vec::new();
        header.write(&mut bytes);
        ranks.broadcast(&bytes, Header::SIZE)?;
        for text in texts.into_iter().filter(|text| !text.is_empty()) {
            ranks.broadcast(text, text.len())?;
        }
        Ok(())
    }

    /// Waits for a command of the first rank.
    pub(crate) fn receive(ranks: &Ranks) -> Result<Self, RunFailure> {
        let unknown = || {
            let message = "the first rank sent an unknown request; all ranks must run the same program";
            RunFailure::of_engine(message.to_owned())
        };
        let bytes = ranks.broadcast(&[], Header::SIZE)?;
        let (kind, (number, lengths)) = Header::read(&bytes).ok_or_else(unknown)?;
        let mut texts = [Vec::new(), Vec::new(), Vec::new()];
        for (text, length) in texts.iter_mut().zip(lengths).filter(|(_, length)| *length > 0) {
            *text = ranks.broadcast(&[], length)?;
        }
        Self::of(kind, number, texts).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::threads;

    #[test]
    fn a_broadcast_command_is_received() {
        let start = Command::Start { engine: "cpu".to_owned(), name: "a".to_owned(), deck: "title = \"A\"".to_owned() };
        let told = [
            start,
            Command::Step(-0.1),
            Command::Collect("density".to_owned()),
            Command::Section(3),
            Command::Reduce(vec![0, 255, 7]),
            Command::Save,
            Command::SaveParts(Parts::Memory),
            Command::SaveParts(Parts::Files("there".to_owned())),
            Command::LoadParts(Parts::Memory),
            Command::LoadParts(Parts::Files("here".to_owned())),
            Command::Write("a frame".to_owned()),
            Command::End,
        ];
        let [first, second]: [Ranks; 2] =
            threads(2).into_iter().map(Ranks::new).collect::<Vec<_>>().try_into().unwrap();
        std::thread::scope(|scope| {
            scope.spawn(|| told.iter().for_each(|command| command.broadcast(&first).unwrap()));
            for command in &told {
                assert_eq!(Command::receive(&second).as_ref(), Ok(command));
            }
        });
    }
}
