//! A kernel compiled for a card.

use super::{Card, CardFault};
use crate::record::{Access, Kernel};
use crate::source::wgsl;
use wgpu::{BindingType, BufferBindingType, ErrorFilter, ShaderStages};

/// A kernel compiled for a card.
#[derive(Debug)]
pub struct Program {
    pub(super) name: String,
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
}

impl Card {
    /// Compiles a kernel.
    ///
    /// # Errors
    /// The driver does not take it.
    pub fn compile(&self, kernel: &Kernel) -> Result<Program, CardFault> {
        let scope = self.device.push_error_scope(ErrorFilter::Validation);
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&kernel.name),
            source: wgpu::ShaderSource::Wgsl(wgsl(kernel).into()),
        });
        let accesses = kernel.buffers.iter().map(|buffer| buffer.access).chain([Access::Read]);
        let entries: Vec<_> = accesses
            .enumerate()
            .map(|(k, access)| wgpu::BindGroupLayoutEntry {
                binding: k as u32,
                visibility: ShaderStages::COMPUTE,
                ty: BindingType::Buffer {
                    ty: BufferBindingType::Storage { read_only: access == Access::Read },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        let label = Some(kernel.name.as_str());
        let layout =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(&kernel.name),
            compilation_options: Default::default(),
            cache: None,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(Program { name: kernel.name.clone(), pipeline, layout }),
            Some(error) => Err(CardFault::Kernel { kernel: kernel.name.clone(), why: error.to_string() }),
        }
    }
}
