//! Ghosts: what stands behind the particles for what is not among them, images in symmetry planes and periodic copies, or particles
//! of other ranks.
//!
//! Ghosts own their columns. A [`Halo`] makes them with each neighbour search and brings their fields to those of the particles they
//! stand for at the points of the step that [`FieldSet`] names, all fields of a set together; readers never ask whom a ghost stands for.

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

/// What is exchanged at a named point of the step; the table of fields says which columns that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldSet {
    /// With every search: what does not change between searches, and positions.
    Search,
    /// For an audit, which has ghosts of its own: the state of the last step.
    Audit,
    /// Before the velocity gradient: positions and velocities.
    Motion,
    /// Before the density re-initialisation: densities.
    Density,
    /// Before the gradient correction of the forces: volumes.
    Volume,
    /// Before the contact overlaps: where faces are, and their velocities.
    Contact,
    /// Before the contact forces: overlaps.
    Overlaps,
    /// Before the forces: stresses and velocities.
    Stress,
    /// Before the forces: what the intermediate sums gave.
    IntermediateSums,
}

/// How a ghost's value follows from that of the particle it stands for, in a mirror or a periodic cell.
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

/// A column of particles, and that of the ghosts to be filled from it.
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

/// Packed records of particles and of the ghosts behind them; coordinates in them are left alone.
pub struct Packed<'a, T> {
    /// Entries of the particles' records, one record behind the other.
    pub own: &'a [T],
    /// Entries of the ghosts' records.
    pub ghosts: &'a mut [T],
    /// For each entry of a record the axes along which a mirror turns its sign: bit 0 for x, twice for none.
    pub axes: &'a [(u8, u8)],
}

/// Who the ghosts are, and where their values come from.
pub trait Halo: Send + Sync {
    /// A halo of the same kind that has no ghosts yet.
    fn another(&self) -> Box<dyn Halo>;
    /// Whether there can never be ghosts.
    fn is_empty(&self) -> bool;
    /// Whether there may be images, which go other ways than what they are images of.
    fn has_images(&self) -> bool;
    /// Number of ghosts.
    fn count(&self) -> usize;
    /// How far outside the particles a ghost may stand beyond the reach it was made for, m.
    fn longest_shift(&self) -> f64;
    /// Brings particles that left a periodic cell back in; says whether there were any.
    fn wrap(&self, positions: &mut [Vector<f64>]) -> bool;
    /// Makes the ghosts of all particles within `reach` (m) of where they are needed. Says whether they are others than before: then
    /// their numbers mean other points.
    fn rebuild(&mut self, positions: &[Vector<f64>], reach: f64) -> bool;
    /// Adds what ghosts of other ranks take over of these columns to the messages to them, and what those here do to what is to come from them.
    fn pack(&self, columns: &[GhostColumn<'_>], outgoing: &mut Outgoing);
    /// Fills the next column of the ghosts, the same ones, from the messages that have come and from particles of this domain.
    fn unpack(&self, column: GhostColumn<'_>, incoming: &mut Incoming);
    /// The point each ghost is an image of: a particle of this domain or, where that is of another rank, the ghost that stands for it; what is no
    /// image is its own.
    fn sources(&self) -> &[u32];
    /// The ghosts that are images, behind those that are not. Their sources are numbered as particles and ghosts are.
    fn images(&self) -> &[Image];
    /// Bytes held.
    fn bytes(&self) -> usize;
    /// Saves or loads who the ghosts are.
    ///
    /// # Errors
    /// The archive holds something else.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError>;
}
