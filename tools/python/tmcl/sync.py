"""The face without asyncio: the same calls, which return when they are answered.

They are made on a thread of the gateway's own, so that a lease is renewed, and a lost connection
noticed, while the program computes or waits.
"""

from __future__ import annotations

import asyncio
import os
import threading
from collections.abc import Coroutine, Iterator, Mapping
from types import TracebackType
from typing import Any, TypeVar

from . import aio, methods
from .aio import PATIENCE_S, USUAL_INTERVAL_S, USUAL_TTL_S, Amount, Path, in_unit
from .errors import NOT_SENT, Error
from .methods import Methods, WatchedState
from .recording import Recording
from .systems import check_process, result_of

T = TypeVar("T")


class Runner:
    """A thread with an event loop."""

    def __init__(self) -> None:
        self._process = os.getpid()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="tmcl", daemon=True)
        self._thread.start()

    def run(self, work: Coroutine[Any, Any, T]) -> T:
        """Ctrl-C ends the wait, and not what the daemon does meanwhile."""
        if self._loop.is_closed():
            work.close()
            raise Error("the gateway was closed", name="closed", outcome=NOT_SENT)
        try:
            check_process(self._process)
        except Error:
            work.close()
            raise
        future = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            return result_of(future)
        finally:
            future.cancel()

    def close(self) -> None:
        if self._loop.is_closed() or os.getpid() != self._process:
            return
        self.run(self._settle())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    @staticmethod
    async def _settle() -> None:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)


def connect(
    where: Path | None = None,
    *,
    token: str | None = None,
    token_file: Path | None = None,
    ca: Path | None = None,
    patience: float = PATIENCE_S,
) -> Gateway:
    """As `tmcl.aio.connect`."""
    runner = Runner()
    try:
        return Gateway(
            runner,
            runner.run(
                aio.connect(where, token=token, token_file=token_file, ca=ca, patience=patience)
            ),
        )
    except BaseException:
        runner.close()
        raise


class Gateway:
    """A tmcld, and its axes: `gateway.x`, `gateway["x"]`, or `gateway.axis("1/0")`."""

    def __init__(self, runner: Runner, gateway: aio.Gateway) -> None:
        self._runner = runner
        self._gateway = gateway
        #: Every method of the daemon: `gateway.rpc.axis_get_units("x")`.
        self.rpc = Methods(self.call)

    def call(self, method: str, params: Mapping[str, Any] | None = None) -> Mapping[str, Any]:
        """Any method by its name, such as call("axis.list", {"all": True}); None is left out."""
        return self._runner.run(self._gateway.call(method, params))

    def axis(self, name: str) -> Axis:
        return Axis(self._runner, self._gateway.axis(name))

    def __getitem__(self, name: str) -> Axis:
        return self.axis(name)

    def __getattr__(self, name: str) -> Axis:
        if name.startswith("_"):
            raise AttributeError(name)
        return Axis(self._runner, getattr(self._gateway, name))

    def axes(self) -> list[Axis]:
        """Those that the configuration names."""
        return [Axis(self._runner, axis) for axis in self._runner.run(self._gateway.axes())]

    def lease(
        self, *axes: str, ttl: float = USUAL_TTL_S, on_loss: str = "stop", by_hand: bool = False
    ) -> Lease:
        """`with gateway.lease("x", "y"):` no other client moves these axes meanwhile, and they stop
        when the block ends. It is renewed until then, or by `lease.renew()` if `by_hand`. When it
        is lost, the next call in the block raises LeaseLost."""
        return Lease(
            self._runner, self._gateway.lease(*axes, ttl=ttl, on_loss=on_loss, by_hand=by_hand)
        )

    def watch(self, *axes: str, interval: float = USUAL_INTERVAL_S) -> Iterator[WatchedState]:
        """`for state in gateway.watch("x"):` the state of some axes, or of all, now and whenever
        it changes, at most every `interval` seconds. Stays while the daemon is started again, for
        as long as the patience of `connect` lasts."""
        return _states(self._runner, self._gateway.watch(*axes, interval=interval))

    def record(self, *axes: str, interval: float = USUAL_INTERVAL_S) -> Recorder:
        """`with gateway.record("x") as recording:` keeps the states until the block ends."""
        return Recorder(self._runner, self._gateway.record(*axes, interval=interval))

    def stop_all(self) -> methods.StoppedAxes:
        return self.rpc.system_stop_all()

    def close(self) -> None:
        try:
            self._runner.run(self._gateway.close())
        except Error:
            return  # it is closed
        self._runner.close()

    def __enter__(self) -> Gateway:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Axis:
    """A number is in the unit of the axis (per second); a text has its unit: "12.5mm", "1 rev"."""

    def __init__(self, runner: Runner, axis: aio.Axis) -> None:
        self.name = axis.name
        self._run = runner.run
        self._runner = runner
        self._axis = axis

    def __repr__(self) -> str:
        return f"<axis {self.name}>"

    def move(
        self, to: Amount | None = None, *, microsteps: int | None = None
    ) -> methods.StartedMove:
        """Starts a move to a position, and does not wait for its end."""
        return self._run(self._axis.move(to, microsteps=microsteps))

    def move_by(
        self, distance: Amount | None = None, *, microsteps: int | None = None
    ) -> methods.StartedMove:
        return self._run(self._axis.move_by(distance, microsteps=microsteps))

    def rotate(
        self,
        velocity: Amount | None = None,
        *,
        internal: int | None = None,
        unattended: bool = False,
    ) -> methods.Turning:
        """Turns without end, until it is stopped; or until the connection ends, unless
        `unattended`."""
        return self._run(self._axis.rotate(velocity, internal=internal, unattended=unattended))

    def stop(self) -> None:
        """Ramps down; returns when the module has taken it, before the axis stands."""
        self._run(self._axis.stop())

    def wait(self, timeout: float | None = None) -> methods.Standing:
        """Returns when the axis stands at its target. Raises Error: "move_interrupted" when it
        stands elsewhere, "deadline_passed" after `timeout` seconds."""
        return self._run(self._axis.wait(timeout))

    def home(self, mode: int | None = None, *, timeout: float | None = None) -> methods.HomedAxis:
        """Searches the reference, and returns when that has ended."""
        return self._run(self._axis.home(mode, timeout=timeout))

    def recover(self) -> None:
        """Says that the axis may move again, whose module has started again."""
        self._run(self._axis.recover())

    def state(self, *, max_age: float | None = None) -> methods.State:
        return self._run(self._axis.state(max_age=max_age))

    @property
    def position(self) -> float:
        """In its unit. Raises Error "no_unit" if it has none."""
        return in_unit(self.name, self.state().position)

    @property
    def velocity(self) -> float:
        """In its unit per second."""
        return in_unit(self.name, self.state().velocity)

    @property
    def target(self) -> float:
        return in_unit(self.name, self.state().target)

    @property
    def moving(self) -> bool:
        return self.state().moving

    def errors(self) -> methods.Errors:
        return self._run(self._axis.errors())

    def units(self) -> methods.Units:
        return self._run(self._axis.units())

    def get(self, parameter: str | int) -> int:
        """What the module holds; `gateway.rpc.parameter_get` gives it in the unit as well."""
        return self._run(self._axis.get(parameter))

    def set(
        self,
        parameter: str | int,
        value: int | None = None,
        *,
        in_unit: Amount | None = None,
    ) -> methods.ParameterSet:
        return self._run(self._axis.set(parameter, value, in_unit=in_unit))

    def watch(self, *, interval: float = USUAL_INTERVAL_S) -> Iterator[WatchedState]:
        return _states(self._runner, self._axis.watch(interval=interval))


def _states(runner: Runner, watch: aio.Watch) -> Iterator[WatchedState]:
    try:
        while True:
            yield runner.run(watch.__anext__())
    finally:
        try:
            runner.run(watch.close())
        except Error:
            pass  # it ends with the gateway


class Lease:
    """See `Gateway.lease`."""

    def __init__(self, runner: Runner, lease: aio.Lease) -> None:
        self._runner = runner
        self._lease = lease

    def renew(self) -> None:
        """Says that its holder is still there. Raises LeaseLost."""
        self._runner.run(self._lease.renew())

    def __enter__(self) -> Lease:
        try:
            self._runner.run(self._lease.__aenter__())
        except BaseException:  # Ctrl-C may come when it has been granted
            try:
                self._runner.run(self._lease.give_up())
            except Error:
                pass  # the gateway is closed, or another process's
            raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._runner.run(self._lease.__aexit__(kind, error, trace))


class Recorder:
    """See `Gateway.record`."""

    def __init__(self, runner: Runner, recorder: aio.Recorder) -> None:
        self._runner = runner
        self._recorder = recorder

    def __enter__(self) -> Recording:
        return self._runner.run(self._recorder.__aenter__())

    def __exit__(self, *_: object) -> None:
        self._runner.run(self._recorder.__aexit__())
