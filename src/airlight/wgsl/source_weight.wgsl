// What a source's light is times. The including pass binds `sources`, and has ABSOLUTE, ALL_MEDIA and SOME_MEDIA of
// fields.py.
//! use media_here
//! use members

// The scattering coefficient that source i leaves out, m^-1; 1 where it is an emission.
fn weight_of_source(i: u32) -> vec3f {
    let source = sources[i];
    if (source.medium == ABSOLUTE) {
        return vec3f(1.0);
    }
    if (source.medium == ALL_MEDIA) {
        return scattering_here();
    }
    // Of those that are its members, or of the parts of one volume, which have rows one after the other.
    var sum = vec3f(0.0);
    for (var j = 0u; j < media_here(); j++) {
        let k = medium_here(j);
        var is_of_it = ray_medium(k) - u32(source.medium) < source.parts;
        if (source.medium == SOME_MEDIA) {
            is_of_it = is_member(ray_medium(k), source.members_low, source.members_high);
        }
        if (is_of_it) {
            sum += media_density_here[k] * sigma_s_of(ray_medium(k));
        }
    }
    return sum;
}
