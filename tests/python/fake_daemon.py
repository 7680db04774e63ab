"""A daemon that does what a test says: on a unix socket, or by WebSocket as the test's own server."""

import base64
import hashlib
import json
import os
import socket
import ssl
import subprocess
import tempfile
import threading

GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
HELLO = {"jsonrpc": "2.0", "method": "hello",
         "params": {"protocol": {"major": 1, "minor": 1}, "daemon": "fake"}}
SILENCE = object()  # no answer
HANG_UP = object()  # the connection ends instead

STATE = {"axis": "x", "position_microsteps": 0, "velocity_internal": 0, "target_microsteps": 0,
         "position_reached": True, "moving": False, "unit": "mm", "position": 1.5, "velocity": 0.0,
         "target": 1.5, "seq": 1, "event_time_ms": 5}


def error(name, outcome="refused", **more):
    return {"error": {"code": -32000, "message": name, "data": {"name": name, "outcome": outcome,
                                                              **more}}}


class Peer:
    """One connection, as the fake sees it."""

    def __init__(self, connection):
        self._connection = connection
        self._lines = connection.makefile("rb")
        self._lock = threading.Lock()

    def open(self):
        self.say(HELLO)

    def send(self, data):
        with self._lock:
            self._connection.sendall(data)

    def say(self, message):
        self.send(json.dumps(message).encode() + b"\n")

    def listen(self):
        for line in self._lines:
            yield json.loads(line)

    def close(self):
        try:
            self._connection.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self._connection.close()


class WebPeer(Peer):
    """The same with an HTTP handshake and frames."""

    token = "secret"

    def open(self):
        headers = {}
        self.request = self._lines.readline().decode().strip()
        while (line := self._lines.readline().decode().strip()):
            name, _, value = line.partition(":")
            headers[name.lower()] = value.strip()
        if headers.get("authorization") != f"Bearer {self.token}":
            self.send(b"HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n")
            raise OSError("no token")
        digest = hashlib.sha1((headers["sec-websocket-key"] + GUID).encode()).digest()
        accept = base64.b64encode(digest).decode()
        self.send(f"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                  f"Sec-WebSocket-Accept: {accept}\r\n\r\n".encode())
        self.say(HELLO)

    def say(self, message):
        text = json.dumps(message).encode()
        size = bytes([len(text)]) if len(text) < 126 else b"\x7e" + len(text).to_bytes(2, "big")
        self.send(b"\x81" + size + text)

    def listen(self):
        while len(head := self._lines.read(2)) == 2:
            size = head[1] & 0x7F
            if size >= 126:
                size = int.from_bytes(self._lines.read(2 if size == 126 else 8), "big")
            mask = self._lines.read(4)
            body = self._lines.read(size)
            payload = bytes(byte ^ mask[i % 4] for i, byte in enumerate(body))
            if head[0] & 0x0F == 1:
                yield json.loads(payload)


class FakeDaemon:
    """`answers[method]`: a result, {"error": ...}, SILENCE, HANG_UP, bytes to send as they are, a
    list of these for one call after the other, or a function of the peer and the request."""

    def __init__(self, context=None):
        self.answers = {"axis.list": {"axes": [{"name": "x"}]}, "bus.list": {"buses": []}}
        self.calls = []
        self.peers = []
        self.context = context
        self.folder = tempfile.TemporaryDirectory()
        self.path = f"{self.folder.name}/socket"
        self.listener = None

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self.stop()
        self.folder.cleanup()

    def start(self):
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.path)
        self._serve(Peer)

    def _serve(self, kind):
        self.listener.listen()
        threading.Thread(target=self._accept, args=(self.listener, kind), daemon=True).start()

    def stop(self):
        """As a daemon that ends: its socket is gone, and its connections are."""
        if self.listener is not None:
            self.listener.shutdown(socket.SHUT_RDWR)  # ends accept()
            self.listener.close()
            self.listener = None
        if os.path.exists(self.path):
            os.unlink(self.path)
        for peer in self.peers:
            peer.close()
        self.peers = []

    def count(self, method):
        return sum(call["method"] == method for call in self.calls)

    def _accept(self, listener, kind):
        while True:
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            threading.Thread(target=self._talk, args=(connection, kind), daemon=True).start()

    def _talk(self, connection, kind):
        try:
            if self.context is not None:
                connection = self.context.wrap_socket(connection, server_side=True)
            peer = kind(connection)
            self.peers.append(peer)
            peer.open()
            for request in peer.listen():
                self.calls.append(request)
                self._answer(peer, request)
        except (OSError, ValueError):
            connection.close()

    def _answer(self, peer, request):
        answer = self.answers.get(request["method"], {})
        if isinstance(answer, list):
            answer = answer.pop(0) if len(answer) > 1 else answer[0]
        if callable(answer):
            answer = answer(peer, request)
        if answer is HANG_UP:
            peer.close()
        elif isinstance(answer, bytes):
            peer.send(answer)
        elif answer is not SILENCE:
            body = answer if "error" in answer else {"result": answer}
            peer.say({"jsonrpc": "2.0", "id": request["id"], **body})


class FakeWebDaemon(FakeDaemon):
    def start(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        scheme = "http" if self.context is None else "https"
        self.url = f"{scheme}://localhost:{self.listener.getsockname()[1]}"
        self._serve(WebPeer)


def tls_context(folder):
    """With a certificate for localhost that nobody has signed: cert.pem in the folder."""
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
         "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost",
         "-keyout", f"{folder}/key.pem", "-out", f"{folder}/cert.pem"],
        check=True, stderr=subprocess.DEVNULL)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(f"{folder}/cert.pem", f"{folder}/key.pem")
    return context
