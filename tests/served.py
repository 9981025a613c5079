"""A directory behind ``http://127.0.0.1``, with range requests or without; remembers what was asked."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from http.server import BaseHTTPRequestHandler, SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path


@dataclass
class Served:
    """Where the directory is, and the GET requests so far: path, and range or None."""

    url: str
    asked: list[tuple[str, tuple[int, int] | None]] = field(default_factory=list)

    def shards(self) -> list[tuple[int, int] | None]:
        return [span for path, span in self.asked if path.endswith(".tar")]


class _Handler(SimpleHTTPRequestHandler):
    served: Served
    ranges = True

    def do_GET(self) -> None:
        wanted = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", "") if self.ranges else "")
        file = Path(self.translate_path(self.path))
        self.served.asked.append((self.path, (int(wanted[1]), int(wanted[2] or 1 << 60)) if wanted else None))
        if not wanted or not file.is_file():
            super().do_GET()
            return
        data = file.read_bytes()
        piece = data[int(wanted[1]) : int(wanted[2] or len(data)) + 1]
        self.send_response(206)
        self.send_header("Content-Range", f"bytes {wanted[1]}-{int(wanted[1]) + len(piece) - 1}/{len(data)}")
        self.send_header("Content-Length", str(len(piece)))
        self.end_headers()
        self.wfile.write(piece)

    def log_message(self, format: str, *arguments: object) -> None:
        """Say nothing."""


@contextmanager
def standing(handler: Callable[..., BaseHTTPRequestHandler]) -> Iterator[str]:
    """Address of a server on loopback that answers by a handler until the block ends."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


@contextmanager
def serve(root: Path, ranges: bool = True) -> Iterator[Served]:
    """Serve a directory until the block ends."""
    served = Served("")
    handler = type("Handler", (_Handler,), {"served": served, "ranges": ranges})
    with standing(partial(handler, directory=str(root))) as served.url:
        yield served
