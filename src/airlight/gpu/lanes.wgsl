// What the lanes before and after this one hold.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    found[id.x] = vec2u(subgroupShuffleUp(id.x, 1u), subgroupShuffleDown(id.x, 1u));
}
