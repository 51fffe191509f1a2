//! use mapped_normal
//! use visibility_surface

// The surface point of each pixel, from the triangle that it sees: what gbuffer.wgsl makes of varyings.

fn maps_seen(maps: vec4u, uv: vec2f, dx: vec2f, dy: vec2f) -> PackedTexel {
    return packed_maps_at(maps, uv, dx, dy);
}

struct GBufferOut {
    @location(0) albedo: vec4f,
    @location(1) normal: vec4f,
    @location(2) emission: vec4f,
}

@fragment fn fragment(@builtin(position) position: vec4f) -> GBufferOut {
    let seen = textureLoad(triangle_ids, vec2i(position.xy), 0).xy;
    let point = visible_point(seen, position.xy);
    let m = point.material;
    // The normal map bends the normal along the texture's axes, the roughness map scales roughness.
    let bump = point.texel.surface.xyz * 2.0 - 1.0;
    let bent = mapped_normal(point.normal, point.world_dx, -point.world_dy, point.uv_dx, -point.uv_dy,
        vec3f(bump.xy * m.normal_scale, max(bump.z, 1e-3)));
    let normal = select(point.normal, bent, (m.maps.z & MAPS_NORMAL) != 0u);
    let gloss = select(1.0, point.texel.surface.w, (m.maps.z & MAPS_ROUGHNESS) != 0u);
    // Zeros where no triangle is seen, as where nothing is drawn.
    let is_seen = seen.x != 0u;
    let gives_light = is_seen && !point.is_black;
    var out: GBufferOut;
    out.albedo = select(vec4f(0.0), vec4f(m.color.rgb * point.texel.light, m.color.a), gives_light);
    out.normal = select(vec4f(0.0), vec4f(normal, saturate(m.roughness * gloss)), is_seen);
    out.emission = select(vec4f(0.0), m.emission, gives_light);
    return out;
}
