// A map of a warped picture as one of another picture: each pixel has a position in the warped picture. Of the four pixels
// around the position, weighted as bilinear interpolation does, those within SURFACE of the one for which they weigh most
// make the disparity; the heaviest of these has the confidence.

#import warp_map

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   SUBPIXEL_BITS      bits after the point of positions
//   NONE_NODE          coordinates of a node without a position
//   NONE               sentinel: the pixel has no disparity
//   SURFACE            largest difference of neighbouring disparities of one surface, in 1/256 px

struct Params {
    // Pixels of the map that is made, and of the map of the warped picture.
    width: u32,
    height: u32,
    source_width: i32,
    source_height: i32,
    // Nodes per row.
    columns: u32,
    // log2 of the distance of nodes, in pixels.
    spacing_bits: u32,
    // Index of the first u32 of the confidences in `map`.
    confidence_offset: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel of the warped picture: the disparity, fixed-point.
@group(0) @binding(1) var<storage, read> disparities: array<i32>;
// Confidences, four packed per u32, rows of ceil(source_width / 4) u32.
@group(0) @binding(2) var<storage, read> confidences: array<u32>;
// Positions in the warped picture at every 2^spacing_bits-th pixel along x and y.
@group(0) @binding(3) var<storage, read> nodes: array<vec2<i32>>;
// One i32 per pixel: the disparity, fixed-point. Then the confidences, four packed per u32.
@group(0) @binding(4) var<storage, read_write> map: array<i32>;

fn disparity_at(pixel: vec2<i32>) -> i32 {
    let inside = clamp(pixel, vec2<i32>(0), vec2<i32>(params.source_width - 1, params.source_height - 1));
    return disparities[inside.y * params.source_width + inside.x];
}

fn confidence_at(pixel: vec2<i32>) -> u32 {
    let inside = clamp(pixel, vec2<i32>(0), vec2<i32>(params.source_width - 1, params.source_height - 1));
    let word = confidences[inside.y * ((params.source_width + 3) / 4) + inside.x / 4];
    return (word >> (8u * u32(inside.x & 3))) & 255u;
}

// Disparity and confidence.
struct Found {
    disparity: i32,
    confidence: u32,
}

fn surface_at(position: vec2<i32>) -> Found {
    let first = position >> vec2<u32>(SUBPIXEL_BITS);
    let part = position & vec2<i32>(ONE - 1);
    let rest = vec2<i32>(ONE) - part;
    var disparities_around: array<i32, 4>;
    var weights: array<i32, 4>;
    for (var k = 0; k < 4; k++) {
        let step = vec2<i32>(k & 1, k >> 1u);
        let shares = select(rest, part, step == vec2<i32>(1));
        disparities_around[k] = disparity_at(first + step);
        weights[k] = select(shares.x * shares.y, 0, disparities_around[k] == NONE);
    }
    var best = Found(NONE, 0u);
    var most = 0;
    for (var k = 0; k < 4; k++) {
        if weights[k] == 0 {
            continue;
        }
        // The sum lies between -SURFACE and SURFACE times the weight, which is at most ONE * ONE.
        var weight = 0;
        var sum = 0;
        var heaviest = 0;
        var confidence = 0u;
        for (var other = 0; other < 4; other++) {
            if weights[other] == 0 || abs(disparities_around[other] - disparities_around[k]) > SURFACE {
                continue;
            }
            weight += weights[other];
            sum += weights[other] * (disparities_around[other] - disparities_around[k]);
            if weights[other] > heaviest {
                heaviest = weights[other];
                confidence = confidence_at(first + vec2<i32>(other & 1, other >> 1u));
            }
        }
        if weight > most {
            most = weight;
            // Rounded to the nearest, halves up.
            let above = (u32(sum + SURFACE * weight) + u32(weight) / 2u) / u32(weight);
            best = Found(disparities_around[k] + i32(above) - SURFACE, confidence);
        }
    }
    return best;
}

// One thread makes four pixels, whose confidences are one u32.
@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = 4u * id.x;
    if x >= params.width || id.y >= params.height {
        return;
    }
    var word = 0u;
    for (var t = 0u; t < min(4u, params.width - x); t++) {
        let position = position_at(x + t, id.y);
        let nearest = (position + vec2<i32>(ONE / 2)) >> vec2<u32>(SUBPIXEL_BITS);
        let size = vec2<i32>(params.source_width, params.source_height);
        var found = Found(NONE, 0u);
        if position.x != NONE_NODE && all(nearest >= vec2<i32>(0)) && all(nearest < size) {
            found = surface_at(position);
        }
        word |= found.confidence << (8u * t);
        map[id.y * params.width + x + t] = found.disparity;
    }
    map[params.confidence_offset + id.y * ((params.width + 3u) / 4u) + id.x] = i32(word);
}
