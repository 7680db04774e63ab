"""An axis as a device of Bluesky in a RunEngine of its own. A command comes as a line of JSON, [name,
...], and all that there is to tell goes out as one. Where there is no Bluesky, a plan is one move."""

import json
import os
import sys
import threading

from bluesky_axis import connect

try:
    from bluesky import RunEngine, plan_stubs, plans
except ImportError:
    RunEngine = None

OUT = os.dup(1)
os.dup2(2, 1)  # a RunEngine prints, too


def tell(name, said=None):
    os.write(OUT, json.dumps([name, said]).encode() + b"\n")  # whole, from whichever thread


class Host:
    def __init__(self, socket, lease):
        self.axis = connect("x", where=socket, lease=lease)[0]
        if RunEngine is not None:
            self.engine = RunEngine(context_managers=[])  # these are for the main thread
            self.engine.subscribe(lambda kind, document: tell(kind, told_of(document)))

    def run(self, name, plan):
        """In a thread, since the main one takes commands."""

        def run():
            try:
                plan()
                tell("ended", name)
            except Exception as error:
                tell("failed", f"{type(error).__name__}: {error.__cause__ or error}")

        tell("begun", name)
        threading.Thread(target=run, daemon=True).start()

    def mv(self, to):
        def alone():
            self.axis.set(to).wait()

        def planned():
            self.engine(plan_stubs.mv(self.axis, to))

        self.run("mv", alone if RunEngine is None else planned)

    def scan(self, start, stop, steps):
        self.run("scan", lambda: self.engine(plans.scan([], self.axis, start, stop, steps)))

    def rel_scan(self, start, stop, steps):
        self.run("rel_scan", lambda: self.engine(plans.rel_scan([], self.axis, start, stop, steps)))

    def count(self):
        self.run("count", lambda: self.engine(plans.count([self.axis])))

    def pause(self):
        self.engine.request_pause()

    def resume(self):
        self.run("resume", self.engine.resume)

    def abort(self):
        self.run("abort", self.engine.abort)

    def stop(self):
        self.axis.stop()

    def read(self):
        tell("read", self.axis.read()["x"]["value"])

    def close(self):
        self.axis.bridge.close()


def told_of(document):
    return {key: document[key] for key in ("data", "exit_status") if key in document}


host = Host(*sys.argv[1:])
tell("started")
for line in sys.stdin:
    name, *said = json.loads(line)
    try:
        getattr(host, name)(*said)
    except Exception as error:
        tell("exception", f"{type(error).__name__}: {error}")
    tell("done", name)
