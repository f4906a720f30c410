"""A stranger's model tried in a process of its own, so that a parser that dies is one sentence.

MuJoCo's parsers are C++ and may end the process, fill the memory or never return. The trial compiles the model,
computes it in its keyframes and makes a step, under limits of time and memory. Robots that come along are not tried.
"""

import faulthandler
import os
import resource
import select
import signal
import warnings
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import mujoco
import numpy as np

from bench import paths
from bench.errors import RobotError
from bench.record.limits import MODEL_BYTES, MODEL_ELEMENTS, MODEL_MEMORY, MODEL_SECONDS
from bench.record.plain_file import FileFault, expect_plain
from bench.robot.mjcf_text import look_through
from bench.robot.plain_words import plain_words
from bench.robot.plausible import implausible
from bench.robot.switches import switched_off

PATIENCE = 4  # times the limit of processor time, by the wall clock: others may need the cores
KEYFRAMES = 20  # that are computed; a file may have thousands
MOST_TOLD = 8  # faults of one model; one slip is often made at every joint
PIPE_SIZE = 4096  # [bytes] of an answer, at most: what a pipe takes at once (POSIX: at least 512)
FINITE = ("qpos0", "body_pos", "body_mass", "body_inertia", "dof_armature", "dof_damping", "tendon_stiffness")
SINGULAR = "too close to singular"  # in a warning of MuJoCo's compiler
_harmless: set[tuple[str, int, int]] = set()


def expect_harmless(file: Path) -> None:
    """Look through a model and try it; once in this process, as long as the file does not change.

    Raises:
        RobotError: It breaks the limits, does not compile, or ends the process that tries it.
    """
    try:
        expect_plain(file, MODEL_BYTES)
    except FileFault as fault:
        raise RobotError(f"{file}: {fault}; {fault.remedy}.") from fault
    place = file.resolve()
    if place.is_relative_to(paths.models_dir().resolve()):
        return
    found = place.stat()
    known = (str(place), found.st_mtime_ns, found.st_size)
    if known in _harmless:
        return
    look_through(file)
    if told := _tried(file.absolute()):
        raise RobotError(f"{file}: {fault}" for fault in told.splitlines())
    _harmless.add(known)


def _tried(file: Path) -> str:
    """Return what trying a model in a process of its own ends in; "" if nothing is wrong with it."""
    answer, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(answer)
        _try(file, theirs)
    os.close(theirs)
    ended = False
    try:
        ended = bool(select.select([answer], [], [], PATIENCE * MODEL_SECONDS.value)[0])
        told = os.read(answer, PIPE_SIZE).decode("utf-8", "replace") if ended else ""
    finally:
        os.close(answer)
        if not ended:
            os.kill(child, signal.SIGKILL)
        status = os.waitpid(child, 0)[1]
    if told:
        return told.strip()
    number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
    if not ended or number == signal.SIGXCPU:
        return f"MuJoCo was not done with it after {MODEL_SECONDS}; {MODEL_SECONDS.remedy}."
    name = signal.Signals(number).name if number else f"exit code {os.waitstatus_to_exitcode(status)}"
    return f"MuJoCo's reader died of it ({name}); simplify it until `python -m mujoco.viewer` opens it."


def _try(file: Path, answer: int) -> None:
    """Try a model and say through the pipe what came of it, a blank if nothing is wrong; never returns."""
    told = ""
    try:
        faulthandler.disable()
        for number in (signal.SIGTERM, signal.SIGHUP):  # what the command hears, not this
            if signal.getsignal(number) is not signal.SIG_IGN:  # as under nohup
                signal.signal(number, signal.SIG_DFL)
        null = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(null, stream)
        _limit(resource.RLIMIT_CORE, 0)
        _limit(resource.RLIMIT_CPU, MODEL_SECONDS.value)
        _limit(resource.RLIMIT_AS, _address_space() + MODEL_MEMORY.value)
        mujoco.set_mju_user_warning(lambda words: None)
        told = "\n".join(islice(_faults(file), MOST_TOLD)) or " "
    except MemoryError:
        told = f"needs more than {MODEL_MEMORY} of memory; {MODEL_MEMORY.remedy}."
    except (ValueError, mujoco.FatalError) as error:
        words = plain_words(ValueError(str(error)))
        out_of = "alloc" in words
        told = f"{words} (memory: {MODEL_MEMORY}; {MODEL_MEMORY.remedy})" if out_of else words
    finally:
        os.write(answer, told.encode("utf-8", "replace")[:PIPE_SIZE])
        os._exit(0 if told else 1)


def _faults(file: Path) -> Iterator[str]:
    """Yield what is wrong with a model. What MuJoCo computes is looked at only where its numbers are plausible."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        spec = mujoco.MjSpec.from_file(str(file))
        model = spec.compile()
    if MODEL_ELEMENTS.exceeded(numbers := int(model.nsensordata) + int(model.nuserdata)):
        yield f"its sensors and user data hold {numbers} numbers, more than {MODEL_ELEMENTS}; {MODEL_ELEMENTS.remedy}."
        return
    infinite = [name for name in FINITE if not np.all(np.isfinite(getattr(model, name)))]
    if infinite:
        yield f"its {infinite[0]} is not finite once compiled; look for numbers that are far too large."
        return
    if faults := [*switched_off(spec, model), *implausible(model)]:
        yield from faults
        return
    for warning in warned:
        if SINGULAR in str(warning.message):
            yield "its mass matrix is singular: look for armatures, masses and inertias that are far too small."
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    if not np.all(np.isfinite(data.qacc)):
        yield "its accelerations at rest are not finite; look for numbers that are far too large or too small."
    for key in range(min(model.nkey, KEYFRAMES)):
        if not np.all(np.isfinite(model.key_qpos[key])):
            yield f"keyframe {key + 1}: qpos is not finite; write numbers."
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
    mujoco.mj_step(model, data)


def _limit(which: int, most: int) -> None:
    """Set a limit of this process, unless a lower one is set already."""
    hard = resource.getrlimit(which)[1]
    most = most if hard == resource.RLIM_INFINITY else min(most, hard)
    resource.setrlimit(which, (most, hard))


def _address_space() -> int:
    """Return what this process has of it now [bytes]; 0 where the system does not say."""
    try:
        return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    except OSError:
        return 0
