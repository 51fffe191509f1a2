// The mean of 2^3 samples of the fine density around a place, in cells of ordinate o's grid.
fn mean_density(o: OrdinateData, place: vec3f) -> f32 {
    var sum = 0.0;
    for (var s = 0u; s < 8u; s++) {
        let corner = vec3f(vec3u(s & 1u, (s >> 1u) & 1u, s >> 2u));
        let local = vec3f(o.u.w, o.v.w, o.direction.w) + (place - 0.25 + 0.5 * corner) * o.cell.xyz;
        let p = local.x * o.u.xyz + local.y * o.v.xyz + local.z * o.direction.xyz;
        let uvw = p / params.extent + 0.5;
        if (all(uvw > vec3f(0.0)) && all(uvw < vec3f(1.0))) {
            sum += textureSampleLevel(fine, linear_clamp, uvw, 0.0).x;
        }
    }
    return sum / 8.0;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let side = params.side;
    if (id.x >= side || id.y >= side) {
        return;
    }
    let o = ordinates[id.z];
    var index = (id.z * (side + 1u) * side + id.y) * side + id.x;
    var sum = 0.0;
    passed[index] = 0.0;
    for (var k = 0u; k < side; k++) {
        sum += o.cell.z * mean_density(o, vec3f(vec3u(id.xy, k)) + 0.5);
        index += side * side;
        passed[index] = sum;
    }
}
