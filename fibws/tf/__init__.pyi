from .buffer import Buffer as Buffer
from .listener import TransformListener as TransformListener
from .transform import Transform as Transform
