// Filling of holes along rays. From each pixel without a disparity a ray goes in each of eight directions to the first
// pixel with one, whose tangent plane (tangent.wgsl) is continued to the hole: a candidate. Doubtful pixels are passed,
// PASSED at most, if another pixel follows behind a hole.
//
// The price of a candidate is its distance, plus its difference in colour, plus a penalty if the other view speaks
// against it: where no disparity points at the partner (project.wgsl), the pixel would have been measured, and where a
// smaller one does, the candidate would hide what the other view shows; and plus a penalty for a small surface or a
// doubtful pixel, which rays would draw out into streaks. The pixel gets the weighted median of the
// candidates; the weight halves with every 2^HALVING_BITS that a price exceeds the least price.

#import consistent
#import halving

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup
//   TILE_WORDS         words of the bitmap per row of a workgroup's tile, 32 pixels each
//   TILE_ROWS          rows of a workgroup's tile
//   RAY                longest ray, in rows; rays along the row have no limit
//   MARGIN             columns of the bitmaps beside the picture
//   SLOPE_BITS         log2 of the slopes' units per 1/256 px per pixel
//   FARTHEST           largest change by continuation, in 1/256 px
//   COLOUR             price of a difference of 1 in the channel that differs most
//   COLOUR_LIMIT       largest difference in colour that counts
//   UNCLAIMED          price of a partner at which no disparity points
//   HIDING             price of a partner at which a smaller disparity points
//   OF_SMALL           price of a small surface
//   SMALL              mark of a small surface, above its colour
//   OF_DOUBTFUL        price of a doubtful pixel
//   DOUBTFUL           mark of a doubtful pixel, above its colour
//   PASSED             largest number of doubtful pixels that a ray passes
//   HALVING_BITS       log2 of the price that halves the weight
//   FILLED             largest confidence of a filled pixel
//   PRICE_BITS         log2 of the price that lowers the confidence of a filled pixel by 1
//   SCALE              disparity units per pixel
//   NONE               sentinel: the pixel has no disparity
//   ABOVE              sentinel: above any disparity

struct Params {
    width: u32,
    height: u32,
    // Smallest and largest filled disparity, in 1/256 px.
    least: i32,
    most: i32,
    // Partner column = column + direction * disparity: -1 if the reference is the left view, 1 if the right view.
    direction: i32,
    // Index of the first u32 of the confidences in `map`.
    confidence_offset: u32,
    // First row of tiles that is filled.
    first_tile_row: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Heights, slopes and colours, as tangent.wgsl writes them, and the picture.
@group(0) @binding(1) var<storage, read> tangents: array<u32>;
// Disparities that point at the pixels of the other view, as project.wgsl writes them.
@group(0) @binding(2) var<storage, read> projected: array<u32>;
// Which pixels have a disparity, and which holes are filled, as bitmap.wgsl writes them.
@group(0) @binding(3) var<storage, read> bitmaps: array<u32>;
// One i32 per pixel: the disparity, fixed-point. Then the confidences, four packed per u32, 0 in holes. Disparities and
// confidences of holes are written; those of other pixels stay.
@group(0) @binding(4) var<storage, read_write> map: array<atomic<u32>>;

// Number of holes, and their places in the tile, in any order.
var<workgroup> count: atomic<u32>;
var<workgroup> places: array<u32, 32 * TILE_WORDS * TILE_ROWS>;

// Candidates of a hole, one per ray.
struct Candidates {
    disparities: array<vec4<i32>, 2>,
    prices: array<vec4<u32>, 2>,
    exist: array<vec4<bool>, 2>,
}

// Column and row steps of ray r.
fn direction_of(r: i32) -> vec2<i32> {
    // Rays 0 and 1: along the row; then to the rows below and above, for each column step -1, 0 and 1.
    let sign = 1 - 2 * (r & 1);
    let across = (r >> 1u) - 2;
    return select(vec2<i32>(sign * across, sign), vec2<i32>(sign, 0), r < 2);
}

// The words of a bitmap that a ray passes: word `origin + i stride` has the bits from 32 i to 32 i + 31 along the ray's
// axis, which are columns if the ray runs along the row, and rows otherwise.
struct Line {
    origin: i32,
    stride: i32,
    // Place of the hole along the axis.
    place: i32,
    // 1 if the ray runs towards larger places, or -1.
    sign: i32,
}

fn line_of(at: vec2<i32>, step: vec2<i32>) -> Line {
    let row_words = (i32(params.width) + 31) / 32;
    if step.y == 0 {
        return Line(at.y * row_words, 1, at.x, step.x);
    }
    // Columns per row downwards.
    let shear = step.x * step.y;
    let columns = i32(params.width) + 2 * MARGIN;
    let blocks = (i32(params.height) + 31) / 32;
    let bitmap = i32(params.height) * row_words + (shear + 1) * blocks * columns;
    return Line(bitmap + MARGIN + at.x - shear * at.y, columns + 32 * shear, at.y, step.y);
}

// Number of steps to the source of a ray's candidate; 0 without any.
fn source_of(at: vec2<i32>, step: vec2<i32>) -> i32 {
    let size = vec2<i32>(i32(params.width), i32(params.height));
    // Steps to the edge of the picture.
    let room = select(at, size - vec2<i32>(1) - at, step > vec2<i32>(0));
    let last = min(select(room.x, RAY, step.x == 0), select(min(room.y, RAY), room.x, step.y == 0));
    let line = line_of(at, step);
    let last_word = (line.place + line.sign * last) >> 5u;
    var word = line.place >> 5u;
    var rest = bitmaps[line.origin + word * line.stride] & beyond(u32(line.place) % 32u, line.sign);
    // No bit while a pixel with a disparity is sought, and all bits while a hole is.
    var holes = 0u;
    var passed = 0;
    var source = 0;
    loop {
        if rest == 0u {
            if word == last_word {
                break;
            }
            word += line.sign;
            rest = bitmaps[line.origin + word * line.stride] ^ holes;
            continue;
        }
        let bit = select(firstLeadingBit(rest), firstTrailingBit(rest), line.sign > 0);
        let distance = line.sign * (32 * word + i32(bit) - line.place);
        if distance > last {
            break;
        }
        if holes == 0u {
            source = distance;
            let place = at + distance * step;
            let mark = tangents[3u * (u32(place.y) * params.width + u32(place.x)) + 2u];
            if (mark & DOUBTFUL) == 0u || passed == PASSED {
                break;
            }
            passed += 1;
        }
        holes = ~holes;
        rest = (bitmaps[line.origin + word * line.stride] ^ holes) & beyond(bit, line.sign);
    }
    return source;
}

// The bits that follow a bit of a word along a ray.
fn beyond(bit: u32, sign: i32) -> u32 {
    return select((1u << bit) - 1u, 0xfffffffeu << bit, sign > 0);
}

// Red, green and blue.
fn channels(colour: u32) -> vec3<i32> {
    return vec3<i32>((vec3<u32>(colour) >> vec3<u32>(0u, 8u, 16u)) & vec3<u32>(255u));
}

// A pixel without a disparity: its place, the index of the first pixel of its row, and its colour.
struct Hole {
    at: vec2<i32>,
    row: u32,
    colour: vec3<i32>,
}

// Disparity and price of the plane of the pixel `source`, continued by `way` pixels to the hole.
fn candidate(source: u32, way: vec2<i32>, hole: Hole) -> vec2<i32> {
    let slopes = bitcast<i32>(tangents[3u * source + 1u]);
    let slope = vec2<i32>((slopes << 16u) >> 16u, slopes >> 16u);
    let change = (slope.x * way.x + slope.y * way.y + (1 << (SLOPE_BITS - 1u))) >> SLOPE_BITS;
    let height = bitcast<i32>(tangents[3u * source]) + clamp(change, -FARTHEST, FARTHEST);
    let disparity = clamp(height, params.least, params.most);

    let colour = tangents[3u * source + 2u];
    let difference = abs(hole.colour - channels(colour));
    let contrast = max(max(difference.r, difference.g), difference.b);
    var price = abs(way.x) + abs(way.y) + COLOUR * min(contrast, COLOUR_LIMIT)
        + select(0, OF_SMALL, (colour & SMALL) != 0u) + select(0, OF_DOUBTFUL, (colour & DOUBTFUL) != 0u);

    let partner = partner_of(hole.at.x, disparity, params.direction);
    let inside = clamp(partner, 0, i32(params.width) - 1);
    if partner == inside {
        let claim = projected[hole.row + u32(inside)];
        let claimed = bitcast<i32>(claim ^ 0x80000000u);
        if claim == 0u {
            price += UNCLAIMED;
        } else if claimed < disparity - SCALE {
            price += HIDING;
        }
    }
    return vec2<i32>(disparity, price);
}

// Weighted median of the candidates, whose least price is `least`.
fn median(candidates: Candidates, least: u32) -> i32 {
    var weights: array<vec4<u32>, 2>;
    var total = 0u;
    for (var k = 0; k < 2; k++) { // unroll
        let weight = halving_weight(candidates.prices[k] - least, HALVING_BITS);
        weights[k] = select(vec4<u32>(0u), weight, candidates.exist[k]);
        total += weights[k].x + weights[k].y + weights[k].z + weights[k].w;
    }
    var result = ABOVE;
    for (var k = 0; k < 2; k++) { // unroll
        for (var i = 0; i < 4; i++) { // unroll
            let disparity = candidates.disparities[k][i];
            let up_to = select(vec4<u32>(0u), weights[0], candidates.disparities[0] <= vec4<i32>(disparity))
                + select(vec4<u32>(0u), weights[1], candidates.disparities[1] <= vec4<i32>(disparity));
            let below = up_to.x + up_to.y + up_to.z + up_to.w;
            result = min(result, select(ABOVE, disparity, (weights[k][i] > 0u) & (2u * below >= total)));
        }
    }
    return result;
}

// Disparity and confidence of the hole at `at`.
fn filling(at: vec2<i32>) -> vec2<i32> {
    let row = u32(at.y) * params.width;
    let colour = tangents[3u * params.width * params.height + row + u32(at.x)];
    let hole = Hole(at, row, channels(colour));
    var candidates: Candidates;
    var least = 0x7fffffff;
    for (var r = 0; r < 8; r++) {
        let step = direction_of(r);
        let distance = source_of(at, step);
        let place = at + distance * step;
        let found = candidate(u32(place.y) * params.width + u32(place.x), -distance * step, hole);
        let exists = distance > 0;
        least = select(least, min(least, found.y), exists);
        for (var k = 0; k < 2; k++) { // unroll
            let is_this = vec4<i32>(r - 4 * k) == vec4<i32>(0, 1, 2, 3);
            candidates.disparities[k] = select(candidates.disparities[k], vec4<i32>(found.x), is_this);
            candidates.prices[k] = select(candidates.prices[k], vec4<u32>(u32(found.y)), is_this);
            candidates.exist[k] = select(candidates.exist[k], vec4<bool>(exists), is_this);
        }
    }
    if least == 0x7fffffff {
        return vec2<i32>(NONE, 0);
    }
    return vec2<i32>(median(candidates, u32(least)), FILLED - min(least >> PRICE_BITS, FILLED - 1));
}

// The holes to be filled of word `word` of row `y`.
fn to_fill_of(word: i32, y: i32) -> u32 {
    let height = i32(params.height);
    let row_words = (i32(params.width) + 31) / 32;
    let others = height * row_words + 3 * ((height + 31) / 32) * (i32(params.width) + 2 * MARGIN);
    let index = others + min(y, height - 1) * row_words + min(word, row_words - 1);
    return select(0u, bitmaps[index], (word < row_words) & (y < height));
}

// A workgroup first lists the holes of its tile, and then shares them out among its threads: they are few, and without
// a list most threads would wait.
@compute @workgroup_size(WORKGROUP_WIDTH)
fn main(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        atomicStore(&count, 0u);
    }
    workgroupBarrier();
    let first = vec2<i32>(i32(tile.x) * TILE_WORDS, i32(params.first_tile_row + tile.y) * TILE_ROWS);
    if thread < TILE_WORDS * TILE_ROWS {
        var rest = to_fill_of(first.x + i32(thread) % TILE_WORDS, first.y + i32(thread) / TILE_WORDS);
        while rest != 0u {
            places[atomicAdd(&count, 1u)] = 32u * thread + firstTrailingBit(rest);
            rest &= rest - 1u;
        }
    }
    workgroupBarrier();
    let listed = atomicLoad(&count);
    for (var i = thread; i < listed; i += WORKGROUP_WIDTH) {
        let place = i32(places[i]);
        let at = vec2<i32>(32 * (first.x + place / 32 % TILE_WORDS) + place % 32, first.y + place / 32 / TILE_WORDS);
        let found = filling(at);
        let row_words = (params.width + 3u) / 4u;
        let word = params.confidence_offset + u32(at.y) * row_words + u32(at.x) / 4u;
        atomicStore(&map[u32(at.y) * params.width + u32(at.x)], bitcast<u32>(found.x));
        atomicOr(&map[word], u32(found.y) << (8u * (u32(at.x) % 4u)));
    }
}
