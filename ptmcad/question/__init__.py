"""The question: a record or options become a `Slice`; what it may contain is proved, what may be
left out is named.
"""
