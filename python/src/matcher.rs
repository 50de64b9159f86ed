//! Many frames of one size.

use std::sync::{Arc, Mutex, PoisonError};

use hsad::{
    Backend, Config, Dense, DenseConfig, DisparityRange, Gpu, Pair, Picture,
    config::Method,
    dense::{Aggregation, Brightness, Inputs, MapReadback, Search},
    gpu::block_on,
    image::Size,
    io::load::LoadedPair,
    luma::{Source, packed_bytes},
    wgpu,
};
use numpy::PyArrayMethods;
use pyo3::{import_exception, prelude::*, types::PyDict};

use crate::{
    arrays::{Array2, Frame, answer, in_pixels, write},
    backend::{backend, begin_work},
    errors::Raise,
    options::given,
};

import_exception!(hsad._errors, ParameterError);

/// Dense matching of frames of one size and disparity range: kernels and memory are made once.
///
/// Frames must be rectified; nothing is looked for but disparities. :func:`match` finds the range, aligns rows and measures trust: call
/// it for a frame now and then.
///
/// Parameters
/// ----------
/// size : tuple of int
///     Width and height of the frames, in pixels.
/// disparities : int
///     Number of disparities to search.
/// min_disparity : int
///     The smallest one, in pixels; may be negative.
/// device : str
///     As for :func:`match`.
/// **options
///     Options of dense matching, as for :func:`match`; the preset is ``"balanced"`` unless another one is named. The whole range is
///     searched by the presets that match semi-globally.
///
/// Raises
/// ------
/// ParameterError
///     A size or an option outside its range.
/// DeviceError
///     As for :func:`match`.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> left = np.random.default_rng(1).integers(0, 256, (60, 90), dtype=np.uint8)
/// >>> matcher = hsad.Matcher((90, 60), 16, device="cpu")
/// >>> disparity, confidence = matcher.match(left, np.roll(left, -7, axis=1))
/// >>> float(np.nanmedian(disparity)), confidence.dtype
/// (7.0, dtype('uint8'))
#[pyclass(module = "hsad", frozen)]
pub struct Matcher {
    size: Size,
    config: DenseConfig,
    engine: Engine,
}

enum Engine {
    Device(Box<Mutex<OnDevice>>),
    Cpu(Arc<Backend>),
}

#[pymethods]
impl Matcher {
    #[new]
    #[pyo3(signature = (size, disparities, *, min_disparity = 0, device = "best", **options))]
    fn new(
        py: Python<'_>,
        size: (u32, u32),
        disparities: u32,
        min_disparity: i32,
        device: &str,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut options = given(options)?;
        options.disparities = Some(disparities);
        options.min_disparity = Some(min_disparity);
        let range = DisparityRange::new(min_disparity, disparities).raise()?;
        let config = dense_config(&options.config().raise()?, range)?;
        let (size, backend) = (Size::from(size), backend(py, device)?);
        let engine = match &*backend {
            Backend::Cpu => Engine::Cpu(backend),
            Backend::Gpu(gpu) => {
                let device = py.detach(|| OnDevice::new(gpu, size, &config)).raise()?;
                Engine::Device(Box::new(Mutex::new(device)))
            }
        };
        Ok(Self { size, config, engine })
    }

    /// Width and height of the frames, in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.size.width, self.size.height)
    }

    /// The smallest and the largest disparity that are searched, in pixels.
    #[getter]
    fn range(&self) -> (i32, i32) {
        (self.config.range.min, self.config.range.last())
    }

    /// Matches a frame.
    ///
    /// Grey frames of 8 bits in one piece are uploaded as they are and are the fastest.
    ///
    /// Parameters
    /// ----------
    /// left, right : array_like
    ///     Pictures of the matcher's size, as for :func:`match`.
    /// disparity, confidence : numpy.ndarray, optional
    ///     Arrays for the answers, float32 and uint8 of shape (height, width), of any strides.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     Disparities in pixels, NaN where there is none, and confidences, as in :class:`Match`; the arrays that were given, if any.
    ///
    /// Raises
    /// ------
    /// ParameterError
    ///     Frames of another size, or arrays for answers of another shape or type.
    #[pyo3(name = "match", signature = (left, right, *, disparity = None, confidence = None))]
    fn match_frame<'py>(
        &self,
        py: Python<'py>,
        left: &Bound<'py, PyAny>,
        right: &Bound<'py, PyAny>,
        disparity: Option<&Bound<'py, PyAny>>,
        confidence: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Array2<'py, f32>, Array2<'py, u8>)> {
        begin_work()?;
        let views = [Frame::new(left, "the left view")?, Frame::new(right, "the right view")?];
        for (view, name) in views.iter().zip(["left", "right"]) {
            if view.size != self.size {
                let (found, own) = (view.size, self.size);
                return Err(ParameterError::new_err(format!(
                    "the {name} view is {found} pixels, but the matcher is for {own}: another size needs another Matcher"
                )));
            }
        }
        let disparities = answer::<f32>(py, disparity, self.size, "disparity")?;
        let confidences = answer::<u8>(py, confidence, self.size, "confidence")?;
        let busy = |name: &str| ParameterError::new_err(format!("{name} is read-only, or an array of the call twice"));
        let mut to = disparities.try_readwrite().map_err(|_| busy("disparity"))?;
        let mut to_confidences = confidences.try_readwrite().map_err(|_| busy("confidence"))?;
        let (to, to_confidences) = (to.as_array_mut(), to_confidences.as_array_mut());
        let put = |dense: Dense| {
            write(&dense.disparity, to, in_pixels);
            write(&dense.confidence, to_confidences, |confidence| confidence);
        };
        match (views[0].grey().zip(views[1].grey()), &self.engine) {
            (Some((left, right)), Engine::Device(device)) => py.detach(|| {
                let mut device = device.lock().unwrap_or_else(PoisonError::into_inner);
                device.match_grey([left, right]).map(put)
            }),
            (_, engine) => {
                let [left, right] = [views[0].raw()?, views[1].raw()?];
                py.detach(|| {
                    let LoadedPair { left, right, .. } = LoadedPair::from_raw(left, right)?;
                    match engine {
                        Engine::Device(device) => {
                            let mut device = device.lock().unwrap_or_else(PoisonError::into_inner);
                            device.match_colours([&left, &right])
                        }
                        Engine::Cpu(backend) => {
                            block_on(async { Pair::new(backend, &left, &right).await?.dense(&self.config).await })
                        }
                    }
                    .map(put)
                })
            }
        }
        .raise()?;
        Ok((disparities, confidences))
    }

    fn __repr__(&self) -> String {
        let (size, range) = (self.size, self.config.range);
        format!("<hsad.Matcher of {size} pixels, {} to {} px>", range.min, range.last())
    }
}

/// The configuration of frames: what a matcher records ahead cannot be searched over a pyramid.
fn dense_config(config: &Config, range: DisparityRange) -> PyResult<DenseConfig> {
    let Method::Hsad(mut parameters) = config.method else {
        return Err(ParameterError::new_err("method is kamencay, but a Matcher needs hsad: hsad.match takes both"));
    };
    if let Aggregation::Costs(costs) = &mut parameters.aggregation {
        costs.search = Search::Whole;
    }
    Ok(DenseConfig { range, reference: config.reference, brightness: Brightness::SAME, parameters })
}

/// A matcher on a device, with memory for the frame on its way.
struct OnDevice {
    gpu: Gpu,
    size: Size,
    matcher: hsad::Matcher,
    map: MapReadback,
    /// Textures of frames in colour, from the first one on.
    textures: Option<([wgpu::Texture; 2], Inputs)>,
    /// Rows of a grey frame, each in words of its own.
    rows: Vec<u8>,
}

impl OnDevice {
    fn new(gpu: &Gpu, size: Size, config: &DenseConfig) -> hsad::Result<Self> {
        let matcher = hsad::Matcher::new(gpu, size, config)?;
        let map = block_on(matcher.readback())?;
        Ok(Self { gpu: gpu.clone(), size, matcher, map, textures: None, rows: Vec::new() })
    }

    /// Matches a frame of grey bytes.
    fn match_grey(&mut self, views: [&[u8]; 2]) -> hsad::Result<Dense> {
        for (view, luma) in views.into_iter().zip(self.matcher.luma()) {
            let (width, bytes) = (self.size.width as usize, packed_bytes(self.size) as usize);
            if view.len() == bytes {
                self.gpu.queue.write_buffer(luma, 0, view);
            } else {
                self.rows.resize(bytes, 0);
                let rows = self.rows.chunks_exact_mut(width.next_multiple_of(4));
                rows.zip(view.chunks_exact(width)).for_each(|(row, pixels)| row[..width].copy_from_slice(pixels));
                self.gpu.queue.write_buffer(luma, 0, &self.rows);
            }
        }
        let mut encoder = self.gpu.device.create_command_encoder(&FRAME);
        self.matcher.record_luma(&mut encoder, self.map.outputs());
        self.gpu.queue.submit([encoder.finish()]);
        block_on(self.map.read())
    }

    /// Matches a frame in colour.
    fn match_colours(&mut self, views: [&Picture; 2]) -> hsad::Result<Dense> {
        if self.textures.is_none() {
            let textures = [(); 2].map(|()| texture(&self.gpu, self.size));
            let shown = textures.each_ref().map(|texture| texture.create_view(&wgpu::TextureViewDescriptor::default()));
            let inputs = self.matcher.inputs(Source::Texture(&shown[0]), Source::Texture(&shown[1]))?;
            self.textures = Some((textures, inputs));
        }
        let mut encoder = self.gpu.device.create_command_encoder(&FRAME);
        if let Some((textures, inputs)) = &self.textures {
            for (texture, view) in textures.iter().zip(views) {
                let layout =
                    wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * view.width()), ..Default::default() };
                self.gpu.queue.write_texture(texture.as_image_copy(), view.rgba(), layout, texture.size());
            }
            self.matcher.record(&mut encoder, inputs, self.map.outputs());
        }
        self.gpu.queue.submit([encoder.finish()]);
        block_on(self.map.read())
    }
}

const FRAME: wgpu::CommandEncoderDescriptor<'static> = wgpu::CommandEncoderDescriptor { label: Some("frame") };

fn texture(gpu: &Gpu, Size { width, height }: Size) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("frame"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}
