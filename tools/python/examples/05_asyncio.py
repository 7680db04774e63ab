#!/usr/bin/env python3
"""The same with asyncio: one task watches while another moves:

    05_asyncio.py [SOCKET]
"""

import asyncio
import sys

import tmcl.aio


async def show(gateway: tmcl.aio.Gateway) -> None:
    async for state in gateway.watch("x", interval=0.1):
        print(f"x is at {state.position:.3f} mm")


async def main() -> None:
    async with await tmcl.aio.connect(*sys.argv[1:]) as gateway:
        watching = asyncio.create_task(show(gateway))
        async with gateway.lease("x"):
            for position in (3, 0):
                await gateway.x.move(position)
                await gateway.x.wait()
        watching.cancel()


asyncio.run(main())
