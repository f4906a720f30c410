"""`bench identify`: joint stiffness, or the dynamics, from campaigns."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from bench.report.dynamics.file_names import DYNAMICS


@dataclass(frozen=True)
class Identify:
    """Identify the joint stiffness from the static runs of a campaign, or the dynamics from the motion runs of some.

    `--method dynamics` finds base inertial parameters, friction, payload and delay by linear regression at full rate,
    with whole runs held out (bench/identify/dynamics/README.md).
    """

    campaign: tyro.conf.Positional[tuple[Path, ...]]
    """Campaign folder (format: bench/record/README.md); for dynamics also several of one machine."""
    method: Literal["current", "force", "force-pose", "force-paper", "joint", "all", "dynamics"] = "all"
    """Method of identification; `all` runs every one for stiffness that the campaign has the channels for."""
    reference: Literal["unloaded", "first-load"] = "unloaded"
    """Stiffness: what the readings of a visit are held against. Among loads that only rise, static friction cancels."""
    weights: Literal["noise", "equal"] = "noise"
    """Stiffness: `equal` is plain least squares, Eqs. (35) and (41); for the methods current and force."""
    level: float | None = None
    """Level of the intervals; by default 0.95 for stiffness, 0.9 for dynamics."""
    robot: str = ""
    """Robot to take, name or folder, such as the one that a diagnosis handed over; by default the campaign names it."""
    held_out: tuple[Path, ...] = ()
    """Dynamics: further campaigns of the machine, which are only predicted."""
    cutoff_hz: float | None = None
    """Dynamics: cut-off of the low-pass that model and data go through; by default ten times the motion's bandwidth."""
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Dynamics: folder to write dynamics.json into; must not exist yet."""
    despite_doubts: bool = False
    """Go on although channels failed plausibility checks; by default that ends in an error."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Identify and print; return the exit code."""
        from bench.cli.heeded import expect_idle
        from bench.errors import InputError

        if not self.campaign:
            raise InputError("name a campaign folder.")
        if self.level is not None and not 0 < self.level < 1:
            raise InputError(f"--level {self.level:g}: must lie between 0 and 1.")
        if self.method == "dynamics":
            stiffness = {"--reference": self.reference != "unloaded", "--weights": self.weights != "noise"}
            expect_idle(stiffness, "is for stiffness, and no part of --method dynamics")
            return self._dynamics(0.9 if self.level is None else self.level)
        if self.weights == "equal" and self.method not in {"current", "force"}:
            raise InputError("--weights equal needs --method current or --method force.")
        if len(self.campaign) > 1 or self.held_out or self.cutoff_hz is not None or self.out:
            raise InputError("several campaigns, --held-out, --cutoff-hz and --out are for --method dynamics.")
        from bench.cli.doubts import heed
        from bench.identify.options import PLAIN, Options
        from bench.report.identification import identify_campaign, print_json, print_table
        from bench.report.joint_campaign import open_checked

        opened = open_checked(self.campaign[0], self.robot)
        heed(opened.warnings, opened.doubts, despite_doubts=self.despite_doubts)
        result = identify_campaign(
            self.campaign[0],
            opened.campaign,
            opened.compiled,
            None if self.method == "all" else [self.method],
            PLAIN if self.weights == "equal" else Options(),
            among_loaded=self.reference == "first-load",
        )
        (print_json if self.json else print_table)(result, 0.95 if self.level is None else self.level)
        return 0

    def _dynamics(self, level: float) -> int:
        import json
        from contextlib import ExitStack

        from bench.cli.doubts import heed
        from bench.record.folder import new_folder
        from bench.report.dynamics.as_json import as_json
        from bench.report.dynamics.identify import identify_dynamics, open_recordings
        from bench.report.dynamics.text import print_dynamics

        with ExitStack() as stack:  # a place where nothing can be written is refused before the work
            folder = stack.enter_context(new_folder(self.out, DYNAMICS, replace=False)) if self.out else None
            recordings = open_recordings(self.campaign, self.held_out, self.robot)
            heed(recordings.warnings, recordings.doubts, despite_doubts=self.despite_doubts)
            result = identify_dynamics(recordings, self.cutoff_hz)
            content = json.dumps(as_json(result, level), indent=2)
            if folder:
                (folder / DYNAMICS).write_text(content + "\n", encoding="utf-8")
        if self.json:
            print(content)
        else:
            print_dynamics(result, level)
            if self.out is not None:
                print(f"written  {self.out / DYNAMICS}")
        return 0
