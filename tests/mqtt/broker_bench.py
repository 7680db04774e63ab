"""What the tests of tmcld-mqtt on a broker share: mosquitto with TLS, certificates and the ACL of config/fleet, a real tmcld
and tmclsim, and clients.

The script that imports this is called with the folder of the programs and mosquitto.
"""
import contextlib
import getpass
import json
import pathlib
import queue
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

PROGRAMS, MOSQUITTO = pathlib.Path(sys.argv[1]), sys.argv[2]
ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE_S = 60  # on a busy machine
TTL_MS = 20_000  # of nonces: a busy machine takes long for two calls
GATEWAY = "hall-1"

folder = pathlib.Path(tempfile.mkdtemp(prefix="tmcld-mqtt-"))
running = []


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


PORT = free_port()


def run(*words, **more):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, **more)


def start(*words, log=None):
    out = open(folder / log, "ab") if log else subprocess.PIPE
    process = subprocess.Popen([str(word) for word in words], stdout=out, stderr=subprocess.STDOUT if log else None)
    running.append(process)
    return process


def end(process, how=signal.SIGTERM):
    process.send_signal(how)
    process.wait(PATIENCE_S)
    running.remove(process)


def await_(what, condition):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.05)
    raise AssertionError(f"{what}: not within {PATIENCE_S} s")


def expect(what, got, wanted):
    assert got == wanted, f"{what}: {got!r} instead of {wanted!r}"


# ---- certificates and the broker --------------------------------------------------------------------


def commands_of_page():
    """Those of docs/FLEET.md: what is indented there, with its continued lines."""
    lines = (ROOT / "docs/FLEET.md").read_text().replace("\\\n", " ").splitlines()
    return [line.strip() for line in lines if line.startswith("    ")]


def command_of_page(begin):
    return next(line for line in commands_of_page() if line.startswith(begin))


def make_certificates(*more):
    """Of the authority, the broker, the gateway, anna, eve, and more names."""
    run("bash", "-c", command_of_page("openssl req -x509"), cwd=folder)
    (folder / "names").write_text("subjectAltName=DNS:localhost\n")
    for name in ("broker", GATEWAY, "anna", "eve", *more):
        request = command_of_page("openssl req -newkey").replace("hall-1", file_of(name))
        run("bash", "-c", request.replace(f"/CN={file_of(name)}", f"'/CN={subject(name)}'"), cwd=folder)
        run("bash", "-c", command_of_page("openssl x509").replace("hall-1", file_of(name)) + " -extfile names", cwd=folder)


def subject(name):
    return re.sub(r"([/+])", r"\\\1", name)


def file_of(name):
    """That of a certificate, without its suffix."""
    return re.sub(r"[^a-z0-9-]", lambda one: f"{ord(one[0]):x}", name)


def certificate_of(user):
    return folder / f"{file_of(user)}.crt", folder / f"{file_of(user)}.key"


def write_broker_config(more="", name="mosquitto", port=PORT):
    text = (ROOT / "config/fleet/mosquitto.conf").read_text()
    text = text.replace("listener 8883", f"listener {port} 127.0.0.1")
    text = text.replace("/etc/mosquitto/certs/", f"{folder}/").replace("/etc/mosquitto/tmcl.acl", f"{folder}/{name}.acl")
    (folder / f"{name}.conf").write_text(text + f"user {getpass.getuser()}\n{more}\n")
    shutil.copy(ROOT / "config/fleet/tmcl.acl", folder / f"{name}.acl")
    (folder / f"{name}.acl").chmod(0o600)


def uncomment(file, begin):
    """The lines from that one to the next empty one are in force."""
    head, found, rest = file.read_text().partition(f"#{begin}\n")
    section, gap, tail = (found + rest).partition("\n\n")
    assert found, f"{file.name} has no {begin}"
    file.write_text(head + section.replace("\n#", "\n")[1:] + gap + tail)


def start_broker(name="mosquitto", port=PORT):
    process = start(MOSQUITTO, "-c", folder / f"{name}.conf", log=f"{name}.log")
    await_("mosquitto", lambda: is_open(port))
    return process


def is_open(port):
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


# ---- clients ----------------------------------------------------------------------------------------


def as_user(user):
    certificate, key = certificate_of(user)
    return ["-V", "5", "-h", "localhost", "-p", str(PORT), "--cafile", folder / "ca.crt", "--cert", certificate, "--key", key]


def publish(user, topic, text="", *more):
    run("mosquitto_pub", *as_user(user), "-t", topic, *(["-m", text] if text else ["-n"]), *more)


def ask(user, topic, text, patience_s=20):
    """The answer; None if none comes."""
    to = f"tmcl/v1/reply/{user}/{GATEWAY}/{time.monotonic_ns()}"
    words = ["mosquitto_rr", *as_user(user), "-t", topic, "-e", to, "-m", text, "-W", patience_s]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    return json.loads(done.stdout) if done.stdout.strip() else None


def call(user, method, params=None, role="operate", **more):
    said = {"params": params or {}, **more}
    answer = ask(user, f"tmcl/v1/{GATEWAY}/call/{role}/{user}/{method}", json.dumps(said))
    assert answer is not None, f"{method} of {user} is not answered"
    return answer


def fresh(user, role="operate"):
    answer = call(user, "nonce", role=role)
    return {"epoch": answer["epoch"], "nonce": answer["nonce"]}


def act(user, method, params):
    """The result of what moves or sets; again, where a busy machine made it too late. The call, too."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        said = fresh(user)
        answer = call(user, method, params, **said)
        if "result" in answer:
            return answer["result"], said
        assert name_of_error(answer).startswith("stale_") and time.monotonic() < deadline, answer


def name_of_error(answer):
    return answer["error"]["data"]["name"] if "error" in answer else json.dumps(answer)


class Listener:
    """Everything on some topics, from its construction on."""

    def __init__(self, user, *topics):
        # What -d adds begins with a word.
        words = ["stdbuf", "-oL", "mosquitto_sub", *as_user(user), "-d", "-F", "%r %t %p"]
        for topic in topics:
            words += ["-t", topic]
        self.process = start(*words)
        self.heard = queue.Queue()
        self.latest = {}
        self.is_subscribed = threading.Event()
        threading.Thread(target=self.read, daemon=True).start()
        assert self.is_subscribed.wait(PATIENCE_S), f"{user} is not subscribed within {PATIENCE_S} s"

    def read(self):
        for line in self.process.stdout:
            line = line.decode().rstrip("\n")
            if line.startswith("Subscribed "):
                self.is_subscribed.set()
            if not line.startswith(("0 ", "1 ")):
                continue
            retained, topic, text = line.split(" ", 2)
            said = json.loads(text) if text else None
            self.latest[topic] = said
            self.heard.put((retained == "1", topic, said))

    def next(self, what, fits):
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            try:
                one = self.heard.get(timeout=1)
            except queue.Empty:
                continue
            if fits(*one):
                return one[2]
        raise AssertionError(f"{what}: not heard within {PATIENCE_S} s")

    def last(self, what, topic, fits):
        """What stands there, as soon as it fits."""
        whole = f"tmcl/v1/{GATEWAY}/{topic}"
        await_(what, lambda: (said := self.latest.get(whole)) and fits(said))
        return self.latest[whole]

    def birth(self, what, fits):
        return self.last(what, "birth", fits)

    def state(self, what, axis, fits):
        return self.last(what, f"state/{axis}", fits)

    def close(self):
        end(self.process)


def send(user, topic, text, to, *more):
    """The answer to what mosquitto_rr cannot ask. `to`: a gateway, or all."""
    listener = Listener(user, f"tmcl/v1/reply/{user}/#")
    mark = str(time.monotonic_ns())
    publish(user, topic, text, *more, "-D", "publish", "response-topic", f"tmcl/v1/reply/{user}/{to}/{mark}")
    answer = listener.next(f"the answer to {topic}", lambda _, where, __: where == f"tmcl/v1/reply/{user}/{GATEWAY}/{mark}")
    listener.close()
    return answer


class Local:
    """A client on tmcld's own socket."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(PATIENCE_S)
        self.socket.connect(str(folder / "socket"))
        self.lines = self.socket.makefile()
        self.lines.readline()

    def call(self, method, params=None):
        request = {"jsonrpc": "2.0", "id": 1, "method": method, "params": params or {}}
        self.socket.sendall(json.dumps(request).encode() + b"\n")
        return json.loads(self.lines.readline())

    def state(self, axis):
        return self.call("axis.get_state", {"axis": axis})["result"]

    def worst_wait(self, while_):
        """The longest that it waits for a state meanwhile."""
        worst = 0
        while while_():
            began = time.monotonic()
            self.state("x")
            worst = max(worst, time.monotonic() - began)
        return worst


# ---- the gateway ------------------------------------------------------------------------------------


def start_simulator():
    process = start(PROGRAMS / "tmclsim", "--module", "TMCM-3110@1", "--pty", folder / "bus", log="tmclsim.log")
    await_("tmclsim", lambda: "ready" in (folder / "tmclsim.log").read_text())
    return process


def write_gateway_config(*more, nonce_ttl_ms=TTL_MS, port=PORT):
    """Of tmcld, and of tmcld-mqtt, which gets more lines."""
    text = f"""
[daemon]
socket = "{folder}/socket"
audit = "{folder}/audit"
[[access]]
role = "operate"
users = ["{getpass.getuser()}"]
relay = true
[[bus]]
name = "bench"
link = "serial:{folder}/bus@115200"
reply_timeout_ms = 1000
"""
    for motor, axis in enumerate("xy"):
        text += f'[[axis]]\nname = "{axis}"\nbus = "bench"\naddress = 1\nmotor = {motor}\n'
    (folder / "tmcld.toml").write_text(text)
    (folder / "mqtt.toml").write_text(f"""
[mqtt]
broker = "localhost:{port}"
gateway = "{GATEWAY}"
socket = "{folder}/socket"
ca = "{folder}/ca.crt"
certificate = "{folder}/{GATEWAY}.crt"
key = "{folder}/{GATEWAY}.key"
nonce_ttl_ms = {nonce_ttl_ms}
""" + "\n".join(more))


def start_daemon():
    process = start(PROGRAMS / "tmcld", "--config", folder / "tmcld.toml", log="tmcld.log")
    await_("tmcld", lambda: "module_answers" in (folder / "tmcld.log").read_text())
    return process


def start_mqtt():
    return start(PROGRAMS / "tmcld-mqtt", "--config", folder / "mqtt.toml", log="tmcld-mqtt.log")


# ---- the script -------------------------------------------------------------------------------------


@contextlib.contextmanager
def cleared_away():
    """Ends what was started; where a test failed, shows what the programs said last."""
    try:
        yield
    except BaseException:
        for log in ("tmcld-mqtt.log", "tmcld.log", "mosquitto.log"):
            if (folder / log).exists():
                print(f"---- {log}\n" + "\n".join((folder / log).read_text().splitlines()[-40:]))
        raise
    finally:
        for process in running:
            process.kill()
            process.wait()
        shutil.rmtree(folder)


def play(*tests):
    for test in tests:
        began = time.monotonic()
        test()
        print(f"{test.__name__}: {time.monotonic() - began:.1f} s", flush=True)
