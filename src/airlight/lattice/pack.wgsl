@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cells = params.count.x * params.count.y * params.count.z;
    let cell = (id.z * params.count.y + id.y) * params.count.x + id.x;
    let own = vec4f(params.own_even, vec3f(params.own_direct));
    let r = injected[cell] * own + propagated[cell];
    let g = injected[cell + cells] * own + propagated[cell + cells];
    let b = injected[cell + 2u * cells] * own + propagated[cell + 2u * cells];
    textureStore(red, id, r * params.scale);
    textureStore(green, id, g * params.scale);
    textureStore(blue, id, b * params.scale);
}
