//! Depth and points of a matched pair on the device.

use hsad::{
    DisparityRange, Error, Matcher, Preset,
    dense::{Dense, Destination, MapSources, PointCloud, PointDraw, Reprojection},
    disparity::DisparityMap,
    image::Plane,
    io::{Calibration, ply, ply::PointFilter},
    luma::{Source, unpack},
    wgpu,
};

use crate::common::{bench, block_on, gpu, picture};

const SIZE: (u32, u32) = (90, 40);

fn buffer(bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu().device.create_buffer(&wgpu::BufferDescriptor { label: None, size: bytes, usage, mapped_at_creation: false })
}

fn texture(format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
    gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIZE.0, height: SIZE.1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// A frame: matching, depth, confidences and points in one encoder, beside what the host makes of the same map.
#[test]
fn depth_and_points_of_a_frame_are_those_of_the_host() {
    let scene = picture((SIZE.0 + 12, SIZE.1), 5);
    // Disparities of 7 and of 10 px, which are 1.94 and 1.42 m.
    let views = [[0, 0], [7, 10]].map(|shifts| {
        Plane::from_fn(SIZE, |x, y| [scene.get(x + shifts[usize::from(y >= SIZE.1 / 2)], y), 9, 200, 255])
    });
    let [left, right] = views
        .each_ref()
        .map(|pixels| bench().texture(wgpu::TextureFormat::Rgba8Unorm, SIZE, pixels.data().as_flattened()));
    let range = DisparityRange::new(0, 16).unwrap();
    let matcher = Matcher::new(gpu(), SIZE, &Preset::Balanced.dense_config(range)).unwrap();
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    let pixels = u64::from(SIZE.0 * SIZE.1);
    let (disparities, confidences) =
        (buffer(4 * pixels, usage), buffer(4 * u64::from(SIZE.0.div_ceil(4) * SIZE.1), usage));
    let inputs = matcher.inputs(Source::Texture(&left), Source::Texture(&right)).unwrap();
    let outputs = matcher.outputs(Destination::Buffer(&disparities), Some(&confidences)).unwrap();

    let calibration = Calibration::centred(80.0, 0.2, 1.25, SIZE).unwrap();
    let reprojection = block_on(Reprojection::new(gpu(), SIZE, range, &calibration)).unwrap();
    let depth = texture(wgpu::TextureFormat::R32Float, wgpu::TextureUsages::STORAGE_BINDING);
    let confidence = texture(wgpu::TextureFormat::R32Uint, wgpu::TextureUsages::STORAGE_BINDING);
    let to_depth = block_on(reprojection.depth_texture(&disparities, &view(&depth))).unwrap();
    let to_confidence = block_on(reprojection.confidence_texture(&confidences, &view(&confidence))).unwrap();
    let filter = PointFilter { max_depth: 1.7, min_confidence: 30 };
    let sources = MapSources { disparities: &disparities, confidences: &confidences, picture: &left };
    let points = |draw| block_on(reprojection.points(sources, &filter, draw, pixels as u32)).unwrap();
    let (cloud, quads) = (points(PointDraw::Vertices), points(PointDraw::Instances(4)));
    bench().run(|encoder| {
        matcher.record(encoder, &inputs, &outputs);
        to_depth.record(encoder);
        to_confidence.record(encoder);
        cloud.record(encoder);
        quads.record(encoder);
    });

    let map: DisparityMap = Plane::new(SIZE, bench().download(&disparities).unwrap()).unwrap();
    let dense = Dense { disparity: map, confidence: unpack(SIZE, &bench().download::<u32>(&confidences).unwrap()) };
    let depths = hsad::io::calibration::depth_map(&dense.disparity, &calibration);
    let expected = depths.map(|&depth| if depth.is_finite() { depth } else { 0.0 });
    assert_eq!(bench().download_texture::<f32>(&depth).unwrap(), expected.data());
    let expected: Vec<u32> = dense.confidence.data().iter().map(|&confidence| confidence.into()).collect();
    assert_eq!(bench().download_texture::<u32>(&confidence).unwrap(), expected);

    let (expected, _) = ply::points(&dense, &views[0], &calibration, &filter).unwrap();
    assert!(expected.len() > 1000 && expected.len() < pixels as usize, "{}", expected.len());
    let count = expected.len() as u32;
    let arguments = |cloud: &PointCloud| bench().download::<u32>(cloud.arguments()).unwrap()[..4].to_vec();
    assert_eq!((arguments(&cloud), arguments(&quads)), (vec![count, 1, 0, 0], vec![4, count, 0, 0]));
    let vertices = bench().download::<[u32; 4]>(cloud.vertices()).unwrap();
    assert!(vertices[..expected.len()] == bench().download::<[u32; 4]>(quads.vertices()).unwrap()[..expected.len()]);
    for (vertex, point) in vertices.iter().zip(&expected) {
        let [x, y, z] = [0, 1, 2].map(|axis| f32::from_bits(vertex[axis]));
        assert_eq!(z, point.position[2]);
        // The host divides once more, in double precision.
        assert!((x - point.position[0]).abs() <= 2e-6 && (y - point.position[1]).abs() <= 2e-6, "{x} {y} {point:?}");
        assert_eq!(vertex[3].to_le_bytes()[..3], point.color);
        assert!(vertex[3].to_le_bytes()[3] >= 30);
    }
}

#[test]
fn what_does_not_fit_is_named() {
    let range = DisparityRange::new(0, 16).unwrap();
    let calibration = Calibration::centred(80.0, 0.2, 0.0, SIZE).unwrap();
    let told = |error: Error| error.to_string();
    let new = |size, calibration: &Calibration| block_on(Reprojection::new(gpu(), size, range, calibration));
    assert!(told(new((9, 9), &calibration).unwrap_err()).contains("these are 9x9"));
    let wrong = Calibration { baseline: f64::NAN, ..calibration };
    assert!(told(new(SIZE, &wrong).unwrap_err()).contains("the baseline"));
    let reprojection = new(SIZE, &calibration).unwrap();
    let usage = wgpu::BufferUsages::STORAGE;
    let (whole, small) = (buffer(4 * 90 * 40, usage), buffer(16, usage));
    let unbound = buffer(4 * 90 * 40, wgpu::BufferUsages::COPY_DST);
    let storage = wgpu::TextureUsages::STORAGE_BINDING;
    let depth = |buffer: &wgpu::Buffer, format, usage| {
        told(block_on(reprojection.depth_texture(buffer, &view(&texture(format, usage)))).unwrap_err())
    };
    assert!(
        depth(&small, wgpu::TextureFormat::R32Float, storage).contains("the disparity map is a buffer of 16 bytes")
    );
    assert!(depth(&unbound, wgpu::TextureFormat::R32Float, storage).contains("it needs BufferUsages(STORAGE)"));
    assert!(depth(&whole, wgpu::TextureFormat::R32Sint, storage).contains("it must be R32Float"));
    let unusable = wgpu::TextureUsages::TEXTURE_BINDING;
    assert!(depth(&whole, wgpu::TextureFormat::R32Float, unusable).contains("it needs TextureUsages(STORAGE_BINDING)"));
    let points = |format, filter: PointFilter, draw, capacity| {
        let picture = view(&texture(format, unusable));
        let sources = MapSources { disparities: &whole, confidences: &whole, picture: &picture };
        told(block_on(reprojection.points(sources, &filter, draw, capacity)).unwrap_err())
    };
    let (format, filter) = (wgpu::TextureFormat::Rgba8Unorm, PointFilter::new(&calibration));
    let vertices = PointDraw::Vertices;
    assert!(points(wgpu::TextureFormat::R32Uint, filter, vertices, 9).contains("the reference view"));
    assert!(points(format, PointFilter { max_depth: 0.0, ..filter }, vertices, 9).contains("the largest depth"));
    assert!(points(format, filter, vertices, 0).contains("capacity is 0"));
    assert!(points(format, filter, PointDraw::Instances(0), 9).contains("the vertices of a point"));
    assert!(points(format, filter, vertices, u32::MAX).contains("points needs 68719476720 bytes"));
}
