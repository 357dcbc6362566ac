"""Verification of a stored result: of maps, poses, lines and designs by methods that share no code
with the one that made it.

Guarantee: nothing here imports the engines (`algebra`, `exact`, `certified`); a contract in
pyproject.toml holds that. Common to both are FLINT, the text of numbers with the refinement of
algebraic ones, descriptions, the slice with its table of counts, a cover's rectangles, and the
result's data classes with the comparison of two arrangements.

Not guaranteed: what `arrangements` says of a family rests on maps of further members, which its
caller makes; the command has them from the engine, one by one. `report.check_anew` compares with
the engine's answer of now. `solutions` asks the slice whether springs have free lengths, by the
engine's evaluation of what is written in them.

An order of reading, for what an exact map claims:

1. `report`: a check is a function that raises `Violation`, or says what it checked. `checks` lists
   all of them, in the order in which one rests on another.
2. `coordinates`, `constraints`, `kinds`, `derivation`: the polynomials that follow from a
   description, derived once for both halves of this package. `claims`: a stored map seen with them.
3. `polynomialtexts`, `equationtexts`, `parameterclaims`: the stored texts say the same.
   `certified.parameterdomain`: the signs of parameters, of exact maps and lines too, by
   `windowsigns`.
4. `principalminors`, `fibrealgebra`: the solutions over a point, counted by
   signatures. `solutions`: the stored counts and boxes. `norms`: the stored curves are all of those
   where counts change.
5. `planecurves`, `rootcounts`, `projections`, `adjacencies`, `merging`: the decomposition of the
   plane. `planclaims` and, once more, `windowsigns`: what was left out.
6. `disks`, `wallintegrals`, `areaclaims`: enclosures of the areas, by power series alone.
7. `poseclaims`: points. `parameterlines`, `intervalclaims`, `rangeclaims`: lines.
   `designclaims`, `arrangements`: designs and families.

Certified maps have their own order in `certified`. There `normalform` derives formulas from the
polynomials of step 2, `exclusion` finds where their solutions may be, and `certified` itself proves
what is there.
"""

from __future__ import annotations

from ptmcad.verification.arrangements import verify_changes, verify_surfaces
from ptmcad.verification.checks import verify
from ptmcad.verification.designclaims import verify_design
from ptmcad.verification.poseclaims import verify_poses
from ptmcad.verification.rangeclaims import verify_range
from ptmcad.verification.report import Check, VerifyReport, check_anew

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
