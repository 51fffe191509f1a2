// 64 bits as two words, the lower one first.

fn two_words(bits: u64) -> vec2u {
    return vec2u(u32(bits), u32(bits >> 32u));
}

fn four_words(bits: vec2<u64>) -> vec4u {
    return vec4u(two_words(bits.x), two_words(bits.y));
}
