"""Questions with one axis: what counts along a line of a slice, where they change, and which
solutions go on.

An engine gives the critical values of a line, exact or enclosed, the counts between them, and all
solutions at a value. Read `along` first, then `diagram` and `follower`; `meeting`, `mirror` and
`landing` say what holds where a path ends.
"""
