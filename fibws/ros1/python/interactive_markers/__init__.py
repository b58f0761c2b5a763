"""Markers that people move and click on, in RViz for example."""
