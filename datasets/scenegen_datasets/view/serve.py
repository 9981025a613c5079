"""Serve the page on this machine, to this machine."""

from __future__ import annotations

import socket
from collections.abc import Callable
from pathlib import Path

from scenegen.foundation.errors import InputError

LOOPBACK = "127.0.0.1"


def serve(root: Path, *, port: int = 0, show: bool = True, ready: Callable[[str], None]) -> None:
    """Show a dataset until interrupted.

    Parameters
    ----------
    root : Path
        Directory of the dataset, finished or growing.
    port : int
        0 takes one that is free.
    show : bool
        Open a browser.
    ready : callable
        Called with the page's address before it is served.

    Raises
    ------
    InputError
        If there is no dataset, the port is taken, or the library behind the page is not installed.

    Notes
    -----
    Binds to the loopback address alone, and answers only to its names: another site open in the same browser cannot
    reach it under a name of its own (DNS rebinding).
    """
    from scenegen_datasets.view.gallery import Gallery
    from scenegen_datasets.view.library import Library

    gallery = Gallery(Library(root))
    try:
        from scenegen_datasets.view import site
    except ImportError as error:
        if (error.name or "").startswith("scenegen"):
            raise
        raise InputError("the viewer needs NiceGUI: pip install 'thermal-scenegen[view]'") from None
    port = _free_port(port)
    ready(f"http://{LOOPBACK}:{port}/")
    site.run(gallery, LOOPBACK, port, show=show)


def _free_port(port: int) -> int:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((LOOPBACK, port))
        except (OSError, OverflowError) as error:
            raise InputError(
                f"port {port}: {error}; choose another with --port, or 0 for a free one"
            ) from None
        return int(probe.getsockname()[1])
