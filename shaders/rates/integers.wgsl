// The rate of integers: each thread adds and takes minima, as semi-global matching does, in four chains of four lanes.

@group(0) @binding(0) var<storage, read_write> results: array<vec4<u32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var a = vec4<u32>(id.x, id.x + 1u, id.x + 2u, id.x + 3u);
    var b = a + 5u;
    var c = a + 7u;
    var d = a + 11u;
    for (var i = 0u; i < ROUNDS; i++) {
        a = min(a + i, d);
        b = min(b + i, a);
        c = min(c + i, b);
        d = min(d + i, c + 3u);
    }
    results[id.x] = a + b + c + d;
}
