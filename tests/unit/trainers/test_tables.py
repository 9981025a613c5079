"""Table 1: verdicts by hand, and the whole table through the command line, twice."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from scenegen_cli.main import main
from scenegen_trainers.models.checkpoint import read_checkpoint
from scenegen_trainers.tables.order import half_width, judge
from scenegen_trainers.tables.paper import RELATIONS, ROWS, Relation
from scenegen_trainers.tables.table1 import Table1, run_name
from scenegen_trainers.tables.table1_page import as_html, as_markdown
from scenegen_trainers.tables.worker import worker

TINY = [
    *("--training.steps", "2", "--training.judge", "2", "--training.judge-pairs", "2"),
    *("--pix2pix.width", "2", "--pix2pix.judge-width", "2", "--pix2pix.downs", "3"),
]


def test_half_width_of_a_mean_by_hand() -> None:
    """Three values 1, 2, 3: t(0.975, 2) = 4.302653, sd 1, so 4.302653 / sqrt(3)."""
    assert half_width([1.0, 2.0, 3.0]) == pytest.approx(4.302653 / 3**0.5, rel=1e-6)


@pytest.mark.parametrize(
    ("better", "verdict"),
    [((1.0, 1.1, 0.9), "held"), ((2.5, 1.0, 2.0), "open"), ((3.0, 3.1, 2.9), "not held")],
)
def test_a_relation_is_held_by_more_than_its_spread(better: tuple[float, ...], verdict: str) -> None:
    relation = Relation("x", ("a",), ("b",))
    runs = {"a": better, "b": (2.0, 2.1, 1.9)}
    assert judge(relation, "rmse_m", runs).verdict == verdict
    flipped = {"held": "not held", "not held": "held", "open": "open"}[verdict]
    assert judge(relation, "delta1", runs).verdict == flipped


def test_the_worst_pair_decides_and_one_seed_decides_nothing() -> None:
    relation = Relation("x", ("a",), ("b", "c"))
    runs = {"a": (1.0, 1.1), "b": (9.0, 9.1), "c": (0.2, 0.3)}
    found = judge(relation, "rel", runs)
    assert found.verdict == "not held" and found.against == "a against c"
    assert judge(relation, "rel", {"a": (1.0,), "b": (9.0,), "c": (9.0,)}).verdict == "open"


def test_the_paper_supports_its_own_relations() -> None:
    """In every score, ties included."""
    for relation in RELATIONS:
        assert set(relation.better) | set(relation.worse) <= {row.key for row in ROWS}
        for score in ROWS[0].figures:
            runs = {row.key: (row.figures[score],) for row in ROWS}
            assert judge(relation, score, runs).margin >= 0.0


def test_rows_are_held_against_an_answer_without_an_image() -> None:
    """Networks of 10 m on average, a row mean of 12 m, and one row that no image helps."""
    kinds = ("pooled", "painted", "pooled_aligned")

    def scores(rmse_m: float) -> dict[str, Any]:
        own = {"rmse_m": rmse_m, "rel": rmse_m / 30.0, "delta1": 0.5, "delta2": 0.7, "delta3": 0.8}
        near = {"from_m": 0.5, "below_m": 20.0, "scores": own}
        return {**dict.fromkeys(kinds, own), "by_range": [near, {**near, "scores": None}]}

    runs = {row.key: [scores(rmse) for rmse in (9.9, 10.0, 10.1)] for row in ROWS}
    runs["proposed-0"] = [scores(rmse) for rmse in (14.9, 15.0, 15.1)]
    baselines = {"row mean": scores(12.0), "row mean, sky as cap": scores(9.0), "constant": scores(20.0)}
    dataset = {"name": "toy", "version": "1.0.0"}
    table = Table1(dataset, "test", "ci", (0, 1, 2), runs, baselines, 600)
    found = {f.claim: f for f in table.against_trivial() if f.score == "rmse_m"}
    assert found["proposed, w_L1 = 300"].verdict == "held"
    assert found["proposed, w_L1 = 300"].margin == pytest.approx(2.0)
    assert found["proposed, w_L1 = 0"].verdict == "not held"
    painted = [f.verdict for f in table.against_trivial("painted") if f.score == "rmse_m"]
    assert painted == ["not held"] * len(ROWS)
    page = as_markdown(table)
    assert page.count("| row mean, no image |  | 12.00 | 0.400 |") == len(kinds)
    assert "| proposed, w_L1 = 0 | not held (-3.000) |" in page
    assert "|  | RMSE [m], 0.5 to 20 m | Rel, 0.5 to 20 m |\n" in page
    assert "| Pix2Pix, w_L1 = 100 | 10.00 ± 0.10 | 0.333 ± 0.003 |\n" in page
    assert '<span class="bad">not held (-3.000)</span>' in as_html(table)


@pytest.mark.slow
def test_the_whole_table_and_one_run_again(
    toy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "table"
    arguments = ["table1", "--data", str(toy), "--out", str(out), "--seeds", "1", "--jobs", "1"]
    assert main([*arguments, *TINY]) == 0
    said = capsys.readouterr().out.split()
    assert said == [str(out / f"table1.{ending}") for ending in ("json", "md", "html")]
    table = json.loads((out / "table1.json").read_text())
    assert [row["key"] for row in table["rows"]] == [row.key for row in ROWS]
    assert all(len(row["runs"]) == 1 for row in table["rows"])
    assert {found["verdict"] for found in table["relations"]} == {"open"}  # one seed decides nothing
    assert "| proposed | 300 |" in (out / "table1.md").read_text()

    row = ROWS[-1]
    before = out / "runs" / run_name(row, 0)
    recipe = read_checkpoint(before / "model.pt").record["recipe"]
    handle = worker({"data": str(toy), "split": "test"})
    handle({"recipe": recipe, "out": str(tmp_path / "again")}, lambda said: None)
    for name in ("scores.json", "model.pt"):
        assert (before / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


def test_train_and_evaluate_from_the_command_line(
    toy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run"
    assert main(["train", "--data", str(toy), "--out", str(out), "--model", "pix2pix", *TINY]) == 0
    model = capsys.readouterr().out.strip()
    assert model == str(out / "model.pt")
    assert main(["evaluate", model, str(toy), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["scores"]["images"] == 8
    assert (out / "evaluation-test" / "worst.png").is_file()
    assert main(["evaluate", model, str(toy), "--out", model]) == 2
    assert "is a file; name a directory" in capsys.readouterr().err
    assert main(["evaluate", model, str(toy), "--split", "train", "--pairs", "4"]) == 0
    said = capsys.readouterr().out
    assert [line.split()[-7] for line in said.splitlines()[1:9:4]] == ["network", "network"]
    assert "learned from these very pairs" in (out / "evaluation-train" / "evaluation.html").read_text()


@pytest.mark.slow
def test_two_processes_share_a_training(toy: Path, tmp_path: Path) -> None:
    """Distributed data parallel on the CPU; a second call finds it done."""
    start = tmp_path / "start.py"
    start.write_text("from scenegen_cli.main import main\nraise SystemExit(main())\n")
    out = tmp_path / "run"
    command = [sys.executable, start, "train", "--data", toy, "--out", out, "--devices", "2", *TINY]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == str(out / "model.pt")
    assert "2 processes" in done.stderr and "deprecated" not in done.stderr
    record = read_checkpoint(out / "model.pt").record
    assert record["step"] == record["recipe"]["training"]["steps"]
    assert not (out / ".lock").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["train"], "--data is missing"),
        (["train", "--data", "nowhere"], "nowhere"),
        (["train", "--data", "x", "--model", "unet"], "--model unet: unknown model; known: fastdepth"),
        (["train", "--data", "x", "--inputs.flow", "fernback"], "perhaps you meant 'farneback'"),
        (["train", "--data", "x", "--profile", "tiny"], "--profile tiny: unknown profile; known: ci"),
        (["evaluate", "none.pt", "x"], "none.pt: no such file"),
        (["evaluate", "none.pt", "x", "--pairs", "-3"], "--pairs -3: so many, or 0 for all"),
        (["evaluate", "none.pt", "x", "--threads", "0"], "--threads 0: at least 1"),
        (["onnx"], "name at least one checkpoint"),
        (["table1"], "--data is missing"),
        (["table1", "--data", "x", "--seeds", "0"], "--seeds must be at least 1"),
    ],
)
def test_mistakes_are_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    said = capsys.readouterr().err.strip()
    assert message in said and "\n" not in said


@pytest.mark.parametrize("command", ["train", "evaluate", "table1", "onnx"])
def test_help_loads_no_torch(command: str) -> None:
    code = (
        "import sys\nfrom scenegen_cli.main import main\n"
        f"assert main(['{command}', '--help']) == 0\n"
        "heavy = {'torch', 'lightning', 'mitsuba', 'cv2', 'scipy'} & {n.partition('.')[0] for n in sys.modules}\n"
        "assert not heavy, heavy\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
