// Of the cosine lobe that comes in through a face: its mean cosine, 2/3, as the states' second band.
const INWARDS = 2.0 / 3.0;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let last = params.count - 1u;
    let low = vec3f(id == vec3u(0u));
    let high = vec3f(id == last);
    let way = (low - high) * vec3f(1.0, 0.0, 1.0);
    let sides = low.x + high.x + low.z + high.z;
    if (sides + high.y <= 0.0) {
        return;
    }
    let beside = params.area * incoming[id.y].rgb;
    let above = high.y * params.area * incoming[params.count.y].rgb;
    let cells_in_all = params.count.x * params.count.y * params.count.z;
    let cell = (id.z * params.count.y + id.y) * params.count.x + id.x;
    for (var c = 0u; c < 3u; c++) {
        let even = sides * beside[c] + above[c];
        let flux = beside[c] * way + vec3f(0.0, -above[c], 0.0);
        cells[c * cells_in_all + cell] += vec4f(even, INWARDS * flux);
    }
}
