"""The methods of tmcld and what they give.

Drawn by tools/python/draw_methods from rpc.discover: change nothing here.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from .record import Record

#: What each method does to a machine at most: reads, writes, moves or stops.
EFFECTS: Mapping[str, str] = {
    "rpc.discover": "reads",
    "bus.list": "reads",
    "bus.trace": "reads",
    "bus.scan": "reads",
    "doctor.examine": "reads",
    "module.list": "reads",
    "module.execute": "moves",
    "axis.list": "reads",
    "axis.move_to": "moves",
    "axis.move_by": "moves",
    "axis.rotate": "moves",
    "axis.jog": "moves",
    "axis.resonance": "moves",
    "axis.stop": "stops",
    "axis.wait": "reads",
    "lease.acquire": "writes",
    "lease.renew": "writes",
    "lease.release": "stops",
    "lease.list": "reads",
    "lease.break": "writes",
    "token.add": "writes",
    "token.list": "reads",
    "token.invite": "writes",
    "token.revoke": "writes",
    "client.list": "reads",
    "audit.tail": "reads",
    "page.find": "reads",
    "configuration.get": "reads",
    "configuration.set": "writes",
    "speak_for": "reads",
    "line.move": "moves",
    "path.stage": "reads",
    "path.plan": "reads",
    "path.run": "moves",
    "path.pause": "writes",
    "path.resume": "moves",
    "path.status": "reads",
    "path.feed": "moves",
    "path.stop": "stops",
    "mint.run": "moves",
    "axis.get_ramp": "reads",
    "axis.plan_ramp": "reads",
    "axis.set_ramp": "writes",
    "ramp.compare": "reads",
    "ramp.find": "reads",
    "profile.simulate": "reads",
    "profile.solve": "reads",
    "axis.home": "moves",
    "axis.start_home": "moves",
    "axis.stop_home": "stops",
    "axis.recover": "writes",
    "axis.set_deadman": "writes",
    "axis.test_deadman": "moves",
    "axis.tune": "moves",
    "axis.verify": "moves",
    "capture.start": "writes",
    "capture.state": "reads",
    "capture.read": "reads",
    "capture.end": "writes",
    "axis.get_state": "reads",
    "axis.get_errors": "reads",
    "axis.get_units": "reads",
    "parameter.get": "reads",
    "parameter.set": "moves",
    "parameter.store": "writes",
    "parameter.restore": "moves",
    "parameter.list": "reads",
    "settings.read": "reads",
    "settings.compare": "reads",
    "settings.load": "writes",
    "settings.store": "writes",
    "coordinate.get": "reads",
    "coordinate.set": "writes",
    "coordinate.capture": "writes",
    "coordinate.move": "moves",
    "coordinate.start": "moves",
    "coordinate.store": "writes",
    "coordinate.load": "writes",
    "global.get": "reads",
    "global.set": "writes",
    "global.store": "writes",
    "global.restore": "writes",
    "io.get": "reads",
    "io.set": "writes",
    "module.info": "reads",
    "module.report_arrivals": "writes",
    "module.reset": "moves",
    "module.factory_reset": "moves",
    "program.assemble": "reads",
    "program.load": "writes",
    "program.compare": "reads",
    "program.read": "reads",
    "program.run": "moves",
    "program.stop": "writes",
    "program.step": "moves",
    "program.step_to": "moves",
    "program.reset": "writes",
    "program.status": "reads",
    "program.set_breakpoint": "writes",
    "program.clear_breakpoint": "writes",
    "program.clear_breakpoints": "writes",
    "firmware.status": "reads",
    "firmware.stage": "reads",
    "firmware.upload": "moves",
    "system.stop_all": "stops",
    "subscribe": "reads",
    "unsubscribe": "reads",
}


@dataclass(frozen=True)
class RpcDiscoverMethodsParams(Record):
    #: what it is called
    name: str = ""
    #: what it is in JSON
    type: str = ""
    #: of a parameter
    required: bool | None = None
    #: of a parameter that is an integer
    minimum: int | None = None
    #: of a parameter that is an integer
    maximum: int | None = None
    #: what it means
    summary: str = ""
    #: of an object, or of each object of an array
    members: tuple[Mapping[str, Any], ...] | None = None


@dataclass(frozen=True)
class RpcDiscoverMethods(Record):
    #: what it is called
    name: str = ""
    #: what it does
    summary: str = ""
    #: what it does to a machine at most: reads, writes, moves or stops
    effect: str = ""
    #: who may call it: stop, observe, operate or configure
    role: str = ""
    #: what it takes
    params: tuple[RpcDiscoverMethodsParams, ...] = ()
    #: what it gives
    result: tuple[RpcDiscoverMethodsParams, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"params": RpcDiscoverMethodsParams, "result": RpcDiscoverMethodsParams}


@dataclass(frozen=True)
class RpcDiscover(Record):
    #: every method
    methods: tuple[RpcDiscoverMethods, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"methods": RpcDiscoverMethods}


@dataclass(frozen=True)
class Counters(Record):
    #: datagrams sent
    requests: int = 0
    #: answers accepted
    replies: int = 0
    #: requests without an answer in time
    timeouts: int = 0
    #: answers to requests that had been given up; dropped
    late_replies: int = 0
    #: answers to nothing that was asked, or from another module; dropped
    unexpected_replies: int = 0
    #: bytes that belong to no datagram
    garbage_bytes: int = 0
    #: exchanges that proved that a module is in step, or that what it had answered before was
    #: right
    fences: int = 0
    #: replies beyond what a module was asked for; dropped
    surplus: int = 0
    #: answers that were given out only when a further exchange had proven them: on a line that
    #: loses, doubles or delays replies, and wherever a movement depends on the value
    suspect: int = 0


@dataclass(frozen=True)
class BusListBusesHeard(Record):
    #: nothing, answers, wrong_checksums, foreign, echo, text, other_baud_rate, noise
    kind: str = ""
    #: how many came in
    bytes: int = 0
    #: the first whole line of it, up to 40 characters
    text: str | None = None
    #: the same in a sentence
    meaning: str = ""
    #: what to try; absent after answers
    hint: str | None = None


@dataclass(frozen=True)
class Bus(Record):
    #: name of the bus
    name: str = ""
    #: how it is reached
    link: str = ""
    #: opening, open, lost
    state: str = ""
    #: why it is not open
    error: str | None = None
    #: bits a second on its wire; null where it is unknown: TCP, USB, virtual CAN
    bit_rate: int | None = None
    #: since the daemon started
    counters: Counters = field(default_factory=lambda: Counters())
    #: what came in since it was opened or scanned last; null on CAN
    heard: BusListBusesHeard | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"counters": Counters, "heard": BusListBusesHeard}


@dataclass(frozen=True)
class BusList(Record):
    #: the buses
    buses: tuple[Bus, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"buses": Bus}


@dataclass(frozen=True)
class BusTraceDatagrams(Record):
    #: counts what went over the bus, from 1 on
    number: int = 0
    #: when, in microseconds since 1970
    utc_us: int = 0
    #: out: to the modules; in: from them
    direction: str = ""
    #: in hexadecimal, as they were on the wire
    bytes: str = ""
    #: identifier of the frame, on CAN
    can_id: int | None = None
    #: true: that has 29 bits
    can_extended: bool | None = None
    #: true: they belong to no datagram
    garbage: bool | None = None
    #: who asked, or whose question it seems to answer; absent: the daemon itself
    client: str | None = None


@dataclass(frozen=True)
class BusTrace(Record):
    #: name of the bus
    bus: str = ""
    #: number of the newest one that there is
    last: int = 0
    #: how many after 'after' are not remembered any more
    dropped: int = 0
    #: the oldest first
    datagrams: tuple[BusTraceDatagrams, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"datagrams": BusTraceDatagrams}


@dataclass(frozen=True)
class BusScanModules(Record):
    #: name of the bus
    bus: str = ""
    #: address of the module
    address: int = 0
    #: model of the module; null if it has no name
    model: str | None = None
    #: its number
    model_number: int | None = None
    #: its version
    firmware: str | None = None
    #: how many motors it has
    axes: int | None = None
    #: no firmware runs
    in_bootloader: bool = False
    #: several have this address
    duplicate_suspected: bool = False
    #: it takes replies for commands
    address_is_reply_id: bool = False


@dataclass(frozen=True)
class BusScanFailed(Record):
    #: name of the bus
    bus: str = ""
    #: why it could not be scanned
    error: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class BusScanSilent(Record):
    #: name of the bus
    bus: str = ""
    #: what came in meanwhile; null on CAN
    heard: BusListBusesHeard | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"heard": BusListBusesHeard}


@dataclass(frozen=True)
class BusScan(Record):
    #: who has answered
    modules: tuple[BusScanModules, ...] = ()
    #: buses that could not be scanned
    failed: tuple[BusScanFailed, ...] = ()
    #: buses on which no module was found
    silent: tuple[BusScanSilent, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"modules": BusScanModules, "failed": BusScanFailed, "silent": BusScanSilent}


@dataclass(frozen=True)
class DoctorExamineFindings(Record):
    #: its name, such as supply
    check: str = ""
    #: the axis, the module (bench:1) or the bus; empty: tmcld itself
    subject: str = ""
    #: it keeps axes from moving, or may
    wrong: bool = False
    #: what is so, in a sentence
    text: str = ""
    #: what to do; null where nothing is wrong
    cure: str | None = None


@dataclass(frozen=True)
class DoctorExamine(Record):
    #: in the order in which to look at them
    findings: tuple[DoctorExamineFindings, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"findings": DoctorExamineFindings}


@dataclass(frozen=True)
class ModuleListModulesDeadman(Record):
    #: what the module is set to
    ms: int = 0
    #: after so many milliseconds without a command it has stopped
    measured: int = 0


@dataclass(frozen=True)
class Module(Record):
    #: name of the bus
    bus: str = ""
    #: address of the module
    address: int = 0
    #: model of the module; null if it has no name
    model: str | None = None
    #: its number
    model_number: int | None = None
    #: its version
    firmware: str | None = None
    #: how many motors it has
    axes: int | None = None
    #: unknown, ready, silent, in_bootloader
    state: str = ""
    #: several have this address
    duplicate_suspected: bool = False
    #: by what it is noticed that it has started again: tick, variable:N, settings, or none
    watched_by: str = ""
    #: whether it stops its motors when no host sends it anything: unknown, none, or what a
    #: test has found
    deadman: str | ModuleListModulesDeadman = ""
    #: whether they are as in the file that is configured: none (no file), unknown, as_file,
    #: differ
    settings: str = ""
    _inner: ClassVar[Mapping[str, type[Record]]] = {"deadman": ModuleListModulesDeadman}


@dataclass(frozen=True)
class ModuleList(Record):
    #: the modules
    modules: tuple[Module, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"modules": Module}


@dataclass(frozen=True)
class ModuleExecute(Record):
    #: status byte of the reply
    status: int = 0
    #: its standard name
    status_name: str = ""
    #: command byte of the reply
    command: int = 0
    #: value of the reply
    value: int = 0
    #: the firmware version where it came as text
    text: str | None = None
    #: such as that an axis turns for this connection only; null if there are none
    warnings: tuple[str, ...] | None = None


@dataclass(frozen=True)
class AxisInfo(Record):
    #: name of the axis
    name: str = ""
    #: name of its bus
    bus: str = ""
    #: address of its module
    address: int = 0
    #: number of its motor
    motor: int = 0
    #: model of its module; null if it is not known
    model: str | None = None
    #: unknown, ready, silent, in_bootloader, no_such_motor
    state: str = ""
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: what is wrong with its driver or its supply, as axis.get_errors names it
    faults: tuple[str, ...] = ()


@dataclass(frozen=True)
class AxisList(Record):
    #: the axes
    axes: tuple[AxisInfo, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"axes": AxisInfo}


@dataclass(frozen=True)
class StartedMove(Record):
    #: where the move ends
    target_microsteps: int = 0
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: where it ends, in the unit
    target: float | None = None
    #: how many seconds it will take; null where it cannot be foreseen
    predicted_s: float | None = None
    #: warnings about its settings, and why the move cannot be foreseen
    warnings: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Turning(Record):
    #: speed in the module's own unit
    velocity_internal: int = 0
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: speed in the unit per second
    velocity: float | None = None
    #: such as that it is faster than max_velocity, which holds for positions
    warnings: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Jogging(Record):
    #: where it comes to rest without a further call
    target_microsteps: int = 0
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: the same in the unit
    target: float | None = None
    #: when it begins to brake without a further call, by CLOCK_MONOTONIC of tmcld's computer
    until_ms: int = 0
    #: such as that the journal cannot be written
    warnings: tuple[str, ...] | None = None


@dataclass(frozen=True)
class MeasuredResonance(Record):
    #: name of the axis
    axis: str = ""
    #: rings: the next three are known; still: its encoder stood as soon as the motor; unclear:
    #: it did neither
    verdict: str = ""
    #: how fast the load swings behind the motor
    resonance_hz: float | None = None
    #: of its swings, 0 to less than 1
    damping: float | None = None
    #: how far it swung to either side when the motor had arrived, as its encoder counts
    swing: float | None = None
    #: the part of what the encoder did then that this explains, 0 to 1
    confidence: float = 0.0
    #: what swings more slowly is not seen in readings over this time
    lowest_hz: float = 0.0
    #: what swings faster is not seen in so few readings a second
    highest_hz: float = 0.0
    #: how many of the encoder
    readings: int = 0
    #: the module has recorded them by itself, by command 142; else the bus was asked
    recorded: bool = False
    #: over which time, in seconds
    readings_s: float = 0.0
    #: how far the move went
    distance_microsteps: int = 0
    #: the greatest velocity of the move, in microsteps per second
    velocity_pps: float = 0.0
    #: its acceleration, per second squared
    acceleration_pps2: float = 0.0
    #: warnings about moves with its settings
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Standing(Record):
    #: where it is
    position_microsteps: int = 0
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: where it is, in the unit
    position: float | None = None
    #: warnings about moves with its settings
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class GrantedLease(Record):
    #: number of the lease
    lease: int = 0
    #: proves that a call is made under this lease
    epoch: int = 0
    #: its axes
    axes: tuple[str, ...] = ()
    #: how soon it has to be renewed
    ttl_ms: int = 0
    #: that its axes are not stopped if tmcld is killed, and why; null if they are
    warnings: tuple[str, ...] | None = None


@dataclass(frozen=True)
class LeaseListLeases(Record):
    #: number of the lease
    lease: int = 0
    #: its axes
    axes: tuple[str, ...] = ()
    #: who has it
    holder: str = ""
    #: for how long
    since_s: float = 0.0
    #: when it ends unless it is renewed
    expires_ms: int = 0


@dataclass(frozen=True)
class LeaseList(Record):
    #: the leases there are
    leases: tuple[LeaseListLeases, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"leases": LeaseListLeases}


@dataclass(frozen=True)
class TokenAdd(Record):
    #: what it is called
    name: str = ""
    #: what its bearer may do: observe, operate or configure
    role: str = ""
    #: the token, which is told this once and kept nowhere
    token: str = ""


@dataclass(frozen=True)
class TokenListTokens(Record):
    #: what it is called
    name: str = ""
    #: what its bearer may do: observe, operate or configure
    role: str = ""
    #: when it was made, in UTC
    made: str = ""


@dataclass(frozen=True)
class TokenList(Record):
    #: the tokens there are
    tokens: tuple[TokenListTokens, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"tokens": TokenListTokens}


@dataclass(frozen=True)
class TokenInvite(Record):
    #: what it is called
    name: str = ""
    #: what its bearer may do: observe, operate or configure
    role: str = ""
    #: signs a browser in once, by POST /session, where the token itself would
    code: str = ""
    #: until it does no more
    ends_in_s: float = 0.0


@dataclass(frozen=True)
class ClientListClients(Record):
    #: who it is, as other methods tell it
    client: str = ""
    #: by which it came: socket; http or websocket; port, where hosts speak TMCL; process, that
    #: of the gateway itself
    door: str = ""
    #: where it is; null: on this computer
    address: str | None = None
    #: number of its user; null: not of this computer
    uid: int | None = None
    #: its process; null: not of this computer
    pid: int | None = None
    #: name of the token that let it in; null: none did
    token: str | None = None
    #: what it may do: stop, observe, operate or configure
    role: str = ""
    #: those that it has leased
    axes: tuple[str, ...] = ()
    #: for how long it has been connected
    since_s: float = 0.0
    #: its calls that are in progress; this one is among them
    requests: int = 0


@dataclass(frozen=True)
class ClientList(Record):
    #: who is connected; who came first is first
    clients: tuple[ClientListClients, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"clients": ClientListClients}


@dataclass(frozen=True)
class AuditTailLines(Record):
    #: counts what was audited since tmcld was started, from 1 on
    number: int = 0
    #: when, in microseconds since 1970
    utc_us: int = 0
    #: number of the user; null: the text says who it is
    uid: int | None = None
    #: the process; null: the text says who it is
    pid: int | None = None
    #: what was asked for, and what came of it
    text: str = ""


@dataclass(frozen=True)
class AuditTail(Record):
    #: number of the newest one that there is
    last: int = 0
    #: how many after 'after' are not remembered any more
    dropped: int = 0
    #: the oldest first
    lines: tuple[AuditTailLines, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"lines": AuditTailLines}


@dataclass(frozen=True)
class PageFind(Record):
    #: what a browser takes, such as https://gateway:4143; empty where nothing is served by
    #: HTTP
    addresses: tuple[str, ...] = ()


@dataclass(frozen=True)
class ConfigurationGet(Record):
    #: its path, which 'managed' in [daemon] names; null: nothing is set by clients
    file: str | None = None
    #: what stands in it; null: it is not there yet
    toml: str | None = None


@dataclass(frozen=True)
class ConfigurationSet(Record):
    #: it is another text than the one before
    changed: bool = False
    #: in words: what has become of the buses, or would
    buses: str = ""


@dataclass(frozen=True)
class SpeakFor(Record):
    #: who makes the calls, as audit and leases name them
    user: str = ""
    #: what that user may do: stop, observe, operate, configure
    role: str = ""


@dataclass(frozen=True)
class LineMoveAxes(Record):
    #: name of the axis
    axis: str = ""
    #: where it is to go
    target_microsteps: int = 0
    #: the same in its unit
    target: float | None = None
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: when it arrives
    predicted_s: float = 0.0


@dataclass(frozen=True)
class LineMove(Record):
    #: its axes, in the order of the request
    axes: tuple[LineMoveAxes, ...] = ()
    #: when the last of them arrives
    predicted_s: float = 0.0
    #: how much earlier the first of them does, as predicted
    spread_s: float = 0.0
    #: how far off the line they get, as predicted; a part of the longest way
    deviation: float = 0.0
    #: one command has started them all
    one_command: bool = False
    #: how long the starts were expected to take
    predicted_skew_s: float = 0.0
    #: from the first start to the last, as the answers tell
    skew_s: float = 0.0
    #: warnings about the settings of its axes
    warnings: tuple[str, ...] | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"axes": LineMoveAxes}


@dataclass(frozen=True)
class PathStage(Record):
    #: how many there are now
    bytes: int = 0


@dataclass(frozen=True)
class PathPlanCourseAxes(Record):
    #: of the file
    axis: str = ""
    #: least position of it
    least: float = 0.0
    #: greatest position
    greatest: float = 0.0
    #: how fast it gets
    top_speed: float = 0.0


@dataclass(frozen=True)
class PathPlanCourseSlowestCorners(Record):
    #: of the file
    line: int = 0
    #: when it is passed
    time_s: float = 0.0
    #: along the path
    speed: float = 0.0
    #: of each axis
    position: tuple[float, ...] = ()


@dataclass(frozen=True)
class PathPlanCourseWords(Record):
    #: of the word: 3, 4, 5, 7, 8 or 9
    number: int = 0
    #: how often it is carried out
    times: int = 0
    #: of the file, for the first time
    line: int = 0
    #: what it switches, as the configuration says it
    switches: str = ""


@dataclass(frozen=True)
class PathPlanCourse(Record):
    #: of the path
    length: float = 0.0
    #: how long it takes
    duration_s: float = 0.0
    #: how many it has
    legs: int = 0
    #: of the file
    axes: tuple[PathPlanCourseAxes, ...] = ()
    #: where it gets slowest; five at most
    slowest_corners: tuple[PathPlanCourseSlowestCorners, ...] = ()
    #: which M words are carried out on it
    words: tuple[PathPlanCourseWords, ...] = ()
    #: how often it waits at M0 until path.resume
    waits: int = 0
    _inner: ClassVar[Mapping[str, type[Record]]] = {"axes": PathPlanCourseAxes, "slowest_corners": PathPlanCourseSlowestCorners, "words": PathPlanCourseWords}


@dataclass(frozen=True)
class PathPlanCurve(Record):
    #: of its points
    times_s: tuple[float, ...] = ()
    #: of each axis at each of them
    positions: tuple[tuple[float, ...], ...] = ()


@dataclass(frozen=True)
class PathPlanExpected(Record):
    #: velocity, segments or position
    mode: str = ""
    #: how far from the path the axes get, in the unit of the file
    off_path: float = 0.0
    #: when they are so far off, in seconds of the course
    off_path_at_s: float = 0.0
    #: where each axis is then
    off_path_at: tuple[float, ...] = ()
    #: how late on the path they get
    lag_s: float = 0.0
    #: how much of the course was foreseen; of a long one only the beginning
    foreseen_s: float = 0.0
    #: whether off_path stays within the tolerance
    keeps_tolerance: bool = False
    #: why the path cannot be passed in this mode, or would be ended; null if it can
    refused: str | None = None


@dataclass(frozen=True)
class PathPlanShapingAxes(Record):
    #: of the file
    axis: str = ""
    #: of its load after the path, to either side
    swing: float = 0.0
    #: the same without the shaper
    unshaped_swing: float = 0.0


@dataclass(frozen=True)
class PathPlanShaping(Record):
    #: zv, zvd or ei
    shaper: str = ""
    #: which it is for
    resonance_hz: float = 0.0
    #: of those swings
    damping: float = 0.0
    #: than the path takes without it
    longer_s: float = 0.0
    #: how far it leaves the path at most: it cuts corners
    off_path: float = 0.0
    #: when that is, in seconds of the course
    off_path_at_s: float = 0.0
    #: what it leaves of their swings
    axes: tuple[PathPlanShapingAxes, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"axes": PathPlanShapingAxes}


@dataclass(frozen=True)
class PathPlanJerkAxes(Record):
    #: of the file
    axis: str = ""
    #: of its load after the path, to either side
    swing: float = 0.0
    #: the same without the jerk
    unlimited_swing: float = 0.0


@dataclass(frozen=True)
class PathPlanJerk(Record):
    #: along the path, at most
    jerk: float = 0.0
    #: than the path takes without it
    longer_s: float = 0.0
    #: of the loads that are told of; null: none
    resonance_hz: float | None = None
    #: what it leaves of their swings
    axes: tuple[PathPlanJerkAxes, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"axes": PathPlanJerkAxes}


@dataclass(frozen=True)
class PathPlan(Record):
    #: by which path.run runs it, once; the daemon keeps the last one
    plan: int = 0
    #: in the order of the file's
    axes: tuple[str, ...] = ()
    #: where it leads, and how fast
    course: PathPlanCourse = field(default_factory=lambda: PathPlanCourse())
    #: to draw it; null unless points are asked for
    curve: PathPlanCurve | None = None
    #: what is expected in each mode, the one that was asked for first; empty where the ramps
    #: of an axis are not described
    expected: tuple[PathPlanExpected, ...] = ()
    #: warnings about the settings of its axes, and what of the file is not carried out
    warnings: tuple[str, ...] = ()
    #: what the shaper makes of it; null without one
    shaping: PathPlanShaping | None = None
    #: what the jerk makes of it; null without one
    jerk: PathPlanJerk | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"course": PathPlanCourse, "curve": PathPlanCurve, "expected": PathPlanExpected, "shaping": PathPlanShaping, "jerk": PathPlanJerk}


@dataclass(frozen=True)
class PathRunTrackingError(Record):
    #: how far off its plan it was seen
    largest: float = 0.0
    #: root of the mean square
    rms: float = 0.0
    #: how often it was looked at
    readings: int = 0
    #: name of the axis
    axis: str = ""


@dataclass(frozen=True)
class PathRunMotors(Record):
    #: of each axis that has an encoder
    tracking_error: tuple[PathRunTrackingError, ...] = ()
    #: how far from the path the motors were seen at most, in the unit of the file; where an
    #: axis has no encoder, its position counts
    off_path: float = 0.0
    #: when that was, in seconds of the course
    off_path_at_s: float = 0.0
    #: where each motor was then
    off_path_at: tuple[float, ...] = ()
    #: how late on the path they were seen at most
    lag_s: float = 0.0
    #: by how much off_path is more than the tolerance, at least; null if it is not
    tolerance_exceeded_by: float | None = None
    #: where the motors were seen, over the course; null unless points are asked for
    seen: PathPlanCurve | None = None
    #: the nearest point of the path to each of these
    on_path: PathPlanCurve | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"tracking_error": PathRunTrackingError, "seen": PathPlanCurve, "on_path": PathPlanCurve}


@dataclass(frozen=True)
class PathRun(Record):
    #: how long it took
    passed_s: float = 0.0
    #: of velocities; of segments; legs in position mode
    updates: int = 0
    #: between updates; the least that a segment takes; of the shortest leg in position mode
    period_ms: float = 0.0
    #: of an update, or of the load of a leg
    worst_delay_ms: float = 0.0
    #: sent meanwhile
    commands: int = 0
    #: of them
    commands_per_s: float = 0.0
    #: part of the time that they took
    bus_load: float = 0.0
    #: of a command, measured before
    round_trip_us: float = 0.0
    #: of each axis
    tracking_error: tuple[PathRunTrackingError, ...] = ()
    #: how far from the path the axes were seen at most, in the unit of the file; between two
    #: readings they may have been farther off
    off_path: float = 0.0
    #: when that was, in seconds of the course
    off_path_at_s: float = 0.0
    #: where each axis was then
    off_path_at: tuple[float, ...] = ()
    #: how late on the path they were seen at most
    lag_s: float = 0.0
    #: by how much off_path is more than the tolerance, at least; null if it is not
    tolerance_exceeded_by: float | None = None
    #: what else is to be said, such as of a parameter not set back
    remarks: tuple[str, ...] = ()
    #: where the axes were seen, over the course; null unless points are asked for
    seen: PathPlanCurve | None = None
    #: the nearest point of the path to each of these
    on_path: PathPlanCurve | None = None
    #: the same by the encoders of the axes; null unless the configuration names one, and it
    #: was read
    motors: PathRunMotors | None = None
    #: warnings about the settings of its axes, and what of the file is not carried out
    warnings: tuple[str, ...] = ()
    #: what was expected before it began, as path.plan says; empty of a path that was planned
    #: before
    expected: tuple[PathPlanExpected, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"tracking_error": PathRunTrackingError, "seen": PathPlanCurve, "on_path": PathPlanCurve, "motors": PathRunMotors, "expected": PathPlanExpected}


@dataclass(frozen=True)
class PathPause(Record):
    #: of the paths concerned
    axes: tuple[str, ...] = ()


@dataclass(frozen=True)
class PathStatusPaths(Record):
    #: in the order of the file's
    axes: tuple[str, ...] = ()
    #: what path.run calls it
    name: str | None = None
    #: velocity, segments or position
    mode: str = ""
    #: approaching, measuring, running, pausing, waiting or ending
    phase: str = ""
    #: how much of its course has been passed, in seconds of that
    passed_s: float = 0.0
    #: how long the course takes as it was planned
    duration_s: float = 0.0
    #: what part of it has been passed; 0 to 1
    done: float = 0.0
    #: how long the rest takes with the present override, or with 1 if that is greater; null
    #: while it is held
    left_s: float | None = None
    #: of the file, on which it is; null in a table with times
    line: int | None = None
    #: whether it stands on its path, or is about to
    held: bool = False
    #: the override: what part of the planned speed is asked for
    factor: float = 0.0
    #: what there is of it now; less than is asked for while it changes, and where an axis can
    #: do no more
    factor_now: float = 0.0
    #: the speed that the course has here
    planned_feed: float = 0.0
    #: the speed that there is: factor_now of it
    feed: float = 0.0
    #: how far from the path the axes were seen so far
    off_path: float = 0.0
    #: when that was, in seconds of the course
    off_path_at_s: float = 0.0
    #: how late on the path they were seen so far
    lag_s: float = 0.0
    #: of the file, of the M0 at which it waits until path.resume; null if it does not
    waits_at_line: int | None = None


@dataclass(frozen=True)
class PathStatus(Record):
    #: those concerned
    paths: tuple[PathStatusPaths, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"paths": PathStatusPaths}


@dataclass(frozen=True)
class MintRunGroups(Record):
    #: of its GO
    line: int = 0
    #: how long it was to take
    planned_s: float = 0.0
    #: how long it took
    took_s: float = 0.0


@dataclass(frozen=True)
class MintRun(Record):
    #: one for each GO
    groups: tuple[MintRunGroups, ...] = ()
    #: what else is to be said, such as of a parameter not set back
    remarks: tuple[str, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"groups": MintRunGroups}


@dataclass(frozen=True)
class AxisGetRampSettings(Record):
    #: standard name of the axis parameter
    parameter: str = ""
    #: its number
    number: int = 0
    #: what it is set to
    value: int = 0


@dataclass(frozen=True)
class AxisGetRampTraits(Record):
    #: as a report of axis.verify names it, such as last_step
    trait: str = ""
    #: which one the module has, such as r3
    variant: str = ""


@dataclass(frozen=True)
class AxisGetRamp(Record):
    #: model of its module
    model: str = ""
    #: where it stands; with `in_motion`, where it was a moment ago
    position_microsteps: int = 0
    #: every parameter that makes a difference to its ramps, in the order in which to give them
    #: to its twin
    settings: tuple[AxisGetRampSettings, ...] = ()
    #: what the configuration says of its module
    traits: tuple[AxisGetRampTraits, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"settings": AxisGetRampSettings, "traits": AxisGetRampTraits}


@dataclass(frozen=True)
class AxisPlanRamp(Record):
    #: name of the axis
    axis: str = ""
    #: model of its module
    model: str = ""
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: what the settings give, in microsteps per second
    velocity_pps: float = 0.0
    #: the same in the unit per second
    velocity: float | None = None
    #: the same, per second squared
    acceleration_pps2: float = 0.0
    #: the same in the unit
    acceleration: float | None = None
    #: the same, of braking
    deceleration_pps2: float = 0.0
    #: the same in the unit
    deceleration: float | None = None
    #: the same, per second cubed; null for an acceleration that changes at once
    jerk_pps3: float | None = None
    #: the same in the unit
    jerk: float | None = None
    #: how long it takes to get up to speed
    ramp_s: float = 0.0
    #: how far it goes meanwhile
    ramp_microsteps: float = 0.0
    #: what makes the ramp
    settings: tuple[AxisGetRampSettings, ...] = ()
    #: what it will do instead where the module cannot do what was asked
    remarks: tuple[str, ...] = ()
    #: warnings about moves with its settings
    warnings: tuple[str, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"settings": AxisGetRampSettings}


@dataclass(frozen=True)
class RampCompareRamps(Record):
    #: what makes it, beside the velocity and the accelerations that all have
    settings: tuple[AxisGetRampSettings, ...] = ()
    #: how long the move takes; null where it does not come to rest on its target
    move_s: float | None = None
    #: the longest part of it in which the speed changes one way
    longest_phase_s: float = 0.0
    #: how far the load swings to either side when the motor has arrived; null without one
    swing_microsteps: float | None = None
    #: the same in the unit
    swing: float | None = None
    #: when the load swings by no more than the tolerance; null if it never does
    settled_s: float | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"settings": AxisGetRampSettings}


@dataclass(frozen=True)
class RampCompare(Record):
    #: name of the axis
    axis: str = ""
    #: model of its module
    model: str = ""
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: how far the move goes
    distance_microsteps: int = 0
    #: within which the load is to stand; null without a load
    tolerance_microsteps: float | None = None
    #: the steepest first
    ramps: tuple[RampCompareRamps, ...] = ()
    #: which of them, from 0 on, has its load stand first; null without a load
    proposed: int | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"ramps": RampCompareRamps}


@dataclass(frozen=True)
class RampFind(Record):
    #: name of the axis
    axis: str = ""
    #: model of its module
    model: str = ""
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: what the settings give, in microsteps per second
    velocity_pps: float = 0.0
    #: the same in the unit per second
    velocity: float | None = None
    #: the same, per second squared
    acceleration_pps2: float = 0.0
    #: the same in the unit
    acceleration: float | None = None
    #: the same, of braking
    deceleration_pps2: float = 0.0
    #: the same in the unit
    deceleration: float | None = None
    #: the same, per second cubed; null for an acceleration that changes at once
    jerk_pps3: float | None = None
    #: the same in the unit
    jerk: float | None = None
    #: how long it takes to get up to speed
    ramp_s: float = 0.0
    #: how far it goes meanwhile
    ramp_microsteps: float = 0.0
    #: what makes the ramp
    settings: tuple[AxisGetRampSettings, ...] = ()
    #: what it will do instead where the module cannot do what was asked
    remarks: tuple[str, ...] = ()
    #: warnings about moves with its settings
    warnings: tuple[str, ...] = ()
    #: how far the move goes
    distance_microsteps: int = 0
    #: how long it takes
    move_s: float = 0.0
    #: how fast it gets, in microsteps per second
    top_speed_pps: float = 0.0
    #: the same in the unit per second
    top_speed: float | None = None
    #: the greatest part that it asks for of the torque that is there at its speed; null
    #: without figures of a motor
    torque_share: float | None = None
    #: the speed at which that is
    torque_share_pps: float | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"settings": AxisGetRampSettings}


@dataclass(frozen=True)
class ProfileSimulateCurve(Record):
    #: of its points
    times_s: tuple[float, ...] = ()
    #: where the motor is at each of them
    positions_microsteps: tuple[int, ...] = ()
    #: how fast
    velocities_pps: tuple[float, ...] = ()
    #: and how that changes
    accelerations_pps2: tuple[float, ...] = ()


@dataclass(frozen=True)
class ProfileSimulate(Record):
    #: model of the module
    model: str = ""
    #: how long the move takes; null where it does not come to rest on its target
    move_s: float | None = None
    #: the longest part of it in which the speed changes one way
    longest_phase_s: float = 0.0
    #: how fast it gets, in microsteps per second
    top_speed_pps: float = 0.0
    #: how far the load swings to either side when the motor has arrived; null without one
    swing_microsteps: float | None = None
    #: when the load swings by no more than the tolerance; null if it never does
    settled_s: float | None = None
    #: to draw it; null unless points are asked for
    curve: ProfileSimulateCurve | None = None
    #: warnings about moves with its settings
    warnings: tuple[str, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"curve": ProfileSimulateCurve}


@dataclass(frozen=True)
class ProfileSolve(Record):
    #: how far it goes
    distance: float = 0.0
    #: the greatest
    speed: float = 0.0
    #: from the initial speed to that
    acceleration: float = 0.0
    #: from that to the final speed, as a positive number
    deceleration: float = 0.0
    #: how long it speeds up
    acceleration_time: float = 0.0
    #: how long it keeps its speed
    slew_time: float = 0.0
    #: how long it slows down
    deceleration_time: float = 0.0
    #: all of them
    total_time: float = 0.0
    #: with which it begins
    initial_speed: float = 0.0
    #: with which it ends
    final_speed: float = 0.0
    #: how far it goes while it speeds up
    acceleration_distance: float = 0.0
    #: at its speed
    slew_distance: float = 0.0
    #: while it slows down
    deceleration_distance: float = 0.0


@dataclass(frozen=True)
class HomedAxis(Record):
    #: where the axis believed to be at what is zero now; null if the module does not say
    correction_microsteps: int | None = None
    #: from one end switch to the other; null if this search did not visit both, or the module
    #: does not say
    switch_distance_microsteps: int | None = None
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: the same correction in the unit
    correction: float | None = None
    #: the same way between the switches
    switch_distance: float | None = None
    #: how far it may go one way without turning: it is stopped beyond that; null: nothing
    #: bounds it
    max_travel_microsteps: int | None = None
    #: the same in the unit
    max_travel: float | None = None
    #: such as that nothing bounds the search
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class AxisStartHome(Record):
    #: how far it may go one way without turning: it is stopped beyond that; null: nothing
    #: bounds it
    max_travel_microsteps: int | None = None
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: the same in the unit
    max_travel: float | None = None
    #: such as that nothing bounds the search
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class AxisSetDeadman(Record):
    #: what its module is set to now; 0: off
    ms: int = 0


@dataclass(frozen=True)
class AxisTestDeadman(Record):
    #: none, or what was found
    deadman: str | ModuleListModulesDeadman = ""
    #: why there is none
    reason: str | None = None
    #: how far the axis has gone
    way_microsteps: int = 0
    _inner: ClassVar[Mapping[str, type[Record]]] = {"deadman": ModuleListModulesDeadman}


@dataclass(frozen=True)
class AxisTuneVelocity(Record):
    #: the greatest that held, or of the current the least
    limit: float = 0.0
    #: with the margin
    proposed: float = 0.0
    #: motor: a trial beyond it failed; travel: that is too short for more; bounds: those of
    #: the axis and of its module
    limited_by: str = ""


@dataclass(frozen=True)
class AxisTuneTrials(Record):
    #: velocity, acceleration, current, threshold, confirmation, hold, or bow
    sought: str = ""
    #: in microsteps per second
    velocity_pps: float = 0.0
    #: per second squared
    acceleration_pps2: float = 0.0
    #: of parameter 6; for hold, of parameter 7
    current: int = 0
    #: the encoder was where the motor should be, there and back
    held: bool = False
    #: the greatest that the encoder had, in microsteps
    deviation: float = 0.0
    #: the least at full speed, where it was read
    load_value: int | None = None
    #: of stallGuard2, with which that was
    threshold: int | None = None
    #: why it did not hold; empty if it did
    trouble: str = ""
    #: of the load at rest, to either side, in microsteps, where it was looked at
    swing: float | None = None


@dataclass(frozen=True)
class AxisTuneSettings(Record):
    #: its number
    parameter: int = 0
    #: of the parameter
    name: str = ""
    #: what is proposed
    value: int = 0
    #: what the axis has
    before: int = 0


@dataclass(frozen=True)
class AxisTuneBow(Record):
    #: what is proposed; what the axis has where no other is better
    value: int = 0
    #: of the load; null where none was found
    resonance_hz: float | None = None
    #: 0 to less than 1
    damping: float | None = None
    #: with it, at rest, to either side, in microsteps
    swing: float = 0.0
    #: with the bow that the axis has
    swing_before: float = 0.0


@dataclass(frozen=True)
class AxisTune(Record):
    #: name of the axis
    axis: str = ""
    #: in microsteps per second, with the acceleration of the axis
    velocity: AxisTuneVelocity = field(default_factory=lambda: AxisTuneVelocity())
    #: per second squared, at the proposed velocity
    acceleration: AxisTuneVelocity = field(default_factory=lambda: AxisTuneVelocity())
    #: of parameter 6, for both that are proposed
    current: AxisTuneVelocity = field(default_factory=lambda: AxisTuneVelocity())
    #: of stallGuard2: the least with which the load value keeps off 0 by a tenth of its range;
    #: null where the module has none, or none does
    threshold: int | None = None
    #: between motor and encoder, in microsteps
    backlash: float = 0.0
    #: of the encoder; below 0 if it counts the other way
    counts_per_microstep: float = 0.0
    #: the position of the axis was set again, by its encoder or switch: search the reference
    lost_steps: bool = False
    #: all that were made, in their order
    trials: tuple[AxisTuneTrials, ...] = ()
    #: what is proposed, in the order to set it
    settings: tuple[AxisTuneSettings, ...] = ()
    #: they are set, and in the module's EEPROM where that keeps them
    stored: bool = False
    #: about what was found
    warnings: tuple[str, ...] = ()
    #: of parameter 7, with which the axis stands; bounds: nothing moved it with less either,
    #: and what it has is proposed; null where the module has none, or none was enough
    hold_current: AxisTuneVelocity | None = None
    #: with which the load stands first; null where the module has none
    bow: AxisTuneBow | None = None
    _inner: ClassVar[Mapping[str, type[Record]]] = {"velocity": AxisTuneVelocity, "acceleration": AxisTuneVelocity, "current": AxisTuneVelocity, "trials": AxisTuneTrials, "settings": AxisTuneSettings, "hold_current": AxisTuneVelocity, "bow": AxisTuneBow}


@dataclass(frozen=True)
class AxisVerifyTraits(Record):
    #: such as last_step: a key of a file for tmclsim --as
    trait: str = ""
    #: the variant that its twin has
    foreseen: str = ""
    #: it was tried what the module does
    measured: bool = False
    #: which variants do; none of those that are known, if it was tried and nothing is here
    fits: tuple[str, ...] = ()
    #: what was seen, or why it was not tried
    text: str = ""


@dataclass(frozen=True)
class AxisVerifyMoves(Record):
    #: how far
    distance_microsteps: int = 0
    #: what the ramp generator was set to
    settings: str = ""
    #: how long its twin takes
    foreseen_s: float = 0.0
    #: it took longer than this
    least_s: float = 0.0
    #: and no longer than this
    most_s: float = 0.0


@dataclass(frozen=True)
class AxisVerify(Record):
    #: of the module
    model: str = ""
    #: its version
    firmware: str = ""
    #: how quickly it has answered at best, without what the wire takes; null on CAN
    answer_us: int | None = None
    #: those that make a difference to its model
    traits: tuple[AxisVerifyTraits, ...] = ()
    #: those that told variants of its chip apart
    moves: tuple[AxisVerifyMoves, ...] = ()
    #: all this as a text: the file that tmclsim --as and 'as' in [[module]] take
    report: str = ""
    _inner: ClassVar[Mapping[str, type[Record]]] = {"traits": AxisVerifyTraits, "moves": AxisVerifyMoves}


@dataclass(frozen=True)
class CaptureStartChannels(Record):
    #: standard name; null if the number has none
    parameter: str | None = None
    #: number of the axis parameter
    number: int = 0
    #: what its values count; null if that has no name
    unit: str | None = None


@dataclass(frozen=True)
class CaptureStart(Record):
    #: its number, for the other methods
    capture: int = 0
    #: what is recorded, in the order of the values
    channels: tuple[CaptureStartChannels, ...] = ()
    #: how many of each channel
    samples: int = 0
    #: how many of them lie before the trigger
    pretrigger: int = 0
    #: how many a second
    rate_hz: float = 0.0
    _inner: ClassVar[Mapping[str, type[Record]]] = {"channels": CaptureStartChannels}


@dataclass(frozen=True)
class CaptureState(Record):
    #: idle, pretrigger, trigger, capture, complete or error
    state: str = ""


@dataclass(frozen=True)
class CaptureRead(Record):
    #: one of each channel after the other
    values: tuple[int, ...] = ()


@dataclass(frozen=True)
class State(Record):
    #: name of the axis
    axis: str = ""
    #: where it is
    position_microsteps: int = 0
    #: speed in the module's own unit
    velocity_internal: int = 0
    #: speed in microsteps per second; null if unknown
    velocity_pps: float | None = None
    #: where it is to go
    target_microsteps: int = 0
    #: position equals target, perhaps only in passing
    position_reached: bool = False
    #: its speed is not zero, or it turns round to come to its target from one side
    moving: bool = False
    #: what the next three are in; null if the axis has none
    unit: str | None = None
    #: where it is
    position: float | None = None
    #: speed per second
    velocity: float | None = None
    #: where it is to go
    target: float | None = None
    #: its module has started again, or is another one: nothing moves it until axis.recover or
    #: axis.home
    latched: bool = False
    #: it has searched its reference, or was told where it is, while tmcld was there, and its
    #: module has not started again since
    referenced: bool = False
    #: why it stands short of its target: stall, deviation, left_limit, right_limit, deadman,
    #: supply, client, lease_lost, search_limit, daemon, velocity_mode (something else than
    #: tmcld has stopped it) or unknown; null while it moves or where that is not known
    stop_cause: str | None = None
    #: how old the oldest of these values is
    age_ms: int = 0
    #: number of its lease; null if it has none
    lease: int | None = None
    #: it turns, and does not stop when a connection ends
    unattended: bool = False
    #: the client that it turns for, or that has its lease; null if there is none
    owner: str | None = None
    #: what a line, a path or a Mint program has changed, as it was before: set back as soon as
    #: its module takes it
    unrestored: tuple[AxisGetRampSettings, ...] = ()
    #: what is wrong with its driver or its supply, as axis.get_errors names it
    faults: tuple[str, ...] = ()
    #: grows whenever a client, or tmcld itself, has it stopped: also where it stands
    last_stop: int = 0
    _inner: ClassVar[Mapping[str, type[Record]]] = {"unrestored": AxisGetRampSettings}


@dataclass(frozen=True)
class Errors(Record):
    #: name of the axis
    axis: str = ""
    #: what its module says is wrong: stall, deviation, overtemperature,
    #: overtemperature_warning, short_to_ground_a, short_to_ground_b, open_load_a, open_load_b,
    #: undervoltage, overvoltage, i2t_exceeded
    flags: tuple[str, ...] = ()
    #: open_load_a, open_load_b: reported, but not yet twice in a row while the axis turned
    #: slowly
    unproven: tuple[str, ...] = ()
    #: those that are closed: left, right, home
    switches: tuple[str, ...] = ()
    #: as in axis.get_state
    stop_cause: str | None = None
    #: voltage of the supply; null if it tells none
    supply_volts: float | None = None
    #: temperature of the module; null if it tells none
    temperature_celsius: float | None = None


@dataclass(frozen=True)
class Units(Record):
    #: name of the axis
    axis: str = ""
    #: model of its module; null if it is not known
    model: str | None = None
    #: what positions are measured in; null if nothing is set
    unit: str | None = None
    #: how many of these a turn of the motor is
    units_per_revolution: float | None = None
    #: how many of these a turn of what its gear drives is
    units_per_output_revolution: float | None = None
    #: turns of the motor for one of those
    gear_ratio: float | None = None
    #: they grow in the motor's negative direction
    reverse: bool | None = None
    #: null where the module tells none
    microsteps_per_revolution: int | None = None
    #: full steps of a turn
    full_steps: int | None = None
    #: what the module's unit of velocity is, in microsteps per second
    velocity_unit_pps: float | None = None
    #: what its unit of acceleration is, in microsteps per second squared
    acceleration_unit_pps2: float | None = None
    #: least position that moves may end at, in the unit; null without soft limits
    soft_limit_minimum: float | None = None
    #: the greatest
    soft_limit_maximum: float | None = None
    #: the least one in microsteps; also without a unit
    soft_limit_minimum_microsteps: int | None = None
    #: the greatest
    soft_limit_maximum_microsteps: int | None = None
    #: what encoder positions count in; null where that is microsteps
    encoder_counts_per_unit: float | None = None


@dataclass(frozen=True)
class Parameter(Record):
    #: standard name; null if the number has none
    parameter: str | None = None
    #: number of the axis parameter
    number: int = 0
    #: its value
    value: int = 0
    #: what the next one is in, such as mm/s; null if there is none
    unit: str | None = None
    #: its value in the axis' unit
    value_in_unit: float | None = None


@dataclass(frozen=True)
class ParameterSet(Record):
    #: standard name; null if the number has none
    parameter: str | None = None
    #: number of the axis parameter
    number: int = 0
    #: its value
    value: int = 0
    #: what the next one is in, such as mm/s; null if there is none
    unit: str | None = None
    #: its value in the axis' unit
    value_in_unit: float | None = None
    #: warnings about moves with its settings
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class ParameterStore(Record):
    #: standard name; null if the number has none
    parameter: str | None = None
    #: number of the axis parameter
    number: int = 0


@dataclass(frozen=True)
class ParameterInfo(Record):
    #: its number
    number: int = 0
    #: its standard name
    name: str = ""
    #: read or read_write
    access: str = ""
    #: can be kept in the EEPROM
    stored: bool = False
    #: least value
    minimum: int = 0
    #: greatest value
    maximum: int = 0
    #: factory default
    initial: int = 0
    #: what the module counts in
    unit: str = ""
    #: what it is
    meaning: str = ""
    #: what value_in_unit is in
    axis_unit: str | None = None
    #: other names that are understood
    aliases: tuple[str, ...] = ()


@dataclass(frozen=True)
class ParameterList(Record):
    #: ascending; none for a model that is not known
    parameters: tuple[ParameterInfo, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"parameters": ParameterInfo}


@dataclass(frozen=True)
class SettingsReadSettings(Record):
    #: where it stands in a file: global, interrupts, motor.0
    section: str = ""
    #: its standard name
    parameter: str = ""
    #: its number
    number: int = 0
    #: its value
    value: int = 0
    #: what a new module has
    initial: int = 0
    #: unit of the value; null for codes and flags
    unit: str | None = None
    #: what it does
    meaning: str = ""


@dataclass(frozen=True)
class SettingsRead(Record):
    #: model of the module
    model: str = ""
    #: its version
    firmware: str = ""
    #: in the order of their numbers
    settings: tuple[SettingsReadSettings, ...] = ()
    #: what is of this module alone, such as its address, and is never loaded
    apart: tuple[SettingsReadSettings, ...] = ()
    #: the same as a file
    toml: str = ""
    _inner: ClassVar[Mapping[str, type[Record]]] = {"settings": SettingsReadSettings, "apart": SettingsReadSettings}


@dataclass(frozen=True)
class SettingsCompareDifferences(Record):
    #: where it stands in a file: global, interrupts, motor.0
    section: str = ""
    #: its standard name
    parameter: str = ""
    #: its number
    number: int = 0
    #: what the module has; null: it has none
    present: int | None = None
    #: what the file says
    wanted: int = 0


@dataclass(frozen=True)
class SettingsCompare(Record):
    #: model of the module
    model: str = ""
    #: what settings.load would write
    differences: tuple[SettingsCompareDifferences, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"differences": SettingsCompareDifferences}


@dataclass(frozen=True)
class SettingsLoadRefused(Record):
    #: where it stands in a file: global, interrupts, motor.0
    section: str = ""
    #: its standard name
    parameter: str = ""
    #: its number
    number: int = 0
    #: what the module or the configuration says to it
    why: str = ""


@dataclass(frozen=True)
class SettingsLoad(Record):
    #: what was written; 'present' is what was before
    written: tuple[SettingsCompareDifferences, ...] = ()
    #: what could not be written, or not be stored
    refused: tuple[SettingsLoadRefused, ...] = ()
    #: what is not as in the file afterwards
    differing: tuple[SettingsCompareDifferences, ...] = ()
    #: how many were copied to the EEPROM
    stored: int = 0
    _inner: ClassVar[Mapping[str, type[Record]]] = {"written": SettingsCompareDifferences, "refused": SettingsLoadRefused, "differing": SettingsCompareDifferences}


@dataclass(frozen=True)
class SettingsStore(Record):
    #: name of the axis
    axis: str = ""
    #: how many were copied to the EEPROM
    stored: int = 0
    #: what could not be stored
    refused: tuple[SettingsLoadRefused, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"refused": SettingsLoadRefused}


@dataclass(frozen=True)
class CoordinateGet(Record):
    #: where it is
    position_microsteps: int = 0
    #: what it measures in; null if the axis has no unit
    unit: str | None = None
    #: where it is, in the unit
    position: float | None = None


@dataclass(frozen=True)
class GlobalGet(Record):
    #: standard name; null if it was given by number
    parameter: str | None = None
    #: number of the global parameter
    number: int = 0
    #: its bank
    bank: int = 0
    #: its value
    value: int = 0


@dataclass(frozen=True)
class GlobalStore(Record):
    #: standard name; null if it was given by number
    parameter: str | None = None
    #: number of the global parameter
    number: int = 0
    #: its bank
    bank: int = 0


@dataclass(frozen=True)
class IoGet(Record):
    #: value of the port
    value: int = 0


@dataclass(frozen=True)
class ModuleInfo(Record):
    #: what the firmware is for
    module_id: int | None = None
    #: its version
    version: int | None = None
    #: 1 bootloader, 2 stand-alone programs, 4 CANopen, 8 EtherCAT, 16 IO-Link
    capabilities: int | None = None
    #: kind of release
    release_type: int | None = None
    #: what the bootloader is for
    bootloader_id: int | None = None
    #: its version
    bootloader_version: int | None = None
    #: bits of an axis parameter's number
    axis_parameter_width: int | None = None
    #: bits of a register's address
    register_address_width: int | None = None
    #: what it was built from
    git_hash: int | None = None


@dataclass(frozen=True)
class ProgramAssembleLabels(Record):
    #: as it is written where it stands
    name: str = ""
    #: of the command behind it
    address: int = 0


@dataclass(frozen=True)
class ProgramAssemble(Record):
    #: a program file, in hexadecimal
    program: str = ""
    #: how many commands it has
    commands: int = 0
    #: of each command, the line of the text, from 1
    lines: tuple[int, ...] = ()
    #: in their order in the text
    labels: tuple[ProgramAssembleLabels, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"labels": ProgramAssembleLabels}


@dataclass(frozen=True)
class ProgramLoad(Record):
    #: how many commands it has
    commands: int = 0


@dataclass(frozen=True)
class ProgramRead(Record):
    #: how many commands it has
    commands: int = 0
    #: a program file, in hexadecimal
    program: str = ""


@dataclass(frozen=True)
class ProgramRun(Record):
    #: true: what the program sets turning has no owner, and turns on when a connection ends
    unattended: bool = False


@dataclass(frozen=True)
class ProgramStepTo(Record):
    #: address: the next command is at one of them; ended: the program has ended, failed or was
    #: stopped; steps: so many were executed; waits: the command is not over yet
    reason: str = ""
    #: how many commands were executed, one that waits included
    steps: int = 0
    #: stopped, running, stepping or reset
    state: str = ""
    #: the next command
    next_address: int | None = None
    #: 0: none; null if the module does not say
    last_error: int | None = None
    #: true: what the program sets turning has no owner, and turns on when a connection ends
    unattended: bool = False


@dataclass(frozen=True)
class ProgramStatus(Record):
    #: stopped, running, stepping or reset
    state: str = ""
    #: the next command; null if the module does not say
    next_address: int | None = None
    #: 0: none; null if the module does not say
    last_error: int | None = None


@dataclass(frozen=True)
class FirmwareStatus(Record):
    #: model of the module; null if it has no name
    model: str | None = None
    #: its number
    model_number: int = 0
    #: what answers: 1110V142, or 1110B101 for its bootloader
    running: str = ""
    #: no firmware runs
    in_bootloader: bool = False


@dataclass(frozen=True)
class FirmwareUpload(Record):
    #: model of the module; null if it has no name
    model: str | None = None
    #: its number
    model_number: int = 0
    #: what ran before: 1110V101
    before: str = ""
    #: what runs now
    running: str = ""
    #: of the image
    checksum: int = 0


@dataclass(frozen=True)
class SystemStopAllStopped(Record):
    #: name of the axis
    axis: str = ""
    #: passed until its module had confirmed
    milliseconds: float = 0.0


@dataclass(frozen=True)
class SystemStopAllFailed(Record):
    #: name of the axis
    axis: str = ""
    #: what went wrong
    error: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class StoppedAxes(Record):
    #: those that confirmed
    stopped: tuple[SystemStopAllStopped, ...] = ()
    #: those that did not
    failed: tuple[SystemStopAllFailed, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"stopped": SystemStopAllStopped, "failed": SystemStopAllFailed}


@dataclass(frozen=True)
class SubscribeStatesSamples(Record):
    #: standard name; null if the number has none
    parameter: str | None = None
    #: number of the axis parameter
    number: int = 0
    #: its value
    value: int = 0
    #: what the next one is in, such as mm/s; null if there is none
    unit: str | None = None
    #: its value in the axis' unit
    value_in_unit: float | None = None
    #: how old the value is
    age_ms: int = 0


@dataclass(frozen=True)
class WatchedState(Record):
    #: name of the axis
    axis: str = ""
    #: where it is
    position_microsteps: int = 0
    #: speed in the module's own unit
    velocity_internal: int = 0
    #: speed in microsteps per second; null if unknown
    velocity_pps: float | None = None
    #: where it is to go
    target_microsteps: int = 0
    #: position equals target, perhaps only in passing
    position_reached: bool = False
    #: its speed is not zero, or it turns round to come to its target from one side
    moving: bool = False
    #: what the next three are in; null if the axis has none
    unit: str | None = None
    #: where it is
    position: float | None = None
    #: speed per second
    velocity: float | None = None
    #: where it is to go
    target: float | None = None
    #: its module has started again, or is another one: nothing moves it until axis.recover or
    #: axis.home
    latched: bool = False
    #: it has searched its reference, or was told where it is, while tmcld was there, and its
    #: module has not started again since
    referenced: bool = False
    #: why it stands short of its target: stall, deviation, left_limit, right_limit, deadman,
    #: supply, client, lease_lost, search_limit, daemon, velocity_mode (something else than
    #: tmcld has stopped it) or unknown; null while it moves or where that is not known
    stop_cause: str | None = None
    #: how old the oldest of these values is
    age_ms: int = 0
    #: number of its lease; null if it has none
    lease: int | None = None
    #: it turns, and does not stop when a connection ends
    unattended: bool = False
    #: the client that it turns for, or that has its lease; null if there is none
    owner: str | None = None
    #: what a line, a path or a Mint program has changed, as it was before: set back as soon as
    #: its module takes it
    unrestored: tuple[AxisGetRampSettings, ...] = ()
    #: what is wrong with its driver or its supply, as axis.get_errors names it
    faults: tuple[str, ...] = ()
    #: grows whenever a client, or tmcld itself, has it stopped: also where it stands
    last_stop: int = 0
    #: counts the states of the axis
    seq: int = 0
    #: when it was read, on the daemon's monotonic clock
    event_time_ms: int = 0
    #: the parameters that the subscription names, as they were read last
    samples: tuple[SubscribeStatesSamples, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"unrestored": AxisGetRampSettings, "samples": SubscribeStatesSamples}


@dataclass(frozen=True)
class Subscribe(Record):
    #: what unsubscribe takes
    subscription: int = 0
    #: the state of each axis now
    states: tuple[WatchedState, ...] = ()
    #: those that do not answer now
    failed: tuple[SystemStopAllFailed, ...] = ()
    _inner: ClassVar[Mapping[str, type[Record]]] = {"states": WatchedState, "failed": SystemStopAllFailed}


class Methods:
    """Each method of the daemon, by its name with `_` for `.`."""

    def __init__(self, call: Callable[[str, Mapping[str, Any]], Mapping[str, Any]]) -> None:
        self._call = call

    def rpc_discover(self) -> RpcDiscover:
        """`rpc.discover` every method, as this daemon has it."""
        return RpcDiscover.of(self._call("rpc.discover", {}))

    def bus_list(self) -> BusList:
        """`bus.list` the configured buses and how they are."""
        return BusList.of(self._call("bus.list", {}))

    def bus_trace(
        self,
        bus: str,
        *,
        after: int | None = None,
        limit: int | None = None,
    ) -> BusTrace:
        """`bus.trace` what went over a bus lately: the last 4096 datagrams."""
        return BusTrace.of(self._call("bus.trace", {"bus": bus, "after": after, "limit": limit}))

    def bus_scan(
        self,
        *,
        bus: str | None = None,
        first: int | None = None,
        last: int | None = None,
    ) -> BusScan:
        """`bus.scan` asks every address who is there; tells its progress by notify_progress."""
        return BusScan.of(self._call("bus.scan", {"bus": bus, "first": first, "last": last}))

    def doctor_examine(
        self,
        *,
        axis: str | None = None,
        bus: str | None = None,
    ) -> DoctorExamine:
        """`doctor.examine` looks for what keeps axes from moving, and says what to do."""
        return DoctorExamine.of(self._call("doctor.examine", {"axis": axis, "bus": bus}))

    def module_list(self) -> ModuleList:
        """`module.list` the configured modules and how they are."""
        return ModuleList.of(self._call("module.list", {}))

    def module_execute(
        self,
        bus: str,
        address: int,
        command: str | int,
        *,
        deadline_ms: int | None = None,
        type: str | int | None = None,
        motor: int | None = None,
        value: int | None = None,
    ) -> ModuleExecute:
        """`module.execute` any TMCL command, exactly as given."""
        return ModuleExecute.of(self._call("module.execute", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "command": command, "type": type, "motor": motor, "value": value}))

    def axis_list(
        self,
        *,
        all: bool | None = None,
    ) -> AxisList:
        """`axis.list` the axes and how they are."""
        return AxisList.of(self._call("axis.list", {"all": all}))

    def axis_move_to(
        self,
        axis: str,
        *,
        position_microsteps: int | None = None,
        position: float | str | None = None,
        predict: bool | None = None,
        deadline_ms: int | None = None,
    ) -> StartedMove:
        """`axis.move_to` starts a move to a position; does not wait for its end."""
        return StartedMove.of(self._call("axis.move_to", {"axis": axis, "position_microsteps": position_microsteps, "position": position, "predict": predict, "deadline_ms": deadline_ms}))

    def axis_move_by(
        self,
        axis: str,
        *,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        predict: bool | None = None,
        deadline_ms: int | None = None,
    ) -> StartedMove:
        """`axis.move_by` starts a move over a distance; does not wait for its end."""
        return StartedMove.of(self._call("axis.move_by", {"axis": axis, "distance_microsteps": distance_microsteps, "distance": distance, "predict": predict, "deadline_ms": deadline_ms}))

    def axis_rotate(
        self,
        axis: str,
        *,
        velocity_internal: int | None = None,
        velocity: float | str | None = None,
        unattended: bool | None = None,
        deadline_ms: int | None = None,
    ) -> Turning:
        """`axis.rotate` turns without end."""
        return Turning.of(self._call("axis.rotate", {"axis": axis, "velocity_internal": velocity_internal, "velocity": velocity, "unattended": unattended, "deadline_ms": deadline_ms}))

    def axis_jog(
        self,
        axis: str,
        hold_ms: int,
        *,
        velocity_internal: int | None = None,
        velocity: float | str | None = None,
    ) -> Jogging:
        """`axis.jog` goes one way for as long as it is called again; needs a lease."""
        return Jogging.of(self._call("axis.jog", {"axis": axis, "velocity_internal": velocity_internal, "velocity": velocity, "hold_ms": hold_ms}))

    def axis_resonance(
        self,
        axis: str,
        *,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        listen_ms: int | None = None,
        deadline_ms: int | None = None,
    ) -> MeasuredResonance:
        """`axis.resonance` makes a small move and finds from the encoder how the load swings after
        it."""
        return MeasuredResonance.of(self._call("axis.resonance", {"axis": axis, "distance_microsteps": distance_microsteps, "distance": distance, "listen_ms": listen_ms, "deadline_ms": deadline_ms}))

    def axis_stop(self, axis: str) -> None:
        """`axis.stop` ramps down to standstill; goes out before everything else."""
        self._call("axis.stop", {"axis": axis})

    def axis_wait(
        self,
        axis: str,
        *,
        timeout_ms: int | None = None,
        target_microsteps: int | None = None,
    ) -> Standing:
        """`axis.wait` answers when the axis stands at its target."""
        return Standing.of(self._call("axis.wait", {"axis": axis, "timeout_ms": timeout_ms, "target_microsteps": target_microsteps}))

    def lease_acquire(
        self,
        axes: Sequence[str],
        *,
        ttl_ms: int | None = None,
        on_loss: str | None = None,
    ) -> GrantedLease:
        """`lease.acquire` gives the client the right to move some axes alone: all of them, or
        none."""
        return GrantedLease.of(self._call("lease.acquire", {"axes": axes, "ttl_ms": ttl_ms, "on_loss": on_loss}))

    def lease_renew(
        self,
        lease: int,
        epoch: int,
        *,
        ttl_ms: int | None = None,
    ) -> GrantedLease:
        """`lease.renew` says that its holder is still there."""
        return GrantedLease.of(self._call("lease.renew", {"lease": lease, "epoch": epoch, "ttl_ms": ttl_ms}))

    def lease_release(
        self,
        lease: int,
        epoch: int,
        *,
        stop: bool | None = None,
    ) -> None:
        """`lease.release` ends it, once its axes have taken a stop."""
        self._call("lease.release", {"lease": lease, "epoch": epoch, "stop": stop})

    def lease_list(self) -> LeaseList:
        """`lease.list` who may move which axes alone."""
        return LeaseList.of(self._call("lease.list", {}))

    def lease_break(self, axis: str) -> None:
        """`lease.break` takes the lease of an axis away, as if its time were over."""
        self._call("lease.break", {"axis": axis})

    def token_add(
        self,
        role: str,
        *,
        name: str | None = None,
    ) -> TokenAdd:
        """`token.add` makes a token, by which a client is let in."""
        return TokenAdd.of(self._call("token.add", {"role": role, "name": name}))

    def token_list(self) -> TokenList:
        """`token.list` which tokens there are."""
        return TokenList.of(self._call("token.list", {}))

    def token_invite(self, name: str) -> TokenInvite:
        """`token.invite` makes a code with which one browser signs in by the token, once, within
        ten minutes."""
        return TokenInvite.of(self._call("token.invite", {"name": name}))

    def token_revoke(self, name: str) -> None:
        """`token.revoke` ends the token, and the connections that it let in."""
        self._call("token.revoke", {"name": name})

    def client_list(self) -> ClientList:
        """`client.list` who is connected, by which door, with which role."""
        return ClientList.of(self._call("client.list", {}))

    def audit_tail(
        self,
        *,
        lines: int | None = None,
        after: int | None = None,
    ) -> AuditTail:
        """`audit.tail` what was moved, set and stopped lately, by whom: the last 1000 lines."""
        return AuditTail.of(self._call("audit.tail", {"lines": lines, "after": after}))

    def page_find(self) -> PageFind:
        """`page.find` where the page for browsers is."""
        return PageFind.of(self._call("page.find", {}))

    def configuration_get(self) -> ConfigurationGet:
        """`configuration.get` the part of the configuration that clients may set."""
        return ConfigurationGet.of(self._call("configuration.get", {}))

    def configuration_set(
        self,
        toml: str,
        *,
        dry_run: bool | None = None,
    ) -> ConfigurationSet:
        """`configuration.set` sets the part of the configuration that is for clients, and goes by
        it."""
        return ConfigurationSet.of(self._call("configuration.set", {"toml": toml, "dry_run": dry_run}))

    def speak_for(
        self,
        user: str,
        role: str,
    ) -> SpeakFor:
        """`speak_for` makes the calls of this connection those of a user, from now on."""
        return SpeakFor.of(self._call("speak_for", {"user": user, "role": role}))

    def line_move(
        self,
        axes: Sequence[str],
        *,
        positions_microsteps: Sequence[int] | None = None,
        positions: Sequence[float | str] | None = None,
        velocity: float | str | None = None,
        velocity_pps: float | None = None,
        acceleration: float | str | None = None,
        acceleration_pps2: float | None = None,
        time_s: float | None = None,
        deadline_ms: int | None = None,
    ) -> LineMove:
        """`line.move` moves several axes so that they start and arrive together."""
        return LineMove.of(self._call("line.move", {"axes": axes, "positions_microsteps": positions_microsteps, "positions": positions, "velocity": velocity, "velocity_pps": velocity_pps, "acceleration": acceleration, "acceleration_pps2": acceleration_pps2, "time_s": time_s, "deadline_ms": deadline_ms}))

    def path_stage(
        self,
        offset: int,
        data: str,
    ) -> PathStage:
        """`path.stage` hands over the next part of a path file."""
        return PathStage.of(self._call("path.stage", {"offset": offset, "data": data}))

    def path_plan(
        self,
        *,
        axes: Sequence[str] | None = None,
        file_axes: Sequence[str] | None = None,
        text: str | None = None,
        bytes: int | None = None,
        format: str | None = None,
        mode: str | None = None,
        tolerance: float | None = None,
        velocity: float | str | None = None,
        acceleration: float | str | None = None,
        feed: float | str | None = None,
        corner_jump: float | str | None = None,
        per_turn: float | None = None,
        deviation: float | None = None,
        period_ms: int | None = None,
        lenient: bool | None = None,
        name: str | None = None,
        shaper: str | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        jerk: float | str | None = None,
        points: int | None = None,
    ) -> PathPlan:
        """`path.plan` plans a path, and says what will be run."""
        return PathPlan.of(self._call("path.plan", {"axes": axes, "file_axes": file_axes, "text": text, "bytes": bytes, "format": format, "mode": mode, "tolerance": tolerance, "velocity": velocity, "acceleration": acceleration, "feed": feed, "corner_jump": corner_jump, "per_turn": per_turn, "deviation": deviation, "period_ms": period_ms, "lenient": lenient, "name": name, "shaper": shaper, "resonance_hz": resonance_hz, "damping": damping, "jerk": jerk, "points": points}))

    def path_run(
        self,
        *,
        axes: Sequence[str] | None = None,
        file_axes: Sequence[str] | None = None,
        text: str | None = None,
        bytes: int | None = None,
        format: str | None = None,
        mode: str | None = None,
        tolerance: float | None = None,
        velocity: float | str | None = None,
        acceleration: float | str | None = None,
        feed: float | str | None = None,
        corner_jump: float | str | None = None,
        per_turn: float | None = None,
        deviation: float | None = None,
        period_ms: int | None = None,
        lenient: bool | None = None,
        name: str | None = None,
        shaper: str | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        jerk: float | str | None = None,
        plan: int | None = None,
        to_start: bool | None = None,
        points: int | None = None,
    ) -> PathRun:
        """`path.run` moves axes along a path and answers at its end; tells its progress by
        notify_progress."""
        return PathRun.of(self._call("path.run", {"axes": axes, "file_axes": file_axes, "text": text, "bytes": bytes, "format": format, "mode": mode, "tolerance": tolerance, "velocity": velocity, "acceleration": acceleration, "feed": feed, "corner_jump": corner_jump, "per_turn": per_turn, "deviation": deviation, "period_ms": period_ms, "lenient": lenient, "name": name, "shaper": shaper, "resonance_hz": resonance_hz, "damping": damping, "jerk": jerk, "plan": plan, "to_start": to_start, "points": points}))

    def path_pause(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathPause:
        """`path.pause` lets axes stand on their path."""
        return PathPause.of(self._call("path.pause", {"axes": axes}))

    def path_resume(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathPause:
        """`path.resume` lets them go on, also from M0."""
        return PathPause.of(self._call("path.resume", {"axes": axes}))

    def path_status(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathStatus:
        """`path.status` how far the paths of some axes are, and how fast."""
        return PathStatus.of(self._call("path.status", {"axes": axes}))

    def path_feed(
        self,
        *,
        axes: Sequence[str] | None = None,
        factor: float | None = None,
        hold: bool | None = None,
    ) -> PathStatus:
        """`path.feed` slows paths down, speeds them up, holds them and lets them go on."""
        return PathStatus.of(self._call("path.feed", {"axes": axes, "factor": factor, "hold": hold}))

    def path_stop(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathPause:
        """`path.stop` ends paths: answers when their axes stand and have their settings again."""
        return PathPause.of(self._call("path.stop", {"axes": axes}))

    def mint_run(
        self,
        axes: Sequence[str],
        *,
        numbers: Sequence[int] | None = None,
        counts: str | None = None,
        text: str | None = None,
        bytes: int | None = None,
    ) -> MintRun:
        """`mint.run` moves axes as a Mint program says and answers at its end; tells its progress
        by notify_progress."""
        return MintRun.of(self._call("mint.run", {"axes": axes, "numbers": numbers, "counts": counts, "text": text, "bytes": bytes}))

    def axis_get_ramp(
        self,
        axis: str,
        *,
        in_motion: bool | None = None,
    ) -> AxisGetRamp:
        """`axis.get_ramp` what its movements can be foreseen from."""
        return AxisGetRamp.of(self._call("axis.get_ramp", {"axis": axis, "in_motion": in_motion}))

    def axis_plan_ramp(
        self,
        axis: str,
        *,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        acceleration: float | str | None = None,
        acceleration_internal: int | None = None,
        deceleration: float | str | None = None,
        deceleration_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
    ) -> AxisPlanRamp:
        """`axis.plan_ramp` chooses the parameters that make a ramp; writes nothing."""
        return AxisPlanRamp.of(self._call("axis.plan_ramp", {"axis": axis, "velocity": velocity, "velocity_internal": velocity_internal, "acceleration": acceleration, "acceleration_internal": acceleration_internal, "deceleration": deceleration, "deceleration_internal": deceleration_internal, "jerk": jerk, "bow": bow}))

    def axis_set_ramp(
        self,
        axis: str,
        *,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        acceleration: float | str | None = None,
        acceleration_internal: int | None = None,
        deceleration: float | str | None = None,
        deceleration_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
        store: bool | None = None,
    ) -> AxisPlanRamp:
        """`axis.set_ramp` chooses them, and sets them on an axis that stands."""
        return AxisPlanRamp.of(self._call("axis.set_ramp", {"axis": axis, "velocity": velocity, "velocity_internal": velocity_internal, "acceleration": acceleration, "acceleration_internal": acceleration_internal, "deceleration": deceleration, "deceleration_internal": deceleration_internal, "jerk": jerk, "bow": bow, "store": store}))

    def ramp_compare(
        self,
        axis: str,
        *,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        acceleration: float | str | None = None,
        acceleration_internal: int | None = None,
        deceleration: float | str | None = None,
        deceleration_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        tolerance_microsteps: int | None = None,
        tolerance: float | str | None = None,
    ) -> RampCompare:
        """`ramp.compare` what the ramps of an axis that stands make of a move and of a load that
        swings."""
        return RampCompare.of(self._call("ramp.compare", {"axis": axis, "velocity": velocity, "velocity_internal": velocity_internal, "acceleration": acceleration, "acceleration_internal": acceleration_internal, "deceleration": deceleration, "deceleration_internal": deceleration_internal, "jerk": jerk, "bow": bow, "distance_microsteps": distance_microsteps, "distance": distance, "resonance_hz": resonance_hz, "damping": damping, "tolerance_microsteps": tolerance_microsteps, "tolerance": tolerance}))

    def ramp_find(
        self,
        axis: str,
        *,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        time_s: float | None = None,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
        load: float | None = None,
        load_per_velocity: float | None = None,
        inertia: float | None = None,
        corner_speed: float | None = None,
        margin: float | None = None,
    ) -> RampFind:
        """`ramp.find` finds the gentlest ramp that makes a move in time, or the quickest that a
        motor can drive; writes nothing."""
        return RampFind.of(self._call("ramp.find", {"axis": axis, "distance_microsteps": distance_microsteps, "distance": distance, "time_s": time_s, "velocity": velocity, "velocity_internal": velocity_internal, "jerk": jerk, "bow": bow, "load": load, "load_per_velocity": load_per_velocity, "inertia": inertia, "corner_speed": corner_speed, "margin": margin}))

    def profile_simulate(
        self,
        model: str,
        distance_microsteps: int,
        *,
        parameters: Sequence[str] | None = None,
        values: Sequence[int] | None = None,
        until_s: float | None = None,
        points: int | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        tolerance_microsteps: int | None = None,
    ) -> ProfileSimulate:
        """`profile.simulate` a move as the ramp generator of a model makes it, of a module that
        need not be there."""
        return ProfileSimulate.of(self._call("profile.simulate", {"model": model, "parameters": parameters, "values": values, "distance_microsteps": distance_microsteps, "until_s": until_s, "points": points, "resonance_hz": resonance_hz, "damping": damping, "tolerance_microsteps": tolerance_microsteps}))

    def profile_solve(
        self,
        *,
        distance: float | None = None,
        speed: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        acceleration_time: float | None = None,
        slew_time: float | None = None,
        deceleration_time: float | None = None,
        total_time: float | None = None,
        initial_speed: float | None = None,
        final_speed: float | None = None,
        acceleration_distance: float | None = None,
        slew_distance: float | None = None,
        deceleration_distance: float | None = None,
        assumption: str | None = None,
    ) -> ProfileSolve:
        """`profile.solve` all of a trapezoid from as much of it as determines it; asks no module."""
        return ProfileSolve.of(self._call("profile.solve", {"distance": distance, "speed": speed, "acceleration": acceleration, "deceleration": deceleration, "acceleration_time": acceleration_time, "slew_time": slew_time, "deceleration_time": deceleration_time, "total_time": total_time, "initial_speed": initial_speed, "final_speed": final_speed, "acceleration_distance": acceleration_distance, "slew_distance": slew_distance, "deceleration_distance": deceleration_distance, "assumption": assumption}))

    def axis_home(
        self,
        axis: str,
        *,
        mode: int | None = None,
        timeout_ms: int | None = None,
        max_travel_microsteps: int | None = None,
        max_travel: float | str | None = None,
        leave: bool | None = None,
    ) -> HomedAxis:
        """`axis.home` searches the reference and answers when that has ended."""
        return HomedAxis.of(self._call("axis.home", {"axis": axis, "mode": mode, "timeout_ms": timeout_ms, "max_travel_microsteps": max_travel_microsteps, "max_travel": max_travel, "leave": leave}))

    def axis_start_home(
        self,
        axis: str,
        *,
        mode: int | None = None,
        max_travel_microsteps: int | None = None,
        max_travel: float | str | None = None,
    ) -> AxisStartHome:
        """`axis.start_home` starts a reference search; does not wait for its end."""
        return AxisStartHome.of(self._call("axis.start_home", {"axis": axis, "mode": mode, "max_travel_microsteps": max_travel_microsteps, "max_travel": max_travel}))

    def axis_stop_home(self, axis: str) -> None:
        """`axis.stop_home` ends a reference search."""
        self._call("axis.stop_home", {"axis": axis})

    def axis_recover(self, axis: str) -> None:
        """`axis.recover` says that an axis may move again whose module is not what it was."""
        self._call("axis.recover", {"axis": axis})

    def axis_set_deadman(
        self,
        axis: str,
        ms: int,
    ) -> AxisSetDeadman:
        """`axis.set_deadman` sets the deadman of the module of an axis, in its EEPROM."""
        return AxisSetDeadman.of(self._call("axis.set_deadman", {"axis": axis, "ms": ms}))

    def axis_test_deadman(self, axis: str) -> AxisTestDeadman:
        """`axis.test_deadman` moves an axis slowly, sends its module nothing, and measures when it
        stops."""
        return AxisTestDeadman.of(self._call("axis.test_deadman", {"axis": axis}))

    def axis_tune(
        self,
        axis: str,
        max_current: int,
        *,
        from_microsteps: int | None = None,
        from_: float | str | None = None,
        to_microsteps: int | None = None,
        to: float | str | None = None,
        margin: float | None = None,
        store: bool | None = None,
        by_switch: str | None = None,
    ) -> AxisTune:
        """`axis.tune` finds by trials the greatest velocity and acceleration that an axis bears."""
        return AxisTune.of(self._call("axis.tune", {"axis": axis, "max_current": max_current, "from_microsteps": from_microsteps, "from": from_, "to_microsteps": to_microsteps, "to": to, "margin": margin, "store": store, "by_switch": by_switch}))

    def axis_verify(
        self,
        axis: str,
        *,
        from_microsteps: int | None = None,
        from_: float | str | None = None,
        to_microsteps: int | None = None,
        to: float | str | None = None,
    ) -> AxisVerify:
        """`axis.verify` moves an axis a little, and finds out in what its module is not like its
        twin."""
        return AxisVerify.of(self._call("axis.verify", {"axis": axis, "from_microsteps": from_microsteps, "from": from_, "to_microsteps": to_microsteps, "to": to}))

    def capture_start(
        self,
        axis: str,
        channels: Sequence[str],
        *,
        rate_hz: float | None = None,
        samples: int | None = None,
        trigger_parameter: str | None = None,
        trigger_edge: str | None = None,
        trigger_value: int | None = None,
        pretrigger_percent: int | None = None,
        resume: bool | None = None,
    ) -> CaptureStart:
        """`capture.start` has the module of an axis record parameters of it, by command 142."""
        return CaptureStart.of(self._call("capture.start", {"axis": axis, "channels": channels, "rate_hz": rate_hz, "samples": samples, "trigger_parameter": trigger_parameter, "trigger_edge": trigger_edge, "trigger_value": trigger_value, "pretrigger_percent": pretrigger_percent, "resume": resume}))

    def capture_state(
        self,
        axis: str,
        capture: int,
    ) -> CaptureState:
        """`capture.state` how far a capture has come."""
        return CaptureState.of(self._call("capture.state", {"axis": axis, "capture": capture}))

    def capture_read(
        self,
        axis: str,
        capture: int,
        first: int,
        count: int,
    ) -> CaptureRead:
        """`capture.read` reads what a module has recorded."""
        return CaptureRead.of(self._call("capture.read", {"axis": axis, "capture": capture, "first": first, "count": count}))

    def capture_end(
        self,
        axis: str,
        *,
        capture: int | None = None,
    ) -> None:
        """`capture.end` the module records nothing any more, and forgets what it has."""
        self._call("capture.end", {"axis": axis, "capture": capture})

    def axis_get_state(
        self,
        axis: str,
        *,
        max_age_ms: int | None = None,
    ) -> State:
        """`axis.get_state` where the axis is and what it does."""
        return State.of(self._call("axis.get_state", {"axis": axis, "max_age_ms": max_age_ms}))

    def axis_get_errors(self, axis: str) -> Errors:
        """`axis.get_errors` what its module says is wrong, in words."""
        return Errors.of(self._call("axis.get_errors", {"axis": axis}))

    def axis_get_units(self, axis: str) -> Units:
        """`axis.get_units` what the axis counts in."""
        return Units.of(self._call("axis.get_units", {"axis": axis}))

    def parameter_get(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
    ) -> Parameter:
        """`parameter.get` reads an axis parameter."""
        return Parameter.of(self._call("parameter.get", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms}))

    def parameter_set(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        value: int | None = None,
        value_in_unit: float | str | None = None,
    ) -> ParameterSet:
        """`parameter.set` sets an axis parameter."""
        return ParameterSet.of(self._call("parameter.set", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms, "value": value, "value_in_unit": value_in_unit}))

    def parameter_store(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
    ) -> ParameterStore:
        """`parameter.store` copies an axis parameter to the EEPROM."""
        return ParameterStore.of(self._call("parameter.store", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms}))

    def parameter_restore(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
    ) -> ParameterStore:
        """`parameter.restore` copies an axis parameter back from the EEPROM."""
        return ParameterStore.of(self._call("parameter.restore", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms}))

    def parameter_list(self, axis: str) -> ParameterList:
        """`parameter.list` the parameters that the model of an axis has."""
        return ParameterList.of(self._call("parameter.list", {"axis": axis}))

    def settings_read(
        self,
        bus: str,
        address: int,
    ) -> SettingsRead:
        """`settings.read` reads all settings of a module."""
        return SettingsRead.of(self._call("settings.read", {"bus": bus, "address": address}))

    def settings_compare(
        self,
        bus: str,
        address: int,
        *,
        toml: str | None = None,
    ) -> SettingsCompare:
        """`settings.compare` compares a module with a file of settings, or with the one that is
        configured."""
        return SettingsCompare.of(self._call("settings.compare", {"bus": bus, "address": address, "toml": toml}))

    def settings_load(
        self,
        bus: str,
        address: int,
        toml: str,
        *,
        store: bool | None = None,
    ) -> SettingsLoad:
        """`settings.load` sets a module as a file of settings says; its motors must stand, and
        nothing moves."""
        return SettingsLoad.of(self._call("settings.load", {"bus": bus, "address": address, "toml": toml, "store": store}))

    def settings_store(self, axis: str) -> SettingsStore:
        """`settings.store` keeps all settings of an axis as they are now, in the module's EEPROM."""
        return SettingsStore.of(self._call("settings.store", {"axis": axis}))

    def coordinate_get(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
    ) -> CoordinateGet:
        """`coordinate.get` reads a coordinate."""
        return CoordinateGet.of(self._call("coordinate.get", {"axis": axis, "number": number, "deadline_ms": deadline_ms}))

    def coordinate_set(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
        position_microsteps: int | None = None,
        position: float | str | None = None,
    ) -> None:
        """`coordinate.set` remembers a position by a number."""
        self._call("coordinate.set", {"axis": axis, "number": number, "deadline_ms": deadline_ms, "position_microsteps": position_microsteps, "position": position})

    def coordinate_capture(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
    ) -> CoordinateGet:
        """`coordinate.capture` remembers where the axis is."""
        return CoordinateGet.of(self._call("coordinate.capture", {"axis": axis, "number": number, "deadline_ms": deadline_ms}))

    def coordinate_move(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`coordinate.move` starts a move to a coordinate."""
        self._call("coordinate.move", {"axis": axis, "number": number, "deadline_ms": deadline_ms})

    def coordinate_start(
        self,
        bus: str,
        address: int,
        number: int,
        motors: Sequence[int],
        *,
        deadline_ms: int | None = None,
        interpolated: bool | None = None,
    ) -> None:
        """`coordinate.start` starts motors of a module together, each to its own coordinate of
        this number."""
        self._call("coordinate.start", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "number": number, "motors": motors, "interpolated": interpolated})

    def coordinate_store(
        self,
        axis: str,
        *,
        number: int | None = None,
        deadline_ms: int | None = None,
    ) -> None:
        """`coordinate.store` copies coordinates of all motors of the axis' module to the EEPROM."""
        self._call("coordinate.store", {"axis": axis, "number": number, "deadline_ms": deadline_ms})

    def coordinate_load(
        self,
        axis: str,
        *,
        number: int | None = None,
        deadline_ms: int | None = None,
    ) -> None:
        """`coordinate.load` copies them back from the EEPROM."""
        self._call("coordinate.load", {"axis": axis, "number": number, "deadline_ms": deadline_ms})

    def global_get(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalGet:
        """`global.get` reads a global parameter."""
        return GlobalGet.of(self._call("global.get", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank}))

    def global_set(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        value: int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalGet:
        """`global.set` sets a global parameter."""
        return GlobalGet.of(self._call("global.set", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank, "value": value}))

    def global_store(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalStore:
        """`global.store` copies a global parameter to the EEPROM."""
        return GlobalStore.of(self._call("global.store", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank}))

    def global_restore(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalStore:
        """`global.restore` copies a global parameter back from the EEPROM."""
        return GlobalStore.of(self._call("global.restore", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank}))

    def io_get(
        self,
        bus: str,
        address: int,
        port: int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> IoGet:
        """`io.get` reads an input or output."""
        return IoGet.of(self._call("io.get", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "port": port, "bank": bank}))

    def io_set(
        self,
        bus: str,
        address: int,
        port: int,
        value: int,
        *,
        deadline_ms: int | None = None,
    ) -> IoGet:
        """`io.set` sets a digital output."""
        return IoGet.of(self._call("io.set", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "port": port, "value": value}))

    def module_info(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> ModuleInfo:
        """`module.info` what a module's firmware says of itself."""
        return ModuleInfo.of(self._call("module.info", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    def module_report_arrivals(
        self,
        bus: str,
        address: int,
        motors: Sequence[int],
        *,
        deadline_ms: int | None = None,
        every: bool | None = None,
    ) -> None:
        """`module.report_arrivals` lets a module tell when motors arrive: events of the kind
        target_reached."""
        self._call("module.report_arrivals", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "motors": motors, "every": every})

    def module_reset(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`module.reset` restarts a module."""
        self._call("module.reset", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    def module_factory_reset(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`module.factory_reset` restores everything in a module to how it was delivered."""
        self._call("module.factory_reset", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    def program_assemble(
        self,
        text: str,
        *,
        model: str | None = None,
    ) -> ProgramAssemble:
        """`program.assemble` makes a program file of a program's text; asks no module."""
        return ProgramAssemble.of(self._call("program.assemble", {"text": text, "model": model}))

    def program_load(
        self,
        bus: str,
        address: int,
        program: str,
        *,
        first_address: int | None = None,
        compare: bool | None = None,
    ) -> ProgramLoad:
        """`program.load` loads a program into a module; tells its progress by notify_progress."""
        return ProgramLoad.of(self._call("program.load", {"bus": bus, "address": address, "program": program, "first_address": first_address, "compare": compare}))

    def program_compare(
        self,
        bus: str,
        address: int,
        program: str,
        *,
        first_address: int | None = None,
    ) -> ProgramLoad:
        """`program.compare` compares a program with the one in a module."""
        return ProgramLoad.of(self._call("program.compare", {"bus": bus, "address": address, "program": program, "first_address": first_address}))

    def program_read(
        self,
        bus: str,
        address: int,
        *,
        first_address: int | None = None,
        length: int | None = None,
    ) -> ProgramRead:
        """`program.read` reads the program in a module."""
        return ProgramRead.of(self._call("program.read", {"bus": bus, "address": address, "first_address": first_address, "length": length}))

    def program_run(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
        first_address: int | None = None,
    ) -> ProgramRun:
        """`program.run` runs the program in a module."""
        return ProgramRun.of(self._call("program.run", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "first_address": first_address}))

    def program_stop(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.stop` ends the program; motors go on."""
        self._call("program.stop", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    def program_step(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> ProgramRun:
        """`program.step` executes one command of the program."""
        return ProgramRun.of(self._call("program.step", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    def program_step_to(
        self,
        bus: str,
        address: int,
        *,
        until: Sequence[int] | None = None,
        most_steps: int | None = None,
        wait_ms: int | None = None,
    ) -> ProgramStepTo:
        """`program.step_to` executes commands of the program one by one, until it stands before
        one of these; tells its progress by notify_progress."""
        return ProgramStepTo.of(self._call("program.step_to", {"bus": bus, "address": address, "until": until, "most_steps": most_steps, "wait_ms": wait_ms}))

    def program_reset(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.reset` ends the program and sets it back to its start."""
        self._call("program.reset", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    def program_status(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> ProgramStatus:
        """`program.status` what the program does."""
        return ProgramStatus.of(self._call("program.status", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    def program_set_breakpoint(
        self,
        bus: str,
        address: int,
        at: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.set_breakpoint` stops the program there from now on."""
        self._call("program.set_breakpoint", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "at": at})

    def program_clear_breakpoint(
        self,
        bus: str,
        address: int,
        at: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.clear_breakpoint` does not stop it there any more."""
        self._call("program.clear_breakpoint", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "at": at})

    def program_clear_breakpoints(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.clear_breakpoints` does not stop it anywhere any more."""
        self._call("program.clear_breakpoints", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    def firmware_status(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> FirmwareStatus:
        """`firmware.status` what runs in a module, as its updates need to know."""
        return FirmwareStatus.of(self._call("firmware.status", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    def firmware_stage(
        self,
        offset: int,
        data: str,
    ) -> PathStage:
        """`firmware.stage` hands over the next part of a firmware image."""
        return PathStage.of(self._call("firmware.stage", {"offset": offset, "data": data}))

    def firmware_upload(
        self,
        bus: str,
        address: int,
        start: int,
        bytes: int,
        *,
        force: bool | None = None,
    ) -> FirmwareUpload:
        """`firmware.upload` exchanges the firmware of a module for the image that was handed over;
        tells its progress by notify_progress."""
        return FirmwareUpload.of(self._call("firmware.upload", {"bus": bus, "address": address, "start": start, "bytes": bytes, "force": force}))

    def system_stop_all(self) -> StoppedAxes:
        """`system.stop_all` stops all axes at once."""
        return StoppedAxes.of(self._call("system.stop_all", {}))

    def subscribe(
        self,
        *,
        axes: Sequence[str] | None = None,
        interval_ms: int | None = None,
        parameters: Sequence[str] | None = None,
        every_look: bool | None = None,
    ) -> Subscribe:
        """`subscribe` tells of states by notify_state whenever they change, and of events."""
        return Subscribe.of(self._call("subscribe", {"axes": axes, "interval_ms": interval_ms, "parameters": parameters, "every_look": every_look}))

    def unsubscribe(self, subscription: int) -> None:
        """`unsubscribe` ends a subscription."""
        self._call("unsubscribe", {"subscription": subscription})


class AsyncMethods:
    """Each method of the daemon, by its name with `_` for `.`."""

    def __init__(self, call: Callable[[str, Mapping[str, Any]], Awaitable[Mapping[str, Any]]]) -> None:
        self._call = call

    async def rpc_discover(self) -> RpcDiscover:
        """`rpc.discover` every method, as this daemon has it."""
        return RpcDiscover.of(await self._call("rpc.discover", {}))

    async def bus_list(self) -> BusList:
        """`bus.list` the configured buses and how they are."""
        return BusList.of(await self._call("bus.list", {}))

    async def bus_trace(
        self,
        bus: str,
        *,
        after: int | None = None,
        limit: int | None = None,
    ) -> BusTrace:
        """`bus.trace` what went over a bus lately: the last 4096 datagrams."""
        return BusTrace.of(await self._call("bus.trace", {"bus": bus, "after": after, "limit": limit}))

    async def bus_scan(
        self,
        *,
        bus: str | None = None,
        first: int | None = None,
        last: int | None = None,
    ) -> BusScan:
        """`bus.scan` asks every address who is there; tells its progress by notify_progress."""
        return BusScan.of(await self._call("bus.scan", {"bus": bus, "first": first, "last": last}))

    async def doctor_examine(
        self,
        *,
        axis: str | None = None,
        bus: str | None = None,
    ) -> DoctorExamine:
        """`doctor.examine` looks for what keeps axes from moving, and says what to do."""
        return DoctorExamine.of(await self._call("doctor.examine", {"axis": axis, "bus": bus}))

    async def module_list(self) -> ModuleList:
        """`module.list` the configured modules and how they are."""
        return ModuleList.of(await self._call("module.list", {}))

    async def module_execute(
        self,
        bus: str,
        address: int,
        command: str | int,
        *,
        deadline_ms: int | None = None,
        type: str | int | None = None,
        motor: int | None = None,
        value: int | None = None,
    ) -> ModuleExecute:
        """`module.execute` any TMCL command, exactly as given."""
        return ModuleExecute.of(await self._call("module.execute", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "command": command, "type": type, "motor": motor, "value": value}))

    async def axis_list(
        self,
        *,
        all: bool | None = None,
    ) -> AxisList:
        """`axis.list` the axes and how they are."""
        return AxisList.of(await self._call("axis.list", {"all": all}))

    async def axis_move_to(
        self,
        axis: str,
        *,
        position_microsteps: int | None = None,
        position: float | str | None = None,
        predict: bool | None = None,
        deadline_ms: int | None = None,
    ) -> StartedMove:
        """`axis.move_to` starts a move to a position; does not wait for its end."""
        return StartedMove.of(await self._call("axis.move_to", {"axis": axis, "position_microsteps": position_microsteps, "position": position, "predict": predict, "deadline_ms": deadline_ms}))

    async def axis_move_by(
        self,
        axis: str,
        *,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        predict: bool | None = None,
        deadline_ms: int | None = None,
    ) -> StartedMove:
        """`axis.move_by` starts a move over a distance; does not wait for its end."""
        return StartedMove.of(await self._call("axis.move_by", {"axis": axis, "distance_microsteps": distance_microsteps, "distance": distance, "predict": predict, "deadline_ms": deadline_ms}))

    async def axis_rotate(
        self,
        axis: str,
        *,
        velocity_internal: int | None = None,
        velocity: float | str | None = None,
        unattended: bool | None = None,
        deadline_ms: int | None = None,
    ) -> Turning:
        """`axis.rotate` turns without end."""
        return Turning.of(await self._call("axis.rotate", {"axis": axis, "velocity_internal": velocity_internal, "velocity": velocity, "unattended": unattended, "deadline_ms": deadline_ms}))

    async def axis_jog(
        self,
        axis: str,
        hold_ms: int,
        *,
        velocity_internal: int | None = None,
        velocity: float | str | None = None,
    ) -> Jogging:
        """`axis.jog` goes one way for as long as it is called again; needs a lease."""
        return Jogging.of(await self._call("axis.jog", {"axis": axis, "velocity_internal": velocity_internal, "velocity": velocity, "hold_ms": hold_ms}))

    async def axis_resonance(
        self,
        axis: str,
        *,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        listen_ms: int | None = None,
        deadline_ms: int | None = None,
    ) -> MeasuredResonance:
        """`axis.resonance` makes a small move and finds from the encoder how the load swings after
        it."""
        return MeasuredResonance.of(await self._call("axis.resonance", {"axis": axis, "distance_microsteps": distance_microsteps, "distance": distance, "listen_ms": listen_ms, "deadline_ms": deadline_ms}))

    async def axis_stop(self, axis: str) -> None:
        """`axis.stop` ramps down to standstill; goes out before everything else."""
        await self._call("axis.stop", {"axis": axis})

    async def axis_wait(
        self,
        axis: str,
        *,
        timeout_ms: int | None = None,
        target_microsteps: int | None = None,
    ) -> Standing:
        """`axis.wait` answers when the axis stands at its target."""
        return Standing.of(await self._call("axis.wait", {"axis": axis, "timeout_ms": timeout_ms, "target_microsteps": target_microsteps}))

    async def lease_acquire(
        self,
        axes: Sequence[str],
        *,
        ttl_ms: int | None = None,
        on_loss: str | None = None,
    ) -> GrantedLease:
        """`lease.acquire` gives the client the right to move some axes alone: all of them, or
        none."""
        return GrantedLease.of(await self._call("lease.acquire", {"axes": axes, "ttl_ms": ttl_ms, "on_loss": on_loss}))

    async def lease_renew(
        self,
        lease: int,
        epoch: int,
        *,
        ttl_ms: int | None = None,
    ) -> GrantedLease:
        """`lease.renew` says that its holder is still there."""
        return GrantedLease.of(await self._call("lease.renew", {"lease": lease, "epoch": epoch, "ttl_ms": ttl_ms}))

    async def lease_release(
        self,
        lease: int,
        epoch: int,
        *,
        stop: bool | None = None,
    ) -> None:
        """`lease.release` ends it, once its axes have taken a stop."""
        await self._call("lease.release", {"lease": lease, "epoch": epoch, "stop": stop})

    async def lease_list(self) -> LeaseList:
        """`lease.list` who may move which axes alone."""
        return LeaseList.of(await self._call("lease.list", {}))

    async def lease_break(self, axis: str) -> None:
        """`lease.break` takes the lease of an axis away, as if its time were over."""
        await self._call("lease.break", {"axis": axis})

    async def token_add(
        self,
        role: str,
        *,
        name: str | None = None,
    ) -> TokenAdd:
        """`token.add` makes a token, by which a client is let in."""
        return TokenAdd.of(await self._call("token.add", {"role": role, "name": name}))

    async def token_list(self) -> TokenList:
        """`token.list` which tokens there are."""
        return TokenList.of(await self._call("token.list", {}))

    async def token_invite(self, name: str) -> TokenInvite:
        """`token.invite` makes a code with which one browser signs in by the token, once, within
        ten minutes."""
        return TokenInvite.of(await self._call("token.invite", {"name": name}))

    async def token_revoke(self, name: str) -> None:
        """`token.revoke` ends the token, and the connections that it let in."""
        await self._call("token.revoke", {"name": name})

    async def client_list(self) -> ClientList:
        """`client.list` who is connected, by which door, with which role."""
        return ClientList.of(await self._call("client.list", {}))

    async def audit_tail(
        self,
        *,
        lines: int | None = None,
        after: int | None = None,
    ) -> AuditTail:
        """`audit.tail` what was moved, set and stopped lately, by whom: the last 1000 lines."""
        return AuditTail.of(await self._call("audit.tail", {"lines": lines, "after": after}))

    async def page_find(self) -> PageFind:
        """`page.find` where the page for browsers is."""
        return PageFind.of(await self._call("page.find", {}))

    async def configuration_get(self) -> ConfigurationGet:
        """`configuration.get` the part of the configuration that clients may set."""
        return ConfigurationGet.of(await self._call("configuration.get", {}))

    async def configuration_set(
        self,
        toml: str,
        *,
        dry_run: bool | None = None,
    ) -> ConfigurationSet:
        """`configuration.set` sets the part of the configuration that is for clients, and goes by
        it."""
        return ConfigurationSet.of(await self._call("configuration.set", {"toml": toml, "dry_run": dry_run}))

    async def speak_for(
        self,
        user: str,
        role: str,
    ) -> SpeakFor:
        """`speak_for` makes the calls of this connection those of a user, from now on."""
        return SpeakFor.of(await self._call("speak_for", {"user": user, "role": role}))

    async def line_move(
        self,
        axes: Sequence[str],
        *,
        positions_microsteps: Sequence[int] | None = None,
        positions: Sequence[float | str] | None = None,
        velocity: float | str | None = None,
        velocity_pps: float | None = None,
        acceleration: float | str | None = None,
        acceleration_pps2: float | None = None,
        time_s: float | None = None,
        deadline_ms: int | None = None,
    ) -> LineMove:
        """`line.move` moves several axes so that they start and arrive together."""
        return LineMove.of(await self._call("line.move", {"axes": axes, "positions_microsteps": positions_microsteps, "positions": positions, "velocity": velocity, "velocity_pps": velocity_pps, "acceleration": acceleration, "acceleration_pps2": acceleration_pps2, "time_s": time_s, "deadline_ms": deadline_ms}))

    async def path_stage(
        self,
        offset: int,
        data: str,
    ) -> PathStage:
        """`path.stage` hands over the next part of a path file."""
        return PathStage.of(await self._call("path.stage", {"offset": offset, "data": data}))

    async def path_plan(
        self,
        *,
        axes: Sequence[str] | None = None,
        file_axes: Sequence[str] | None = None,
        text: str | None = None,
        bytes: int | None = None,
        format: str | None = None,
        mode: str | None = None,
        tolerance: float | None = None,
        velocity: float | str | None = None,
        acceleration: float | str | None = None,
        feed: float | str | None = None,
        corner_jump: float | str | None = None,
        per_turn: float | None = None,
        deviation: float | None = None,
        period_ms: int | None = None,
        lenient: bool | None = None,
        name: str | None = None,
        shaper: str | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        jerk: float | str | None = None,
        points: int | None = None,
    ) -> PathPlan:
        """`path.plan` plans a path, and says what will be run."""
        return PathPlan.of(await self._call("path.plan", {"axes": axes, "file_axes": file_axes, "text": text, "bytes": bytes, "format": format, "mode": mode, "tolerance": tolerance, "velocity": velocity, "acceleration": acceleration, "feed": feed, "corner_jump": corner_jump, "per_turn": per_turn, "deviation": deviation, "period_ms": period_ms, "lenient": lenient, "name": name, "shaper": shaper, "resonance_hz": resonance_hz, "damping": damping, "jerk": jerk, "points": points}))

    async def path_run(
        self,
        *,
        axes: Sequence[str] | None = None,
        file_axes: Sequence[str] | None = None,
        text: str | None = None,
        bytes: int | None = None,
        format: str | None = None,
        mode: str | None = None,
        tolerance: float | None = None,
        velocity: float | str | None = None,
        acceleration: float | str | None = None,
        feed: float | str | None = None,
        corner_jump: float | str | None = None,
        per_turn: float | None = None,
        deviation: float | None = None,
        period_ms: int | None = None,
        lenient: bool | None = None,
        name: str | None = None,
        shaper: str | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        jerk: float | str | None = None,
        plan: int | None = None,
        to_start: bool | None = None,
        points: int | None = None,
    ) -> PathRun:
        """`path.run` moves axes along a path and answers at its end; tells its progress by
        notify_progress."""
        return PathRun.of(await self._call("path.run", {"axes": axes, "file_axes": file_axes, "text": text, "bytes": bytes, "format": format, "mode": mode, "tolerance": tolerance, "velocity": velocity, "acceleration": acceleration, "feed": feed, "corner_jump": corner_jump, "per_turn": per_turn, "deviation": deviation, "period_ms": period_ms, "lenient": lenient, "name": name, "shaper": shaper, "resonance_hz": resonance_hz, "damping": damping, "jerk": jerk, "plan": plan, "to_start": to_start, "points": points}))

    async def path_pause(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathPause:
        """`path.pause` lets axes stand on their path."""
        return PathPause.of(await self._call("path.pause", {"axes": axes}))

    async def path_resume(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathPause:
        """`path.resume` lets them go on, also from M0."""
        return PathPause.of(await self._call("path.resume", {"axes": axes}))

    async def path_status(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathStatus:
        """`path.status` how far the paths of some axes are, and how fast."""
        return PathStatus.of(await self._call("path.status", {"axes": axes}))

    async def path_feed(
        self,
        *,
        axes: Sequence[str] | None = None,
        factor: float | None = None,
        hold: bool | None = None,
    ) -> PathStatus:
        """`path.feed` slows paths down, speeds them up, holds them and lets them go on."""
        return PathStatus.of(await self._call("path.feed", {"axes": axes, "factor": factor, "hold": hold}))

    async def path_stop(
        self,
        *,
        axes: Sequence[str] | None = None,
    ) -> PathPause:
        """`path.stop` ends paths: answers when their axes stand and have their settings again."""
        return PathPause.of(await self._call("path.stop", {"axes": axes}))

    async def mint_run(
        self,
        axes: Sequence[str],
        *,
        numbers: Sequence[int] | None = None,
        counts: str | None = None,
        text: str | None = None,
        bytes: int | None = None,
    ) -> MintRun:
        """`mint.run` moves axes as a Mint program says and answers at its end; tells its progress
        by notify_progress."""
        return MintRun.of(await self._call("mint.run", {"axes": axes, "numbers": numbers, "counts": counts, "text": text, "bytes": bytes}))

    async def axis_get_ramp(
        self,
        axis: str,
        *,
        in_motion: bool | None = None,
    ) -> AxisGetRamp:
        """`axis.get_ramp` what its movements can be foreseen from."""
        return AxisGetRamp.of(await self._call("axis.get_ramp", {"axis": axis, "in_motion": in_motion}))

    async def axis_plan_ramp(
        self,
        axis: str,
        *,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        acceleration: float | str | None = None,
        acceleration_internal: int | None = None,
        deceleration: float | str | None = None,
        deceleration_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
    ) -> AxisPlanRamp:
        """`axis.plan_ramp` chooses the parameters that make a ramp; writes nothing."""
        return AxisPlanRamp.of(await self._call("axis.plan_ramp", {"axis": axis, "velocity": velocity, "velocity_internal": velocity_internal, "acceleration": acceleration, "acceleration_internal": acceleration_internal, "deceleration": deceleration, "deceleration_internal": deceleration_internal, "jerk": jerk, "bow": bow}))

    async def axis_set_ramp(
        self,
        axis: str,
        *,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        acceleration: float | str | None = None,
        acceleration_internal: int | None = None,
        deceleration: float | str | None = None,
        deceleration_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
        store: bool | None = None,
    ) -> AxisPlanRamp:
        """`axis.set_ramp` chooses them, and sets them on an axis that stands."""
        return AxisPlanRamp.of(await self._call("axis.set_ramp", {"axis": axis, "velocity": velocity, "velocity_internal": velocity_internal, "acceleration": acceleration, "acceleration_internal": acceleration_internal, "deceleration": deceleration, "deceleration_internal": deceleration_internal, "jerk": jerk, "bow": bow, "store": store}))

    async def ramp_compare(
        self,
        axis: str,
        *,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        acceleration: float | str | None = None,
        acceleration_internal: int | None = None,
        deceleration: float | str | None = None,
        deceleration_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        tolerance_microsteps: int | None = None,
        tolerance: float | str | None = None,
    ) -> RampCompare:
        """`ramp.compare` what the ramps of an axis that stands make of a move and of a load that
        swings."""
        return RampCompare.of(await self._call("ramp.compare", {"axis": axis, "velocity": velocity, "velocity_internal": velocity_internal, "acceleration": acceleration, "acceleration_internal": acceleration_internal, "deceleration": deceleration, "deceleration_internal": deceleration_internal, "jerk": jerk, "bow": bow, "distance_microsteps": distance_microsteps, "distance": distance, "resonance_hz": resonance_hz, "damping": damping, "tolerance_microsteps": tolerance_microsteps, "tolerance": tolerance}))

    async def ramp_find(
        self,
        axis: str,
        *,
        distance_microsteps: int | None = None,
        distance: float | str | None = None,
        time_s: float | None = None,
        velocity: float | str | None = None,
        velocity_internal: int | None = None,
        jerk: float | str | None = None,
        bow: int | None = None,
        load: float | None = None,
        load_per_velocity: float | None = None,
        inertia: float | None = None,
        corner_speed: float | None = None,
        margin: float | None = None,
    ) -> RampFind:
        """`ramp.find` finds the gentlest ramp that makes a move in time, or the quickest that a
        motor can drive; writes nothing."""
        return RampFind.of(await self._call("ramp.find", {"axis": axis, "distance_microsteps": distance_microsteps, "distance": distance, "time_s": time_s, "velocity": velocity, "velocity_internal": velocity_internal, "jerk": jerk, "bow": bow, "load": load, "load_per_velocity": load_per_velocity, "inertia": inertia, "corner_speed": corner_speed, "margin": margin}))

    async def profile_simulate(
        self,
        model: str,
        distance_microsteps: int,
        *,
        parameters: Sequence[str] | None = None,
        values: Sequence[int] | None = None,
        until_s: float | None = None,
        points: int | None = None,
        resonance_hz: float | None = None,
        damping: float | None = None,
        tolerance_microsteps: int | None = None,
    ) -> ProfileSimulate:
        """`profile.simulate` a move as the ramp generator of a model makes it, of a module that
        need not be there."""
        return ProfileSimulate.of(await self._call("profile.simulate", {"model": model, "parameters": parameters, "values": values, "distance_microsteps": distance_microsteps, "until_s": until_s, "points": points, "resonance_hz": resonance_hz, "damping": damping, "tolerance_microsteps": tolerance_microsteps}))

    async def profile_solve(
        self,
        *,
        distance: float | None = None,
        speed: float | None = None,
        acceleration: float | None = None,
        deceleration: float | None = None,
        acceleration_time: float | None = None,
        slew_time: float | None = None,
        deceleration_time: float | None = None,
        total_time: float | None = None,
        initial_speed: float | None = None,
        final_speed: float | None = None,
        acceleration_distance: float | None = None,
        slew_distance: float | None = None,
        deceleration_distance: float | None = None,
        assumption: str | None = None,
    ) -> ProfileSolve:
        """`profile.solve` all of a trapezoid from as much of it as determines it; asks no module."""
        return ProfileSolve.of(await self._call("profile.solve", {"distance": distance, "speed": speed, "acceleration": acceleration, "deceleration": deceleration, "acceleration_time": acceleration_time, "slew_time": slew_time, "deceleration_time": deceleration_time, "total_time": total_time, "initial_speed": initial_speed, "final_speed": final_speed, "acceleration_distance": acceleration_distance, "slew_distance": slew_distance, "deceleration_distance": deceleration_distance, "assumption": assumption}))

    async def axis_home(
        self,
        axis: str,
        *,
        mode: int | None = None,
        timeout_ms: int | None = None,
        max_travel_microsteps: int | None = None,
        max_travel: float | str | None = None,
        leave: bool | None = None,
    ) -> HomedAxis:
        """`axis.home` searches the reference and answers when that has ended."""
        return HomedAxis.of(await self._call("axis.home", {"axis": axis, "mode": mode, "timeout_ms": timeout_ms, "max_travel_microsteps": max_travel_microsteps, "max_travel": max_travel, "leave": leave}))

    async def axis_start_home(
        self,
        axis: str,
        *,
        mode: int | None = None,
        max_travel_microsteps: int | None = None,
        max_travel: float | str | None = None,
    ) -> AxisStartHome:
        """`axis.start_home` starts a reference search; does not wait for its end."""
        return AxisStartHome.of(await self._call("axis.start_home", {"axis": axis, "mode": mode, "max_travel_microsteps": max_travel_microsteps, "max_travel": max_travel}))

    async def axis_stop_home(self, axis: str) -> None:
        """`axis.stop_home` ends a reference search."""
        await self._call("axis.stop_home", {"axis": axis})

    async def axis_recover(self, axis: str) -> None:
        """`axis.recover` says that an axis may move again whose module is not what it was."""
        await self._call("axis.recover", {"axis": axis})

    async def axis_set_deadman(
        self,
        axis: str,
        ms: int,
    ) -> AxisSetDeadman:
        """`axis.set_deadman` sets the deadman of the module of an axis, in its EEPROM."""
        return AxisSetDeadman.of(await self._call("axis.set_deadman", {"axis": axis, "ms": ms}))

    async def axis_test_deadman(self, axis: str) -> AxisTestDeadman:
        """`axis.test_deadman` moves an axis slowly, sends its module nothing, and measures when it
        stops."""
        return AxisTestDeadman.of(await self._call("axis.test_deadman", {"axis": axis}))

    async def axis_tune(
        self,
        axis: str,
        max_current: int,
        *,
        from_microsteps: int | None = None,
        from_: float | str | None = None,
        to_microsteps: int | None = None,
        to: float | str | None = None,
        margin: float | None = None,
        store: bool | None = None,
        by_switch: str | None = None,
    ) -> AxisTune:
        """`axis.tune` finds by trials the greatest velocity and acceleration that an axis bears."""
        return AxisTune.of(await self._call("axis.tune", {"axis": axis, "max_current": max_current, "from_microsteps": from_microsteps, "from": from_, "to_microsteps": to_microsteps, "to": to, "margin": margin, "store": store, "by_switch": by_switch}))

    async def axis_verify(
        self,
        axis: str,
        *,
        from_microsteps: int | None = None,
        from_: float | str | None = None,
        to_microsteps: int | None = None,
        to: float | str | None = None,
    ) -> AxisVerify:
        """`axis.verify` moves an axis a little, and finds out in what its module is not like its
        twin."""
        return AxisVerify.of(await self._call("axis.verify", {"axis": axis, "from_microsteps": from_microsteps, "from": from_, "to_microsteps": to_microsteps, "to": to}))

    async def capture_start(
        self,
        axis: str,
        channels: Sequence[str],
        *,
        rate_hz: float | None = None,
        samples: int | None = None,
        trigger_parameter: str | None = None,
        trigger_edge: str | None = None,
        trigger_value: int | None = None,
        pretrigger_percent: int | None = None,
        resume: bool | None = None,
    ) -> CaptureStart:
        """`capture.start` has the module of an axis record parameters of it, by command 142."""
        return CaptureStart.of(await self._call("capture.start", {"axis": axis, "channels": channels, "rate_hz": rate_hz, "samples": samples, "trigger_parameter": trigger_parameter, "trigger_edge": trigger_edge, "trigger_value": trigger_value, "pretrigger_percent": pretrigger_percent, "resume": resume}))

    async def capture_state(
        self,
        axis: str,
        capture: int,
    ) -> CaptureState:
        """`capture.state` how far a capture has come."""
        return CaptureState.of(await self._call("capture.state", {"axis": axis, "capture": capture}))

    async def capture_read(
        self,
        axis: str,
        capture: int,
        first: int,
        count: int,
    ) -> CaptureRead:
        """`capture.read` reads what a module has recorded."""
        return CaptureRead.of(await self._call("capture.read", {"axis": axis, "capture": capture, "first": first, "count": count}))

    async def capture_end(
        self,
        axis: str,
        *,
        capture: int | None = None,
    ) -> None:
        """`capture.end` the module records nothing any more, and forgets what it has."""
        await self._call("capture.end", {"axis": axis, "capture": capture})

    async def axis_get_state(
        self,
        axis: str,
        *,
        max_age_ms: int | None = None,
    ) -> State:
        """`axis.get_state` where the axis is and what it does."""
        return State.of(await self._call("axis.get_state", {"axis": axis, "max_age_ms": max_age_ms}))

    async def axis_get_errors(self, axis: str) -> Errors:
        """`axis.get_errors` what its module says is wrong, in words."""
        return Errors.of(await self._call("axis.get_errors", {"axis": axis}))

    async def axis_get_units(self, axis: str) -> Units:
        """`axis.get_units` what the axis counts in."""
        return Units.of(await self._call("axis.get_units", {"axis": axis}))

    async def parameter_get(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
    ) -> Parameter:
        """`parameter.get` reads an axis parameter."""
        return Parameter.of(await self._call("parameter.get", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms}))

    async def parameter_set(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        value: int | None = None,
        value_in_unit: float | str | None = None,
    ) -> ParameterSet:
        """`parameter.set` sets an axis parameter."""
        return ParameterSet.of(await self._call("parameter.set", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms, "value": value, "value_in_unit": value_in_unit}))

    async def parameter_store(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
    ) -> ParameterStore:
        """`parameter.store` copies an axis parameter to the EEPROM."""
        return ParameterStore.of(await self._call("parameter.store", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms}))

    async def parameter_restore(
        self,
        axis: str,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
    ) -> ParameterStore:
        """`parameter.restore` copies an axis parameter back from the EEPROM."""
        return ParameterStore.of(await self._call("parameter.restore", {"axis": axis, "parameter": parameter, "deadline_ms": deadline_ms}))

    async def parameter_list(self, axis: str) -> ParameterList:
        """`parameter.list` the parameters that the model of an axis has."""
        return ParameterList.of(await self._call("parameter.list", {"axis": axis}))

    async def settings_read(
        self,
        bus: str,
        address: int,
    ) -> SettingsRead:
        """`settings.read` reads all settings of a module."""
        return SettingsRead.of(await self._call("settings.read", {"bus": bus, "address": address}))

    async def settings_compare(
        self,
        bus: str,
        address: int,
        *,
        toml: str | None = None,
    ) -> SettingsCompare:
        """`settings.compare` compares a module with a file of settings, or with the one that is
        configured."""
        return SettingsCompare.of(await self._call("settings.compare", {"bus": bus, "address": address, "toml": toml}))

    async def settings_load(
        self,
        bus: str,
        address: int,
        toml: str,
        *,
        store: bool | None = None,
    ) -> SettingsLoad:
        """`settings.load` sets a module as a file of settings says; its motors must stand, and
        nothing moves."""
        return SettingsLoad.of(await self._call("settings.load", {"bus": bus, "address": address, "toml": toml, "store": store}))

    async def settings_store(self, axis: str) -> SettingsStore:
        """`settings.store` keeps all settings of an axis as they are now, in the module's EEPROM."""
        return SettingsStore.of(await self._call("settings.store", {"axis": axis}))

    async def coordinate_get(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
    ) -> CoordinateGet:
        """`coordinate.get` reads a coordinate."""
        return CoordinateGet.of(await self._call("coordinate.get", {"axis": axis, "number": number, "deadline_ms": deadline_ms}))

    async def coordinate_set(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
        position_microsteps: int | None = None,
        position: float | str | None = None,
    ) -> None:
        """`coordinate.set` remembers a position by a number."""
        await self._call("coordinate.set", {"axis": axis, "number": number, "deadline_ms": deadline_ms, "position_microsteps": position_microsteps, "position": position})

    async def coordinate_capture(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
    ) -> CoordinateGet:
        """`coordinate.capture` remembers where the axis is."""
        return CoordinateGet.of(await self._call("coordinate.capture", {"axis": axis, "number": number, "deadline_ms": deadline_ms}))

    async def coordinate_move(
        self,
        axis: str,
        number: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`coordinate.move` starts a move to a coordinate."""
        await self._call("coordinate.move", {"axis": axis, "number": number, "deadline_ms": deadline_ms})

    async def coordinate_start(
        self,
        bus: str,
        address: int,
        number: int,
        motors: Sequence[int],
        *,
        deadline_ms: int | None = None,
        interpolated: bool | None = None,
    ) -> None:
        """`coordinate.start` starts motors of a module together, each to its own coordinate of
        this number."""
        await self._call("coordinate.start", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "number": number, "motors": motors, "interpolated": interpolated})

    async def coordinate_store(
        self,
        axis: str,
        *,
        number: int | None = None,
        deadline_ms: int | None = None,
    ) -> None:
        """`coordinate.store` copies coordinates of all motors of the axis' module to the EEPROM."""
        await self._call("coordinate.store", {"axis": axis, "number": number, "deadline_ms": deadline_ms})

    async def coordinate_load(
        self,
        axis: str,
        *,
        number: int | None = None,
        deadline_ms: int | None = None,
    ) -> None:
        """`coordinate.load` copies them back from the EEPROM."""
        await self._call("coordinate.load", {"axis": axis, "number": number, "deadline_ms": deadline_ms})

    async def global_get(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalGet:
        """`global.get` reads a global parameter."""
        return GlobalGet.of(await self._call("global.get", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank}))

    async def global_set(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        value: int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalGet:
        """`global.set` sets a global parameter."""
        return GlobalGet.of(await self._call("global.set", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank, "value": value}))

    async def global_store(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalStore:
        """`global.store` copies a global parameter to the EEPROM."""
        return GlobalStore.of(await self._call("global.store", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank}))

    async def global_restore(
        self,
        bus: str,
        address: int,
        parameter: str | int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> GlobalStore:
        """`global.restore` copies a global parameter back from the EEPROM."""
        return GlobalStore.of(await self._call("global.restore", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "parameter": parameter, "bank": bank}))

    async def io_get(
        self,
        bus: str,
        address: int,
        port: int,
        *,
        deadline_ms: int | None = None,
        bank: int | None = None,
    ) -> IoGet:
        """`io.get` reads an input or output."""
        return IoGet.of(await self._call("io.get", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "port": port, "bank": bank}))

    async def io_set(
        self,
        bus: str,
        address: int,
        port: int,
        value: int,
        *,
        deadline_ms: int | None = None,
    ) -> IoGet:
        """`io.set` sets a digital output."""
        return IoGet.of(await self._call("io.set", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "port": port, "value": value}))

    async def module_info(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> ModuleInfo:
        """`module.info` what a module's firmware says of itself."""
        return ModuleInfo.of(await self._call("module.info", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    async def module_report_arrivals(
        self,
        bus: str,
        address: int,
        motors: Sequence[int],
        *,
        deadline_ms: int | None = None,
        every: bool | None = None,
    ) -> None:
        """`module.report_arrivals` lets a module tell when motors arrive: events of the kind
        target_reached."""
        await self._call("module.report_arrivals", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "motors": motors, "every": every})

    async def module_reset(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`module.reset` restarts a module."""
        await self._call("module.reset", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    async def module_factory_reset(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`module.factory_reset` restores everything in a module to how it was delivered."""
        await self._call("module.factory_reset", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    async def program_assemble(
        self,
        text: str,
        *,
        model: str | None = None,
    ) -> ProgramAssemble:
        """`program.assemble` makes a program file of a program's text; asks no module."""
        return ProgramAssemble.of(await self._call("program.assemble", {"text": text, "model": model}))

    async def program_load(
        self,
        bus: str,
        address: int,
        program: str,
        *,
        first_address: int | None = None,
        compare: bool | None = None,
    ) -> ProgramLoad:
        """`program.load` loads a program into a module; tells its progress by notify_progress."""
        return ProgramLoad.of(await self._call("program.load", {"bus": bus, "address": address, "program": program, "first_address": first_address, "compare": compare}))

    async def program_compare(
        self,
        bus: str,
        address: int,
        program: str,
        *,
        first_address: int | None = None,
    ) -> ProgramLoad:
        """`program.compare` compares a program with the one in a module."""
        return ProgramLoad.of(await self._call("program.compare", {"bus": bus, "address": address, "program": program, "first_address": first_address}))

    async def program_read(
        self,
        bus: str,
        address: int,
        *,
        first_address: int | None = None,
        length: int | None = None,
    ) -> ProgramRead:
        """`program.read` reads the program in a module."""
        return ProgramRead.of(await self._call("program.read", {"bus": bus, "address": address, "first_address": first_address, "length": length}))

    async def program_run(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
        first_address: int | None = None,
    ) -> ProgramRun:
        """`program.run` runs the program in a module."""
        return ProgramRun.of(await self._call("program.run", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "first_address": first_address}))

    async def program_stop(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.stop` ends the program; motors go on."""
        await self._call("program.stop", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    async def program_step(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> ProgramRun:
        """`program.step` executes one command of the program."""
        return ProgramRun.of(await self._call("program.step", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    async def program_step_to(
        self,
        bus: str,
        address: int,
        *,
        until: Sequence[int] | None = None,
        most_steps: int | None = None,
        wait_ms: int | None = None,
    ) -> ProgramStepTo:
        """`program.step_to` executes commands of the program one by one, until it stands before
        one of these; tells its progress by notify_progress."""
        return ProgramStepTo.of(await self._call("program.step_to", {"bus": bus, "address": address, "until": until, "most_steps": most_steps, "wait_ms": wait_ms}))

    async def program_reset(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.reset` ends the program and sets it back to its start."""
        await self._call("program.reset", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    async def program_status(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> ProgramStatus:
        """`program.status` what the program does."""
        return ProgramStatus.of(await self._call("program.status", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    async def program_set_breakpoint(
        self,
        bus: str,
        address: int,
        at: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.set_breakpoint` stops the program there from now on."""
        await self._call("program.set_breakpoint", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "at": at})

    async def program_clear_breakpoint(
        self,
        bus: str,
        address: int,
        at: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.clear_breakpoint` does not stop it there any more."""
        await self._call("program.clear_breakpoint", {"bus": bus, "address": address, "deadline_ms": deadline_ms, "at": at})

    async def program_clear_breakpoints(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> None:
        """`program.clear_breakpoints` does not stop it anywhere any more."""
        await self._call("program.clear_breakpoints", {"bus": bus, "address": address, "deadline_ms": deadline_ms})

    async def firmware_status(
        self,
        bus: str,
        address: int,
        *,
        deadline_ms: int | None = None,
    ) -> FirmwareStatus:
        """`firmware.status` what runs in a module, as its updates need to know."""
        return FirmwareStatus.of(await self._call("firmware.status", {"bus": bus, "address": address, "deadline_ms": deadline_ms}))

    async def firmware_stage(
        self,
        offset: int,
        data: str,
    ) -> PathStage:
        """`firmware.stage` hands over the next part of a firmware image."""
        return PathStage.of(await self._call("firmware.stage", {"offset": offset, "data": data}))

    async def firmware_upload(
        self,
        bus: str,
        address: int,
        start: int,
        bytes: int,
        *,
        force: bool | None = None,
    ) -> FirmwareUpload:
        """`firmware.upload` exchanges the firmware of a module for the image that was handed over;
        tells its progress by notify_progress."""
        return FirmwareUpload.of(await self._call("firmware.upload", {"bus": bus, "address": address, "start": start, "bytes": bytes, "force": force}))

    async def system_stop_all(self) -> StoppedAxes:
        """`system.stop_all` stops all axes at once."""
        return StoppedAxes.of(await self._call("system.stop_all", {}))

    async def subscribe(
        self,
        *,
        axes: Sequence[str] | None = None,
        interval_ms: int | None = None,
        parameters: Sequence[str] | None = None,
        every_look: bool | None = None,
    ) -> Subscribe:
        """`subscribe` tells of states by notify_state whenever they change, and of events."""
        return Subscribe.of(await self._call("subscribe", {"axes": axes, "interval_ms": interval_ms, "parameters": parameters, "every_look": every_look}))

    async def unsubscribe(self, subscription: int) -> None:
        """`unsubscribe` ends a subscription."""
        await self._call("unsubscribe", {"subscription": subscription})
