//! When lists that are kept are searched again.

use super::columns::Group;
use super::kernels::kept::{HIGH, LONGEST, LONGEST_ROW, LOW};
use super::kernels::limits::CHUNK;
use super::snapshot::read;
use super::start::stages;
use super::{GpuEngine, failure};
use sphorge_engine::model::Search;
use sphorge_engine::persist::{Archive, ArchiveError, Persist};
use sphorge_engine::{RunFailure, SearchReport};

/// Room beyond the longest list there was, as a share of it.
const SPARE: f64 = 0.25;

/// What is known of lists that are kept.
#[derive(Debug, Default)]
pub(super) struct Kept {
    /// Neighbours there is room for.
    pub(super) room: u32,
    /// Whether they were searched at all.
    is_made: bool,
    /// Number of the step of the last full search.
    pub(super) last_searched: u32,
}

/// The ways of all particles since the last full search.
struct Ways {
    /// Square of the longest, m².
    longest: f64,
    /// Square of the diagonal of their box, m².
    diagonal: f64,
}

impl GpuEngine {
    /// Makes the lists valid for the positions just reached.
    pub(super) fn refresh_kept(&mut self) -> Result<SearchReport, RunFailure> {
        let due = match self.model.search {
            Search::Skin { fraction } => !self.kept.is_made || self.moved_beyond_skin(fraction)?,
            Search::EveryStep | Search::Adaptive(_) | Search::Initial => true,
        };
        if due {
            self.search_all()?;
        } else if !self.model.contact_pairs().is_empty() {
            // The contact goes through the cells.
            self.card.launch(&self.stages.sorting);
        }
        Ok(SearchReport { searched_fraction: f64::from(u8::from(due)) })
    }

    /// Whether two particles may have closed in by more than the skin: by twice the longest way of any since the search, and by what the ways of all
    /// differ; images in planes of symmetry go other ways than their particles.
    fn moved_beyond_skin(&self, fraction: f64) -> Result<bool, RunFailure> {
        let smallest = self.initial.smoothing_length.iter().copied().fold(f64::INFINITY, f64::min);
        let skin = fraction * smallest * self.model.numerics.kernel.support();
        let ways = self.ways()?;
        let has_images = !self.model.symmetry.is_empty();
        Ok(ways.longest > 0.25 * skin * skin && (has_images || ways.diagonal > skin * skin))
    }

    fn ways(&self) -> Result<Ways, RunFailure> {
        self.card.launch(&self.stages.ways);
        let numbers = self.of_chunks()?;
        let largest = |k: usize| numbers(k).fold(f64::NEG_INFINITY, f64::max);
        let least = |k: usize| numbers(k).fold(f64::INFINITY, f64::min);
        let diagonal = (0..3).map(|a| (largest(HIGH + a) - least(LOW + a)).powi(2)).sum();
        Ok(Ways { longest: largest(LONGEST), diagonal })
    }

    /// The numbers of chunks, by their place.
    fn of_chunks(&self) -> Result<impl Fn(usize) -> Box<dyn Iterator<Item = f64>>, RunFailure> {
        let numbers = read(&self.card, &self.columns, Group::Ways)?;
        let chunks = self.stride / CHUNK;
        Ok(move |k: usize| {
            let of = numbers[k * chunks..(k + 1) * chunks].to_vec();
            Box::new(of.into_iter().map(f64::from)) as Box<dyn Iterator<Item = f64>>
        })
    }

    /// Searches the neighbours of all particles, with more room where there is too little.
    fn search_all(&mut self) -> Result<(), RunFailure> {
        self.card.launch(&self.stages.sorting);
        self.card.launch(&self.stages.search);
        let longest = self.of_chunks()?(LONGEST_ROW).fold(0.0, f64::max);
        if longest > f64::from(self.kept.room) {
            self.make_room(((1.0 + SPARE) * longest) as u32 + 1)?;
            self.set_step()?;
            self.card.launch(&self.stages.search);
        }
        self.kept.is_made = true;
        self.kept.last_searched = self.steps;
        Ok(())
    }

    /// Takes lists that have room for so many neighbours of each particle; what they held is lost.
    fn make_room(&mut self, room: u32) -> Result<(), RunFailure> {
        let kept = self.card.zeros(room as usize * self.stride).map_err(failure)?;
        self.columns.insert(Group::Kept, kept);
        self.kept.room = room;
        self.stages = stages(&self.card, &self.columns, &self.plan)?;
        Ok(())
    }

    /// Saves or loads what is known of lists that are kept, and takes the room that those which are to be loaded need.
    pub(super) fn persist_kept(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let mut room = self.kept.room;
        room.persist("kept.room", archive)?;
        self.kept.is_made.persist("kept.is_made", archive)?;
        self.kept.last_searched.persist("kept.last_searched", archive)?;
        if room != self.kept.room {
            self.make_room(room).map_err(|fault| ArchiveError::Unsupported(fault.to_string()))?;
        }
        Ok(())
    }
}
