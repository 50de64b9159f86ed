//! Compute pipelines by plain Vulkan, and what the driver tells of them: VK_KHR_pipeline_executable_properties.
//!
//! wgpu submits work when it opens a device, and a device that executes nothing is lost at that.

use std::{collections::BTreeMap, error::Error, ffi::CStr, time::Instant};

use ash::{khr::pipeline_executable_properties, vk};
use hsad::internals::{Binding, Stage};
use naga::{
    back::spv,
    proc::{BoundsCheckPolicies, BoundsCheckPolicy},
    valid::{Capabilities, ValidationFlags, Validator},
};

/// The driver's numbers of a pipeline by their names, and the time of its compilation in seconds.
pub type Statistics = (BTreeMap<String, u64>, f64);

/// The first device of the driver, kept until the process ends.
pub struct Compiler {
    device: ash::Device,
    executables: pipeline_executable_properties::Device,
    _instance: ash::Instance,
    _entry: ash::Entry,
}

impl Compiler {
    /// Opens the first device.
    pub fn open() -> Result<Self, Box<dyn Error>> {
        // SAFETY: the loader is Vulkan's; all handles stem from the calls before, and structs live as long as the calls.
        unsafe {
            let entry = ash::Entry::load()?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
            let instance =
                entry.create_instance(&vk::InstanceCreateInfo::default().application_info(&application), None)?;
            let physical = *instance.enumerate_physical_devices()?.first().ok_or("no device")?;
            let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
            let extensions = [pipeline_executable_properties::NAME.as_ptr()];
            let mut with_properties =
                vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
            let features = instance.get_physical_device_features(physical);
            let description = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_extension_names(&extensions)
                .enabled_features(&features)
                .push_next(&mut with_properties);
            let device = instance.create_device(physical, &description, None)?;
            let executables = pipeline_executable_properties::Device::new(&instance, &device);
            Ok(Self { device, executables, _instance: instance, _entry: entry })
        }
    }

    /// Compiles a stage.
    pub fn compile(&self, stage: &Stage) -> Result<Statistics, Box<dyn Error>> {
        let code = spirv(&stage.wgsl())?;
        let device = &self.device;
        // SAFETY: naga has validated the module, and the layout has its bindings.
        unsafe {
            let bindings: Vec<_> = (0..)
                .zip(stage.bindings)
                .map(|(binding, kind)| {
                    vk::DescriptorSetLayoutBinding::default()
                        .binding(binding)
                        .descriptor_type(descriptor_type(kind))
                        .descriptor_count(1)
                        .stage_flags(vk::ShaderStageFlags::COMPUTE)
                })
                .collect();
            let set = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            let sets = [device.create_descriptor_set_layout(&set, None)?];
            let layout =
                device.create_pipeline_layout(&vk::PipelineLayoutCreateInfo::default().set_layouts(&sets), None)?;
            let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&code), None)?;
            let main = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(module)
                .name(c"main");
            let pipeline = vk::ComputePipelineCreateInfo::default()
                .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
                .stage(main)
                .layout(layout);
            let start = Instant::now();
            let pipelines = device.create_compute_pipelines(vk::PipelineCache::null(), &[pipeline], None);
            let seconds = start.elapsed().as_secs_f64();
            let pipeline = pipelines.map_err(|(_, error)| error)?[0];
            let executable = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline);
            let statistics = self.executables.get_pipeline_executable_statistics(&executable)?;
            let number = |statistic: &vk::PipelineExecutableStatisticKHR<'_>| {
                let name = CStr::from_ptr(statistic.name.as_ptr()).to_string_lossy().into_owned();
                // All of the driver's numbers are of 64 bits.
                (name, statistic.value.u64)
            };
            Ok((statistics.iter().map(number).collect(), seconds))
        }
    }
}

/// The SPIR-V of a module, with the options that wgpu has for Vulkan.
fn spirv(wgsl: &str) -> Result<Vec<u32>, Box<dyn Error>> {
    let module = naga::front::wgsl::parse_str(wgsl)?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module)?;
    let entry = spv::PipelineOptions { shader_stage: naga::ShaderStage::Compute, entry_point: "main".into() };
    let options = spv::Options {
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            // Robust buffer access of the driver.
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Restrict,
            ..Default::default()
        },
        ..Default::default()
    };
    Ok(spv::write_vec(&module, &info, &options, Some(&entry))?)
}

fn descriptor_type(binding: &Binding) -> vk::DescriptorType {
    match binding {
        Binding::Uniform(_) => vk::DescriptorType::UNIFORM_BUFFER,
        Binding::Read | Binding::Write => vk::DescriptorType::STORAGE_BUFFER,
        Binding::Words | Binding::Map(_) => vk::DescriptorType::STORAGE_IMAGE,
        Binding::Picture => vk::DescriptorType::SAMPLED_IMAGE,
    }
}
