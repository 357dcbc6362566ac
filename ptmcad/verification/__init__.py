"""Verification of a stored region map by methods that share no code with the one that made it.

Guarantee: nothing here imports the engines (`algebra`, `exact`, `certified`); a contract in
pyproject.toml holds that. Common to both are FLINT, the text of numbers, descriptions, the slice
with its table of counts, and the result's data classes.
"""

from __future__ import annotations

from ptmcad.verification.arrangements import verify_changes, verify_surfaces
from ptmcad.verification.checks import verify
from ptmcad.verification.designs import verify_design
from ptmcad.verification.ranges import verify_range
from ptmcad.verification.report import Check, VerifyReport, check_anew
from ptmcad.verification.solutions import verify_poses

__all__ = [
    "Check",
    "VerifyReport",
    "check_anew",
    "verify",
    "verify_changes",
    "verify_design",
    "verify_poses",
    "verify_range",
    "verify_surfaces",
]
