"""What the word after --pilot may be."""

from pathlib import Path

import pytest

import campaign_pilots
from scenegen.foundation.errors import InputError
from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_render.camera import Camera
from scenegen_trainers.campaign.names import is_slug
from scenegen_trainers.pilots.checkpoint import save
from scenegen_trainers.pilots.spec import parse_pilot, raise_pilot

CAMERA = Camera.from_fov(16, 12, 90.0)


@pytest.mark.parametrize("word", ["oracle", "blind", "campaign_pilots:Climber", "campaign_pilots:OnlyDepth"])
def test_a_pilot_is_found_and_raised(word: str) -> None:
    spec = parse_pilot(word, "waypoint")
    pilot = raise_pilot(spec, LoopKnobs(), CAMERA)
    assert is_slug(spec.slug)
    assert spec.name == word.rpartition(":")[2]
    assert hasattr(pilot, "act")


def test_another_file_of_the_same_name_is_another_pilot(tmp_path: Path) -> None:
    path = tmp_path / "my net.pt"
    save(path, campaign_pilots.Warm(), {})
    first = parse_pilot(str(path), "waypoint")
    (tmp_path / "moved").mkdir()
    moved = path.rename(tmp_path / "moved" / "my net.pt")
    assert parse_pilot(str(moved), "waypoint").slug == first.slug  # where it lies does not matter
    assert parse_pilot(str(moved), "straight").slug != first.slug
    save(moved, campaign_pilots.Warm(far_m=3.0), {"far_m": 3.0})
    assert parse_pilot(str(moved), "waypoint").slug != first.slug
    assert is_slug(first.slug)


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("orakle", "perhaps you meant 'oracle'"),
        ("missing.pt", "no such file"),
        ("missing.onnx", "no such file"),
        ("no_such_module:Pilot", "cannot import 'no_such_module'"),
        ("campaign_pilots:Nobody", "has no 'Nobody'"),
        (".", "ends in .pt, .pth or .onnx"),
    ],
)
def test_what_is_no_pilot_is_one_line(word: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_pilot(word, "waypoint")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("campaign_pilots:NotANetwork", "without name"),
        ("campaign_pilots:broken", "raised ValueError: no weights"),
    ],
)
def test_a_plug_in_that_is_no_pilot_is_one_line(word: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        raise_pilot(parse_pilot(word, "waypoint"), LoopKnobs(), CAMERA)
