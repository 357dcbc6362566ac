"""What the commands ``python -m ptmcad.studies.bench...`` have in common: options, files, bad input."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ptmcad.errors import PtmcadError

NO_RECORDS = "no configs/*.yaml here: name the problem records, or change to the project's folder"


class Command(argparse.ArgumentParser):
    """A parser with the options --out, and --rounds and --seed where runs take turns."""

    def __init__(self, name: str, description: str, *, files: str, rounds: int = 0, epilog: str | None = None) -> None:
        super().__init__(prog=f"python -m ptmcad.studies.{name}", description=description, epilog=epilog)
        self.add_argument("--out", type=Path, help=f"folder for {files}; default: print only")
        if rounds:
            self.add_argument("--rounds", type=int, default=rounds, help=f"runs of each job (default {rounds})")
            self.add_argument("--seed", type=int, default=1, help="of all that is drawn (default 1)")

    def chosen(self, arguments: Sequence[str] | None) -> argparse.Namespace:
        """The options, --rounds being positive."""
        found = self.parse_args(arguments)
        if getattr(found, "rounds", 1) < 1:
            self.error("--rounds must be at least 1")
        return found

    def status(self, work: Callable[[], int]) -> int:
        """The exit status of the work; 2, with a message, for bad input."""
        try:
            return work()
        except (PtmcadError, OSError) as error:
            print(f"{self.prog}: {error}", file=sys.stderr)
            return 2


def progress(message: str) -> None:
    """What is being done, on standard error."""
    print(message, file=sys.stderr, flush=True)


def save(folder: Path | None, name: str, document: dict[str, Any] | str, page: str = "") -> None:
    """Write NAME.json, and NAME.md when there is a page, into a folder if one is given."""
    if folder is None:
        return
    folder.mkdir(parents=True, exist_ok=True)
    text = document if isinstance(document, str) else json.dumps(document, indent=1, ensure_ascii=False) + "\n"
    (folder / f"{name}.json").write_text(text, encoding="utf-8")
    if page:
        (folder / f"{name}.md").write_text(page, encoding="utf-8")
