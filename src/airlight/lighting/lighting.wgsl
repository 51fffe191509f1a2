//! use pixel_point
//! use lights
//! use shadow
//! use surface_reflection
//! use glossy
//! use lattice
//! use ambient_cube
//! use near_visibility

override HAS_SURFACES: bool = true;
override HAS_OCCLUSION: bool = false;
override HAS_GLOSS: bool = false;
override DAMPING: f32 = 0.0;
override HAS_SUNS: bool = true;
override HAS_LAMPS: bool = true;
override HAS_SKY: bool = true;
override IS_ONE_LATTICE: bool = false;

struct Lit {
    @location(0) direct: vec4f,
    @location(1) indirect: vec4f,
}

fn background(direction: vec3f) -> vec3f {
    let u = atan2(direction.x, -direction.z) / (2.0 * PI)
        + params.environment_rotation / (2.0 * PI);
    let v = acos(clamp(direction.y, -1.0, 1.0)) / PI;
    return textureSampleLevel(environment, environment_sampler, vec2f(u, v), 0.0).rgb;
}

fn light_visibility(light: LightData, p: vec3f, n: vec3f, in: Incoming) -> f32 {
    let view = view_of(light, in.to_light);
    if (HAS_SUNS && (!HAS_LAMPS || light.kind == LIGHT_DIRECTIONAL)) {
        return lit_share(parallel_shadows, shadow_compare, parallel_views[view], view, p, n,
            in.to_light, 1.0);
    }
    return lit_share(local_shadows, shadow_compare, local_views[view], view, p, n, in.to_light,
        in.distance);
}

fn direct_light(r: Reflector, p: vec3f, n: vec3f, v: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    if (!HAS_SUNS && !HAS_LAMPS) {
        return sum;
    }
    // Software drivers run a loop's body once more than a test at its head would let them, and both
    // sides of every branch: loops end with their test.
    var i = 0u;
    loop {
        let light = lights[i];
        let in = incoming(light, p);
        let cosine = dot(n, in.to_light);
        if (cosine > 0.0 && any(in.irradiance > vec3f(0.0))) {
            let lit = light_visibility(light, p, n, in);
            if (lit > 0.0) {
                let arriving = in.irradiance * light_passed(i, p) * cosine * lit;
                sum += reflection(r, n, in.to_light, v) * arriving;
            }
        }
        i++;
        if (i >= params.light_count) {
            break;
        }
    }
    return sum;
}

// Of a single lattice what a loop needs is read once, and nothing is left of loops over lattices.
fn lattice_of(k: u32) -> LatticeParams {
    if (IS_ONE_LATTICE) {
        return lattices[0];
    }
    return lattices[k];
}

fn last_lattice() -> u32 {
    if (IS_ONE_LATTICE) {
        return 0u;
    }
    return arrayLength(&lattices) - 1u;
}

fn sky_at(uvw: vec3f, n: vec3f) -> vec3f {
    if (!HAS_SKY) {
        return vec3f(0.0);
    }
    return sky_irradiance(uvw, n);
}

struct Mirrored {
    sky: vec3f,         // irradiance, W m^-2
    bounced: vec3f,
}

// What comes from around the mirrored direction: of the point's own cell, or along a ray, which
// goes on in the next larger lattice where it leaves one.
fn mirrored_light(
    level: u32, p: vec3f, r: Reflector, n_v: f32, n: vec3f, own: vec3f, mirrored: vec3f,
) -> Mirrored {
    var k = level;
    var uvw = own;
    if (!HAS_GLOSS) {
        return Mirrored(sky_at(own, mirrored),
            lattice_irradiance_at(lattice_of(k), own, mirrored));
    }
    var ray = Glossy(vec3f(0.0), 1.0, 1.0, own, 0.0, false);
    let share = glossy_share(specular_albedo(r, n_v), sqrt(r.alpha));
    if (share > 0.0) {
        ray = glossy_begun();
        let last = last_lattice();
        loop {
            let place = bent_place(lattice_of(k), p);
            let lookup = lattice_lookup_place(lattice_of(k), place, n);
            uvw = lattice_eased(lattice_of(k), lookup, vec3f(0.0));
            let raised = GLOSSY_START * lattice_of(level).cell / lattice_of(k).cell;
            let begin = GlossyRay(n, mirrored, r.alpha, raised);
            ray = glossy_walk(lattice_of(k), place, lookup, begin, ray, k == last);
            if (k == last || !ray.is_cut) {
                break;
            }
            ray.end *= lattice_of(k).cell / lattice_of(k + 1u).cell;
            k++;
        }
    }
    let end = mix(uvw, ray.uvw, share);
    return Mirrored(mix(1.0, ray.left, share) * sky_at(end, mirrored),
        share * ray.irradiance
            + mix(1.0, ray.lit, share) * lattice_irradiance_at(lattice_of(k), end, mirrored));
}

struct LatticeLight {
    sky: vec3f,         // radiance, W m^-2 sr^-1
    bounced: vec3f,
}

// What one lattice gives to a surface.
fn lattice_light(
    level: u32, p: vec3f, r: Reflector, n: vec3f, v: vec3f, open: f32,
) -> LatticeLight {
    let lattice = lattice_of(level);
    let n_v = max(dot(n, v), 1e-4);
    let mirrored = reflect(-v, n);
    let uvw = lattice_coordinates(lattice, p, n);
    var e = lattice_irradiance(lattice, uvw, n);
    if (DAMPING > 0.0) {
        e *= lattice_damping(lattice, uvw, n, DAMPING);
    }
    let mirror = mirrored_light(level, p, r, n_v, n, uvw, mirrored);
    return LatticeLight(reflected(r, n_v, open, sky_at(uvw, n), mirror.sky),
        reflected(r, n_v, open, e, mirror.bounced));
}

// Diffuse light of irradiance e, and e_mirror (around the mirrored direction) by the gloss, as far
// as the near surroundings let it in.
fn reflected(r: Reflector, n_v: f32, visibility: f32, e: vec3f, e_mirror: vec3f) -> vec3f {
    let gloss = specular_albedo(r, n_v);
    let diffuse = (vec3f(1.0) - gloss) * r.diffuse * interreflected(visibility, r.diffuse);
    let mirror = gloss * specular_visibility(visibility, n_v, sqrt(r.alpha));
    return (diffuse * e + mirror * e_mirror) / PI;
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Lit {
    let pixel = vec2i(position.xy);
    let d = textureLoad(depth, pixel, 0);
    var out: Lit;
    out.indirect = vec4f(0.0, 0.0, 0.0, 1.0);
    let p = pixel_point(position.xy, d);
    let v = normalize(params.eye - p);
    if (!HAS_SURFACES || d <= 0.0) {
        out.direct = vec4f(background(-v), 0.0);
        return out;
    }
    let base = textureLoad(albedo, pixel, 0);
    let bent = textureLoad(normal, pixel, 0);
    let glow = textureLoad(emission, pixel, 0);
    let n = normalize(bent.xyz);
    let r = reflector(base.rgb, base.a, bent.w, glow.a);
    var direct = glow.rgb + direct_light(r, p, n, v);
    if (params.has_lattice != 0u) {
        let open = near_visibility(position.xy, 1.0 / (params.world_from_clip[2].w * d));
        // The finest lattice that has the point; towards its border the next larger one.
        let last = last_lattice();
        var left = 1.0;
        var k = 0u;
        loop {
            var weight = 0.0;
            loop {
                weight = left * lattice_weight(lattice_of(k), p);
                if (weight > 0.0 || k >= last) {
                    break;
                }
                k++;
            }
            let light = lattice_light(k, p, r, n, v, open);
            direct += weight * light.sky;
            out.indirect += vec4f(weight * light.bounced, 0.0);
            left -= weight;
            k++;
            if (k > last || left <= 0.0) {
                break;
            }
        }
    }
    out.direct = vec4f(direct, 1.0);
    return out;
}
