"""Ranges as tables and documents."""
