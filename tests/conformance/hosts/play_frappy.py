"""Plays a SECoP server of frappy with its PD-1161, asked by frappy's own client: play_frappy.py PLACE CHECKOUT."""

import logging
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from checks import check, crashed, finish, near, until

READABLE = (
    "value encoder steppos speed minspeed currentspeed maxcurrent standby_current acceleration target_reached "
    "move_status error_bits home free_wheeling power_down_delay baudrate encoder_tolerance"
).split()

# frappy logs by a package that Debian does not have; the class that it uses is one of logging's.
MLZLOG = """
import logging, sys
from logging import *
COMMENT = logging.INFO + 5
class MLZLogger(logging.Logger):
    def getChild(self, suffix, ownDir=False): return logging.getLogger(self.name + '.' + suffix)
    def init(self, level): self.setLevel(logging.INFO)
    def addHandler(self, handler): logging.Logger.addHandler(self, handler)
def getLogger(name=None, *a, **k): return logging.getLogger(name)
class ColoredConsoleHandler(logging.StreamHandler):
    def __init__(self, *a): super().__init__(sys.stderr)
class LogfileHandler(logging.NullHandler):
    def __init__(self, *a, **k): super().__init__()
Handler, LOGLEVELS = logging.Handler, {k.lower(): v for k, v in logging._nameToLevel.items()}
INVLOGLEVELS = {v: k for k, v in LOGLEVELS.items()}
logging.setLoggerClass(MLZLogger)
"""


def server(folder, place, checkout):
    uri = f"tcp://{place}" if not place.startswith("/") else f"serial://{place}?baudrate=115200"
    (folder / "m_cfg.py").write_text(
        "Node('m.test', 'motor', interface='tcp://0')\n"
        f"Mod('io', 'frappy.io.BytesIO', 'line', uri='{uri}')\n"
        "Mod('m', 'frappy_psi.trinamic.Motor', 'motor', io='io', has_encoder=True, encoder_tolerance=3.6, "
        "move_limit=9999, safe_current=2.8, speed=300, acceleration=300, maxcurrent=1.0)\n"
    )
    (folder / "mlzlog.py").write_text(MLZLOG)
    (folder / "log").mkdir()
    environment = {
        **os.environ,
        "FRAPPY_CONFDIR": str(folder),
        "FRAPPY_LOGDIR": str(folder / "log"),
        "FRAPPY_PIDDIR": str(folder),
        "PYTHONPATH": f"{folder}:{checkout}",
    }
    log = open(folder / "server.log", "w")
    return subprocess.Popen(
        [sys.executable, f"{checkout}/bin/frappy-server", "-c", str(folder / "m_cfg.py"), "m"],
        env=environment, stdout=log, stderr=log,
    )


def listening(process):
    """The TCP port of the server, by what the kernel knows of it."""
    found = subprocess.run(["ss", "-Hltnp"], capture_output=True, text=True).stdout
    ports = re.findall(rf":(\d+) .*pid={process.pid},", found)
    return int(ports[0]) if ports else None


def play(client):
    def get(name):
        return client.getParameter("m", name, trycache=False).value

    def put(name, value):
        return client.setParameter("m", name, value).value

    def idle():
        return int(get("status")[0]) == 100

    def go(angle):
        put("target", angle)
        time.sleep(0.2)
        return round(get("value"), 1) if until(idle) else "still moving"

    check("idle after the start", idle, True)
    for name in READABLE:
        check("read " + name, lambda: get(name))
    check("speed", lambda: put("speed", 350), near(350, 0.5))
    check("acceleration", lambda: put("acceleration", 300), near(300, 10))
    check("maxcurrent", lambda: put("maxcurrent", 0.8), near(0.8, 0.02))
    check("free_wheeling", lambda: put("free_wheeling", 0.2), near(0.2, 0.01))
    check("power_down_delay", lambda: put("power_down_delay", 0.5), near(0.5, 0.01))
    check("move to 90 deg", lambda: go(90), near(90, 1))
    check("the encoder follows", lambda: get("encoder") - get("steppos"), near(0, 0.9))
    check("move to -45 deg", lambda: go(-45), near(-45, 1))

    def stop():
        put("target", 3000)
        time.sleep(0.5)
        client.execCommand("m", "stop")
        return until(lambda: abs(get("currentspeed")) < 1) and until(idle)

    check("stop while it moves", stop, True)
    check("reset", lambda: client.execCommand("m", "reset"))


def main():
    place, checkout = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        process = server(folder, place, checkout)
        try:
            sys.path.insert(0, str(folder))
            from frappy.client import SecopClient

            logging.disable(logging.CRITICAL)
            if not until(lambda: process.poll() is not None or listening(process)):
                raise SystemExit((folder / "server.log").read_text())
            client = SecopClient(f"127.0.0.1:{listening(process)}")
            client.connect()
            play(client)
            client.disconnect()
        except Exception:
            print((folder / "server.log").read_text()[-2000:])
            crashed()
        finally:
            process.terminate()
            process.wait(10)
    finish()


main()
