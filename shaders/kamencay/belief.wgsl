// Min-sum belief propagation on the grid: half of the nodes, like the squares of one colour on a chessboard,
// send a message to each neighbour.
//
//     m(d) = min over e of (h(e) + V(d - e)) - min h,   h = own data cost + all messages but the receiver's,
//     V(k) = min(SLOPE |k|, LIMIT), both times the link's weight / 16 and rounded down
//
// Felzenszwalb and Huttenlocher: 'Efficient belief propagation for early vision', IJCV 70(1), 2006: a message in
// linear time (section 3.1: once forth, once back), half of the nodes at a time (3.2), from coarse to fine (3.3).

struct Params {
    width: u32,
    height: u32,
    // Which half sends: nodes with x + y of this parity.
    parity: u32,
    // Whether the neighbours' messages are still those of their parents in the grid of half the size.
    from_parents: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Two disparities a word, 16 bits each, 2 FOURS words a node.
@group(0) @binding(1) var<storage, read> costs: array<u32>;
// The weight of a node's link to the right in the lowest byte, and downwards in the next, 0 to 16 each.
@group(0) @binding(2) var<storage, read> links: array<u32>;
@group(0) @binding(3) var<storage, read> parents: array<u32>;
// What each node sends up, down, left and right: four disparities a word, FOURS words a direction.
@group(0) @binding(4) var<storage, read_write> messages: array<u32>;

alias Costs = array<vec4<u32>, FOURS>;

fn unpack(word: u32) -> vec4<u32> {
    return (vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
}

fn pack(values: vec4<u32>) -> u32 {
    return values.x | (values.y << 8u) | (values.z << 16u) | (values.w << 24u);
}

fn neighbour(x: i32, y: i32, direction: u32) -> vec2<i32> {
    switch direction {
        case 0u: { return vec2<i32>(x, y - 1); }
        case 1u: { return vec2<i32>(x, y + 1); }
        case 2u: { return vec2<i32>(x - 1, y); }
        default: { return vec2<i32>(x + 1, y); }
    }
}

fn is_inside(at: vec2<i32>) -> bool {
    return at.x >= 0 && at.y >= 0 && at.x < i32(params.width) && at.y < i32(params.height);
}

// Where the message begins that the node at `from` sends in a direction.
fn place(from_node: vec2<i32>, direction: u32) -> u32 {
    let at = vec2<u32>(from_node);
    let parent = (at.y / 2u) * ((params.width + 1u) / 2u) + at.x / 2u;
    let node = select(at.y * params.width + at.x, parent, params.from_parents != 0u);
    return (4u * node + direction) * FOURS;
}

fn received(word: u32) -> vec4<u32> {
    if params.from_parents != 0u {
        return unpack(parents[word]);
    }
    return unpack(messages[word]);
}

// The weight of the link from a node to the neighbour at `to`.
fn link(node: vec2<i32>, to: vec2<i32>) -> u32 {
    let first = vec2<u32>(min(node, to));
    return (links[first.y * params.width + first.x] >> select(0u, 8u, node.x == to.x)) & 255u;
}

fn least(h: Costs) -> u32 {
    var least = h[0];
    for (var k = 0; k < FOURS; k++) { // unroll
        least = min(least, h[k]);
    }
    return min(min(least.x, least.y), min(least.z, least.w));
}

// More than any cost with four messages on top of it, and far from what 32 bits hold.
const BEYOND = 0xffffffu;

// Each cost or what it takes to come from a smaller disparity.
fn forth(h: Costs, slope: u32) -> Costs {
    var out: Costs;
    var last = BEYOND;
    for (var k = 0; k < FOURS; k++) { // unroll
        let x = min(h[k].x, last + slope);
        let y = min(h[k].y, x + slope);
        let z = min(h[k].z, y + slope);
        last = min(h[k].w, z + slope);
        out[k] = vec4<u32>(x, y, z, last);
    }
    return out;
}

// Each cost or what it takes to come from a larger disparity.
fn back(h: Costs, slope: u32) -> Costs {
    var out: Costs;
    var last = BEYOND;
    for (var k = 0; k < FOURS; k++) { // unroll
        let w = min(h[FOURS - 1 - k].w, last + slope);
        let z = min(h[FOURS - 1 - k].z, w + slope);
        let y = min(h[FOURS - 1 - k].y, z + slope);
        last = min(h[FOURS - 1 - k].x, y + slope);
        out[FOURS - 1 - k] = vec4<u32>(last, y, z, w);
    }
    return out;
}

fn minus(sum: Costs, start: u32) -> Costs {
    var h: Costs;
    for (var k = 0; k < FOURS; k++) { // unroll
        h[k] = sum[k] - received(start + k);
    }
    return h;
}

fn plus(sum: Costs, start: u32) -> Costs {
    var h: Costs;
    for (var k = 0; k < FOURS; k++) { // unroll
        h[k] = sum[k] + received(start + k);
    }
    return h;
}

fn data(node: u32) -> Costs {
    var h: Costs;
    for (var k = 0; k < FOURS; k++) { // unroll
        let low = costs[2u * (node * FOURS + k)];
        let high = costs[2u * (node * FOURS + k) + 1u];
        h[k] = vec4<u32>(low & 0xffffu, low >> 16u, high & 0xffffu, high >> 16u);
    }
    return h;
}

fn send(h: Costs, weight: u32, start: u32) {
    let slope = (SLOPE * weight) >> 4u;
    let limit = (LIMIT * weight) >> 4u;
    let minimum = least(h);
    let costs = back(forth(h, slope), slope);
    for (var k = 0; k < FOURS; k++) { // unroll
        messages[start + k] = pack(min(costs[k] - minimum, vec4<u32>(limit)));
    }
}

@compute @workgroup_size(WORKGROUP_WIDTH, WORKGROUP_HEIGHT)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let node = vec2<i32>(i32(2u * id.x + ((id.y + params.parity) & 1u)), i32(id.y));
    if !is_inside(node) {
        return;
    }
    let index = id.y * params.width + u32(node.x);
    var sum = data(index);
    for (var direction = 0u; direction < 4u; direction++) {
        let from_node = neighbour(node.x, node.y, direction);
        if is_inside(from_node) {
            sum = plus(sum, place(from_node, direction ^ 1u));
        }
    }
    for (var direction = 0u; direction < 4u; direction++) {
        let to = neighbour(node.x, node.y, direction);
        let start = (4u * index + direction) * FOURS;
        if is_inside(to) {
            send(minus(sum, place(to, direction ^ 1u)), link(node, to), start);
        } else {
            for (var k = 0; k < FOURS; k++) { // unroll
                messages[start + k] = 0u;
            }
        }
    }
}
