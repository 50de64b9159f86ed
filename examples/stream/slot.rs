//! A slot of the ring: textures that a frame is uploaded to, and memory that the host reads its results from.

use std::rc::Rc;

use hsad::{
    dense::{Dense, DenseConfig, Inputs, MapReadback, Matcher},
    features::{Detector, DetectorInput, FeatureConfig, FeatureReadback},
    gpu::{Gpu, block_on},
    image::Size,
    io::Picture,
    luma::Source,
    seeding::{Seeding, SeedingConfig},
    wgpu,
};

/// Result of a frame.
pub struct FrameResult {
    /// Index of the frame.
    pub index: usize,
    /// Disparities with their confidences.
    pub map: Dense,
    /// Seeding from the frame's features, if it was run on this frame.
    pub seeding: Option<Seeding>,
}

/// The kernels for one configuration, shared by the slots that were made for it.
pub struct Engine {
    pub gpu: Gpu,
    pub config: DenseConfig,
    pub matcher: Matcher,
    /// Detectors of the left and the right view, which read the matcher's luma.
    detectors: [(Detector, DetectorInput); 2],
}

impl Engine {
    pub fn new(gpu: &Gpu, size: Size, config: DenseConfig) -> hsad::Result<Self> {
        let matcher = Matcher::new(gpu, size, &config)?;
        // A small capacity, so that little has to be read back.
        let features = FeatureConfig { max_features: 2048, ..FeatureConfig::default() };
        let [left, right] = matcher.luma().map(|luma| -> hsad::Result<_> {
            let detector = block_on(Detector::new(gpu, size, &features))?;
            let input = block_on(detector.input(luma))?;
            Ok((detector, input))
        });
        Ok(Self { gpu: gpu.clone(), config, matcher, detectors: [left?, right?] })
    }
}

/// Textures and host memory of one frame.
pub struct Slot {
    pub engine: Rc<Engine>,
    textures: [wgpu::Texture; 2],
    inputs: Inputs,
    map: MapReadback,
    features: [FeatureReadback; 2],
    sent: Option<Sent>,
}

/// A submitted frame.
struct Sent {
    index: usize,
    frame: [Picture; 2],
    seeded: bool,
}

impl Slot {
    pub fn new(engine: &Rc<Engine>, Size { width, height }: Size) -> hsad::Result<Self> {
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

    /// Uploads a frame and submits dense matching and, if `seeded`, feature detection.
    pub fn send(&mut self, index: usize, frame: [Picture; 2], seeded: bool) {
        let Engine { gpu, matcher, detectors, .. } = &*self.engine;
        for (texture, picture) in self.textures.iter().zip(&frame) {
            let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * picture.width()), ..Default::default() };
            gpu.queue.write_texture(texture.as_image_copy(), picture.rgba(), layout, texture.size());
        }
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("frame") };
        let mut encoder = gpu.device.create_command_encoder(&descriptor);
        matcher.record(&mut encoder, &self.inputs, self.map.outputs());
        if seeded {
            for ((detector, input), readback) in detectors.iter().zip(&self.features) {
                detector.record(&mut encoder, input);
                detector.record_readback(&mut encoder, readback);
            }
        }
        gpu.queue.submit([encoder.finish()]);
        self.sent = Some(Sent { index, frame, seeded });
    }

    /// Waits for the submitted frame, if there is one, but not for frames submitted later.
    pub fn collect(&mut self) -> hsad::Result<Option<FrameResult>> {
        let Some(Sent { index, frame, seeded }) = self.sent.take() else { return Ok(None) };
        let map = block_on(self.map.read())?;
        let seeding = match seeded {
            false => None,
            true => {
                let [left, right] = self.features.each_mut().map(|readback| block_on(readback.read()));
                let views = frame.each_ref().map(Picture::luma);
                Some(Seeding::find((&views[0], &views[1]), (&left?, &right?), &SeedingConfig::default())?)
            }
        };
        Ok(Some(FrameResult { index, map, seeding }))
    }
}
