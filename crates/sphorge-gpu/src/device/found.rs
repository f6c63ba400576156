//! What cards there are.

use wgpu::{Backends, DeviceType, Instance, InstanceDescriptor};

/// A card, or what stands for one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// As its driver calls it.
    pub name: String,
    /// Through which interface it is reached: `Vulkan`, `Metal` or `Direct3D 12`.
    pub interface: &'static str,
    /// Its driver, with the version.
    pub driver: String,
    /// Whether it is a program on the processor: kernels are checked on it, but nothing is faster.
    pub is_software: bool,
    /// Largest buffer, bytes.
    pub largest_buffer: u64,
}

impl Found {
    pub(super) fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let limits = adapter.limits();
        let interface = match info.backend {
            wgpu::Backend::Vulkan => "Vulkan",
            wgpu::Backend::Metal => "Metal",
            wgpu::Backend::Dx12 => "Direct3D 12",
            wgpu::Backend::Noop | wgpu::Backend::Gl | wgpu::Backend::BrowserWebGpu => "another interface",
        };
        Self {
            name: info.name,
            interface,
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            is_software: info.device_type == DeviceType::Cpu,
            largest_buffer: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
        }
    }
}

/// Adapters, cards before what stands for one.
pub(super) fn adapters() -> Vec<wgpu::Adapter> {
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

/// Every card that is reached, the one that is taken without being asked for first.
pub fn find() -> Vec<Found> {
    adapters().iter().map(Found::of).collect()
}
