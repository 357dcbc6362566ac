"""A campaign: ``PYTHONPATH=.. python -m forger [--places N] [--kinds NAME,...] MAP...`` in
tests/verification/.

A map is the name of a shipped slice, with savings to switch off after a plus sign
(``fig2+sign-curve``), or the number of a random one (``17``). The figures follow as text.
"""

from __future__ import annotations

import argparse
import time

from forger import rearrangements
from forger.judge import FALSE, Tally, judge
from forger.maps import named


def main() -> None:
    """Run the campaign that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("maps", nargs="+")
    parser.add_argument("--places", type=int, help="of each kind, at random; all when not given")
    parser.add_argument("--kinds", default="", help="only these, parted by commas")
    options = parser.parse_args()
    false, true = Tally(), Tally()
    asked = set(options.kinds.split(",")) - {""}
    for name in options.maps:
        start = time.perf_counter()
        r = named(name)
        for kinds, wrong, tally in (
            (FALSE, True, false),
            (rearrangements.KINDS, False, true),
        ):
            chosen = [kind for kind in kinds if not asked or kind.__name__ in asked]
            judge(
                name, r, chosen, wrong, options.places, tally, lambda text: print(text, flush=True)
            )
        print(f"{name}: {len(r.cells)} cells, {time.perf_counter() - start:.0f} s", flush=True)
    for what, tally in (("false", false), ("true", true)):
        print(f"{what}: {len(tally.tried)} kinds, {sum(tally.places.values())} places, {sum(tally.tried.values())} "
              f"tried, {len(tally.wrong)} judged wrongly")  # fmt: skip
        for label in tally.places:
            print(f"  {label}: {tally.places[label]} places, {tally.tried.get(label, 0)} tried")
    for key in sorted(false.by):
        print(f"  {key}: {false.by[key]}")


if __name__ == "__main__":
    main()
