"""Runs a script's unit tests: ``rosunit.unitrun(package, name, TestCase)``."""

from __future__ import annotations

from rosunit.report import Report
from rosunit.run import (
    XML_OUTPUT_FLAG,
    XMLTestRunner,
    create_xml_runner,
    print_unittest_summary,
    run,
    unitrun,
)

__all__ = [
    "XML_OUTPUT_FLAG",
    "Report",
    "XMLTestRunner",
    "create_xml_runner",
    "print_unittest_summary",
    "run",
    "unitrun",
]
