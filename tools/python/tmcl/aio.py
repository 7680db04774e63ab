"""Axes by asyncio: `gateway = await tmcl.aio.connect()`, `await gateway.x.move(12.5)`.

What the words mean, and what a call does that cannot be answered, is in docs/PYTHON.md.
"""

from __future__ import annotations

import asyncio
import math
import os
from collections.abc import AsyncIterator, Mapping
from types import TracebackType
from typing import Any

from . import methods
from .connection import MOST_REPEATS, Connection, Live, States
from .errors import NOT_SENT, Error, LeaseLost, NotConnected
from .link import OpenLink, way_to
from .methods import EFFECTS, AsyncMethods, WatchedState
from .recording import Recording

Amount = float | str
Path = str | os.PathLike[str]

PATIENCE_S = 10.0
#: For the first connection: a daemon that was just started.
PATIENCE_TO_CONNECT_S = 2.0
USUAL_TTL_S = 2.0
USUAL_INTERVAL_S = 0.05
#: A renewal that was not taken is tried again so often before the lease ends.
RENEWALS_IN_TTL = 20


async def connect(
    where: Path | None = None,
    *,
    token: str | None = None,
    token_file: Path | None = None,
    ca: Path | None = None,
    patience: float = PATIENCE_S,
) -> Gateway:
    """Connects to the tmcld at a unix socket ($TMCLD_SOCKET, or /run/tmcld/tmcld.sock, if none is
    named), or at an URL such as "https://gateway:4143", with a token, and `ca` as the file of
    certificates to trust. `patience`: so many seconds a daemon that is away is waited for when
    something is to be read. Raises NotConnected."""
    if math.isnan(patience):
        raise _no_time("patience", patience)
    gateway = Gateway(way_to(where, token, token_file, ca), patience)
    try:
        await gateway._connection.live(PATIENCE_TO_CONNECT_S)
        await gateway.axes()
    except BaseException:
        await gateway.close()
        raise
    return gateway


class Gateway:
    """A tmcld, and its axes: `gateway.x`, `gateway["x"]`, or `gateway.axis("1/0")`."""

    def __init__(self, open_link: OpenLink, patience: float = PATIENCE_S) -> None:
        self._connection = Connection(open_link, patience)
        self._leases: list[Lease] = []
        self._names: list[str] = []
        self._given_lease = _lease_in_environment()
        #: Every method of the daemon: `await gateway.rpc.axis_get_units("x")`.
        self.rpc = AsyncMethods(self.call)

    async def call(self, method: str, params: Mapping[str, Any] | None = None) -> Mapping[str, Any]:
        """Any method by its name, such as call("axis.list", {"all": True}); None is left out."""
        said = {name: value for name, value in (params or {}).items() if value is not None}
        return await self._connection.call(method, self._under_lease(method, said))

    def axis(self, name: str) -> Axis:
        return Axis(self, name)

    def __getitem__(self, name: str) -> Axis:
        return Axis(self, name)

    def __getattr__(self, name: str) -> Axis:
        if name.startswith("_") or name not in self._names:
            known = ", ".join(self._names) or "none"
            raise AttributeError(f"there is no axis '{name}' (there are: {known})")
        return Axis(self, name)

    async def axes(self) -> list[Axis]:
        """Those that the configuration names."""
        self._names = [axis.name for axis in (await self.rpc.axis_list()).axes]
        return [Axis(self, name) for name in self._names]

    def lease(
        self, *axes: str, ttl: float = USUAL_TTL_S, on_loss: str = "stop", by_hand: bool = False
    ) -> Lease:
        """`async with gateway.lease("x", "y"):` no other client moves these axes meanwhile, and they
        stop when the block ends. It is renewed until then, or by `await lease.renew()` if
        `by_hand`. When it is lost, the next call in the block raises LeaseLost."""
        return Lease(self, axes, ttl, on_loss, by_hand)

    def watch(self, *axes: str, interval: float = USUAL_INTERVAL_S) -> Watch:
        """`async for state in gateway.watch("x"):` the state of some axes, or of all, now and
        whenever it changes, at most every `interval` seconds. Stays while the daemon is started
        again, for as long as the patience of `connect` lasts."""
        return Watch(self._connection, axes, interval)

    def record(self, *axes: str, interval: float = USUAL_INTERVAL_S) -> Recorder:
        """`async with gateway.record("x") as recording:` keeps the states until the block ends."""
        return Recorder(self.watch(*axes, interval=interval))

    async def stop_all(self) -> methods.StoppedAxes:
        return await self.rpc.system_stop_all()

    async def close(self) -> None:
        await self._connection.close()

    async def __aenter__(self) -> Gateway:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    def _shortest_ttl(self) -> float:
        """Of the leases that are not renewed by hand."""
        return min((lease.ttl for lease in self._leases if not lease.by_hand), default=math.inf)

    async def _renew_leases(self) -> None:
        """Those, in virtual time, in which no clock of this program says when."""
        for lease in self._leases:
            if not lease.by_hand:
                try:
                    await lease.renew()
                except LeaseLost:
                    pass  # the next call says so

    def _under_lease(self, method: str, said: dict[str, Any]) -> dict[str, Any]:
        """A call that acts names the lease that it is made under, so that the daemon refuses it
        when that has ended. Raises LeaseLost where that is known already."""
        if EFFECTS.get(method) == "stops" or method.startswith("lease."):
            return said
        for lease in self._leases:
            lease.check()
        if EFFECTS.get(method) == "reads":
            return said
        named = said.get("axes") or [said.get("axis")]
        for lease in self._leases:
            if all(name in lease.axes for name in named):
                return {**said, **lease.key}
        return {**self._given_lease, **said}


def _lease_in_environment() -> dict[str, int]:
    """What `tmclctl lease run` tells the programs that it starts."""
    try:
        return {"lease": int(os.environ["TMCL_LEASE"]), "epoch": int(os.environ["TMCL_EPOCH"])}
    except (KeyError, ValueError):
        return {}


class Axis:
    """A number is in the unit of the axis (per second); a text has its unit: "12.5mm", "1 rev"."""

    def __init__(self, gateway: Gateway, name: str) -> None:
        self.name = name
        self._gateway = gateway
        self._rpc = gateway.rpc

    def __repr__(self) -> str:
        return f"<axis {self.name}>"

    async def move(
        self, to: Amount | None = None, *, microsteps: int | None = None
    ) -> methods.StartedMove:
        """Starts a move to a position, and does not wait for its end."""
        return await self._rpc.axis_move_to(self.name, position=to, position_microsteps=microsteps)

    async def move_by(
        self, distance: Amount | None = None, *, microsteps: int | None = None
    ) -> methods.StartedMove:
        return await self._rpc.axis_move_by(
            self.name, distance=distance, distance_microsteps=microsteps
        )

    async def rotate(
        self,
        velocity: Amount | None = None,
        *,
        internal: int | None = None,
        unattended: bool = False,
    ) -> methods.Turning:
        """Turns without end, until it is stopped; or until the connection ends, unless
        `unattended`."""
        return await self._rpc.axis_rotate(
            self.name, velocity=velocity, velocity_internal=internal, unattended=unattended or None
        )

    async def stop(self) -> None:
        """Ramps down; returns when the module has taken it, before the axis stands."""
        await self._rpc.axis_stop(self.name)

    async def wait(self, timeout: float | None = None) -> methods.Standing:
        """Returns when the axis stands at its target. Raises Error: "move_interrupted" when it
        stands elsewhere, "deadline_passed" after `timeout` seconds."""
        return await self._rpc.axis_wait(self.name, timeout_ms=_timeout(timeout))

    async def home(
        self, mode: int | None = None, *, timeout: float | None = None
    ) -> methods.HomedAxis:
        """Searches the reference, and returns when that has ended."""
        return await self._rpc.axis_home(self.name, mode=mode, timeout_ms=_timeout(timeout))

    async def recover(self) -> None:
        """Says that the axis may move again, whose module has started again."""
        await self._rpc.axis_recover(self.name)

    async def state(self, *, max_age: float | None = None) -> methods.State:
        return await self._rpc.axis_get_state(self.name, max_age_ms=_milliseconds("max_age", max_age))

    async def position(self) -> float:
        """In its unit. Raises Error "no_unit" if it has none."""
        return in_unit(self.name, (await self.state()).position)

    async def errors(self) -> methods.Errors:
        return await self._rpc.axis_get_errors(self.name)

    async def units(self) -> methods.Units:
        return await self._rpc.axis_get_units(self.name)

    async def get(self, parameter: str | int) -> int:
        """What the module holds; `gateway.rpc.parameter_get` gives it in the unit as well."""
        return (await self._rpc.parameter_get(self.name, parameter)).value

    async def set(
        self,
        parameter: str | int,
        value: int | None = None,
        *,
        in_unit: Amount | None = None,
    ) -> methods.ParameterSet:
        return await self._rpc.parameter_set(
            self.name, parameter, value=value, value_in_unit=in_unit
        )

    def watch(self, *, interval: float = USUAL_INTERVAL_S) -> Watch:
        return self._gateway.watch(self.name, interval=interval)


def in_unit(axis: str, value: float | None) -> float:
    if value is None:
        raise Error(
            f"axis '{axis}' has no unit",
            name="no_unit",
            outcome=NOT_SENT,
            hint="In microsteps state() has it; 'unit' in tmcld.toml gives the axis one",
        )
    return value


def _no_time(what: str, seconds: float) -> Error:
    return Error(
        f"{what}: {seconds} is no number of seconds", name="bad_argument", outcome=NOT_SENT
    )


def _milliseconds(what: str, seconds: float | None, least: int = 0) -> int | None:
    """Raises Error for what is no time. `least`: where less means something else."""
    if seconds is None:
        return None
    if not math.isfinite(seconds):
        raise _no_time(what, seconds)
    return max(least, math.ceil(seconds * 1000))


def _timeout(seconds: float | None) -> int | None:
    """0 is the shortest here, and no limit to the daemon."""
    return _milliseconds("timeout", seconds, least=1)


class Lease:
    """See `Gateway.lease`."""

    def __init__(
        self, gateway: Gateway, axes: tuple[str, ...], ttl: float, on_loss: str, by_hand: bool
    ) -> None:
        self.axes = set(axes)
        self.key: dict[str, int] = {}
        self._gateway = gateway
        self._params = {"axes": list(axes), "ttl_ms": _milliseconds("ttl", ttl), "on_loss": on_loss}
        self.ttl = ttl
        self.by_hand = by_hand
        self._live: Live | None = None
        self._renewing: asyncio.Task[None] | None = None
        self._expires = 0.0
        self._in_virtual_time = False
        self._lost: LeaseLost | None = None

    def check(self) -> None:
        """Raises LeaseLost if it has ended."""
        if self._lost is None and asyncio.get_running_loop().time() > self._expires:
            self._lose(f"it was not renewed for {self.ttl:g} s")
        if self._lost is not None:
            raise self._lost.with_traceback(None)

    async def renew(self) -> None:
        """Says that its holder is still there. Raises LeaseLost."""
        self.check()
        assert self._live is not None
        try:
            while not await self._renew_once():
                await asyncio.sleep(self.ttl / RENEWALS_IN_TTL)
                self.check()
        except asyncio.TimeoutError:
            self._lose("the daemon did not answer in time")
        except Error as error:
            self._lose(error.message)
        self.check()

    async def _renew_once(self) -> bool:
        """False if the daemon has too much else to do for this program, and has the lease yet."""
        assert self._live is not None
        asked = asyncio.get_running_loop().time()
        try:
            await asyncio.wait_for(
                self._live.call("lease.renew", self.key), max(self._expires - asked, 0)
            )
        except Error as error:
            if error.name != "too_many_requests":
                raise
            return False
        self._expires = self._end_from(asked)
        return True

    def _end_from(self, asked: float) -> float:
        return math.inf if self._in_virtual_time else asked + self.ttl

    async def __aenter__(self) -> Lease:
        self._live = live = await self._gateway._connection.live()
        asked = asyncio.get_running_loop().time()
        granted = await live.call("lease.acquire", self._params)
        self._lost = None
        hello = live.hello
        # The daemon alone knows then how late it is.
        self._in_virtual_time = hello is not None and hello.in_virtual_time
        self._expires = self._end_from(asked)
        self.key = {name: granted[name] for name in ("lease", "epoch")}
        self.axes |= set(granted["axes"])
        live.when_lost.append(self._connection_lost)
        if live.lost is not None:
            self._connection_lost(live.lost)
        self._gateway._leases.append(self)
        if not self.by_hand and not self._in_virtual_time:
            self._renewing = asyncio.get_running_loop().create_task(self._renew())
        return self

    async def give_up(self) -> None:
        """Of a block that was not entered although the lease was granted."""
        if self in self._gateway._leases:
            try:
                await self.__aexit__(None, None, None)
            except Error:
                pass  # it is lost, which is as good

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        assert self._live is not None
        self._gateway._leases.remove(self)
        self._live.when_lost.remove(self._connection_lost)
        if self._renewing is not None:
            self._renewing.cancel()
        try:
            self.check()
            await self._live.call("lease.release", self.key)
        except Error:
            if error is None:
                raise

    async def _renew(self) -> None:
        try:
            while True:
                await asyncio.sleep(self.ttl / 3)
                await self.renew()
        except LeaseLost:
            pass  # the next call says so

    def _connection_lost(self, why: Error) -> None:
        self._lose(why.message)

    def _lose(self, why: str) -> None:
        if self._lost is None:
            self._lost = LeaseLost(
                f"the lease of {', '.join(sorted(self.axes))} is lost: {why}",
                name="lease_lost",
                outcome=NOT_SENT,
                hint="Its axes were told to stop; look at them, and take it anew",
            )


class Watch(AsyncIterator[WatchedState]):
    """See `Gateway.watch`. `close()` ends it before its connection does."""

    def __init__(self, connection: Connection, axes: tuple[str, ...], interval: float) -> None:
        self._connection = connection
        self._axes = list(axes)
        self._interval_ms = _milliseconds("interval", interval) or 0
        self._states: States | None = None
        self._live: Live | None = None
        self._number = 0
        self._dropped_before = 0

    @property
    def dropped(self) -> int:
        """How many states were replaced by newer ones, because they were not taken in time."""
        return self._dropped_before + (self._states.dropped if self._states is not None else 0)

    async def __anext__(self) -> WatchedState:
        while True:
            if self._states is None:
                await self.begin()
            try:
                assert self._states is not None
                return await self._states.next()
            except Error:
                self._dropped_before, self._states = self.dropped, None

    async def begin(self) -> None:
        """Subscribes, if it has not; the first state asks for that, too."""
        for attempt in range(MOST_REPEATS):
            if self._states is not None:
                return
            live, states = await self._connection.live(), States()
            try:
                self._number = await live.subscribe(self._axes, self._interval_ms, states)
                self._live, self._states = live, states
            except Error:
                if live.lost is None or attempt + 1 == MOST_REPEATS:
                    raise

    def take(self) -> list[WatchedState]:
        """Those that have come and were not taken yet."""
        if self._states is None:
            return []
        come = list(self._states.waiting)
        self._states.waiting.clear()
        return come

    async def close(self) -> None:
        if self._live is not None and self._states is not None:
            await self._live.unsubscribe(self._number)
        self._states = None


class Recorder:
    """See `Gateway.record`."""

    def __init__(self, watch: Watch) -> None:
        self._watch = watch
        self._recording = Recording()
        self._task: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Recording:
        await self._watch.begin()
        self._task = asyncio.get_running_loop().create_task(self._keep())
        return self._recording

    async def __aexit__(self, *_: object) -> None:
        assert self._task is not None
        self._task.cancel()
        try:
            await self._task
        except asyncio.CancelledError:
            pass
        except NotConnected:
            pass  # the recording has what there was
        for state in self._watch.take():
            self._recording.add(state)
        self._recording.dropped = self._watch.dropped
        await self._watch.close()

    async def _keep(self) -> None:
        async for state in self._watch:
            self._recording.add(state)


