"""The best design with proof: bounds of a range's length, or of an area, over boxes of design
parameters.
"""
