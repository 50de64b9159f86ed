//! Triangle meshes of disparity maps as PLY, the Stanford polygon format.

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use super::{
    Picture,
    ply::{Point, write_head},
};
use crate::{
    disparity::{DisparityMap, SCALE},
    error::{Result, check},
    image::Plane,
};

/// Largest difference of the disparities of pixels that a triangle joins, in 1/256 px: 1 px, from one pixel to the next the limit of the
/// disparity gradient up to which people see one surface (P. Burt and B. Julesz, 'A Disparity Gradient Limit for Binocular Fusion',
/// Science 208, 1980).
const LARGEST_STEP: u32 = SCALE as u32;

/// Largest ratio of the depths of pixels that a triangle joins. 1 px is less than this from 4 px of disparity on, and so in every cloud of
/// the default depth; nearer to infinity it is the gap between things.
const LARGEST_RATIO: f32 = 1.25;

/// A corner of triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position and colour.
    pub point: Point,
    /// Unit vector on the side that the camera sees.
    pub normal: [f32; 3],
}

/// The surfaces of a disparity map.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The corners, in raster order of their pixels; none that no triangle has.
    pub vertices: Vec<Vertex>,
    /// Three corners each, counterclockwise as the camera sees them.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The mesh of a map: two triangles per 2x2 pixels, one where three of them are points, none across steps of more than 1 px of
    /// disparity or a quarter of the depth. `positions` are those of the map's pixels in camera coordinates, not finite where a pixel is no
    /// point; a vertex has the colour of its pixel, and as normal the mean of its triangles', weighted by their areas.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if the sizes differ.
    pub fn new(positions: &Plane<[f32; 3]>, map: &DisparityMap, picture: &Picture) -> Result<Self> {
        let size = positions.size();
        for (name, other) in [("the map", map.size()), ("the picture", picture.size())] {
            check(other == size, name, other, format!("its points are {size}: both need one size"))?;
        }
        let triangles = triangles(positions, map);
        let mut normals = vec![DVec3::ZERO; positions.data().len()];
        let mut is_corner = vec![false; normals.len()];
        let at = |pixel: u32| Vec3::from(positions.data()[pixel as usize]).as_dvec3();
        for corners in &triangles {
            let [a, b, c] = corners.map(at);
            for &pixel in corners {
                normals[pixel as usize] += (b - a).cross(c - a);
                is_corner[pixel as usize] = true;
            }
        }
        let (mut vertices, mut places) = (Vec::new(), vec![0; normals.len()]);
        for pixel in (0..normals.len()).filter(|&pixel| is_corner[pixel]) {
            let [red, green, blue, _] = picture.data()[pixel];
            let point = Point { position: positions.data()[pixel], color: [red, green, blue] };
            places[pixel] = vertices.len() as u32;
            vertices.push(Vertex { point, normal: normals[pixel].normalize_or_zero().as_vec3().into() });
        }
        let triangles = triangles.into_iter().map(|corners| corners.map(|pixel| places[pixel as usize])).collect();
        Ok(Self { vertices, triangles })
    }
}

/// The triangles of pixels, by index.
fn triangles(positions: &Plane<[f32; 3]>, map: &DisparityMap) -> Vec<[u32; 3]> {
    let (width, height) = (map.width(), map.height());
    let is_point: Vec<bool> =
        positions.data().iter().map(|place| place.iter().all(|value| value.is_finite())).collect();
    let step = |p: u32, q: u32| map.data()[p as usize].abs_diff(map.data()[q as usize]);
    let depth = |p: u32| positions.data()[p as usize][2];
    let is_near = |p: u32, q: u32| depth(p).max(depth(q)) <= LARGEST_RATIO * depth(p).min(depth(q));
    let joined =
        |p: u32, q: u32| is_point[p as usize] && is_point[q as usize] && step(p, q) <= LARGEST_STEP && is_near(p, q);
    let is_surface = |&[p, q, r]: &[u32; 3]| joined(p, q) && joined(q, r) && joined(r, p);
    let mut triangles = Vec::new();
    for y in 1..height {
        for x in 1..width {
            // The corners of a cell: a and b above, c and d below.
            let d = y * width + x;
            let [a, b, c] = [d - width - 1, d - width, d - 1];
            let halves = |pair: [[u32; 3]; 2]| pair.into_iter().filter(is_surface).collect::<Vec<_>>();
            let [falling, rising] = [halves([[a, c, d], [a, d, b]]), halves([[a, c, b], [b, c, d]])];
            // Of two ways the one with more triangles, and then the one whose diagonal has the smaller step.
            let is_rising = rising.len() > falling.len() || rising.len() == falling.len() && step(b, c) < step(a, d);
            triangles.extend(if is_rising { rising } else { falling });
        }
    }
    triangles
}

/// Writes a mesh as a binary little-endian PLY.
///
/// # Errors
/// The errors of `out`.
pub fn write(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    let corner = [("float", "x y z nx ny nz"), ("uchar", "red green blue")];
    let face = [("list uchar int", "vertex_indices")];
    write_head(out, &[("vertex", mesh.vertices.len(), &corner), ("face", mesh.triangles.len(), &face)])?;
    for Vertex { point, normal } in &mesh.vertices {
        for number in point.position.iter().chain(normal) {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(&point.color)?;
    }
    for corners in &mesh.triangles {
        out.write_all(&[3])?;
        for corner in corners {
            out.write_all(&corner.to_le_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mesh of disparities in px, of pixels 1 m apart in a plane 5 m away, with a gap where the disparity is 0.
    fn mesh(width: u32, disparities: &[i32]) -> Mesh {
        let map =
            DisparityMap::new((width, disparities.len() as u32 / width), disparities.iter().map(|d| 256 * d).collect())
                .unwrap();
        let place = |x: u32, y: u32| if map.get(x, y) == 0 { [f32::NAN; 3] } else { [x as f32, y as f32, 5.0] };
        let positions = Plane::from_fn(map.size(), place);
        Mesh::new(&positions, &map, &Picture::from_fn(map.size(), |x, y| [x as u8, y as u8, 9, 255])).unwrap()
    }

    #[test]
    fn two_triangles_per_cell_face_the_camera() {
        let mesh = mesh(3, &[7, 7, 7, 7, 7, 8]);
        assert_eq!(mesh.triangles, [[0, 3, 4], [0, 4, 1], [1, 4, 2], [2, 4, 5]]);
        assert_eq!(mesh.vertices.len(), 6);
        for Vertex { normal, .. } in &mesh.vertices {
            assert_eq!(*normal, [0.0, 0.0, -1.0]);
        }
        assert_eq!(mesh.vertices[5].point, Point { position: [2.0, 1.0, 5.0], color: [2, 1, 9] });
    }

    #[test]
    fn steps_and_gaps_are_cut() {
        // Three pixels of a cell are a triangle; what no triangle has is no vertex.
        assert_eq!(mesh(2, &[7, 7, 7, 0]).triangles, [[0, 2, 1]]);
        assert_eq!(mesh(2, &[0, 7, 7, 7]).triangles, [[0, 1, 2]]);
        assert_eq!(mesh(2, &[7, 9, 7, 9]), Mesh { vertices: Vec::new(), triangles: Vec::new() });
        let edge = mesh(4, &[7, 7, 20, 20, 7, 7, 20, 20]);
        assert_eq!((edge.vertices.len(), edge.triangles.len()), (8, 4));
        assert_eq!(mesh(1, &[7, 7]).vertices, []);
    }

    /// Disparities of 3/4 and 7/4 px: more than twice as far away, in the cloud of any depth.
    #[test]
    fn small_steps_of_disparity_far_away_are_cut() {
        let mesh = |near: i32, far: i32| {
            let map = Plane::from_fn((4, 2), |x, _| if x < 2 { near } else { far });
            let place = |x: u32, y: u32| [x as f32, y as f32, 1e4 / map.get(x, y) as f32];
            Mesh::new(&Plane::from_fn(map.size(), place), &map, &Picture::filled((4, 2), [9; 4])).unwrap()
        };
        assert_eq!(mesh(448, 192).triangles.len(), 4);
        assert_eq!(mesh(6 * 256, 5 * 256).triangles.len(), 6);
    }

    #[test]
    fn sizes_must_agree() {
        let positions = Plane::filled((2, 1), [1.0; 3]);
        let error = Mesh::new(&positions, &Plane::filled((1, 2), 256), &Picture::filled((2, 1), [0; 4])).unwrap_err();
        assert_eq!(error.to_string(), "the map is 1x2, but its points are 2x1: both need one size");
    }

    #[test]
    fn writes_exactly_these_bytes() {
        let mut out = Vec::new();
        write(&mut out, &mesh(2, &[7, 7, 7, 0])).unwrap();
        let (header, body) = out.split_at(out.len() - 3 * 27 - 13);
        let header = String::from_utf8_lossy(header);
        assert!(
            header.contains("\nelement vertex 3\n")
                && header.contains("\nelement face 1\n")
                && header.ends_with("end_header\n")
        );
        assert_eq!(body[12..27], [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80, 0xbf, 0, 0, 9]);
        assert_eq!(body[81..], [3, 0, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0]);
    }
}
