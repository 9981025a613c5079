"""``croissant.json``: the dataset in MLCommons' Croissant 1.0 (JSON-LD), for search engines and catalogue tools."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from scenegen_datasets.licence import licence_of, licence_url

_CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "citeAs": "cr:citeAs",
    "column": "cr:column",
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "equivalentProperty": "cr:equivalentProperty",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "extract": "cr:extract",
    "field": "cr:field",
    "fileObject": "cr:fileObject",
    "fileProperty": "cr:fileProperty",
    "fileSet": "cr:fileSet",
    "format": "cr:format",
    "includes": "cr:includes",
    "isLiveDataset": "cr:isLiveDataset",
    "jsonPath": "cr:jsonPath",
    "key": "cr:key",
    "md5": "cr:md5",
    "parentField": "cr:parentField",
    "path": "cr:path",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "recordSet": "cr:recordSet",
    "references": "cr:references",
    "regex": "cr:regex",
    "repeated": "cr:repeated",
    "replace": "cr:replace",
    "samplingRate": "cr:samplingRate",
    "sc": "https://schema.org/",
    "separator": "cr:separator",
    "source": "cr:source",
    "subField": "cr:subField",
    "transform": "cr:transform",
}

_FORMATS = {
    "png": "image/png",
    "tiff": "image/tiff",
    "exr": "image/x-exr",
    "npy": "application/x-npy",
    "json": "application/json",
}
_IMAGES = ("png", "tiff")


def croissant(description: Mapping[str, Any], sums: Mapping[str, str]) -> dict[str, Any]:
    """Describe a dataset from its ``dataset.json`` and the SHA-256 of its files.

    Parameters
    ----------
    description : mapping
        Content of ``dataset.json``.
    sums : mapping of str to str
        Path below the dataset to SHA-256; the shards among them become distributions.
    """
    shards = sorted(path for path in sums if path.startswith("shards/"))
    members = description["members"]
    return {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "name": description["name"],
        "description": f"{description['counts']['pairs']} pairs of synthetic thermal (LWIR) and metric depth images "
        "with optical flow, temperature and labels, seen from drones over procedural worlds.",
        "version": description["version"],
        "license": licence_url(licence_of(description)),
        "citeAs": f"{description['name']} {description['version']}: thermal and depth images made by thermal-scenegen, "
        f"content {description['content_id'][:16]}",
        "identifier": description["content_id"],
        "keywords": ["thermal", "LWIR", "depth", "optical flow", "synthetic", "drone"],
        "distribution": [*(_shard(p, sums[p]) for p in shards), *(_member(m, shards) for m in members)],
        "recordSet": [_records(m) for m in members],
    }


def _shard(path: str, sha256: str) -> dict[str, Any]:
    return {
        "@type": "cr:FileObject",
        "@id": path,
        "name": path,
        "contentUrl": path,
        "encodingFormat": "application/x-tar",
        "sha256": sha256,
    }


def _member(suffix: str, shards: list[str]) -> dict[str, Any]:
    return {
        "@type": "cr:FileSet",
        "@id": f"files-{suffix}",
        "name": f"files-{suffix}",
        "containedIn": [{"@id": path} for path in shards],
        "encodingFormat": _FORMATS[suffix.rpartition(".")[2]],
        "includes": f"*.{suffix}",
    }


def _records(suffix: str) -> dict[str, Any]:
    """One record a frame: its key, cut from the file name, and the content of the member."""
    name = suffix.partition(".")[0]
    files = {"@id": f"files-{suffix}"}
    key = {
        "@type": "cr:Field",
        "@id": f"{name}/key",
        "name": f"{name}/key",
        "dataType": "sc:Text",
        "source": {
            "fileSet": files,
            "extract": {"fileProperty": "filename"},
            "transform": {"regex": rf"^(.+)\.{suffix.replace('.', chr(92) + '.')}$"},
        },
    }
    content = {
        "@type": "cr:Field",
        "@id": f"{name}/content",
        "name": f"{name}/content",
        "dataType": "sc:ImageObject" if suffix.rpartition(".")[2] in _IMAGES else "sc:Text",
        "source": {"fileSet": files, "extract": {"fileProperty": "content"}},
    }
    return {
        "@type": "cr:RecordSet",
        "@id": name,
        "name": name,
        "key": {"@id": f"{name}/key"},
        "field": [key, content],
    }
