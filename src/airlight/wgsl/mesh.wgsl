// Vertices and materials of meshes. A pass that uses this binds `instances`, `materials` and, as
// group 1, the four maps and their samplers.

struct VertexIn {
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec4f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
}

struct VertexOut {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(4) @interpolate(flat) material: u32,
}

struct SurfacePoint {
    base_color: vec3f,
    alpha: f32,
    normal: vec3f,      // world, facing the viewer
    roughness: f32,
    emission: vec3f,
    metallic: f32,
    specular: f32,
}

fn placed_vertex(in: VertexIn, clip_from_world: mat4x4f) -> VertexOut {
    let instance = instances[in.instance];
    var out: VertexOut;
    let world = instance.world_from_object * vec4f(in.position, 1.0);
    out.clip = clip_from_world * world;
    out.world = world.xyz;
    out.normal = (instance.normal_from_object * vec4f(in.normal.xyz, 0.0)).xyz;
    out.uv = in.uv;
    out.color = in.color;
    out.material = instance.material;
    return out;
}

// Gradients come from the interpolated uv, and the material's scale goes on after: beside a
// triangle's edge some drivers read 0 from buffers in the lanes that only serve differences.
fn base_color_at(in: VertexOut) -> vec4f {
    let m = materials[in.material];
    let uv = in.uv * m.uv_base_color.xy + m.uv_base_color.zw;
    return textureSampleGrad(base_color_map, base_color_sampler, uv,
        dpdx(in.uv) * m.uv_base_color.xy, dpdy(in.uv) * m.uv_base_color.xy)
        * in.color * vec4f(m.base_color, m.alpha);
}

fn facing_normal(in: VertexOut, is_front: bool) -> vec3f {
    let n = normalize(in.normal);
    return select(-n, n, is_front);
}

// The normal map's normal, its frame made of screen derivatives (Schueler 2013): no tangents.
// The screen's y runs down, so that its frame is left-handed: the second difference is turned over.
fn mapped_normal(
    n: vec3f, world: vec3f, uv_dx: vec2f, uv_dy: vec2f, tangent_space: vec3f,
) -> vec3f {
    let dp1 = dpdx(world);
    let dp2 = -dpdy(world);
    let duv1 = uv_dx;
    let duv2 = -uv_dy;
    let p2 = cross(dp2, n);
    let p1 = cross(n, dp1);
    let t = p2 * duv1.x + p1 * duv2.x;
    let b = p2 * duv1.y + p1 * duv2.y;
    let longest = max(dot(t, t), dot(b, b));
    if (longest < 1e-20) {
        return n;
    }
    let scale = inverseSqrt(longest);
    // v runs down the image, a normal map's green up.
    return normalize(t * scale * tangent_space.x - b * scale * tangent_space.y
        + n * tangent_space.z);
}

fn surface_at(in: VertexOut, is_front: bool) -> SurfacePoint {
    let m = materials[in.material];
    let base = base_color_at(in);
    let uv_mr = in.uv * m.uv_metallic_roughness.xy + m.uv_metallic_roughness.zw;
    let uv_n = in.uv * m.uv_normal.xy + m.uv_normal.zw;
    let uv_e = in.uv * m.uv_emission.xy + m.uv_emission.zw;
    let dx = dpdx(in.uv);
    let dy = dpdy(in.uv);
    let mr = textureSampleGrad(metallic_roughness_map, metallic_roughness_sampler, uv_mr,
        dx * m.uv_metallic_roughness.xy, dy * m.uv_metallic_roughness.xy);
    let bump = textureSampleGrad(normal_map, normal_sampler, uv_n, dx * m.uv_normal.xy,
        dy * m.uv_normal.xy).xyz * 2.0 - 1.0;
    let glow = textureSampleGrad(emission_map, emission_sampler, uv_e, dx * m.uv_emission.xy,
        dy * m.uv_emission.xy).rgb;
    var point: SurfacePoint;
    point.base_color = base.rgb;
    point.alpha = base.a;
    let n = facing_normal(in, is_front);
    let bent = mapped_normal(n, in.world, dx * m.uv_normal.xy, dy * m.uv_normal.xy,
        vec3f(bump.xy * m.normal_scale, max(bump.z, 1e-3)));
    point.normal = select(n, bent, m.has_normal_map != 0u);
    point.roughness = clamp(m.roughness * mr.g, 0.0, 1.0);
    point.metallic = clamp(m.metallic * mr.b, 0.0, 1.0);
    point.emission = m.emission * glow;
    point.specular = m.specular;
    return point;
}
