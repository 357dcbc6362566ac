"""The process that computes and the one that watches it: memory, signals, and files that appear
whole or not at all.
"""
