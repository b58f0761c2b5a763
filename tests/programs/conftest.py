"""Programs as a person starts them, and the hub that they meet at."""

from running_programs import hub as hub
from running_programs import start as start
