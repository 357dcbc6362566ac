"""``python -m ptmcad`` is the command line."""

from ptmcad.cli import main

if __name__ == "__main__":
    main()
