"""What the bridges to control systems have in common: axes that are followed, and moved under a lease.

A bridge tells another system of axes, and moves them for it. It answers at once, from what it knows,
says when it knows nothing any more, and never moves what was asked for long ago.
"""

from __future__ import annotations

import asyncio
import threading
import tomllib
from collections.abc import Awaitable, Callable, Coroutine, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from . import aio
from .errors import NOT_SENT, UNKNOWN, Error
from .methods import State, Units, WatchedState
from .systems import result_of

T = TypeVar("T")

#: Of two looks at an axis that stands; one that moves is told of at each interval.
LOOK_S = 0.3
INTERVAL_S = 0.1
#: What is older says nothing any more: within two seconds the other system has to know.
FRESH_S = 1.5
#: So long a call may take that moves something, or that looks at it.
ANSWER_S = 2.0
#: A bridge that stood still for so long takes no movement, which may have waited meanwhile ...
STANDSTILL_S = 1.0
#: ... until it has had so long to refuse what has.
QUIET_S = 1.0
TICK_S = 0.1
LEASES = ("move", "session")
#: Faults that a module does not recover from by itself; others are warnings.
BROKEN = {"overtemperature", "short_to_ground_a", "short_to_ground_b", "undervoltage", "overvoltage"}
#: Why an axis stands short of its target, where that was not wanted.
LIMITS = {"left_limit", "right_limit", "search_limit"}
ALARMING = LIMITS | {"stall", "deviation", "deadman", "supply"}


@dataclass(frozen=True)
class AxisChoice:
    """A table [[axis]] of a configuration: what is in it besides `name` and `lease` is the bridge's."""

    name: str
    lease: str
    more: Mapping[str, Any]


@dataclass(frozen=True)
class Choices:
    """The configuration of a bridge, a TOML file."""

    gateway: Mapping[str, Any]
    lease_ttl: float
    axes: tuple[AxisChoice, ...]

    @staticmethod
    def read(file: Path, *keys_of_axes: str) -> Choices:
        """`keys_of_axes`: what every axis needs besides its name. Raises ValueError, OSError."""
        said = tomllib.loads(file.read_text("utf-8"))
        _check_keys(file, "the file", said, {"gateway", "axis", "lease", "lease_ttl"})
        gateway = dict(said.get("gateway", {}))
        _check_keys(file, "[gateway]", gateway, {"where", "token_file", "ca"})
        ttl = said.get("lease_ttl", aio.USUAL_TTL_S)
        if not isinstance(ttl, int | float) or not 1 <= ttl <= 60:
            raise ValueError(f"{file}: lease_ttl is 1 to 60 seconds")
        tables = said.get("axis", [])
        if not tables:
            raise ValueError(f"{file}: it names no axes; each is a table [[axis]]")
        usual = said.get("lease", "move")
        axes = tuple(_axis_choice(file, table, usual, set(keys_of_axes)) for table in tables)
        return Choices(gateway, float(ttl), axes)


def _check_keys(file: Path, where: str, said: Mapping[str, Any], known: set[str]) -> None:
    for key in said.keys() - known:
        raise ValueError(f"{file}: {where} has '{key}'; known are {', '.join(sorted(known))}")


def _axis_choice(file: Path, said: Mapping[str, Any], usual: str, keys: set[str]) -> AxisChoice:
    _check_keys(file, "[[axis]]", said, {"name", "lease"} | keys)
    for key in sorted({"name"} | keys):
        if not isinstance(said.get(key), str):
            raise ValueError(f"{file}: an [[axis]] lacks '{key}', a text")
    lease = said.get("lease", usual)
    if lease not in LEASES:
        raise ValueError(f"{file}: lease is \"move\" or \"session\", and not {lease!r}")
    return AxisChoice(said["name"], lease, {key: said[key] for key in keys})


class Bridge:
    """A thread that follows axes. `changed` is set whenever there is something to tell."""

    def __init__(self, choices: Choices) -> None:
        self.changed = threading.Event()
        self.lease_ttl = choices.lease_ttl
        self.gateway: aio.Gateway | None = None
        self.trouble = "not connected to tmcld yet"
        self._where = choices.gateway
        self._quiet_until = 0.0
        self._tasks: set[asyncio.Task[None]] = set()
        self._loop = asyncio.new_event_loop()
        self._last_tick = self._loop.time()
        self.axes = {choice.name: Follower(self, choice) for choice in choices.axes}
        self._thread = threading.Thread(target=self._run, name="tmcl-bridge", daemon=True)
        self._thread.start()

    def ask(self, work: Coroutine[Any, Any, T]) -> T:
        """From any other thread. Raises Error."""
        return result_of(self.begin(work))

    def begin(self, work: Coroutine[Any, Any, T]) -> Future[T]:
        """As `ask`, without waiting for the answer."""
        return asyncio.run_coroutine_threadsafe(work, self._loop)

    def close(self) -> None:
        """Ends the connection, by which tmcld stops what was moved here. Nothing may be asked after."""
        self.begin(self._end())
        self._thread.join()
        self._loop.close()

    def now(self) -> float:
        return self._loop.time()

    def check_awake(self) -> None:
        """Raises Error if what is asked for now may have been asked for long ago."""
        if self.now() - self._last_tick > STANDSTILL_S or self.now() < self._quiet_until:
            raise Error(
                "the bridge stood still, and this may have waited meanwhile",
                name="stale_request",
                outcome=NOT_SENT,
                hint="Ask again if it is still wanted",
            )

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self.later(self._tick())
        self.later(self._connect())
        self._loop.run_forever()

    async def _end(self) -> None:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        if self.gateway is not None:
            await self.gateway.close()
        self._loop.stop()

    def later(self, work: Coroutine[Any, Any, None]) -> None:
        """In the bridge's thread: beside what goes on."""
        task = self._loop.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _tick(self) -> None:
        while True:
            now = self.now()
            if now - self._last_tick > STANDSTILL_S:
                self._quiet_until = now + QUIET_S
            self._last_tick = now
            await asyncio.sleep(TICK_S)

    async def _connect(self) -> None:
        while self.gateway is None:
            try:
                self.gateway = await aio.connect(**self._where)
            except (Error, OSError) as error:
                self.trouble = str(error)
                self.changed.set()
                await asyncio.sleep(LOOK_S)
        for axis in self.axes.values():
            self.later(axis.watch())
            self.later(axis.look())


class Follower:
    """One axis: what is known of it, and its movements for the other system. What is read here may be
    read by any thread; coroutines are for `Bridge.ask`."""

    def __init__(self, bridge: Bridge, choice: AxisChoice) -> None:
        self.name = choice.name
        self.units: Units | None = None
        #: How the last movement ended, where that was not at its target.
        self.ended_by: Error | None = None
        self._bridge = bridge
        self._in_session = choice.lease == "session"
        self._state: State | WatchedState | None = None
        self._seen = 0.0
        self._trouble: str | None = None
        self._lease: dict[str, Any] = {}
        self._following: asyncio.Task[None] | None = None
        self._beginning = asyncio.Lock()
        self._stops = 0

    @property
    def state(self) -> State | WatchedState | None:
        """None where nothing is known that is fresh: `trouble` says why."""
        return None if self.trouble is not None else self._state

    @property
    def trouble(self) -> str | None:
        if self._state is None and self._trouble is None:
            return self._bridge.trouble
        if self._trouble is None and self._bridge.now() - self._seen > FRESH_S:
            return f"tmcld has told nothing of axis '{self.name}' for {FRESH_S:g} s"
        return self._trouble

    @property
    def busy(self) -> bool:
        """It is on a movement of this bridge, or moves for someone else."""
        state = self.state
        return self._following is not None or (state is not None and state.moving)

    async def move(self, to: float) -> None:
        """In the unit of the axis, or in microsteps if it has none. Returns when it has begun."""
        said = {"position": to} if self._has_unit() else {"position_microsteps": round(to)}
        await self._begin("axis.move_to", said, self._stand)

    async def jog(self, velocity: float, hold: float) -> None:
        """Goes on for `hold` seconds, and longer if it is called again before that."""
        said = {"velocity": velocity} if self._has_unit() else {"velocity_internal": round(velocity)}

        async def held() -> None:
            await asyncio.sleep(hold)
            await self._stand()

        await self._begin("axis.jog", {**said, "hold_ms": round(hold * 1000)}, held)

    async def home(self) -> None:
        """Returns at once; what becomes of the search is in `busy` and `ended_by`."""

        async def searched() -> None:
            assert self._bridge.gateway is not None
            await self._bridge.gateway.call("axis.home", {"axis": self.name, **self._lease})

        await self._begin(None, {}, searched)

    async def stop(self) -> None:
        """Needs no lease, and is tried whatever is known. What was asked for before does not begin."""
        self._stops += 1
        await self.call("axis.stop")

    async def recover(self) -> None:
        await self.call("axis.recover")

    async def call(self, method: str, **params: Any) -> Mapping[str, Any]:
        """Any method for this axis. Raises Error, also when it takes too long."""
        gateway = self._bridge.gateway
        if gateway is None:
            raise Error(self._bridge.trouble, name="not_connected", outcome=NOT_SENT)
        try:
            said = {"axis": self.name, **params}
            return await asyncio.wait_for(gateway.call(method, said), ANSWER_S)
        except TimeoutError:
            raise _no_answer(method) from None

    async def watch(self) -> None:
        """Tells of what moves; what tells of nothing is for `look`."""
        assert self._bridge.gateway is not None
        while True:
            try:
                async for state in self._bridge.gateway.watch(self.name, interval=INTERVAL_S):
                    self._know(state)
            except Error:
                await asyncio.sleep(LOOK_S)

    async def look(self) -> None:
        while True:
            await self._keep_lease()
            try:
                if self.units is None:
                    self.units = Units.of(await self.call("axis.get_units"))
                self._know(State.of(await self.call("axis.get_state")))
            except Error as error:
                self._lose(str(error))
            await asyncio.sleep(LOOK_S)

    def _has_unit(self) -> bool:
        """By the state, which may be there before the units are."""
        return self._state is not None and self._state.unit is not None

    def _know(self, state: State | WatchedState) -> None:
        self._state, self._seen, self._trouble = state, self._bridge.now(), None
        self._bridge.changed.set()

    def _lose(self, why: str) -> None:
        """The units may be others when it comes back."""
        self._trouble, self.units = why, None
        self._bridge.changed.set()

    async def _begin(
        self, method: str | None, said: Mapping[str, Any], end: Callable[[], Awaitable[None]]
    ) -> None:
        """All of it within the time that its caller waits for: nothing moves for a caller who has
        given up. A movement that may have begun, and failed for the caller, is stopped."""
        self._bridge.check_awake()
        if (trouble := self.trouble) is not None:
            raise Error(trouble, name="axis_lost", outcome=NOT_SENT)
        stops = self._stops
        try:
            async with asyncio.timeout(ANSWER_S), self._beginning:
                await self._take_lease()
                if self._stops != stops:
                    message = f"axis '{self.name}' was stopped meanwhile"
                    raise Error(message, name="superseded_by_stop", outcome=NOT_SENT)
                if method is not None:
                    await self.call(method, **said, **self._lease)
                self._know(State.of(await self.call("axis.get_state")))
                self._follow(end)
        except TimeoutError:
            self._bridge.later(self._abandon(UNKNOWN))
            raise _no_answer(method or "axis.get_state") from None
        except Error as error:
            self._bridge.later(self._abandon(error.outcome))
            raise

    def _follow(self, end: Callable[[], Awaitable[None]]) -> None:
        if self._following is not None:
            self._following.cancel()
        self.ended_by = None
        self._following = asyncio.ensure_future(self._until(end))
        self._bridge.changed.set()

    async def _until(self, end: Callable[[], Awaitable[None]]) -> None:
        try:
            await end()
        except Error as error:
            self.ended_by = error
        try:
            self._know(State.of(await self.call("axis.get_state")))
        except Error as error:
            self._lose(str(error))
        async with self._beginning:
            self._following = None
            await self._give_lease()
        self._bridge.changed.set()

    async def _stand(self) -> None:
        assert self._bridge.gateway is not None
        await self._bridge.gateway.axis(self.name).wait()

    async def _abandon(self, outcome: str) -> None:
        async with self._beginning:
            try:
                if outcome == UNKNOWN:
                    await self.call("axis.stop")
            except Error:
                pass  # its lease runs out
            if self._following is None:
                await self._give_lease()

    async def _take_lease(self) -> None:
        assert self._bridge.gateway is not None
        if not self._lease:
            said = {"axes": [self.name], "ttl_ms": round(self._bridge.lease_ttl * 1000)}
            granted = await self._lease_call("lease.acquire", said)
            self._lease = {name: granted[name] for name in ("lease", "epoch")}

    async def _keep_lease(self) -> None:
        try:
            if self._lease:
                await self._lease_call("lease.renew", self._lease)
            elif self._in_session:
                await self._take_lease()
        except Error as error:
            if error.name != "too_many_requests":
                self._lease = {}

    async def _give_lease(self) -> None:
        """At a standstill: a stop would say something of the next movement."""
        if self._in_session or not self._lease:
            return
        lease, self._lease = self._lease, {}
        try:
            await self._lease_call("lease.release", {**lease, "stop": False})
        except Error:
            pass  # it is lost, which is as good

    async def _lease_call(self, method: str, said: Mapping[str, Any]) -> Mapping[str, Any]:
        assert self._bridge.gateway is not None
        try:
            return await asyncio.wait_for(self._bridge.gateway.call(method, said), ANSWER_S)
        except TimeoutError:
            raise _no_answer(method) from None


def _no_answer(method: str) -> Error:
    message = f"{method}: tmcld does not answer within {ANSWER_S:g} s"
    return Error(message, name="no_answer", outcome=UNKNOWN)
