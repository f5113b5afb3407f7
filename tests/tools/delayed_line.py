"""A TCP line on 127.0.0.1 with a round trip and a bandwidth, between a client and a server."""

import asyncio
import threading


class DelayedLine:
    """Listens on `port` and connects to `server`. `rate`: bytes a second in each direction; 0: no limit. While the line is cut, connections are
    closed and refused."""

    BUFFER = 256 * 1024  # bytes on the way in one direction; beyond the product of delay and rate they wait

    def __init__(self, server, round_trip, rate=0):
        self.server, self.delay, self.rate = server, round_trip / 2, rate
        self.port, self.is_cut, self.writers = 0, False, set()
        self.loop = asyncio.new_event_loop()
        ready = threading.Event()
        self.thread = threading.Thread(target=self._run, args=(ready,), daemon=True)
        self.thread.start()
        ready.wait()

    def cut(self):
        self.loop.call_soon_threadsafe(self._set, True)

    def join(self):
        self.loop.call_soon_threadsafe(self._set, False)

    def close(self):
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join()

    def _set(self, is_cut):
        self.is_cut = is_cut
        for writer in self.writers if is_cut else ():
            writer.transport.abort()

    def _run(self, ready):
        asyncio.set_event_loop(self.loop)
        listener = self.loop.run_until_complete(asyncio.start_server(self._accept, "127.0.0.1", 0))
        self.port = listener.sockets[0].getsockname()[1]
        ready.set()
        self.loop.run_forever()
        self._set(True)
        listener.close()
        tasks = asyncio.all_tasks(self.loop)
        for task in tasks:
            task.cancel()
        self.loop.run_until_complete(asyncio.gather(*tasks, return_exceptions=True))
        self.loop.close()

    async def _accept(self, reader, writer):
        self.writers.add(writer)
        try:
            if self.is_cut:
                return
            to_reader, to_writer = await asyncio.open_connection("127.0.0.1", self.server)
            self.writers.add(to_writer)
            await asyncio.wait([asyncio.ensure_future(self._pump(reader, to_writer)), asyncio.ensure_future(self._pump(to_reader, writer))],
                               return_when=asyncio.FIRST_COMPLETED)
            to_writer.close()
            self.writers.discard(to_writer)
        except OSError:
            pass
        finally:
            writer.close()
            self.writers.discard(writer)

    async def _pump(self, reader, writer):
        space = asyncio.Semaphore(self.BUFFER // 4096)
        ways = asyncio.Queue()

        async def deliver():
            while True:
                due, data, parts = await ways.get()
                await asyncio.sleep(max(0.0, due - self.loop.time()))
                for _ in range(parts):
                    space.release()
                if not data:
                    return
                writer.write(data)
                await writer.drain()

        delivery, sent = asyncio.ensure_future(deliver()), 0.0
        try:
            while True:
                data = await reader.read(65536 if self.rate == 0 else 4096)
                parts = (len(data) + 4095) // 4096 if self.rate else 0
                for _ in range(parts):
                    await space.acquire()
                sent = max(sent, self.loop.time()) + (len(data) / self.rate if self.rate else 0)
                ways.put_nowait((sent + self.delay, data, parts))
                if not data:
                    break
            await delivery
        except (OSError, asyncio.CancelledError):
            delivery.cancel()
