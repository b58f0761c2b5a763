"""The built page and its files over HTTP."""

from __future__ import annotations

import gzip
import re
from pathlib import Path

import pytest
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from fibws.hub.http.requests import BUILT, HttpRequests, read_files
from fibws.hub.settings import Settings

INDEX = "<!doctype html><title>ä</title>".encode()
SCRIPT = b"console.log('I heard 8');\n" * 100
FILES = {
    "index.html": INDEX,
    "index.html.gz": gzip.compress(INDEX),
    "roslib.js": b"var ROSLIB = {};",
    "assets/index-Cq7x.js": SCRIPT,
    "assets/index-Cq7x.js.br": b"packed by brotli",
    "assets/index-Cq7x.js.gz": gzip.compress(SCRIPT),
    "assets/icon-B0aa.png": b"\x89PNG" * 100,
    "assets/odd-A1bb.xyz": b"?",
}


def get(path: str, files: dict[str, bytes] = FILES, **headers: str) -> Response:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return respond(requests(files), path, Headers(named))


def requests(files: dict[str, bytes]) -> HttpRequests:
    return HttpRequests(Settings(), files)


def respond(http: HttpRequests, path: str, headers: Headers) -> Response:
    response = http.respond(Request(path, headers))
    assert response is not None
    return response


def directives(response: Response) -> dict[str, str]:
    policy = response.headers["Content-Security-Policy"]
    return dict(directive.split(" ", 1) for directive in policy.split("; "))


def test_page_and_files_are_served_at_their_paths() -> None:
    assert get("/").body == INDEX
    assert get("/assets/index-Cq7x.js").body == SCRIPT


@pytest.mark.parametrize(
    "path",
    [
        "/index.html",
        "",
        "//",
        "/assets",
        "/assets/",
        "/assets/../index.html",
        "/../pages.py",
        "/roslib.js/",
        "/ROSLIB.js",
        "/%72oslib.js",
    ],
)
def test_unknown_paths_are_404(path: str) -> None:
    assert get(path).status_code == 404


@pytest.mark.parametrize(
    ("path", "content_type"),
    [
        ("/", "text/html; charset=utf-8"),
        ("/roslib.js", "text/javascript; charset=utf-8"),
        ("/assets/icon-B0aa.png", "image/png"),
        ("/assets/odd-A1bb.xyz", "application/octet-stream"),
    ],
)
def test_files_have_their_content_type(path: str, content_type: str) -> None:
    assert get(path).headers["Content-Type"] == content_type


@pytest.mark.parametrize(
    ("path", "kept"),
    [
        ("/", "no-cache"),
        ("/roslib.js", "no-cache"),
        ("/assets/index-Cq7x.js", "public, max-age=31536000, immutable"),
    ],
)
def test_only_files_with_a_digest_in_their_name_are_cached_for_ever(path: str, kept: str) -> None:
    assert get(path).headers["Cache-Control"] == kept


@pytest.mark.parametrize(
    "accepted",
    ["gzip", "gzip, deflate", "GZIP;q=0.5", "gzip;q=0.05", "br;q=0, gzip;q=1.0"],
)
def test_gzip_is_sent_if_accepted(accepted: str) -> None:
    response = get("/assets/index-Cq7x.js", Accept_Encoding=accepted)
    assert response.headers["Content-Encoding"] == "gzip"
    assert response.headers["Content-Length"] == str(len(response.body))
    assert len(response.body) < len(SCRIPT)
    assert gzip.decompress(response.body) == SCRIPT


@pytest.mark.parametrize(
    "accepted",
    ["", "*", "gzip;q=0", "gzip; q=0.000", "gzip ;\tQ = 0.0", "gzip;q=0, br;q=0", "x-gzip-like"],
)
def test_file_is_sent_uncompressed_unless_a_coding_is_accepted(accepted: str) -> None:
    response = get("/assets/index-Cq7x.js", Accept_Encoding=accepted)
    assert "Content-Encoding" not in response.headers
    assert response.body == SCRIPT


@pytest.mark.parametrize("accepted", ["br", "gzip, deflate, br", "gzip, BR;q=0.1"])
def test_brotli_is_sent_if_accepted(accepted: str) -> None:
    response = get("/assets/index-Cq7x.js", Accept_Encoding=accepted)
    assert response.headers["Content-Encoding"] == "br"
    assert response.headers["Content-Type"] == "text/javascript; charset=utf-8"
    assert response.body == b"packed by brotli"


def test_file_that_the_build_has_not_packed_is_sent_as_it_is() -> None:
    response = get("/assets/icon-B0aa.png", Accept_Encoding="gzip, br")
    assert "Content-Encoding" not in response.headers
    assert get("/", Accept_Encoding="br").body == INDEX


@pytest.mark.parametrize("suffix", [".br", ".gz"])
def test_packed_files_have_no_addresses(suffix: str) -> None:
    assert get(f"/assets/index-Cq7x.js{suffix}").status_code == 404


@pytest.mark.parametrize("path", ["/", "/assets/index-Cq7x.js"])
def test_responses_vary_by_accept_encoding(path: str) -> None:
    assert get(path).headers["Vary"] == "Accept-Encoding"


@pytest.mark.parametrize("known", ["{}", '"x", {}', '"x",{}', "*"])
def test_cached_file_is_not_sent_again(known: str) -> None:
    whole = get("/")
    again = get("/", If_None_Match=known.format(whole.headers["ETag"]))
    assert (again.status_code, again.body) == (304, b"")
    assert again.headers["ETag"] == whole.headers["ETag"]
    assert again.headers["Content-Security-Policy"] == whole.headers["Content-Security-Policy"]
    assert "Content-Type" not in again.headers
    assert "Content-Length" not in again.headers


def test_file_that_has_changed_is_sent() -> None:
    old = get("/").headers["ETag"]
    new = get("/", FILES | {"index.html": b"new"}, If_None_Match=old)
    assert (new.status_code, new.body) == (200, b"new")
    assert new.headers["ETag"] != old


def test_headers_may_be_repeated() -> None:
    headers = Headers({"Accept-Encoding": "br", "If-None-Match": '"x"'})
    headers["Accept-Encoding"] = "gzip"
    headers["If-None-Match"] = '"y"'
    response = respond(requests(FILES), "/", headers)
    assert response.headers["Content-Encoding"] == "gzip"


@pytest.mark.parametrize("files", [FILES, {}], ids=["built", "not built"])
def test_content_security_policy_loads_only_the_hubs_own_files(
    files: dict[str, bytes],
) -> None:
    assert directives(get("/", files)) == {
        "default-src": "'none'",
        "script-src": "'self'",
        "style-src": "'self'",
        "img-src": "'self' data:",
        "connect-src": "'self' ws: wss: http: https:",
        "worker-src": "'self'",
        "base-uri": "'none'",
        "form-action": "'none'",
        "frame-ancestors": "'none'",
        "require-trusted-types-for": "'script'",
        "trusted-types": "fibws",
    }


def test_page_sends_no_referrer() -> None:
    assert get("/").headers["Referrer-Policy"] == "no-referrer"


def test_only_roslib_may_be_loaded_by_other_origins() -> None:
    theirs = {"Access-Control-Allow-Origin": "*", "Cross-Origin-Resource-Policy": "cross-origin"}
    assert theirs.items() <= dict(get("/roslib.js").headers.raw_items()).items()
    for path in ("/", "/assets/index-Cq7x.js"):
        assert not theirs.keys() & dict(get(path).headers.raw_items()).keys()


class TestNotBuilt:
    def test_root_explains_how_to_build_the_page(self) -> None:
        response = get("/", {})
        assert response.status_code == 503
        assert response.headers["Content-Type"] == "text/html; charset=utf-8"
        assert response.headers["Cache-Control"] == "no-store"
        assert b"<pre>python -m pip install -e .</pre>" in response.body

    def test_other_paths_are_404(self) -> None:
        assert get("/roslib.js", {}).status_code == 404


class TestReading:
    def test_files_are_found_in_all_folders(self, tmp_path: Path) -> None:
        (tmp_path / "assets" / "fonts").mkdir(parents=True)
        (tmp_path / "index.html").write_bytes(b"1")
        (tmp_path / "assets" / "index.js").write_bytes(b"2")
        (tmp_path / "assets" / "fonts" / "a.woff2").write_bytes(b"3")
        assert read_files(tmp_path) == {
            "index.html": b"1",
            "assets/index.js": b"2",
            "assets/fonts/a.woff2": b"3",
        }

    def test_hidden_files_are_left_out(self, tmp_path: Path) -> None:
        (tmp_path / ".sources.sha256").touch()
        assert read_files(tmp_path) == {}

    def test_checkout_without_a_build_has_no_files(self, tmp_path: Path) -> None:
        assert read_files(tmp_path / "dist") == {}


def test_built_page_has_all_files_that_it_loads() -> None:
    files = read_files(BUILT)
    if not files:
        pytest.skip("the page is not built: python -m pip install -e .")
    http = requests(files)
    index = files["index.html"].decode()
    loaded = re.findall(r'(?:src|href)="\./([^"]+)"', index)
    assert len(loaded) >= 2
    for path in ("roslib.js", *loaded):
        assert respond(http, f"/{path}", Headers()).status_code == 200
    assert files["roslib.js"].startswith(b"var ROSLIB=")
