"""Equilibria with free lengths, by the dense search, where all springs are alike."""

from __future__ import annotations

from support.dense_search import dense_search


def free_length_equilibria(*values: float) -> int:
    """Different equilibria for (rho, L1, L2, l0, f3, f4), with stiffness 1."""
    given = dict(zip(("rho", "L1", "L2", "l0", "F3", "F4"), values, strict=True))
    springs = {f"k{n}": 1.0 for n in (1, 2, 3)} | {f"l0_{n}": given["l0"] for n in (1, 2, 3)}
    total: int = dense_search({"F3x": 0.0, "F4x": 0.0, **given, **springs})["total"]
    return total
