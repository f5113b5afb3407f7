// Tests the page for reports, and events and the day before on the page History, in chromium with a mock station.
//
//   node reports_test.mjs PAGE_FILES NODE_MODULES

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { chromiumPath, clipped, says, settled, startBrowser, until } from './browser.mjs';
import { startMock } from './mock_station.mjs';

const [files, modules] = process.argv.slice(2);
const skip = chromiumPath() ? false : 'chromium is not installed: tools/install.sh test';
const power = 'press-shop/device-01/flow-1';
let mock, guarded, browser;

before(async () => {
  if (skip) return;
  mock = await startMock({ files, modules, channels: 400, role: 'engineer' });
  guarded = await startMock({ files, modules, login: true, channels: 80 });
  browser = await startBrowser(modules, `http://127.0.0.1:${mock.port}`);
});
after(async () => {
  await browser?.close();
  mock?.close();
  guarded?.close();
  assert.deepEqual(browser?.faults ?? [], []);
});

const open = async (hash, options) => {
  const page = await browser.open(hash, options);
  await settled(page);
  return page;
};

for (const [name, options] of [['wide', {}], ['on a phone in the dark', { width: 390, height: 800, dark: true }], ['in Chinese', { width: 1024, language: 'zh-CN' }]])
  test(`the page for reports, ${name}: nothing clipped, no violation`, { skip }, async () => {
    const faults = [];
    for (const hash of ['#/reports', `#/reports?channel=press-shop%2F*%2Fflow-1&by=shift`, `#/history?c=${mock.plant.alarms[0].bus}/${mock.plant.alarms[0].device}/${mock.plant.alarms[0].channel}&compare=`]) {
      const page = await open(hash, options);
      faults.push(...[...await clipped(page), ...await browser.axe(page)].map((each) => `${hash}: ${each}`));
      if (options.language) assert.match(await page.textContent('main'), /[\u4e00-\u9fff]/);
      else assert.doesNotMatch(await page.textContent('main'), /[\u4e00-\u9fff]/);
      await page.context().close();
    }
    assert.deepEqual(faults, []);
  });

test('a report is typed, shown, downloaded, saved, opened again and deleted, by keyboard', { skip }, async () => {
  const page = await open('#/overview');
  await page.keyboard.press('g');
  await page.keyboard.press('r');
  await settled(page);
  await says(page, '.empty', /Type channels/);
  await page.keyboard.press('/');
  await page.keyboard.type(`${power}, boiler-house/*/flow-1`);
  await page.keyboard.press('Enter');
  await settled(page);
  await says(page, 'tbody', /press-shop\/device-01\/flow-1/);
  await says(page, 'tbody', /boiler-house\/device-02\/flow-1/);
  assert.match(await page.locator('tbody tr').first().textContent(), /\d{4}-\d\d-\d\d\s*1\s*2\.5\s*4\s*60\.125\s*50 %/);
  assert.match(page.url(), /channel=press-shop%2Fdevice-01%2Fflow-1&channel=boiler-house%2F\*%2Fflow-1&by=day/);
  for (const format of ['CSV', 'XLSX']) {
    const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name: format, exact: true }).click()]);
    assert.equal(file.suggestedFilename(), `report.${format.toLowerCase()}`);
  }
  await page.selectOption('select[name=by]', 'month');
  await page.getByRole('button', { name: '30 d' }).click();
  await settled(page);
  await page.selectOption('select[name=by]', 'month');
  await page.locator('main form button.primary').click();
  await settled(page);
  assert.match(page.url(), /by=month.*span=30d/);
  await page.fill('input[name=name]', '能耗 <b>');
  await page.keyboard.press('Enter');
  await says(page, '.saved', /能耗 <b>/);
  const query = mock.reports.saved.get('能耗 <b>');
  assert.match(query, /^channel=press-shop%2Fdevice-01%2Fflow-1&channel=boiler-house%2F\*%2Fflow-1&by=month&shifts=[\w%]+&span=30d$/);
  await page.evaluate(() => { location.hash = '#/reports'; });
  await settled(page);
  await page.getByRole('link', { name: '能耗 <b>' }).click();
  await settled(page);
  await says(page, 'tbody', /boiler-house\/device-02\/flow-1/);
  await page.getByRole('button', { name: 'Delete 能耗 <b>' }).click();
  await until(() => mock.reports.saved.size === 0, 'the report is deleted');
  await page.context().close();
});

test('a report by schedule shows its last file, and a refused report its reason', { skip }, async () => {
  const page = await open('#/reports?channel=a//b', { ignore: /400/ });
  await says(page, '.empty', /an empty part.*give BUS/);
  await says(page, '.saved', /energy.*06:10.*energy_2026-11-28\.xlsx/s);
  await page.getByRole('link', { name: 'energy' }).click();
  await settled(page);
  await says(page, 'tbody', /press-shop\/device-03\/flow-1/);
  await page.context().close();
});

test('the printed page is the table alone, in light colours', { skip }, async () => {
  const page = await open(`#/reports?channel=${power}`, { dark: true });
  await page.emulateMedia({ media: 'print', colorScheme: 'dark' });
  assert.ok(await page.locator('table').isVisible());
  for (const hidden of ['body > header', '.line', 'main .tools', '.saved']) assert.ok(!await page.locator(hidden).first().isVisible(), hidden);
  assert.equal(await page.evaluate(() => getComputedStyle(document.querySelector('td')).color), 'rgb(23, 28, 33)');
  await page.context().close();
});

test('a viewer reads reports and saves none', { skip }, async () => {
  const page = await browser.open(`#/reports?channel=${power}`, { base: `http://127.0.0.1:${guarded.port}`, ignore: /401/ });
  await page.fill('#user', 'vera');
  await page.fill('#password', 'secret secret');
  await page.press('#password', 'Enter');
  await settled(page);
  await page.evaluate((to) => { location.hash = to; }, `#/reports?channel=${power}`);
  await settled(page);
  await says(page, 'tbody', /flow-1/);
  assert.equal(await page.locator('input[name=name]').count(), 0);
  await page.context().close();
});

test('history shows the day before as thin curves, and reads them at the cursor', { skip }, async () => {
  const page = await open(`#/history?c=${power}&span=10min`);
  const asked = [];
  page.on('request', (request) => { if (request.url().includes('/api/history')) asked.push(Number(new URL(request.url()).searchParams.get('to'))); });
  await page.getByRole('button', { name: 'Day before' }).click();
  await settled(page);
  assert.equal(asked.length, 2);
  assert.ok(Math.abs(Math.max(...asked) - Math.min(...asked) - 86_400_000) < 5, String(asked));
  assert.equal(await page.getByRole('button', { name: 'Day before' }).getAttribute('aria-pressed'), 'true');
  assert.match(page.url(), /compare=.*span=10min/);
  const box = await page.locator('.chart').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  const cells = page.locator('tbody td.number');
  await until(async () => /\d/.test(await cells.nth(0).textContent()) && /\d/.test(await cells.nth(1).textContent()), 'both values at the cursor');
  await page.context().close();
});

test('events of the channels are marks on the time axis with a text, and a list', { skip }, async () => {
  const alarm = mock.plant.alarms.find(({ channel }) => channel), path = `${alarm.bus}/${alarm.device}/${alarm.channel}`;
  alarm.since_ms = Date.now() - 30 * 60_000;
  const from = Math.round(alarm.since_ms - 600_000), to = Math.round(alarm.since_ms + 600_000);
  const page = await open(`#/history?c=${path}&from=${from}&to=${to}`);
  await page.locator('summary').focus();
  await page.keyboard.press('Enter');
  await says(page, 'details li', new RegExp(`${path} raised ${alarm.limit}`));
  const box = await page.locator('.chart').boundingBox();
  // The axis has 60 px at the left and 12 px at the right.
  await page.mouse.move(box.x + 60 + (box.width - 72) / 2, box.y + 100);
  await until(async () => / raised /.test(await page.locator('.chart canvas').nth(1).getAttribute('title') ?? ''), 'the text of the mark');
  await page.context().close();
});
