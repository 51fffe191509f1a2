// Stores a cell's third band, and the six irradiances of its ambient cube.
//! use sky_light

fn store_sky_media_sides(texel: vec3u, light: SkyLight) {
    let slab = vec3u(0u, 0u, textureDimensions(third).z / 4u);
    textureStore(third, texel, stored(light.squares[0].x, light.squares[0].yzw));
    textureStore(third, texel + slab, stored(light.squares[1].x, light.squares[1].yzw));
    textureStore(third, texel + 2u * slab, stored(light.squares[2].x, light.squares[2].yzw));
    textureStore(third, texel + 3u * slab, stored(light.rest.x, vec3f(light.rest.yz, 0.0)));
    // The ambient cube of lattice/skylight: +x -x +y -y +z -z.
    for (var axis = 0u; axis < 3u; axis++) {
        textureStore(cube, texel + 2u * axis * slab, vec4f(light.plus[axis], 1.0));
        textureStore(cube, texel + (2u * axis + 1u) * slab, vec4f(light.minus[axis], 1.0));
    }
}
