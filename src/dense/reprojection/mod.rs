//! Depth, confidences and points of a map where an application draws them: on the device.

mod table;

pub use table::DepthTable;

use super::kernels::{
    ConfidenceTexture, DepthTexture, PointCounts, PointLayout, PointRule, PointSources, Points as PointsKernel,
};
use crate::{
    calibration::Calibration,
    disparity::{DisparityRange, SCALE},
    error::{Error, Result, check_range},
    gpu::{Dispatch, Gpu, WordTexture, check_buffer, check_texture, drawn_buffer, guarded, record_run, refused},
    image::Size,
    io::ply::PointFilter,
    luma::{TexelFormat, packed_bytes},
};

/// Reprojection of disparities to metres on an application's device, from the buffers that [`super::Matcher::outputs`] fills.
///
/// Depth is focal length times baseline over disparity and `doffs`, as in [`crate::calibration::depth_map`], to the bit on every device:
/// a table has the depth of each disparity.
///
/// A reprojection is built once per size, range and calibration. Its outputs are prepared once per set of buffers, and recorded per
/// frame behind the matcher: they submit nothing, map nothing and create nothing on the device.
#[derive(Debug)]
pub struct Reprojection {
    gpu: Gpu,
    size: Size,
    calibration: Calibration,
    table: DepthTable,
    words: WordTexture,
}

/// Buffers of a map, as the destinations of a matcher, with `STORAGE` besides; and the reference view.
#[derive(Clone, Copy, Debug)]
pub struct MapSources<'a> {
    /// One `i32` per pixel, row by row: [`super::Destination::Buffer`].
    pub disparities: &'a wgpu::Buffer,
    /// One byte per pixel, in rows of `width.div_ceil(4)` `u32`s.
    pub confidences: &'a wgpu::Buffer,
    /// A texture of the reference view with `TEXTURE_BINDING`, of a format in [`TexelFormat::ALL`]: the colours.
    pub picture: &'a wgpu::TextureView,
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointDraw {
    /// A vertex per point, for `PrimitiveTopology::PointList`: the buffer steps per vertex.
    Vertices,
    /// An instance of so many vertices per point, at least 1, such as 4 for a quad as a triangle strip: the buffer steps per instance.
    Instances(u32),
}

/// A texture that is written from a map: depths or confidences.
#[derive(Debug)]
pub struct MapTextureOutput(Dispatch);

impl MapTextureOutput {
    /// Records the writing of all texels of the map, behind the matcher's work.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.0.record(encoder);
    }
}

/// Points of a map in a vertex buffer, with the arguments of their draw.
#[derive(Debug)]
pub struct PointCloud {
    dispatches: [Dispatch; 2],
    vertices: wgpu::Buffer,
    arguments: wgpu::Buffer,
}

impl PointCloud {
    /// Bytes per point of [`Self::vertices`].
    pub const STRIDE: u64 = 16;

    /// The attributes of a point: its position at location 0, red, green and blue with the confidence as alpha at location 1.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 2] = [
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: 0 },
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Unorm8x4, offset: 12, shader_location: 1 },
    ];

    /// Records the writing of all points, behind the matcher's work.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        record_run(encoder, &self.dispatches, None);
    }

    /// The points in raster order, [`Self::STRIDE`] bytes each: x (right), y (down) and z (forward) in metres, in coordinates of the
    /// calibration's camera, as `f32`; red, green, blue and confidence as bytes. Usages: `VERTEX`, `STORAGE`, `COPY_SRC`.
    pub fn vertices(&self) -> &wgpu::Buffer {
        &self.vertices
    }

    /// The arguments of `draw_indirect`, at offset 0; the number of points is the first or, for instances, the second `u32`. Usages:
    /// `INDIRECT`, `STORAGE`, `COPY_SRC`.
    pub fn arguments(&self) -> &wgpu::Buffer {
        &self.arguments
    }
}

impl Reprojection {
    /// The reprojection of maps of `size` that were searched in `range`, for the geometry of the pair: that of the right camera
    /// ([`Calibration::seen_from_right`]) where the right view is the reference.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a calibration that is not valid or of another size; [`Error::TooLarge`] for a range whose table does not
    /// fit in a texture: 8,190 disparities always do.
    pub async fn new(
        gpu: &Gpu,
        size: impl Into<Size>,
        range: DisparityRange,
        calibration: &Calibration,
    ) -> Result<Self> {
        let size = size.into();
        calibration.validate()?;
        calibration.check_size(size)?;
        let entries = u64::from(SCALE.unsigned_abs()) * (u64::from(range.count) + 1) + 1;
        guarded(gpu, "the table of depths", || {
            let words = WordTexture::new(gpu, "the table of depths", 2 * entries)?;
            let table = DepthTable::new(range, calibration);
            words.write(gpu, table.words());
            Ok(Self { gpu: gpu.clone(), size, calibration: *calibration, table, words })
        })
        .await
    }

    /// Binds a texture of format `R32Float` with `STORAGE_BINDING` as the destination of depths, in metres; 0 where a pixel has none.
    ///
    /// # Errors
    /// [`Error::Resource`] for an invalid size, format, usage or dimension, and for a resource of another device.
    pub async fn depth_texture(&self, disparities: &wgpu::Buffer, to: &wgpu::TextureView) -> Result<MapTextureOutput> {
        self.check_disparities(disparities)?;
        self.texture("the depth map", to, DepthTexture::FORMAT, || {
            DepthTexture::new(&self.gpu).prepare(self.size, disparities, &self.table, &self.words, to)
        })
        .await
    }

    /// Binds a texture of format `R32Uint` with `STORAGE_BINDING` as the destination of confidences, 0 to 255.
    ///
    /// # Errors
    /// As [`Self::depth_texture`].
    pub async fn confidence_texture(
        &self,
        confidences: &wgpu::Buffer,
        to: &wgpu::TextureView,
    ) -> Result<MapTextureOutput> {
        self.check_confidences(confidences)?;
        self.texture("the confidence map", to, ConfidenceTexture::FORMAT, || {
            ConfidenceTexture::new(&self.gpu).prepare(self.size, confidences, to)
        })
        .await
    }

    /// Allocates a vertex buffer for up to `capacity` of the points that `filter` keeps, at least 1; of more, those of the lower rows
    /// are left out.
    ///
    /// # Errors
    /// As [`Self::depth_texture`]; also [`Error::Parameter`] for a filter that is not valid and for a capacity or a number of vertices of
    /// 0, and [`Error::TooLarge`].
    pub async fn points(
        &self,
        sources: MapSources<'_>,
        filter: &PointFilter,
        draw: PointDraw,
        capacity: u32,
    ) -> Result<PointCloud> {
        filter.validate()?;
        check_range("capacity", capacity, 1..=u32::MAX)?;
        let instanced = match draw {
            PointDraw::Vertices => 0,
            PointDraw::Instances(vertices) => {
                check_range("the vertices of a point", vertices, 1..=u32::MAX)?;
                vertices
            }
        };
        self.check_disparities(sources.disparities)?;
        self.check_confidences(sources.confidences)?;
        let (name, format) = ("the reference view", sources.picture.texture().format());
        let format = TexelFormat::new(format).ok_or_else(|| Error::Resource {
            name,
            value: format!("a texture of format {format:?}"),
            expected: format!("it must be one of {:?}", TexelFormat::ALL),
        })?;
        check_texture(name, sources.picture.texture(), self.size, wgpu::TextureUsages::TEXTURE_BINDING)?;
        let rule = PointRule {
            least: self.table.least(&self.calibration, filter.max_depth),
            min_confidence: filter.min_confidence,
        };
        let layout =
            PointLayout { centre: [self.calibration.cx as f32, self.calibration.cy as f32], capacity, instanced };
        guarded(&self.gpu, "the points", || {
            let bytes = PointCloud::STRIDE * u64::from(capacity);
            let vertices = drawn_buffer(&self.gpu, "points", bytes, wgpu::BufferUsages::VERTEX)?;
            let bytes = 4 * u64::from(PointCounts::words(self.size.height));
            let arguments = drawn_buffer(&self.gpu, "points per row", bytes, wgpu::BufferUsages::INDIRECT)?;
            let MapSources { disparities, confidences, picture } = sources;
            let counts = PointCounts::new(&self.gpu).prepare(self.size, rule, [disparities, confidences], &arguments);
            let sources = PointSources { size: self.size, disparities, confidences, picture: (picture, format) };
            let table = (&self.table, &self.words);
            let points = PointsKernel::new(&self.gpu).prepare(sources, rule, table, layout, [&arguments, &vertices]);
            Ok(PointCloud { dispatches: [counts, points], vertices, arguments })
        })
        .await
        .map_err(|error| refused("the points", error))
    }

    fn check_disparities(&self, buffer: &wgpu::Buffer) -> Result<()> {
        check_buffer("the disparity map", buffer, 4 * self.size.pixels(), wgpu::BufferUsages::STORAGE)
    }

    fn check_confidences(&self, buffer: &wgpu::Buffer) -> Result<()> {
        check_buffer("the confidence map", buffer, packed_bytes(self.size), wgpu::BufferUsages::STORAGE)
    }

    async fn texture(
        &self,
        name: &'static str,
        to: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        dispatch: impl FnOnce() -> Dispatch,
    ) -> Result<MapTextureOutput> {
        let found = to.texture().format();
        if found != format {
            let value = format!("a texture of format {found:?}");
            return Err(Error::Resource { name, value, expected: format!("it must be {format:?}") });
        }
        check_texture(name, to.texture(), self.size, wgpu::TextureUsages::STORAGE_BINDING)?;
        guarded(&self.gpu, name, || Ok(MapTextureOutput(dispatch()))).await.map_err(|error| refused(name, error))
    }
}
