// Packs 0 and 1 of every cell: the open shares of the hops that its neighbours send it, byte j from
// neighbour j. `incoming_word_0` .. `incoming_word_6` are generated.

fn outgoing(cell: vec3i, hop: u32) -> f32 {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(params.count))) {
        return 1.0;
    }
    let c = vec3u(cell);
    let index = (c.z * params.count.y + c.y) * params.count.x + c.x;
    let word = packs[4u * index + 2u + hop / 16u][(hop / 4u) & 3u];
    return unpack4x8unorm(word)[hop & 3u];
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let at = vec3i(id);
    let cell = (id.z * params.count.y + id.y) * params.count.x + id.x;
    packs[4u * cell] = vec4u(incoming_word_0(at), incoming_word_1(at), incoming_word_2(at),
        incoming_word_3(at));
    packs[4u * cell + 1u] = vec4u(incoming_word_4(at), incoming_word_5(at), incoming_word_6(at),
        0u);
}
