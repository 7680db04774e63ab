"""Handshake and frames of a WebSocket, without a socket."""

import base64
import hashlib
import unittest

from tmcl.errors import ConnectionLost, NotConnected, ProtocolError
from tmcl.lines import MOST_BYTES
from tmcl.websocket import MOST_HEADER_BYTES, WebSocket

GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"


def counted(size):
    return bytes(range(size))


def accepting(key):
    digest = base64.b64encode(hashlib.sha1((key + GUID).encode()).digest()).decode()
    return (
        "HTTP/1.1 101 Switching Protocols\r\nupgrade: WebSocket\r\nConnection: keep-alive, Upgrade"
        f"\r\nSec-WebSocket-Accept: {digest}\r\n\r\n"
    ).encode()


class WebSocketTest(unittest.TestCase):
    def setUp(self):
        self.socket = WebSocket("gateway:4143", "/ws", "secret", counted)
        self.key = base64.b64encode(counted(16)).decode()

    def receive(self, data):
        return list(self.socket.receive(data))

    def open(self):
        self.receive(accepting(self.key))
        self.assertTrue(self.socket.opened)

    def test_asks_with_its_token(self):
        opening = self.socket.opening().decode()
        self.assertTrue(opening.startswith("GET /ws HTTP/1.1\r\nHost: gateway:4143\r\n"))
        self.assertIn("\r\nAuthorization: Bearer secret\r\n", opening)
        self.assertIn(f"\r\nSec-WebSocket-Key: {self.key}\r\n", opening)
        self.assertTrue(opening.endswith("\r\n\r\n"))

    def test_opens_in_any_pieces(self):
        for byte in accepting(self.key) + b"\x81\x02hi":
            messages = self.receive(bytes([byte]))
        self.assertEqual(messages, [b"hi"])

    def test_a_refusal_names_status_and_what_to_try(self):
        with self.assertRaises(NotConnected) as raised:
            self.receive(b"HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n")
        self.assertEqual(raised.exception.name, "http_401")
        self.assertEqual(raised.exception.outcome, "not_sent")
        self.assertIn("Unauthorized", str(raised.exception))

    def test_a_refusal_says_what_the_gateway_says(self):
        body = b'{"error":{"message":"no such token","data":{"name":"unknown_token","hint":"h"}}}'
        head = b"HTTP/1.1 401 Unauthorized\r\ncontent-length: %d\r\n\r\n" % len(body)
        self.assertEqual(self.receive(head), [])
        self.assertEqual(self.socket.missing, len(body))
        with self.assertRaises(NotConnected) as raised:
            self.receive(body)
        refusal = raised.exception
        self.assertEqual((refusal.message, refusal.name, refusal.hint, refusal.data["status"]),
                         ("no such token", "unknown_token", "h", 401))

    def test_a_refusal_that_says_nothing_in_json_is_one_too(self):
        for body in (b"<html>", b"[]", b'{"error":1}', b"\xff"):
            with self.subTest(body=body), self.assertRaises(NotConnected) as raised:
                self.setUp()
                self.receive(b"HTTP/1.1 500 Oops\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
            self.assertEqual(raised.exception.name, "http_500")

    def test_refuses_what_is_no_handshake(self):
        for answer in (
            b"SSH-2.0-OpenSSH\r\n\r\n",
            b"HTTP/1.1 101\r\n\r\n",
            accepting("another key"),
            b"x" * (MOST_HEADER_BYTES + 1),
        ):
            with self.subTest(answer=answer[:20]), self.assertRaises(ProtocolError):
                list(WebSocket("h", "/ws", None, counted).receive(answer))

    def test_masks_what_it_sends(self):
        for size, head in ((5, b"\x81\x85"), (126, b"\x81\xfe\x00\x7e"),
                           (65_536, b"\x81\xff" + (65_536).to_bytes(8, "big"))):
            payload = bytes(index % 251 for index in range(size))
            frame = self.socket.frame(payload)
            self.assertTrue(frame.startswith(head))
            mask, body = counted(4), frame[len(head) + 4:]
            self.assertEqual(bytes(b ^ mask[i % 4] for i, b in enumerate(body)), payload)

    def test_puts_parts_together_and_answers_pings_between_them(self):
        self.open()
        parts = b"\x01\x02ab" + b"\x89\x01p" + b"\x00\x01c" + b"\x80\x01d"
        self.assertEqual(self.receive(parts), [b"abcd"])
        self.assertEqual(self.socket.to_send()[:2], b"\x8a\x81")
        self.assertEqual(self.socket.to_send(), b"")

    def test_takes_long_messages_up_to_a_bound(self):
        self.open()
        long = b"x" * 70_000
        self.assertEqual(self.receive(b"\x81\x7f" + len(long).to_bytes(8, "big") + long), [long])
        with self.assertRaisesRegex(ProtocolError, "longer than"):
            self.receive(b"\x81\x7f" + (MOST_BYTES + 1).to_bytes(8, "big"))

    def test_parts_together_have_the_same_bound(self):
        self.open()
        half = MOST_BYTES // 2 + 1
        head = b"\x7f" + half.to_bytes(8, "big")
        self.assertEqual(self.receive(b"\x01" + head + b"x" * half), [])
        with self.assertRaisesRegex(ProtocolError, "longer than"):
            self.receive(b"\x00" + head)

    def test_refuses_frames_that_no_server_may_send(self):
        for frame in (b"\x81\x81aaaab", b"\xc1\x00", b"\x82\x00", b"\x83\x00", b"\x09\x00",
                      b"\x89\x7e\x00\x80", b"\x80\x00", b"\x01\x00\x81\x00"):
            with self.subTest(frame=frame), self.assertRaises(ProtocolError):
                self.setUp()
                self.open()
                self.receive(frame)

    def test_gives_the_messages_before_a_close_and_answers_it(self):
        self.open()
        messages = []
        with self.assertRaisesRegex(ConnectionLost, "1008: revoked"):
            for message in self.socket.receive(b"\x81\x01a" + b"\x88\x09\x03\xf0revoked"):
                messages.append(message)
        self.assertEqual(messages, [b"a"])
        self.assertEqual(self.socket.to_send()[:2], b"\x88\x82")


if __name__ == "__main__":
    unittest.main()
