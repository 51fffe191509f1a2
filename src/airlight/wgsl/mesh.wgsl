//! use bihemispherical_albedo
//! use mapped_normal
//! use mesh_vertex
//! use material_map

// Materials of meshes. A pass that uses this binds `materials` and, as group 1, the four maps and
// their samplers; the overrides say which maps a pipeline's materials have.

override HAS_BASE_COLOR_MAP: bool = true;
override HAS_METALLIC_ROUGHNESS_MAP: bool = true;
override HAS_NORMAL_MAP: bool = true;
override HAS_EMISSION_MAP: bool = true;

struct SurfacePoint {
    base_color: vec3f,
    alpha: f32,
    normal: vec3f,      // world, facing the viewer
    roughness: f32,
    emission: vec3f,
    metallic: f32,
    specular: f32,
}

fn base_color_at(in: VertexOut) -> vec4f {
    let m = materials[in.material];
    let factor = in.color * vec4f(m.base_color, m.alpha);
    if (!HAS_BASE_COLOR_MAP) {
        return factor;
    }
    let at = map_coordinates(in.uv, m.uv_base_color);
    return factor * map_at(base_color_map, base_color_sampler, at.uv, at.dx, at.dy);
}

fn metallic_roughness_at(in: VertexOut, m: MaterialData) -> vec2f {
    if (!HAS_METALLIC_ROUGHNESS_MAP) {
        return vec2f(m.metallic, m.roughness);
    }
    let at = map_coordinates(in.uv, m.uv_metallic_roughness);
    let map = map_at(metallic_roughness_map, metallic_roughness_sampler, at.uv, at.dx, at.dy);
    return saturate(vec2f(m.metallic, m.roughness) * map.bg);
}

// Reflected over incident power of the surface with base colour `base`.
fn albedo_at(in: VertexOut, base: vec3f) -> vec3f {
    let m = materials[in.material];
    let gloss = metallic_roughness_at(in, m);
    return bihemispherical_albedo(base, gloss.x, gloss.y, m.specular);
}

fn facing_normal(in: VertexOut, is_front: bool) -> vec3f {
    let n = normalize(in.normal);
    return select(-n, n, is_front);
}

fn surface_normal(in: VertexOut, m: MaterialData, is_front: bool) -> vec3f {
    let n = facing_normal(in, is_front);
    if (!HAS_NORMAL_MAP) {
        return n;
    }
    let at = map_coordinates(in.uv, m.uv_normal);
    let bump = map_at(normal_map, normal_sampler, at.uv, at.dx, at.dy).xyz * 2.0 - 1.0;
    return mapped_normal(n, dpdx(in.world), -dpdy(in.world), at.dx, -at.dy,
        vec3f(bump.xy * m.normal_scale, max(bump.z, 1e-3)));
}

fn surface_at(in: VertexOut, is_front: bool) -> SurfacePoint {
    let m = materials[in.material];
    let base = base_color_at(in);
    var point: SurfacePoint;
    point.base_color = base.rgb;
    point.alpha = base.a;
    point.normal = surface_normal(in, m, is_front);
    let gloss = metallic_roughness_at(in, m);
    point.metallic = gloss.x;
    point.roughness = gloss.y;
    point.emission = m.emission;
    point.specular = m.specular;
    if (HAS_EMISSION_MAP) {
        let at = map_coordinates(in.uv, m.uv_emission);
        point.emission *= map_at(emission_map, emission_sampler, at.uv, at.dx, at.dy).rgb;
    }
    return point;
}
