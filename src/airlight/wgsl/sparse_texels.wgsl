// Which texels of a reduced image are sparse samples (media/shafts/sparse_samples.wgsl): their rows begin at even
// and odd texels alternately.

fn texel_of_sample(sample: vec2u) -> vec2u {
    return vec2u(2u * sample.x + (sample.y & 1u), 2u * sample.y);
}
