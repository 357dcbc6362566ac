"""The savings: what a computation leaves out because a slice does not need it, each with the
reason, by name.

Guarantee: with any of them switched off the regions, their counts and their neighbours are the
same, and the bounds of areas overlap. Names are stable; a result's plan says which savings were
made and which were kept.
"""

from __future__ import annotations

from collections.abc import Iterable

from ptmcad.errors import ConfigError
from ptmcad.text.syntax import did_you_mean

ALL = "all"
"""Stands for every saving."""
GENERAL_SAVING = "imports"
"""The saving that is made on every slice alike: results state it, and what explains a slice leaves
it out.
"""
IMPORTED = ("numpy", "matplotlib.figure", "sympy", "numba")
"""What the saving "imports" leaves out where nothing needs it."""


SAVINGS = {
    "exact": {
        "sign-curve": (
            "projection of H11 = 0",
            "where it vanishes off the critical curves, det H < 0",
        ),
        "hermite-matrix": (
            "determinant of the Hermite matrix",
            "the norm of det H has the same critical factors and no others",
        ),
        "infinity": (
            "curves over which solutions leave every bounded set",
            "near them det H stays away from 0 at every solution, and real ones are bounded",
        ),
        "no-real-points": ("components without a point in the window", "no cell touches them"),
        "axis-order": ("decomposition over the other axis", "regions do not depend on it"),
        "even-powers": (
            "discriminants and resultants of full degree",
            "where only powers of u^k occur they are computed in u^k",
        ),
        "equal-counts": (
            "areas beside walls that separate no regions",
            "what one cell has too much there its neighbour in the region has too little",
        ),
    },
    "certified": {
        "folds-of-saddles": (
            "folds of saddles and maxima",
            "the number of stable equilibria does not change",
        ),
        "cones-and-creases": (
            "points where a spring has no length",
            "no minimum appears or vanishes there without a fold",
        ),
        "dependent-equations": (
            "boxes on which dependent equations do not vanish",
            "they vanish at every equilibrium",
        ),
        "mirror-images": (
            "mirror images of folds, and what is singular on the mirror",
            "an exchange or a reflection of the unknowns leaves the slice as it is",
        ),
    },
    "any": {
        "imports": (
            "imports of numpy, matplotlib, sympy and numba",
            "nothing needs them before it asks",
        ),
    },
}
"""Of each engine, and of both, in the order in which they make them: the name, what is left out, and
the reason for which the answer is the same.
"""
BY_NAME = {name: words for table in SAVINGS.values() for name, words in table.items()}


def switched_off(names: Iterable[str], certified: bool) -> frozenset[str]:
    """The savings to switch off, from the names that a caller gave.

    Parameters
    ----------
    names : of savings, or `ALL`, which stands for all those that the engine has.
    certified : whether the certified engine is going to compute, else the exact one.

    Raises
    ------
    ConfigError
        For a name that no saving has, or one of the other engine's.
    """
    given = (names,) if isinstance(names, str) else sorted(names)
    check_names(given)
    other, engine = ("exact", "certified")[:: 1 if certified else -1]
    own = (*SAVINGS[engine], *SAVINGS["any"])
    for name in given:
        if name != ALL and name not in own:
            raise ConfigError(
                f"{name!r} is a saving of the {other} engine, and this slice is the {engine} engine's, "
                f"which has {', '.join(own)}",
                key="without",
            )
    return frozenset(own if ALL in given else given)


def check_names(names: Iterable[str]) -> None:
    """Refuse what is no saving's name.

    Raises
    ------
    ConfigError
        That lists the names.
    """
    for name in names:
        if name != ALL and name not in BY_NAME:
            raise ConfigError(
                f"{name[:60]!r} is no saving{did_you_mean(name, (*BY_NAME, ALL))}; "
                f"there are {', '.join(BY_NAME)} and {ALL}",
                key="without",
            )


def load_all() -> None:
    """Import what is left out otherwise, as far as it is installed."""
    from importlib import import_module
    from importlib.util import find_spec

    for module in IMPORTED:
        if find_spec(module.partition(".")[0]) is not None:
            import_module(module)
