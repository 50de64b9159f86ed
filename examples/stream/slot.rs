//! A slot of the ring: textures that a frame is uploaded to, and buffers that the host reads its results from.

use std::sync::mpsc::{Receiver, channel};

use hsad::{
    dense::{Destination, Inputs, Matcher, Outputs},
    features::{DESCRIPTOR_LENGTH, Detector, Feature, collect, keypoints::Keypoint},
    io::Picture,
    luma::Source,
    seeding::{Seeding, SeedingConfig},
    wgpu,
};

/// Result of a frame.
pub struct FrameResult {
    /// Index of the frame.
    pub index: usize,
    /// One disparity per pixel, in 1/256 px.
    pub disparities: Vec<i32>,
    /// Seeding from the frame's features, if it was run on this frame.
    pub seeding: Option<Seeding>,
}

/// Textures and buffers of one frame.
pub struct Slot {
    textures: [wgpu::Texture; 2],
    inputs: Inputs,
    outputs: Outputs,
    disparities: wgpu::Buffer,
    found: [Found; 2],
    sent: Option<Sent>,
}

/// A submitted frame.
struct Sent {
    index: usize,
    frame: [Picture; 2],
    seeded: bool,
    submission: wgpu::SubmissionIndex,
    mapped: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

/// Buffers from which the host reads a view's features.
struct Found {
    count: wgpu::Buffer,
    keypoints: wgpu::Buffer,
    descriptors: wgpu::Buffer,
}

/// A buffer of `size` bytes that the host reads.
fn staging(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
}

/// Reads the values of a mapped buffer and unmaps it.
fn values<T: bytemuck::Pod>(buffer: &wgpu::Buffer) -> Result<Vec<T>, wgpu::MapRangeError> {
    let values = bytemuck::pod_collect_to_vec(&buffer.get_mapped_range(..)?);
    buffer.unmap();
    Ok(values)
}

/// The output buffers of a detector.
fn found_by(detector: &Detector) -> [&wgpu::Buffer; 3] {
    let list = detector.keypoints();
    [list.found(), list.keypoints(), detector.descriptors()]
}

impl Found {
    fn new(device: &wgpu::Device, detector: &Detector) -> Self {
        let [count, keypoints, descriptors] = found_by(detector).map(|buffer| staging(device, buffer.size()));
        Self { count, keypoints, descriptors }
    }

    fn buffers(&self) -> [&wgpu::Buffer; 3] {
        [&self.count, &self.keypoints, &self.descriptors]
    }

    /// Reads the features from the mapped buffers, up to their capacity.
    fn features(&self) -> Result<Vec<Feature>, wgpu::MapRangeError> {
        let mut keypoints = values::<Keypoint>(&self.keypoints)?;
        keypoints.truncate(values::<u32>(&self.count)?[0] as usize);
        let descriptors = values::<[f32; DESCRIPTOR_LENGTH]>(&self.descriptors)?;
        Ok(collect(&keypoints, &descriptors))
    }
}

impl Slot {
    pub fn new(
        device: &wgpu::Device,
        matcher: &Matcher,
        detectors: &[Detector; 2],
        (width, height): (u32, u32),
    ) -> hsad::Result<Self> {
        let textures = [0; 2].map(|_| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("camera"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8UnormSrgb,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            })
        });
        let views = textures.each_ref().map(|texture| texture.create_view(&wgpu::TextureViewDescriptor::default()));
        let inputs = matcher.inputs(device, Source::Texture(&views[0]), Source::Texture(&views[1]))?;
        let disparities = staging(device, 4 * u64::from(width) * u64::from(height));
        let outputs = matcher.outputs(device, Destination::Buffer(&disparities), None)?;
        let found = detectors.each_ref().map(|detector| Found::new(device, detector));
        Ok(Self { textures, inputs, outputs, disparities, found, sent: None })
    }

    /// Uploads a frame and submits dense matching and, with `detectors`, feature detection.
    pub fn send(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        matcher: &Matcher,
        index: usize,
        frame: [Picture; 2],
        detectors: Option<&[Detector; 2]>,
    ) {
        for (texture, picture) in self.textures.iter().zip(&frame) {
            let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * picture.width()), ..Default::default() };
            queue.write_texture(texture.as_image_copy(), picture.rgba(), layout, texture.size());
        }
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        self.inputs.record(&mut encoder);
        matcher.record(&mut encoder, &self.outputs);
        for (detector, found) in detectors.into_iter().flatten().zip(&self.found) {
            detector.record(&mut encoder);
            for (from, to) in found_by(detector).into_iter().zip(found.buffers()) {
                encoder.copy_buffer_to_buffer(from, 0, to, 0, None);
            }
        }
        let submission = queue.submit([encoder.finish()]);
        let seeded = detectors.is_some();
        let (send, mapped) = channel();
        for buffer in self.mapped(seeded) {
            let send = send.clone();
            // If the slot was dropped, nobody receives the result.
            buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(send.send(result)));
        }
        self.sent = Some(Sent { index, frame, seeded, submission, mapped });
    }

    /// The buffers that the host reads.
    fn mapped(&self, seeded: bool) -> Vec<&wgpu::Buffer> {
        let features = self.found.iter().filter(|_| seeded).flat_map(Found::buffers);
        [&self.disparities].into_iter().chain(features).collect()
    }

    /// Waits for the submitted frame, if there is one, but not for frames submitted later.
    pub fn collect(&mut self, device: &wgpu::Device) -> Result<Option<FrameResult>, Box<dyn std::error::Error>> {
        let Some(Sent { index, frame, seeded, submission, mapped }) = self.sent.take() else { return Ok(None) };
        device.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: None })?;
        for result in mapped {
            result?;
        }
        let disparities = values(&self.disparities)?;
        let seeding = match seeded {
            false => None,
            true => {
                let [left, right] = [self.found[0].features()?, self.found[1].features()?];
                let views = frame.each_ref().map(Picture::luma);
                Some(Seeding::find((&views[0], &views[1]), (&left, &right), &SeedingConfig::default())?)
            }
        };
        Ok(Some(FrameResult { index, disparities, seeding }))
    }
}
