//! The server: on this machine alone, for whoever knows the address, and for reading only.

use super::{
    ViewError, ViewSettings,
    description::{Description, Flag, flags},
    http::{Answer, serve},
    nodes::cell_bytes,
    parts::part,
    request::{Refused, Request},
    run::ViewedRun,
    settings::{self, Start},
    text::explained,
};
use crate::plot::{ColorMap, DARKEST, LIGHT, LINES, NO_VALUE, SINGLE_COLOR};
use serde::Serialize;
use std::{
    net::{Ipv4Addr, TcpListener},
    path::{Path, PathBuf},
    sync::Arc,
    thread,
};

/// Rows of a history that the page gets.
const MOST_ROWS: usize = 4000;

/// Shows runs at an address of this machine.
pub struct Viewer {
    listener: TcpListener,
    shown: Arc<Shown>,
    port: u16,
    address: String,
}

/// What is shown, and the word that it is shown for.
struct Shown {
    runs: Vec<ViewedRun>,
    settings: ViewSettings,
    token: String,
}

/// What the page needs to know once.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Opening {
    version: &'static str,
    start: Start,
    /// Colour maps: 256 colours each, in hexadecimal digits.
    maps: Vec<(&'static str, String)>,
    /// Colours of curves.
    lines: [[u8; 3]; LINES.len()],
    /// Of a value that is not finite, and of bodies with one value everywhere.
    no_value: [u8; 3],
    single: [u8; 3],
    /// Fields that are one or zero.
    flags: Vec<Flag>,
    /// Direction to the light: right, up, towards the eye; and the share of it that a surface turned away loses.
    light: [f64; 3],
    darkest: f64,
}

impl Opening {
    pub(super) fn new(runs: &[ViewedRun], settings: &ViewSettings) -> Self {
        let maps = [("viridis", ColorMap::Viridis), ("inferno", ColorMap::Inferno), ("diverging", ColorMap::Diverging)];
        let table = |map: ColorMap| {
            (0..256)
                .map(|k| map.color(f64::from(k) / 255.0))
                .map(|[r, g, b]| format!("{r:02x}{g:02x}{b:02x}"))
                .collect()
        };
        Self {
            version: env!("CARGO_PKG_VERSION"),
            start: settings.start(runs),
            maps: maps.map(|(name, map)| (name, table(map))).to_vec(),
            lines: LINES,
            no_value: NO_VALUE,
            single: SINGLE_COLOR,
            flags: flags(),
            light: LIGHT,
            darkest: DARKEST,
        }
    }
}

impl Viewer {
    /// Takes a port of this machine, 0 for any that is free, to show the runs of some folders, which must have one each.
    ///
    /// # Errors
    /// [`ViewError::Output`] for a folder without a run, [`ViewError::Plot`] for a field, body, column or frame that a run
    /// does not have, [`ViewError::Port`] if the port cannot be taken.
    pub fn open(folders: &[PathBuf], settings: ViewSettings, port: u16) -> Result<Self, ViewError> {
        let runs = ViewedRun::open_all(folders)?;
        settings.check(&runs)?;
        Self::listen(runs, settings, port)
    }

    /// The same for a run that is about to be made in a folder.
    ///
    /// # Errors
    /// [`ViewError::Port`] if no port can be taken.
    pub fn await_run(folder: &Path, port: u16) -> Result<Self, ViewError> {
        Self::listen(vec![ViewedRun::awaited(folder)], ViewSettings::default(), port)
    }

    fn listen(runs: Vec<ViewedRun>, settings: ViewSettings, port: u16) -> Result<Self, ViewError> {
        let failed = |source| ViewError::Port { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        let number = listener.local_addr().map_err(failed)?.port();
        let token = token()?;
        let address = format!("http://127.0.0.1:{number}/{token}/");
        Ok(Self { listener, shown: Arc::new(Shown { runs, settings, token }), port: number, address })
    }

    /// Where the page is. Whoever knows it can see the runs.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// The port that it has taken.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Answers requests in threads of their own, until the program ends.
    ///
    /// # Errors
    /// [`ViewError::Port`] if the system lends the port no second time.
    pub fn start(&self) -> Result<(), ViewError> {
        let listener = self.listener.try_clone().map_err(|source| ViewError::Port { port: self.port, source })?;
        let shown = Arc::clone(&self.shown);
        thread::spawn(move || serve(&listener, move |method, address| shown.answer(method, address)));
        Ok(())
    }
}

/// The field that a page of these runs shows first where none is named; none where they have no frame yet.
///
/// # Errors
/// As [`Viewer::open`].
pub fn first_field(folders: &[PathBuf]) -> Result<Option<String>, ViewError> {
    let runs = ViewedRun::open_all(folders)?;
    Ok(settings::first_field(&runs))
}

impl Shown {
    fn answer(&self, method: &str, address: &str) -> Answer {
        // In this order: who does not know the token is not told what there would be.
        let request = match Request::read(address, &self.token) {
            Ok(request) => request,
            Err(Refused::Forbidden) => {
                return Answer::text(403, "The address is not complete. Open the one that `sphorge` has printed.\n");
            }
            Err(Refused::Unknown) => return Answer::text(404, "There is nothing of this name.\n"),
        };
        if !matches!(method, "GET" | "HEAD") {
            return Answer::text(405, "Runs can be read only.\n");
        }
        self.found(&request).unwrap_or_else(|error| Answer::text(404, &explained(&error)))
    }

    fn found(&self, request: &Request) -> Result<Answer, ViewError> {
        let of = |run: usize| self.runs.get(run);
        let nothing = || Answer::text(404, "There is no such run.\n");
        Ok(match request {
            Request::Part(name) => match part(name) {
                Some((text, kind)) => Answer { code: 200, kind, bytes: text.into_bytes() },
                None => Answer::text(404, "There is nothing of this name.\n"),
            },
            Request::Start => Answer::json(&Opening::new(&self.runs, &self.settings)),
            Request::Runs => Answer::json(
                &self.runs.iter().map(|run| run.describe(self.settings.mirror)).collect::<Vec<Description>>(),
            ),
            Request::Array { run, frame, name } => match of(*run) {
                Some(run) => Answer::numbers(run.array(*frame, name)?.bytes()),
                None => nothing(),
            },
            Request::Range { run, frame, name } => match of(*run) {
                Some(run) => Answer::numbers(run.array(*frame, name)?.head_bytes()),
                None => nothing(),
            },
            Request::Cells { run } => match of(*run) {
                Some(run) => Answer::numbers(cell_bytes(&*run.cells()?)),
                None => nothing(),
            },
            Request::Nodes { run, frame } => match of(*run) {
                Some(run) => Answer::numbers(run.nodes(*frame)?.bytes()),
                None => nothing(),
            },
            Request::Column { run, column } => match of(*run) {
                Some(run) => {
                    Answer::numbers(run.column(*column, MOST_ROWS)?.iter().flat_map(|x| x.to_le_bytes()).collect())
                }
                None => nothing(),
            },
            Request::Particle { run, frame, particle } => match of(*run) {
                Some(run) => Answer::json(&run.particle(*frame, *particle)?),
                None => nothing(),
            },
        })
    }
}

/// A word that nobody can guess.
fn token() -> Result<String, ViewError> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|error| ViewError::Random { reason: error.to_string() })?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}
