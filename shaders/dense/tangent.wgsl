// Tangent planes of the surfaces beside holes, for the filling along rays.
//
// A pixel with a disparity and a neighbour without, left, right, above or below, gets the least-squares plane of the
// disparities around it, on a grid of every STEP-th pixel up to STEPS steps away, that differ from its own by at most TOLERANCE. The two
// normal equations are solved by ROUNDS rounds of Gauss-Seidel from slopes of 0, in integers. The colour is the mean of
// the pixel and its neighbours left and right whose disparities differ by at most SCALE.
//
// Where fewer than one in SMALL_SHARE of the samples belong to the surface, it is small: a speck or a wire.
//
// A pixel is doubtful if it belongs to a speck amid holes: fewer than one in SPECK_SHARE of the samples belong to the
// surface, and fewer than one in KNOWN_SHARE have a disparity; or if its disparity is at an end of the searched range,
// beyond which the surface may go on, and fewer than one in KNOWN_SHARE of the samples belong to the surface.

#import words
#import bitmap_rows
#import floor_div
#import quotient

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup
//   TILE_WORDS         words of the bitmap per row of a workgroup's tile, 32 pixels each
//   TILE_ROWS          rows of a workgroup's tile
//   STEP               distance of samples, in pixels
//   STEPS              samples on either side of the pixel, along a row or a column
//   SIDE               samples along a row: 2 STEPS + 1
//   LEAST_SAMPLES      samples of a plane with slopes, at least
//   SMALL_SHARE        samples per sample of a surface that is just not small
//   SMALL              mark of a small surface, above its colour
//   SPECK_SHARE        samples per sample of a surface that is just no speck
//   KNOWN_SHARE        samples per sample with a disparity around a surface that is just no speck, and per sample of a
//                      surface at an end of the range that is just not doubtful
//   DOUBTFUL           mark of a doubtful pixel, above its colour
//   TOLERANCE          largest difference of a sample from the pixel's disparity, in 1/256 px
//   STEEPEST_X         largest slope along a row, in 1/16 of 1/256 px per STEP pixels
//   STEEPEST_Y         largest slope along a column, in 1/16 of 1/256 px per STEP pixels
//   ROUNDS             rounds of Gauss-Seidel
//   SCALE              disparity units per pixel
//   NONE               sentinel: the pixel has no disparity

struct Params {
    width: u32,
    height: u32,
    // Up to the low end and from the high end on, disparities are at an end of the range, in 1/256 px.
    low_end: i32,
    high_end: i32,
}

@group(0) @binding(0) var<uniform> params: Params;
// One i32 per pixel: the disparity, fixed-point. A texture, since the loads are scattered.
@group(0) @binding(1) var words: texture_storage_2d<r32uint, read>;
// Which pixels have a disparity, as bitmap.wgsl writes them.
@group(0) @binding(2) var<storage, read> bitmaps: array<u32>;
// Three u32 per pixel: the height of the plane at the pixel, an i32 in 1/256 px; the slopes, along x in the lower half
// and along y in the upper half, in the units of STEEPEST; the mean colour, red in the lowest byte, then green and blue,
// with SMALL where the surface is small and DOUBTFUL where the pixel is doubtful.
// Behind them the picture, which is read: one u32 per pixel, as the mean colour.
//
// Only pixels that have a disparity and, of eight neighbours, one without, are written: the others end no ray. Those of
// them with diagonal neighbours without a disparity alone have their own disparity, slopes of 0 and their own colour.
@group(0) @binding(3) var<storage, read_write> tangents: array<u32>;

// Number of pixels beside holes. Their places in the tile, in any order; the highest bit is set if a plane is fitted.
var<workgroup> count: atomic<u32>;
var<workgroup> places: array<u32, 32 * TILE_WORDS * TILE_ROWS>;

// The pixels of a word whose neighbour left or right is a hole, from the holes of the word, and of the words before and
// after.
fn beside(holes: u32, before: u32, after: u32) -> u32 {
    return (holes << 1u) | (before >> 31u) | (holes >> 1u) | (after << 31u);
}

// The same in row `y`.
fn beside_row(word: i32, y: i32) -> u32 {
    return beside(holes_of(word, y), holes_of(word - 1, y), holes_of(word + 1, y));
}

// Disparity of a pixel; NONE outside the picture.
fn disparity_at(x: i32, y: i32) -> i32 {
    let inside_x = clamp(x, 0, i32(params.width) - 1);
    let inside_y = clamp(y, 0, i32(params.height) - 1);
    let disparity = bitcast<i32>(word_at(u32(inside_y) * params.width + u32(inside_x)));
    return select(NONE, disparity, (x == inside_x) & (y == inside_y));
}

// Mean colour of the pixel and its neighbours left and right on the surface.
fn mean_colour(x: i32, y: i32, own: i32) -> u32 {
    let pixels = params.width * params.height;
    var sum = vec3<u32>(0u);
    var count = 0u;
    for (var i = 0; i < 3; i++) { // unroll
        let disparity = disparity_at(x + i - 1, y);
        if disparity != NONE && abs(disparity - own) <= SCALE {
            let colour = tangents[3u * pixels + u32(y) * params.width + u32(x + i - 1)];
            sum += (vec3<u32>(colour) >> vec3<u32>(0u, 8u, 16u)) & vec3<u32>(255u);
            count += 1u;
        }
    }
    let half = count / 2u;
    return quotient(sum.r + half, count)
        | (quotient(sum.g + half, count) << 8u)
        | (quotient(sum.b + half, count) << 16u);
}

// Number of samples inside the picture around `place`, along an axis of `length` pixels.
fn samples_inside(place: i32, length: u32) -> i32 {
    return min(place / STEP, STEPS) + min((i32(length) - 1 - place) / STEP, STEPS) + 1;
}

struct Tangent {
    height: i32,
    slopes: vec2<i32>,
    // SMALL, DOUBTFUL, both or 0.
    mark: u32,
}

fn tangent(x: i32, y: i32, own: i32) -> Tangent {
    // Sums over the samples: number, u, v, u u, u v, v v, e, u e, v e, and the number with a disparity, where u and v count columns and rows in steps,
    // and e is the disparity less the pixel's. Each row is summed first, with constant u.
    var n = 0;
    var known = 0;
    var first = vec3<i32>(0);
    var squares = vec3<i32>(0);
    var moments = vec2<i32>(0);
    for (var v = -STEPS; v <= STEPS; v++) {
        var row_n = 0;
        var row_u = 0;
        var row_uu = 0;
        var row_e = 0;
        var row_ue = 0;
        for (var i = 0; i < SIDE; i++) { // unroll
            let disparity = disparity_at(x + STEP * (i - STEPS), y + STEP * v);
            let e = disparity - own;
            let counts = (disparity != NONE) & (abs(e) <= TOLERANCE);
            known += select(0, 1, disparity != NONE);
            row_n += select(0, 1, counts);
            row_u += select(0, i - STEPS, counts);
            row_uu += select(0, (i - STEPS) * (i - STEPS), counts);
            row_e += select(0, e, counts);
            row_ue += select(0, (i - STEPS) * e, counts);
        }
        n += row_n;
        first += vec3<i32>(row_u, v * row_n, row_e);
        squares += vec3<i32>(row_uu, v * row_u, v * v * row_n);
        moments += vec2<i32>(row_ue, v * row_e);
    }
    let inside = samples_inside(x, params.width) * samples_inside(y, params.height);
    let is_speck = (SPECK_SHARE * n < inside) & (KNOWN_SHARE * known < inside);
    let is_at_end = (own <= params.low_end) | (own >= params.high_end);
    let is_doubtful = is_speck | (is_at_end & (KNOWN_SHARE * n < inside));
    let mark = select(0u, SMALL, SMALL_SHARE * n < inside) | select(0u, DOUBTFUL, is_doubtful);
    if n < LEAST_SAMPLES {
        return Tangent(own, vec2<i32>(0), mark);
    }
    // The normal equations with the mean removed; all products stay below 2^30. A slope beyond what a division is exact for
    // is held at its bound.
    let uu = max(floor_div(n * squares.x - first.x * first.x, n), 1);
    let uv = floor_div(n * squares.y - first.x * first.y, n);
    let vv = max(floor_div(n * squares.z - first.y * first.y, n), 1);
    let ue = rounded_div(n * moments.x - first.x * first.z, n);
    let ve = rounded_div(n * moments.y - first.y * first.z, n);
    var slopes = vec2<i32>(0);
    for (var round = 0; round < ROUNDS; round++) {
        slopes.x = clamp(rounded_div(16 * ue - slopes.y * uv, uu), -STEEPEST_X, STEEPEST_X);
        slopes.y = clamp(rounded_div(16 * ve - slopes.x * uv, vv), -STEEPEST_Y, STEEPEST_Y);
    }
    let height = rounded_div(16 * first.z - first.x * slopes.x - first.y * slopes.y, 16 * n);
    return Tangent(own + height, slopes, mark);
}

// A workgroup first lists the pixels of its tile that are beside holes, and then shares them out among its threads:
// they are few, and without a list most threads would wait.
@compute @workgroup_size(WORKGROUP_WIDTH)
fn main(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let pixels = params.width * params.height;
    if thread == 0u {
        atomicStore(&count, 0u);
    }
    workgroupBarrier();
    let first = vec2<i32>(i32(tile.x) * TILE_WORDS, i32(tile.y) * TILE_ROWS);
    if thread < TILE_WORDS * TILE_ROWS {
        let word = first.x + i32(thread) % TILE_WORDS;
        let y = first.y + i32(thread) / TILE_WORDS;
        let holes = holes_of(word, y);
        let straight = beside(holes, holes_of(word - 1, y), holes_of(word + 1, y))
            | holes_of(word, y - 1) | holes_of(word, y + 1);
        let around = straight | beside_row(word, y - 1) | beside_row(word, y + 1);
        let known = row_word(word, y);
        var rest = around & known;
        while rest != 0u {
            let bit = firstTrailingBit(rest);
            rest &= rest - 1u;
            let is_straight = (straight >> bit) & 1u;
            places[atomicAdd(&count, 1u)] = (32u * thread + bit) | (is_straight << 31u);
        }
    }
    workgroupBarrier();
    let listed = atomicLoad(&count);
    for (var i = thread; i < listed; i += WORKGROUP_WIDTH) {
        let place = i32(places[i] & 0x7fffffffu);
        let x = 32 * (first.x + place / 32 % TILE_WORDS) + place % 32;
        let y = first.y + place / 32 / TILE_WORDS;
        let pixel = u32(y) * params.width + u32(x);
        let own = bitcast<i32>(word_at(pixel));
        var plane = tangent(x, y, own);
        var colour = tangents[3u * pixels + pixel] & 0xffffffu;
        if places[i] >= 0x80000000u {
            colour = mean_colour(x, y, own);
        } else {
            plane = Tangent(own, vec2<i32>(0), plane.mark);
        }
        tangents[3u * pixel] = bitcast<u32>(plane.height);
        tangents[3u * pixel + 1u] = u32(plane.slopes.x & 0xffff) | (u32(plane.slopes.y) << 16u);
        tangents[3u * pixel + 2u] = colour | plane.mark;
    }
}
