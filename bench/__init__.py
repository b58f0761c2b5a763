"""Measures the hub against a relay in C and a straightforward Python hub, in one run."""
