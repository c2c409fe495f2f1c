"""Broken input on the command line: one line that names what is wrong, exit code 2, nothing
written.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hyperleg_design import cli

OUT = ("--out", "out")
POLICY = "walk_upright-toe-0"
SEARCH = ("search", "sweep_good.yaml", "--objective", "leg_mass")
VALUE = "{{value: {}, label: assumed, source: test}}"

CAMPAIGN = (
    "name: c\npreset: study\ngroups: [{name: g, task: walk_upright, designs: [toe], seeds: 1}]\n"
)

FILES: dict[str, str | bytes] = {
    "empty.yaml": "",
    "list.yaml": "- 1\n- 2\n",
    "scalar.yaml": "42\n",
    "tab.yaml": "toe:\n\tmass: 1\n",
    "open.yaml": "toe: {mass: 1\n",
    "twice.yaml": "toe: {mass: {value: 0.1, label: assumed, source: a}}\ntoe: {}\n",
    "binary.yaml": bytes(range(256)),
    "python.yaml": "!!python/object/apply:os.system ['true']\n",
    "alias.yaml": "a: &a [*a]\n",
    "unknown_field.yaml": f"toe: {{mas: {VALUE.format(1)}}}\n",
    "unknown_section.yaml": f"tail: {{mass: {VALUE.format(1)}}}\n",
    "text.yaml": f"toe: {{mass: {VALUE.format('heavy')}}}\n",
    "nan.yaml": f"toe: {{mass: {VALUE.format('.nan')}}}\n",
    "inf.yaml": f"toe: {{mass: {VALUE.format('.inf')}}}\n",
    "negative.yaml": f"toe: {{mass: {VALUE.format(-1)}}}\n",
    "zero_length.yaml": f"shank: {{length: {VALUE.format(0)}}}\n",
    "degrees.yaml": f"toe: {{length: {VALUE.format(55)}}}\n",
    "label.yaml": "toe: {mass: {value: 0.2, label: guessed, source: test}}\n",
    "short_vector.yaml": f"foot: {{com: {VALUE.format('[0, 0]')}}}\n",
    "motor.yaml": f"actuators: {{knee: {{motor: {VALUE.format('RI700')}}}}}\n",
    "base.yaml": "base: no_such_design\n",
    "empty.urdf": "",
    "text.urdf": "a robot\n",
    "open.urdf": '<robot name="a"><link name="b">',
    "not_robot.urdf": "<mujoco/>",
    "no_links.urdf": '<robot name="a"/>',
    "two_roots.urdf": '<robot name="a"><link name="b"/><link name="c"/></robot>',
    "same_link.urdf": '<robot name="a"><link name="b"/><link name="b"/></robot>',
    "orphan.urdf": '<robot name="a"><link name="b"/><joint name="j" type="revolute">'
    '<parent link="b"/><child link="x"/><axis xyz="0 0 1"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>',
    "loop.urdf": '<robot name="a"><link name="b"/><link name="c"/>'
    '<joint name="j" type="fixed"><parent link="b"/><child link="c"/></joint>'
    '<joint name="k" type="fixed"><parent link="c"/><child link="b"/></joint></robot>',
    "mesh.urdf": '<robot name="a"><link name="b"><visual><geometry>'
    '<mesh filename="no/such.stl"/></geometry></visual></link></robot>',
    "entity.urdf": '<!DOCTYPE r [<!ENTITY e SYSTEM "file:///etc/passwd">]>'
    '<robot name="a"><link name="&e;"/></robot>',
    "empty.xml": "",
    "text.xml": "a model\n",
    "open.xml": "<mujoco><worldbody>",
    "element.xml": "<mujoco><world/></mujoco>",
    "massless.xml": '<mujoco><worldbody><body><joint/><geom size="0.1" mass="0"/></body>'
    "</worldbody></mujoco>",
    "log.csv": "a,b\n1,2\n",
    "empty.csv": "",
    "one_row.csv": "time,position/knee\n0.0,1.0\n",
    "text.csv": "time,position/knee\n" + "".join(f"{i / 100},x\n" for i in range(50)),
    "no_time.csv": "position/knee\n" + "1.0\n" * 50,
    "back.csv": "time,position/knee\n" + "".join(f"{-i / 100},0\n" for i in range(50)),
    "misspelt.csv": "time,positon/knee\n" + "".join(f"{i / 100},0\n" for i in range(50)),
    "still_clock.csv": "time,position/knee\n" + "0.0,0.0\n" * 50,
    "garbage.parquet": b"PAR1 garbage PAR1",
    "garbage.mcap": b"\x89MCAP0\r\n garbage",
    "garbage.pt": b"garbage",
    "broken.json": "{",
    "other.json": "[1, 2]",
    "garbage.db3": b"SQLite format 3\x00 garbage",
    "garbage.onnx": b"garbage",
    "empty.onnx": b"",
    "diagnosis_empty.json": "{}",
    "diagnosis_schema.json": json.dumps({"schema": 99, "causes": []}),
    "diagnosis_none.json": json.dumps(
        {"schema": 1, "verdict": "none", "gap": {"closed": 0.0}, "causes": []}
    ),
    "overlay_effect.yaml": "schema: 1\neffects:\n- {effect: gremlins, location: knee}\n",
    "overlay_empty.yaml": "schema: 1\n",
    "protocol.yaml": "kind: swim\n",
    "campaign.yaml": "name: x\n",
    "sweep.yaml": "base: hyperleg\naxes: []\n",
    "notes.txt": "not a robot",
    **{
        f"sweep_{name}.yaml": f"design: hyperleg\naxes: {{toe.mass: {axis}}}\n"
        for name, axis in {
            "good": "{low: 0.1, high: 0.5, steps: 3}",
            "nan": "{low: .nan, high: 0.5, steps: 3}",
            "reversed": "{low: 0.5, high: 0.1, steps: 3}",
            "huge": "{low: 0.1, high: 0.5, steps: 1000000000}",
            "part": "{low: 0.1, high: 0.5, steps: 2.5}",
            "none": "{values: []}",
            "log": "{low: -0.1, high: 0.5, steps: 3, log: true}",
        }.items()
    },
    "sweep_tab.yaml": "design: hyperleg\naxes:\n\ttoe.mass: 3\n",
    "sweep_latin.yaml": "name: caf\xe9\n".encode("latin-1"),
    "sweep_design.yaml": "design: hyperlegs\naxes: {toe.mass: {values: [0.1]}}\n",
    **{
        f"walk_{name}.yaml": "kind: walk\n" + line
        for name, line in {
            "none": "trials: 0",
            "many": "trials: 100000000",
            "nan": "distance: .nan",
            "unknown": "speeed: 1",
            "wide": "start: {tilt: wide}",
        }.items()
    },
    "course.yaml": "kind: t_test\npoints: {A: [0, 0]}\norder: [A, Q]\n",
    "campaign_task.yaml": CAMPAIGN.replace("walk_upright", "walk_uprigth"),
    "campaign_design.yaml": CAMPAIGN.replace("[toe]", "[teo]"),
    "campaign_seeds.yaml": CAMPAIGN.replace("seeds: 1", "seeds: 0"),
    "ranges.yaml": "pool: 8\nranges: {toe.mass: {low: 0.5, high: 0.1}}\n",
}
"""Files that every case finds in its working directory."""

OTHER = ("base", "overlay", "sweep", "walk", "course", "campaign_", "ranges")
"""How names of files begin that are no broken designs."""
DESIGN_FILES = [name for name in FILES if name.endswith(".yaml") and not name.startswith(OTHER)]
ROBOT_FILES = [name for name in FILES if name.endswith((".urdf", ".xml"))]
LOG_FILES = [
    name for name in FILES if name.endswith((".csv", ".parquet", ".mcap", ".pt", ".db3", ".json"))
]

CASES: list[tuple[tuple[str, ...], tuple[str, ...]]] = [
    # the words themselves
    (("analyse",), ("analyse", "analyze")),
    (("--verion",), ("--verion",)),
    (("gap", "diagnos", *OUT), ("diagnos",)),
    (("analyze", "--desing", "toe"), ("--desing",)),
    (("analyze", "toe"), ("toe",)),
    (("analyze", "--set"), ("--set",)),
    (("build",), ("--out",)),
    (("check",), ("files",)),
    (("sweep", "run", "toe_mass"), ("--out",)),
    (("sweep", "walk", "toe_mass", *OUT), ("walk", "run")),
    (("campaign", "start"), ("start", "status")),
    (("list", "robots"), ("robots", "designs")),
    (("video", "walk_upright-toe-0"), ("--out",)),
    (("video", "walk_upright-toe-0", "--out", "a.webm"), ("--out", ".mp4")),
    (("view", "toe", "mini_cheetah", "hyperleg", "--once"), ("one design or two",)),
    (("view", "nosuch", "--once"), ("nosuch",)),
    (("gap", "score"), ("Folder of the trial",)),
    (("gap", "excite", *OUT), ("--robot",)),
    (("gap", "show"), ("effect",)),
    (("gap", "diagnose", *OUT), ("--logs",)),
    # numbers out of range or no numbers
    (("train", "--threads", "0", *OUT), ("--threads", "0", "1")),
    (("train", "--threads", "two", *OUT), ("--threads", "two")),
    (("train", "--threads", "1.5", *OUT), ("--threads", "1.5")),
    (("train", "--seed", "-1", *OUT), ("--seed", "-1", "0")),
    (("train", "--seed", "", *OUT), ("--seed",)),
    (("evaluate", "garbage.onnx", "--workers", "0", *OUT), ("--workers", "0")),
    (("evaluate", "garbage.onnx", "--workers", "-2", *OUT), ("--workers", "-2")),
    (("paper", "--workers", "0", *OUT), ("--workers", "0")),
    (("video", "walk_upright-toe-0", "--seed", "-3", "--out", "a.gif"), ("--seed", "-3")),
    (("gap", "diagnose", "--logs", "log.csv", "--threads", "0", *OUT), ("--threads", "0")),
    (("gap", "diagnose", "--logs", "log.csv", "--seed", "-1", *OUT), ("--seed", "-1")),
    (("gap", "excite", "--robot", "toe", "--rate", "0", *OUT), ("--rate", "0")),
    (("gap", "excite", "--robot", "toe", "--rate", "-5", *OUT), ("--rate", "-5")),
    (("gap", "excite", "--robot", "toe", "--rate", "nan", *OUT), ("--rate", "nan")),
    (("gap", "excite", "--robot", "toe", "--rate", "inf", *OUT), ("--rate", "inf")),
    (("gap", "excite", "--robot", "toe", "--base", "floating", *OUT), ("floating", "fixed")),
    (("gap", "excite", "--robot", "toe", "--format", "xlsx", *OUT), ("xlsx", "csv")),
    (("gap", "blind", "--cases", "0", "--seed", "1", *OUT), ("--cases", "0")),
    (("gap", "blind", "--seed", "-1", *OUT), ("--seed", "-1")),
    (("gap", "blind", "--seed", "1", "--workers", "0", *OUT), ("--workers", "0")),
    (("gap", "blind", "--seed", "1", "--plants", "moon", *OUT), ("moon",)),
    (("gap", "baselines", "x", "--budget", "0"), ("--budget", "0")),
    # overrides of a design
    (("analyze", "--set", "toe.mas=0.3"), ("toe.mas", "toe.mass")),
    (("analyze", "--set", "toe.mass"), ("toe.mass", "path=value")),
    (("analyze", "--set", "toe.mass="), ("toe.mass",)),
    (("analyze", "--set", "=0.3"), ("0.3",)),
    (("analyze", "--set", "toe=0.3"), ("toe",)),
    (("analyze", "--set", "actuators.*.gears=7"), ("actuators.*.gears", "7")),
    (("build", "--set", "*.mass=-1", *OUT), ("pelvis.mass", "-1", "kg")),
    (("analyze", "--set", "toe.mass=300"), ("toe.mass", "300", "kg")),
    (("analyze", "--set", "toe.mass=-0.1"), ("toe.mass", "-0.1", "kg")),
    (("analyze", "--set", "toe.mass=nan"), ("toe.mass", "nan")),
    (("analyze", "--set", "toe.mass=heavy"), ("toe.mass", "heavy")),
    (("analyze", "--set", "toe.mass=[1, 2]"), ("toe.mass",)),
    (("analyze", "--set", "toe.mass={a: 1}"), ("toe.mass",)),
    (("analyze", "--set", "toe.mass=9" + "9" * 5000), ("toe.mass",)),
    (("analyze", "--set", "foot.com=[0, 0]"), ("foot.com",)),
    (("analyze", "--set", "shank.length=380"), ("shank.length", "380")),
    (("analyze", "--set", "actuators.knee.motor=RI700"), ("RI700", "RI70")),
    (("analyze", "--set", "actuators.knee.gear=0"), ("actuators.knee.gear", "0")),
    (("analyze", "--set", "transmission.posture=sitting"), ("sitting", "standing")),
    (("analyze", "--variant", "no_toe"), ("no_toe", "toe_removed")),
    (("analyze", "--variant", "toe_removed", "--set", "toe.mass=0.3"), ("toe.mass",)),
    (("analyze", "--design", "hyperlegs"), ("hyperlegs", "hyperleg")),
    (("analyze", "--design", ""), ("no such file",)),
    (("analyze", "--design", "notes.txt"), ("notes.txt",)),
    (("analyze", "--design", "."), (".",)),
    (("analyze", "--design", "base.yaml"), ("no_such_design",)),
    (("analyze", "--set-file", "none.yaml"), ("none.yaml",)),
    (("build", "--set", "toe.mas=0.3", *OUT), ("toe.mas", "toe.mass")),
    (("build", "--out", "notes.txt"), ("notes.txt",)),
    (("build", "--out", "."), ("empty",)),
    (("compare", "hyperlegs"), ("hyperlegs",)),
    (("compare", "toe", "--set", "toe.mas=1"), ("toe.mas",)),
    # verbs that read a file of their own
    (("check", "no/such/file.urdf"), ("no/such/file.urdf",)),
    (("check", "notes.txt"), ("notes.txt",)),
    (("check", "."), (".",)),
    (("sweep", "run", "no_sweep", *OUT), ("no_sweep", "toe_mass")),
    (("sweep", "run", "sweep.yaml", *OUT), ("sweep.yaml",)),
    (("sweep", "run", "empty.yaml", *OUT), ("empty.yaml",)),
    (("sweep", "run", "list.yaml", *OUT), ("list.yaml",)),
    (("sweep", "run", "binary.yaml", *OUT), ("binary.yaml",)),
    (("sweep", "run", "toe_mass", "--out", "notes.txt"), ("notes.txt",)),
    (("study", "--policies", "none", *OUT), ("none", "no such folder")),
    (("study", "--out", "notes.txt"), ("notes.txt",)),
    (("paper", "--policies", "none", *OUT), ("none", "no such folder")),
    (("campaign", "status", "no_campaign"), ("no_campaign", "campaign")),
    (("campaign", "status", "campaign.yaml"), ("campaign.yaml",)),
    (("campaign", "status", "empty.yaml"), ("empty.yaml",)),
    (("campaign", "pack", "--from", "none", "--to", "p"), ("none", "no such folder")),
    (("campaign", "pack", "--from", ".", "--to", "p"), ("no training",)),
    (("train", "--overlay", "none.yaml", *OUT), ("none.yaml",)),
    (("train", "--overlay", "overlay_effect.yaml", *OUT), ("gremlins",)),
    (("train", "--overlay", "overlay_empty.yaml", *OUT), ("overlay_empty.yaml",)),
    (("evaluate", *OUT), ("ONNX",)),
    (("evaluate", "none.onnx", *OUT), ("none.onnx",)),
    (("evaluate", "garbage.onnx", *OUT), ("garbage.onnx",)),
    (("evaluate", "empty.onnx", *OUT), ("empty.onnx",)),
    (("evaluate", "garbage.onnx", "--overlay", "none.yaml", *OUT), ("none.yaml",)),
    (
        ("evaluate", "walk_upright-toe-0", "walk_upright-toe-0", *OUT),
        ("same policy", "counts once"),
    ),
    (("evaluate", "walk_upright-toe-0", "--protocol", "swim", *OUT), ("swim",)),
    (
        ("evaluate", "walk_upright-toe-0", "--swap", "toe_motor_to_ankle", *OUT),
        ("toe_removed_matched",),
    ),
    (("evaluate", "walk_upright-toe-0", "--protocol", "protocol.yaml", *OUT), ("protocol.yaml",)),
    (("evaluate", "garbage.onnx", "--out", "notes.txt"), ("notes.txt",)),
    (("video", "none.onnx", "--out", "a.gif"), ("none.onnx", "walk_upright-toe-0")),
    (("video", "garbage.onnx", "--out", "a.gif"), ("garbage.onnx",)),
    # files of sweeps, protocols, campaigns and ranges, and what a search and a viewer are asked for
    *[
        (("sweep", "run", f"sweep_{name}.yaml", *OUT), (f"sweep_{name}.yaml", word))
        for name, word in {
            "nan": "axes.toe.mass.low = nan",
            "reversed": "must lie below high",
            "huge": "1000000000",
            "part": "whole number",
            "none": "at least one value",
            "log": "must be positive",
            "tab": "a tab",
            "latin": "UTF-8",
            "design": "design = 'hyperlegs'",
        }.items()
    ],
    *[
        (("evaluate", POLICY, "--protocol", f"walk_{name}.yaml", *OUT), (f"walk_{name}.yaml", word))
        for name, word in {
            "none": "trials = 0",
            "many": "4096",
            "nan": "distance = nan",
            "unknown": "did you mean speed?",
            "wide": "start.tilt = 'wide'",
        }.items()
    ],
    (("evaluate", POLICY, "--protocol", "course.yaml", *OUT), ("course.yaml", "'Q'")),
    *[
        (("campaign", "status", f"campaign_{name}.yaml"), (f"campaign_{name}.yaml", word))
        for name, word in {
            "task": "groups.0.task = 'walk_uprigth'",
            "design": "groups.0.designs = 'teo'",
            "seeds": "groups.0.seeds = 0",
        }.items()
    ],
    (("campaign", "status", "elsewhere"), ("campaign_t_test",)),
    (("variants", POLICY, "--designs", "ranges.yaml", *OUT), ("ranges.yaml", "low < high")),
    *[
        ((*SEARCH, "--storage", url, *OUT), (url,))
        for url in ("mysql://host", "no_url", "sqlite:///no/such/folder/x.db")
    ],
    (
        (*SEARCH, "--constraint", "leg_mass<<3", *OUT),
        ("leg_mass<<3", "MEASURE<=NUMBER"),
    ),
    (("view", "toe", "--once", "--port", "99999"), ("--port = 99999", "65535")),
    (("view", "toe", "--once", "--host", "no host"), ("no host",)),
    (("view", "toe", "--once", "--policy", "walk_upright-toe-99"), ("walk_upright-toe-99",)),
    (
        ("video", POLICY, "--size", "100000", "100000", "--out", "a.gif"),
        ("--size", "100000", "4096"),
    ),
    (("video", POLICY, "--duration", "nan", "--out", "a.gif"), ("--duration = nan",)),
    # folders in place of files, and places below files
    (("analyze", "--design", "folder.yaml"), ("folder.yaml", "is a folder")),
    (("evaluate", POLICY, "--protocol", "folder.yaml", *OUT), ("folder.yaml", "is a folder")),
    (("evaluate", "folder.yaml", *OUT), ("folder.yaml", "without policy.onnx")),
    (("paper", "--policies", "folder.yaml", *OUT), ("folder.yaml", "no finished training")),
    (("variants", "walk_any-mini_cheetah-0", *OUT), ("toe layouts, not mini_cheetah", "--designs")),
    (("analyze", "--out", "notes.txt/page"), ("notes.txt", "is a file")),
    (("evaluate", POLICY, "--logs", "notes.txt/logs", *OUT), ("notes.txt", "is a file")),
    # the gap's verbs
    (("gap", "show", "viscuous_friction", *OUT), ("viscous_friction",)),
    (("gap", "show", "viscous_friction", "--set", "damp=1", *OUT), ("damp",)),
    (("gap", "show", "viscous_friction", "--set", "damping=much", *OUT), ("damping", "much")),
    (("gap", "show", "viscous_friction", "--location", "tail", *OUT), ("tail",)),
    (("gap", "apply", "none.json"), ("none.json",)),
    (("gap", "apply", "notes.txt"), ("notes.txt",)),
    (("gap", "apply", "broken.json"), ("broken.json",)),
    (("gap", "apply", "other.json"), ("other.json",)),
    (("gap", "apply", "diagnosis_empty.json"), ("diagnosis_empty.json",)),
    (("gap", "apply", "diagnosis_schema.json"), ("schema 1",)),
    (("gap", "apply", "diagnosis_none.json"), ("diagnosis_none.json",)),
    (("gap", "apply", "overlay_effect.yaml"), ("gremlins",)),
    (("gap", "score", "none"), ("none",)),
    (("validate", "--data", "none", "--only", "go2", *OUT), ("none",)),
    (("validate", "--checkout", "none", "--only", "go2", *OUT), ("none", "hyperleg_design")),
    (("validate", "--suites", "dreams", *OUT), ("dreams", "newcomers")),
    (("gap", "baselines", "none"), ("none",)),
    (("gap", "measure", "--logs", "none.parquet"), ("none.parquet",)),
    (("gap", "diagnose", "--logs", "none.parquet", *OUT), ("none.parquet",)),
    (("gap", "excite", "--robot", "none.xml", *OUT), ("none.xml",)),
    *[(("analyze", "--design", name), (name,)) for name in DESIGN_FILES],
    *[(("analyze", "--set-file", name), (name,)) for name in DESIGN_FILES],
    *[(("check", name), (name,)) for name in (*DESIGN_FILES, *ROBOT_FILES)],
    *[
        (("gap", "excite", "--robot", name, "--out", "out"), (name,))
        for name in ROBOT_FILES
        if name not in ("mesh.urdf", "massless.xml")
    ],
    (("gap", "check", "misspelt.csv"), ("positon/knee", "did you mean position/knee?")),
    *[(("gap", "check", name), (name,)) for name in LOG_FILES],
    *[(("gap", "diagnose", "--robot", "toe", "--logs", name, *OUT), (name,)) for name in LOG_FILES],
]
"""Arguments, and words that the error must hold."""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all of `FILES`."""
    folder = tmp_path_factory.mktemp("broken")
    for name, content in FILES.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    (folder / "folder.yaml").mkdir()
    return folder


def contents(folder: Path) -> dict[str, Any]:
    return {str(p.relative_to(folder)): p.is_file() and p.read_bytes() for p in folder.rglob("*")}


@pytest.mark.parametrize(("arguments", "words"), CASES, ids=lambda value: " ".join(value)[:70])
def test_broken_input_is_one_line_and_writes_nothing(
    place, capfd, monkeypatch, arguments: tuple[str, ...], words: tuple[str, ...]
):
    monkeypatch.chdir(place)
    before = contents(place)
    code = cli.main(list(arguments))
    out, err = capfd.readouterr()
    assert code == 2
    if arguments[0] == "check" or arguments[:2] == ("gap", "check"):  # these print their findings
        text = out + err
    else:
        text = err
        assert out == ""
        assert err.startswith("hyperleg: ")
        assert len(err.splitlines()) == 1
    for word in words:
        assert word in text
    assert "Traceback" not in text
    assert contents(place) == before
