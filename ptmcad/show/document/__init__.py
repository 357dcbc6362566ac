"""Answers as JSON documents, and back, each by one codec; docs/*.schema.json are their schemas."""
