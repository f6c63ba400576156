//! What a sweep is to run, and what of it is there already.

use super::{Varied, name};
use crate::{
    deck::{DeckReport, Setup, overlapping_keys},
    engine::{EngineKind, Unsupported},
    output::{OutputError, RunDirectory, Status, Summary},
};
use std::{
    collections::{BTreeSet, HashSet},
    fs,
    path::{Path, PathBuf},
    sync::atomic::{AtomicBool, Ordering},
};

/// Most runs of a sweep.
pub(super) const MOST_RUNS: usize = 10_000;

/// Every combination of the values of some keys.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Folder that the folders of the runs are in.
    pub folder: PathBuf,
    /// The keys and their values.
    pub varied: Vec<Varied>,
    /// The runs, the values of the last key changing first.
    pub runs: Vec<SweepRun>,
    /// Measures that any of the decks declares.
    pub measures: Vec<String>,
    /// Whether runs that are there are made again.
    pub(super) again: bool,
}

/// One of the runs.
#[derive(Clone, Debug)]
pub struct SweepRun {
    /// Name of its folder.
    pub name: String,
    /// Value of each key.
    pub values: Vec<String>,
    /// Its deck, everything that was set worked in.
    pub deck_text: String,
    /// What there is to note of it before it is made, such as that its spacing does not fit a body.
    pub notes: Vec<String>,
    /// What there is to do.
    pub planned: Planned,
}

/// How runs are to be planned.
pub struct Planning<'a> {
    /// Folder that the folders of the runs are in.
    pub folder: &'a Path,
    /// What runs the decks.
    pub engine: &'a dyn EngineKind,
    /// Whether runs that are there are made again.
    pub again: bool,
    /// Looked at before each deck: where it becomes true, there is no sweep.
    pub stop: &'a AtomicBool,
}

/// What there is to do for a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planned {
    /// All of it.
    New,
    /// It was begun and can go on from a checkpoint.
    Resume,
    /// It was begun and has left nothing to go on from, or is to be made again.
    Again,
    /// Nothing: it has ended.
    Nothing,
}

/// Why there is no sweep.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SweepError {
    /// What is to be varied makes no sense.
    #[error("{what}")]
    #[diagnostic(code(sphorge::sweep::varied), help("{help}"))]
    Varied {
        /// What is wrong.
        what: String,
        /// What to do.
        help: String,
    },
    /// The deck of a run cannot be used.
    #[error("{which} cannot be run: {set}")]
    #[diagnostic(code(sphorge::sweep::deck), help("nothing was run"))]
    Deck {
        /// Which of the runs.
        which: String,
        /// What was set for it.
        set: String,
        /// What is wrong with it.
        #[source]
        #[diagnostic_source]
        source: DeckReport,
    },
    /// The engine does not run such a model.
    #[error("the engine `{engine}` does not run {which}: {unsupported}")]
    #[diagnostic(code(sphorge::sweep::engine), help("{}", unsupported.help))]
    Unsupported {
        /// Name of the engine.
        engine: &'static str,
        /// Which of the runs.
        which: String,
        /// What it cannot do.
        unsupported: Unsupported,
    },
    /// There is another run in the folder of one of the sweep.
    #[error("{} contains a run of another deck", path.display())]
    #[diagnostic(
        code(sphorge::sweep::another),
        help(
            "the deck, or what is set in it, has changed since; choose another folder with `-o DIR`, or pass `--overwrite` to run it again"
        )
    )]
    Another {
        /// The folder.
        path: PathBuf,
    },
    /// Another study makes runs in the folder.
    #[error("another study makes runs in {}: {owner}", path.display())]
    #[diagnostic(
        code(sphorge::sweep::locked),
        help("wait until it has ended: the same command then finds its runs; or choose another folder with `-o DIR`")
    )]
    Locked {
        /// The folder.
        path: PathBuf,
        /// The process, as it calls itself.
        owner: String,
    },
    /// It was stopped before all decks were read.
    #[error("the study was stopped before its first run")]
    #[diagnostic(code(sphorge::sweep::stopped))]
    Stopped,
    /// Something else is in the way, or cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
    /// A measure, a key or a spacing that there is not.
    #[error("{what}")]
    #[diagnostic(code(sphorge::sweep::unknown), help("{help}"))]
    Unknown {
        /// What is wrong.
        what: String,
        /// What there is.
        help: String,
    },
}

/// Values of a run, and what is set for it.
pub(super) type Set = (Vec<String>, Vec<(String, String)>);

/// Reads the deck with these changes.
pub(super) type Load<'a> = dyn Fn(&[(String, String)]) -> Result<Setup, DeckReport> + 'a;

impl Sweep {
    /// Plans every combination: reads and fills the deck of each by `load`, and looks at what the folder has of it. Nothing is written.
    ///
    /// # Errors
    /// See [`SweepError`]: the first run that cannot be made.
    pub fn plan(
        load: impl Fn(&[(String, String)]) -> Result<Setup, DeckReport>,
        varied: Vec<Varied>,
        planning: &Planning<'_>,
    ) -> Result<Self, SweepError> {
        check(&varied)?;
        let combinations = combinations(&varied);
        let set = combinations.into_iter().map(|values| {
            let set = varied.iter().map(|of| of.key.clone()).zip(values.iter().cloned()).collect();
            (values, set)
        });
        Self::of(&load, varied.clone(), set.collect(), planning)
    }

    /// The same for given combinations alone, each of as many values as there are keys: what a search for values asks for.
    ///
    /// # Errors
    /// As above.
    pub fn points(
        load: impl Fn(&[(String, String)]) -> Result<Setup, DeckReport>,
        keys: &[String],
        points: &[Vec<String>],
        planning: &Planning<'_>,
    ) -> Result<Self, SweepError> {
        let fault = |what: &str, help: &str| SweepError::Varied { what: what.to_owned(), help: help.to_owned() };
        if points.is_empty() || keys.is_empty() {
            return Err(fault("there is nothing to run", "give keys and a value for each"));
        }
        if points.len() > MOST_RUNS || points.iter().any(|point| point.len() != keys.len()) {
            return Err(fault("the points do not fit the keys", "give a value for each key"));
        }
        if points.iter().collect::<HashSet<_>>().len() < points.len() {
            return Err(fault("a point is given twice", "give each once"));
        }
        let set = |values: &Vec<String>| (values.clone(), keys.iter().cloned().zip(values.iter().cloned()).collect());
        let varied = |(k, key): (usize, &String)| Varied {
            key: key.clone(),
            values: points.iter().map(|point| point[k].clone()).collect(),
        };
        let varied = keys.iter().enumerate().map(varied).collect();
        Self::of(&load, varied, points.iter().map(set).collect(), planning)
    }

    /// The same for given values, each with what is set for it.
    pub(super) fn of(
        load: &Load<'_>,
        varied: Vec<Varied>,
        sets: Vec<Set>,
        planning: &Planning<'_>,
    ) -> Result<Self, SweepError> {
        let Planning { folder, engine, again, stop } = *planning;
        if RunDirectory::is_run(folder) {
            return Err(SweepError::Unknown {
                what: format!("{} is the folder of a run", folder.display()),
                help: "choose another folder with `-o DIR`: those of the runs are made in it".to_owned(),
            });
        }
        let count = sets.len();
        let mut names = HashSet::new();
        let mut runs = Vec::with_capacity(count);
        let mut measures = BTreeSet::new();
        for (k, (values, set)) in sets.into_iter().enumerate() {
            if stop.load(Ordering::Relaxed) {
                return Err(SweepError::Stopped);
            }
            let which = || format!("run {} of {count}", k + 1);
            let told = || set.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(", ");
            let setup = load(&set).map_err(|source| SweepError::Deck { which: which(), set: told(), source })?;
            if k == 0 {
                tell_apart(&setup.deck_text, &varied)?;
            }
            engine.supports(&setup.model).map_err(|unsupported| SweepError::Unsupported {
                engine: engine.name(),
                which: which(),
                unsupported,
            })?;
            measures.extend(setup.model.measures.iter().map(|measure| measure.name.clone()));
            let mut name = name::of(varied.iter().map(|of| of.key.as_str()).zip(values.iter().map(String::as_str)));
            if !names.insert(name.to_lowercase()) {
                name = name::told_apart(&name, &told());
                names.insert(name.to_lowercase());
            }
            let planned = planned(&folder.join(&name), &setup.deck_text, again)?;
            let notes = setup.all_notes();
            runs.push(SweepRun { name, values, deck_text: setup.deck_text, notes, planned });
        }
        Ok(Self { folder: folder.to_owned(), varied, runs, measures: measures.into_iter().collect(), again })
    }

    /// What there is to note of the runs: each once, with the number of the first run that it is of, and of how many it is.
    pub fn notes(&self) -> Vec<(&str, usize, usize)> {
        let mut notes: Vec<(&str, usize, usize)> = Vec::new();
        for (k, run) in self.runs.iter().enumerate() {
            for note in &run.notes {
                match notes.iter_mut().find(|(known, ..)| known == note) {
                    Some((_, _, count)) => *count += 1,
                    None => notes.push((note, k, 1)),
                }
            }
        }
        notes
    }

    /// Leaves the first of the runs as they are, though all are to be made again: the same study has made them.
    pub fn keep_first(&mut self, count: usize) {
        self.runs.iter_mut().take(count).for_each(|run| run.planned = Planned::Nothing);
    }

    /// The folder of a run.
    pub fn directory(&self, run: &SweepRun) -> PathBuf {
        self.folder.join(&run.name)
    }

    /// The deck of a run, as a file.
    pub fn deck(&self, run: &SweepRun) -> PathBuf {
        self.folder.join(format!("{}.toml", run.name))
    }
}

/// Refuses keys of which one would undo the other: rows of the table would state what no run had.
fn tell_apart(deck: &str, varied: &[Varied]) -> Result<(), SweepError> {
    let keys: Vec<&str> = varied.iter().map(|of| of.key.as_str()).collect();
    match overlapping_keys(deck, &keys) {
        None => Ok(()),
        Some((a, b)) => Err(SweepError::Varied {
            what: format!("`{}` and `{}` set the same", keys[a], keys[b]),
            help: "a vector and its components, or two names of one key, cannot be varied together: choose one"
                .to_owned(),
        }),
    }
}

/// What is wrong with keys and values as such.
fn check(varied: &[Varied]) -> Result<(), SweepError> {
    let fault = |what: String, help: &str| Err(SweepError::Varied { what, help: help.to_owned() });
    if varied.is_empty() {
        return fault("no key is varied".to_owned(), "give one: `--vary particles.spacing=\"0.6 mm,0.3 mm\"`");
    }
    // Before anything is read of them.
    let count = varied.iter().try_fold(1usize, |count, of| count.checked_mul(of.values.len()));
    if count.is_none_or(|count| count > MOST_RUNS) {
        return fault(format!("these are more than {MOST_RUNS} runs"), "vary fewer keys, or give fewer values");
    }
    for (k, of) in varied.iter().enumerate() {
        let key = &of.key;
        if varied[..k].iter().any(|other| other.key == *key) {
            return fault(format!("`{key}` is varied twice"), "give all of its values at once");
        }
        if of.values.is_empty() {
            return fault(format!("`{key}` has no values"), "give at least one");
        }
        let (mut texts, mut numbers) = (HashSet::new(), HashSet::new());
        let second = match of.numbers() {
            // Zero has two signs.
            Some((values, _)) => values.iter().position(|value| !numbers.insert((value + 0.0).to_bits())),
            None => of.values.iter().position(|value| !texts.insert(value)),
        };
        if let Some(second) = second {
            return fault(format!("`{key}` has the value `{}` twice", of.values[second]), "give each value once");
        }
    }
    Ok(())
}

/// Every combination of values, those of the last key changing first.
fn combinations(varied: &[Varied]) -> Vec<Vec<String>> {
    varied.iter().fold(vec![Vec::new()], |before, of| {
        let with = |values: &Vec<String>| {
            let values = values.clone();
            of.values.iter().map(move |value| [values.as_slice(), std::slice::from_ref(value)].concat())
        };
        before.iter().flat_map(with).collect()
    })
}

/// What there is to do for the run of a deck in a folder.
pub(super) fn planned(path: &Path, deck_text: &str, again: bool) -> Result<Planned, SweepError> {
    match RunDirectory::check(path, false) {
        Ok(()) => return Ok(Planned::New),
        Err(OutputError::Exists { .. }) => RunDirectory::check(path, true)?,
        Err(error) => return Err(error.into()),
    }
    if again {
        return Ok(Planned::Again);
    }
    let run = RunDirectory::open(path)?;
    match fs::read_to_string(run.deck()) {
        Ok(deck) if deck == deck_text => {}
        Ok(_) => return Err(SweepError::Another { path: path.to_owned() }),
        // Killed before there was one.
        Err(_) => return Ok(Planned::Again),
    }
    Ok(match Summary::read(&run) {
        Ok(summary) if summary.status != Status::Stopped => Planned::Nothing,
        _ if run.has_checkpoint() => Planned::Resume,
        _ => Planned::Again,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{decks, engine::ENGINES};

    fn varied(texts: &[&str]) -> Vec<Varied> {
        texts.iter().map(|text| Varied::read(text).unwrap()).collect()
    }

    fn planning(folder: &Path) -> Planning<'_> {
        static GO: AtomicBool = AtomicBool::new(false);
        Planning { folder, engine: ENGINES[0], again: false, stop: &GO }
    }

    fn plan(texts: &[&str], folder: &Path) -> Result<Sweep, SweepError> {
        let deck = decks::find("iron-plate").unwrap();
        let load = |set: &[(String, String)]| {
            let coarse = [("particles.spacing".to_owned(), "1.2 mm".to_owned())];
            crate::deck::load_text(deck.name, deck.text, &[&coarse[..], set].concat())
        };
        Sweep::plan(load, varied(texts), &planning(folder))
    }

    #[test]
    fn every_combination_is_a_run_under_its_own_name() {
        let folder = tempfile::tempdir().unwrap();
        let sweep = plan(&["body.bar.velocity.1=-100 m/s,-200 m/s", "particles.smoothing=1.1,1.2,1.3"], folder.path());
        let sweep = sweep.unwrap();
        let values: Vec<_> = sweep.runs.iter().map(|run| run.values.join(" ")).collect();
        assert_eq!(values[..4], ["-100 m/s 1.1", "-100 m/s 1.2", "-100 m/s 1.3", "-200 m/s 1.1"]);
        assert_eq!(sweep.runs[0].name, "body.bar.velocity.1=-100m_s,particles.smoothing=1.1");
        let names: HashSet<_> = sweep.runs.iter().map(|run| &run.name).collect();
        assert!(names.len() == 6 && sweep.runs.iter().all(|run| run.planned == Planned::New));
        assert!(sweep.runs[3].deck_text.contains("-200 m/s") && sweep.runs[3].deck_text.contains("1.2 mm"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn points_are_runs_as_they_are_given() {
        let folder = tempfile::tempdir().unwrap();
        let deck = decks::find("iron-plate").unwrap();
        let keys = ["body.bar.velocity.1", "particles.spacing"].map(str::to_owned);
        let plan = |points: &[[&str; 2]]| {
            let points: Vec<_> = points.iter().map(|point| point.map(str::to_owned).to_vec()).collect();
            let load = |set: &[(String, String)]| crate::deck::load_text(deck.name, deck.text, set);
            Sweep::points(load, &keys, &points, &planning(folder.path()))
        };
        let sweep = plan(&[["-100 m/s", "2 mm"], ["-50 m/s", "1.2 mm"], ["-100 m/s", "1.2 mm"]]).unwrap();
        let names: Vec<_> = sweep.runs.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names[1], "body.bar.velocity.1=-50m_s,particles.spacing=1.2mm");
        assert!(names.len() == 3 && sweep.runs[2].deck_text.contains("-100 m/s"));
        assert_eq!(sweep.varied[1].values, ["2 mm", "1.2 mm", "1.2 mm"]);
        for points in [&[][..], &[["-1 m/s", "2 mm"]; 2], &[["-1 m/s", "2 s"]]] {
            assert!(plan(points).is_err(), "{points:?}");
        }
    }

    #[test]
    fn a_stop_is_looked_at_before_each_deck() {
        let folder = tempfile::tempdir().unwrap();
        let deck = decks::find("iron-plate").unwrap();
        let (stop, read) = (AtomicBool::new(false), std::cell::Cell::new(0));
        let load = |set: &[(String, String)]| {
            read.set(read.get() + 1);
            stop.store(read.get() == 2, Ordering::Relaxed);
            let coarse = [("particles.spacing".to_owned(), "2 mm".to_owned())];
            crate::deck::load_text(deck.name, deck.text, &[&coarse[..], set].concat())
        };
        let planning = Planning { stop: &stop, ..planning(folder.path()) };
        let stopped = Sweep::plan(load, varied(&["time.max-steps=1,2,3,4"]), &planning);
        assert!(matches!(stopped, Err(SweepError::Stopped)) && read.get() == 2, "{stopped:?}");
        // Too many values are counted before they are compared with each other: of these none is new.
        let many = Varied { key: "time.max-steps".to_owned(), values: vec!["7".to_owned(); MOST_RUNS + 1] };
        assert!(check(&[many]).unwrap_err().to_string().contains("more than 10000 runs"));
    }

    #[test]
    fn faults_are_told_before_anything_is_run() {
        let folder = tempfile::tempdir().unwrap();
        let fault = |texts: &[&str]| {
            let error = plan(texts, folder.path()).unwrap_err();
            let mut told = error.to_string();
            if let SweepError::Deck { source, .. } = &error {
                told += &format!(" | {source} | {}", source.problems()[0].help().unwrap_or_default());
            }
            told
        };
        assert!(fault(&["time.end=1 us,2 us", "time.end=3 us"]).contains("`time.end` is varied twice"));
        for (a, b) in [
            ("body.bar.velocity.1=-1 m/s,-2 m/s", "body.0.velocity.1=-3 m/s"),
            ("\"particles\".spacing=1 mm", "particles.spacing=2 mm"),
            ("body.bar.velocity=[0,-1],[0,-2]", "body.bar.velocity.1=-3 m/s"),
        ] {
            let key = |text: &str| format!("`{}`", text.split_once('=').unwrap().0);
            let told = fault(&[a, b]);
            assert!(told.contains(&key(a)) && told.contains(&key(b)) && told.contains("set the same"), "{told}");
        }
        assert!(fault(&["time.end=1 us,1000 ns"]).contains("the value `1000 ns` twice"));
        assert!(fault(&["time.max-steps=1,2,1"]).contains("the value `1` twice"));
        let slip = fault(&["time.ent=1 us,2 us"]);
        assert!(
            slip.contains("run 1 of 2 cannot be run: time.ent=1 us") && slip.contains("did you mean `end`"),
            "{slip}"
        );
        let late = fault(&["body.bar.velocity.1=-100 m/s,-200 m"]);
        assert!(late.contains("run 2 of 2") && late.contains("expected a velocity"), "{late}");
        let many: String = (1..200).map(|k| format!(",{k}")).collect();
        let many = [format!("time.max-steps=1000{many}"), format!("audit=1000{many}")];
        assert!(fault(&[&many[0], &many[1]]).contains("more than 10000 runs"));
    }

    #[test]
    fn what_a_folder_has_decides_what_there_is_to_do() {
        use crate::output::testing;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run");
        let state = |again| planned(&path, "deck", again);
        assert_eq!(state(false).unwrap(), Planned::New);
        let run = RunDirectory::create(&path, false).unwrap();
        assert_eq!(state(false).unwrap(), Planned::Again);
        fs::write(run.deck(), "deck").unwrap();
        assert_eq!(state(false).unwrap(), Planned::Again);
        fs::write(path.join("checkpoint-000000000010.zip"), "").unwrap();
        assert_eq!(state(false).unwrap(), Planned::Resume);
        Summary { status: Status::Stopped, ..testing::summary(1.0) }.write(&run).unwrap();
        assert_eq!(state(false).unwrap(), Planned::Resume);
        for status in [Status::Completed, Status::CompletedWithWarnings, Status::Failed] {
            Summary { status, ..testing::summary(1.0) }.write(&run).unwrap();
            assert_eq!(state(false).unwrap(), Planned::Nothing);
        }
        assert_eq!(state(true).unwrap(), Planned::Again);
        fs::write(run.deck(), "another").unwrap();
        assert!(matches!(state(false), Err(SweepError::Another { .. })));
        drop(run);
        fs::remove_dir_all(&path).unwrap();
        fs::write(&path, "").unwrap();
        assert!(matches!(state(false), Err(SweepError::Output(_))));
    }
}
