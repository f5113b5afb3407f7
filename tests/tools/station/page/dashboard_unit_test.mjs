// Tests the parts of dashboards without a browser.
//
//   node dashboard_unit_test.mjs PAGE_FOLDER NODE_MODULES

import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import test from 'node:test';
import { loadModules } from './load_modules.mjs';
import { encodeFrame } from './mock_station.mjs';

const [folder, modules] = process.argv.slice(2).map((path) => resolve(path));
const source = join(folder, 'src');
const { document: documents, grid, reading, property_form: form, kiosk, router, plant, i18n, pages, widgets, lamp, gauge } = await loadModules(folder, modules, [
  'dashboard/document', 'dashboard/grid', 'dashboard/reading', 'dashboard/property_form', 'kiosk', 'router', 'plant', 'i18n', 'pages', 'dashboard/widgets',
  'dashboard/widgets/lamp', 'dashboard/widgets/gauge']);

const format = JSON.parse(readFileSync(join(folder, '../dashboard/dashboard_format.json'), 'utf8'));
const makePlant = (channels) => {
  const result = new plant.Plant();
  result.applyCatalogue({ version: 1, full: true, gone: [],
    channels: channels.map(([path, type, refresh_ms = 500], index) => [index + 1, path, type, 'bar', '', 'read-only', 'scheduled', refresh_ms, { high: 8, 'high-high': 9, 'write-max': 5 }, '', 'north']) });
  return result;
};
const sample = (id, value, more = {}) => ({ id, value, text: null, acquired_ms: Date.now() - 40, quality: 0, ...more });

test('each kind of the table has a widget, a file and texts in both languages', () => {
  assert.deepEqual(Object.keys(widgets.widgets).sort(), Object.keys(format.kinds).sort());
  assert.deepEqual(readdirSync(join(source, 'dashboard/widgets')).map((file) => file.replace('.ts', '')).sort(), Object.keys(format.kinds).sort());
  const { texts } = pages.pageOf('dashboard').module;
  const names = (rows) => rows.flatMap((row) => [row.name, ...(Array.isArray(row.of) ? names(row.of) : Array.isArray(row.of?.of) ? names(row.of.of) : [])]);
  for (const [kind, { properties }] of Object.entries(format.kinds)) {
    assert.ok(texts[`widget.${kind}`], kind);
    for (const name of names(properties)) assert.ok(texts[`property.${name}`], `${kind}: ${name}`);
  }
});

test('values of parameters are of the address, the default, or one of the choice', () => {
  const dashboard = { name: 'a', title: 'a', widgets: [], parameters: [{ name: 'pump', default: '1', values: ['1', '2'] }, { name: 'hall', default: 'north' }] };
  const values = (text) => documents.valuesOf(dashboard, new URLSearchParams(text));
  assert.deepEqual(values(''), { pump: '1', hall: 'north' });
  assert.deepEqual(values('pump=2&hall=south'), { pump: '2', hall: 'south' });
  assert.deepEqual(values('pump=7&hall=a/b'), { pump: '1', hall: 'north' });
  for (const hostile of ['*', '${pump}', '../x', 'x'.repeat(65), '']) assert.equal(values(`hall=${encodeURIComponent(hostile)}`).hall, 'north');
});

test('parameters are filled in once, everywhere in a widget', () => {
  const widget = { kind: 'trend', at: [0, 0, 1, 1], title: 'Pump ${pump}', channels: ['a/${pump}/${other}'], states: [{ text: '${pump}', value: true }] };
  assert.deepEqual(documents.filled(widget, { pump: '${pump}' }),
    { kind: 'trend', at: [0, 0, 1, 1], title: 'Pump ${pump}', channels: ['a/${pump}/${other}'], states: [{ text: '${pump}', value: true }] });
  assert.deepEqual(documents.filled(widget, { pump: '3' }).channels, ['a/3/${other}']);
});

test('the printed text is JSON with a widget in each line', () => {
  const dashboard = { name: 'a', title: 'A "quoted" title', widgets: [{ kind: 'text', at: [0, 0, 1, 1], text: 'x' }, { kind: 'text', at: [1, 0, 1, 1], text: 'y' }] };
  const text = documents.printed(dashboard);
  assert.deepEqual(JSON.parse(text), dashboard);
  assert.equal(text.split('\n').filter((line) => line.includes('"kind"')).length, 2);
  assert.deepEqual(JSON.parse(documents.printed(documents.emptyDashboard('a', 'b'))).widgets, []);
});

test('a widget that is moved pushes others down, and never covers one', () => {
  const all = [[0, 0, 3, 2], [3, 0, 3, 2], [0, 2, 6, 4], [0, 6, 2, 2]];
  assert.deepEqual(grid.placed(all, 0, [2, 0, 3, 2], 12), [[2, 0, 3, 2], [3, 2, 3, 2], [0, 4, 6, 4], [0, 8, 2, 2]]);
  assert.deepEqual(grid.placed(all, 0, [0, 0, 3, 2], 12), all);
  let seed = 7;
  const random = (most) => (seed = (seed * 16807) % 2147483647) % most;
  for (let turn = 0; turn < 300; turn++) {
    let places = [];
    for (let n = 0; n < 12; n++) places.push(grid.freePlace(places, [1 + random(5), 1 + random(4)], 12));
    places = grid.placed(places, random(12), [random(20) - 4, random(12) - 3, random(16), random(60)], 12);
    places.forEach((a, i) => {
      assert.ok(a[0] >= 0 && a[0] + a[2] <= 12 && a[1] >= 0 && a[2] >= 1 && a[3] >= 1 && a[3] <= grid.mostHeight, String(a));
      places.forEach((b, k) => assert.ok(i === k || !grid.covers(a, b), `${a} covers ${b}`));
    });
  }
});

test('a new widget gets the first free place', () => {
  assert.deepEqual(grid.freePlace([[0, 0, 10, 2]], [4, 2], 12), [0, 2, 4, 2]);
  assert.deepEqual(grid.freePlace([[0, 0, 8, 2]], [4, 2], 12), [8, 0, 4, 2]);
  assert.deepEqual(grid.freePlace([], [20, 2], 12), [0, 0, 12, 2]);
});

test('nothing looks fresher than it is: a reading has quality and age', () => {
  const now = Date.now(), own = makePlant([['a/b/c', 'float32'], ['a/b/text', 'string(8)'], ['a/b/never', 'int16']]);
  own.applyFrame(encodeFrame([sample(1, 7.25)]));
  own.applyTexts({ id: [2], value: ['STEP'], acquired_ms: [now - 50], quality: [0] });
  const of = (path, at = now, digits) => reading.readingOf(own, path, at, digits);
  assert.deepEqual([of('a/b/c').text, of('a/b/c').tone, of('a/b/c').current], ['7.250', 'good', true]);
  assert.equal(of('a/b/c', now, 1).text, '7.3');
  assert.equal(of('a/b/text').text, 'STEP');
  const late = of('a/b/c', now + 60_000);
  assert.deepEqual([late.tone, late.late, late.current], ['warning', true, false]);
  assert.match(reading.stateText(late), /^◆ \d+ s$/);
  for (const path of ['a/b/never', 'no/such/channel']) assert.deepEqual([of(path).text, of(path).tone, of(path).current], ['–', 'unknown', false]);
  own.applyFrame(encodeFrame([sample(1, 7.25, { quality: 2 })]));
  assert.deepEqual([of('a/b/c').tone, of('a/b/c').current], ['bad', false]);
});

test('the frame of a widget shows the worst channel, and of equal ones the oldest', () => {
  const each = (tone, age_ms) => ({ tone, age_ms });
  assert.equal(reading.worstOf([]), undefined);
  assert.deepEqual(reading.worstOf([each('good', 900), each('bad', 1), each('warning', 5000)]), each('bad', 1));
  assert.deepEqual(reading.worstOf([each('good', 1), each('good', 900)]), each('good', 900));
});

test('a pattern is the one of the station', () => {
  const fits = (pattern, path) => reading.patternTest(pattern)(path);
  assert.ok(fits('shop', 'shop/press/speed') && fits('shop/press', 'shop/press/speed') && fits('*', 'a/b/c') && fits('s*p/*/sp*d', 'shop/press/speed'));
  assert.ok(!fits('shop/*', 'shopping/a/b') && !fits('shop/speed', 'shop/press/speed') && !fits('a.c', 'abc/d/e'));
});

test('a lamp compares numbers, booleans and texts', () => {
  const states = [{ value: true, text: 'on' }, { value: 0, text: 'off' }, { value: 'STEP-1', text: 'step' }];
  assert.equal(lamp.stateOf(states, { value: 1, text: 'true' }).text, 'on');
  assert.equal(lamp.stateOf(states, { value: 0, text: 'false' }).text, 'off');
  assert.equal(lamp.stateOf(states, { value: NaN, text: 'STEP-1' }).text, 'step');
  assert.equal(lamp.stateOf(states, { value: 7, text: '7' }), undefined);
});

test('limits on the scale are marks; limits of writing are not', () => {
  const own = makePlant([['a/b/c', 'float32']]);
  const marks = (min, max) => gauge.limitMarks(reading.readingOf(own, 'a/b/c', 0), min, max);
  assert.deepEqual(marks(0, 10), [{ share: 0.8, serious: false }, { share: 0.9, serious: true }]);
  assert.deepEqual(marks(0, 5), []);
});

test('typed values of a form are numbers, booleans or texts', () => {
  assert.deepEqual(['1', '-2.5', 'true', 'false', 'on', '', ' '].map(form.valueOf), [1, -2.5, true, false, 'on', '', ' ']);
});

test('a wall screen shows dashboards with their parameters in turn', () => {
  const exists = (name) => ['overview', 'alarms', 'dashboard'].includes(name);
  const next = (hash) => kiosk.nextTurn(router.parseRoute(hash), exists);
  const turns = 'overview,dashboard/pumps;pump=1,dashboard/pumps;pump=2,nowhere,alarms';
  let at = `#/overview?kiosk=${encodeURIComponent(turns)}&every=5`;
  const seen = [];
  for (let n = 0; n < 5; n++) {
    seen.push(at.split('&kiosk')[0].split('?kiosk')[0]);
    at = next(at);
    assert.equal(router.parseRoute(at).query.get('kiosk'), turns);
    assert.equal(router.parseRoute(at).query.get('every'), '5');
  }
  assert.deepEqual(seen, ['#/overview', '#/dashboard/pumps?pump=1', '#/dashboard/pumps?pump=2', '#/alarms', '#/overview']);
  assert.equal(next('#/overview?kiosk=overview'), undefined);
  assert.equal(next('#/overview'), undefined);
});
