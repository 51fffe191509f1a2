// Pixels around which texels of the reduced picture differ, listed with how many groups they fill.

fn differs_around(pixel: vec2u) -> bool {
    let centre = vec2i(pixel / rays.scale);
    let last = vec2i(rays.reduced) - 1;
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    for (var k = 0; k < 9; k++) {
        let texel = clamp(centre + vec2i(k % 3, k / 3) - 1, vec2i(0), last);
        let value = textureLoad(reduced, texel, 0).rgb;
        least = min(least, value);
        most = max(most, value);
    }
    return any(most - least > refine.contrast * most);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.size) || !differs_around(id.xy)) {
        return;
    }
    let at = atomicAdd(&found[0], 1u);
    chosen[at] = id.x | (id.y << 16u);
    atomicMax(&groups[0], min(at / refine.group + 1u, MOST_GROUPS));
    atomicMax(&groups[1], 1u);
    atomicMax(&groups[2], 1u);
}

const MOST_GROUPS = 65535u;
