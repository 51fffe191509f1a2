//! use mesh_vertex
//! use material_map

// As visibility_ids.wgsl, of materials with holes.

override IS_CUTOUT: bool = true;
override HAS_BASE_COLOR_MAP: bool = true;

struct Seen {
    @invariant @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) what: vec2u,
    @location(1) uv: vec2f,
}

@vertex fn vertex(
    @location(0) position: vec3f, @location(1) uv: vec2f, at: InstanceTransform,
    @location(8) first: u32, @location(9) what: u32, @builtin(vertex_index) index: u32,
) -> Seen {
    let clip = params.clip_from_world * world_position(at, position);
    return Seen(clip, vec2u(first + index, what), uv);
}

@fragment fn fragment(in: Seen) -> @location(0) vec2u {
    // Alpha alone of the material: the triangle shades later.
    let m = materials[in.what.y >> 16u];
    var alpha = m.alpha;
    if (HAS_BASE_COLOR_MAP) {
        let at = map_coordinates(in.uv, m.uv_base_color);
        alpha *= map_at(base_color_map, base_color_sampler, at.uv, at.dx, at.dy).a;
    }
    if (IS_CUTOUT && alpha < m.alpha_cutoff) {
        discard;
    }
    return in.what;
}
