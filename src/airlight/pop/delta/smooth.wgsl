// A cell's light on cells half as wide, by cubic splines through the cells that hold some; no brighter and no darker
// than the eight around it. See maths/halved_cells.py.
//! use medium_grid

// Catmull and Rom's weights of four cells, t beyond the second one.
fn spline(t: f32) -> vec4f {
    let s = 1.0 - t;
    return 0.5 * vec4f(-t * s * s, 2.0 + t * t * (3.0 * t - 5.0),
        t * (1.0 + t * (4.0 - 3.0 * t)), -t * t * s);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= 2u * params.count)) {
        return;
    }
    // Where no light is needed none is read.
    let inside = id / 2u;
    if (reach[cell_index(inside)] == 0u) {
        textureStore(halved, id, vec4f(0.0));
        return;
    }
    let at = 0.5 * vec3f(id) - 0.25;
    let first = vec3i(floor(at)) - 1;
    let t = at - floor(at);
    let x = spline(t.x);
    let y = spline(t.y);
    let z = spline(t.z);
    let last = vec3i(params.count) - 1;
    var sum = vec3f(0.0);
    var total = 0.0;
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    for (var k = 0u; k < 64u; k++) {
        let corner = vec3u(k & 3u, (k >> 2u) & 3u, k >> 4u);
        let cell = vec3u(clamp(first + vec3i(corner), vec3i(0), last));
        if (reach[cell_index(cell)] == 0u) {
            continue;
        }
        let light = textureLoad(emission, cell, 0).rgb;
        let weight = x[corner.x] * y[corner.y] * z[corner.z];
        sum += weight * light;
        total += weight;
        if (all((corner == vec3u(1u)) | (corner == vec3u(2u)))) {
            least = min(least, light);
            most = max(most, light);
        }
    }
    // The cell itself is among the eight.
    textureStore(halved, id, vec4f(clamp(sum / max(total, LEAST_TOTAL), least, most), 1.0));
}

// Weights of cells without light are missing; the rest counts as at least so much.
const LEAST_TOTAL = 0.1;
