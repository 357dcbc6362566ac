"""The shipped problem records, by the engine that answers them."""

from __future__ import annotations

from pathlib import Path

import yaml

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
_ALL = tuple(sorted(CONFIGS.glob("*.yaml")))
_OTHER = tuple(path for path in sorted(CONFIGS.glob("*/*.yaml")) if path.parent.name != "families")
OTHER_FREE = tuple(path for path in _OTHER if "free:" in path.read_text(encoding="utf-8"))
"""Records of slices of other mechanisms whose springs have free lengths, for the certified engine.
"""
OTHER = tuple(path for path in _OTHER if path not in OTHER_FREE)
"""Those of other mechanisms and systems that the exact one answers."""
LINES_ONLY = {"five-bar", "three-bar-chain", "two-dof-tensegrity-loaded", "two-x-joints"}
"""Those of them that are too large for an exact map."""


def _has_free_lengths(path: Path) -> bool:
    record = yaml.safe_load(path.read_text(encoding="utf-8"))
    return any(name.startswith("l0") for name in (*record["parameters"], *record["axes"]))


FREE = tuple(path for path in _ALL if _has_free_lengths(path))
"""Records with free lengths, for the certified engine."""
EXACT = tuple(path for path in _ALL if path not in FREE)
