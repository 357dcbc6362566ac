"""Benchmarks: whole processes, timed as a user meets them, and the error of what they answer.

``ptmcad bench`` measures error against run time, and ``python -m ptmcad.studies.bench STUDY`` what whole records take,
what each saving is worth, and how cost grows. What could not be measured is reported with its reason.
"""
