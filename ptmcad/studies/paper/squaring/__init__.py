"""Section 5.2 of the paper without its obstacle: the equations with free lengths, roots cleared by squaring, and all
their solutions at one design, those that squaring added told apart."""
