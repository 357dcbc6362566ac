"""A forger of region maps: alterations after which all that follows from the altered claim is
computed anew.

A kind of alteration is a function from a true map to alterations, one for each place where it can
be made; each makes an altered map when it is called. Those of `forger.exact`, `forger.variety` and
`forger.certified` are false, those of `forger.rearrangements` are as true as the map was.

``PYTHONPATH=.. python -m forger`` in the folder tests/verification/ runs a campaign.
"""
