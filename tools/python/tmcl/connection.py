"""Calls to a daemon, by asyncio: who waits for which answer, and what is asked again."""

from __future__ import annotations

import asyncio
import os
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from .engine import Answer, Engine, Failure, Hello, Message, Notification
from .errors import NOT_SENT, ConnectionLost, Error, NotConnected, garbage
from .link import OPENING_S, READ_BYTES, Link, OpenLink
from .methods import EFFECTS, WatchedState
from .systems import check_process

#: When the daemon has said nothing for so long while a call waits, it is asked something easy;
#: when that is not answered either, the connection counts as lost.
SILENCE_S = 5.0
#: So long a daemon that is not there is waited for before something is done, rather than read.
PATIENCE_TO_ACT_S = 2.0
#: So often one call is repeated at most.
MOST_REPEATS = 5
FIRST_PAUSE_S = 0.05
LONGEST_PAUSE_S = 1.0
#: Of states not taken yet; the oldest are dropped.
MOST_STATES = 65_536
# These do not get better by waiting.
_HOPELESS = ("bad_certificate", "garbage", "too_many_clients")

Said = Mapping[str, Any]


class States:
    """What a subscription has told, not taken yet."""

    def __init__(self) -> None:
        self.waiting: deque[WatchedState] = deque(maxlen=MOST_STATES)
        self.dropped = 0
        self.lost: Error | None = None
        self._changed = asyncio.Event()

    def add(self, said: Said) -> None:
        self.dropped += len(self.waiting) == MOST_STATES
        dropped = said.get("dropped")
        self.dropped += dropped if isinstance(dropped, int) else 0
        self.waiting.append(WatchedState.of(said))
        self._changed.set()

    def lose(self, why: Error) -> None:
        self.lost = why
        self._changed.set()

    async def next(self) -> WatchedState:
        """Raises ConnectionLost when there is nothing more to come."""
        while not self.waiting:
            if self.lost is not None:
                raise self.lost
            self._changed.clear()
            await self._changed.wait()
        return self.waiting.popleft()


class _Waiting(NamedTuple):
    method: str
    future: asyncio.Future[Said]
    at_answer: Callable[[Said], None] | None


class Live:
    """One connection while it lasts."""

    def __init__(self, link: Link, silence_s: float) -> None:
        self.link = link
        self.lost: Error | None = None
        self.hello: Hello | None = None
        self.when_lost: list[Callable[[Error], None]] = []
        self._engine = Engine(link.framing)
        self._waiting: dict[int, _Waiting] = {}
        self._process = os.getpid()
        self._returns: set[asyncio.Task[None]] = set()
        self._subscriptions: dict[int, States] = {}
        self._greeted = asyncio.Event()
        self._silence_s = silence_s
        loop = asyncio.get_running_loop()
        self._last_heard = loop.time()
        self._tasks = [loop.create_task(self._read()), loop.create_task(self._watch_over())]

    async def greeting(self) -> None:
        try:
            await asyncio.wait_for(self._greeted.wait(), OPENING_S)
        except asyncio.TimeoutError:
            await self.close("it does not say hello")
        if self.lost is not None:
            raise NotConnected(
                f"{self.link.name}: {self.lost.message}",
                name=self.lost.name,
                outcome=NOT_SENT,
                hint=self.lost.hint,
            )

    async def call(
        self, method: str, params: Said, at_answer: Callable[[Said], None] | None = None
    ) -> Said:
        """`at_answer` is called with the answer before anything that came after it is looked at.
        What the answer brings to a caller who has given up meanwhile is given back."""
        check_process(self._process)
        if self.lost is not None:
            raise ConnectionLost(
                f"{method}: {self.lost.message}", name="connection_lost", outcome=NOT_SENT
            )
        number, request = self._engine.call(method, params)
        future: asyncio.Future[Said] = asyncio.get_running_loop().create_future()
        self._waiting[number] = _Waiting(method, future, at_answer)
        self._write(request)
        try:
            return await future
        except asyncio.CancelledError:
            if future.done() and not future.cancelled() and future.exception() is None:
                self._give_back(method, future.result())
            raise

    async def subscribe(self, axes: list[str], interval_ms: int, states: States) -> int:
        params: dict[str, Any] = {"interval_ms": interval_ms}
        if axes:
            params["axes"] = axes

        def begin(answer: Said) -> None:
            self._subscriptions[answer["subscription"]] = states
            for state in answer["states"]:
                states.add(state)

        number: int = (await self.call("subscribe", params, begin))["subscription"]
        return number

    async def unsubscribe(self, number: int) -> None:
        self._subscriptions.pop(number, None)
        await self._quietly("unsubscribe", {"subscription": number})

    async def close(self, why: str = "the connection was closed here") -> None:
        self._end(ConnectionLost(why, name="connection_lost", outcome=NOT_SENT))
        try:
            await asyncio.wait_for(self.link.writer.wait_closed(), 1.0)
        except (OSError, asyncio.TimeoutError):
            pass

    def _write(self, data: bytes) -> None:
        if data and not self.link.writer.is_closing():
            self.link.writer.write(data)

    async def _read(self) -> None:
        try:
            while data := await self.link.reader.read(READ_BYTES):
                self._last_heard = asyncio.get_running_loop().time()
                self._receive(data)
            self._end(_lost("tmcld has closed the connection"))
        except Error as error:
            self._end(error)
        except OSError as error:
            self._end(_lost(f"the connection broke: {error}"))
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            self._end(garbage(f"an answer that lacks something: {error!r}"))

    def _receive(self, data: bytes) -> None:
        try:
            for message in self._engine.receive(data):
                self._take(message)
        finally:
            self._write(self._engine.to_send())

    def _take(self, message: Message) -> None:
        if isinstance(message, Hello):
            self.hello = message
            self._greeted.set()
        elif isinstance(message, Notification):
            states = self._subscriptions.get(message.params.get("subscription", -1))
            if message.method == "notify_state" and states is not None:
                states.add(message.params)
        else:
            self._answer(message)

    def _answer(self, message: Answer | Failure) -> None:
        waiting = self._waiting.get(message.id)
        if waiting is None:
            return
        if waiting.future.done():  # its caller has given up
            if isinstance(message, Answer):
                self._give_back(waiting.method, message.result)
        elif isinstance(message, Failure):
            waiting.future.set_exception(message.error)
        else:
            if waiting.at_answer is not None:
                waiting.at_answer(message.result)
            waiting.future.set_result(message.result)
        del self._waiting[message.id]

    def _give_back(self, method: str, result: Said) -> None:
        """Only this answer names it: no other program can."""
        if method == "lease.acquire":
            key = {name: result[name] for name in ("lease", "epoch")}
            work = self._quietly("lease.release", {**key, "stop": False})
        elif method == "subscribe":
            work = self.unsubscribe(result["subscription"])
        else:
            return
        task = asyncio.get_running_loop().create_task(work)
        self._returns.add(task)
        task.add_done_callback(self._returns.discard)

    async def _quietly(self, method: str, params: Said) -> None:
        try:
            await self.call(method, params)
        except Error:
            pass  # it has ended with its connection

    async def _watch_over(self) -> None:
        """A connection that is there and says nothing is lost, too."""
        loop = asyncio.get_running_loop()
        while self.lost is None:
            await asyncio.sleep(self._silence_s / 5)
            silent_for = loop.time() - self._last_heard
            if not self._engine.is_waiting and not self._subscriptions:
                self._last_heard = loop.time()
            elif silent_for > 2 * self._silence_s:
                self._end(_lost(f"tmcld has said nothing for {silent_for:.0f} s"))
            elif silent_for > self._silence_s:
                await self._probe()

    async def _probe(self) -> None:
        try:
            await asyncio.wait_for(self.call("bus.list", {}), self._silence_s)
        except (Error, asyncio.TimeoutError):
            pass  # what silence means is decided by the clock

    def _end(self, why: Error) -> None:
        if self.lost is not None:
            return
        self.lost = why
        self._greeted.set()
        self.link.writer.close()
        lost = self._engine.lose(why.message)
        for number, waiting in self._waiting.items():
            if not waiting.future.done():
                waiting.future.set_exception(lost.get(number) or _lost(why.message))
        self._waiting.clear()
        for states in self._subscriptions.values():
            states.lose(why)
        for tell in self.when_lost:
            tell(why)
        here = asyncio.current_task()
        for task in self._tasks:
            if task is not here:
                task.cancel()


def _lost(why: str) -> ConnectionLost:
    return ConnectionLost(why, name="connection_lost", outcome="unknown")


def _is_hopeless(error: NotConnected) -> bool:
    """A refusal by HTTP that says that something is wrong with what was asked for."""
    return error.name in _HOPELESS or 400 <= int(error.data.get("status", 0)) < 500


class Connection:
    """Calls, over connections that come and go. What reads or stops is asked again when its
    answer was lost; what sets or moves something never is."""

    def __init__(
        self, open_link: OpenLink, patience_s: float, silence_s: float = SILENCE_S
    ) -> None:
        self._open_link = open_link
        self._patience_s = patience_s
        self._silence_s = silence_s
        self._live: Live | None = None
        self._opening = asyncio.Lock()
        self._closed = False
        self._process = os.getpid()

    async def call(self, method: str, params: Said) -> Said:
        repeatable = EFFECTS.get(method) in ("reads", "stops")
        patience = self._patience_s if repeatable else PATIENCE_TO_ACT_S
        for _ in range(MOST_REPEATS):
            live = await self.live(patience)
            try:
                return await live.call(method, params)
            except ConnectionLost as lost:
                if not repeatable or self._closed:
                    raise
                last = lost
        raise last

    async def live(self, patience_s: float | None = None) -> Live:
        """The connection, made anew if need be. Raises NotConnected after so long."""
        check_process(self._process)
        patience = self._patience_s if patience_s is None else min(patience_s, self._patience_s)
        async with self._opening:
            if self._live is None or self._live.lost is not None:
                self._live = await self._open(patience)
            return self._live

    async def close(self) -> None:
        self._closed = True
        if self._live is not None and os.getpid() == self._process:
            await self._live.close()

    async def _open(self, patience_s: float) -> Live:
        loop = asyncio.get_running_loop()
        until = loop.time() + patience_s
        pause = FIRST_PAUSE_S
        while True:
            try:
                return await self._open_once()
            except NotConnected as error:
                left = until - loop.time()
                if self._closed or left <= 0 or _is_hopeless(error):
                    raise
                await asyncio.sleep(min(pause, left))
                pause = min(2 * pause, LONGEST_PAUSE_S)

    async def _open_once(self) -> Live:
        if self._closed:
            raise NotConnected("it was closed", name="closed", outcome=NOT_SENT)
        try:
            link = await asyncio.wait_for(self._open_link(), OPENING_S)
        except asyncio.TimeoutError:
            raise NotConnected(
                f"no connection within {OPENING_S:.0f} s",
                name="not_connected",
                outcome=NOT_SENT,
                hint="Is the gateway switched on, and its port open?",
            ) from None
        live = Live(link, self._silence_s)
        await live.greeting()
        return live
