"""Numbers, polynomials, expressions and YAML as text, and back, exactly; with line numbers where a
user wrote them.
"""
