"""Tokens that clients read, and that no hub would accept."""

from __future__ import annotations

import json
import time
from base64 import urlsafe_b64encode


def unsigned(name: str, seconds: float) -> str:
    """Return a token that expires in some seconds."""
    claims = json.dumps({"sub": name, "exp": time.time() + seconds}).encode()
    return f"e30.{urlsafe_b64encode(claims).decode().rstrip('=')}.e30"
