"""Warnings that would come again and again, logged once."""

from __future__ import annotations

import logging
from collections import OrderedDict

from fibws.hub.log.text import printable

logger = logging.getLogger("fibws.hub")

MOST_WARNINGS = 1000
"""Warnings that are remembered."""


class OneTimeWarnings:
    """Logs each text once, unless many others have come since."""

    def __init__(self) -> None:
        self._logged: OrderedDict[str, None] = OrderedDict()

    def __call__(self, text: str) -> None:
        """Log a text without a full stop."""
        if text not in self._logged:
            self._logged[text] = None
            if len(self._logged) > MOST_WARNINGS:
                self._logged.popitem(last=False)
            logger.warning("%s.", printable(text))
