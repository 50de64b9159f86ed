//! A slot of the ring: textures that a frame is uploaded to, and memory that the host reads its results from.

use std::sync::Arc;

use hsad::{
    dense::{Dense, Inputs, MapReadback},
    disparity::DisparityRange,
    features::FeatureReadback,
    gpu::block_on,
    image::Size,
    io::Picture,
    luma::Source,
    seeding::{Seeding, SeedingConfig},
    wgpu,
};

use crate::engine::Engine;

/// Result of a frame.
pub struct FrameResult {
    /// Index of the frame.
    pub index: usize,
    /// The range that was searched.
    pub range: DisparityRange,
    /// Disparities with their confidences.
    pub map: Dense,
    /// Seeding from the frame's features, if it was run on this frame.
    pub seeding: Option<Seeding>,
}

/// Textures and host memory of one frame.
pub struct Slot {
    pub engine: Arc<Engine>,
    textures: [wgpu::Texture; 2],
    inputs: Inputs,
    map: MapReadback,
    features: [FeatureReadback; 2],
    sent: Option<Sent>,
}

/// A submitted frame.
pub struct Sent {
    pub index: usize,
    pub frame: [Picture; 2],
    /// Whether its features are detected.
    pub seeded: bool,
}

impl Slot {
    pub fn new(engine: &Arc<Engine>, Size { width, height }: Size) -> hsad::Result<Self> {
        let textures = [0; 2].map(|_| {
            engine.gpu.device.create_texture(&wgpu::TextureDescriptor {
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
        let inputs = engine.matcher.inputs(Source::Texture(&views[0]), Source::Texture(&views[1]))?;
        let map = block_on(engine.matcher.readback())?;
        let [left, right] = engine.detectors.each_ref().map(|(detector, _)| block_on(detector.readback()));
        Ok(Self { engine: engine.clone(), textures, inputs, map, features: [left?, right?], sent: None })
    }

    /// Has the device compile what some drivers compile only when a kernel first runs.
    pub async fn warm_up(&self) -> hsad::Result<()> {
        self.engine.matcher.warm_up(Some(&self.inputs), self.map.outputs()).await
    }

    /// Uploads a frame and submits dense matching and, if it is to be seeded, feature detection.
    pub fn send(&mut self, sent: Sent) {
        let Engine { gpu, matcher, detectors, .. } = &*self.engine;
        for (texture, picture) in self.textures.iter().zip(&sent.frame) {
            let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * picture.width()), ..Default::default() };
            gpu.queue.write_texture(texture.as_image_copy(), picture.rgba(), layout, texture.size());
        }
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("frame") };
        let mut encoder = gpu.device.create_command_encoder(&descriptor);
        matcher.record(&mut encoder, &self.inputs, self.map.outputs());
        if sent.seeded {
            for ((detector, input), readback) in detectors.iter().zip(&self.features) {
                detector.record(&mut encoder, input);
                detector.record_readback(&mut encoder, readback);
            }
        }
        gpu.queue.submit([encoder.finish()]);
        self.sent = Some(sent);
    }

    /// Waits for the submitted frame, if there is one, but not for frames submitted later. A frame whose results cannot be read is
    /// kept for [`Self::take`].
    pub fn collect(&mut self) -> hsad::Result<Option<FrameResult>> {
        let Some(Sent { index, frame, seeded }) = &self.sent else { return Ok(None) };
        let map = block_on(self.map.read())?;
        let seeding = match seeded {
            false => None,
            true => {
                let [left, right] = self.features.each_mut().map(|readback| block_on(readback.read()));
                let views = frame.each_ref().map(Picture::luma);
                Some(Seeding::find((&views[0], &views[1]), (&left?, &right?), &SeedingConfig::default())?)
            }
        };
        let result = FrameResult { index: *index, range: self.engine.config.range, map, seeding };
        self.sent = None;
        Ok(Some(result))
    }

    /// The submitted frame, whose results are not wanted any more.
    pub fn take(&mut self) -> Option<Sent> {
        self.sent.take()
    }
}
