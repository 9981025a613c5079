"""WebDataset: decode the members of our shards exactly, where its own decoders make 8-bit colour of every image.

>>> import webdataset
>>> pairs = webdataset.WebDataset(urls, shardshuffle=False).decode(decoder)  # doctest: +SKIP
>>> layers = pairs.map(unpacked)  # doctest: +SKIP

Needs no library but our own; shards that Hugging Face streams as bytes decode the same way.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scenegen.foundation import canonical
from scenegen_datasets.declared import declared
from scenegen_datasets.layers import LAYERS, MEMBERS
from scenegen_datasets.pixels import decode_member

_JSON = "json"


def decoder(extension: str, data: bytes) -> Any:
    """Decode one member.

    Parameters
    ----------
    extension : str
        Suffix of the member, with or without a dot before it: ``.thermal.png``.
    data : bytes

    Returns
    -------
    dict of str to array, mapping, or None
        Layer name to array; the content of ``json``; None for what is no member of ours, so that other decoders get
        their turn.

    Raises
    ------
    CorruptFrameError
        If the bytes are not what a dataset of ours holds.
    DatasetError
        If the JSON is none.
    """
    suffix = extension.lstrip(".")
    if suffix not in MEMBERS:
        return None
    if suffix == _JSON:
        return canonical.parse(data, suffix, max_bytes=1 << 20)
    shape, channels = declared(suffix, data)
    layers = tuple(
        layer
        for layer in LAYERS.values()
        if layer.member == suffix and (channels is None or set(layer.channels) <= channels)
    )
    return decode_member(suffix, layers, data, shape)


def unpacked(sample: Mapping[str, Any]) -> dict[str, Any]:
    """Make of a decoded sample of WebDataset one like those of `PairDataset`: layers by name, ``key``, and the JSON."""
    found: dict[str, Any] = {"key": sample["__key__"]}
    for suffix, value in sample.items():
        if suffix in MEMBERS:
            found |= value
    return found
