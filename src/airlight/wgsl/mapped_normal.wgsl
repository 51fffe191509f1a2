// The normal map's normal, in a frame made of screen derivatives (Schueler2013), or of a tangent.

// `dp1`, `duv1`: what the point and its uv change by from a pixel to the next one to the right; `dp2`,
// `duv2`: to the next one above. The screen's y runs down: who takes differences turns them over.
fn mapped_normal(
    n: vec3f, dp1: vec3f, dp2: vec3f, duv1: vec2f, duv2: vec2f, tangent_space: vec3f,
) -> vec3f {
    let p2 = cross(dp2, n);
    let p1 = cross(n, dp1);
    let t = p2 * duv1.x + p1 * duv2.x;
    let b = p2 * duv1.y + p1 * duv2.y;
    let longest = max(dot(t, t), dot(b, b));
    if (longest < 1e-20) {
        return n;
    }
    let scale = inverseSqrt(longest);
    // v runs down the image, a normal map's green up.
    return normalize(t * scale * tangent_space.x - b * scale * tangent_space.y
        + n * tangent_space.z);
}

// The same by a `tangent` that is not along `n`, whose w is the side of the bitangent. `n` faces the viewer; from behind
// a surface shows the same bumps.
fn tangent_mapped_normal(n: vec3f, is_front: bool, tangent: vec4f, tangent_space: vec3f) -> vec3f {
    let t = normalize(tangent.xyz - n * dot(n, tangent.xyz));
    let side = select(-1.0, 1.0, is_front == (tangent.w > 0.0));
    return normalize(t * tangent_space.x + side * cross(n, t) * tangent_space.y + n * tangent_space.z);
}
