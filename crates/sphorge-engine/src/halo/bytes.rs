//! Columns of ghosts as bytes between ranks.

use super::{GhostColumn, Packed};
use crate::RunFailure;
use crate::persist::Fixed;

/// Bytes that a ghost receives.
pub(super) fn width(column: &GhostColumn<'_>) -> usize {
    fn of<V: Fixed>(_: &[V]) -> usize {
        V::SIZE
    }
    match column {
        GhostColumn::Scalar(own, _) => of(own),
        GhostColumn::Integer(own, _) => of(own),
        GhostColumn::Point(own, _) | GhostColumn::Vector(own, _) => of(own),
        GhostColumn::Symmetric(own, _) => of(own),
        GhostColumn::Tensor(own, _) => of(own),
        GhostColumn::Single(records) => records.axes.len() * of(records.own),
        GhostColumn::Double(records) => records.axes.len() * of(records.own),
    }
}

/// Writes the values of these particles for their ghosts.
pub(super) fn write(column: &GhostColumn<'_>, particles: &[u32], bytes: &mut Vec<u8>) {
    fn values<V: Fixed>(own: &[V], particles: &[u32], bytes: &mut Vec<u8>) {
        particles.iter().for_each(|&i| own[i as usize].write(bytes));
    }
    fn records<V: Fixed>(records: &Packed<'_, V>, particles: &[u32], bytes: &mut Vec<u8>) {
        let width = records.axes.len();
        let record = |&i: &u32| records.own[i as usize * width..][..width].iter();
        particles.iter().flat_map(record).for_each(|value| value.write(bytes));
    }
    match column {
        GhostColumn::Scalar(own, _) => values(own, particles, bytes),
        GhostColumn::Integer(own, _) => values(own, particles, bytes),
        GhostColumn::Point(own, _) | GhostColumn::Vector(own, _) => values(own, particles, bytes),
        GhostColumn::Symmetric(own, _) => values(own, particles, bytes),
        GhostColumn::Tensor(own, _) => values(own, particles, bytes),
        GhostColumn::Single(of) => records(of, particles, bytes),
        GhostColumn::Double(of) => records(of, particles, bytes),
    }
}

/// Fills ghosts from index `first` on with the values written for their particles.
///
/// # Errors
/// The bytes are invalid.
pub(super) fn read(column: &mut GhostColumn<'_>, first: usize, bytes: &[u8]) -> Result<(), RunFailure> {
    fn values<V: Fixed>(ghosts: &mut [V], bytes: &[u8]) -> Result<(), RunFailure> {
        for (ghost, bytes) in ghosts.iter_mut().zip(bytes.chunks_exact(V::SIZE)) {
            *ghost = V::read(bytes).ok_or_else(crate::ranks::unreadable)?;
        }
        Ok(())
    }
    match column {
        GhostColumn::Scalar(_, ghosts) => values(&mut ghosts[first..], bytes),
        GhostColumn::Integer(_, ghosts) => values(&mut ghosts[first..], bytes),
        GhostColumn::Point(_, ghosts) | GhostColumn::Vector(_, ghosts) => values(&mut ghosts[first..], bytes),
        GhostColumn::Symmetric(_, ghosts) => values(&mut ghosts[first..], bytes),
        GhostColumn::Tensor(_, ghosts) => values(&mut ghosts[first..], bytes),
        GhostColumn::Single(records) => values(&mut records.ghosts[first * records.axes.len()..], bytes),
        GhostColumn::Double(records) => values(&mut records.ghosts[first * records.axes.len()..], bytes),
    }
}
