"""Coordinate frames: transforms between them, and what is known of them over time, as in tf2."""
