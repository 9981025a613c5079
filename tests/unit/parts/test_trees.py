"""Trees: exact height, inside their promised radius, rooted, porous like real crowns, sites that see no leaf."""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.errors import InputError
from scenegen.parts.vegetation.growth import Plan
from scenegen.parts.vegetation.outline import half_width
from scenegen.parts.vegetation.plant import crown_radius_m, plant, triangles
from scenegen.parts.vegetation.species import SPECIES, Species
from scenegen.parts.vegetation.tree import BARK, LEAVES, TWIGS, tree

DECIDUOUS = sorted(name for name, s in SPECIES.items() if not s.evergreen)
TRUNK_SITES = 3
MONTHS = {"summer": Season(50.0, 7, 1), "winter": Season(50.0, 1, 15), "spring": Season(50.0, 5, 3)}


def model(name: str, faces: int = 1700, in_leaf: float = 1.0, seed: int = 3):
    return tree(SPECIES[name], Plan(faces, in_leaf), np.random.default_rng(seed))


def gap_share(template, species: Species, seed: int) -> float:
    """Share of horizontal rays through the inner four fifths of the outline that meet nothing, cast at triangles."""
    rng, outline = np.random.default_rng(seed), species.growth.outline
    turn = rng.uniform(0, 2 * np.pi)
    flat = template.vertices @ np.array([[np.cos(turn), 0.0], [np.sin(turn), 0.0], [0.0, 1.0]])
    ray = rng.uniform((-outline.radius, outline.base + 0.05), (outline.radius, 0.95), (1200, 2))
    ray = ray[np.abs(ray[:, 0]) < 0.8 * half_width(outline, ray[:, 1])]
    a, b, c = (flat[template.faces[:, k]][:, :, None] for k in range(3))
    p = ray.T[None]

    def turned(u, v):
        return (v[:, 0] - u[:, 0]) * (p[:, 1] - u[:, 1]) - (v[:, 1] - u[:, 1]) * (p[:, 0] - u[:, 0]) > 0

    first, second, third = turned(a, b), turned(b, c), turned(c, a)
    hit = (first == second) & (second == third)
    return 1.0 - float(hit.any(axis=0).mean())


@pytest.mark.parametrize("name", SPECIES)
@pytest.mark.parametrize("month", MONTHS)
def test_height_is_exact_and_nothing_leaves_the_crown_radius(workshop, row, name, month):
    height = np.linspace(4.0, 19.0, 9)
    position = row(9) + np.array([0.0, 0.0, 2.0])
    shop = workshop(season=MONTHS[month])
    parts = plant(name, position, height, shop, np.random.default_rng(1))
    barks = [i for name in ("bark_trunk", "twigs_bare") for i in shop.palette.variants(name)]
    radius = crown_radius_m(name, height)
    seen = np.zeros(9, bool)
    for part in parts:
        for instance in np.unique(part.object):
            k = instance - 1
            vertices = part.vertices[part.faces[part.object == instance]].reshape(-1, 3) - position[k]
            assert vertices[:, 2].max() == pytest.approx(height[k], abs=1e-9)
            assert -0.05 * height[k] < vertices[:, 2].min() < -0.02 * height[k]
            assert 0.7 * radius[k] < np.hypot(vertices[:, 0], vertices[:, 1]).max() <= radius[k] + 1e-9
            leaf = np.repeat(~np.isin(part.surface[part.object == instance], barks), 3)
            assert not leaf.any() or vertices[leaf, 2].min() > 0.0
            low = vertices[vertices[:, 2] < 0.005 * height[k]]
            assert np.hypot(low[:, 0], low[:, 1]).max() < 0.11 * height[k]
            seen[k] = True
    assert seen.all()


@pytest.mark.parametrize("name", sorted(set(SPECIES) - {"palm"}))
def test_sky_shines_through_a_crown_as_through_real_ones(name):
    share = np.mean([gap_share(model(name, seed=k), SPECIES[name], k) for k in range(3)])
    assert 0.08 < share < 0.34


@pytest.mark.parametrize("name", DECIDUOUS)
def test_a_bare_tree_shows_its_branches_and_the_sky(name):
    bare = model(name, in_leaf=0.0)
    assert set(bare.slot) == {BARK, TWIGS}
    assert 0.5 < gap_share(bare, SPECIES[name], 0) < 0.93
    half = model(name, in_leaf=0.5)
    assert (
        gap_share(bare, SPECIES[name], 0)
        > gap_share(half, SPECIES[name], 0)
        > gap_share(model(name), SPECIES[name], 0)
    )


@pytest.mark.parametrize("name", SPECIES)
@pytest.mark.parametrize("faces", [600, 1000, 1700, 3000])
def test_triangles_stay_near_what_was_asked_and_sites_are_few(name, faces):
    for in_leaf in (0.0, 0.6, 1.0):
        made = model(name, faces, in_leaf)
        assert 0.55 * faces < len(made.faces) < 1.35 * faces
        assert 6 <= len(np.unique(made.corner_site)) <= 14
        used = made.vertices[made.faces]
        area = np.linalg.norm(np.cross(used[:, 1] - used[:, 0], used[:, 2] - used[:, 0]), axis=1)
        assert np.isfinite(made.vertices).all() and (area > 0.0).mean() > 0.995


@pytest.mark.parametrize("name", SPECIES)
def test_rays_that_leave_a_leaf_site_outwards_never_meet_a_leaf(name):
    made = model(name)
    leaf = made.slot == LEAVES
    corners = made.vertices[made.faces[leaf]].reshape(-1, 3)
    for k in np.unique(made.corner_site[leaf]):
        assert ((corners - made.site_position[k]) @ made.site_normal[k]).max() < 0.0


@pytest.mark.parametrize("name", DECIDUOUS)
def test_rays_that_leave_a_bare_crown_outwards_never_meet_a_branch(name):
    made = model(name, in_leaf=0.0)
    for slot in (BARK, TWIGS):
        mine = (made.slot == slot) & (made.corner_site[:, 0] >= TRUNK_SITES)
        corners = made.vertices[made.faces[mine]].reshape(-1, 3)
        assert mine.sum() > 60
        for k in np.unique(made.corner_site[mine]):
            assert ((corners - made.site_position[k]) @ made.site_normal[k]).max() < 0.0


def test_leaves_take_the_site_of_their_side():
    made = model("maple", 3000)
    leaf = made.slot == LEAVES
    middle = made.vertices[made.faces[leaf]].mean(axis=1)
    normal = made.site_normal[made.corner_site[leaf, 0]]
    east = normal[:, 0] > 0.5
    assert east.any() and (middle[east, 0] > 0.0).mean() > 0.97
    top, under = normal[:, 2] > 0.99, normal[:, 2] < -0.99
    assert middle[top, 2].mean() > middle[under, 2].mean() + 0.1


def test_each_branch_of_a_bare_tree_has_a_sunny_side():
    made = model("oak", in_leaf=0.0)
    a, b, c = (made.vertices[made.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    agrees = np.einsum("ij,ij->i", normal, made.site_normal[made.corner_site[:, 0]])
    assert agrees[made.slot == BARK].min() > 0.3 and agrees.mean() > 0.65


def test_trees_are_the_same_for_the_same_seed_and_differ_otherwise(workshop, row, same):
    height = np.linspace(5.0, 15.0, 30)
    first, again, other = (
        plant("lime", row(30), height, workshop(), np.random.default_rng(seed)) for seed in (5, 5, 6)
    )
    assert same(first, again)
    assert not np.array_equal(first[0].vertices, other[0].vertices)


def test_labels_and_instances(workshop, row):
    shop = workshop()
    shop.builder.new_objects(7)
    parts = plant("birch", row(40), np.full(40, 8.0), shop, np.random.default_rng(0))
    assert len(parts) == 2
    owner = np.concatenate([p.object for p in parts])
    assert np.array_equal(np.unique(owner), np.arange(8, 48))
    assert {int(s) for p in parts for s in p.semantic} == {int(Semantic.TREE)}
    bark, leaves = (set(shop.palette.variants(name)) for name in ("bark_trunk", "tree_crown"))
    assert {int(s) for p in parts for s in p.surface} <= bark | leaves


def test_forests_of_nothing_and_unknown_species(workshop):
    none = plant("oak", np.zeros((0, 3)), np.zeros(0), workshop(), np.random.default_rng(0))
    assert sum(len(p.faces) for p in none) == 0
    with pytest.raises(InputError, match=r"unknown species 'oka'.*oak"):
        crown_radius_m("oka", 5.0)


def test_a_budget_of_triangles_can_be_kept(workshop, row):
    height = np.random.default_rng(2).uniform(4.0, 16.0, 200)
    full = triangles(height)
    for detail in (1.0, 0.6):
        parts = plant("maple", row(200), height, workshop(), np.random.default_rng(0), detail)
        assert sum(len(p.faces) for p in parts) == pytest.approx(detail * full, rel=0.2)
