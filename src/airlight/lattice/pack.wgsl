// What surfaces read of a solved lattice: injected light as they see it, and all propagated light.
//! use cell_order

// Beyond all surfaces nothing shines on what faces out; two bands would leave some light there.
fn is_beyond(cell: vec3u) -> bool {
    let low = params.origin + vec3f(cell) * params.cell;
    let slack = 0.01 * params.cell;
    return any(low + params.cell < params.low + slack) || any(low > params.high - slack);
}

// What surfaces read of a state. Light enters finer lattices from these textures as it is; no surface has less than none.
fn seen(state: vec4f, index: u32) -> vec4f {
    var all = state;
    // With beams that the lattice does not hold, by their fluence and flux.
    if (params.beams != 0.0) {
        let light = beams[index];
        all += params.beams * vec4f(light.x, 3.0 * light.yzw);
    }
    return select(all, vec4f(0.0), all.x < 0.0 && params.is_finest != 0u);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cells = params.count.x * params.count.y * params.count.z;
    let cell = cell_in(params.count, id);
    // W sr^-1 of the three channels, in stored units.
    let own = vec4f(params.own_constant, vec3f(params.own_directional));
    let r = injected[cell] * own + propagated[cell];
    let g = injected[cell + cells] * own + propagated[cell + cells];
    let b = injected[cell + 2u * cells] * own + propagated[cell + 2u * cells];
    let texel = id + vec3u(0u, params.first_row, 0u);
    let scale = select(params.scale, 0.0, is_beyond(id));
    textureStore(red, texel, seen(r, cell) * scale);
    textureStore(green, texel, seen(g, cell + cells) * scale);
    textureStore(blue, texel, seen(b, cell + 2u * cells) * scale);
}
