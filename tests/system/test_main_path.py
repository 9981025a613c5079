"""The main path, end to end: one command makes a verified dataset, the same bytes however it is made."""

import contextlib
import json
import os
import signal
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import small
import stubborn

from scenegen_cli.main import main
from scenegen_datasets import run
from scenegen_datasets.info import info
from scenegen_datasets.loader import PairDataset
from scenegen_datasets.verify import verify

HERE = Path(__file__).parent


def test_a_dataset_is_made_whole_and_loads(finished_dataset: Path) -> None:
    assert verify(finished_dataset).ok
    facts = info(finished_dataset)
    assert (facts.pairs, facts.frames, facts.clips, facts.worlds, facts.complete) == (16, 20, 4, 1, True)
    pairs = PairDataset(finished_dataset, layers=("thermal", "depth", "flow", "covisible", "semantic"))
    assert len(pairs) == 16
    for sample in pairs:
        assert sample["thermal"].shape == sample["depth"].shape == (64, 64)
        assert sample["thermal"].dtype == np.uint16
        assert np.array_equal(np.isinf(sample["depth"]), sample["semantic"] == 0)
        assert int(sample["thermal"].min()) > 0
        assert int(sample["thermal"].max()) < 16383
    assert len({pairs[i]["facts"]["hour"] for i in range(0, 16, 4)}) == 4  # an hour of its own for each clip
    assert len({pairs[i]["facts"]["latitude_deg"] for i in range(16)}) == 1  # a place for the world


def test_the_run_log_tells_what_each_stage_cost(finished_dataset: Path) -> None:
    events = [json.loads(line) for line in (finished_dataset / "run.log.jsonl").read_text().splitlines()]
    clips = [event for event in events if event["event"] == "clip"]
    assert sorted(event["clip"] for event in clips) == [f"city-00000-{k:03d}" for k in range(4)]
    assert all({"solve", "bake", "trace", "sense", "encode"} <= event["stages"].keys() for event in clips)
    assert "run.log.jsonl" not in (finished_dataset / "MANIFEST.sha256").read_text()


def test_one_process_and_growth_give_the_same_bytes(finished_dataset: Path, tmp_path: Path) -> None:
    root = tmp_path / "tiny"
    assert main(small.render(root, pairs=8, jobs=1)) == 0
    assert info(root).pairs == 8
    assert main(small.render(root, jobs=1)) == 0
    assert small.tree(root) == small.tree(finished_dataset)


def test_killed_at_random_moments_it_resumes_to_the_same_bytes(
    finished_dataset: Path, tmp_path: Path
) -> None:
    root = tmp_path / "tiny"
    rng = np.random.default_rng(20)
    for victim in ("group", "worker", "coordinator"):
        before = small.starts(root)
        job = small.start([*small.render(root), "--no-verify"])
        if (
            victim == "worker"
        ):  # of those that make clips; the first child only looks whether the renderer starts
            assert small.until(lambda: small.starts(root) > before)  # noqa: B023 - called here and now
        time.sleep(rng.uniform(2.0, 8.0))
        workers = small.children(job.pid)
        if victim == "worker" and workers:
            with contextlib.suppress(ProcessLookupError):
                os.kill(workers[-1], signal.SIGKILL)  # the job must get over it by itself
            job.communicate(timeout=600)
            assert job.returncode == 0
        elif victim == "group":
            os.killpg(job.pid, signal.SIGKILL)
        else:
            job.kill()
        job.communicate()
        assert small.gone(workers)
    assert main(small.render(root)) == 0
    assert small.tree(root) == small.tree(finished_dataset)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupt_leaves_no_process_and_says_how_to_go_on(number: int, code: int, tmp_path: Path) -> None:
    root = tmp_path / "tiny"
    job = small.start(small.render(root))
    assert small.until(lambda: small.starts(root) and small.children(job.pid))
    time.sleep(1.0)
    workers = small.children(job.pid)
    job.send_signal(number)
    _, errors = job.communicate(timeout=120)
    assert job.returncode == code
    assert not (root / "dataset.json").exists()  # it has not waited for its workers
    assert small.gone(workers)
    assert f"Continue with: scenegen render --pairs 16 --out {root}" in errors
    assert "Traceback" not in errors


def test_another_recipe_is_refused_by_its_key(
    finished_dataset: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = small.tree(finished_dataset)
    assert main(small.render(finished_dataset, more=("--seed", "1"))) == 2
    message = capsys.readouterr().err.strip().splitlines()[-1]
    assert "seed: 0 -> 1" in message
    assert small.tree(finished_dataset) == before


def test_a_finished_job_run_again_changes_nothing(
    finished_dataset: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = small.tree(finished_dataset)
    assert main([*small.render(finished_dataset), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert (report["made"], report["verified"], report["quarantined"]) == (0, True, {})
    assert small.tree(finished_dataset) == before


def test_a_clip_that_cannot_be_made_is_put_aside_and_made_by_a_later_run(
    finished_dataset: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    root, clip = tmp_path / "tiny", f"city-00000-{stubborn.REFUSED:03d}"
    with monkeypatch.context() as patch:
        patch.setattr(run, "WORKER", "stubborn:worker")
        patch.setitem(run.ENVIRONMENT, "PYTHONPATH", os.pathsep.join([str(HERE), *sys.path]))
        assert main(small.render(root, jobs=1)) == 3
    captured = capsys.readouterr()
    assert "verified, without 1 of 4 clips" in captured.out
    assert f"put aside: {clip}: no free flight in this test" in captured.err
    assert info(root).missing == (clip,)
    assert len(PairDataset(root)) == 12
    assert main(["status", str(root)]) == 0
    assert f"{clip}: no free flight in this test" in capsys.readouterr().out
    assert main(small.render(root, jobs=1)) == 0
    assert small.tree(root) == small.tree(finished_dataset)


def test_commands_on_a_dataset(
    finished_dataset: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    for arguments in (["info"], ["status"], ["verify", "--quick"], ["preview"]):
        assert main([arguments[0], str(finished_dataset), *arguments[1:]]) == 0
    said = capsys.readouterr().out
    assert "16 in 4 clips of 1 world (20 frames)" in said
    assert "16 of 16 (100 %)" in said
    assert main(["preview", str(finished_dataset), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "contact_sheet.png").read_bytes() == (
        finished_dataset / "preview" / "contact_sheet.png"
    ).read_bytes()


def test_a_flipped_byte_is_found(
    finished_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    import shutil

    root = tmp_path / "tiny"
    shutil.copytree(finished_dataset, root)
    shard = next(root.glob("shards/*/*/*.tar"))
    content = bytearray(shard.read_bytes())
    content[len(content) // 2] ^= 1
    shard.write_bytes(content)
    assert main(["verify", str(root)]) == 1
    assert shard.name in capsys.readouterr().out
