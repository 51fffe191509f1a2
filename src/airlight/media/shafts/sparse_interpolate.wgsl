// The texels between sites: the mean of those beside them where these are of the same depth and
// alike; others are listed.
//! use pixel_list
//! use sparse_texels

// Of the depth, how far off a site's may be.
const SAME_DEPTH_AS_SITE = 0.03;

// The site of a texel, which is one, and whether the picture has it.
fn site_of(texel: vec2i) -> vec3i {
    let site = (texel - vec2i((texel.y >> 1u) & 1, 0)) / 2;
    let is_in = all(texel >= vec2i(0)) && all(texel < vec2i(rays.reduced));
    return vec3i(select(vec2i(0), site, is_in), select(0, 1, is_in));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let texel = vec2i(min(id.xy, rays.reduced - 1u));
    let own = textureLoad(picked, texel, 0).x;
    let is_odd_row = (texel.y & 1) == 1;
    // In a row of sites those left and right, and above and below to compare with. Between rows
    // the one straight above or below (twice), and two beside it in the other row.
    let row = texel.y & ~1;
    let shift = (row >> 1u) & 1;
    let is_upper = (texel.x & 1) == shift;
    let is_site = !is_odd_row && is_upper;
    let up = vec2i(0, select(-2, select(1, -1, is_upper), is_odd_row));
    let down = vec2i(0, select(2, up.y, is_odd_row));
    let beside = vec2i(1, select(0, -up.y, is_odd_row));
    var places = array(texel + vec2i(-beside.x, beside.y), texel + beside, texel + up, texel + down);
    var sum = vec3f(0.0);
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    var is_held = true;
    for (var k = 0u; k < 4u; k++) {
        let site = site_of(select(places[k], texel, is_site));
        let here = textureLoad(sites, site.xy, 0);   // a: how far its ray goes, m
        let counts = is_odd_row || k < 2u;
        let is_beside = abs(here.a - own) < SAME_DEPTH_AS_SITE * min(here.a, own);
        sum += select(0.0, select(0.5, 0.25, is_odd_row), counts) * here.rgb;
        is_held = is_held && site.z == 1 && (!counts || is_beside);
        least = min(least, here.rgb);
        most = max(most, here.rgb);
    }
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    textureStore(scattered, texel, vec4f(sum, own));
    least = select(vec3f(3e38), least, is_held);
    if (!is_site && is_redrawn(least, most, redrawn.contrast)) {
        list_pixel(id.xy, vec3f(0.0), redrawn.group);
    }
}
