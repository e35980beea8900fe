"""The answers of HTTP that the page of a rig needs, each with what browsers are told to keep to."""

from __future__ import annotations

import base64
import hashlib
import re
from http import HTTPStatus

from websockets.datastructures import Headers
from websockets.http11 import Response

#: Of every answer.
_STRICT = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
_NOTHING = "default-src 'none'; frame-ancestors 'none'"


def policy_of(page: str, host: str) -> str:
    """Return what a page may do: run its own script, be styled, and talk to its rig.

    Examples
    --------
    >>> policy_of("<script>a()</script>", "127.0.0.1:8010").split("; ")[1]
    "script-src 'wasm-unsafe-eval' 'sha256-qVpDBgj7bpq5hMAcGp3AOc79J3Y1Z4HvySTwKrWDoy4='"
    """
    scripts = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    hashes = (base64.b64encode(hashlib.sha256(each.encode()).digest()) for each in scripts)
    allowed = " ".join(f"'sha256-{each.decode('ascii')}'" for each in hashes)
    return (
        f"default-src 'none'; script-src 'wasm-unsafe-eval' {allowed}; "
        f"style-src 'unsafe-inline'; img-src data:; connect-src ws://{host}; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


def page_answer(page: str, host: str) -> Response:
    """Return the page."""
    return _answer(HTTPStatus.OK, page, "text/html; charset=utf-8", policy_of(page, host))


def words_answer(status: HTTPStatus, words: str) -> Response:
    """Return some words, why something is not given."""
    return _answer(status, f"{words}\n", "text/plain; charset=utf-8")


def cookie_answer(name: str, token: str) -> Response:
    """Return the way to the page, with a cookie that no script can read."""
    answer = words_answer(HTTPStatus.SEE_OTHER, "The page is at /.")
    answer.headers["Location"] = "/"
    answer.headers["Set-Cookie"] = f"{name}={token}; Path=/; HttpOnly; SameSite=Strict"
    return answer


def _answer(status: HTTPStatus, text: str, kind: str, policy: str = _NOTHING) -> Response:
    body = text.encode()
    headers = Headers(
        {
            "Content-Type": kind,
            "Content-Length": str(len(body)),
            "Connection": "close",
            "Content-Security-Policy": policy,
            **_STRICT,
        }
    )
    return Response(status.value, status.phrase, headers, body)
