//! Ghost particles: images in symmetry planes, periodic copies, and particles of other ranks. They are stored behind
//! the particles.
//!
//! Ghosts have their own columns. A [`Halo`] creates them at each neighbour search. At the points of the step that
//! [`FieldSet`] names it updates their fields from the particles they represent, all fields of a set together. Readers
//! need not know which particle a ghost represents.

mod bytes;
mod images;
mod parcels;
mod remote;

pub use images::{Image, Images};
pub(crate) use parcels::{Arrival, Columns, Exchanged, ExchangedSets, begin, fill, finish};
pub use parcels::{Incoming, Outgoing};
pub(crate) use remote::Remote;

use crate::persist::{Archive, ArchiveError};
use sphorge_physics::{SymmetricTensor, Tensor, Vector};

/// The fields that are exchanged at a point of the step; the table of fields says which columns these are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldSet {
    /// With every search: fields that do not change between searches, and positions.
    Search,
    /// For an audit, which has its own ghosts: the state of the last step.
    Audit,
    /// Before the velocity gradient: positions and velocities.
    Motion,
    /// Before the density re-initialisation: densities.
    Density,
    /// Before the gradient correction of the forces: volumes.
    Volume,
    /// Before the contact overlaps: positions of faces and their velocities.
    Contact,
    /// Before the contact forces: overlaps.
    Overlaps,
    /// Before the forces: stresses and velocities.
    Stress,
    /// Before the forces: results of the intermediate sums.
    IntermediateSums,
}

/// How the value of a ghost follows from that of its particle, in a mirror or a periodic cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// Ghosts do not have it.
    Unmirrored,
    /// As it is.
    Same,
    /// A point: mirrored and shifted.
    Point,
    /// A vector: mirrored.
    Vector,
    /// A symmetric tensor: mirrored.
    Symmetric,
    /// A tensor: mirrored.
    Tensor,
}

/// A column of particles, and the column of the ghosts to be filled from it.
pub enum GhostColumn<'a> {
    /// Numbers that are the same in every image.
    Scalar(&'a [f64], &'a mut [f64]),
    /// Whole numbers.
    Integer(&'a [u32], &'a mut [u32]),
    /// Points, m.
    Point(&'a [Vector<f64>], &'a mut [Vector<f64>]),
    /// Vectors.
    Vector(&'a [Vector<f64>], &'a mut [Vector<f64>]),
    /// Symmetric tensors.
    Symmetric(&'a [SymmetricTensor<f64>], &'a mut [SymmetricTensor<f64>]),
    /// Tensors.
    Tensor(&'a [Tensor<f64>], &'a mut [Tensor<f64>]),
    /// Packed records in single precision.
    Single(Packed<'a, f32>),
    /// Packed records in double precision.
    Double(Packed<'a, f64>),
}

/// Packed records of particles and of the ghosts behind them; their coordinates are not changed.
pub struct Packed<'a, T> {
    /// Entries of the particles' records, stored contiguously.
    pub own: &'a [T],
    /// Entries of the ghosts' records, likewise.
    pub ghosts: &'a mut [T],
    /// For each entry of a record the axes along which a mirror image changes its sign: bit 0 for x; set twice for no
    /// change.
    pub axes: &'a [(u8, u8)],
}

/// The list of ghosts and the sources of their values.
pub trait Halo: Send + Sync {
    /// A halo of the same kind that has no ghosts yet.
    fn another(&self) -> Box<dyn Halo>;
    /// Whether there can never be ghosts.
    fn is_empty(&self) -> bool;
    /// Whether there may be images, which move differently from their sources.
    fn has_images(&self) -> bool;
    /// Number of ghosts.
    fn count(&self) -> usize;
    /// How far outside the particles a ghost may be beyond the reach for which it was created, m.
    fn longest_shift(&self) -> f64;
    /// Moves particles that left a periodic cell back into it, and where they `started` as far; returns whether there were any.
    fn wrap(&self, positions: &mut [Vector<f64>], started: &mut [Vector<f64>]) -> bool;
    /// Creates the ghosts of all particles within `reach` (m) of where they are needed. Returns whether they differ
    /// from the previous ones; their indices then refer to other points.
    fn rebuild(&mut self, positions: &[Vector<f64>], reach: f64) -> bool;
    /// Adds the values of these columns for ghosts on other ranks to the messages, and the ghosts of this rank to the
    /// expected lengths.
    fn pack(&self, columns: &[GhostColumn<'_>], outgoing: &mut Outgoing);
    /// Fills the next of the same columns of the ghosts, from the received messages and from particles of this domain.
    fn unpack(&self, column: GhostColumn<'_>, incoming: &mut Incoming);
    /// The point of which each ghost is an image: a particle of this domain or, if that is on another rank, the ghost
    /// that represents it; for a ghost that is not an image itself.
    fn sources(&self) -> &[u32];
    /// The ghosts that are images; they follow those that are not. Their sources are indices of particles and ghosts.
    fn images(&self) -> &[Image];
    /// Bytes held.
    fn bytes(&self) -> usize;
    /// Saves or loads the list of ghosts.
    ///
    /// # Errors
    /// The archive does not contain it.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError>;
}
