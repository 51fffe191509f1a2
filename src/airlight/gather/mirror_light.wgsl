// What listed pixels' rays found, and its light: two rows for each.
//! needs fn air_of(row: u32) -> Air

struct Air {
    light: vec3f,           // W m^-2 sr^-1, that media scatter into a ray
    passed: vec3f,
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let at = id.y * params.batch.x + id.x;
    if (any(id.xy >= params.batch) || params.first + at >= found[0]) {
        return;
    }
    let hit = textureLoad(hit_positions, id.xy, 0);
    let start = textureLoad(starts, id.xy, 0);
    var kind = select(LEFT, MET, hit.w > 0.0);
    if (start.w <= 0.0) {
        kind = NOWHERE;
    }
    var light = textureLoad(direct_light, id.xy, 0).rgb;
    if (hit.w > 0.0) {
        let towards_lights = textureLoad(hit_albedos, id.xy, 0).rgb;
        let all_around = (towards_lights + textureLoad(hit_normals, id.xy, 0).w) / max(towards_lights, vec3f(1e-4));
        light += all_around * textureLoad(indirect_light, id.xy, 0).rgb;
    }
    let air = air_of(2u * at);
    let row = 2u * (params.first + at);
    mirrored[row] = vec4f(hit.xyz, kind);
    mirrored[row + 1u] = vec4f(air.light + air.passed * light, 0.0);
}
