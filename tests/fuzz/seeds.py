"""The honest inputs that the fuzzer starts from: shipped records, and results of slices that verify
within moments.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import ptmcad
from ptmcad.question.config import slice_from_options
from ptmcad.question.slice import Slice

CONFIGS = Path(__file__).resolve().parents[2] / "configs"


@cache
def records() -> tuple[bytes, ...]:
    """The shipped records."""
    return tuple(path.read_bytes() for path in sorted(CONFIGS.glob("*.yaml")))


def slices() -> dict[str, Slice]:
    """Slices whose results are cheap to verify: two of the paper's, and one for each shape a result
    can have.
    """
    options = slice_from_options
    return {
        "fig2": options(CONFIGS / "fig2.yaml"),
        "fig3": options(CONFIGS / "fig3.yaml", count="index"),
        "one cell": options(
            slice="rho,F", ranges=["F=-1:1", "rho=1:2"], sets=["F3=F", "F4=F"], count="total"
        ),
        "one line": options(slice="L2,rho", ranges=["L2=1:2", "rho=0:1/2"]),
        "crossing": options(slice="L2,rho", ranges=["L2=1/2:3/2", "rho=3/4:5/4"]),
        "cusp": options(
            slice="rho,F", ranges=["F=-1:1", "rho=0.999:1.001"], sets=["F3=F", "F4=F", "L2=1"]
        ),
    }


@cache
def results() -> tuple[bytes, ...]:
    """The results of these slices as JSON, without their timings so that they are the same
    everywhere.
    """
    return tuple(
        ptmcad.classify(slice).to_json(timings=False).encode() for slice in slices().values()
    )
