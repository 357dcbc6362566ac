"""Equilibria with free lengths, by the dense search, where all springs are alike."""

from __future__ import annotations

from support.dense_search import dense_search
from support.paper_energy import alike


def free_length_equilibria(*values: float) -> int:
    """Different equilibria for (rho, L1, L2, l0, f3, f4), with stiffness 1."""
    total: int = dense_search(alike(*values))["total"]
    return total
