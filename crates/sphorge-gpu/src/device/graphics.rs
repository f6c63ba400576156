//! GPUs that Vulkan, Metal and Direct3D 12 reach, through wgpu.

use super::deferred_error::DeferredError;
use super::{CardFault, Found, Interface};
use crate::record::{Access, Kernel};
use crate::source::WORKGROUP;
use std::sync::OnceLock;
use std::sync::mpsc::Receiver;
use wgpu::{
    Backends, BindingType, BufferBindingType, BufferUsages, DeviceType, ErrorFilter, Instance, InstanceDescriptor,
    ShaderStages,
};

/// Workgroups of a row of a launch; no GPU allows fewer.
const ROW: u32 = 65_535;

/// A GPU that is open.
#[derive(Debug)]
pub(super) struct Graphics {
    name: String,
    largest_buffer: u64,
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// The first thing that went wrong with a launch, a copy or the GPU itself. They are reported by the next wait.
    deferred_error: DeferredError,
}

/// A kernel compiled for a GPU.
#[derive(Clone, Debug)]
pub(super) struct Pipeline {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

/// A kernel with its buffers.
#[derive(Debug)]
pub(super) struct Bound {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    /// Workgroups of a row, and rows.
    groups: [u32; 2],
}

/// Adapters, GPUs before what stands for one.
///
/// They are looked for once, and what they belong to stays until the process ends: drivers that are loaded and unloaded on several threads
/// at a time crash (NVIDIA's 580.159).
pub(super) fn adapters() -> Vec<wgpu::Adapter> {
    static ADAPTERS: OnceLock<Vec<wgpu::Adapter>> = OnceLock::new();
    ADAPTERS.get_or_init(enumerate).clone()
}

fn enumerate() -> Vec<wgpu::Adapter> {
    let backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
    let instance = Instance::new(InstanceDescriptor { backends, ..InstanceDescriptor::new_without_display_handle() });
    let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu | DeviceType::Other => 2,
        DeviceType::Cpu => 3,
    });
    adapters
}

/// What an adapter is.
pub(super) fn found(adapter: &wgpu::Adapter) -> Found {
    let info = adapter.get_info();
    let limits = adapter.limits();
    Found {
        name: info.name,
        interface: match info.backend {
            wgpu::Backend::Metal => Interface::Metal,
            wgpu::Backend::Dx12 => Interface::Direct3d12,
            // No other is asked for.
            _ => Interface::Vulkan,
        },
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        is_software: info.device_type == DeviceType::Cpu,
        largest_buffer: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
        memory: None,
    }
}

impl Graphics {
    pub(super) fn open(adapter: &wgpu::Adapter) -> Result<Self, CardFault> {
        let Found { name, largest_buffer, .. } = found(adapter);
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        match pollster::block_on(adapter.request_device(&descriptor)) {
            Ok((device, queue)) => {
                let deferred_error = DeferredError::default();
                let (of_commands, of_device) = (deferred_error.clone(), deferred_error.clone());
                device.on_uncaptured_error(std::sync::Arc::new(move |error| of_commands.keep(error.to_string())));
                device.set_device_lost_callback(move |_, why| of_device.keep(why));
                Ok(Self { name, largest_buffer, device, queue, deferred_error })
            }
            Err(why) => Err(CardFault::DoesNotOpen { name, why: why.to_string() }),
        }
    }

    pub(super) fn zeros(&self, bytes: u64) -> Result<wgpu::Buffer, String> {
        if bytes > self.largest_buffer {
            return Err(format!("columns are up to {} bytes", self.largest_buffer));
        }
        let scopes = [ErrorFilter::OutOfMemory, ErrorFilter::Validation].map(|of| self.device.push_error_scope(of));
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        // The innermost first.
        for scope in scopes.into_iter().rev() {
            if let Some(error) = pollster::block_on(scope.pop()) {
                return Err(error.to_string());
            }
        }
        Ok(buffer)
    }

    pub(super) fn write(&self, buffer: &wgpu::Buffer, bytes: &[u8]) {
        self.queue.write_buffer(buffer, 0, bytes);
    }

    pub(super) fn compile(&self, kernel: &Kernel, text: &str) -> Result<Pipeline, String> {
        let scope = self.device.push_error_scope(ErrorFilter::Validation);
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&kernel.name),
            source: wgpu::ShaderSource::Wgsl(text.into()),
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
            None => Ok(Pipeline { pipeline, layout }),
            Some(error) => Err(error.to_string()),
        }
    }

    pub(super) fn bind(&self, of: &Pipeline, buffers: &[wgpu::Buffer], threads: u32) -> Result<Bound, String> {
        let groups = threads.div_ceil(WORKGROUP);
        let rows = groups.div_ceil(ROW).max(1);
        let row = groups.div_ceil(rows);
        let arguments = self.zeros(12)?;
        self.write(&arguments, bytemuck::cast_slice(&[threads, row * WORKGROUP, 0]));
        let entries: Vec<_> = buffers
            .iter()
            .chain([&arguments])
            .enumerate()
            .map(|(k, buffer)| wgpu::BindGroupEntry { binding: k as u32, resource: buffer.as_entire_binding() })
            .collect();
        let scope = self.device.push_error_scope(ErrorFilter::Validation);
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &of.layout,
            entries: &entries,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(Bound { pipeline: of.pipeline.clone(), group, groups: [row, rows] }),
            Some(error) => Err(error.to_string()),
        }
    }

    pub(super) fn launch<'a>(&self, launches: impl Iterator<Item = &'a Bound>) {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            for launch in launches {
                pass.set_pipeline(&launch.pipeline);
                pass.set_bind_group(0, &launch.group, &[]);
                pass.dispatch_workgroups(launch.groups[0], launch.groups[1], 1);
            }
        }
        self.queue.submit([encoder.finish()]);
    }

    /// Waits for everything that was launched.
    pub(super) fn wait(&self) -> Result<(), CardFault> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|why| self.lost(&why)).map(drop)
    }

    pub(super) fn read(&self, buffer: &wgpu::Buffer, count: usize) -> Result<Vec<f32>, CardFault> {
        let mut copying = self.reserve(count);
        copying.add(buffer, count);
        copying.close();
        copying.wait()
    }

    /// Memory for so many numbers that are copied back while the GPU goes on.
    pub(super) fn reserve(&self, count: usize) -> Copying {
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4 * count as u64,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let (name, device, queue) = (self.name.clone(), self.device.clone(), self.queue.clone());
        Copying { name, device, queue, deferred_error: self.deferred_error.clone(), copy, filled: 0, mapped: None }
    }

    fn lost(&self, why: &dyn std::fmt::Display) -> CardFault {
        CardFault::Lost { name: self.name.clone(), why: why.to_string() }
    }
}

/// Numbers on their way from a GPU, of one array behind the other.
#[derive(Debug)]
pub(super) struct Copying {
    name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    deferred_error: DeferredError,
    copy: wgpu::Buffer,
    /// Bytes that copies were queued for.
    filled: u64,
    mapped: Option<Mapped>,
}

/// When all of it is there.
#[derive(Debug)]
struct Mapped {
    receiver: Receiver<Result<(), wgpu::BufferAsyncError>>,
    submitted: wgpu::SubmissionIndex,
}

impl Copying {
    /// Queues a copy of the first numbers of a buffer behind everything that was launched.
    pub(super) fn add(&mut self, buffer: &wgpu::Buffer, count: usize) {
        let bytes = 4 * count as u64;
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &self.copy, self.filled, bytes);
        self.queue.submit([encoder.finish()]);
        self.filled += bytes;
    }

    /// Nothing is added any more.
    pub(super) fn close(&mut self) {
        let (sender, receiver) = std::sync::mpsc::channel();
        self.copy.slice(..self.filled).map_async(wgpu::MapMode::Read, move |result| {
            // Nobody waits any more where the GPU was lost.
            let _ = sender.send(result);
        });
        self.mapped = Some(Mapped { receiver, submitted: self.queue.submit([]) });
    }

    /// The numbers, when they are there.
    pub(super) fn wait(self) -> Result<Vec<f32>, CardFault> {
        let lost = |why: &dyn std::fmt::Display| CardFault::Lost { name: self.name.clone(), why: why.to_string() };
        let Some(Mapped { receiver, submitted }) = self.mapped else { return Ok(Vec::new()) };
        let poll = wgpu::PollType::Wait { submission_index: Some(submitted), timeout: None };
        self.device.poll(poll).map_err(|why| lost(&why))?;
        receiver.recv().map_err(|why| lost(&why))?.map_err(|why| lost(&why))?;
        if let Some(why) = self.deferred_error.first() {
            return Err(lost(&why));
        }
        let view = self.copy.slice(..self.filled).get_mapped_range().map_err(|why| lost(&why))?;
        Ok(bytemuck::cast_slice::<u8, f32>(&view).to_vec())
    }
}
