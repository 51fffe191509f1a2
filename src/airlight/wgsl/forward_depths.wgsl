// Optical depths of all media on a light's path to a point, and where light that they scatter forwards comes from. The including
// pass declares LightData, the media with what `media_light` needs, and SLANT_MEDIA: beyond so many, light comes slantwise
// from those alone that the straight path meets.
//! use forward_beams
//! use media_light

const SLANT_DEVIATIONS = 3.0;   // beside a medium that its light is looked for
const LEAST_DEFLECTED = 1e-3;   // optical depth, by which media beside the straight path count

struct Depths {
    reduced: vec3f,     // optical depth of the reduced medium
    forward: vec3f,     // that the true medium has besides
    scattering: vec3f,  // of it
    deviation: f32,     // m, of the light's spread across its direction
    back: f32,          // m, from where it is deflected
}

// Where light comes slantwise to a point from: sums over media of squares, m^2, by weight.
struct Slants {
    squares: vec2f,     // of the deviation, of the distance back
    weight: f32,
}

// Of medium m between `near` and `far`, m, before the point; green's spread.
fn with_slant(sum: Slants, m: u32, near: f32, far: f32, weight: f32) -> Slants {
    let own = slant(near, far, row_of_media(m).g.g);
    return Slants(sum.squares + weight * own * own, sum.weight + weight);
}

// Of a medium that the path from p passes by, where it would lie on a path that goes through it.
fn with_slant_beside(sum: Slants, m: u32, p: vec3f, direction: vec3f) -> Slants {
    // Metres along the axes of the medium's box, from its middle.
    let rows = transpose(row_of_media(m).volume_from_world);
    let size = 1.0 / vec3f(length(rows[0].xyz), length(rows[1].xyz), length(rows[2].xyz));
    let o = (medium_coordinates(m, p) - 0.5) * size;
    let span = span_beside(size, o, volume_direction(m, direction) * size);
    if (span.x >= span.y) {
        return sum;
    }
    let deviations = span.z / max(slant(span.x, span.y, row_of_media(m).g.g).x, 1e-6);
    if (deviations > SLANT_DEVIATIONS) {
        return sum;
    }
    return with_slant(sum, m, span.x, span.y, LEAST_DEFLECTED * exp(-0.5 * deviations * deviations));
}

// All media between p and a light. `is_slanted`: where its light comes slantwise from counts, too.
fn depths_towards(light: LightData, index: u32, p: vec3f, is_slanted: bool) -> Depths {
    let path = media_light_path(light, p);
    var sum = Depths(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0);
    var slants = Slants(vec2f(0.0), 0.0);
    var along = vec2f(0.0);
    var walk = walk_towards(index, p, path);
    loop {
        if (walk.medium != NO_MEDIUM) {
            let m = walk.medium;
            let column = media_light_column(m, index, p, path);
            let reduced = row_of_media(m).sigma_t * column;
            let isotropic = max(vec3f(1e-4), 1.0 - row_of_media(m).g);
            sum.reduced += reduced;
            let scattering = reduced * row_of_media(m).albedo / isotropic;
            sum.forward += scattering * row_of_media(m).g;
            sum.scattering += scattering;
            // Each counts by what it deflects; of many, none of which is looked for beside the path, the lengths in them add up.
            let deflected = scattering.g * row_of_media(m).g.g;
            if (MEDIA_COUNT > SLANT_MEDIA) {
                along += slant(0.0, select(0.0, column, deflected > 0.0), row_of_media(m).g.g);
            } else if (is_slanted && deflected > 0.0) {
                let span = medium_interval(m, p, path.xyz);
                slants = with_slant(slants, m, max(span.x, 0.0), min(span.y, path.w), deflected);
            }
        }
        continuing {
            step_towards(&walk);
            break if walk.is_done;
        }
    }
    // Directional lights are blurred, and so come to where the straight path meets no medium.
    if (is_slanted && light.kind == LIGHT_DIRECTIONAL && MEDIA_COUNT <= SLANT_MEDIA
        && slants.weight < LEAST_DEFLECTED) {
        for (var m = 0u; m < MEDIA_COUNT; m++) {
            if (row_of_media(m).g.g > 0.0) {
                slants = with_slant_beside(slants, m, p, path.xyz);
            }
        }
    }
    let slanted_m = along + sqrt(slants.squares / max(slants.weight, 1e-20));
    sum.deviation = slanted_m.x;
    sum.back = slanted_m.y;
    return sum;
}
