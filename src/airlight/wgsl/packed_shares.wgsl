// Three shares of 0 to 1 in one number that is exact in 32 bits: eight bits each.

fn packed_shares(shares: vec3f) -> f32 {
    let steps = round(255.0 * saturate(shares));
    return steps.x + 256.0 * (steps.y + 256.0 * steps.z);
}

fn unpacked_shares(packed: f32) -> vec3f {
    let steps = u32(packed);
    return vec3f(vec3u(steps & 255u, (steps >> 8u) & 255u, steps >> 16u)) / 255.0;
}
