// Local lights as points in media see them: those without extent, and samples of those with one. The including pass
// declares LightData, and with the media HAS_SIZED_LIGHTS (media/media_slots.py).
//! use lights
//! use medium
//! use sized_light

// A local light as media see it.
struct SeenLight {
    gain: f32,      // what they get, over its color by the square of the softened distance
    reach: f32,     // m, that attenuates it
    mu: f32,        // cosine of the angle by which what goes to the eye is scattered, in the mean
    sharpness: f32, // what g is multiplied by, as light comes from many directions
}

// From a point `away` from it, towards `eye`; `reach`, m, and `mu` as of a softened point. A part of known size sends
// its radiance from its solid angle, any other as much as a point in all of space.
fn seen_light(light: LightData, away: vec3f, eye: vec3f, reach: f32, mu: f32) -> SeenLight {
    if (has_size(light)) {
        let directions = sized_directions(light, away);
        return SeenLight(reach * reach * sized_share(light, away), sized_reach(light, away),
            dot(directions.xyz, eye), directions.w);
    }
    var gain = 1.0;
    if (sends_by_direction(light.kind)) {
        gain = sent_share(light, normalize(away));
        gain *= select(1.0, softened_gain(light.nearest, reach * reach), light.kind == LIGHT_SAMPLE);
    }
    // Near a part that fills a volume light comes from all sides (maths/point_light_beam.py, local_sharpness).
    let sharpness = reach * inverseSqrt(reach * reach + light.spread * light.spread + 1e-30);
    return SeenLight(gain, reach, mu, sharpness);
}

// What arrives in media from all of a light.
fn incoming_in_media(light: LightData, position: vec3f) -> Incoming {
    if (has_size(light)) {
        let away = position - light.position;
        return Incoming(-normalize(away), light.color * sized_share(light, away), sized_reach(light, away));
    }
    return incoming(light, position);
}

// An interval of an eye ray as a local light sees it: the angles x0 to x1 from the ray's nearest point, t_near, which is
// `h`, m, from the light. t = t_near + h tan(x) removes 1/r^2 (Kulla2012).
struct SeenInterval { t_near: f32, h: f32, x0: f32, x1: f32 }

fn seen_interval(light: LightData, origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> SeenInterval {
    let geometry = ray_light_geometry(origin, direction, light.position);
    let t_near = -geometry.y;
    let h = max(softened(light, geometry.x), 1e-4 * max(abs(t0 - t_near), abs(t1 - t_near)) + 1e-9);
    return SeenInterval(t_near, h, atan((t0 - t_near) / h), atan((t1 - t_near) / h));
}
