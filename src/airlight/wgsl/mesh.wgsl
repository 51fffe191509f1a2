//! use mapped_normal
//! use mesh_vertex

// Materials of meshes. A pass that uses this binds `materials` and, as group 1, the four maps and
// their samplers; the overrides say which maps a pipeline's materials have.

override HAS_BASE_COLOR_MAP: bool = true;
override HAS_METALLIC_ROUGHNESS_MAP: bool = true;
override HAS_NORMAL_MAP: bool = true;
override HAS_EMISSION_MAP: bool = true;
override HAS_PLACED_MAPS: bool = true;      // whether any has a scale or an offset

struct SurfacePoint {
    base_color: vec3f,
    alpha: f32,
    normal: vec3f,      // world, facing the viewer
    roughness: f32,
    emission: vec3f,
    metallic: f32,
    specular: f32,
}

// Where maps are placed, gradients come from the interpolated uv, and the scale goes on after: beside a
// triangle's edge some drivers read 0 from buffers in the lanes that only serve differences.
fn base_color_at(in: VertexOut) -> vec4f {
    let m = materials[in.material];
    let factor = in.color * vec4f(m.base_color, m.alpha);
    if (!HAS_BASE_COLOR_MAP) {
        return factor;
    }
    if (!HAS_PLACED_MAPS) {
        return factor * textureSample(base_color_map, base_color_sampler, in.uv);
    }
    let uv = in.uv * m.uv_base_color.xy + m.uv_base_color.zw;
    return factor * textureSampleGrad(base_color_map, base_color_sampler, uv,
        dpdx(in.uv) * m.uv_base_color.xy, dpdy(in.uv) * m.uv_base_color.xy);
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
    var dx = dpdx(in.uv);
    var dy = dpdy(in.uv);
    var bump = vec3f(0.0);
    if (HAS_PLACED_MAPS) {
        dx *= m.uv_normal.xy;
        dy *= m.uv_normal.xy;
        let uv = in.uv * m.uv_normal.xy + m.uv_normal.zw;
        bump = textureSampleGrad(normal_map, normal_sampler, uv, dx, dy).xyz * 2.0 - 1.0;
    } else {
        bump = textureSample(normal_map, normal_sampler, in.uv).xyz * 2.0 - 1.0;
    }
    return mapped_normal(n, dpdx(in.world), -dpdy(in.world), dx, -dy,
        vec3f(bump.xy * m.normal_scale, max(bump.z, 1e-3)));
}

fn surface_at(in: VertexOut, is_front: bool) -> SurfacePoint {
    let m = materials[in.material];
    let base = base_color_at(in);
    var point: SurfacePoint;
    point.base_color = base.rgb;
    point.alpha = base.a;
    point.normal = surface_normal(in, m, is_front);
    point.roughness = m.roughness;
    point.metallic = m.metallic;
    point.emission = m.emission;
    point.specular = m.specular;
    let dx = dpdx(in.uv);
    let dy = dpdy(in.uv);
    if (HAS_METALLIC_ROUGHNESS_MAP) {
        var mr = vec4f(0.0);
        if (HAS_PLACED_MAPS) {
            let place = m.uv_metallic_roughness;
            mr = textureSampleGrad(metallic_roughness_map, metallic_roughness_sampler,
                in.uv * place.xy + place.zw, dx * place.xy, dy * place.xy);
        } else {
            mr = textureSample(metallic_roughness_map, metallic_roughness_sampler, in.uv);
        }
        point.roughness = clamp(m.roughness * mr.g, 0.0, 1.0);
        point.metallic = clamp(m.metallic * mr.b, 0.0, 1.0);
    }
    if (HAS_EMISSION_MAP) {
        if (HAS_PLACED_MAPS) {
            let place = m.uv_emission;
            point.emission *= textureSampleGrad(emission_map, emission_sampler,
                in.uv * place.xy + place.zw, dx * place.xy, dy * place.xy).rgb;
        } else {
            point.emission *= textureSample(emission_map, emission_sampler, in.uv).rgb;
        }
    }
    return point;
}
