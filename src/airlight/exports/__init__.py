"""Solved light for other programs: light fields as plain arrays with a header.

    renderer -> solved -> LightField -> light_field_file (.npz, folder) or vdb
                              -> irradiance of surfaces, by lookup

solved             a renderer's lattices and volumes, read back -> light field
light_field        the arrays, and the irradiance that they give surfaces
lookup             where surfaces are looked up in them, in NumPy
light_field_file   .npz, or a folder of .npy, with a JSON header
vdb                OpenVDB files for programs that show volumes
"""
