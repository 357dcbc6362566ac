"""``python -m ptmcad.studies.bench``: run the benchmark, write JSON and Markdown."""

import sys

from ptmcad.studies.bench.suite import main

if __name__ == "__main__":
    sys.exit(main())
