"""Boundaries of regions: walls as polylines, and strips over which a boundary has one shape."""
