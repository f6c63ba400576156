//! The kernels of a model as texts in the languages of GPUs.

use super::columns::Recording;
use super::kernels::limits;
use super::kernels::reference::References;
use super::plan::{Grids, Plan, Rows};
use super::ranks::exchange;
use super::ranks::touched::{ALL, ColumnSet, Touched};
use super::segments::Segments;
use super::start::grid_of;
use crate::record::KernelFault;
use sphorge_engine::{Model, Particles};

/// The source of a kernel of the step in the languages of GPUs.
#[derive(Clone, Debug)]
pub struct KernelText {
    /// Its name.
    pub name: String,
    /// For Vulkan, Metal and Direct3D 12.
    pub wgsl: String,
    /// For CUDA.
    pub cuda: String,
}

/// Every kernel of the step of a model that [`super::Gpu`] supports.
///
/// # Errors
/// A law cannot be translated for a GPU.
pub fn kernel_texts(model: &Model, particles: &Particles) -> Result<Vec<KernelText>, KernelFault> {
    let stride = particles.len().div_ceil(limits::CHUNK) * limits::CHUNK;
    let partition = Segments::of(model, particles, particles.len()).partition();
    let rows = Rows { stride, are_shared: false, partition };
    let grid = grid_of(model, particles);
    let of = |references| Plan::of(model, particles, rows, Grids::one(&grid), references);
    let text = |recording: &Recording| KernelText {
        name: recording.kernel.name.clone(),
        wgsl: crate::source::wgsl(&recording.kernel),
        cuda: crate::source::cuda(&recording.kernel),
    };
    let of_plan = |plan: &Plan| -> Vec<_> {
        plan.all().chain(plan.reductions.iter().map(|planned| &planned.kernel)).map(text).collect()
    };
    let mut texts = of_plan(&of(References::Initial)?);
    if model.formulation.renews() {
        // Kernels that change once a body has separated.
        for mut other in of_plan(&of(References::Renewed)?) {
            if !texts.iter().any(|known| known.cuda == other.cuda) {
                other.name += "_renewed";
                texts.push(other);
            }
        }
    }
    each_kernel_of_ranks(model, particles, stride, &mut |recording| {
        let mut other = text(recording);
        if !texts.iter().any(|known| known.cuda == other.cuda) {
            other.name += "_shared";
            texts.push(other);
        }
    })?;
    Ok(texts)
}

/// Visits the kernels of a model whose particles are shared by several GPUs, and the kernels of the halo exchange.
fn each_kernel_of_ranks(
    model: &Model,
    p: &Particles,
    stride: usize,
    visit: &mut dyn FnMut(&Recording),
) -> Result<(), KernelFault> {
    let partition = Segments::of(model, p, p.len()).partition();
    let rows = Rows { stride, are_shared: true, partition };
    let plan = Plan::of(model, p, rows, Grids::one(&grid_of(model, p)), References::Initial)?;
    let mut gathered = ColumnSet::new();
    for recording in plan.all() {
        for (group, columns) in Touched::of(recording, stride, false).gathered {
            *gathered.entry(group).or_default() |= columns;
        }
    }
    // Columns whose index is unknown are those of the longest group.
    gathered.values_mut().filter(|columns| **columns == ALL).for_each(|columns| *columns = 1);
    plan.all().chain(&exchange::kernels(&gathered, stride, p.len())?).for_each(visit);
    Ok(())
}
