// Which texels of a reduced picture are sites (media/shafts/sparse_samples.wgsl): a row of them begins at an even
// and an odd texel by turns.

fn texel_of_site(site: vec2u) -> vec2u {
    return vec2u(2u * site.x + (site.y & 1u), 2u * site.y);
}
