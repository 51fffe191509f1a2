// What listed pixels' rays found, and its light, to which later segments add theirs.
//! use hit_code
//! use packed_pixel
//! use surface_reflection
//! use specular_cosine
//! use glow_share
//! needs fn air_of(row: u32) -> Air

struct Air {
    light: vec3f,           // W m^-2 sr^-1, that media scatter into a ray
    passed: vec3f,
}

// What of a segment's light is shown here, and which share of what the next one finds.
struct Shown {
    light: vec3f,
    onwards: vec3f,
    glow: f32,              // share of glowing surfaces that the next segment shows; the rest is light here
}

fn shown(at: vec2u, hit: vec4f, seen_glow: f32) -> Shown {
    let direct = textureLoad(direct_light, at, 0).rgb;
    var out = Shown(direct, vec3f(0.0), 0.0);
    if (hit.w <= 0.0) {
        return out;
    }
    let gloss = glosses[hit_material(hit.w)];
    let towards_lights = textureLoad(hit_albedos, at, 0).rgb;
    let albedo = towards_lights + textureLoad(hit_normals, at, 0).w;
    let all_around = albedo / max(towards_lights, vec3f(1e-4)) * textureLoad(indirect_light, at, 0).rgb;
    // No ray meets a single light, and rough metal spreads its highlight: that stays as it is on matt surfaces.
    let lights = textureLoad(lit, at, 0).rgb;
    let goes_on = f32(params.goes_on != 0u);
    let share = goes_on * gloss.metallic;
    out.glow = glow_share(gloss.alpha);
    // What the next ray shows of a coat is no paint, and neither is the light that the coat keeps from what lies under it.
    let v = normalize(textureLoad(starts, at, 0).xyz - hit.xyz);
    let n_v = max(dot(normalize(textureLoad(hit_normals, at, 0).xyz), v), 1e-4);
    let albedos = specular_cosine(n_v, gloss.alpha).albedos;
    let coat = gloss.f0 * albedos.x + saturate(50.0 * gloss.f0) * albedos.y;
    let coat_seen = goes_on * (1.0 - gloss.metallic) * coat_share(gloss.f0, gloss.alpha, n_v);
    let under = max(albedo - coat_seen * gloss.coat, vec3f(0.0)) / max(albedo, vec3f(1e-4));
    let paint = under * (1.0 - coat_seen * coat) / (1.0 - coat_seen * gloss.coat);
    out.light = (1.0 - share * out.glow) * mix(vec3f(1.0), paint, out.glow) * lights
        + (1.0 - share) * paint * (direct - lights + all_around);
    out.onwards = share * albedo + coat_seen * coat;
    if (!is_hit_behind(hit.w) || gloss.two_sided != 0u) {
        out.light += seen_glow * gloss.glow;
    }
    return out;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let at = id.y * params.batch.x + id.x;
    let before = select(params.first, 0u, params.segment > 0u);
    if (any(id.xy >= params.batch) || before + at >= found[params.segment]) {
        return;
    }
    let hit = textureLoad(hit_positions, id.xy, 0);
    let is_followed = textureLoad(starts, id.xy, 0).w > 0.0;
    let pixel = unpacked_pixel(pixels[at]);
    let row = 2u * (pixel.y * u32(params.size.x) + pixel.x);
    var throughput = vec4f(1.0, 1.0, 1.0, 0.0);
    var radiance = vec3f(0.0);
    if (params.segment == 0u) {
        // Pixels show what glows themselves, in closed form.
        let kind = select(NOWHERE, select(LEFT, MET, hit.w > 0.0), is_followed);
        textureStore(mirrored_ends, pixel, vec4f(hit.xyz, kind));
    } else {
        throughput = throughputs[row];
        radiance = throughputs[row + 1u].rgb;
    }
    var onwards = vec4f(0.0);
    if (is_followed) {
        let air = air_of(2u * at);
        let found_here = shown(id.xy, hit, throughput.a);
        radiance += throughput.rgb * (air.light + air.passed * found_here.light);
        onwards = vec4f(throughput.rgb * air.passed * found_here.onwards, found_here.glow);
    }
    // The last segment's are what stays.
    textureStore(mirrored_found, pixel, vec4f(radiance, 0.0));
    throughputs[row] = onwards;
    throughputs[row + 1u] = vec4f(radiance, 0.0);
}
