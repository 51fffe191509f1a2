// A reduced picture at full size, and the pixels that cannot be made of its texels listed, with how
// many groups they fill: where texels of the pixel's own depth differ, or none is of its depth.
//! use upsample_corner

// Texels whose depth counts for less are another surface's.
const SAME_DEPTH = 0.2;
const MOST_GROUPS = 65535u;

fn list(pixel: vec2u) {
    let at = atomicAdd(&found[0], 1u);
    chosen[at] = pixel.x | (pixel.y << 16u);
    atomicMax(&groups[0], min(at / refine.group + 1u, MOST_GROUPS));
    atomicMax(&groups[1], 1u);
    atomicMax(&groups[2], 1u);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let own = own_distance(position.xy);
    var sum = vec3f(0.0);
    var total = 0.0;
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    for (var k = 0u; k < 4u; k++) {
        let corner = corner_of(position.xy, k);
        let texel = textureLoad(reduced, corner.texel, 0);   // a: how far its ray goes, m
        let likeness = depth_weight(texel.a, own);
        let weight = corner_weight(corner.share, likeness);
        sum += weight * texel.rgb;
        total += weight;
        if (likeness > SAME_DEPTH) {
            least = min(least, texel.rgb);
            most = max(most, texel.rgb);
        }
    }
    if (refine.contrast <= 0.0 || least.x > 1e38 || any(most - least > refine.contrast * most)) {
        list(vec2u(position.xy));
    }
    return vec4f(sum / total, 1.0);
}
