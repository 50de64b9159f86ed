//! Writing of a scene's files.

use std::io::{Error, Result};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::rig::Side;
use super::{Pair, Scene};

/// Writes a rendered scene's pictures, ground truth and description to `folder`, which is created if missing.
///
/// # Errors
/// If the folder cannot be created or a file cannot be written.
pub fn write(scene: &Scene, pair: &Pair, folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder)?;
    let (width, height) = (pair.width, pair.height);
    let png = |name: &str, data: &[u8], colour: ExtendedColorType| {
        let file = std::fs::File::create(folder.join(name))?;
        PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive)
            .write_image(data, width, height, colour)
            .map_err(Error::other)
    };
    png("left.png", &pair.left.rgb, ExtendedColorType::Rgb8)?;
    png("right.png", &pair.right.rgb, ExtendedColorType::Rgb8)?;
    png("nonocc.png", &pair.left.visible, ExtendedColorType::L8)?;
    png("nonocc_right.png", &pair.right.visible, ExtendedColorType::L8)?;
    std::fs::write(folder.join("disp_left.pfm"), pfm(&pair.left.disparity, width, height))?;
    std::fs::write(folder.join("disp_right.pfm"), pfm(&pair.right.disparity, width, height))?;
    std::fs::write(folder.join("meta.json"), description(scene, pair))
}

/// A grey PFM: three lines of text, then little-endian floats, the bottom row first.
fn pfm(values: &[f32], width: u32, height: u32) -> Vec<u8> {
    let mut bytes = format!("Pf\n{width} {height}\n-1.0\n").into_bytes();
    for row in values.chunks(width as usize).rev() {
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

fn description(scene: &Scene, pair: &Pair) -> String {
    let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
    for &disparity in pair.left.disparity.iter().filter(|disparity| disparity.is_finite()) {
        (least, most) = (least.min(disparity), most.max(disparity));
    }
    let rig = &scene.rig;
    let [left, right] = scene.sensors;
    let ((cx0, cy), (cx1, _)) = (rig.centre(Side::Left), rig.centre(Side::Right));
    format!(
        r#"{{
 "scene": "{name}",
 "title": "{title}",
 "source": "rendered by examples/render_scenes: cargo run --example render_scenes -- data",
 "licence": "CC0-1.0",
 "width": {width},
 "height": {height},
 "focal_px": {focal},
 "baseline_mm": {baseline},
 "doffs_px": {doffs},
 "calib_txt": "cam0=[{focal} 0 {cx0}; 0 {focal} {cy}; 0 0 1]\ncam1=[{focal} 0 {cx1}; 0 {focal} {cy}; 0 0 1]\ndoffs={doffs}\nbaseline={baseline}\nwidth={width}\nheight={height}\nndisp={ndisp}\n",
 "min_disparity": {least:.3},
 "max_disparity": {most:.3},
 "nonocc_fraction": {share:.4},
 "right_gain": {gain},
 "right_offset": {offset},
 "right_exponent": {exponent},
 "noise_sigma": [{noise0}, {noise1}]
}}
"#,
        name = scene.name,
        title = scene.title,
        width = pair.width,
        height = pair.height,
        focal = rig.focal,
        baseline = rig.baseline,
        doffs = rig.doffs,
        ndisp = most.ceil() + 1.0,
        share = pair.left.visible.iter().filter(|&&v| v == 255).count() as f64 / pair.left.visible.len() as f64,
        gain = right.gain,
        offset = right.offset,
        exponent = 1.0 + f64::from(right.bend) / 16.0,
        noise0 = left.noise,
        noise1 = right.noise,
    )
}
