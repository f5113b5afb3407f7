// A mock station: HTTP and WebSocket with a fictitious plant, for development and tests of the page
// alone.
//
//   node mock_station.mjs --files FOLDER --modules NODE_MODULES [--port 8090] [--channels 10000]
//     [--login] [--role ROLE] [--quiet]
//
// FOLDER: the built page (build/station-page/files). --login: users anna (operator), erik and erna (engineers)
// and vera (viewer), password `secret secret`. --role: the role of everybody without a login.

import { createServer } from 'node:http';
import { randomBytes } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { mockDashboards } from './mock_dashboards.mjs';
import { mockReports } from './mock_reports.mjs';
import { MockConfiguration } from './mock_configuration.mjs';

const contentTypes = {
  html: 'text/html; charset=utf-8', js: 'text/javascript; charset=utf-8', css: 'text/css; charset=utf-8', svg: 'image/svg+xml', manifest: 'application/manifest+json',
};
// Name of the page's file with this address.
const fileOf = (path) => (path === '/' || path === '/embed' ? 'index.html' : /^\/[\w.-]+$/.test(path) ? path.slice(1) : '');
const contentSecurity = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; " +
  "font-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; " +
  "require-trusted-types-for 'script'; trusted-types lit-html";
const users = { anna: 'operator', erik: 'engineer', erna: 'engineer', vera: 'viewer' };
const password = 'secret secret';
const namedBuses = ['boiler-house', 'press-shop', 'utilities', 'water-works'];

export class InventedPlant {
  // `buses`: their number; otherwise the four with names. `site`: of all buses, "north:".
  constructor(channels, buses = 0, site = '') {
    const busNames = buses ? Array.from({ length: buses }, (_, n) => `line-${String(n + 1).padStart(2, '0')}`) : namedBuses.map((name) => site + name);
    const now = Date.now();
    this.channels = [];
    this.alarms = [];
    this.sequence = 0;
    const kinds = [
      { name: 'temperature', type: 'int16', unit: '°C', limits: { high: 80, 'high-high': 95 } },
      { name: 'pressure', type: 'float32', unit: 'bar', limits: { low: 2, high: 8 } },
      { name: 'running', type: 'bool', unit: '', access: 'read-write', limits: {} },
      { name: 'speed-setpoint', type: 'uint16', unit: '1/min', access: 'read-write', limits: { 'write-min': 0, 'write-max': 3000 } },
      { name: 'energy', type: 'uint64', unit: 'Wh', limits: {} },
      { name: 'program', type: 'string(8)', unit: '', limits: {} },
      { name: 'level', type: 'float32', unit: '%', limits: { 'low-low': 5, low: 10 } },
      { name: 'flow', type: 'float64', unit: 'm³/h', limits: {} },
    ];
    for (let id = 0; id < channels; id++) {
      const kind = kinds[id % kinds.length], device = Math.floor(id / 40), bus = busNames[device % busNames.length];
      this.channels.push({
        id: id + 1, kind, path: `${bus}/device-${String(Math.floor(device / busNames.length) + 1).padStart(2, '0')}/${kind.name}-${Math.floor((id % 40) / kinds.length) + 1}`,
        refresh_ms: id % 5 === 0 ? 500 : 1000, value: kind.type === 'bool' ? 1 : 40 + (id % 17), text: kind.type.startsWith('string') ? 'STEP-1' : kind.type === 'uint64' ? String(9007199254740993n + BigInt(id)) : null,
        acquired_ms: now, quality: id % 97 === 0 ? 2 : id % 331 === 0 ? 7 : 0,
      });
    }
    this.byPath = new Map(this.channels.map((channel) => [channel.path, channel]));
    this.buses = busNames.map((bus, index) => ({
      bus, bridge: index < 2 ? 'north' : 'south', state: index === 3 && channels > 100 ? 'closed' : 'running', utilisation: 0.4 + (index % 5) * 0.1, planned_load: 0.45 + 0.1 * (index % 5),
      measured_load: 0.42 + 0.1 * (index % 5), stretch: index === 2 ? 1.18 : 1, exchanges: 1000, samples: 10_000, commands: 3, deadline_misses: 12 * index,
      bytes_sent: 120_000, bytes_received: 480_000, reopened: index === 3 ? 4 : 0, dds_deadline_misses: 0,
      causes: index ? { NO_ANSWER: 12 * index, CHECKSUM: 3 } : {}, misses: index ? { 'no-answer': 9 * index, overload: 3 * index } : {}, reported_ms: now,
      ...(index === 3 && channels > 100 ? { closed_because: 'PORT_GONE' } : {}),
    }));
    this.devices = [];
    for (const bus of busNames)
      for (let n = 1; n <= 3; n++)
        this.devices.push({
          bus, device: `device-0${n}`, state: n === 3 ? 'degraded' : 'online', exchanges: 5000, failures: 12 * n, retries: 3, deadline_misses: 1, answer_time_ms: 4.2 * n,
          answer_spread_ms: 0.8, timeout_ms: 100, pause_ms: 2, areas: [{ area: 'holding', answer_time_ms: 4.2, answer_spread_ms: 0.8, largest_block: 60, longest_block: 0 }],
          refused: n === 3 ? ['holding:107', 'holding:109'] : [], refused_gaps: n === 3 ? ['holding:105..107'] : [], causes: { NO_ANSWER: 12 * n }, reported_ms: now });
    this.descriptions = this.devices.map(({ bus, device }, index) => ({
      bus, device, bridge: 'north', protocol: 'modbus-rtu', port: '/dev/ttyUSB0 115200 8N1', address: String(index % 3 + 1), digits: { 'flow-1': 0 }, resolution: { 'pressure-2': 1 } }));
    this.interests = [{ station: 'wall-panel', pattern: `${busNames[0]}/device-01/*`, refresh_ms: 500 }];
    const alarm = (index, more) => {
      const channel = this.channels[index % this.channels.length];
      const [bus, device, name] = channel.path.split('/');
      this.alarms.push({ bus, device, channel: name, limit: 'high', priority: 'high', state: 'unacknowledged', active: true, value: 83.2, since_ms: now - 65_000, raised_ns: '1764360000123456789', occurrences: 1,
        chattering: false, acknowledged_by: '', acknowledged_ms: null, note: '', shelved_until_ms: null, shelved_by: '', suppressed: '', ...more });
    };
    alarm(0, { limit: 'high-high', priority: 'critical' });
    alarm(8, { state: 'acknowledged', acknowledged_by: 'anna', acknowledged_ms: now - 30_000, note: 'called the electrician' });
    alarm(1, { limit: 'low', priority: 'medium', state: 'returned', active: false, occurrences: 7, chattering: true });
    alarm(9, { priority: 'low', shelved_until_ms: now + 3_600_000, shelved_by: 'anna', note: 'sensor is changed on Monday' });
    alarm(6, { limit: 'low-low', priority: 'high', suppressed: 'maintenance' });
    this.sessions = [{ bus: busNames[1], device: 'device-01', state: 'open', who: 'otto@10.0.0.7', bytes_to_device: 48_211, bytes_from_device: 190_332, since_ms: now - 480_000, last_request: 'RD read DM, first 0100, count 0010', last_request_ms: now - 2_000 }];
    this.bridges = ['north', 'south'].map((bridge, index) => ({
      bridge, host: `plc-${bridge}`, process: `${bridge}-1`, version: '0.1.0', standby_group: '', strength: 0, since_ms: now - 86_400_000,
      buses: busNames.slice(2 * index, 2 * index + 2).map((bus) => ({ bus, since_ms: now - 86_400_000, serving: true })) }));
    this.audit = [
      { at_ms: now - 480_000, who: 'otto (10.0.0.7:39464)', what: 'program', target: `${busNames[1]}/device-01`, bytes_to_device: 48_211, bytes_from_device: 190_332, result: 'done' },
      { at_ms: now - 500_000, who: 'anna from 10.0.0.5', what: 'write 7', target: `${busNames[1]}/device-01/speed-setpoint-1`, bytes_to_device: 0, bytes_from_device: 0, result: 'verified' },
      { at_ms: now - 600_000, who: 'mallory (10.0.0.66:5000)', what: 'login', target: '', bytes_to_device: 0, bytes_from_device: 0, result: 'refused: wrong password' }];
  }

  step(slice, slices) {
    const now = Date.now(), changed = [];
    for (let index = slice; index < this.channels.length; index += slices) {
      const channel = this.channels[index];
      if (channel.quality === 7 || channel.quality === 2 && Math.random() < 0.98) continue;
      channel.acquired_ms = now;
      if (channel.kind.type.startsWith('string')) channel.text = `STEP-${1 + (Math.floor(now / 5000) % 9)}`;
      else if (channel.kind.type === 'uint64') channel.text = String(BigInt(channel.text) + 1n);
      else if (channel.kind.type.startsWith('float')) channel.value = 50 + 40 * Math.sin(now / 20_000 + index);
      else if (channel.kind.type === 'int16') channel.value = Math.round(10 * (55 + 20 * Math.sin(now / 30_000 + index))) / 10;
      changed.push(channel);
    }
    return changed;
  }

  alarmEvents() {
    const events = [];
    for (const { bus, device, channel, limit, value, since_ms, active, acknowledged_ms, acknowledged_by, note, shelved_until_ms, shelved_by } of this.alarms) {
      const add = (at_ms, event, more = {}) => events.push({ at_ms, bus, device, channel, limit, event, value: null, who: '', note: '', until_ms: null, ...more });
      add(since_ms, 'raised', { value });
      if (!active) add(since_ms + 20_000, 'cleared', { value });
      if (acknowledged_ms) add(acknowledged_ms, 'acknowledged', { who: acknowledged_by, note });
      if (shelved_until_ms) add(since_ms + 30_000, 'shelved', { who: shelved_by, note, until_ms: shelved_until_ms });
    }
    return events.sort((a, b) => a.at_ms - b.at_ms);
  }

  catalogue() {
    return { version: 1, full: true, gone: [], channels: this.channels.map((c) =>
      [c.id, c.path, c.kind.type, c.kind.unit, `holding:${c.id % 1000}`, c.kind.access ?? 'read-only', 'scheduled', c.refresh_ms, c.kind.limits, '', 'north']) };
  }
}

export function encodeFrame(channels) {
  const n = channels.length, bytes = new ArrayBuffer(16 + 17 * n), head = new DataView(bytes);
  const base = channels.reduce((newest, channel) => Math.max(newest, channel.acquired_ms), 0);
  head.setUint8(0, 1);
  head.setUint32(4, n, true);
  head.setFloat64(8, base, true);
  const value = new Float64Array(bytes, 16, n), id = new Uint32Array(bytes, 16 + 8 * n, n), age = new Uint32Array(bytes, 16 + 12 * n, n);
  const quality = new Uint8Array(bytes, 16 + 16 * n, n);
  channels.forEach((channel, row) => {
    value[row] = channel.text === null ? channel.value : NaN;
    id[row] = channel.id;
    age[row] = channel.quality === 7 ? 0xffffffff : base - channel.acquired_ms;
    quality[row] = channel.quality;
  });
  return bytes;
}

// `empty`: the paths of channels without a stored sample. `badFrom`: when the fault of a path began.
function history(url, { empty = new Set(), badFrom = new Map(), late = [] }) {
  const from = Number(url.searchParams.get('from')), to = Number(url.searchParams.get('to')), points = Number(url.searchParams.get('points')) || 1000;
  const bucket_ms = Math.max(1000, Math.ceil((to - from) / points / 1000) * 1000);
  const series = url.searchParams.getAll('channel').map((channel, index) => {
    const each = { channel, unit: index % 2 ? 'bar' : '°C', type: 'float32', tier: bucket_ms >= 60_000 ? 'minute' : 'raw', bucket_ms, t: [], min: [], max: [], average: [], last: [], count: [], bad: [], late };
    for (let t = Math.ceil(from / bucket_ms) * bucket_ms; t < to && !empty.has(channel); t += bucket_ms) {
      const gap = badFrom.has(channel) ? t >= badFrom.get(channel) : Math.floor(t / bucket_ms) % 211 > 204;
      const value = 50 + 40 * Math.sin(t / 20_000 / (1 + bucket_ms / 30_000) + index);
      each.t.push(t);
      each.average.push(gap ? null : value);
      each.last.push(gap ? null : value);
      each.min.push(gap ? null : value - 4);
      each.max.push(gap ? null : value + 5);
      each.count.push(gap ? 0 : 5);
      each.bad.push(gap ? 5 : 0);
    }
    return each;
  });
  return { from_ms: from, to_ms: to, series };
}

// Eight slots: fast points in every slot, slow ones in turn; and a group read when due.
function planOf(bus, load = 0.46) {
  const slot_ms = 94, slots = 8;
  const point = (area, first, count, names, every, phase_ms) => ({
    area, first, count, channels: names, period_ms: every * slot_ms, phase_ms, worst_gap_ms: every * slot_ms + 3, stretch: 1 });
  const groups = [1, 2, 3].flatMap((n) => {
    const device = `device-0${n}`, base = 9 * n;
    return [
      { device, list: false, period_ms: slot_ms, phase_ms: base + 8, slack_ms: 1.5, load: load / 5, points: [
        point('holding', 100, 8, ['temperature-1', 'temperature-2'], 1, base + 8), point('holding', 110, 4, ['pressure-1'], 4, base + 8 + slot_ms), point('holding', 116, 2, ['flow-1'], 8, base + 8 + 3 * slot_ms)] },
      { device, list: n === 2, period_ms: n * 2 * slot_ms, phase_ms: 60 + 4 * n + (n - 1) * slot_ms, slack_ms: 4, load: load / 20, points: [
        point('coil', 0, 8, ['running-1', 'running-2', 'running-3'], n * 2, 60 + 4 * n + (n - 1) * slot_ms)] }].filter((group) => (slots * slot_ms) % group.period_ms === 0);
  });
  groups.push({ device: 'device-03', list: false, period_ms: null, phase_ms: null, slack_ms: null, load: 0.01, points: [
    { ...point('input', 0, 4, ['energy-1'], 1, 0), period_ms: null, phase_ms: null, worst_gap_ms: null }] });
  return { bus, in_force_since_ms: Date.now() - 3_600_000, load, stretch: 1, slot_ms, hyperperiod_ms: slots * slot_ms, groups };
}

// Returns {port, plant, close(), dropClients(), changePlan(bus, load), refuse}. While `refuse` is
// true, new sockets are rejected.
export async function startMock({ files, modules, port = 0, channels = 10_000, login = false, slices = 20, buses = 0, site = '', role = 'operator' }) {
  const { WebSocketServer } = createRequire(join(resolve(modules), 'x'))('ws');
  const plant = new InventedPlant(channels, buses, site);
  const logins = new Map();  // cookie: user
  const cached = new Map();
  const catalogue = gzipSync(JSON.stringify(plant.catalogue()));
  const clients = new Set();
  const mock = { plant, configuration: new MockConfiguration(), planLoad: 0.46, refuse: false, silent: false, writes: [] };
  const dashboards = mock.dashboards = mockDashboards(), reports = mock.reports = mockReports(plant);
  let nextRequest = 100;

  const caller = (request) => {
    if (!login) return { user: 'local', role };
    const cookie = /fieldcast=(\w+)/.exec(request.headers.cookie ?? '')?.[1];
    return logins.get(cookie);
  };
  const mayOperate = ({ role: of }) => of === 'operator' || of === 'engineer';
  const tell = (message) => { for (const client of clients) client.send(JSON.stringify(message)); };
  const tellResult = (request_id, more = {}) => setTimeout(() => tell({ kind: 'result', request_id, state: 'done', cause: 'NONE', reason: '', value: null, completed_ms: Date.now(), ...more }), 30);
  const findAlarm = (key) => plant.alarms.find((each) => ['bus', 'device', 'channel', 'limit'].every((name) => each[name] === key[name]));
  const changeAlarms = (keys, change) => {
    const request_id = nextRequest++;
    const failed = keys.some(({ raised_ns, ...key }) => raised_ns && findAlarm(key).raised_ns !== raised_ns) ?
      { state: 'rejected', cause: 'WRONG_STATE', reason: 'the alarm was raised again since then' } : mock.failActions;
    if (failed) {
      tellResult(request_id, failed);
      return [202, { request_id, request_ids: [request_id] }];
    }
    for (const alarm of keys.map(findAlarm).filter(Boolean)) {
      Object.assign(alarm, change(alarm));
      tell({ kind: 'alarm', ...alarm });
    }
    tellResult(request_id);
    return [202, { request_id, request_ids: [request_id] }];
  };
  const audit = (who, what, target, result = 'done') => plant.audit.unshift({ at_ms: Date.now(), who, what, target, bytes_to_device: 0, bytes_from_device: 0, result });

  const endSession = ({ user }, { bus, device, note }) => {
    const request_id = nextRequest++;
    const session = plant.sessions.find((each) => each.bus === bus && each.device === device);
    session.state = 'closed';
    audit(user, `end programming session: ${note}`, `${bus}/${device}`);
    tell({ kind: 'session', ...session });
    tellResult(request_id);
    return [202, { request_id, request_ids: [request_id] }];
  };

  function write(user, { channel, value }, answer) {
    const found = plant.byPath.get(channel);
    if (!found) return answer({ kind: 'refused', error: `no channel ${channel}`, hint: '' });
    const request_id = nextRequest++;
    mock.writes.push({ user, channel, value });
    audit(user, 'write', `${channel} = ${value}`);
    setTimeout(() => {
      found.value = Number(value === true || value === 'true' ? 1 : value === false || value === 'false' ? 0 : value);
      found.acquired_ms = Date.now();
      answer({ kind: 'result', request_id, state: 'verified', cause: 'NONE', reason: '', value: found.value, completed_ms: Date.now() });
      for (const client of clients) client.send(encodeFrame([found]));
    }, 40);
  }

  const get = {
    '/api/catalogue': () => catalogue,
    '/api/buses': () => [200, plant.buses], '/api/devices': () => [200, plant.devices],
    '/api/sessions': () => [200, plant.sessions], '/api/bridges': () => [200, plant.bridges],
    '/api/alarms': (url) => [200, url.searchParams.has('from') ? { events: plant.alarmEvents() } : { alarms: plant.alarms }],
    '/api/history': (url) => [200, history(url, mock)],
    '/api/export': (url) => ({ csv: `published_at,channel\n${url.searchParams.getAll('channel').join('\n')}\n`, name: `${url.searchParams.getAll('channel').join('+').replaceAll('/', '_')}.csv` }),
    '/api/notifications': () => [200, plant.messages ?? { waiting: 0, sent: 0, failed: 0, lost: 0, targets: [], rules: [], messages: [] }],
    '/api/audit': () => [200, { entries: plant.audit }],
    '/api/users': () => [200, { users: Object.entries(users).map(([user, role]) => ({ user, role, created_ms: Date.now() - 8.64e7 })) }],
    '/api/document': (url) => ({ csv: `# ${url.searchParams.get('name')}\n`, type: 'text/plain' }),
    ...dashboards.get, ...reports.get,
    '/api/plan': (url) => (plant.buses.some(({ bus }) => bus === url.searchParams.get('bus')) ? [200, planOf(url.searchParams.get('bus'), mock.planLoad)] :
      [404, { error: 'no bridge publishes a plan of this bus', hint: '' }]),
  };
  const post = {
    '/api/alarms/acknowledge': ({ user }, { alarms, note }) => changeAlarms(alarms, (alarm) => ({ state: alarm.active ? 'acknowledged' : 'clear', acknowledged_by: user, acknowledged_ms: Date.now(), note })),
    '/api/notifications/test': (_, { target }) => {
      plant.messages.messages.unshift({ id: 't', target, recipient: 'ann@plant.example', subject: 'TEST: message', state: 'sent', made_ms: Date.now(), done_ms: Date.now(), attempts: 1, error: '' });
      return [200, {}];
    },
    '/api/alarms/shelve': ({ user }, { alarms, minutes, note }) => changeAlarms(alarms, () => ({ shelved_until_ms: Date.now() + minutes * 60_000, shelved_by: user, note })),
    '/api/alarms/unshelve': (_, { alarms }) => changeAlarms(alarms, () => ({ shelved_until_ms: null, shelved_by: '' })),
    '/api/alarms/maintenance': (_, { bus, device, minutes }) => changeAlarms(plant.alarms.filter((alarm) => alarm.bus === bus && alarm.device === device), () => ({ suppressed: minutes ? 'maintenance' : '' })),
    '/api/sessions/end': endSession, ...reports.post,
    '/api/commands': ({ user }, body) => { write(user, body, (message) => tell(message)); return [202, { request_id: nextRequest - 1 }]; },
  };

  const server = createServer(async (request, response) => {
    const url = new URL(request.url, 'http://x');
    const headers = { 'content-security-policy': contentSecurity, 'x-content-type-options': 'nosniff', 'cache-control': 'no-store' };
    const json = (status, body, more = {}) => {
      response.writeHead(status, { ...headers, 'content-type': 'application/json', ...more });
      response.end(status === 204 ? undefined : JSON.stringify(body));
    };
    const file = fileOf(url.pathname);
    if (file && existsSync(join(files, file))) {
      if (!cached.has(url.pathname)) cached.set(url.pathname, gzipSync(readFileSync(join(files, file))));
      response.writeHead(200, { ...headers, 'content-type': contentTypes[file.split('.').pop()], 'content-encoding': 'gzip' });
      return response.end(cached.get(url.pathname));
    }
    let text = '';
    for await (const part of request) text += part;
    const body = text ? JSON.parse(text) : {};
    const me = caller(request);
    if (url.pathname === '/api/login') {
      const role = body.token ? (body.token === 'wall-token' ? 'viewer' : undefined) : body.password === password ? users[body.user] : undefined;
      if (!role) return json(401, { error: 'user or password is wrong', hint: '' });
      const cookie = randomBytes(16).toString('hex');
      logins.set(cookie, { user: body.user ?? 'wall', role });
      audit(body.user ?? 'wall', 'login', '');
      return json(200, { user: body.user, role, expires_ms: Date.now() + 3.6e6 }, { 'set-cookie': `fieldcast=${cookie}; HttpOnly; SameSite=Strict; Path=/` });
    }
    if (url.pathname === '/api/me')
      return json(200, { user: me?.user ?? '', role: me?.role ?? null, login: !login ? 'none' : me ? 'session' : 'required', expires_ms: null, version: '0.1.0', store: true, now_ms: Date.now() });
    if (!me) return json(401, { error: 'a login is needed', hint: '' });
    if (url.pathname === '/api/logout') {
      logins.delete(/fieldcast=(\w+)/.exec(request.headers.cookie ?? '')?.[1]);
      return json(204);
    }
    if (request.method === 'POST' && post[url.pathname]) return mayOperate(me) ? json(...post[url.pathname](me, body)) : json(403, { error: 'the role operator is needed', hint: '' });
    if (request.method === 'POST' && dashboards.post[url.pathname])
      return me.role === 'engineer' ? json(...dashboards.post[url.pathname](me, body)) : json(403, { error: 'not allowed', hint: 'your role may not do this' });
    if (url.pathname.startsWith('/api/configuration')) {
      if (me.role !== 'engineer') return json(403, { error: 'the role engineer is needed', hint: '' });
      const answer = request.method === 'GET' ? mock.configuration.get(url) : mock.configuration.post(url.pathname, body, me.user);
      return json(...(answer ?? [404, { error: 'no such resource', hint: '' }]));
    }
    const found = request.method === 'GET' && get[url.pathname]?.(url);
    if (!found) return json(404, { error: 'no such resource', hint: '' });
    if (Array.isArray(found)) return json(...found);
    if (found.csv) {
      response.writeHead(200, { ...headers, 'content-type': found.type ?? 'text/csv', ...(found.name ? { 'content-disposition': `attachment; filename="${found.name}"` } : {}) });
      return response.end(found.csv);
    }
    if (found.svg) {
      response.writeHead(200, { ...headers, 'content-security-policy': "default-src 'none'; sandbox", 'content-type': 'image/svg+xml' });
      return response.end(found.svg);
    }
    response.writeHead(200, { ...headers, 'content-type': 'application/json', 'content-encoding': 'gzip' });
    return response.end(found);
  });

  const sockets = new WebSocketServer({ noServer: true, handleProtocols: () => 'fieldcast.1', perMessageDeflate: false });
  server.on('upgrade', (request, socket, head) => {
    const me = caller(request);
    if (mock.refuse || !me) return socket.end('HTTP/1.1 401 Unauthorized\r\n\r\n');
    sockets.handleUpgrade(request, socket, head, (client) => {
      const send = (message) => client.send(JSON.stringify(message));
      send({ kind: 'hello', version: '0.1.0', user: me.user, role: me.role, now_ms: Date.now(), catalogue: 1 });
      client.on('close', () => clients.delete(client));
      client.on('message', (data) => {
        const message = JSON.parse(data);
        const answer = (reply) => send({ id: message.id, ...reply });
        if (message.ping !== undefined && !mock.silent) send({ kind: 'pong', id: message.ping, now_ms: Date.now() });
        else if (message.write && !mayOperate(me)) answer({ kind: 'refused', error: 'the role operator is needed', hint: 'Log in as an operator.' });
        else if (message.write) write(me.user, message.write, answer);
        else if (message.acquire) setTimeout(() => answer({ kind: 'result', request_id: nextRequest++, state: 'done', cause: 'NONE', reason: '', value: 1, completed_ms: Date.now() }), 20);
        else if (message.subscribe === '*') {
          clients.add(client);
          for (const [kind, list] of [['bus', plant.buses], ['device', plant.devices], ['alarm', plant.alarms], ['session', plant.sessions], ['bridge', plant.bridges], ['description', plant.descriptions], ['interest', plant.interests]])
            for (const each of list) send({ kind, ...each });
          client.send(encodeFrame(plant.channels));
          send(texts(plant.channels));
        }
      });
    });
  });
  const texts = (list) => {
    const rows = list.filter((channel) => channel.text !== null);
    return { kind: 'values', id: rows.map((c) => c.id), value: rows.map((c) => c.text), acquired_ms: rows.map((c) => c.acquired_ms), quality: rows.map((c) => c.quality) };
  };
  let turn = 0;
  const stepping = setInterval(() => {
    const changed = plant.step(turn++ % slices, slices);
    if (mock.silent || !changed.length) return;
    const frame = encodeFrame(changed.filter((channel) => channel.text === null)), text = JSON.stringify(texts(changed));
    for (const client of clients) {
      if (client.bufferedAmount > 1e6) continue;
      client.send(frame);
      client.send(text);
    }
  }, 1000 / slices);
  const reporting = setInterval(() => {
    if (mock.silent) return;
    for (const bus of plant.buses) {
      if (bus.state === 'closed') continue;
      bus.utilisation = Math.max(0, Math.min(1, bus.utilisation + (Math.random() - 0.5) * 0.04));
      bus.measured_load = bus.utilisation * 0.93;
      bus.exchanges += 52;
      bus.reported_ms = Date.now();
      tell({ kind: 'bus', ...bus });
    }
  }, 1000);
  await new Promise((done) => server.listen(port, '127.0.0.1', done));
  return Object.assign(mock, {
    port: server.address().port,
    tell,
    changePlan: (bus, load) => {
      mock.planLoad = load;
      tell({ kind: 'plan', bus });
    },
    dropClients: () => sockets.clients.forEach((client) => client.terminate()),
    close: () => {
      clearInterval(stepping);
      clearInterval(reporting);
      sockets.clients.forEach((client) => client.terminate());
      server.closeAllConnections();
      server.close();
    },
  });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const option = (name, otherwise) => {
    const at = process.argv.indexOf(`--${name}`);
    return at < 0 ? otherwise : process.argv[at + 1];
  };
  const mock = await startMock({
    files: option('files'), modules: option('modules'), port: Number(option('port', 8090)), channels: Number(option('channels', 10_000)),
    login: process.argv.includes('--login'), role: option('role', 'operator'), buses: Number(option('buses', 0)) });
  console.log(`http://127.0.0.1:${mock.port}/`);
}
