"""The schemes split and paper: light propagates in a grid per ordinate (Elek2014 section 4).

ordinates, density -> grids: parallel to each ordinate, or shells around a local light
  -> propagate: steps through all grids at once, ahead, aside and behind
  -> merge: all grids on the cells of the medium, and the residuum that they hand over
  -> emission: radiance towards the eye
propagation: grids, steps and merge together; scheme: the face that the solver sees
"""
