// Tests the parts of the page without a browser.
//
//   node page_test.mjs PAGE_FOLDER NODE_MODULES

import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import test from 'node:test';
import { loadModules } from './load_modules.mjs';
import { encodeFrame } from './mock_station.mjs';

const [folder, modules] = process.argv.slice(2).map((path) => resolve(path));
const source = join(folder, 'src');
const { frame, plant, router, rows, recent_values, format, i18n, trend, ticks, typed, clock, alarm_rows, bus_advice, bus_order, channel_fault, csv, plan_picture, device_health, port_command, printable, browser_notices, pages, common, causes, server, server_text, texts: configurationTexts } =
  await loadModules(folder, modules, ['frame', 'plant', 'router', 'rows', 'recent_values', 'format', 'i18n', 'trend', 'ticks', 'typed', 'clock', 'alarm_rows', 'bus_advice', 'bus_order', 'channel_fault', 'csv', 'plan_picture',
    'device_health', 'port_command', 'printable', 'browser_notices', 'pages', 'texts/common', 'texts/causes', 'texts/server', 'server_text', 'configuration/texts']);

const row = (id, path, more = {}) => [id, path, more.type ?? 'float32', more.unit ?? '', 'holding:0', 'read-only', 'scheduled', 500, {}, more.description ?? '', 'north'];
const sample = (id, value, more = {}) => ({ id, value, text: null, acquired_ms: Date.now() - 40, quality: 0, ...more });
const makePlant = (...channels) => {
  const made = new plant.Plant();
  made.applyCatalogue({ version: 1, full: true, channels: channels.map((path, index) => row(index + 1, path)), gone: [] });
  return made;
};

test('the rate of a programming session is that of its last two reports', () => {
  const made = new plant.Plant();
  const report = (more) => ({ bus: 'one', device: 'plc', state: 'open', who: 'anna', bytes_to_device: 0, bytes_from_device: 0, since_ms: 1000, last_request: '', last_request_ms: null, ...more });
  const rate = (at) => made.rates.of('one/plc', at);
  made.setSession(report(), 0);
  assert.equal(rate(0), 0);
  made.setSession(report({ bytes_to_device: 100, bytes_from_device: 300 }), 2000);
  assert.equal(rate(2000), 200);
  made.setSession(report({ bytes_to_device: 100, bytes_from_device: 300, last_request: 'RD read DM' }), 2500);
  assert.equal(rate(2500), 200);
  assert.equal(rate(5000), 0);
  made.setSession(report({ since_ms: 9000, bytes_to_device: 7 }), 9000);
  assert.equal(rate(9000), 0);
});

// All string literals of the programs, adjacent ones joined. The message of a row may be made of several.
const literals = () => {
  const texts = [], root = join(folder, '../../..');
  for (const part of ['bridge', 'core', 'tools/station'])
    for (const name of readdirSync(join(root, part), { recursive: true })) {
      if (!name.endsWith('.cpp')) continue;
      const code = readFileSync(join(root, part, name), 'utf8').replace(/"\s*"/g, '');
      texts.push(...(code.match(/"(?:[^"\\\n]|\\.)*"/g) ?? []));
    }
  return texts.join('\n').replace(/\\"/g, '"');
};

test('each message with a Chinese text is one of the programs', () => {
  const all = literals();
  for (const [en, zh] of server.messages) {
    for (const part of en.split(/\{\}|(?=, last by)/).map((each) => each.trim())) assert.ok(all.includes(part), `no program writes '${part}' of '${en}'`);
    assert.equal(zh.match(/\{\d?\}/g)?.length, en.match(/\{\}/g)?.length, en);
    assert.match(zh, /[\u4e00-\u9fff]/);
  }
  assert.equal(new Set(server.messages.map(([en]) => en)).size, server.messages.length);
});

test('a message of a program is shown in Chinese with its parts, an unknown one unchanged', () => {
  assert.equal(server_text.serverText('try again in 7 s'), 'try again in 7 s');
  i18n.setLanguage('zh');
  assert.equal(server_text.serverText('try again in 7 s'), '请在 7 秒后重试');
  assert.equal(server_text.serverText("no device of the bus 'a+b' has the protocol 'dtc'"), '总线 “a+b” 没有协议为 “dtc” 的设备');
  assert.equal(server_text.serverText('the version 12ab of anna (desk) is still watched'), 'anna (desk) 的版本 12ab 仍在观察中');
  assert.equal(server_text.serverText('the configuration was changed meanwhile, last by $& {}'), '配置已被修改，最后由 $& {} 修改');
  for (const other of ['', 'something else', 'try again in 7 s and more', '('.repeat(2000)]) assert.equal(server_text.serverText(other), other);
  i18n.setLanguage('en');
});

test('the browser is notified once of each alarm that becomes unacknowledged', () => {
  globalThis.window = { Notification: {}, isSecureContext: true };
  globalThis.Notification = { permission: 'granted' };
  const kept = globalThis.localStorage;
  globalThis.localStorage = { ...kept, getItem: (key) => (key === 'fieldcast.notices' ? 'on' : null) };
  const shown = [];
  const notices = new browser_notices.BrowserNotices((title, options, address) => shown.push([title, options.tag, address]));
  const alarm = (channel, more) => ({ bus: 'one', device: 'plc', channel, limit: 'high', priority: 'critical', state: 'unacknowledged', since_ms: 5, suppressed: '', shelved_until_ms: null, ...more });
  notices.see(alarm('old'), 1000);  // was there when the page was opened
  notices.see(alarm('old'), 9000);
  notices.see(alarm('a/b'), 9000);
  notices.see(alarm('a/b'), 9100);
  notices.see(alarm('quiet', { suppressed: 'maintenance' }), 9100);
  notices.see(alarm('shelved', { shelved_until_ms: 10000 }), 9100);
  assert.deepEqual(shown, [['critical: one/plc/a/b high', 'one/plc/a/b/high', '#/alarms?alarm=one%2Fplc%2Fa%2Fb%2Fhigh']]);
  notices.see(alarm('a/b', { state: 'acknowledged' }), 9200);
  notices.see(alarm('a/b', { since_ms: 9300 }), 9300);  // raised again
  assert.equal(shown.length, 2);
  for (let i = 0; i < 5; ++i) notices.see(alarm(`c${i}`), 9400);
  assert.deepEqual(shown.slice(3).map(([title, tag]) => [title, tag]), [4, 5, 6, 7].map((n) => [`${n} new alarms`, 'fieldcast']));
  globalThis.Notification.permission = 'denied';
  notices.see(alarm('d'), 60000);
  assert.equal(shown.length, 7);
  globalThis.localStorage = kept;
});

test('marks that turn the writing direction are shown escaped', () => {
  for (const mark of '\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\u200e\u200f\u061c')
    assert.equal(printable.printable(`a${mark}b`), `a\\u${mark.charCodeAt(0).toString(16).toUpperCase().padStart(4, '0')}b`);
  assert.equal(i18n.word('cause', 'a\u202eb'), 'a\\u202Eb');
  assert.equal(printable.printable('温度 °C "<b>'), '温度 °C "<b>');
});

test('a frame is read where it lies', () => {
  const read = frame.parseFrame(encodeFrame([sample(7, 1.5, { acquired_ms: 5000 }), sample(9, -2, { quality: 3, acquired_ms: 5040 })]));
  assert.deepEqual([...read.id], [7, 9]);
  assert.deepEqual([...read.value], [1.5, -2]);
  assert.deepEqual([...read.quality], [0, 3]);
  assert.deepEqual([read.base_ms, ...read.age_ms], [5040, 40, 0]);
});

test('a page that watches a channel gets no values of the channel that has its id in a new connection', () => {
  const made = makePlant('a/b/watched'), seen = [];
  made.watched = 1;
  made.onValue = (id) => seen.push(made.value[id]);
  made.applyFrame(encodeFrame([sample(1, 5)]));
  made.restart();
  made.applyFrame(encodeFrame([sample(1, 99)]));
  made.applyCatalogue({ version: 1, full: true, channels: [row(1, 'a/b/other'), row(2, 'a/b/watched')], gone: [] });
  assert.deepEqual(seen, [5]);
});

test('bytes that are no frame are refused', () => {
  const good = encodeFrame([sample(1, 1)]);
  assert.equal(frame.parseFrame(good.slice(0, 15)), undefined);
  assert.equal(frame.parseFrame(good.slice(0, good.byteLength - 1)), undefined);
  const other = good.slice(0);
  new DataView(other).setUint8(0, 2);
  assert.equal(frame.parseFrame(other), undefined);
});

test('frames wait for the catalogue of their connection', () => {
  const made = makePlant('a/b/c');
  made.restart();
  made.applyFrame(encodeFrame([sample(1, 42)]));
  assert.ok(Number.isNaN(made.value[1]));
  made.applyCatalogue({ version: 1, full: true, channels: [row(1, 'x/y/z')], gone: [] });
  assert.equal(made.value[1], 42);
  assert.equal(made.channels.get(1).path, 'x/y/z');
  assert.equal(made.ids.get('a/b/c'), undefined);
});

test('values of an id that the catalogue does not know yet are kept', () => {
  const made = makePlant('a/b/c');
  made.applyFrame(encodeFrame([sample(5000, 3)]));
  made.applyCatalogue({ version: 2, full: false, channels: [row(5000, 'a/b/new')], gone: [1] });
  assert.equal(made.value[5000], 3);
  assert.equal(made.channels.has(1), false);
});

test('an id beyond all bounds takes no memory', () => {
  const made = makePlant('a/b/c');
  made.applyFrame(encodeFrame([sample(0xfffffff0, 3)]));
  assert.ok(made.value.length < 1e6);
});

test('a text gives way to the number that comes after it', () => {
  const made = makePlant('a/b/c');
  made.applyTexts({ kind: 'values', id: [1], value: ['9007199254740993'], acquired_ms: [5], quality: [0] });
  assert.equal(made.texts.get(1), '9007199254740993');
  made.applyFrame(encodeFrame([sample(1, 12)]));
  assert.equal(made.texts.has(1), false);
});

test('channels are counted by bus and quality', () => {
  const made = makePlant('a/d/1', 'a/d/2', 'b/d/1');
  made.applyFrame(encodeFrame([sample(1, 1), sample(2, 1, { quality: 2 })]));
  assert.deepEqual(made.count().get('a'), { all: 2, bad: 1, unread: 0 });
  assert.deepEqual(made.count().get(''), { all: 3, bad: 1, unread: 1 });
});

test('rows are filtered, grouped, sorted and pinned', () => {
  const made = makePlant('shop/press/speed', 'shop/press/force', 'shop/oven/zone', 'yard/crane/load');
  made.applyFrame(encodeFrame([sample(1, 9), sample(2, 5), sample(3, 7, { quality: 2 }), sample(4, 1)]));
  const choice = { filter: '', onlyBad: false, badFirst: false, group: false, sort: 'channel', descending: false, pinned: new Set() };
  const paths = (more) => {
    const found = rows.arrange(made, { ...choice, ...more });
    return [...found.rows].map((each) => (each < 0 ? `[${found.headings[-1 - each]}]` : made.channels.get(each).path));
  };
  assert.deepEqual(paths({ filter: 'shop/press/*' }), ['shop/press/force', 'shop/press/speed']);
  assert.deepEqual(paths({ filter: 'PRESS spe' }), ['shop/press/speed']);
  assert.deepEqual(paths({ filter: 'shop/(*' }), []);
  assert.deepEqual(paths({ onlyBad: true }), ['shop/oven/zone']);
  assert.deepEqual(paths({ badFirst: true })[0], 'shop/oven/zone');
  assert.deepEqual(paths({ sort: 'value', descending: true })[0], 'shop/press/speed');
  assert.deepEqual(paths({ pinned: new Set(['yard/crane/load']) })[0], 'yard/crane/load');
  assert.deepEqual(paths({ group: true }), ['[shop/oven]', 'shop/oven/zone', '[shop/press]', 'shop/press/force', 'shop/press/speed', '[yard/crane]', 'yard/crane/load']);
});

const alarmOf = (channel, more = {}) => ({
  bus: 'shop', device: 'press', channel, limit: 'high', priority: 'high', state: 'unacknowledged', active: true, value: 1, since_ms: 1000, occurrences: 1,
  chattering: false, acknowledged_by: '', acknowledged_ms: null, note: '', shelved_until_ms: null, shelved_by: '', suppressed: '', ...more });

test('alarms that want somebody come first, then by priority, the newest on top', () => {
  const alarms = [
    alarmOf('shelved', { shelved_until_ms: 9000 }), alarmOf('acknowledged', { state: 'acknowledged', priority: 'critical' }), alarmOf('old'),
    alarmOf('returned', { state: 'returned', active: false, since_ms: 2000 }), alarmOf('medium', { priority: 'medium' }),
    alarmOf('maintenance', { suppressed: 'maintenance' }), alarmOf('critical', { priority: 'critical' }),
  ];
  const arrange = (choice, now = 5000) => alarm_rows.arrangeAlarms(alarms, { filter: '', section: undefined, ...choice }, now);
  const names = (choice, now) => arrange(choice, now).alarms.map((each) => each.channel);
  assert.deepEqual(names({}), ['critical', 'returned', 'old', 'medium', 'acknowledged', 'shelved', 'maintenance']);
  assert.deepEqual(names({}, 9001).slice(0, 4), ['critical', 'returned', 'old', 'shelved']);
  assert.deepEqual(names({ section: 'shelved' }), ['shelved']);
  assert.deepEqual(names({ filter: 'PRESS crit' }), ['critical', 'acknowledged']);
  assert.deepEqual(arrange({ section: 'shelved' }).counts, { unacknowledged: 4, acknowledged: 1, shelved: 1, maintenance: 1 });
});

test('rows of alarms keep their places while the user selects', () => {
  const shown = ['a', 'b', 'c'].map((name) => alarmOf(name)), fresh = alarmOf('new', { priority: 'critical' });
  const changed = alarmOf('c', { state: 'acknowledged', priority: 'low' });
  const present = new Map([shown[0], changed, fresh].map((alarm) => [`shop/press/${alarm.channel}/high`, alarm]));
  const rows = alarm_rows.steadyAlarms(shown, present, [fresh, shown[0], changed]);
  assert.deepEqual(rows.map(({ channel, state, active }) => [channel, state, active]),
    [['a', 'unacknowledged', true], ['b', 'clear', false], ['c', 'acknowledged', true], ['new', 'unacknowledged', true]]);
  assert.equal(alarm_rows.worstOf('high', [null, 3, 9, undefined, NaN, 5]), 9);
  assert.equal(alarm_rows.worstOf('low-low', [3, 9, 5]), 3);
  assert.equal(alarm_rows.worstOf('low', [null]), null);
});

test('an alarm that is clear stays while it is shelved or its device is in maintenance', () => {
  const made = makePlant('a/b/c');
  const clear = { state: 'clear', active: false };
  made.setAlarm(alarmOf('x', { ...clear, suppressed: 'maintenance' }));
  made.setAlarm(alarmOf('y', { ...clear, shelved_until_ms: 5 }));
  made.setAlarm(alarmOf('z'));
  assert.equal(made.alarms.size, 3);
  for (const channel of ['x', 'y', 'z']) made.setAlarm(alarmOf(channel, clear));
  assert.equal(made.alarms.size, 0);
});

test('no cell of a CSV breaks its row or is a formula', () => {
  assert.equal(csv.csvText(['a', 'b'], [['x,y', 'say "no"'], ['=1+1', -2], ['two\nlines', null]]),
    'a,b\r\n"x,y","say ""no"""\r\n\'=1+1,-2\r\n"two\nlines",\r\n');
  assert.equal(csv.csvTime(1000), '1970-01-01T00:00:01.000Z');
});

// One group that is read every 100 ms; one of its points in every second read only.
const pointOf = (more) => ({ area: 'holding', first: 100, count: 4, channels: ['a'], period_ms: 100, phase_ms: 30, worst_gap_ms: null, stretch: 1, ...more });
const group = {
  device: 'press', list: false, period_ms: 100, phase_ms: 30, slack_ms: 1, load: 0.2,
  points: [pointOf(), pointOf({ first: 110, count: 1, channels: ['b'], period_ms: 200, phase_ms: 130 })] };

test('a read of the plan ends at its phase and carries the points whose turn it is', () => {
  const { readOf, readNear, pointsOf } = plan_picture;
  assert.deepEqual(readOf(group, 1, 400), { index: 1, begin_ms: 110, end_ms: 130 });
  assert.equal(readOf(group, 4, 400).index, 0);
  assert.equal(readOf(group, -1, 400).end_ms, 330);
  assert.equal(readNear(group, 115, 400).index, 1);
  assert.equal(readNear(group, 399, 400).index, 3);
  const carried = (index) => pointsOf(group, readOf(group, index, 400)).flatMap((each) => each.channels);
  assert.deepEqual([0, 1, 2, 3].map(carried), [['a'], ['a', 'b'], ['a'], ['a', 'b']]);
  assert.equal(readOf({ ...group, period_ms: null, phase_ms: null }, 0, 400), undefined);
});

test('marks are as wide as the time on the wire, and never more than pixels', () => {
  assert.deepEqual(plan_picture.marksOf([group], 400, 400), [[10, 30], [110, 130], [210, 230], [310, 330]]);
  const wrapped = plan_picture.marksOf([{ ...group, phase_ms: 5 }], 400, 400);
  assert.deepEqual([wrapped[0], wrapped.at(-1)], [[0, 5], [385, 400]]);
  const many = { ...group, period_ms: 1, phase_ms: 0.5, load: 0.5 };
  assert.equal(plan_picture.marksOf([many], 100_000, 300).length, 1);
  assert.equal(plan_picture.rangeText(group.points), 'holding 100..110');
  assert.deepEqual(plan_picture.axisTicks(752, 8), [0, 100, 200, 300, 400, 500, 600, 700]);
});

test('why a device is as it is', () => {
  const device = (more) => ({ bus: 'shop', device: 'press', state: 'online', exchanges: 100, failures: 2, refused: [], refused_gaps: [], causes: {}, ...more });
  const { reasonOf, grownCause } = device_health;
  const counts = { CHECKSUM: 9, NO_ANSWER: 40 };
  assert.deepEqual(reasonOf(device(), undefined, undefined, undefined), { kind: 'fine', n: 0 });
  assert.deepEqual(reasonOf(device({ state: 'offline', causes: counts }), undefined, undefined, undefined), { kind: 'failing', cause: 'NO_ANSWER' });
  assert.deepEqual(reasonOf(device({ state: 'degraded', causes: counts }), undefined, undefined, 'CHECKSUM'), { kind: 'failing', cause: 'CHECKSUM' });
  assert.deepEqual(reasonOf(device({ state: 'degraded', refused: ['holding:7'], causes: counts }), undefined, undefined, undefined), { kind: 'refuses', n: 1 });
  assert.deepEqual(reasonOf(device({ state: 'offline' }), { state: 'closed', closed_because: 'PORT_MISSING' }, undefined, undefined), { kind: 'bus-closed', cause: 'PORT_MISSING' });
  assert.deepEqual(reasonOf(device(), { state: 'leased' }, { state: 'open', who: 'otto' }, undefined), { kind: 'programmed', who: 'otto' });
  assert.equal(grownCause(counts, { CHECKSUM: 12, NO_ANSWER: 41 }), 'CHECKSUM');
  assert.equal(grownCause(counts, counts), undefined);
  const names = (devices) => device_health.orderedDevices(devices).map((each) => each.device);
  assert.deepEqual(names([device({ device: 'b' }), device({ device: 'a' }), device({ device: 'z', state: 'offline' })]), ['z', 'a', 'b']);
});

test('the command for the programming software is safe to paste', () => {
  const choice = { server: 'plc-north:4950', number: 'P1', port: '/tmp/plc', user: '', tls: false };
  assert.equal(port_command.portCommand(choice), 'fieldcast-port --server plc-north:4950 --device P1 --link /tmp/plc');
  assert.equal(port_command.portCommand({ ...choice, number: "P1; rm 'x'", tls: true, user: 'anna' }),
    `fieldcast-port --server plc-north:4950 --tls --user anna --password-file anna.password --device 'P1; rm '\\''x'\\''' --link /tmp/plc`);
  assert.equal(port_command.portCommand({ ...choice, number: 'P 1" & del %x%', port: 'COM5' }),
    'fieldcast-port connect --server plc-north:4950 --device "P 1 & del x" --port COM5');
  assert.equal(port_command.serverOf('::1'), '[::1]:4950');
});

test('an address survives its way through a link', () => {
  const route = router.parseRoute(router.link('channel', ['bus 1', 'a/b', '温度'], { c: ['x', 'y&z'] }));
  assert.deepEqual(route.parts, ['bus 1', 'a/b', '温度']);
  assert.deepEqual(route.query.getAll('c'), ['x', 'y&z']);
  assert.equal(router.parseRoute('').name, 'overview');
  assert.deepEqual(router.parseRoute('#/live/%zz').parts, ['%zz']);
});

function plantWithOneChannel() {
  const line = new plant.Plant();
  line.applyCatalogue({ version: 1, full: true, channels: [[1, 'a/b/c', 'float32', 'kN', '', 'read-only', 'scheduled', 500, {}, '', 'x']], gone: [] });
  return line;
}

test('numbers are shown as they are', () => {
  assert.equal(format.exactValue(Math.fround(0.1), 'float32'), '0.1');
  assert.equal(format.exactValue(16777217, 'float64'), '16777217');
  assert.equal(format.exactValue(1, 'bool'), 'true');
  assert.equal(format.tableValue({ id: 900, type: 'int16' }, 23.400000000000002), '23.4');
  assert.equal(format.tableValue({ id: 900, type: 'int16' }, 23), '23.0');
  assert.equal(format.tableValue({ id: 901, type: 'int16' }, NaN), '–');
  assert.equal(format.age(-5), '0.0 s');
  assert.equal(format.age(65_000), '65 s');
  assert.equal(format.duration(0.25), '250 µs');
});

test('the decimals of a value are those of its channel, not of its arithmetic', () => {
  const shown = (type, ...values) => values.map((value) => format.roundedValue(value, { type }, format.decimalsOf({ type }, values)));
  assert.deepEqual(shown('float32', 0.0000338111, 886.39154), ['0.0000338', '886.39']);
  assert.deepEqual(shown('float32', Math.fround(886.39154)), ['886.39']);
  assert.deepEqual(shown('float32', 21.5), ['21.5']);
  assert.deepEqual(shown('float64', 0.0000338111), ['0.0000338']);
  assert.deepEqual(shown('int16', 23.400000000000002, 7), ['23.4', '7.0']);
  assert.deepEqual(shown('uint16', 1450), ['1450']);
  assert.deepEqual(shown('float32', -0.0001, 500.25), ['-0.0001', '500.25']);
  assert.deepEqual(shown('bool', 1), ['true']);
  assert.equal(format.roundedValue(null, { type: 'float32' }, 2), '–');
});

test('the digits of a channel are those of its configuration, else of its resolution', () => {
  const line = plantWithOneChannel();
  const channel = () => line.channels.get(1);
  const shown = (value) => format.tableValue(channel(), value);
  assert.equal(shown(886.39154), '886.39');
  assert.equal(shown(0.0000338111), '0.0000338');
  line.setDescription({ bus: 'a', device: 'b', protocol: 'modbus-rtu', port: '', address: '7', digits: {}, resolution: { c: 1, other: 2 } });
  assert.equal(shown(886.39154), '886.4');
  assert.equal(shown(0.0000338111), '0.0000338');
  line.setDescription({ bus: 'a', device: 'b', protocol: 'modbus-rtu', port: '', address: '7', digits: { c: 0 }, resolution: {} });
  assert.equal(shown(886.39154), '886');
  assert.equal(shown(-0.2), '0');
  assert.equal(format.shownValue(12.25, channel()), '12');
  line.applyCatalogue({ version: 2, full: false, channels: [[1, 'a/b/c', 'float32', 'kN', '', 'read-only', 'scheduled', 500, {}, '', 'x']], gone: [] });
  assert.equal(shown(886.39154), '886');
});

test('the trend of a row has the values of the last minutes, with gaps', () => {
  const recent = new recent_values.RecentValues(), values = Float64Array.from([NaN, 5, 1, NaN, 3]), quality = new Uint8Array(5);
  for (const [at_ms, value] of [[0, 0], [1000, 9], [5000, 10], [10_000, NaN], [15_000, 5]]) {
    values[2] = value;
    quality[4] = at_ms === 5000 ? 2 : 0;  // the value of a bad quality is that of the last good one
    recent.take(values, quality, at_ms);
  }
  assert.equal(recent.taken, 4);  // one every 5 s
  assert.equal(recent.path(2, 47, 20), 'M44.0 20.0L45.0 0.0M47.0 10.0');
  assert.equal(recent.path(1, 47, 20), 'M44.0 10.0L45.0 10.0L46.0 10.0L47.0 10.0');
  assert.equal(recent.path(3, 47, 20), '');
  assert.equal(recent.path(4, 47, 20), 'M44.0 10.0M46.0 10.0L47.0 10.0');
  assert.equal(recent.path(99, 47, 20), '');
  for (let n = 4; n < 100; n++) recent.take(values, quality, 5000 * n);
  assert.match(recent.path(1, 47, 20), /^M0\.0 .*L47\.0 10\.0$/);
  recent.clear();
  assert.equal(recent.path(1, 47, 20), '');
});

test('a fault began with the first sample without a value after the last good one', () => {
  const since = (t, bad) => channel_fault.badSince({ from_ms: 0, to_ms: 9, series: [{ t, bad }] });
  assert.deepEqual(since([1, 2, 3, 4], [1, 0, 2, 1]), { at_ms: 3, whole: false });
  assert.deepEqual(since([1, 2], [1, 1]), { at_ms: 1, whole: true });
  assert.equal(since([1, 2], [1, 0]), undefined);
  assert.equal(since([], []), undefined);
});

test('the overview begins with the buses that need attention', () => {
  const view = (bus, need = {}, more = {}) => ({ bus: { bus, state: 'running', stretch: 1, planned_load: 0.4, ...more }, need: { contested: false, alarms: 0, bad: 0, missed: 0, ...need } });
  const views = [view('a'), view('b', { missed: 2 }), view('c', { bad: 1 }), view('d', {}, { stretch: 2.5 }), view('e', { alarms: 1 }), view('f', {}, { state: 'closed' }), view('g', { contested: true }), view('h', {}, { state: 'leased' })];
  assert.equal(bus_order.worstFirst(views).map(({ bus }) => bus.bus).join(''), 'fgedcbah');
});

test('an overloaded bus has the words of the log, and a split that its plan allows', () => {
  assert.match(bus_advice.overloadText({ planned_load: 2.534, stretch: 12.4 }), /^More is wanted than the wire carries, 2\.53 times as much: refreshes are up to 12 times as long as configured\. Refresh less often, .* or split the bus; .fieldcast plan. shows what is enough\.$/);
  assert.equal(bus_advice.overloadText({ planned_load: 0.9, stretch: 1 }), undefined);
  const plan = (loads) => ({ groups: Object.entries(loads).map(([name, load]) => ({ device: name, load })) });
  assert.deepEqual(bus_advice.splitOf(plan({ a: 0.9, b: 0.8, c: 0.05, d: 0.05 })), [['a'], ['b', 'c', 'd']]);
  assert.equal(bus_advice.splitOf(plan({ a: 1.4, b: 0.2 })), undefined);
  assert.deepEqual(bus_advice.planAdvice(plan({ a: 1.4, b: 0.2 })), ['a needs the most: 140 % of the wire.']);
});

test('a refresh that was not read in time is explained by what held the wire', () => {
  const load = (late, no_answer = 0, commands = 0) => ({ missCauses: { LATE: late }, causes: { NO_ANSWER: no_answer }, commands });
  const bus = { measured_load: 0.35, planned_load: 0.36 };
  assert.match(bus_advice.lateText([load(1), load(1, 1), load(10, 1)], bus, 300), /Failed exchanges meanwhile: 1 \(no response\).*up to 300 ms/);
  assert.match(bus_advice.lateText([load(1), load(1), load(10, 0, 2)], bus, 300), /Commands used the wire meanwhile: 2/);
  assert.match(bus_advice.lateText([load(1), load(15)], bus, 300), /no exchange failed.*Measured 35 % of planned 36 %/);
  assert.equal(bus_advice.lateText([load(5), load(5, 3)], bus, 300), undefined);
});

const series = (t, average, bad, bucket_ms = 1000) => ({
  channel: 'a/b/c', unit: 'bar', type: 'float32', tier: 'raw', bucket_ms, t, average, min: average, max: average, last: average, count: t.map(() => 1), bad });

test('a line of the store breaks where nothing was for long, and marks what was bad', () => {
  const line = trend.lineOf(series([0, 1000, 100_000, 101_000], [1, 2, null, 4], [0, 0, 3, 0]), 'a/b/c', 1000);
  assert.deepEqual(line.t, [0, 1000, 1001, 100_000, 101_000]);
  assert.deepEqual(line.average, [1, 2, null, null, 4]);
  assert.deepEqual(line.bad, [{ from_ms: 100_000, to_ms: 101_000 }]);
});

test('live values go on where the store ends', () => {
  const stored = trend.lineOf(series([1000, 2000], [1, 2], [0, 0]), 'a/b/c', 1000);
  const tail = new trend.LiveTail(1000);
  for (const [at, value] of [[1500, 9], [2500, 3], [3500, 4]]) tail.add(at, value, true, at);
  const joined = tail.join(stored, 0, 3600);
  assert.deepEqual(joined.t, [1000, 2000, 2500, 3500]);
  assert.deepEqual(joined.average, [1, 2, 3, 4]);
  assert.deepEqual(joined.bad, []);
});

test('a missed refresh is a gap in red, an outage lasts until a good value comes', () => {
  const none = { ...trend.lineOf(series([], [], []), 'a/b/c') };
  const tail = new trend.LiveTail(1000);
  tail.add(1000, 1, true, 1000);
  tail.add(5000, 2, true, 5000);
  assert.deepEqual(tail.join(none, 0, 5000).bad, [{ from_ms: 2000, to_ms: 5000 }]);
  assert.deepEqual(tail.join(none, 0, 5000).average, [1, null, 2]);
  tail.add(5000, 2, false, 6000);
  assert.deepEqual(tail.join(none, 0, 9000).bad.at(-1), { from_ms: 2000, to_ms: 9000 });
  tail.add(9500, 3, true, 9500);
  assert.deepEqual(tail.join(none, 0, 9600).bad.at(-1), { from_ms: 2000, to_ms: 9500 });
});

test('marks of an axis are round', () => {
  assert.deepEqual(ticks.numberTicks(0, 1, 5).map((tick) => tick.text), ['0.0', '0.2', '0.4', '0.6', '0.8', '1.0']);
  assert.deepEqual(ticks.numberTicks(-3, 47, 5).map((tick) => tick.text), ['0', '10', '20', '30', '40']);
  assert.deepEqual(ticks.numberTicks(1, 1, 5), []);
  const at = new Date(2026, 5, 1, 23, 50).getTime();
  const marks = ticks.timeTicks(at, at + 20 * 60_000, 4);
  assert.deepEqual(marks.map((tick) => tick.text), ['23:50', '23:55', '06-02 00:00', '00:05', '00:10']);
});

test('the clock of the station is taken from its most punctual message', () => {
  let own = 1_000_000;
  const station = new clock.StationClock(() => own);
  station.observe(own + 500 - 80);  // 80 ms in transit
  own += 1000;
  station.observe(own + 500 - 2);
  own += 1000;
  station.observe(own + 500 - 300);
  assert.equal(station.now(), own + 498);
  for (let n = 0; n < 70; n++) station.observe((own += 1000) - 3600_000);  // it was set back
  assert.equal(station.now(), own - 3600_000);
});

test('what was typed becomes a value of the type', () => {
  assert.deepEqual(typed.typedValue('21,5', 'float32', {}), { value: 21.5 });
  assert.deepEqual(typed.typedValue('9007199254740993', 'int64', {}), { value: 9007199254740993n });
  assert.deepEqual(typed.typedValue('true', 'bool', {}), { value: true });
  assert.deepEqual(typed.typedValue('', 'string(8)', {}), { value: '' });
  assert.deepEqual(typed.typedValue('abc', 'int16', {}), { fault: 'number' });
  assert.deepEqual(typed.typedValue('', 'int16', {}), { fault: 'number' });
  assert.deepEqual(typed.typedValue('31', 'float32', { 'write-max': 30 }), { fault: 'range' });
});

test('every text is there in both languages, and every key that is asked for exists', async () => {
  const files = (path) => readdirSync(path, { withFileTypes: true }).flatMap((entry) =>
    entry.isDirectory() ? files(join(path, entry.name)) : [join(path, entry.name)]);
  const all = new Set();
  for (const texts of [common.texts, causes.texts, configurationTexts.texts, ...pages.pages.map(({ module }) => module.texts)]) {
    assert.ok(Object.keys(texts).length > 0);
    for (const [key, languages] of Object.entries(texts)) {
      assert.deepEqual(languages.map((text) => typeof text === 'string' && text !== ''), [true, true], key);
      assert.ok(!all.has(key), `${key} is there twice`);
      all.add(key);
    }
  }
  const whole = files(source).map((path) => readFileSync(path, 'utf8')).join('\n');
  const kinds = new Set([...whole.matchAll(/\bword\('([a-z]+)'/g)].map((match) => match[1]));
  const prefixes = [...whole.matchAll(/\bt\(`([^$`]+)\$\{/g)].map((match) => match[1]);
  const isUsed = (key) => key.endsWith('.title') || kinds.has(key.split('.')[0]) || prefixes.some((prefix) => key.startsWith(prefix)) ||
    new RegExp(`[^\\n ,{]'${key}'|'${key}'[^:]`).test(whole);
  for (const key of all) assert.ok(isUsed(key), `${key} is not used`);
  for (const path of files(source))
    for (const [, key] of readFileSync(path, 'utf8').matchAll(/\bt\('([\w.-]+)'/g)) assert.ok(all.has(key), `${path}: ${key}`);
  assert.equal(i18n.t('live.shown', { n: 3, all: 5 }), '3 of 5');
});

test('each page has a row, a title, and a key that no other page has', () => {
  const names = readdirSync(join(source, 'pages')).map((file) => file.replace('.ts', ''));
  assert.deepEqual(pages.pages.map(({ name }) => name).sort(), names.sort());
  const keys = pages.pages.flatMap(({ key }) => (key ? [key] : []));
  assert.equal(new Set(keys).size, keys.length);
  for (const { name, module } of pages.pages) assert.ok(module.texts[`${name}.title`], name);
});
