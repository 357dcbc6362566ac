"""A model in floating point, and one solution of it followed along a course of parameters."""
