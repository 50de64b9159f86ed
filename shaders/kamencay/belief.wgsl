// Min-sum belief propagation on the grid of pixels: half of the nodes, like the squares of one colour on a chessboard,
// send a message to each neighbour.
//
//     m(d) = min over e of (h(e) + V(d - e)) - min h,   h = own data cost + all messages but the receiver's,
//     V(k) = min(SLOPE |k|, LIMIT), SLOPE and LIMIT times the link's weight / 16, rounded down
//
// Felzenszwalb and Huttenlocher: 'Efficient belief propagation for early vision', IJCV 70(1), 2006: messages in linear
// time by a forward and a backward pass (section 3.1), half of the nodes at a time (3.2), from coarse to fine (3.3).

// Constants:
//   WORKGROUP_WIDTH    threads per workgroup along x
//   WORKGROUP_HEIGHT   threads per workgroup along y
//   FOURS              vectors of four disparities per node
//   SLOPE              V per disparity of difference, at weight 16
//   LIMIT              largest V, at weight 16

struct Params {
    width: u32,
    height: u32,
    // Parity of x + y of the nodes that send.
    parity: u32,
    // 1: the neighbours' messages are those of their parents in the grid of half the size.
    from_parents: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Data costs: 2 FOURS u32 per node, two disparities packed per u32, 16 bits each.
@group(0) @binding(1) var<storage, read> costs: array<u32>;
// One u32 per node: weight of the link to the right in the lowest byte, weight of the link downwards in the next byte,
// 0 to 16 each.
@group(0) @binding(2) var<storage, read> links: array<u32>;
// Messages of the grid of half the size, laid out as `messages`.
@group(0) @binding(3) var<storage, read> parents: array<u32>;
// Messages of each node up, down, left and right: FOURS u32 per direction, four disparities packed per u32.
@group(0) @binding(4) var<storage, read_write> messages: array<u32>;

// Costs of a node, four disparities per vector.
alias Costs = array<vec4<u32>, FOURS>;

fn unpack(word: u32) -> vec4<u32> {
    return (vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(255u);
}

fn pack(values: vec4<u32>) -> u32 {
    return values.x | (values.y << 8u) | (values.z << 16u) | (values.w << 24u);
}

// The neighbour of (x, y) in direction 0 to 3: up, down, left, right.
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

// Index of the first u32 of the message that `from_node`, or its parent, sends in a direction.
fn message_start(from_node: vec2<i32>, direction: u32) -> u32 {
    let at = vec2<u32>(from_node);
    let parent = (at.y / 2u) * ((params.width + 1u) / 2u) + at.x / 2u;
    let node = select(at.y * params.width + at.x, parent, params.from_parents != 0u);
    return (4u * node + direction) * FOURS;
}

// Four disparities of a received message.
fn received(word: u32) -> vec4<u32> {
    if params.from_parents != 0u {
        return unpack(parents[word]);
    }
    return unpack(messages[word]);
}

// Weight of the link between a node and its neighbour `to`.
fn link_weight(node: vec2<i32>, to: vec2<i32>) -> u32 {
    let first = vec2<u32>(min(node, to));
    return (links[first.y * params.width + first.x] >> select(0u, 8u, node.x == to.x)) & 255u;
}

fn min_cost(h: Costs) -> u32 {
    var least = h[0];
    for (var k = 0; k < FOURS; k++) { // unroll
        least = min(least, h[k]);
    }
    return min(min(least.x, least.y), min(least.z, least.w));
}

// Sentinel above any data cost plus four messages; adding SLOPE does not overflow.
const UNREACHABLE = 0xffffffu;

// Forward pass: the least of each cost and of the costs of smaller disparities plus the slope.
fn forward_pass(h: Costs, slope: u32) -> Costs {
    var out: Costs;
    var last = UNREACHABLE;
    for (var k = 0; k < FOURS; k++) { // unroll
        let x = min(h[k].x, last + slope);
        let y = min(h[k].y, x + slope);
        let z = min(h[k].z, y + slope);
        last = min(h[k].w, z + slope);
        out[k] = vec4<u32>(x, y, z, last);
    }
    return out;
}

// Backward pass: the least of each cost and of the costs of larger disparities plus the slope.
fn backward_pass(h: Costs, slope: u32) -> Costs {
    var out: Costs;
    var last = UNREACHABLE;
    for (var k = 0; k < FOURS; k++) { // unroll
        let w = min(h[FOURS - 1 - k].w, last + slope);
        let z = min(h[FOURS - 1 - k].z, w + slope);
        let y = min(h[FOURS - 1 - k].y, z + slope);
        last = min(h[FOURS - 1 - k].x, y + slope);
        out[FOURS - 1 - k] = vec4<u32>(last, y, z, w);
    }
    return out;
}

// `sum` without the message that begins at `start`.
fn without_message(sum: Costs, start: u32) -> Costs {
    var h: Costs;
    for (var k = 0; k < FOURS; k++) { // unroll
        h[k] = sum[k] - received(start + k);
    }
    return h;
}

// `sum` with the message that begins at `start`.
fn with_message(sum: Costs, start: u32) -> Costs {
    var h: Costs;
    for (var k = 0; k < FOURS; k++) { // unroll
        h[k] = sum[k] + received(start + k);
    }
    return h;
}

// Data costs of a node.
fn data_costs(node: u32) -> Costs {
    var h: Costs;
    for (var k = 0; k < FOURS; k++) { // unroll
        let low = costs[2u * (node * FOURS + k)];
        let high = costs[2u * (node * FOURS + k) + 1u];
        h[k] = vec4<u32>(low & 0xffffu, low >> 16u, high & 0xffffu, high >> 16u);
    }
    return h;
}

// Writes the message of costs `h` over a link of this weight, from u32 `start` of `messages` on.
fn send(h: Costs, weight: u32, start: u32) {
    let slope = (SLOPE * weight) >> 4u;
    let limit = (LIMIT * weight) >> 4u;
    let minimum = min_cost(h);
    let costs = backward_pass(forward_pass(h, slope), slope);
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
    var sum = data_costs(index);
    for (var direction = 0u; direction < 4u; direction++) {
        let from_node = neighbour(node.x, node.y, direction);
        if is_inside(from_node) {
            sum = with_message(sum, message_start(from_node, direction ^ 1u));
        }
    }
    for (var direction = 0u; direction < 4u; direction++) {
        let to = neighbour(node.x, node.y, direction);
        let start = (4u * index + direction) * FOURS;
        if is_inside(to) {
            send(without_message(sum, message_start(to, direction ^ 1u)), link_weight(node, to), start);
        } else {
            for (var k = 0; k < FOURS; k++) { // unroll
                messages[start + k] = 0u;
            }
        }
    }
}
