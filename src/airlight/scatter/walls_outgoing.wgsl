// Packs 2 and 3 of every cell: the open shares of its own 26 hops. `path_0` .. `path_25` are
// generated.

// The open share of the face hop (+x -x +y -y +z -z) into a cell; outside, nothing stops light.
fn entered(cell: vec3i, face: u32) -> f32 {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(params.count))) {
        return 1.0;
    }
    let c = vec3u(cell);
    let packed = face_visibility[(c.z * params.count.y + c.y) * params.count.x + c.x];
    return select(unpack4x8unorm(packed.y)[face & 3u], unpack4x8unorm(packed.x)[face], face < 4u);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let at = vec3i(id);
    let cell = (id.z * params.count.y + id.y) * params.count.x + id.x;
    packs[4u * cell + 2u] = vec4u(
        pack4x8unorm(vec4f(path_0(at), path_1(at), path_2(at), path_3(at))),
        pack4x8unorm(vec4f(path_4(at), path_5(at), path_6(at), path_7(at))),
        pack4x8unorm(vec4f(path_8(at), path_9(at), path_10(at), path_11(at))),
        pack4x8unorm(vec4f(path_12(at), path_13(at), path_14(at), path_15(at))));
    packs[4u * cell + 3u] = vec4u(
        pack4x8unorm(vec4f(path_16(at), path_17(at), path_18(at), path_19(at))),
        pack4x8unorm(vec4f(path_20(at), path_21(at), path_22(at), path_23(at))),
        pack4x8unorm(vec4f(path_24(at), path_25(at), 1.0, 1.0)),
        reflectance[cell]);
}
