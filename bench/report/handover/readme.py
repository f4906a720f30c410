"""README.md of a robot folder that a diagnosis hands over."""

from collections.abc import Sequence

import numpy as np

from bench.robot.figures import Figures
from bench.robot.folder import Robot

# The issue asks for 1e-6; what a search for balances from another start leaves lies far below (tests/report/handover).
AGREES = 1e-6


def readme_of(robot: Robot, figures: Figures, missing: Sequence[str], disagreement: float, recording: str = "") -> str:
    """Return the README.

    Args:
        robot: Nominal.
        figures: Of the new robot.
        missing: What it lacks of the fit.
        disagreement: As in `Handed`.
        recording: Of several recordings, the last; "": there is one.
    """
    lines = [
        f"# {figures.title}",
        "",
        f"Written by `bench diagnose`, from the robot folder `{robot.name}` and a measured campaign. Every command",
        "takes this folder as a robot. Every figure that was fitted stands in `../figures.csv` with its interval:",
        "`found` is what this robot has, `stated` the robot of the first diagnosis, `earlier` that of `--given`. A row",
        '"in recording x" is what that recording has of its own, on top of the row without it. The',
        "uncertainties in `figures.yaml` are those that were stated, not what is left after this campaign. Where the",
        f"nominal numbers come from: README of `{robot.name}`.",
        "",
        f"- `{figures.mjcf}`: findings and fitted deviations of the model. `patch nominal.xml robot.diff` in the",
        "  folder above makes it of the nominal one, as MuJoCo writes that.",
        "- `figures.yaml`: fitted torque constants in `drives`; under `fitted` errors of readings and weights, and",
        "  effects that no MJCF holds. A replay (`bench diagnose`) has all of it. A simulation (`bench run`,",
        "  gymnasium) has `readings` in its instruments, and neither `weights` nor `effects`. `bench identify` has the",
        "  torque constants.",
        "- `promises.json`: within what this model will err on the next recording (`bench predict`). `posterior.json`:",
        "  what is known of figures and findings, together (`bench diagnose --given` and the folder above).",
        "- `bench apply` on the folder above writes URDF and feed-forward torques; what else:",
        "  the page bench/report/handover/README.md of the bench.",
        "- Left out: how much of its friction each joint held at rest. That belongs to the campaign.",
    ]
    if recording:
        lines += [
            f"- What belongs to one recording alone (payload, zeros of encoders, frame of the tracker) is that of the "
            f"last one, `{recording}`. Of what drifts from day",
            "  to day (friction, torque constants, offsets, temperature of the gas) it has the mean of all days. "
            "`../figures.csv` has it",
            "  of every recording.",
        ]
    if np.isnan(disagreement):
        lines.append("- Not held against the fit: from scratch, this model finds no balance along the campaign.")
    elif disagreement > AGREES:
        lines.append(
            f"- **It differs from what was fitted** by up to {disagreement:.1g} of a channel's largest reading."
        )
    else:
        lines.append(f"- It predicts what was fitted, to {disagreement:.1g} of a channel's largest reading.")
    if missing:
        lines += ["", "## What is missing", "", *(f"- {words}." for words in missing)]
    return "\n".join(lines) + "\n"
