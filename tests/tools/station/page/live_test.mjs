// Tests the page's connection to the station with a socket and clocks of its own, without a browser.
//
//   node live_test.mjs PAGE_FOLDER NODE_MODULES

import assert from 'node:assert/strict';
import { resolve } from 'node:path';
import test from 'node:test';
import { loadModules } from './load_modules.mjs';
import { encodeFrame } from './mock_station.mjs';

const [folder, modules] = process.argv.slice(2).map((path) => resolve(path));

let wall_ms = 1_700_000_000_000, monotonic_ms = 0;
const timers = new Set();
const sockets = [];
const requests = [];

class Socket {
  static OPEN = 1;
  readyState = 0;
  sent = [];
  constructor() { sockets.push(this); }
  send(text) { this.sent.push(JSON.parse(text)); }
  close() { this.readyState = 3; }
  open() {
    this.readyState = 1;
    this.onopen();
  }
  say(message) { this.onmessage({ data: message instanceof ArrayBuffer ? message : JSON.stringify(message) }); }
}

const timer = (run, after_ms, every_ms) => {
  const made = { run, at_ms: monotonic_ms + after_ms, every_ms };
  timers.add(made);
  return made;
};
Object.assign(globalThis, {
  window: globalThis, location: { protocol: 'http:', host: 'station' }, WebSocket: Socket, addEventListener: () => {},
  setTimeout: (run, after_ms = 0) => timer(run, after_ms), clearTimeout: (made) => timers.delete(made), setInterval: (run, every_ms) => timer(run, every_ms, every_ms),
  fetch: (path) => new Promise((done) => requests.push({ path, respond: (body) => done(Response.json(body)) })),
});
Object.defineProperty(globalThis, 'performance', { value: { now: () => monotonic_ms }, configurable: true });
Date.now = () => wall_ms;
const { live, plant } = await loadModules(folder, modules, ['live', 'plant']);
document.addEventListener = () => {};

const settled = () => new Promise((done) => setImmediate(done));
async function pass(duration_ms, each = () => {}) {
  for (const end_ms = monotonic_ms + duration_ms; monotonic_ms < end_ms;) {
    monotonic_ms += 1000;
    wall_ms += 1000;
    each();
    for (const due of [...timers]) {
      if (due.at_ms > monotonic_ms) continue;
      due.every_ms ? due.at_ms += due.every_ms : timers.delete(due);
      due.run();
    }
    await settled();
  }
}

const hello = (catalogue) => ({ kind: 'hello', version: '1', user: 'anna', role: 'operator', now_ms: wall_ms, catalogue });
const catalogue = (version) => ({ version, full: true, channels: [[1, 'a/b/c', 'float32', '', '', 'read-only', 'on-demand', 0, {}, '', 'x']], gone: [] });
async function connect() {
  for (const list of [timers, requests, sockets]) list instanceof Set ? list.clear() : list.splice(0);
  const page = new live.Live(new plant.Plant());
  page.start();
  await join();
  assert.equal(page.state, 'open');
  return page;
}
async function join() {
  sockets.at(-1).open();
  sockets.at(-1).say(hello(1));
  requests.at(-1).respond(catalogue(1));
  await settled();
  await settled();
}
// Responds to all pings since the last call.
const answer = (socket) => socket.sent.splice(0).forEach((message) => { if (message.ping) socket.say({ kind: 'pong', id: message.ping, now_ms: wall_ms }); });

test('ages grow while no fresh value arrives', async () => {
  const page = await connect(), socket = sockets[0], acquired_ms = wall_ms;
  await pass(300_000, () => {
    answer(socket);
    socket.say(encodeFrame([{ id: 1, value: 5, text: null, acquired_ms, quality: 2 }]));
  });
  assert.equal(page.now() - acquired_ms, 300_000);
  await pass(300_000, () => {
    answer(socket);
    socket.say(encodeFrame([]));
  });
  assert.equal(page.now() - acquired_ms, 600_000);
});

test('a result of a former connection is not that of a later request', async () => {
  const page = await connect();
  sockets[0].say({ kind: 'result', request_id: 7, state: 'done' });
  sockets[0].onclose();
  await pass(1000);
  await join();
  let result;
  void page.resultOf(7).then((told) => { result = told; });
  await settled();
  assert.equal(result, undefined);
  sockets.at(-1).say({ kind: 'result', request_id: 7, state: 'rejected' });
  await settled();
  assert.equal(result.state, 'rejected');
});

test('an attempt to connect again that gets no response is given up', async () => {
  const page = await connect();
  sockets[0].onclose();
  await pass(1000);
  sockets[1].open();  // and the network is silent: the catalogue does not arrive
  await pass(12_000);
  assert.ok(sockets.length > 2);
  await join();
  assert.equal(page.state, 'open');
});

test('a catalogue that is older than the connection is fetched again', async () => {
  const page = new live.Live(new plant.Plant());
  page.start(Promise.resolve(catalogue(1)));
  sockets.at(-1).open();
  await settled();
  const asked = requests.length;
  sockets.at(-1).say(hello(2));
  assert.deepEqual(requests.slice(asked).map(({ path }) => path), ['/api/catalogue?after=1']);
  assert.equal(page.state, 'open');
});
