"""What pytest must not import when it looks for doctests: a module that needs atheris."""

collect_ignore = ["guided.py"]
