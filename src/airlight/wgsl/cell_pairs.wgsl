// Two cells' light (a vec4f each) as one vec4<u64>: the CPU adapter reads and writes lane by
// lane, and per component, so that 32 bytes at once cost little more than 16 in four floats.

struct CellPair { a: vec4f, b: vec4f }

fn cell_pair(bits: vec4<u64>) -> CellPair {
    let x = vec4u(u32(bits.x), u32(bits.x >> 32u), u32(bits.y), u32(bits.y >> 32u));
    let y = vec4u(u32(bits.z), u32(bits.z >> 32u), u32(bits.w), u32(bits.w >> 32u));
    return CellPair(bitcast<vec4f>(x), bitcast<vec4f>(y));
}

fn two_floats(low: f32, high: f32) -> u64 {
    return u64(bitcast<u32>(low)) | (u64(bitcast<u32>(high)) << 32u);
}

fn cell_pair_bits(a: vec4f, b: vec4f) -> vec4<u64> {
    return vec4<u64>(two_floats(a.x, a.y), two_floats(a.z, a.w), two_floats(b.x, b.y),
        two_floats(b.z, b.w));
}
