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
    let texel = id + vec3u(0u, params.first_row, 0u);
    textureStore(red, texel, r * params.scale);
    textureStore(green, texel, g * params.scale);
    textureStore(blue, texel, b * params.scale);
}
