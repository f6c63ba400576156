//! What the page asks for: addresses are read here, and all that are none of these are refused.

/// What is asked for. Runs and frames are numbered from zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Request {
    /// A file of the page.
    Part(String),
    /// What the page shows when it opens.
    Start,
    /// What there is of the runs now.
    Runs,
    /// Numbers of all particles.
    Array { run: usize, frame: usize, name: String },
    /// What is known of these numbers without all of them.
    Range { run: usize, frame: usize, name: String },
    /// Which corners cells have in common.
    Cells { run: usize },
    /// Where these corners are.
    Nodes { run: usize, frame: usize },
    /// A column of the history by its number.
    Column { run: usize, column: usize },
    /// All of one particle.
    Particle { run: usize, frame: usize, particle: usize },
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refused {
    /// The token is not there, or another.
    Forbidden,
    /// There is nothing of that name.
    Unknown,
}

impl Request {
    /// Reads an address as a request has it: a path, which begins with the token.
    pub(super) fn read(address: &str, token: &str) -> Result<Self, Refused> {
        let path = address.split(['?', '#']).next().unwrap_or_default();
        let path = path.strip_prefix('/').ok_or(Refused::Forbidden)?;
        let (given, path) = path.split_once('/').ok_or(Refused::Forbidden)?;
        if !is_same(given, token) {
            return Err(Refused::Forbidden);
        }
        // Names of fields and of files of the page have no other characters; none of them leads anywhere else.
        let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '/' | '-');
        if !path.chars().all(is_plain) || path.contains("..") {
            return Err(Refused::Unknown);
        }
        let words: Vec<&str> = path.split('/').collect();
        let number = |word: &str| word.parse().map_err(|_| Refused::Unknown);
        Ok(match words[..] {
            [""] => Self::Part("index.html".to_owned()),
            ["start.json"] => Self::Start,
            ["runs.json"] => Self::Runs,
            ["run", run, "frame", frame, "array", name] => {
                Self::Array { run: number(run)?, frame: number(frame)?, name: name.to_owned() }
            }
            ["run", run, "frame", frame, "range", name] => {
                Self::Range { run: number(run)?, frame: number(frame)?, name: name.to_owned() }
            }
            ["run", run, "frame", frame, "particle", particle] => {
                Self::Particle { run: number(run)?, frame: number(frame)?, particle: number(particle)? }
            }
            ["run", run, "frame", frame, "nodes"] => Self::Nodes { run: number(run)?, frame: number(frame)? },
            ["run", run, "cells"] => Self::Cells { run: number(run)? },
            ["run", run, "history", column] => Self::Column { run: number(run)?, column: number(column)? },
            [name] => Self::Part(name.to_owned()),
            _ => return Err(Refused::Unknown),
        })
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn is_same(given: &str, token: &str) -> bool {
    let differ = given.bytes().zip(token.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b));
    given.len() == token.len() && differ == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_behind_their_token_alone() {
        let read = |address: &str| Request::read(address, "t0k");
        assert_eq!(read("/t0k/"), Ok(Request::Part("index.html".into())));
        assert_eq!(read("/t0k/main.js?again"), Ok(Request::Part("main.js".into())));
        assert_eq!(
            read("/t0k/run/1/frame/20/array/stress.xy"),
            Ok(Request::Array { run: 1, frame: 20, name: "stress.xy".into() })
        );
        assert_eq!(read("/t0k/run/0/history/3"), Ok(Request::Column { run: 0, column: 3 }));
        for forbidden in ["", "/", "/t0k", "/t0/", "/t0kk/", "/T0K/", "//t0k/", "/x/t0k/", "http://127.0.0.1/t0k/"] {
            assert_eq!(read(forbidden), Err(Refused::Forbidden), "{forbidden}");
        }
        let unknown = [
            "/t0k/..",
            "/t0k/../deck.toml",
            "/t0k/%2e%2e/deck.toml",
            "/t0k/run/0/frame/0/array/../../x",
            "/t0k/run/-1/cells",
            "/t0k/run/18446744073709551616/cells",
            "/t0k/run/0/frame/0/array/a b",
            "/t0k/run/0/frame/0/array/C:\\x",
            "/t0k/a/b",
        ];
        for unknown in unknown {
            assert_eq!(read(unknown), Err(Refused::Unknown), "{unknown}");
        }
    }
}
