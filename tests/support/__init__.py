"""What many tests rest on: other ways to the same answers, maps, false maps, programs to ask."""
