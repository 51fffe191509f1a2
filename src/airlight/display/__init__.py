"""From a renderer's layers to a surface that a person looks at; nothing is read back.

combine      layers summed, one chosen, or a debug view; averaged over samples
meter        exposure from the image itself        tone      exposure, curve, sRGB
show         the toned image on a surface of any size
presenter    the four in a row
"""
