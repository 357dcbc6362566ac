"""Verification of a stored region map by methods that share no code with the one that made it.

Guarantee: nothing here imports the exact engine (`algebra`, `cad`, `variety`, `counting`, `regions`, `locate`,
`exactmap`) or its models; a layering test holds that. Common to both are FLINT, and the result's own data classes.
"""

from __future__ import annotations

from ptmcad.verification.report import Check, VerifyReport
from ptmcad.verification.verify import verify

__all__ = ["Check", "VerifyReport", "verify"]
