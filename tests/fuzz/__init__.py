"""Fuzzing: damaged and hostile records, options, results and point files, and what the program may answer to them.

``python -m fuzz`` in the folder tests/ runs a campaign; ``make fuzz`` does so with coverage guidance by atheris.
"""
