"""A bench without hardware, for tests: simulated modules, and a tmcld with their motors as axes.

    import tmcl.testing

    with tmcl.testing.bench("TMCM-3110", unit="mm", screw_pitch=5) as d:
        d.x.move(12.5)
        d.x.wait()

The programs tmclsim and tmcld are looked for in the folder $TMCL_BIN, or in the PATH. Their time is
the computer's, or, with virtual_time=True, one that goes on while a call waits: a move of a minute
takes milliseconds then. In pytest this is the fixture `tmcl_bench`: docs/PYTHON.md.
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any
from weakref import WeakSet

from .aio import PATIENCE_S
from .errors import NOT_SENT, Error, NotConnected
from .sync import Gateway, connect

#: Names, or names with keys that such an axis has in tmcld.toml: texts, numbers, lists.
Axes = Sequence[str] | Mapping[str, Mapping[str, object]]

#: Of the first motors, where none are named.
USUAL_AXES = ("x", "y", "z", "u", "v", "w")
#: So long a program may take to begin, and to end, on a busy computer.
START_S = 30.0
_PROBE_S = 0.05
_MODULE = re.compile(r"module (\d+) \S+, (\d+) motor")


@contextmanager
def bench(
    *models: str,
    axes: Axes = (),
    simulator: Sequence[str] = (),
    virtual_time: bool = False,
    **settings: object,
) -> Iterator[BenchGateway]:
    """A gateway that is connected to a `Bench` of its own.

    `models` are those of the simulated modules, such as "TMCM-3110". `settings` are keys of
    [[axis]] in tmcld.toml for all axes: unit with screw_pitch or units_per_revolution,
    soft_limits, ...; `axes` gives them names, or sets keys of one:
    {"stage": {"soft_limits": [0, 20]}}. `simulator` are options of tmclsim. With `virtual_time` a
    wait takes no time. Errors: no_program, bench_failed.
    """
    with Bench(
        *models, axes=axes, simulator=simulator, virtual_time=virtual_time, **settings
    ) as made:
        with made.connect() as gateway:
            yield gateway


class BenchGateway(Gateway):
    """A gateway that knows its bench: `d.bench.run_for(1.5)`."""

    def __init__(self, bench: Bench, gateway: Gateway) -> None:
        super().__init__(gateway._runner, gateway._gateway)
        self.bench = bench
        bench._gateways.add(self)

    def __enter__(self) -> BenchGateway:
        return self


class Bench:
    """`with Bench("TMCM-3110") as made:` modules of these models, at addresses from 1 on, on a bus
    "bench", and a tmcld at the socket `made.socket`. All of it ends with the block.

    `axes` names motors, from the first of the first module on; the others have no axis. `settings`
    are keys of tmcld.toml for all of them, and axes={"x": {"soft_limits": [0, 20]}, "y": {}} has
    some for one. `simulator` are options of tmclsim, such as ["--bench", "stage.toml"].

    With `virtual_time` modules and tmcld are one process. Its time stands still while no call waits
    for its answer; while one does, and in `run_for`, it goes from event to event as fast as that
    can be computed. What happens is then the same every time.
    Raises Error: "no_program", or "bench_failed" with what the program says."""

    def __init__(
        self,
        *models: str,
        axes: Axes = (),
        simulator: Sequence[str] = (),
        virtual_time: bool = False,
        **settings: object,
    ) -> None:
        self._options = [word for model in models for word in ("--module", model)]
        self._options += simulator
        self._axes = axes
        self._settings = settings
        self._virtual_time = virtual_time
        self._simulator: subprocess.Popen[str] | None = None
        self._daemon: subprocess.Popen[Any] | None = None
        self._speaking = threading.Lock()
        self._gateways: WeakSet[BenchGateway] = WeakSet()
        self._ending = ExitStack()

    def __enter__(self) -> Bench:
        with ExitStack() as ending:
            folder = tempfile.TemporaryDirectory(prefix="tmcl-", ignore_cleanup_errors=True)
            self.folder = Path(ending.enter_context(folder))
            self.socket = self.folder / "socket"
            if self._virtual_time:
                self._start_both(ending)
            else:
                self._write_configuration(self._start_simulator(ending, "--pty", self._bus))
                ending.callback(self.stop_daemon)
                self.start_daemon()
            self._ending = ending.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.close()

    def connect(self, *, patience: float = PATIENCE_S) -> BenchGateway:
        return BenchGateway(self, connect(self.socket, patience=patience))

    def run_for(self, seconds: float) -> None:
        """Lets so much virtual time pass, and returns when what happens in it has happened. Leases
        of `connect` are renewed meanwhile, but for those by hand."""
        left = float(seconds)
        while left > (ttl := self._shortest_ttl() / 3):
            self._say(f"run {ttl!r}")
            left -= ttl
            self._renew_leases()
        self._say(f"run {left!r}")
        self._renew_leases()

    @property
    def now(self) -> float:
        """The virtual time: seconds since the bench was there."""
        return float(self._say("now"))

    def start_daemon(self) -> None:
        """Returns when it serves."""
        self._check_time(False, "tmcld starts and ends with its modules in virtual time")
        command = [_program("tmcld"), "--config", str(self.folder / "tmcld.toml")]
        with open(self.folder / "tmcld.log", "ab") as log:
            self._daemon = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log
            )
        until = time.monotonic() + START_S
        while True:
            try:
                connect(self.socket, patience=_PROBE_S).close()
                return
            except NotConnected:
                if self._daemon.poll() is not None or time.monotonic() > until:
                    raise _failed("tmcld", self._daemon, self.log()) from None

    def stop_daemon(self, *, kill: bool = False) -> None:
        """`kill`: as if its computer had failed; otherwise it ends as it does, and stops its axes."""
        self._check_time(False, "tmcld starts and ends with its modules in virtual time")
        if self._daemon is not None:
            _end(self._daemon, kill)

    @property
    def daemon_pid(self) -> int:
        process = self._simulator if self._virtual_time else self._daemon
        assert process is not None
        return process.pid

    def log(self) -> str:
        """What tmcld has said so far."""
        return (self.folder / "tmcld.log").read_text("utf-8", "replace")

    @property
    def _bus(self) -> str:
        return str(self.folder / "bus")

    def _start_both(self, ending: ExitStack) -> None:
        """As one process. Which motors there are the simulator has to say before that."""
        with ExitStack() as ending_first:
            motors = self._start_simulator(ending_first, "--pty", self._bus)
        self._write_configuration(motors)
        with_gateway = ("--gateway", str(self.folder / "tmcld.toml"), "--console")
        self._start_simulator(ending, *with_gateway, log="tmcld.log")

    def _start_simulator(
        self, ending: ExitStack, *ways: str, log: str = "tmclsim.log"
    ) -> list[tuple[int, int]]:
        """The motors that there are, each by its module's address and its own number."""
        said = ending.enter_context(open(self.folder / log, "w+", encoding="utf-8"))
        simulator = ending.enter_context(
            subprocess.Popen(
                [_program("tmclsim"), *self._options, *ways],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=said,
                text=True,
            )
        )
        ending.callback(_end, simulator)
        self._simulator = simulator
        motors: list[tuple[int, int]] = []
        too_late = threading.Timer(START_S, simulator.kill)
        too_late.start()
        assert simulator.stdout is not None
        for line in simulator.stdout:
            if line == "ready\n":
                too_late.cancel()
                return motors
            if module := _MODULE.match(line):
                motors += [(int(module[1]), motor) for motor in range(int(module[2]))]
        too_late.cancel()
        simulator.wait()
        said.seek(0)
        raise _failed("tmclsim", simulator, said.read())

    def _say(self, line: str) -> str:
        """What the simulator answers on its console, behind its "ok"."""
        self._check_time(True, "without virtual_time=True a bench has the time of the computer")
        process = self._simulator
        assert process is not None and process.stdin is not None and process.stdout is not None
        with self._speaking:
            try:
                process.stdin.write(line + "\n")
                process.stdin.flush()
            except OSError:
                pass  # it has ended, and says nothing more
            word, _, rest = process.stdout.readline().strip().partition(" ")
        if word == "ok":
            return rest
        if word:
            raise Error(rest, name="bad_argument", outcome=NOT_SENT)
        raise _failed("tmclsim", process, self.log())

    def _shortest_ttl(self) -> float:
        return min((one._gateway._shortest_ttl() for one in self._gateways), default=math.inf)

    def _renew_leases(self) -> None:
        for one in list(self._gateways):
            try:
                one._runner.run(one._gateway._renew_leases())
            except Error:
                pass  # it was closed

    def _check_time(self, virtual: bool, why_not: str) -> None:
        if self._virtual_time != virtual:
            raise Error(why_not, name="not_in_this_time", outcome=NOT_SENT)

    def _write_configuration(self, motors: list[tuple[int, int]]) -> None:
        names = list(self._axes or USUAL_AXES[: len(motors)])
        if len(names) > len(motors):
            message = f"axes has {len(names)} names, and the modules have {len(motors)} motor(s)"
            raise Error(message, name="bad_argument", outcome=NOT_SENT)
        link = f"serial:{self._bus}@115200"
        text = _table("[daemon]", {"socket": str(self.socket)})
        text += _table("[[bus]]", {"name": "bench", "link": link})
        for name, (address, motor) in zip(names, motors):
            own = self._axes[name] if isinstance(self._axes, Mapping) else {}
            place: dict[str, object] = {"bus": "bench", "address": address, "motor": motor}
            text += _table("[[axis]]", {"name": name, **place, **self._settings, **own})
        (self.folder / "tmcld.toml").write_text(text, "utf-8")


def _table(head: str, keys: Mapping[str, object]) -> str:
    """Texts, numbers and lists are in TOML what they are in JSON."""
    return "\n".join([head, *(f"{key} = {json.dumps(value)}" for key, value in keys.items())]) + "\n"


def _program(name: str) -> str:
    folder = os.environ.get("TMCL_BIN")
    found = shutil.which(name, path=folder)
    if found is None:
        where = f"{folder}, which is $TMCL_BIN" if folder else "the PATH"
        raise Error(
            f"there is no program {name} in {where}",
            name="no_program",
            outcome=NOT_SENT,
            hint="'apt install tmcl-sim tmcld' brings it; $TMCL_BIN names the folder of a build, "
            "such as build/release/bin",
        )
    return found


def _failed(name: str, process: subprocess.Popen[Any], said: str) -> Error:
    how = "did not get ready" if process.poll() is None else f"has ended with {process.returncode}"
    return Error(f"{name} {how}: {said.strip()}", name="bench_failed", outcome=NOT_SENT)


def _end(process: subprocess.Popen[Any], kill: bool = False) -> None:
    if process.poll() is None:
        if kill:
            process.kill()
        else:
            process.terminate()
    try:
        process.wait(START_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
