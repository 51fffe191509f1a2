//! use bihemispherical_albedo
//! use translucency
//! use mapped_normal
//! use mesh_vertex
//! use material_map

// Materials of meshes, for passes whose vertex shader surface/mesh_pass.py has. A pass that uses this binds
// `materials` and, as group 1, the four maps and their samplers; the overrides say which maps a pipeline's materials
// have.

override HAS_BASE_COLOR_MAP: bool = true;
override HAS_METALLIC_ROUGHNESS_MAP: bool = true;
override HAS_NORMAL_MAP: bool = true;
override HAS_EMISSION_MAP: bool = true;
override IS_CUTOUT: bool = true;        // they may have holes

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

fn transmission_at(in: VertexOut) -> f32 {
    let m = materials[in.material];
    return m.transmission * (1.0 - metallic_roughness_at(in, m).x);
}

// What of the light passes straight through, of base colour and alpha: along `d`, of normal `n`, both unit.
fn passed_at(in: VertexOut, base: vec4f, n: vec3f, d: vec3f) -> vec3f {
    let m = materials[in.material];
    let mirrored = dielectric_fresnel(0.04 * m.specular, abs(dot(n, d)));
    return passed_share(base.rgb, coverage(base.a, m.is_blended != 0u), transmission_at(in), mirrored);
}

// The same along the normal.
fn passed_head_on(in: VertexOut, base: vec4f) -> vec3f {
    return passed_at(in, base, vec3f(0.0, 0.0, 1.0), vec3f(0.0, 0.0, 1.0));
}

// Whether a map that is drawn from here shows what lies behind: in a hole, or, by chance, where light passes.
fn is_hole(in: VertexOut, base: vec4f) -> bool {
    let m = materials[in.material];
    if (m.is_translucent == 0u || base.a < m.alpha_cutoff) {
        return base.a < m.alpha_cutoff;
    }
    return chance(in.clip.xy, dot(in.world, in.normal)) >= 1.0 - mean_channel(passed_head_on(in, base));
}

// Whether it is the back of what reflects and emits on its front alone.
fn is_black(in: VertexOut, is_front: bool) -> bool {
    return !is_front && materials[in.material].is_one_sided != 0u;
}

// As albedo_at, of a point that is no hole: what a translucent surface reflects, over the chance to be there.
fn present_albedo(in: VertexOut, base: vec4f, is_front: bool) -> vec3f {
    let m = materials[in.material];
    if (is_black(in, is_front)) {
        return vec3f(0.0);
    }
    if (m.is_translucent == 0u) {
        return albedo_at(in, base.rgb);
    }
    let reflected = albedo_at(in, base.rgb * (1.0 - transmission_at(in))) * coverage(base.a, m.is_blended != 0u);
    return min(reflected / max(1.0 - mean_channel(passed_head_on(in, base)), 1e-3), vec3f(1.0));
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
    let tangent_space = vec3f(bump.xy * m.normal_scale, max(bump.z, 1e-3));
    let by_uvs = mapped_normal(n, dpdx(in.world), -dpdy(in.world), at.dx, -at.dy, tangent_space);
    // Without a tangent, or between ones that cancel, the texture coordinates say where the map lies.
    let across = cross(n, in.tangent.xyz);
    if (dot(across, across) < 1e-12) {
        return by_uvs;
    }
    return tangent_mapped_normal(n, is_front, in.tangent, tangent_space);
}

fn surface_at(in: VertexOut, is_front: bool) -> SurfacePoint {
    // The material's values times those of its maps.
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
    if (is_black(in, is_front)) {
        point.base_color = vec3f(0.0);
        point.emission = vec3f(0.0);
        point.metallic = 0.0;
        point.specular = 0.0;
    }
    return point;
}

// What a camera sees of it: of an unlit material the base colour, `unlit_radiance` times, and no reflection.
fn shown_point(in: VertexOut, is_front: bool, unlit_radiance: f32) -> SurfacePoint {
    var point = surface_at(in, is_front);
    if (materials[in.material].is_unlit != 0u) {
        point.emission = point.base_color * unlit_radiance;
        point.base_color = vec3f(0.0);
        point.metallic = 0.0;
        point.specular = 0.0;
    }
    return point;
}
