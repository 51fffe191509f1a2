"""Participating media in a frame: extinction, light scattered once, and marching of solved fields.

    scene.medium, scene.volume -> gpu_media: extinction, scattering, transmittance towards lights
        shadow maps -> bounds -> shafts (lit intervals of rays), shadow_volumes, jitter
        sky lights  -> sky_in_media: the environment's light in cells
        fields      -> march (rays, march_cells, march_kernel) -> upsample, guided -> compose
    media: the solver that yields the sky's light and draws all of it; media_image: its passes

gpu_media        all media of a scene on the device; light_columns: density of grids towards lights
transmittance    the exact transmittance of media without grids
shafts           lit intervals through shadow maps, integrated at once, or in density grids by steps
facets           shadow maps as quad-trees of planar facets; shadow_volumes: drawn and added up
jitter, blur     the cheap way: jittered steps, and the pattern taken out again
half_space       light of an endless medium beyond the lattices
volume_blockers  volumes as blockers of a lattice; attenuated_maps: of what lights send through them
"""
