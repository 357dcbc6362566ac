"""A result as one HTML page that needs nothing else: no network, no other file.

Guarantee: every number that is shown as text is exact or certified to one unit of its last digit,
and comes from the result; nothing of the result is taken for markup or code. Pictures are drawn in
floating point.
"""

from ptmcad.show.report.reportpage import page

__all__ = ["page"]
