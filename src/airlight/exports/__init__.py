"""What was solved, for other programs: light fields as plain arrays with a header.

light_field        the values, and how irradiance is read off them in NumPy
light_field_file   .npz, or a folder of .npy, with JSON saying what is where
solved             the light field of a renderer, or of a scene
"""
