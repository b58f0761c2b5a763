"""The older name of `parameter_generator_catkin`."""

from dynamic_reconfigure.parameter_generator_catkin import *  # noqa: F403
