// Tests what the pages show of trends, alarms, channels and buses, in chromium with a mock station.
//
//   node views_test.mjs PAGE_FILES NODE_MODULES

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { chromiumPath, clipped, says, settled, startBrowser, until } from './browser.mjs';
import { startMock } from './mock_station.mjs';

const [files, modules] = process.argv.slice(2);
const skip = chromiumPath() ? false : 'chromium is not installed: tools/install.sh test';
const device = 'boiler-house/device-01';
let mock, browser;

before(async () => {
  if (skip) return;
  mock = await startMock({ files, modules, channels: 400 });
  browser = await startBrowser(modules, `http://127.0.0.1:${mock.port}`);
});
after(async () => {
  await browser?.close();
  mock?.close();
});

const open = async (hash, options) => {
  const page = await browser.open(hash, options);
  await settled(page);
  return page;
};
// Notes the texts that canvases draw from now on, with their colours.
const noteCanvas = (page) => page.evaluate(() => {
  window.drawn = [];
  window.dashes = new Set();
  const { fillText, setLineDash } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
    window.drawn.push([text, this.fillStyle]);
    return fillText.call(this, text, ...rest);
  };
  CanvasRenderingContext2D.prototype.setLineDash = function (dash) {
    window.dashes.add(dash.join(' '));
    return setLineDash.call(this, dash);
  };
  dispatchEvent(new Event('fieldcast-theme'));
});

test('a trend without a value says so and has no invented axis', { skip }, async () => {
  const path = `${device}/flow-1`;
  mock.empty = new Set([path]);
  const page = await open(`#/history?c=${path}&span=10min`);
  await noteCanvas(page);
  const texts = await page.evaluate(() => window.drawn.map(([text]) => text));
  assert.ok(texts.includes('no data in this time'), texts.join());
  assert.ok(!texts.includes('0.0') && !texts.includes('1.0'), texts.join());
  await says(page, '.legend', /bad, or no value in time/);
  mock.empty = undefined;
  await page.context().close();
});

test('samples that arrived late are marked', { skip }, async () => {
  const from_ms = new Date(2026, 0, 2, 10, 0, 0).getTime();
  mock.late = [{ from_ms, to_ms: from_ms + 60_000, samples: 5, received_ms: from_ms + 90_000 }];
  const page = await open(`#/history?c=${device}/temperature-1&span=10min`);
  await says(page, 'tbody', /Late samples: 2026-01-02 10:00:00–2026-01-02 10:01:00/);
  mock.late = undefined;
  await page.context().close();
});

test('curves differ by dash and number, and each axis names its curves', { skip }, async () => {
  const names = ['temperature-1', 'pressure-1', 'temperature-2', 'pressure-2'].map((name) => `c=${device}/${name}`).join('&');
  const page = await open(`#/history?${names}&span=10min`);
  await noteCanvas(page);
  const texts = await page.evaluate(() => window.drawn.map(([text]) => text));
  for (const text of ['1 3: °C', '2 4: bar', '1', '2', '3', '4']) assert.ok(texts.includes(text), `${text} in ${texts.join()}`);
  assert.ok(await page.evaluate(() => window.dashes.size) >= 4, 'four dashes');
  assert.deepEqual(await page.locator('tbody .swatch').allTextContents().then((all) => all.map((text) => text.trim())), ['1', '2', '3', '4']);
  await says(page, '.legend', /strip at the bottom in the colour of its curve/);
  await page.context().close();
});

test('times of a range are typed in the style of a 24-hour clock', { skip }, async () => {
  const page = await open(`#/history?c=${device}/temperature-1&span=10min`);
  assert.match(await page.inputValue('input[name="from"]'), /^\d{4}-\d\d-\d\d \d\d:\d\d:\d\d$/);
  await page.fill('input[name="from"]', '2020-01-01 13:00:00');
  await page.fill('input[name="to"]', '2020-01-01 14:30:00');
  await page.getByRole('button', { name: 'Show' }).click();
  const [, from, to] = await until(() => /from=(\d+)&to=(\d+)/.exec(page.url()), 'the range is in the address');
  assert.equal(to - from, 5_400_000);
  await page.context().close();
});

test('an export of several channels is one file that is named after them', { skip }, async () => {
  const page = await open(`#/history?c=${device}/temperature-1&c=${device}/pressure-1&span=10min`);
  const link = page.getByRole('link', { name: 'Save as CSV' });
  assert.equal(await link.count(), 1);
  const [file] = await Promise.all([page.waitForEvent('download'), link.click()]);
  assert.equal(file.suggestedFilename(), 'boiler-house_device-01_temperature-1+boiler-house_device-01_pressure-1.csv');
  assert.match(readFileSync(await file.path(), 'utf8'), /temperature-1\n.*pressure-1/);
  await page.context().close();
});

test('figures of a channel have the same decimals', { skip }, async () => {
  const page = await open(`#/history?c=${device}/temperature-1&span=10min`);
  const figures = await page.locator('tbody td.number').allTextContents();
  assert.ok(figures.slice(1, 4).every((text) => /^-?\d+\.\d{3}$/.test(text)), figures.join());
  await page.context().close();
});

test('an alarm that has returned shows the value now, its limit and the worst value apart', { skip }, async () => {
  const page = await open('#/alarms');
  const row = page.locator('.vrow.inactive', { hasText: 'pressure-1' });
  assert.match(await row.locator('.c-limit').textContent(), /^low < 2 bar$/);
  assert.match(await row.locator('.c-value').textContent(), /^now -?\d+(\.\d{1,3})? bar$/);
  // stored minimum of the mock: 50 - 40 - 4 at least
  await until(async () => /^worst \d+\.\d+ bar$/.test(await row.locator('.c-worst').textContent()) && parseFloat((await row.locator('.c-worst').textContent()).slice(6)) < 83, 'the worst value of the store');
  await page.context().close();
});

test('rows of alarms do not move under the pointer', { skip }, async () => {
  const page = await open('#/alarms');
  const order = () => page.locator('.vbody .vrow:not([hidden]) .c-channel').evaluateAll((cells) =>
    cells.map((cell) => [parseInt(cell.parentElement.getAttribute('aria-rowindex'), 10), cell.textContent]).sort((a, b) => a[0] - b[0]).map(([, text]) => text));
  const before = await order();
  await page.locator('.vrow[aria-rowindex="3"]').hover();
  const alarm = { ...mock.plant.alarms[0], channel: 'temperature-5', since_ms: Date.now() };
  mock.plant.alarms.push(alarm);
  mock.tell({ kind: 'alarm', ...alarm });
  await until(async () => (await order()).length === before.length + 1, 'the new alarm is there');
  assert.deepEqual((await order()).slice(0, before.length), before);
  await says(page, '.held', /keep their places/);
  await page.mouse.move(5, 5);
  await until(async () => /temperature-5/.test((await order())[0]), 'it is first when the pointer has left');
  mock.plant.alarms.pop();
  mock.tell({ kind: 'alarm', ...alarm, state: 'clear', active: false });
  await page.context().close();
});

test('a channel without a good value shows since when, its last value, the attempts and what to check', { skip }, async () => {
  const bad = mock.plant.channels[0];
  assert.equal(bad.quality, 2);
  const since = Date.now() - 90_000;
  bad.acquired_ms = since;
  bad.value = 39;
  mock.badFrom = new Map([[bad.path, since + 2000]]);
  const page = await open(`#/channel/${bad.path}`);
  await says(page, '.fault', /Since\s*\d{4}-\d\d-\d\d .*\((8|9)\d s\)/);
  await says(page, '.fault', /Last good value\s*39 °C \d{4}-/);
  await says(page, '.fault', /12 of 5,000 exchanges failed \(0\.2 %\), most often: no response; 3 retries/);
  await says(page, '.fault', /Power of the device; cable and adapter/);
  assert.equal(await page.locator('.fault a').first().getAttribute('href'), '#/devices/boiler-house/device-01');
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  await page.context().close();
  const good = await open(`#/channel/${device}/flow-1`);
  assert.equal(await good.locator('.fault').count(), 0);
  await good.context().close();
  mock.badFrom = undefined;
});

test('fifty buses are rows, worst first, and fit on a phone', { skip }, async (each) => {
  const many = await startMock({ files, modules, channels: 2000, buses: 50 });
  each.after(() => many.close());
  many.plant.buses[40].state = 'closed';
  many.plant.alarms.push({ ...many.plant.alarms[0], bus: 'line-30', device: 'device-01', channel: 'temperature-1' });
  for (const options of [{}, { width: 390, height: 800, dark: true }]) {
    const page = await browser.open('#/overview', { ...options, base: `http://127.0.0.1:${many.port}` });
    await settled(page);
    const rows = page.locator('.bus-row');
    await until(async () => await rows.count() === 50, 'fifty rows');
    await says(page, '.bus-row:nth-child(-n+2)', /line-41/);
    // Buses, alarms and values arrive in messages of their own.
    await until(async () => {
      const names = await rows.locator('.name').allTextContents();
      return names.indexOf('line-41') < 2 && names.indexOf('line-04') < 2 && names.indexOf('line-30') < 4;
    }, 'the worst first');
    if (!options.width) assert.ok((await rows.first().boundingBox()).height <= 40);
    assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
    await page.getByRole('button', { name: 'Cards' }).click();
    await until(async () => await page.locator('.card.bus').count() === 50, 'cards');
    await page.context().close();
  }
});

test('the live list of a phone has units, and rows of devices are one line', { skip }, async () => {
  const phone = await open('#/live?q=flow-1', { width: 390, height: 800 });
  assert.match(await phone.locator('.vbody .vrow:not([hidden]) .c-unit').first().innerText(), /m³\/h/);
  assert.deepEqual(await clipped(phone), []);
  await phone.context().close();
  for (const [hash, reads] of [['#/devices', /degraded.*refuses 2 addresses/s], ['#/programming', /programming.*otto/s]]) {
    const page = await open(hash);
    const row = page.locator('.vrow[aria-rowindex="2"]');
    assert.match(await row.textContent(), reads);
    assert.ok((await row.boundingBox()).height <= 31);
    assert.deepEqual(await clipped(page), []);
    await page.context().close();
  }
});

test('an overloaded bus says what to do, and why refreshes were not read in time', { skip }, async () => {
  const bus = mock.plant.buses[2];
  const page = await open('#/overview');
  await says(page, '.card.bus', /More is wanted than the wire carries.*Refresh less often/);
  bus.misses = { ...bus.misses, LATE: 9 };
  bus.causes = { ...bus.causes, NO_ANSWER: bus.causes.NO_ANSWER + 1 };
  bus.deadline_misses += 9;
  await says(page, '.card.bus', /Not read in time\. Failed exchanges meanwhile: 1 \(no response\)/);
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  mock.planLoad = 2.5;
  await page.evaluate(() => { location.hash = '#/plan/utilities'; });
  await settled(page);
  await says(page, '.plan-advice', /2\.50 times as much.*Refresh less often.*needs the most/s);
  mock.planLoad = 0.46;
  await page.context().close();
});

test('History proposes the channels that were looked at last', { skip }, async () => {
  const page = await open(`#/channel/${device}/flow-1`);
  await page.evaluate((to) => { location.hash = to; }, `#/channel/${device}/flow-2`);
  await settled(page);
  await page.evaluate(() => { location.hash = '#/history'; });
  await settled(page);
  await says(page, '.recent', /Looked at last.*flow-2.*flow-1.*The last 2 together/s);
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  await page.getByRole('link', { name: 'The last 2 together' }).click();
  await until(() => /c=.*flow-2&c=.*flow-1/.test(decodeURIComponent(page.url())), 'both are shown');
  await page.context().close();
});

test('values have the digits of their channel on every page', { skip }, async () => {
  const page = await open('#/live?q=boiler-house/device-01/*-2');
  const value = (name) => page.locator('.vbody .vrow', { hasText: name }).locator('.c-value').textContent();
  assert.match(await value('pressure-2'), /^-?\d+\.\d$/);  // by its resolution
  await page.evaluate((to) => { location.hash = to; }, `#/channel/${device}/flow-1`);
  await says(page, '.big-value', /^\d+ m³\/h$/);  // configured
  await says(page, '.about', /Asked for by\s*wall-panel \(500 ms\)/);
  await page.evaluate((to) => { location.hash = to; }, `#/history?c=${device}/flow-1&span=10min`);
  await until(async () => /^\d+$/.test(await page.locator('tbody td.number').nth(1).textContent().catch(() => '')), 'the minimum of the history');
  await page.context().close();
});

test('a device has its protocol, its address and the response time of the day', { skip }, async () => {
  const page = await open('#/devices');
  assert.match(await page.locator('.vrow[aria-rowindex="2"] .c-at').textContent(), /^modbus-rtu · 3$/);
  await page.evaluate(() => { location.hash = '#/devices/boiler-house/device-03'; });
  await says(page, '.device', /Protocol\s*modbus-rtu\s*Address\s*3\s*Port\s*\/dev\/ttyUSB0 115200 8N1/);
  await says(page, '.device', /Response time of the last day/);
  assert.equal(await page.locator('.device canvas').count(), 2);
  await page.evaluate(() => { location.hash = '#/devices/boiler-house/device-01'; });
  await says(page, '.device h2', /device-01/);
  await says(page, '.device', /Response time of the last day/);
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  await page.context().close();
});

test('a row of the live table has a small trend', { skip }, async () => {
  const page = await open('#/live?q=flow-1');
  await until(async () => /^M.*L/.test(await page.locator('.c-trend path').first().getAttribute('d').catch(() => '')), 'two values of a trend', 20_000);
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  await page.context().close();
});

test('each page links to its document', { skip }, async () => {
  const page = await open('#/alarms', { width: 390, height: 800 });
  const [shown] = await Promise.all([page.context().waitForEvent('page'), page.getByRole('link', { name: 'Docs' }).click()]);
  await says(shown, 'body', /# alarms\.md/);
  assert.match(shown.url(), /\/api\/document\?name=alarms\.md$/);
  await shown.close();
  await page.getByRole('button', { name: 'Keys' }).click();
  await says(page, 'dialog', /g o/);
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  await page.context().close();
});

test('no error was told to the console', { skip }, () => assert.deepEqual(browser.faults, []));
