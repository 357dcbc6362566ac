"""Sweeps as tables, as a page and as pictures one after another."""
