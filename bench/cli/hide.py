"""`bench hide`: a campaign with a hidden effect."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Hide:
    """Make a campaign in which effects are hidden, and apart from it the truth: something to try a diagnosis on.

    An effect is NAME[@PLACE][:PARAMETER][=VALUE], such as coulomb_level@2=0.2: a fifth more, at joint 2. A place may be
    a channel or a run, hung_load@loading=-0.5, and what sets in with a run has that too: channel_step@current_2_a@line.
    `bench effects` lists names, parameters and ranges. Values are in SI units; 0.02 of a relative quantity is 2 %.
    Without a parameter the first is meant, without a value a typical one.
    """

    effects: tyro.conf.Positional[tuple[str, ...]]
    """Effects to hide; none with --none."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """Folder to write; must not exist yet."""
    joint: int | None = None
    """Number of the joint, from 1, for effects that are named without a place."""
    seed: int = 0
    """Of noise, instruments and background errors."""
    machine: int | None = None
    """Seed of the machine itself, its figures and torque constants: recordings with the same one are of one machine
    (bench compare), each with friction, air and a set-up of its day. Viscous friction differs by 15 % from day to day,
    and the air by 5 K, with gas as warm; a diagnosis of one recording may find that. By default the machine comes with
    --seed, and there is no other day."""
    scenario: str = "session-short"
    """Name of a scenario that comes along, or path to a scenario file."""
    none: bool = False
    """Hide nothing: null data, in which all is nominal but for small background errors."""
    without: tuple[str, ...] = ()
    """Instruments (tracker, force, current, ...), channels (gear_temperature, ...) and parts of the session (line,
    dwell, ...) that the lab does not have."""
    channels: tuple[str, ...] = ()
    """Further channels that it has: gas_temperature."""
    parquet: bool = False
    """Write tables as Parquet instead of CSV."""

    def run(self) -> int:
        """Make and write the campaign; return the exit code."""
        import numpy as np

        from bench.cli.heeded import expect_idle
        from bench.cli.seeds import checked_seed
        from bench.effects.catalogue import catalogue
        from bench.errors import InputError, RobotError
        from bench.hide.campaign import hide_campaign
        from bench.hide.recorded import recorded_of
        from bench.hide.request import effects_of
        from bench.hide.write import CAMPAIGN, TRUTH, write_hidden
        from bench.record.folder import new_folder
        from bench.record.truth import expect_apart
        from bench.robot.compiled import compile_robot
        from bench.robot.folder import load_robot
        from bench.scenario.complementary import Complementary
        from bench.scenario.files import read_scenario, said_of

        rng = np.random.default_rng(checked_seed(self.seed))
        machine = None if self.machine is None else np.random.default_rng(checked_seed(self.machine, "--machine"))
        if bool(self.effects) == self.none:
            raise InputError("name an effect to hide, or give --none for data without one; not both.")
        if all("@" in effect for effect in self.effects):
            expect_idle({f"--joint {self.joint}": self.joint is not None}, "no effect is named without a place")
        session = read_scenario(self.scenario)
        if isinstance(session, Complementary):
            raise InputError(f"{self.scenario}: is no experiment on the robot; take a session, such as session-short.")
        with said_of(self.scenario):
            robot = load_robot(session.robot)
            recorded = recorded_of(robot, session, self.without, self.channels)
        acting = effects_of(self.effects, compile_robot(robot), catalogue(), self.joint, recorded)
        expect_apart(self.out)
        with new_folder(self.out, CAMPAIGN, replace=False) as folder:
            try:
                hidden = hide_campaign(
                    robot,
                    session,
                    acting,
                    rng,
                    without=self.without,
                    channels=self.channels,
                    machine=machine,
                )
            except RobotError as error:  # the robot was sound before
                raise InputError(f"no robot can be simulated with {', '.join(self.effects)}: {error}") from error
            write_hidden(hidden, folder, "parquet" if self.parquet else "csv")
        for one in acting:
            print(f"hidden     {one}")
        print(f"campaign   {self.out / CAMPAIGN}")
        print(f"truth      {self.out / TRUTH}")
        return 0
