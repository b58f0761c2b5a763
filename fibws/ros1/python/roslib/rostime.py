"""Former module of genpy's times."""

from genpy.rostime import Duration, Time, TVal

__all__ = ["Duration", "TVal", "Time"]
