//! The terms of particles at faces, found in double precision in the reference configuration: see [`super::kernels::face_sums`].

use super::columns::{Group, Handles, Layout, groups};
use super::kernels::face_sums::SPREAD;
use super::kernels::images::Planes;
use super::read_back::{Group64, read};
use super::{GpuEngine, failure};
use rayon::prelude::*;
use sphorge_engine::{FaceConfiguration, FaceNeighbor, FaceTerm, FaceTerms, RunFailure, face_terms};
use sphorge_physics::{Tensor, Vector};
use std::sync::Arc;

impl GpuEngine {
    /// Finds the faces of the present reference configuration, once its lists and gradient corrections are known, and copies their terms to
    /// the GPU.
    pub(super) fn find_faces(&mut self) -> Result<(), RunFailure> {
        if !self.model.formulation.is_quadratic_at_faces() {
            return Ok(());
        }
        let terms = self.terms_of_faces()?;
        self.write_faces(&terms)?;
        self.rebind()
    }

    fn terms_of_faces(&self) -> Result<FaceTerms, RunFailure> {
        let whole = |group: Group| -> Result<Vec<u32>, RunFailure> {
            Ok(read(&self.card, &self.columns, group)?.into_iter().map(f32::to_bits).collect())
        };
        let group = |group: Group| -> Result<Group64, RunFailure> {
            Ok(Group64::new(Arc::new(read(&self.card, &self.columns, group)?), self.stride))
        };
        let (starts, list) = (whole(Group::ListStarts)?, whole(Group::List)?);
        let (reference, constants, corrections) =
            (group(Group::Reference)?, group(Group::Constants)?, group(Group::Correction)?);
        let of = groups::Reference::layout();
        let all = || (0..self.initial.len()).into_par_iter().with_min_len(1 << 10);
        let position: Vec<Vector<f64>> =
            all().map(|i| [0, 1, 2].map(|a| reference.double(of.position.axis(a), i))).collect();
        let volume: Vec<f64> = all().map(|i| reference.double(of.volume, i)).collect();
        let of_length = groups::Constants::layout().smoothing_length;
        let smoothing_length: Vec<f64> = all().map(|i| constants.number(of_length, i)).collect();
        let of = groups::Correction::layout().correction;
        let component = |k: usize, i: usize| corrections.number(of.component(k), i);
        let correction: Vec<Tensor<f64>> =
            all().map(|i| [0, 1, 2].map(|a| [0, 1, 2].map(|b| component(3 * a + b, i)))).collect();
        let planes = Planes::of(&self.model);
        let neighbor = |entry: &u32| {
            let (j, image) = Planes::split(*entry);
            let along = [0, 1, 2].map(|axis| planes.coordinate(image, axis, position[j][axis]));
            FaceNeighbor {
                source: j,
                mirrored: along.map(|(_, mirrored)| mirrored),
                position: along.map(|(x, _)| x),
                smoothing_length: smoothing_length[j],
                volume: volume[j],
            }
        };
        Ok(face_terms(&FaceConfiguration {
            position: &position,
            smoothing_length: &smoothing_length,
            volume: &volume,
            correction: &correction,
            body: &self.initial.body,
            has_come_apart: &self.has_separated,
            kernel: self.model.numerics.kernel,
            dimension: self.model.dimensions.into(),
            row: |i: usize| list[starts[i] as usize..starts[i + 1] as usize].iter().map(neighbor),
        }))
    }

    fn write_faces(&mut self, of: &FaceTerms) -> Result<(), RunFailure> {
        let Self { card, columns, stride, .. } = self;
        let mut insert = |group: Group, numbers: &[u32]| -> Result<(), RunFailure> {
            columns.insert(group, card.indices(numbers).map_err(failure)?);
            Ok(())
        };
        // Row zero has no terms.
        let starts: Vec<u32> = [0].iter().chain(&of.starts).copied().collect();
        let near_faces: Vec<u32> = of.face_of_near.iter().map(|face| face.map_or(0, |face| face + 1)).collect();
        insert(Group::FaceParticles, &of.faces)?;
        insert(Group::FaceStarts, &starts)?;
        insert(Group::FaceEntries, &entries(&of.terms, 0))?;
        insert(Group::NearParticles, &of.near)?;
        insert(Group::NearStarts, &of.near_starts)?;
        insert(Group::NearEntries, &entries(&of.near_terms, 1))?;
        insert(Group::NearFaces, &near_faces)?;
        if self.model.has_facets() {
            let mut rows = vec![0; *stride];
            of.faces.iter().zip(1..).for_each(|(i, row)| rows[*i as usize] = row);
            insert(Group::FaceRows, &rows)?;
        }
        let width = <groups::FaceTable<()> as Handles<()>>::LENGTH;
        let mut table = vec![0.0f32; width];
        for (contraction, whole) in of.contraction.iter().zip(&of.whole) {
            table.extend(contraction.as_flattened().as_flattened().iter().chain(whole).map(|number| *number as f32));
        }
        let slopes = |terms: &[FaceTerm]| -> Vec<f32> {
            terms.iter().flat_map(|term| term.q).map(|number| number as f32).collect()
        };
        for (group, numbers) in [
            (Group::FaceTable, table),
            (Group::FaceTerms, slopes(&of.terms)),
            (Group::NearTerms, slopes(&of.near_terms)),
        ] {
            columns.insert(group, card.numbers(&numbers).map_err(failure)?);
        }
        // Nothing is taken from particles that were at faces.
        for (group, count) in [
            (Group::FaceSpread, SPREAD * (of.faces.len() + 1)),
            (Group::FaceTaken, <groups::FaceTaken<()> as Handles<()>>::LENGTH * *stride),
            (Group::FaceShare, <groups::FaceShare<()> as Handles<()>>::LENGTH * *stride),
        ] {
            columns.insert(group, card.zeros(count).map_err(failure)?);
        }
        Ok(())
    }
}

/// Entries of lists: neighbours, or rows that begin after `first`, with the axes along which they are images.
fn entries(terms: &[FaceTerm], first: u32) -> Vec<u32> {
    terms.iter().map(|term| Planes::join(term.other + first, Planes::code_of(term.mirrored))).collect()
}
