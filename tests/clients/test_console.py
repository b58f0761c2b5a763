"""A page's mistakes are in the console of its browser."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

from .casts import ROSLIB_1, ROSLIB_2, Cast, marked
from .conftest import Observe

ROOT = Path(__file__).parents[2]
WEB_PAGE = ROOT / "docs" / "web.md"
LISTENER = 'ros.on("status", (status) => console.error(JSON.stringify(status)));'
"""The line by which a page with npm's roslib shows its statuses."""

CASTS = (
    Cast("/roslib.js", "Chromium", ("mistakes",)),
    Cast("/roslib.mjs", "Chromium", ("mistakes",)),
    Cast(ROSLIB_1, "Chromium", ("mistakes_with_listener",)),
    Cast(ROSLIB_2, "Chromium", ("mistakes_with_listener",)),
)

MISTAKES = (
    ("publish", "does not have a field dta", "did you mean data?"),
    ("publish", "requires a string for field data"),
    ("publish", "Expected a JSON object"),
    ("advertise", "/chatter with type std_msgs/Int32", "std_msgs/String"),
    ("/chatter has type std_msgs/String", "no messages pass from or to type std_msgs/Int32"),
    ("std_msg/String", "did you mean std_msgs/String?"),
    ("advertise", "Sting", "did you mean std_msgs/String?"),
    ("advertise", "'/a name' is not a legal name"),
    ("subscribe", "throttle_rate", "fast"),
    ("advertise_service", "Emty", "did you mean std_srvs/Empty?"),
    ("Service /rosapi/get_parm does not exist",),
    ("does not have a field nam", "did you mean name?"),
)
"""The facts in the console's line about each mistake."""


@pytest.mark.parametrize("cast", [marked(cast, id=str(cast)) for cast in CASTS])
def test_mistakes_of_a_page_are_in_its_console(cast: Cast, observe: Observe) -> None:
    observations = observe(cast)
    assert observations.of("mistakes") is None
    console = observations.complaints
    untold = [
        facts
        for facts in MISTAKES
        if not any(all(fact in line for fact in facts) for line in console)
    ]
    assert untold == [], console


@pytest.mark.npm
@pytest.mark.long
def test_lines_of_the_documentation_have_types(tmp_path: Path) -> None:
    """Pages in TypeScript may use them as they are."""
    compiler = ROOT / "web" / "node_modules" / ".bin" / "tsc"
    roslib = ROOT / "web" / "node_modules" / "roslib"
    if not (compiler.exists() and roslib.exists()):
        pytest.skip("needs npm --prefix web ci")
    lines = "\n".join(
        block
        for page in (WEB_PAGE, WEB_PAGE.with_name("recipes.md"))
        for block in re.findall(r"```js\n(ros\.on.*?)```", page.read_text(), re.DOTALL)
    )
    assert lines.count("ros.on(") >= 4
    head = 'import { Ros } from "roslib";\nconst url = "";\nconst ros = new Ros({ url });\n'
    (tmp_path / "page.ts").write_text(head + lines)
    options = {
        "strict": True,
        "noEmit": True,
        "target": "es2022",
        "lib": ["es2022", "dom"],
        "module": "esnext",
        "moduleResolution": "bundler",
        "skipLibCheck": True,
        "types": [],
        "paths": {"roslib": [str(roslib)]},
    }
    settings = {"compilerOptions": options, "files": ["page.ts"]}
    (tmp_path / "tsconfig.json").write_text(json.dumps(settings))
    done = subprocess.run([compiler, "-p", tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_line_for_roslib_from_npm_is_documented() -> None:
    assert LISTENER in WEB_PAGE.read_text()
    scenario = Path(__file__).parent / "scenarios" / "mistakes_with_listener.mjs"
    assert LISTENER in scenario.read_text()
