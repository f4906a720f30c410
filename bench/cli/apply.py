"""`bench apply`: a robot for other programs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Apply:
    """Write a robot for other programs: URDF with fitted inertials, and feed-forward torques along a motion.

    What else to do with the result of a diagnosis: bench/report/handover/README.md.
    """

    robot: tyro.conf.Positional[str]
    """Folder of a diagnosis, which stands for the robot that it handed over; or a robot folder or name."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """Folder to write; must not exist yet."""
    motion: Path | None = None
    """CSV file of a motion to command: time_s, q_cmd_i_rad of each drive i, and if known velocity_i, acceleration_i."""
    payload_kg: float = 0.0
    """Mass that is bolted to the load point [kg]."""

    def run(self) -> int:
        """Write, and print where; return the exit code."""
        import sys
        from math import isfinite

        from bench.errors import InputError
        from bench.record.folder import new_folder
        from bench.record.possible import MAX_MASS
        from bench.record.units import STANDARD_GRAVITY
        from bench.report.handover.applied import applied_robot
        from bench.report.handover.apply import DRIVES, README, TORQUES, beyond, summary, urdf_name, write_applied
        from bench.report.handover.feed_forward import feed_forward, read_motion
        from bench.report.handover.motion_faults import gaps
        from bench.report.handover.urdf_gaps import WITHOUT_FRICTION
        from bench.report.joint_campaign import UNFINISHED
        from bench.report.prediction.model import load_model
        from bench.robot.figures import MOST_RATINGS

        if not (isfinite(self.payload_kg) and self.payload_kg >= 0):
            raise InputError(f"--payload-kg {self.payload_kg:g}: must be a mass of 0 or more.")
        robot = load_model(self.robot)
        rated = robot.figures.rating.force_n / STANDARD_GRAVITY
        if self.payload_kg > min(MOST_RATINGS * rated, MAX_MASS):
            raise InputError(
                f"--payload-kg {self.payload_kg:g}: the robot is rated for {rated:.3g} kg; grams? give kg."
            )
        applied = applied_robot(robot, self.payload_kg)
        motion = read_motion(self.motion, applied.compiled) if self.motion else None
        table = feed_forward(applied, motion) if motion is not None else None
        with new_folder(self.out, README, replace=False) as folder:
            write_applied(applied, table, folder)
        if robot.figures.fitted.unfinished:
            print(f"warning  {robot.folder}: {'; '.join(UNFINISHED)}", file=sys.stderr)
        if self.payload_kg > rated:
            print(f"warning  {self.payload_kg:g} kg are more than the {rated:.3g} kg of the rating", file=sys.stderr)
        if applied.is_without_friction:
            print(f"warning  {WITHOUT_FRICTION}", file=sys.stderr)
        if motion is not None and table is not None:
            for words in (*gaps(motion.time, motion.q), *beyond(table, motion, applied)):
                print(f"warning  {words}", file=sys.stderr)
            for line in summary(table, applied.bodies.names):
                print(line)
            print(f"torques    {self.out / TORQUES}")
        print(f"urdf       {self.out / urdf_name(applied.compiled.robot)}   (what it cannot say: {README})")
        print(f"drives     {self.out / DRIVES}")
        return 0
