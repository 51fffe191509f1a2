"""From a renderer's layers to a surface that a person looks at; nothing is read back.

combine      layers summed, one chosen, or a debug view; averaged over samples
meter        exposure from the picture itself        tone      exposure, curve, sRGB
show         the toned picture on a surface of any size
presenter    the four in a row
"""
