"""Payloads of Sparkplug B, read and written without the program that is tested."""
import struct

TYPES = {4: "Int64", 10: "Double", 11: "Boolean", 12: "String"}


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value, at


def fields(data):
    at = 0
    while at < len(data):
        key, at = varint(data, at)
        kind = key & 7
        if kind == 0:
            value, at = varint(data, at)
        elif kind == 1:
            value, at = struct.unpack_from("<d", data, at)[0], at + 8
        else:
            assert kind == 2, f"a field of kind {kind}"
            length, at = varint(data, at)
            value, at = data[at:at + length], at + length
        yield key >> 3, value


def metric(data):
    name, value, unit = None, None, None
    for number, one in fields(data):
        if number == 1:
            name = one.decode()
        elif number == 9:
            keys, values = [], []
            for of_set, part in fields(one):
                (keys if of_set == 1 else values).append(part)
            unit = dict(fields(values[keys.index(b"engUnit")]))[8].decode()
        elif number in (11, 13, 14, 15):
            value = {11: int, 13: float, 14: bool, 15: lambda text: text.decode()}[number](one)
    return name, value, unit


def read(data):
    """seq (None of a death), values by name, units by name."""
    seq, values, units = None, {}, {}
    for number, one in fields(data):
        if number == 3:
            seq = one
        elif number == 2:
            name, value, unit = metric(one)
            values[name] = value
            units[name] = unit
    return seq, values, units


def rebirth():
    name = b"Node Control/Rebirth"
    one = b"\x0a" + bytes([len(name)]) + name + b"\x20\x0b\x70\x01"
    return b"\x08\x01\x12" + bytes([len(one)]) + one
