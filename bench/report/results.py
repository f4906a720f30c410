"""Results folders: a session as campaign, truth and recording side by side, complete or not at all."""

from pathlib import Path

from bench.executor.contract import Progress
from bench.record.truth import Truth, write_truth
from bench.record.write import TableFormat, write_campaign
from bench.report.recording.write import write_recording
from bench.scenario.files import Experiment
from bench.simulate.session import Session, run_session
from bench.simulate.truth import true_parameters

CAMPAIGN, TRUTH, RECORDING = "campaign", "truth", "session.rrd"


def write_session(session: Session, folder: Path, table_format: TableFormat = "csv") -> None:
    """Write what a session gave into an existing folder: `campaign/`, `truth/` and `session.rrd`.

    Args:
        session: What `bench.simulate.session` returned.
        folder: An empty folder.
        table_format: How the campaign's tables are stored.
    """
    write_campaign(session.campaign, folder / CAMPAIGN, table_format)
    write_truth(truth_of(session), folder / TRUTH)
    write_recording(folder / RECORDING, session.compiled, session.film)


def run_and_write(job: tuple[Experiment, Path], progress: Progress) -> Session:
    """Run a scenario and write its session into a folder that does not exist yet.

    Raises:
        InputError: The scenario does not fit its robot.
    """
    scenario, folder = job
    session = run_session(scenario, progress)
    folder.mkdir(parents=True)
    write_session(session, folder)
    return session


def run_and_forget(job: tuple[Experiment, Path], progress: Progress) -> None:
    """Do the same in a worker process, which hands nothing back but the files."""
    run_and_write(job, progress)


def truth_of(session: Session) -> Truth:
    """Return the true parameters and the readings of ideal instruments."""
    parameters = true_parameters(session.compiled, session.instruments.errors)
    return Truth(parameters, (), {run.name: run.columns for run in session.ideal})
