// Mean-shift filtering: each pixel gets the colour of the mode that its colour and position climb to.
//
// Comaniciu and Meer: 'Mean shift: a robust approach toward feature space analysis', PAMI 24(5), 2002, section 4.1,
// with the uniform kernel: the mean of all pixels of a square window whose colours lie in a ball around the last mean.
// Positions and colours are fixed-point, in 1/16 px and 1/16 level; means are rounded to the nearest, halves up.

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   RADIUS             radius of the window, in pixels
//   SQUARED_RANGE      squared radius of the ball of colours, in (1/16 level)^2
//   TURNS              iterations, at most
//   STILL              sum of the changes of position and colour that ends the iterations, in 1/16

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One u32 per pixel: red in the lowest byte, then green and blue; the highest byte is ignored.
@group(0) @binding(1) var<storage, read> pixels: array<u32>;
// One u32 per pixel, the colour of its mode: red in the lowest byte, then green and blue; the highest byte is 0.
@group(0) @binding(2) var<storage, read_write> modes: array<u32>;

fn colour(word: u32) -> vec3<i32> {
    return (vec3<i32>(i32(word)) >> vec3<u32>(0u, 8u, 16u)) & vec3<i32>(255);
}

// sum / count in 1/16, for a sum of at least 0.
fn mean(sum: i32, count: i32) -> i32 {
    return i32((32u * u32(sum) + u32(count)) / (2u * u32(count)));
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.width || id.y >= params.height {
        return;
    }
    let size = vec2<i32>(i32(params.width), i32(params.height));
    let pixel = id.y * params.width + id.x;
    var position = 16 * vec2<i32>(i32(id.x), i32(id.y));
    var mode = 16 * colour(pixels[pixel]);
    for (var iteration = 0; iteration < TURNS; iteration++) {
        let centre = (position + 8) >> vec2<u32>(4u);
        let first = max(centre - RADIUS, vec2<i32>(0));
        let last = min(centre + RADIUS, size - 1);
        var count = 0;
        var position_sum = vec2<i32>(0);
        var colour_sum = vec3<i32>(0);
        for (var y = first.y; y <= last.y; y++) {
            for (var x = first.x; x <= last.x; x++) {
                let neighbour = colour(pixels[y * size.x + x]);
                let offset = 16 * neighbour - mode;
                if dot(offset, offset) <= SQUARED_RANGE {
                    count += 1;
                    // Relative to the window's corner: sums are small and at least 0.
                    position_sum += vec2<i32>(x, y) - centre + RADIUS;
                    colour_sum += neighbour;
                }
            }
        }
        if count == 0 {
            break;
        }
        let next_position =
            16 * (centre - RADIUS) + vec2<i32>(mean(position_sum.x, count), mean(position_sum.y, count));
        let next_mode = vec3<i32>(mean(colour_sum.x, count), mean(colour_sum.y, count), mean(colour_sum.z, count));
        let shift = abs(next_position - position);
        let change = abs(next_mode - mode);
        position = next_position;
        mode = next_mode;
        if shift.x + shift.y + change.x + change.y + change.z <= STILL {
            break;
        }
    }
    let rounded = vec3<u32>((mode + 8) >> vec3<u32>(4u));
    modes[pixel] = rounded.x | (rounded.y << 8u) | (rounded.z << 16u);
}
