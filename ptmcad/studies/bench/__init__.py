"""Benchmarks: whole processes, timed as a user meets them, and the error of what they answer.

Guarantee: times and memory are those of whole processes, start-up included; competitors take turns within a round, so
that a slow minute of the machine hits all of them alike; errors are bounded and not sampled
(`ptmcad.studies.bench.error`); and what could not be measured is reported with its reason.

``ptmcad bench`` measures error against run time, and ``python -m ptmcad.studies.bench STUDY`` what whole records take,
what each saving is worth, and how cost grows.
"""
