"""Participating media in a frame: extinction, single scattering, and marching of solved fields.

    scene.medium, scene.volume -> gpu_media: extinction, scattering, transmittance towards lights
        shadow maps -> shafts/: single scattering of lights, in lit intervals of eye rays
        sky lights  -> sky_in_media: the light of the environment in cells of a lattice
        fields      -> march/: multiple scattering, and single scattering of the sky
        both        -> compositing/: reduced images at full size, surfaces behind media

media            the solver that yields the light of the sky, and draws all of it
media_image      the passes of one image; image_textures: what is asked of it, and drawn to
gpu_media        all media of a scene on the device; media_slots: what passes bind to read them
media_rows       each medium as a row of their table
atlas            their density grids in one texture; emission_grids: what they give off
density_grids    that texture and the columns through it, once for all tables of media
media_tree       their boxes, as rays walk them; path_lists: those between a point and a light
media_changes    the boxes of media that changed; stale_cells: cells that the sky's light reaches so
light_columns    column density of density grids towards lights; column_texels: how fine
detail           noise below their voxels
rays             which eye ray each texel of a reduced image stands for
reduced          media that stand for others: isotropic ones in what solvers solve, absorbing ones
                 for those that another solver knows
pixel_list       pixels to redraw; settings: of all this
volume_blockers  volumes as blockers of a lattice
attenuated_maps  reflective shadow maps, attenuated by media
"""
