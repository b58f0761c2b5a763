"""Make pages of files outside docs/ when MkDocs builds the site.

README.md is the home page and CHANGELOG.md the changelog: neither is written twice. Links between
them and the pages in docs/ are those that work on GitHub, and are changed here to the site's.
"""

from __future__ import annotations

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
PAGES = {"README.md": "index.md", "CHANGELOG.md": "changelog.md"}
"""Files of the repository's root, and the pages that they become."""
BADGES = re.compile(r"^\[!\[.*\n", re.MULTILINE)
"""Pictures of other servers, which pages of the site do not load."""
FILES = ["LICENSE"]
"""Files that pages link to."""


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the files of the repository's root to those of the site."""
    for name, page in PAGES.items():
        text = BADGES.sub("", (ROOT / name).read_text("utf-8"))
        files.append(File.generated(config, page, content=links_of_site(text, "")))
    for name in FILES:
        files.append(File.generated(config, name, content=(ROOT / name).read_text("utf-8")))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Change links that leave docs/, and name the terminals of the tutorial's blocks."""
    markdown = re.sub(
        r"^```(console|text) (\d+)$", r'```\1 title="Terminal \2"', markdown, flags=re.MULTILINE
    )
    return links_of_site(markdown, "../")


def links_of_site(markdown: str, root: str) -> str:
    """Return a page with links to the pages of the site.

    Args:
        root: the path from the page's folder to the repository's root, such as ``../``.
    """
    for name, page in PAGES.items():
        markdown = re.sub(rf"\]\({re.escape(root + name)}(?=[#)])", f"]({page}", markdown)
    return markdown.replace("](docs/", "](") if root == "" else markdown
