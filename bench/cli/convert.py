"""`bench convert`: a campaign from a laboratory's own logs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Convert:
    """Make a campaign of logs as the `log.yaml` of the robot's folder says, or propose such a file with `--look`.

    A log is text with any separator, Parquet or MCAP (a ROS 2 bag). How it is described, and what is cut out of it,
    says bench/record/logs/README.md.
    """

    robot: tyro.conf.Positional[str] = ""
    """Name of a robot folder, or a path to one."""
    source: tyro.conf.Positional[Path | None] = None
    """A log, or a folder of logs."""
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Campaign folder to write, must not exist yet; with --look the log.yaml to write."""
    log: Path | None = None
    """Another file in place of `log.yaml` of the robot's folder."""
    window_s: tuple[float, float] | None = None
    """Only this, FROM TO in seconds after the first row of each log; in place of `runs: windows_s`."""
    parquet: bool = False
    """Write tables as Parquet instead of CSV."""
    look: Path | None = None
    """Propose a log.yaml for this log: what its columns seem to be, each guess with its reason. Converts nothing."""
    of: Annotated[str, tyro.conf.arg(name="robot")] = ""
    """With --look: the robot that moved; units, signs, gear ratios and delays are then held against its model."""
    topic: str = ""
    """With --look: topic of an MCAP recording."""

    def run(self) -> int:
        """Convert or look, and say what was left out; return the exit code."""
        from bench.cli.heeded import expect_idle
        from bench.errors import InputError

        if self.look is not None:
            converting = {
                "LOGS": self.source,
                "--log": self.log,
                "--window-s": self.window_s,
                "--parquet": self.parquet,
            }
            expect_idle(converting, "--look proposes a log.yaml, and converts nothing")
            expect_idle({"ROBOT": self.of and self.robot}, "--robot names another one")
            return self._look(self.look)
        expect_idle({"--robot": self.of, "--topic": self.topic}, "only --look asks for it")
        if not self.robot or self.source is None or self.out is None:
            raise InputError("bench convert ROBOT LOGS -o DIR, or bench convert --look LOG --robot ROBOT.")
        return self._convert(self.source, self.out)

    def _look(self, log: Path) -> int:
        from bench.errors import InputError, printable
        from bench.report.files import refuse_to_overwrite, replacing
        from bench.report.log_look.look import look
        from bench.robot.compiled import compile_robot
        from bench.robot.folder import load_robot
        from bench.robot.nominal_dynamics import nominal_dynamics

        if log.is_dir():
            raise InputError(f"{log}: is a folder; give one of its logs, they are read alike.")
        if self.out is not None:
            refuse_to_overwrite(self.out)
        robot = self.of or self.robot
        nominal = nominal_dynamics(compile_robot(load_robot(robot))) if robot else None
        proposed = look(log, self.topic, nominal)
        if self.out is None:
            print(proposed.text, end="")
        else:
            try:
                self.out.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InputError(f"{self.out}: cannot be written: {error.strerror}; choose another folder.") from error
            with replacing(self.out) as partial:
                partial.write_text(proposed.text, encoding="utf-8")
            for question in proposed.questions:
                print(printable(question))
            print(
                f"{self.out}: look at every line, then: bench convert {robot or 'ROBOT'} {log} --log {self.out} -o DIR"
            )
        return 0

    def _convert(self, source: Path, out: Path) -> int:
        from bench.record.check import check_campaign
        from bench.record.convert import convert
        from bench.record.finding import counted
        from bench.record.log_format import LOG_FORMAT
        from bench.record.logs.cuts import in_window
        from bench.record.logs.likewise import at_a_glance
        from bench.record.write import write_campaign
        from bench.report.campaigns import plain_arm, unknown_constants
        from bench.robot.compiled import compile_robot
        from bench.robot.folder import load_robot
        from bench.robot.logs import campaign_name, log_format_of

        robot = load_robot(self.robot)
        layout = log_format_of(robot, self.log)
        if self.window_s is not None:
            layout = layout.model_copy(update={"runs": in_window(layout.runs, self.window_s)})
        compiled = compile_robot(robot)
        converted = convert(source, layout, campaign_name(robot), plain_arm(compiled))
        write_campaign(converted.campaign, out, "parquet" if self.parquet else "csv")
        unused: dict[tuple[str, ...], list[str]] = {}
        for file, names in converted.unused.items():
            unused.setdefault(names, []).append(file)
        for names, files in unused.items():
            if names:
                print(f"{', '.join(files)}: not used: {', '.join(names)}")
        warnings = [*converted.warnings, *check_campaign(out, plain_arm(compiled)).findings]  # errors are not written
        for warning in at_a_glance(warnings):
            print(f"{warning.label:14}{warning}")
        unknown = tuple(unknown_constants(converted.campaign, compiled))  # of the robot, and to be mended there
        for fault in unknown:
            print(f"{'warning':14}{fault}")
        if without_torque := layout.kind == "motion" and not layout.reads_drives:
            print(
                f"{'warning':14}{self.log or LOG_FORMAT} reads neither torques nor currents of the drives: motions "
                "without them tell nothing about the robot's dynamics; write tau_motor_N_nm or current_N_a"
            )
        runs, failed = converted.campaign.runs, sum(finding.level == "doubt" for finding in warnings)
        words = [counted(len(runs), "run"), counted(sum(map(len, runs)), "row")]
        words += [counted(failed, "failed plausibility check")] if failed else []
        words += [counted(len(warnings) - failed + len(unknown) + without_torque, "warning")]
        print(f"{out}: {', '.join(words)}")
        return 0
