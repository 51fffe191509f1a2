// The texels between sparse samples: the mean of the samples beside them where these are of the same depth and
// alike; other texels are listed.
//! use pixel_list
//! use sparse_texels

// The relative difference of depth up to which a sample counts as of the same surface.
const SAME_DEPTH_AS_SAMPLE = 0.03;

// The sample of a texel that is one; z: whether the image has it.
fn sample_of(texel: vec2i) -> vec3i {
    let sample = (texel - vec2i((texel.y >> 1u) & 1, 0)) / 2;
    let is_in = all(texel >= vec2i(0)) && all(texel < vec2i(rays.reduced));
    return vec3i(select(vec2i(0), sample, is_in), select(0, 1, is_in));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2i(min(id.xy, rays.reduced - 1u));
    let own = textureLoad(picked, texel, 0).x;
    // In a row of samples those left and right, and above and below to compare with. Between rows
    // the one straight above or below (twice), and two beside it in the other row.
    let is_odd_row = (texel.y & 1) == 1;
    let row = texel.y & ~1;
    let shift = (row >> 1u) & 1;
    let is_upper = (texel.x & 1) == shift;
    let is_sample = !is_odd_row && is_upper;
    let up = vec2i(0, select(-2, select(1, -1, is_upper), is_odd_row));
    let down = vec2i(0, select(2, up.y, is_odd_row));
    let beside = vec2i(1, select(0, -up.y, is_odd_row));
    var taps = array(texel + vec2i(-beside.x, beside.y), texel + beside, texel + up, texel + down);
    // Their mean, and between which colours they lie.
    var sum = vec3f(0.0);
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    var is_covered = true;
    for (var k = 0u; k < 4u; k++) {
        let tap = sample_of(select(taps[k], texel, is_sample));
        let here = textureLoad(samples, tap.xy, 0);   // a: distance of its ray, m
        let counts = is_odd_row || k < 2u;
        let is_beside = abs(here.a - own) < SAME_DEPTH_AS_SAMPLE * min(here.a, own);
        sum += select(0.0, select(0.5, 0.25, is_odd_row), counts) * here.rgb;
        is_covered = is_covered && tap.z == 1 && (!counts || is_beside);
        least = min(least, here.rgb);
        most = max(most, here.rgb);
    }
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    textureStore(scattered, texel, vec4f(sum, own));
    // A texel between samples that differ is redrawn.
    least = select(vec3f(3e38), least, is_covered);
    if (!is_sample && is_redrawn(least, most, redrawn.contrast)) {
        list_pixel(id.xy, vec3f(0.0), redrawn.group);
    }
}
