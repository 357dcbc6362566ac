"""Open cylindrical algebraic decomposition of a rectangular window, with exact adjacency."""
