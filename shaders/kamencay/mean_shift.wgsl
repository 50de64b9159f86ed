// Mean-shift filtering: each pixel gets the colour of the mode of the density of colours and places that it
// climbs to.
//
// Comaniciu and Meer: 'Mean shift: a robust approach toward feature space analysis', PAMI 24(5), 2002, section
// 4.1, with the uniform kernel: the mean of all pixels of a square window whose colours lie within a ball
// around the last mean. Places and colours are whole 1/16; a mean is rounded to the nearest, halves up.

struct Params {
    width: u32,
    height: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Red, green and blue from the lowest byte on; the highest byte does not matter.
@group(0) @binding(1) var<storage, read> pixels: array<u32>;
// The same of the mode, the highest byte 0.
@group(0) @binding(2) var<storage, read_write> modes: array<u32>;

fn colour(word: u32) -> vec3<i32> {
    return (vec3<i32>(i32(word)) >> vec3<u32>(0u, 8u, 16u)) & vec3<i32>(255);
}

// sum / count in 1/16, of sums that are not negative.
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
    var place = 16 * vec2<i32>(i32(id.x), i32(id.y));
    var mode = 16 * colour(pixels[pixel]);
    for (var turn = 0; turn < TURNS; turn++) {
        let centre = (place + 8) >> vec2<u32>(4u);
        let first = max(centre - RADIUS, vec2<i32>(0));
        let last = min(centre + RADIUS, size - 1);
        var count = 0;
        var places = vec2<i32>(0);
        var colours = vec3<i32>(0);
        for (var y = first.y; y <= last.y; y++) {
            for (var x = first.x; x <= last.x; x++) {
                let other = colour(pixels[y * size.x + x]);
                let away = 16 * other - mode;
                if dot(away, away) <= SQUARED_RANGE {
                    count += 1;
                    // From the window's corner on, so that sums stay small and are not negative.
                    places += vec2<i32>(x, y) - centre + RADIUS;
                    colours += other;
                }
            }
        }
        if count == 0 {
            break;
        }
        let next_place = 16 * (centre - RADIUS) + vec2<i32>(mean(places.x, count), mean(places.y, count));
        let next_mode = vec3<i32>(mean(colours.x, count), mean(colours.y, count), mean(colours.z, count));
        let way = abs(next_place - place);
        let change = abs(next_mode - mode);
        place = next_place;
        mode = next_mode;
        if way.x + way.y + change.x + change.y + change.z <= STILL {
            break;
        }
    }
    let rounded = vec3<u32>((mode + 8) >> vec3<u32>(4u));
    modes[pixel] = rounded.x | (rounded.y << 8u) | (rounded.z << 16u);
}
