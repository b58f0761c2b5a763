"""The error of genpy's generator; classes are created by `genpy.dynamic`."""

from genpy.errors import MsgGenerationException

__all__ = ["MsgGenerationException"]
