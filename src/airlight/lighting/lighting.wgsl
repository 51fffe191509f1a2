//! use pixel_point
//! use picture_texel
//! use lights
//! use shadow
//! use sky_reflected

override HAS_SURFACES: bool = true;
override DAMPING: f32 = 0.0;
override HAS_SUNS: bool = true;
override HAS_LAMPS: bool = true;
override IS_ONE_SUN: bool = false;      // the only light
override HAS_LIGHTS: bool = true;       // else `lit` has their light
override HAS_LATTICES: bool = true;
override HAS_PLACES: bool = false;      // `places` and the sky's light on them are known
override RETURNED: f32 = 0.0;           // 1: the lattice's light bounces between near surfaces

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
    if (IS_ONE_SUN) {
        return lit_share(parallel_shadows, shadow_compare, first_parallel_views(), 0u, p, n,
            in.to_light, 1.0);
    }
    let view = view_of(light, in.to_light);
    if (HAS_SUNS && (!HAS_LAMPS || light.kind == LIGHT_DIRECTIONAL)) {
        return lit_share(parallel_shadows, shadow_compare, parallel_views[view], view, p, n,
            in.to_light, 1.0);
    }
    return lit_share(local_shadows, shadow_compare, local_views[view], view, p, n, in.to_light,
        in.distance);
}

fn light_at(i: u32) -> LightData {
    if (IS_ONE_SUN) {
        return first_lights();
    }
    return lights[i];
}

fn arriving_from(light: LightData, p: vec3f) -> Incoming {
    if (!HAS_LAMPS) {
        return Incoming(-light.direction, light.color, 1e30);
    }
    return incoming(light, p);
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
        let light = light_at(i);
        let in = arriving_from(light, p);
        let cosine = dot(n, in.to_light);
        if (cosine > 0.0 && any(in.irradiance > vec3f(0.0))) {
            let lit = light_visibility(light, p, n, in);
            if (lit > 0.0) {
                let arriving = in.irradiance * light_passed(i, p) * cosine * lit;
                sum += reflection(r, n, in.to_light, v) * arriving;
            }
        }
        i++;
        if (IS_ONE_SUN || i >= params.light_count) {
            break;
        }
    }
    return sum;
}

struct LatticeLight {
    sky: SkyReflected,
    bounced: vec3f,     // radiance, W m^-2 sr^-1
}

// What one lattice gives to a surface.
fn lattice_light(
    level: u32, uvw: vec3f, p: vec3f, r: Reflector, n: vec3f, v: vec3f, n_v: f32, near: Near,
    mirrors: vec3f,
) -> LatticeLight {
    let lattice = lattice_of(level);
    let mirrored = reflect(-v, n);
    var e = lattice_irradiance(lattice, uvw, n);
    if (DAMPING > 0.0) {
        e *= lattice_damping(lattice, uvw, n, DAMPING);
    }
    let mirror = mirrored_light(level, p, r, n_v, n, uvw, mirrored);
    let diffuse = (vec3f(1.0) - specular_albedo(r, n_v)) * r.diffuse;
    let seen = interreflected(near.open, r.diffuse);
    var sky = sky_reflected(r, n_v, sky_at(uvw, n), mirror.sky, near.open, mirrors);
    if (HAS_LIGHTS) {
        sky = SkyReflected(sky.shown + sky.returned, vec3f(0.0));
        e *= seen;
    } else {
        // What the near surroundings hide comes back as their own light.
        let open = 1.0 - near.hidden;
        let returned = RETURNED * (interreflected(open, r.diffuse) - open) * e;
        e = replaced(e, from_occluders(lattice, uvw, near), near.light) + returned;
    }
    return LatticeLight(sky, (diffuse * e + mirrors * mirror.bounced) / PI);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Lit {
    let pixel = vec2u(position.xy);
    let d = depth_texel(depth, pixel);
    var out: Lit;
    out.indirect = vec4f(0.0, 0.0, 0.0, 1.0);
    let p = pixel_point(position.xy, d);
    let v = normalize(params.eye - p);
    if (!HAS_SURFACES || d <= 0.0) {
        if (HAS_LIGHTS) {
            out.direct = vec4f(background(-v), 0.0);
        } else {
            out.direct = picture_texel(lit, pixel);
        }
        return out;
    }
    let base = picture_texel(albedo, pixel);
    let bent = picture_texel(normal, pixel);
    let glow = picture_texel(emission, pixel);
    let n = normalize(bent.xyz);
    let r = reflector(base.rgb, base.a, bent.w, glow.a);
    var is_listed = false;
    var open = 1.0;
    var direct = vec3f(0.0);
    var bounced = vec3f(0.0);
    if (HAS_LIGHTS) {
        direct = glow.rgb + direct_light(r, p, n, v);
    } else {
        direct = picture_texel(lit, pixel).rgb;
    }
    if (HAS_LATTICES && params.has_lattice != 0u) {
        let near = near_surroundings(position.xy, 1.0 / (params.world_from_clip[2].w * d));
        open = near.open;
        let n_v = max(dot(n, v), 1e-4);
        is_listed = is_walked_apart(r, n_v);
        let mirrors = select(mirror_gain(r, n_v, near.open), vec3f(0.0), is_listed);
        var place = vec4f(0.0);
        if (HAS_PLACES) {
            place = places_of(pixel);
        }
        // The finest lattice that has the point; towards its border the next larger one.
        let last = last_lattice();
        var left = 1.0;
        var k = 0u;
        loop {
            k = lattice_from(k, p);
            let weight = left * lattice_weight(lattice_of(k), p);
            var uvw = place.xyz;
            if (!HAS_PLACES) {
                uvw = lattice_coordinates(lattice_of(k), p, n);
            }
            let light = lattice_light(k, uvw, p, r, n, v, n_v, near, mirrors);
            direct += weight * light.sky.shown;
            bounced += weight * light.bounced;
            bounced += weight * light.sky.returned;
            left -= weight;
            k++;
            if (k > last || left <= 0.0) {
                break;
            }
        }
        if (HAS_PLACES) {
            let sky = place_sky_of(pixel);
            direct += vec3f(place.w, sky.xy);
            bounced += vec3f(sky.zw, place_returned_of(pixel).x);
        }
    }
    out.indirect = vec4f(bounced, 1.0);
    out.direct = vec4f(direct, 1.0);
    if (is_listed) {
        list_glossy(vec2u(position.xy), direct, bounced, open);
    }
    return out;
}
