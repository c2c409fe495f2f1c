from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.robot.build import design_yaml
from hyperleg_design.robot.design import Design, load_design, parse_overrides
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.values import Origin


def same(a: Design, b: Design) -> bool:
    one, two = parameters.leaves(a), parameters.leaves(b)
    return a.variant == b.variant and all(
        np.array_equal(one[p], two[p]) and np.shape(one[p]) == np.shape(two[p]) for p in one
    )


def test_an_override_reaches_the_design(hyperleg):
    made = load_design("hyperleg", overrides=["toe.mass=0.3", "actuators.knee.motor=RI80"])
    assert (made["toe.mass"], made["actuators.knee.motor"]) == (0.3, "RI80")
    assert mass_table(load_design(overrides={"toe.mass": 0.3})).total == pytest.approx(
        32.16, abs=1e-12
    )
    assert made.origins["toe.mass"] == Origin("user", "--set")
    assert made.origins["foot.mass"].label == "paper"
    assert hyperleg["toe.mass"] == 0.22


def test_a_pattern_reaches_all_that_match_it_and_later_values_win():
    made = load_design(overrides=["actuators.*.gear=8", "actuators.knee.gear=6"])
    gears = {name: made[f"actuators.{name}.gear"] for name in ("hip_yaw", "ankle", "toe", "knee")}
    assert gears == {"hip_yaw": 8.0, "ankle": 8.0, "toe": 8.0, "knee": 6.0}
    assert made.origins["actuators.toe.gear"] == Origin("user", "--set")
    with pytest.raises(InputError, match=r"actuators\.\*\.gears = 8: no such field"):
        load_design(overrides=["actuators.*.gears=8"])


def test_overlays_go_before_overrides_and_keep_labels(write):
    first = write(
        "first.yaml", "toe: {mass: {value: 0.4, label: vendor, source: scale}}\nfoot: {mass: 0.7}\n"
    )
    second = write("second.yaml", "foot: {mass: 0.8}\n")
    made = load_design(overlays=[first, second], overrides={"toe.mass": 0.3})
    assert (made["toe.mass"], made["foot.mass"]) == (0.3, 0.8)
    assert load_design(overlays=[first]).origins["toe.mass"] == Origin("vendor", "scale")


def test_an_override_beside_what_the_variant_changes_is_kept():
    assert load_design(overrides={"toe.length": 0.07}, variant="toe_locked")["toe.length"] == 0.07
    assert (
        load_design(overrides={"toe.mass": 0.3}, variant="toe_removed_matched")["toe.mass"] == 0.3
    )


def test_an_override_that_the_variant_undoes_is_refused():
    with pytest.raises(InputError, match=r"toe\.mass.*toe_removed"):
        load_design(overrides={"toe.mass": 0.3}, variant="toe_removed")


def test_printed_sums_lapse_with_a_replaced_mass(hyperleg, write):
    assert hyperleg["masses.expected_total"] == 32.0
    made = hyperleg.with_values({"pelvis.mass": 12.0})
    assert (made["masses.expected_total"], made["masses.expected_leg"]) == (0.0, 8.27)
    made = hyperleg.with_values({"toe.mass": np.array([0.2, 0.3])})
    assert (made["masses.expected_total"], made["masses.expected_leg"]) == (0.0, 0.0)
    with pytest.raises(InputError, match=r"expected_total = 40\.0.*32\.2"):
        load_design(overlays=[write("o.yaml", "toe: {mass: 0.32}\nmasses: {expected_total: 40}\n")])


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_a_resolved_design_reads_back_as_itself(write, variant):
    overrides = {"thigh.length": 0.1 + 0.2, "actuators.knee.motor": "RI80", "foot.mass": 1 / 3}
    design = load_design(overrides=overrides, variant=variant)
    again = load_design(write("again.yaml", design_yaml(design)))
    assert same(design, again)
    assert dict(again.origins) == dict(design.origins)
    assert again.name == "hyperleg"


def test_shipped_variants_are_the_ablations(hyperleg):
    for variant in ("toe", "toe_locked", "toe_removed_matched", "toe_removed"):
        assert same(load_design(variant), load_design("hyperleg", variant=variant))


def test_bases_chain(write):
    write("one.yaml", "base: hyperleg\ntoe: {mass: 0.3}\n")
    two = write("two.yaml", "base: one\nvariant: toe_locked\nfoot: {mass: 0.7}\n")
    design = load_design(two)
    assert (design.name, design.variant, design["toe.mass"], design["foot.mass"]) == (
        "two",
        "toe_locked",
        0.3,
        0.7,
    )


def test_a_batch_takes_its_size_from_its_leaves(hyperleg):
    assert hyperleg.batch_shape == ()
    batch = hyperleg.with_values(
        {
            "toe.mass": np.linspace(0.2, 0.4, 5),
            "foot.com": np.zeros((5, 3)),
            "actuators.knee.motor": np.array(["RI70", "RI80", "RI70", "RI80", "RI70"]),
        }
    )
    assert batch.batch_shape == (5,)
    one = batch.take(3)
    assert one.batch_shape == ()
    assert (one["toe.mass"], one["actuators.knee.motor"], one["foot.com"].tolist()) == (
        batch["toe.mass"][3],
        "RI80",
        [0, 0, 0],
    )
    assert type(one["actuators.knee.motor"]) is str
    assert one.origins == batch.origins
    with pytest.raises(IndexError):
        batch.take(5)


def test_a_batch_of_one_stretches(hyperleg):
    batch = hyperleg.with_values({"toe.mass": np.array([0.3]), "foot.mass": np.array([0.6, 0.7])})
    assert batch.batch_shape == (2,)
    assert (batch.take(1)["toe.mass"], batch.take(1)["foot.mass"]) == (0.3, 0.7)
    assert hyperleg.with_values({"toe.mass": np.array([0.3])}).batch_shape == (1,)


def test_batches_of_unequal_length_are_refused(hyperleg):
    with pytest.raises(InputError, match=r"toe\.mass = 3.*foot\.mass is 2"):
        hyperleg.with_values({"toe.mass": np.full(3, 0.3), "foot.mass": np.full(2, 0.6)})


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"toe.mas": 0.3}, ["toe.mas", "toe.mass"]),
        ({"toe": 0.3}, ["toe", "section"]),
        ({"toe.mass": "0.3 kg"}, ["toe.mass", "0.3 kg", "kg"]),
        ({"toe.mass": 220}, ["toe.mass", "220", "kg"]),
        ({"thigh.length": -0.3}, ["thigh.length", "-0.3", "m"]),
        ({"toe.joint": np.array(["active", "locked"])}, ["toe.joint", "batch"]),
        ({"transmission.posture": "running"}, ["transmission.posture", "running", "walking"]),
        ({"actuators.knee.motor": "RI7O"}, ["actuators.knee.motor", "RI7O", "RI70"]),
        ({"actuators.knee.motor": np.array(["RI70", "XX"])}, ["actuators.knee.motor", "XX"]),
        ({"electrical.constants": "mine"}, ["electrical.constants", "mine", "vendor"]),
        ({"masses.law": "magic"}, ["masses.law", "magic", "components"]),
        ({"reference.knee_motor": "XX"}, ["reference.knee_motor", "XX"]),
    ],
)
def test_bad_values_name_field_value_and_remedy(hyperleg, values, words):
    with pytest.raises(InputError) as caught:
        hyperleg.with_values(values)
    for word in ["override", *words]:
        assert word in str(caught.value)


def test_getitem_names_the_nearest_path(hyperleg):
    with pytest.raises(InputError, match=r"did you mean toe\.mass"):
        hyperleg["toe.mas"]


@pytest.mark.parametrize(
    "item",
    [
        "toe.mass",
        "=3",
        "",
        "toe.mass=[1",
        "toe.mass={a: b",
        "toe.mass=2020-99-01",
        "toe.mass=" + "[" * 10_000,
    ],
)
def test_overrides_that_cannot_be_read(item):
    with pytest.raises(InputError, match="--set"):
        parse_overrides([item])


def test_overrides_are_yaml():
    assert parse_overrides(["a.b=1e3", "c=[1, 2]", "d=true", " e = x=y "]) == {
        "a.b": "1e3",
        "c": [1, 2],
        "d": True,
        "e": "x=y",
    }


WHOLE = (resources.content_folder("descriptions") / "hyperleg.yaml").read_text()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("name: hyperleg", "name: '../evil'", ["name", "../evil", "letter"]),
        ("name: hyperleg", "name: 'a ${1} b'", ["name", "letter"]),
        ("name: hyperleg", "name: [1]", ["name", "letter"]),
        ("name: hyperleg", "name: hyperleg\nvariant: no_toe", ["variant", "no_toe", "toe_removed"]),
        (
            "name: hyperleg",
            "name: hyperleg\nvariant: toe_removed",
            ["variant", "toe_removed", "toe.joint"],
        ),
        ("name: hyperleg", "name: hyperleg\nextra: 1", ["extra", "no such field"]),
        ("pelvis:\n", "pelviss:\n", ["pelviss", "did you mean pelvis"]),
        (
            "toe_installed: {value: true",
            "toe_installed: {value: false",
            ["actuators.toe_installed", "toe.joint"],
        ),
        ("mass: {value: 15.46", "mass: {value: 16.46", ["masses.expected_total", "32.0", "33"]),
        ("mass: {value: 5.71", "mass: {value: 5.81", ["masses.expected_leg", "8.27", "8.37"]),
        ("mass: {value: 15.46", "mass: {value: 15460", ["pelvis.mass", "15460", "kg"]),
        (
            "spacing: {value: 0.20, label",
            "spacing: {value: 0.20, lable",
            ["hip.spacing.lable", "did you mean label?"],
        ),
        ("motor: {value: RI70", "motor: {value: RI71", ["motor", "RI71", "RI70"]),
    ],
)
def test_a_whole_design_with_a_fault(write, old, new, words):
    assert old in WHOLE
    path = write("robot.yaml", WHOLE.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_design(path)
    for word in ["robot.yaml", *words]:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("base: robot\n", ["base", "back to itself"]),
        ("base: nowhere\n", ["nowhere", "hyperleg"]),
        ("base: [1]\n", ["[1]"]),
        ("base: hyperleg\nvariant: 3\n", ["variant", "3"]),
        ("base: toe_removed\nvariant: toe_locked\ntoe: {mas: 1}\n", ["toe.mas"]),
        ("base: hyperleg\ntoe: 5\n", ["toe", "section"]),
        ("base: hyperleg\n5: {x: 1}\n", ["5"]),
    ],
)
def test_a_design_on_a_base_with_a_fault(write, text, words):
    path = write("robot.yaml", text)
    with pytest.raises(InputError) as caught:
        load_design(path)
    for word in words:
        assert word in str(caught.value)


def test_two_bases_that_lead_to_each_other(write):
    write("one.yaml", "base: two\n")
    with pytest.raises(InputError, match="back to itself"):
        load_design(write("two.yaml", "base: one\n"))


def test_a_variant_of_a_variant_is_refused(write):
    with pytest.raises(InputError, match="toe_removed"):
        load_design("toe_removed", variant="toe_locked")
    whole = write("whole.yaml", design_yaml(load_design("toe_removed")))
    with pytest.raises(InputError, match="no active toe"):
        load_design(whole, variant="toe_locked")


def test_a_name_comes_from_the_file(write):
    assert load_design(
        write("my robot (2).yaml", WHOLE.replace("name: hyperleg\n", ""))
    ).name == "my_robot_2_.yaml".removesuffix(".yaml")


def test_a_missing_file(tmp_path: Path):
    with pytest.raises(InputError, match=r"gone\.yaml.*shipped: .*hyperleg"):
        load_design(tmp_path / "gone.yaml")


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_a_mapping_carries_a_whole_design(variant):
    import json

    from hyperleg_design.robot.design import design_from_mapping

    design = load_design("hyperleg", variant=variant, overrides={"pelvis.mass": 16.0})
    again = design_from_mapping(json.loads(json.dumps(design.to_mapping())), "carried")
    assert again.to_mapping() == design.to_mapping()
    assert again.variant == variant
    for broken, field in (
        ("text", ""),
        ({**design.to_mapping(), "variant": "no_toes"}, "variant"),
        ({"name": "x"}, "pelvis"),
    ):
        with pytest.raises(InputError) as caught:
            design_from_mapping(broken, "carried")
        assert caught.value.field == field
        assert caught.value.where == "carried"
