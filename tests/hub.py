"""A Hub behind ``http://127.0.0.1``: dataset repositories, as far as `huggingface_hub` asks for them over HTTP.

Written from what its client sends and reads: repositories and branches, trees, commits as lines of JSON, large files
by git LFS, and downloads by range. Large files by Xet are not part of it (``HF_HUB_DISABLE_XET=1``).
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler
from typing import Any
from urllib.parse import parse_qs, unquote, urlsplit

from served import standing

TOKEN = "hf_of_the_tests"
_LARGE = (".tar", ".npy")


@dataclass
class Repository:
    """Branches with their files, and the commits that made them: message, and paths with a minus for what went."""

    private: bool
    branches: dict[str, dict[str, bytes]] = field(default_factory=lambda: {"main": {".gitattributes": b""}})
    commits: list[tuple[str, list[str]]] = field(default_factory=list)

    def sha(self, revision: str) -> str:
        """A commit id: changes with the content."""
        told = sorted((path, hashlib.sha1(data).hexdigest()) for path, data in self.files(revision).items())
        return hashlib.sha1(json.dumps(told).encode()).hexdigest()

    def files(self, revision: str) -> dict[str, bytes]:
        """Files of a branch, or of the commit a branch stands at."""
        if revision in self.branches:
            return self.branches[revision]
        return next(files for name, files in self.branches.items() if self.sha(name) == revision)


@dataclass
class Hub:
    """What is there, and where; `refuses` names the requests that are answered with an error."""

    url: str = ""
    repositories: dict[str, Repository] = field(default_factory=dict)
    blobs: dict[str, bytes] = field(default_factory=dict)
    refuses: Callable[[str, str], bool] = lambda method, path: False


def entry(path: str, data: bytes) -> dict[str, Any]:
    """A file as trees list it."""
    told: dict[str, Any] = {"type": "file", "path": path, "size": len(data)}
    told["oid"] = hashlib.sha1(b"blob %d\0" % len(data) + data).hexdigest()
    if path.endswith(_LARGE):
        told["lfs"] = {"oid": hashlib.sha256(data).hexdigest(), "size": len(data), "pointerSize": 130}
        told["oid"] = hashlib.sha1(path.encode()).hexdigest()  # of the pointer
    return told


class _Handler(BaseHTTPRequestHandler):
    hub: Hub
    protocol_version = "HTTP/1.1"

    def log_message(self, format: str, *arguments: object) -> None:
        """Say nothing."""

    def do_GET(self) -> None:
        self._route("GET")

    def do_HEAD(self) -> None:
        self._route("HEAD")

    def do_POST(self) -> None:
        self._route("POST")

    def do_PUT(self) -> None:
        self._route("PUT")

    def _route(self, method: str) -> None:
        path = unquote(urlsplit(self.path).path)
        self.body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        if self.hub.refuses(method, path):
            return self._say({"error": "the line is cut"}, 500)
        changes = method == "POST" and "/paths-info/" not in path
        if changes and self.headers.get("Authorization") != f"Bearer {TOKEN}":
            return self._say({"error": "Invalid username or password."}, 401)
        for pattern, answer in _ROUTES:
            match = re.fullmatch(pattern, path)
            if match:
                return answer(self, *match.groups())
        return self._say({"error": f"no such page: {path}"}, 404)

    def _say(self, content: Any, status: int = 200, **headers: str) -> None:
        self._send(json.dumps(content).encode(), status, {"Content-Type": "application/json", **headers})

    def _send(self, data: bytes, status: int, headers: dict[str, str]) -> None:
        self.send_response(status)
        for name, value in {"Content-Length": str(len(data)), **headers}.items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(data)

    def create(self) -> None:
        told = json.loads(self.body)
        name = "/".join(filter(None, (told.get("organization", "somebody"), told["name"])))
        known = name in self.hub.repositories
        if not known:
            self.hub.repositories[name] = Repository(
                told.get("visibility") == "private" or bool(told.get("private"))
            )
        self._say({"url": f"{self.hub.url}/datasets/{name}", "name": name}, 409 if known else 200)

    def branch(self, name: str, branch: str) -> None:
        branches = self.hub.repositories[name].branches
        known = branch in branches
        branches.setdefault(branch, dict(branches["main"]))
        self._say({}, 409 if known else 200)

    def about(self, name: str, revision: str | None) -> None:
        repository = self.hub.repositories.get(name)
        if repository is None:
            return self._say({"error": "Repository not found"}, 404, **{"X-Error-Code": "RepoNotFound"})
        sha = repository.sha(revision or "main")
        names = [{"rfilename": path} for path in sorted(repository.files(sha))]
        return self._say(
            {"id": name, "sha": sha, "private": repository.private, "siblings": names, "tags": []}
        )

    def tree(self, name: str, revision: str, below: str | None) -> None:
        files = self.hub.repositories[name].files(revision)
        folder = below.strip("/") + "/" if below and below.strip("/") else ""
        inside = {path: data for path, data in files.items() if path.startswith(folder)}
        deep = parse_qs(urlsplit(self.path).query).get("recursive", ["False"])[0].lower() in ("true", "1")
        folders = {p[: k.start()] for p in inside for k in re.finditer("/", p) if k.start() > len(folder)}
        told: list[dict[str, Any]]
        told = [{"type": "directory", "path": p, "oid": "0" * 40, "size": 0} for p in sorted(folders)]
        told += [entry(path, data) for path, data in sorted(inside.items())]
        self._say([one for one in told if deep or "/" not in one["path"][len(folder) :]])

    def paths(self, name: str, revision: str) -> None:
        files = self.hub.repositories[name].files(revision)
        is_json = self.headers.get("Content-Type", "").startswith("application/json")
        asked = json.loads(self.body)["paths"] if is_json else parse_qs(self.body.decode()).get("paths", [])
        found: list[dict[str, Any]] = [entry(path, files[path]) for path in asked if path in files]
        for path in asked:
            if any(known.startswith(f"{path}/") for known in files):
                found.append({"type": "directory", "path": path, "oid": "0" * 40, "size": 0})
        self._say(found)

    def preupload(self, name: str, revision: str) -> None:
        told = [
            {
                "path": file["path"],
                "uploadMode": "lfs" if file["path"].endswith(_LARGE) else "regular",
                "shouldIgnore": False,
            }
            for file in json.loads(self.body)["files"]
        ]
        self._say({"files": told})

    def lfs_batch(self, name: str) -> None:
        objects = json.loads(self.body)["objects"]
        for one in objects:
            if one["oid"] not in self.hub.blobs:
                one["actions"] = {"upload": {"href": f"{self.hub.url}/lfs/{one['oid']}"}}
        self._say({"transfer": "basic", "objects": objects})

    def lfs(self, oid: str) -> None:
        right = hashlib.sha256(self.body).hexdigest() == oid
        if right:
            self.hub.blobs[oid] = self.body
        self._say({}, 200 if right else 422)

    def commit(self, name: str, revision: str) -> None:
        repository = self.hub.repositories[name]
        files, said, names = dict(repository.files(revision)), "", []
        for key, value in ((line["key"], line["value"]) for line in map(json.loads, self.body.splitlines())):
            if key == "header":
                said = value["summary"]
                continue
            names.append(("-" if key == "deletedFile" else "") + value["path"])
            if key == "deletedFile":
                del files[value["path"]]
            elif key == "lfsFile":
                files[value["path"]] = self.hub.blobs[value["oid"]]
            else:
                files[value["path"]] = base64.b64decode(value["content"])
        repository.branches[revision] = files
        repository.commits.append((said, names))
        url = f"{self.hub.url}/datasets/{name}/commit/{repository.sha(revision)}"
        self._say({"success": True, "commitOid": repository.sha(revision), "commitUrl": url})

    def resolve(self, name: str, revision: str, path: str) -> None:
        repository = self.hub.repositories.get(name)
        if repository is None or path not in repository.files(revision):
            code = "EntryNotFound" if repository else "RepoNotFound"
            return self._say({"error": code}, 404, **{"X-Error-Code": code})
        data = repository.files(revision)[path]
        told = entry(path, data)
        headers = {"X-Repo-Commit": repository.sha(revision), "ETag": f'"{told.get("lfs", told)["oid"]}"'}
        wanted = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        if wanted is None:
            return self._send(data, 200, {**headers, "Accept-Ranges": "bytes"})
        start, end = int(wanted[1]), min(int(wanted[2] or len(data)), len(data) - 1)
        if start >= len(data):
            return self._say({}, 416)
        span = {"Content-Range": f"bytes {start}-{end}/{len(data)}"}
        return self._send(data[start : end + 1], 206, {**headers, **span})


_NAME = r"([\w.-]+/[\w.-]+)"
_ROUTES: tuple[tuple[str, Callable[..., None]], ...] = (
    ("/api/repos/create", _Handler.create),
    ("/api/validate-yaml", lambda handler: handler._say({"errors": [], "warnings": []})),
    (f"/api/datasets/{_NAME}/branch/(.+)", _Handler.branch),
    (f"/api/datasets/{_NAME}/tree/([^/]+)(/.*)?", _Handler.tree),
    (f"/api/datasets/{_NAME}/paths-info/([^/]+)", _Handler.paths),
    (f"/api/datasets/{_NAME}/preupload/([^/]+)", _Handler.preupload),
    (f"/api/datasets/{_NAME}/commit/([^/]+)", _Handler.commit),
    (f"/api/datasets/{_NAME}(?:/revision/([^/]+))?", _Handler.about),
    (rf"/datasets/{_NAME}\.git/info/lfs/objects/batch", _Handler.lfs_batch),
    ("/lfs/([0-9a-f]{64})", _Handler.lfs),
    (f"/datasets/{_NAME}/resolve/([^/]+)/(.+)", _Handler.resolve),
)


@contextmanager
def serve_hub() -> Iterator[Hub]:
    """Serve an empty Hub until the block ends."""
    hub = Hub()
    with standing(type("Handler", (_Handler,), {"hub": hub})) as hub.url:
        yield hub
