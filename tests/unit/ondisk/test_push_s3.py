"""Pushed to and read from S3, by `s3fs` from `moto`'s server.

Runs where both are installed: ``pip install 'moto[server]' s3fs``.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from scenegen.foundation.errors import DatasetError, InputError
from scenegen_datasets import PairDataset
from scenegen_datasets.layers import DEFAULT_LAYERS
from scenegen_datasets.push import push

pytest.importorskip("s3fs")
pytest.importorskip("moto.server")
pytestmark = pytest.mark.filterwarnings("ignore")  # of botocore


@pytest.fixture(scope="module")
def endpoint() -> Iterator[str]:
    from moto.server import ThreadedMotoServer

    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    yield "http://{}:{}".format(*server.get_host_and_port())
    server.stop()


@pytest.fixture(autouse=True)
def surroundings(endpoint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a user of S3 has in the environment."""
    monkeypatch.setenv("AWS_ENDPOINT_URL", endpoint)
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "testing")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "testing")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    monkeypatch.setenv("SCENEGEN_CACHE", str(tmp_path / "copies"))


@pytest.fixture
def bucket(endpoint: str) -> str:
    import boto3

    client = boto3.client("s3", endpoint_url=endpoint)
    name = f"sets-{len(client.list_buckets()['Buckets'])}"
    client.create_bucket(Bucket=name)
    return name


def buckets() -> set[str]:
    import boto3

    return {one["Name"] for one in boto3.client("s3").list_buckets()["Buckets"]}


def test_what_is_pushed_is_read_at_random_and_on_end(pristine: Path, bucket: str, endpoint: str) -> None:
    url = f"s3://{bucket}/night/city"
    total = sum(path.is_file() for path in pristine.rglob("*"))
    assert push(pristine, url).sent == total and push(pristine, url).sent == 0
    options = {"endpoint_url": endpoint, "key": "testing", "secret": "testing"}
    layers = (*DEFAULT_LAYERS, "previous_thermal")
    here, there = (PairDataset(x, layers=layers, storage_options=options) for x in (pristine, url))
    travelled = pickle.loads(pickle.dumps(there))
    for order in (np.random.default_rng(1).permutation(18).tolist(), range(18)):
        for i in order:
            mine, theirs = here[i], travelled[i]
            assert all(np.array_equal(mine[n], theirs[n], equal_nan=n == "flow") for n in layers)


def test_a_killed_push_is_no_dataset_and_goes_on(pristine: Path, bucket: str) -> None:
    url = f"s3://{bucket}/killed"
    import s3fs

    fs = s3fs.S3FileSystem(use_listings_cache=False)
    for sign in (signal.SIGKILL, signal.SIGINT):
        pushing = subprocess.Popen(
            [sys.executable, "-m", "scenegen_cli.main", "push", str(pristine), url],
            env=os.environ,
            stderr=subprocess.PIPE,
        )
        before = len(fs.find(f"{bucket}/killed"))
        while pushing.poll() is None and len(fs.find(f"{bucket}/killed")) < before + 2:
            time.sleep(0.02)
        pushing.send_signal(sign)
        _, said = pushing.communicate()
        assert b"Traceback" not in said
        if f"{bucket}/killed/dataset.json" not in fs.find(f"{bucket}/killed"):
            with pytest.raises(InputError, match="not whole yet"):
                PairDataset(url)
    there = len(fs.find(f"{bucket}/killed"))
    total = sum(path.is_file() for path in pristine.rglob("*"))
    done = push(pristine, url)
    assert done.sent in (total - there, 0) and len(PairDataset(url)) == 18


def test_a_bucket_that_is_not_there_is_told_and_not_made(pristine: Path, bucket: str) -> None:
    before = buckets()
    with pytest.raises(InputError, match=r"^s3://mistyped/d: there is no such bucket; make it"):
        push(pristine, "s3://mistyped/d")
    with pytest.raises(InputError, match="no dataset at s3://mistyped/d"):
        PairDataset("s3://mistyped/d")
    assert buckets() == before


def test_without_credentials_one_line_says_so(
    pristine: Path, bucket: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import s3fs

    monkeypatch.setattr("scenegen_datasets.remote.web._WAITS_S", ())
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    s3fs.S3FileSystem.clear_instance_cache()
    for act in (lambda: push(pristine, f"s3://{bucket}/d"), lambda: PairDataset(f"s3://{bucket}/d")):
        with pytest.raises(
            DatasetError, match=r"Unable to locate credentials; .*check the URL and your access"
        ):
            act()
    s3fs.S3FileSystem.clear_instance_cache()
