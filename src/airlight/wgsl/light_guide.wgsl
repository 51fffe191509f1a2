// Where lights shine on surfaces, as a few spheres around what is lit: directions towards them, and how likely each is
// chosen. The including pass binds `lit_patches` (gather/guide.py). `facing` says where rays go that no patch leads: by the cosine
// about a surface's normal, or from the air by lobe_density about a vector as long as the lobe's mean cosine.
//! use gather
//! use guided_share

override FROM_AIR: bool = false;

const LIT_PATCHES = 16u;
const LEAST_SINE2 = 1e-6;
const MOST_SINE2 = 0.9;

// A patch as a point of a surface or in the air sees it.
struct PatchSight {
    along: vec3f,
    sine2: f32,             // of half the angle of its cone
    height: f32,            // one minus the cosine of that
    light: f32,             // W m^-2, about
    found: f32,             // share of rays that no patch leads that meet its cone, about
    weight: f32,            // of its being chosen
}

// The cones of all patches as a point sees them: where they lie, and their weights over 2 pi times how high they are.
struct PatchCones {
    count: u32,
    along_sine2: array<vec4f, LIT_PATCHES>,
    density: array<f32, LIT_PATCHES>,
}

// How patches are chosen at a point, and the one that a number chooses.
struct GuideChoice {
    total: f32,             // of all weights
    found: f32,             // share of rays that no patch leads that find the patches' light
    chosen: PatchSight,
    number: f32,            // uniform again
}

// Over pi the density, sr^-1, of rays that no patch leads, towards a cone about `along`; of a surface's eased by the sine
// of half its angle.
fn patch_cosine(along: vec3f, sine: f32, facing: vec3f) -> f32 {
    if (FROM_AIR) {
        let g = length(facing);
        return 3.14159265 * lobe_density(dot(facing, along) / max(g, 1e-6), g);
    }
    return saturate((dot(facing, along) + sine) / (1.0 + sine));
}

fn patch_sight(k: u32, place: vec3f, facing: vec3f) -> PatchSight {
    let lit = lit_patches[k];
    let offset = lit.centre - place;
    let d2 = max(dot(offset, offset), 1e-20);
    var out: PatchSight;
    out.along = offset * inverseSqrt(d2);
    out.sine2 = lit.radius * lit.radius / d2 + LEAST_SINE2;
    let sine = sqrt(out.sine2);
    out.height = out.sine2 / (1.0 + sqrt(max(1.0 - out.sine2, 0.0)));
    let cosine = patch_cosine(out.along, sine, facing);
    let sent = saturate(1.0 - length(lit.normal) + sine - dot(lit.normal, out.along));
    // A point inside of a sphere, or nearly, finds what is in it by other rays.
    out.light = select(0.0, lit.flux * cosine * sent / d2, out.sine2 < MOST_SINE2);
    out.found = clamp(2.0 * out.height * cosine, 1e-7, 1.0);
    out.weight = out.light / (1.0 + out.found / RARE);
    return out;
}

// How dense the directions of a cone are, times the weights of all, at one: 0 outside of it.
fn cone_density(direction: vec3f, along: vec3f, sine2: f32, density: f32) -> f32 {
    let off = cross(direction, along);
    return select(0.0, density, dot(off, off) < sine2 && dot(direction, along) > 0.0);
}

// `number` in [0, 1) chooses; all cones are put down in `cones`.
fn guide_choice(place: vec3f, facing: vec3f, number: f32, cones: ptr<function, PatchCones>) -> GuideChoice {
    var out: GuideChoice;
    out.number = number;
    var light = 0.0;
    var noise = 0.0;
    let count = u32(lit_patches[LIT_PATCHES].radius);
    (*cones).count = count;
    for (var k = 0u; k < count; k++) {
        // What the point sees of the patch, stored for the densities of directions.
        let seen = patch_sight(k, place, facing);
        (*cones).along_sine2[k] = vec4f(seen.along, seen.sine2);
        (*cones).density[k] = seen.weight / (6.2831853 * seen.height);
        light += seen.light;
        noise += seen.light * seen.light / seen.found;
        out.total += seen.weight;
        // One of all so far, each as likely as its weight.
        let share = seen.weight / max(out.total, 1e-30);
        let is_chosen = out.number < share;
        out.number = select((out.number - share) / max(1.0 - share, 1e-9), out.number / max(share, 1e-9), is_chosen);
        if (is_chosen) {
            out.chosen = seen;
        }
    }
    out.number = saturate(out.number);
    out.found = select(1.0, light * light / noise, noise > 0.0);
    return out;
}

// At which a direction is chosen, sr^-1, where cones are known; `total`: of all weights.
fn density_of_cones(cones: ptr<function, PatchCones>, total: f32, direction: vec3f) -> f32 {
    var inside = 0.0;
    for (var k = 0u; k < (*cones).count; k++) {
        let cone = (*cones).along_sine2[k];
        inside += cone_density(direction, cone.xyz, cone.w, (*cones).density[k]);
    }
    return inside / max(total, 1e-30);
}

// At which a direction is chosen, sr^-1.
fn guide_density(place: vec3f, facing: vec3f, direction: vec3f) -> f32 {
    var total = 0.0;
    var inside = 0.0;
    let count = u32(lit_patches[LIT_PATCHES].radius);
    for (var k = 0u; k < count; k++) {
        let seen = patch_sight(k, place, facing);
        total += seen.weight;
        inside += cone_density(direction, seen.along, seen.sine2, seen.weight / (6.2831853 * seen.height));
    }
    return inside / max(total, 1e-30);
}

// Whether there are any patches.
fn has_guide() -> bool {
    return lit_patches[LIT_PATCHES].radius > 0.0;
}

// Whether a patch leads a ray, by a part of a number in [0, 1); `rest` of it is uniform again.
struct Led { part: f32, is_led: bool, rest: f32 }

fn led(choice: GuideChoice, number: f32) -> Led {
    let part = select(0.0, guided_share(choice.found), choice.total > 0.0);
    let is_led = number < part;
    return Led(part, is_led, select((number - part) / (1.0 - part), number / max(part, 1e-9), is_led));
}
