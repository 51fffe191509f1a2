//! use bihemispherical_albedo
//! use reflected_power
//! use visibility_surface

// What each texel of a reflective shadow map sees: what reflective.wgsl makes of varyings.

// Virtual lights average over many texels: the nearest one of the fitting level is as good as eight.
fn maps_seen(maps: vec4u, uv: vec2f, dx: vec2f, dy: vec2f) -> PackedTexel {
    return packed_maps_near(maps, uv, dx, dy);
}

struct ReflectiveOut {
    @location(0) normal: vec4f,
    @location(1) flux: vec4f,
}

@fragment fn fragment(@builtin(position) position: vec4f) -> ReflectiveOut {
    let seen = textureLoad(triangle_ids, vec2i(position.xy), 0).xy;
    let point = visible_point(seen, position.xy);
    // Its reflectance, from packed maps.
    let m = point.material;
    let gloss = select(1.0, point.texel.surface.w, (m.maps.z & MAPS_ROUGHNESS) != 0u);
    let albedo = bihemispherical_albedo(
        m.color.rgb * point.texel.light, m.color.a, saturate(m.roughness * gloss), m.emission.a);
    let size = bitcast<vec2f>(two_words(instances[9u * (seen.y & 0xffffu) + 8u].x)).y;
    // Texels that see nothing send nothing.
    let is_seen = seen.x != 0u;
    var out: ReflectiveOut;
    out.normal = select(vec4f(0.0), vec4f(point.normal, size), is_seen);
    let power = reflected_power(albedo, point.world);
    out.flux = select(vec4f(0.0), vec4f(power, 0.0), is_seen && !point.is_black);
    return out;
}
