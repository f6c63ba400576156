//! A card that is open: its memory, and launches.

use super::found::adapters;
use super::{CardFault, Found, Program};
use crate::source::WORKGROUP;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{BufferUsages, ErrorFilter};

/// Workgroups of a row of a launch; no card allows fewer.
const ROW: u32 = 65_535;

/// A card that is open.
#[derive(Debug)]
pub struct Card {
    found: Found,
    pub(super) device: wgpu::Device,
    queue: wgpu::Queue,
    /// The first thing that went wrong with a launch, a copy or the card itself. They are told when they are waited for.
    trouble: Trouble,
}

/// What went wrong first, if anything did.
#[derive(Clone, Debug, Default)]
struct Trouble(Arc<Mutex<Option<String>>>);

impl Trouble {
    fn keep(&self, why: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
    }

    fn first(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// A kernel with its buffers.
#[derive(Debug)]
pub struct Launch {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    /// Workgroups of a row, and rows.
    groups: [u32; 2],
}

/// Numbers or whole numbers in the memory of a card.
#[derive(Debug)]
pub struct Array {
    buffer: wgpu::Buffer,
    /// Number of elements, of four bytes each.
    count: usize,
}

impl Array {
    /// Number of elements.
    pub fn count(&self) -> usize {
        self.count
    }
}

impl Card {
    /// Opens a card: the first whose name contains the words asked for, whatever their case, or the first of all.
    ///
    /// # Errors
    /// There is none, or it does not open.
    pub fn open(asked: Option<&str>) -> Result<Self, CardFault> {
        let adapters = adapters();
        let is_asked = |adapter: &&wgpu::Adapter| {
            asked.is_none_or(|words| adapter.get_info().name.to_lowercase().contains(&words.to_lowercase()))
        };
        let Some(adapter) = adapters.iter().find(is_asked) else {
            return Err(not_found(asked, &adapters));
        };
        let found = Found::of(adapter);
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        match pollster::block_on(adapter.request_device(&descriptor)) {
            Ok((device, queue)) => {
                let trouble = Trouble::default();
                let (of_commands, of_device) = (trouble.clone(), trouble.clone());
                device.on_uncaptured_error(Arc::new(move |error| of_commands.keep(error.to_string())));
                device.set_device_lost_callback(move |_, why| of_device.keep(why));
                Ok(Self { found, device, queue, trouble })
            }
            Err(why) => Err(CardFault::DoesNotOpen { name: found.name, why: why.to_string() }),
        }
    }

    /// What it is.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// Room for that many elements, all zero.
    ///
    /// # Errors
    /// There is no room.
    pub fn zeros(&self, count: usize) -> Result<Array, CardFault> {
        // No binding is empty.
        let bytes = 4 * count.max(1) as u64;
        if bytes > self.found.largest_buffer {
            let why = format!("columns are up to {} bytes", self.found.largest_buffer);
            return Err(CardFault::Memory { name: self.found.name.clone(), bytes, why });
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
                let name = self.found.name.clone();
                return Err(CardFault::Memory { name, bytes, why: error.to_string() });
            }
        }
        Ok(Array { buffer, count })
    }

    /// Numbers, copied to the card.
    ///
    /// # Errors
    /// There is no room.
    pub fn numbers(&self, numbers: &[f32]) -> Result<Array, CardFault> {
        let array = self.zeros(numbers.len())?;
        self.queue.write_buffer(&array.buffer, 0, bytemuck::cast_slice(numbers));
        Ok(array)
    }

    /// Whole numbers, copied to the card.
    ///
    /// # Errors
    /// There is no room.
    pub fn indices(&self, indices: &[u32]) -> Result<Array, CardFault> {
        let array = self.zeros(indices.len())?;
        self.queue.write_buffer(&array.buffer, 0, bytemuck::cast_slice(indices));
        Ok(array)
    }

    /// Overwrites the first numbers of an array, after everything that was launched.
    pub fn write(&self, array: &Array, numbers: &[f32]) {
        self.queue.write_buffer(&array.buffer, 0, bytemuck::cast_slice(&numbers[..numbers.len().min(array.count)]));
    }

    /// Binds a kernel to its buffers, in their order, for launches of that many threads.
    ///
    /// # Errors
    /// There is no room for the arguments, or the buffers are not those of the kernel.
    pub fn bind(&self, program: &Program, arrays: &[&Array], threads: u32) -> Result<Launch, CardFault> {
        let groups = threads.div_ceil(WORKGROUP);
        let rows = groups.div_ceil(ROW).max(1);
        let row = groups.div_ceil(rows);
        let arguments = self.indices(&[threads, row * WORKGROUP, 0])?;
        let entries: Vec<_> = arrays
            .iter()
            .copied()
            .chain([&arguments])
            .enumerate()
            .map(|(k, array)| wgpu::BindGroupEntry { binding: k as u32, resource: array.buffer.as_entire_binding() })
            .collect();
        let scope = self.device.push_error_scope(ErrorFilter::Validation);
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &program.layout,
            entries: &entries,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(Launch { pipeline: program.pipeline.clone(), group, groups: [row, rows] }),
            Some(error) => Err(CardFault::Kernel { kernel: program.name.clone(), why: error.to_string() }),
        }
    }

    /// Launches kernels one after the other, each when what the last has written is there.
    pub fn launch<'a>(&self, launches: impl IntoIterator<Item = &'a Launch>) {
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

    /// Copies numbers back, after everything that was launched.
    ///
    /// # Errors
    /// The card does not answer, or something that was asked of it before went wrong.
    pub fn read(&self, array: &Array) -> Result<Vec<f32>, CardFault> {
        let bytes = array.buffer.size();
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&array.buffer, 0, &copy, 0, bytes);
        self.queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        copy.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            // Nobody waits any more where the card was lost.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|why| self.lost(&why))?;
        receiver.recv().map_err(|why| self.lost(&why))?.map_err(|why| self.lost(&why))?;
        if let Some(why) = self.trouble.first() {
            return Err(self.lost(&why));
        }
        let view = copy.slice(..).get_mapped_range().map_err(|why| self.lost(&why))?;
        Ok(bytemuck::cast_slice::<u8, f32>(&view)[..array.count].to_vec())
    }

    fn lost(&self, why: &dyn std::fmt::Display) -> CardFault {
        CardFault::Lost { name: self.found.name.clone(), why: why.to_string() }
    }
}

fn not_found(asked: Option<&str>, adapters: &[wgpu::Adapter]) -> CardFault {
    let names: Vec<_> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    let (what, help) = match asked {
        Some(words) if !names.is_empty() => (format!("no card is called `{words}`"), format!("there are: {}", names.join(", "))),
        _ => (
            "no card is reached by Vulkan, Metal or Direct3D 12".to_owned(),
            "install the driver of the card; on Linux also `libvulkan1`, and `mesa-vulkan-drivers` to try kernels without one"
                .to_owned(),
        ),
    };
    CardFault::NotFound { what, help }
}

#[cfg(test)]
impl Array {
    /// Takes the memory of an array away, as a card that is lost does.
    pub(crate) fn destroy(&self) {
        self.buffer.destroy();
    }
}
