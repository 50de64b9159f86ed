//! Census transforms of both views, in bands of rows with halo rows around them.

use super::Plan;
use crate::{
    dense::{
        config::{Cost, View},
        kernels::{Census, Pad},
    },
    error::Result,
    gpu::Gpu,
    image::Size,
};

/// The kernels, and the memory of a band, for both views of a pair.
pub(super) struct Transform {
    size: Size,
    /// Packed luma and change of brightness, of the left and of the right view.
    pictures: [(wgpu::Buffer, wgpu::Buffer); 2],
    pad: Pad,
    transform: Census,
    padded: wgpu::Buffer,
    /// The census transforms of each view, two words per pixel.
    census: [wgpu::Buffer; 2],
}

impl Transform {
    /// Allocates memory for the transforms that `cost` needs of `rows` rows of packed `luma` of `size`, with their halo.
    pub(super) fn new(
        gpu: &Gpu,
        plan: &mut Plan,
        cost: &Cost,
        (size, rows): (Size, u32),
        [left, right]: [&wgpu::Buffer; 2],
    ) -> Result<Self> {
        let padding = Census::padding(size, 0, rows);
        let transformed = 2 * u64::from(size.width) * u64::from(rows);
        Ok(Self {
            size,
            pictures: [(left.clone(), plan.brightness(View::Left)), (right.clone(), plan.brightness(View::Right))],
            pad: Pad::new(gpu),
            transform: Census::new(gpu, cost.weak_spread, gpu.shapes().census),
            padded: plan.buffer("padded rows", u64::from(padding.rows) * u64::from(padding.stride))?,
            census: [plan.buffer("census, left", transformed)?, plan.buffer("census, right", transformed)?],
        })
    }

    /// Plans the census transforms of `rows` rows from `first_row`, which may lie outside the picture, for both views.
    pub(super) fn plan(&self, plan: &mut Plan, first_row: i32, rows: u32) {
        for ((picture, brightness), census) in self.pictures.iter().zip(&self.census) {
            let (padding, size) = (Census::padding(self.size, first_row, rows), Size::new(self.size.width, rows));
            plan.run(self.pad.prepare(padding, brightness, picture, &self.padded));
            plan.run(self.transform.prepare(size, &self.padded, census));
        }
    }

    /// The census transforms of `view`, then of the other view.
    pub(super) fn of(&self, view: View) -> [&wgpu::Buffer; 2] {
        let [left, right] = &self.census;
        match view {
            View::Left => [left, right],
            View::Right => [right, left],
        }
    }
}
