"""The built-in mechanisms as records: that of Wenger & Chablat, two crossed bars, three springs,
one slider.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

from ptmcad.errors import ConfigError
from ptmcad.model.description import Mechanism, Model
from ptmcad.model.mechanismrecord import described

RECORD = {
    "name": "ptm",
    "title": "the planar tensegrity mechanism of Wenger and Chablat",
    "parameters": {
        "L1": {"kind": "length", "default": 1, "range": [0, 4]},
        "L2": {"kind": "length", "default": 1, "range": [0, 4]},
        "rho": {"kind": "base", "default": 1, "range": [0, 4]},
        "k": {"kind": "stiffness", "default": 100, "range": [0, 200], "alias": ["k1", "k2", "k3"]},
        "l0": {"kind": "free length", "default": 0, "range": [0, 1], "alias": ["l0_1", "l0_2", "l0_3"]},
        "F3": {"kind": "force", "range": [-30, 0]},
        "F4": {"kind": "force", "range": [-30, 0]},
        "F3x": {"kind": "force", "range": [-30, 30]},
        "F4x": {"kind": "force", "range": [-30, 30]},
    },
    "unknowns": {"th1": "angle", "th2": "angle"},
    "points": {
        "A1": [0, 0],
        "A2": ["rho", 0],
        "A3": ["L1*cos(th1)", "L1*sin(th1)"],
        "A4": ["rho - L2*cos(th2)", "L2*sin(th2)"],
    },
    "bars": [["A1", "A3"], ["A2", "A4"]],
    "supports": {"A1": "pin", "A2": "slider x"},
    "springs": [
        {"between": ["A1", "A4"], "k": "k1", "free": "l0_1"},
        {"between": ["A2", "A3"], "k": "k2", "free": "l0_2"},
        {"between": ["A3", "A4"], "k": "k3", "free": "l0_3"},
    ],
    "loads": {"A3": ["F3x", "F3"], "A4": ["F4x", "F4"]},
    "symmetries": [
        # seen in a mirror halfway between A1 and A2
        {
            "L1": "L2", "L2": "L1", "k1": "k2", "k2": "k1", "l0_1": "l0_2", "l0_2": "l0_1",
            "F3": "F4", "F4": "F3", "F3x": "-F4x", "F4x": "-F3x", "th1": "th2", "th2": "th1",
        },
        # seen in a mirror along A1A2
        {"F3": "-F3", "F4": "-F4", "th1": "-th1", "th2": "-th2"},
    ],
}  # fmt: skip

MEANINGS = {
    "L1": "Length of the rod A1A3.",
    "L2": "Length of the rod A2A4.",
    "rho": "Distance A1A2 of the two pivots.",
    "k": "Stiffness of the springs, force per length.",
    "k1": "Stiffness of the spring A1A4.",
    "k2": "Stiffness of the spring A2A3.",
    "k3": "Stiffness of the spring A3A4.",
    "F3": "Vertical force at A3, upwards.",
    "F4": "Vertical force at A4, upwards.",
    "F3x": "Horizontal force at A3, to the right.",
    "F4x": "Horizontal force at A4, to the right.",
    "l0": "Free length of the springs.",
    "l0_1": "Free length of A1A4.",
    "l0_2": "Free length of A2A3.",
    "l0_3": "Free length of A3A4.",
}
"""What its parameters are, for people."""


@lru_cache(maxsize=1)
def ptm() -> Mechanism:
    """The paper's mechanism."""
    return described(RECORD, proved=True)


def title_of(spring: Any, model: Model) -> str:
    """Of a spring as it is described, or compiled: the paper's are named by their ends, as in all
    answers.
    """
    return f"{spring.start}{spring.end}" if model == ptm() else spring.name


def mechanism_of(name: str) -> Mechanism:
    """The built-in mechanism of a name.

    Raises
    ------
    KeyError
        When there is none; `ptmcad.question.config` refuses such names before.
    """
    return _BUILT_IN[name]()


def built_in() -> tuple[str, ...]:
    """The names of the mechanisms that `mechanism_of` has."""
    return tuple(_BUILT_IN)


def recognised(found: Mechanism) -> Mechanism:
    """A mechanism that was described, or the built-in one that it is, whether or not its symmetries
    were written down.

    Raises
    ------
    ConfigError
        When it has the name of a built-in one and is another.
    """
    if found.name not in _BUILT_IN:
        return found
    known = _BUILT_IN[found.name]()
    if replace(found, symmetries=known.symmetries) != known:
        raise ConfigError(
            f"'{found.name}' is the name of a built-in mechanism, which is another", key="name"
        )
    return known


def known_of(name: str) -> Mechanism:
    """What is known of a mechanism by its name, as a stored result has it: nothing of one that is
    not built in.
    """
    return _BUILT_IN[name]() if name in _BUILT_IN else Mechanism(name, {}, {}, {}, (), {}, (), ())


_BUILT_IN = {"ptm": ptm}
