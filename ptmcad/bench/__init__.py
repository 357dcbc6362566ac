"""Benchmarks: whole processes, timed as a user meets them.

Guarantee: every figure is the wall time, processor time and peak memory of one whole process, start-up included;
competitors are run in turn, one run of each per round, so that a slow minute of the machine hits all of them alike;
and what could not be measured is reported with its reason.

Run it with ``make bench`` or ``python -m ptmcad.bench --help``.
"""
