const LARGEST_HALF = 65504.0;

fn stored(index: u32, way: f32) -> vec4f {
    let single = source[index] - reflected[index];
    let state = (total[index] - 0.5 * single) * (way * params.scale);
    return clamp(state, vec4f(-LARGEST_HALF), vec4f(LARGEST_HALF));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cells = params.count.x * params.count.y * params.count.z;
    let cell = (id.z * params.count.y + id.y) * params.count.x + id.x;
    var sigma_t = params.sigma_t;
    if (params.is_varied != 0u) {
        sigma_t = vec3f(medium[cell].y, medium[cell + cells].y, medium[cell + 2u * cells].y);
    }
    let way = way_m(sigma_t, params.cell);
    textureStore(red, id, stored(cell, way.r));
    textureStore(green, id, stored(cell + cells, way.g));
    textureStore(blue, id, stored(cell + 2u * cells, way.b));
}
