#!/usr/bin/env python3
"""Clients of tmcld by HTTP and WebSocket, with nothing but the standard library: what a test asks for by name.

    web_clients.py half-open PORT COUNT           connections that say nothing; others are served all the same
    web_clients.py body PORT BYTES                a body that is far too long
    web_clients.py silent PORT                    a WebSocket that only listens is greeted, and stays
    web_clients.py revoked PORT TOKEN OTHER NAME  OTHER revokes the token NAME of a WebSocket that has a lease
    web_clients.py crowd PORT COUNT [CA]          WebSockets with subscriptions that all call; 'p99 MS' of stops
"""
import asyncio
import base64
import json
import os
import resource
import socket
import ssl
import struct
import sys
import time

# A computer that is busy with other tests is slow, not wrong.
PATIENCE_S = 60


class WebSocket:
    """Frames as RFC 6455 has them, as far as a client of tmcld needs them."""

    def __init__(self, reader, writer):
        self.reader, self.writer, self.last_id = reader, writer, 0

    @classmethod
    async def open(cls, port, context=None, token=None):
        name = "localhost" if context else None
        reader, writer = await asyncio.open_connection("127.0.0.1", port, ssl=context, server_hostname=name)
        head = f"GET /ws HTTP/1.1\r\nHost: localhost:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        head += "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode()
        head += f"\r\nAuthorization: Bearer {token}" if token else ""
        writer.write((head + "\r\n\r\n").encode())
        status = (await reader.readuntil(b"\r\n\r\n")).split(b"\r\n")[0]
        if b" 101 " not in status:
            raise RuntimeError(status.decode())
        return cls(reader, writer)

    def send(self, opcode, data):
        mask = os.urandom(4)
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + struct.pack(">H", len(data))
        self.writer.write(bytes([0x80 | opcode]) + size + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    async def frame(self):
        """Its opcode and what is in it; a ping is answered."""
        while True:
            head, size = await self.reader.readexactly(2)
            if size == 126:
                (size,) = struct.unpack(">H", await self.reader.readexactly(2))
            elif size == 127:
                (size,) = struct.unpack(">Q", await self.reader.readexactly(8))
            data = await self.reader.readexactly(size)
            if head & 0xF == 9:
                self.send(10, data)
                continue
            return head & 0xF, data

    async def message(self):
        opcode, data = await self.frame()
        if opcode != 1:
            raise RuntimeError(f"a frame of kind {opcode}: {data!r}")
        return json.loads(data)

    async def call(self, method, **params):
        self.last_id += 1
        self.send(1, json.dumps({"jsonrpc": "2.0", "id": self.last_id, "method": method, "params": params}).encode())
        while True:
            message = await self.message()
            if message.get("id") == self.last_id:
                return message["result"]


def health(port):
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as one:
        one.sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        answer = b""
        while part := one.recv(4096):
            answer += part
    assert answer.startswith(b"HTTP/1.1 200") and answer.endswith(b"ok\n"), answer


def half_open(port, count):
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1] - 100
    count = min(count, most)
    ends = []
    while len(ends) < count:
        ends.append(socket.create_connection(("127.0.0.1", port), PATIENCE_S))
        if len(ends) % 500 == 0:  # Whoever waits for this program can see that it goes on.
            print(".", flush=True)
    health(port)
    closed = sum(end.fileno() < 0 or is_closed(end) for end in ends)
    print(f"{count} connections, {closed} closed, others served")


def is_closed(end):
    end.setblocking(False)
    try:
        return end.recv(1) == b""
    except BlockingIOError:
        return False
    except ConnectionResetError:
        return True


def body(port, size):
    with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as one:
        one.sendall(f"POST /rpc HTTP/1.1\r\nHost: localhost:{port}\r\nContent-Type: application/json\r\n"
                    f"Content-Length: {size}\r\n\r\n".encode())
        answer = one.recv(4096)
    print(answer.split(b"\r\n")[0].decode())
    health(port)


async def silent(port):
    one = await WebSocket.open(port)
    greeting = await one.message()
    print(greeting["method"])
    other = await WebSocket.open(port)
    await other.message()
    print(len((await other.call("axis.list"))["axes"]), "axes")


async def revoked(port, token, other, name):
    holder, boss = await WebSocket.open(port, token=token), await WebSocket.open(port, token=other)
    await holder.message()
    await boss.message()
    await holder.call("lease.acquire", axes=["x"], ttl_ms=60000)
    held = (await boss.call("lease.list"))["leases"]
    print("holder:", held[0]["holder"].split(" from ")[0])
    await boss.call("token.revoke", name=name)
    opcode, data = await holder.frame()
    while opcode == 1:
        opcode, data = await holder.frame()
    print("closed:", struct.unpack(">H", data[:2])[0], data[2:].decode())
    print("leases:", len((await boss.call("lease.list"))["leases"]))
    try:
        await WebSocket.open(port, token=token)
    except RuntimeError as refused:
        print("again:", refused)


async def crowd(port, count, context):
    begin = time.monotonic()
    clients = []
    for first in range(0, count, 50):
        print(".", flush=True)
        clients += await asyncio.gather(*(WebSocket.open(port, context) for _ in range(first, min(first + 50, count))))
    for one in clients:
        await one.message()
    connected = time.monotonic() - begin

    done = 0

    async def use(one):
        nonlocal done
        await one.call("subscribe", axes=["y"], interval_ms=1000)
        for _ in range(3):
            await one.call("axis.list")
        done += 1
        if done % 20 == 0:
            print(".", flush=True)

    begin = time.monotonic()
    await asyncio.gather(*(use(one) for one in clients))
    asked = time.monotonic() - begin
    times = []
    for i in range(100):
        begin = time.monotonic()
        await clients[i * 7 % count].call("axis.stop", axis="y")
        times.append((time.monotonic() - begin) * 1000)
    print(f"{count} connected in {connected:.1f} s, {count * 4} answers in {asked:.1f} s, "
          f"stop p50 {sorted(times)[49]:.1f} ms, p99 {sorted(times)[98]:.1f} ms", flush=True)
    sys.stdin.read()  # until the memory of the daemon was looked at


def main():
    what, port, *rest = sys.argv[1:]
    port = int(port)
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    if what == "half-open":
        half_open(port, int(rest[0]))
    elif what == "body":
        body(port, int(rest[0]))
    elif what == "silent":
        asyncio.run(asyncio.wait_for(silent(port), PATIENCE_S))
    elif what == "revoked":
        asyncio.run(asyncio.wait_for(revoked(port, *rest), PATIENCE_S))
    elif what == "crowd":
        asyncio.run(crowd(port, int(rest[0]), ssl.create_default_context(cafile=rest[1]) if rest[1:] else None))


main()
