"""Air on the device, and view rays marched through it.

air            all media of a scene: extinction, scattering, depth towards the eye and the lights
light_columns  mean density of grids towards every light
rays           which eye ray a texel of a reduced picture stands for
march          in-scattered radiance of solved sources, and the air's transmittance
upsample       a reduced picture at full size, by depth
guided         the same by depth and density: as sharp as the air itself
transmittance  the exact transmittance of media without grids
compose        surfaces behind air, and the air's own light
"""
