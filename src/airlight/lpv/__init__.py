"""Light propagation volumes: indirect light on nested lattices (Kaplanyan2010).

    reflective shadow maps, sky, points of light
        | lattice.inject: texels are virtual point lights (section 3.1)
        v
    states of cells <- border: light of the larger lattice around a finer one
        | propagate: steps, summed by doubling and with their tail (section 3.3)
        |   step: the kernels     storage: how states are stored     sums: totals, powers
        v
    lattice.lookup: textures that surfaces and media read (section 3.4)

solver           all of it, top to bottom: yields irradiance and reflected light
settings         what it can be told
cascades         the nested lattices and the buffers of each (section 4)
lattice_media    how volumes take part: they attenuate, block and send light of their own
less             light of one lattice without that of another
seen_blockers    blockers from what camera and lights see, and
geometry_volume  the paper's own, as spherical harmonics (section 3.2)
"""
