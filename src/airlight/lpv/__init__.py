"""Light propagation volumes: indirect light on a lattice (Kaplanyan2010).

propagate    six-neighbour steps, one dispatch each        lpv    the technique, top to bottom
"""
