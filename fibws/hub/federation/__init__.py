"""Several hubs with one graph: remote nodes attach to it through backplanes."""
