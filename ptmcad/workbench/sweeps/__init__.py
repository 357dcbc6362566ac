"""Sweeps: every member of a family classified, by several processes or a cluster, into a folder
that can be resumed.
"""
