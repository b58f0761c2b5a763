"""How nodes that are no clients of this hub join its graph: the parts that all bridges share."""
