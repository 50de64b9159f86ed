// The 64 values that describe each keypoint's surroundings, one workgroup a keypoint: M-SURF
// (Agrawal, Konolige, Blas, 'CenSurE', ECCV 2008, section 3.3), made symmetric. What the kernel for
// any orientation and the one for none share.
//
// 24x24 samples; 4x4 subregions of 9x9 samples that overlap. Both Gaussians are products of a
// column's and a row's factor. So a thread walks down one column of samples and gathers the four
// bands of subregions it crosses; then a thread gathers the nine columns of one subregion.
//
// Samples are `radius` apart, the keypoint's scale in whole 1/16 px, so that without rotation they
// share their corners exactly.

const SAMPLES = 24u;
const CELLS = 16u;

var<workgroup> columns: array<array<vec4f, 4>, SAMPLES>;
var<workgroup> squares: array<f32, CELLS>;

// The parts of one column of samples in the four rows of subregions.
struct Bands {
    first: vec4f,
    second: vec4f,
    third: vec4f,
    fourth: vec4f,
}

// Of the Gaussian around a subregion's centre, sigma 2.5, for samples up to 4 away.
fn sample_weight(distance: vec4f) -> vec4f {
    return select(vec4f(0.0), exp(-distance * distance / (2.0 * 2.5 * 2.5)), abs(distance) <= vec4f(4.0));
}

fn add(bands: Bands, row: u32, response: vec2f) -> Bands {
    let values = vec4f(response, abs(response));
    let weights = sample_weight(f32(row) - vec4f(4.0, 9.0, 14.0, 19.0));
    return Bands(
        bands.first + weights.x * values,
        bands.second + weights.y * values,
        bands.third + weights.z * values,
        bands.fourth + weights.w * values,
    );
}

// Gathers the columns, and writes the descriptor of keypoint `n`. Only the first SAMPLES threads
// bring a column, but all of the workgroup must come.
fn finish(n: u32, local: u32, bands: Bands) {
    if local < SAMPLES {
        columns[local][0] = bands.first;
        columns[local][1] = bands.second;
        columns[local][2] = bands.third;
        columns[local][3] = bands.fourth;
    }
    workgroupBarrier();

    var cell = vec4f(0.0);
    if local < CELLS {
        let column = local % 4u;
        let band = local / 4u;
        for (var k = 0u; k < 9u; k++) {
            let distance = f32(k) - 4.0;
            cell += exp(-distance * distance / (2.0 * 2.5 * 2.5)) * columns[5u * column + k][band];
        }
        let from_centre = vec2f(f32(column), f32(band)) - 1.5;
        cell *= exp(-dot(from_centre, from_centre) / (2.0 * 1.5 * 1.5));
        squares[local] = dot(cell, cell);
    }
    workgroupBarrier();

    if local < CELLS {
        var square = 0.0;
        for (var k = 0u; k < CELLS; k++) {
            square += squares[k];
        }
        let length = sqrt(square);
        descriptors[CELLS * n + local] = select(cell / length, vec4f(0.0), length < 1e-6);
    }
}
