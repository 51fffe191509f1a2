// The open shares of a cell's 26 hops, a byte each by the number of the hop, four to a word.
//! needs fn open_hop(at: vec3i, hop: u32) -> f32

fn packed_hops(at: vec3i) -> array<u32, 8> {
    var words: array<u32, 8>;
    for (var word = 0u; word < 7u; word++) {
        var shares = vec4f(1.0);
        for (var k = 0u; k < 4u; k++) {
            let hop = 4u * word + k;
            // Hop 13 would be the cell itself; there are 27 numbers.
            if (hop != 13u && hop < 27u) {
                shares[k] = open_hop(at, hop);
            }
        }
        words[word] = pack4x8unorm(shares);
    }
    return words;
}
