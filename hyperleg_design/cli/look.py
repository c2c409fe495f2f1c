"""Verbs that show: view, video; no logic of their own."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from hyperleg_design.cli.arguments import AtLeast
from hyperleg_design.cli.output import Printing, emit
from hyperleg_design.errors import InputError
from hyperleg_design.robot.load import load_robot


@dataclass(frozen=True, kw_only=True)
class View(Printing):
    """Open a page in the browser: the robot in 3-D, sliders, masses, envelopes, recorded walks."""

    designs: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    """One or two shipped names or YAML files; what was recorded, else hyperleg, by default."""
    variant: str = ""
    """Ablation to make of all designs: toe, toe_locked, toe_removed_matched, toe_removed or
    toe_passive."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PATH=VALUE, applied to all designs."""
    recording: Path | None = None
    """Parquet log of a walk to play, such as evaluate --logs writes."""
    policy: str = ""
    """ONNX file or name of a shipped training; one trial of it is simulated and played."""
    seed: Annotated[int | None, AtLeast(0)] = None
    """Seed of the policy's starting state; the protocol's by default."""
    host: str = "localhost"
    """Address to listen on; 0.0.0.0 lets other machines in."""
    port: Annotated[int, AtLeast(1)] = 8080
    """Port to listen on."""
    dark: bool = False
    """Begin with the dark scheme."""
    once: bool = False
    """Build the page, and end instead of serving it."""

    def run(self) -> None:
        """Build the page and serve it until the user stops it.

        Raises:
            InputError: both a recording and a policy, or a port or design that cannot be used.
        """
        from hyperleg_design.report.viewer import needs, viewer
        from hyperleg_design.report.viewer.walk import walk_of_file, walk_of_policy

        if self.recording and self.policy:
            raise InputError("view", "--policy", self.policy, "leave it out or --recording")
        needs.check_installed()
        needs.check_port(self.host, self.port)
        designs = [
            load_robot(name, overrides=self.set, variant=self.variant or None)
            for name in self.designs
        ]
        first = designs[0] if designs else None
        walk = None
        if self.recording:
            walk = walk_of_file(self.recording, first)
        elif self.policy:
            walk = walk_of_policy(self.policy, first, seed=self.seed)
        if not designs:
            designs = [load_robot(overrides=self.set) if walk is None else walk.design]
        labels = list(self.designs) or [designs[0].name]
        if len(set(labels)) < len(labels):
            labels = [f"{label} ({i})" for i, label in enumerate(labels, 1)]
        page = viewer.Viewer(
            dict(zip(labels, designs, strict=True)),
            walk,
            host=self.host,
            port=self.port,
            dark=self.dark,
        )
        if self.json:
            emit({"url": page.url, "designs": labels, "walk": walk and walk.caption})
        else:
            print(f"open {page.url}" + ("" if self.once else "; Ctrl-C to stop"), flush=True)
        if self.once:
            page.close()
            return
        try:
            page.wait()
        except KeyboardInterrupt:
            print("stopped", file=sys.stderr)


@dataclass(frozen=True, kw_only=True)
class Video(Printing):
    """Write a walk as an MP4 or GIF file: one trial of a policy, or a recording."""

    source: Annotated[str, tyro.conf.Positional]
    """ONNX file, name of a shipped training such as walk_upright-toe-1, or a recording
    (.parquet)."""
    out: Path
    """File to write, .mp4 or .gif."""
    design: str = ""
    """Robot to run the policy on, or that was recorded; the policy's or the recording's own by
    default."""
    set: tyro.conf.UseAppendAction[tuple[str, ...]] = ()
    """PATH=VALUE, such as toe.mass=0.3; needs --design."""
    protocol: str = ""
    """walk, t_test, or a YAML file; what suits the policy's task by default."""
    seed: Annotated[int | None, AtLeast(0)] = None
    """Seed of the policy's starting state; the protocol's by default."""
    begin: Annotated[float, AtLeast(0)] = 0.0
    """First time shown [s], or as much earlier as the walk is too short for begin and duration."""
    duration: Annotated[float, AtLeast(0, exclusive=True)] = 10.0
    """Length of the part of a walk that is shown [s]; a T-test is shown whole."""
    size: tuple[int, int] = (800, 640)
    """Width and height [px]."""
    fps: Annotated[float, AtLeast(1)] = 25.0
    """Frames a second."""

    def run(self) -> None:
        """Simulate where needed, draw the frames, and write the video.

        Raises:
            InputError: options that do not fit the source.
        """
        from hyperleg_design.evaluation.protocol import TTestProtocol
        from hyperleg_design.report.pictures.motion import t_test_motion, walk_motion
        from hyperleg_design.report.pictures.replay import replay
        from hyperleg_design.report.pictures.video import check_video, write_video
        from hyperleg_design.report.viewer.walk import walk_of_file

        check_video(self.out, self.size)
        if self.set and not self.design:
            raise InputError("video", "--set", list(self.set), "needs --design")
        design = load_robot(self.design, overrides=self.set) if self.design else None
        look: dict[str, Any] = {"frames_per_second": self.fps, "size": self.size}
        part: dict[str, Any] = {"begin": self.begin, "duration": self.duration}
        if self.source.endswith(".parquet"):
            walk = walk_of_file(self.source, design)
            caption, motion = walk.caption, walk_motion(walk.moving(self.fps), **look, **part)
        else:
            shown = replay(self.source, self.protocol or None, seed=self.seed, design=design)
            trial, outcome = shown.trials[0], shown.outcomes[0].replace("_", " ")
            caption = f"{shown.policy}: {outcome} after {shown.end_times[0]:.2f} s"
            if isinstance(shown.protocol, TTestProtocol):
                motion = t_test_motion(trial, shown.protocol, most_frames=100_000, **look)
            else:
                motion = walk_motion(trial, **part, **look)
        path = write_video(motion, self.out, progress=not self.json)
        self.tell(
            {"file": str(path), "frames": len(motion.focus), "shows": caption},
            f"{caption}\nwritten to {path}",
        )
