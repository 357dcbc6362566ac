"""A campaign that coverage guides: atheris (libFuzzer) mutates inputs with the damage of `fuzz.damage`.

``python -m fuzz.guided KIND CASES SEED FOLDER`` ends with exit status 0 when every case was answered as it must be;
libFuzzer stores an input that was not in FOLDER. Its own watchdog stops a case after five seconds, or at 2 GB.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from pathlib import Path
from random import Random

import atheris

# everything of ptmcad that a case reaches must be imported here, or coverage does not see it
with atheris.instrument_imports(include=["ptmcad"]):
    import ptmcad.ask.location
    import ptmcad.exact.exactmap
    import ptmcad.show.table
    import ptmcad.verification  # noqa: F401
    from fuzz import targets
    from fuzz.damage import damaged_bytes, damaged_tokens, damaged_tree
    from fuzz.seeds import records, results

LENGTH = {"record": 5_000, "result": 40_000}
_honest = {"record": records, "result": results}
_fresh = {"record": targets.make_record, "result": targets.make_result}


def mutated(kind: str, data: bytes, most: int, seed: int) -> bytes:
    """The next input: damage to one of the corpus that coverage has found, or a fresh case."""
    rng = Random(seed)
    choice = rng.randrange(10)
    if choice == 0 or not data:
        return _fresh[kind](seed)[:most]
    if choice == 1:
        return bytes(atheris.Mutate(data, most))
    if choice <= 3:
        return damaged_bytes(data, rng, rng.choice(_honest[kind]()))[:most]
    if kind == "result":
        try:
            return damaged_tree(json.loads(data), rng).encode("utf-8", "surrogatepass")[:most]
        except (ValueError, RecursionError):
            pass
    return damaged_tokens(data.decode("utf-8", "replace"), rng).encode("utf-8", "surrogatepass")[
        :most
    ]


def main(kind: str, cases: int, seed: int, folder: Path) -> None:
    """Run the campaign; libFuzzer ends the process."""
    corpus = folder / f"{kind}-corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    for number, data in enumerate(_honest[kind]()):
        (corpus / f"honest-{number}").write_bytes(data)
    outcomes: Counter[str] = Counter()
    slowest = 0.0

    def case(data: bytes) -> None:
        nonlocal slowest
        start = time.perf_counter()
        outcomes[targets.run(kind, data)] += 1
        slowest = max(slowest, time.perf_counter() - start)
        done = sum(outcomes.values())
        if done % 1000 == 0 or done == cases:
            figures = {"cases": done, "outcomes": dict(outcomes), "slowest": round(slowest, 3)}
            (folder / f"{kind}-figures.json").write_text(json.dumps(figures), encoding="utf-8")

    options = [f"-runs={cases}", f"-seed={seed}", "-timeout=5", "-rss_limit_mb=2048", f"-max_len={LENGTH[kind]}",
               f"-artifact_prefix={folder}/{kind}-", "-print_final_stats=1"]  # fmt: skip
    atheris.Setup(
        [sys.argv[0], *options, str(corpus)],
        case,
        custom_mutator=lambda data, most, number: mutated(kind, data, most, number),
    )
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), Path(sys.argv[4]))
