// Tests the page in chromium with a mock station: every page at every width, in both languages and
// colours; keys, logins, writes, and a lost connection. e2e_station.mjs uses the real programs.
//
//   node browser_test.mjs PAGE_FILES NODE_MODULES [SCREENSHOTS]

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { chromiumPath, clipped, startBrowser, until } from './browser.mjs';
import { startMock } from './mock_station.mjs';

const [files, modules] = process.argv.slice(2);
const channel = 'boiler-house/device-01/speed-setpoint-1', trend = 'boiler-house/device-01/temperature-1';
const pages = ['#/overview', '#/live', `#/channel/${trend}`, `#/channel/${channel}`, '#/alarms', '#/devices', '#/programming',
  `#/history?c=${trend}&c=${channel}`, '#/history', '#/plan/press-shop', '#/reports', '#/audit', '#/dashboards', '#/dashboard/pumps', '#/channel/no/such/one'];
const skip = chromiumPath() ? false : 'chromium is not installed: tools/install.sh test';
let mock, guarded, browser;

before(async () => {
  if (skip) return;
  mock = await startMock({ files, modules });
  guarded = await startMock({ files, modules, login: true, channels: 80 });
  browser = await startBrowser(modules, `http://127.0.0.1:${mock.port}`);
});
after(async () => {
  await browser?.close();
  mock?.close();
  guarded?.close();
});

const live = (page) => page.waitForSelector('html[data-connection="open"]');
const address = (station) => `http://127.0.0.1:${station.port}`;
// Waits until a page is shown and its requests have responses.
const settled = async (page) => {
  await live(page);
  await page.waitForFunction(() => document.querySelector('main .page')?.textContent.trim() !== '');
  await until(() => page.underWay === 0, 'answers of the station');
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
};
const logIn = async (page, user, password) => {
  await page.fill('#user', user);
  await page.fill('#password', password);
  await page.press('#password', 'Enter');
};

for (const [name, options] of [['wide and light', {}], ['on a phone in the dark', { width: 390, height: 800, dark: true }], ['in Chinese at 1024', { width: 1024, language: 'zh-CN' }]])
  test(`every page, ${name}: nothing clipped, no violation, no error`, { skip }, async () => {
    const page = await browser.open('#/overview', options);
    const faults = [];
    for (const hash of pages) {
      await page.evaluate((to) => { location.hash = to; }, hash);
      await settled(page);
      faults.push(...(await clipped(page)).map((each) => `${hash}: ${each}`), ...(options.language ? [] : await browser.axe(page)).map((each) => `${hash}: ${each}`));
      if (options.language) assert.match(await page.textContent('body'), /[\u4e00-\u9fff]/);
      else assert.doesNotMatch(await page.textContent('main'), /[\u4e00-\u9fff]/);
    }
    await page.context().close();
    assert.deepEqual([...faults, ...browser.faults], []);
  });

test('the live table holds 10 000 channels in a few rows, and filters, sorts, groups and pins them', { skip }, async () => {
  const page = await browser.open('#/live');
  await settled(page);
  assert.equal(await page.getAttribute('.vtable', 'aria-rowcount'), '10001');
  assert.ok(await page.locator('.vbody .vrow').count() < 60);
  await page.keyboard.press('/');
  await page.keyboard.type('press-shop/device-02/*');
  await until(async () => (await page.textContent('.tools .number')).startsWith('40 '), 'forty channels of the device');
  await page.keyboard.press('Escape');
  assert.equal(await page.inputValue('.filter'), 'press-shop/device-02/*');
  await page.getByText('By device').click();
  assert.match(await page.textContent('.vrow.heading'), /press-shop\/device-02/);
  await page.getByRole('button', { name: 'Pin press-shop/device-02/flow-2 on top' }).click();
  assert.match(await page.locator('.vrow[aria-rowindex="3"]').textContent(), /press-shop\/device-02\/flow-2/);
  await page.fill('.filter', '');
  await page.getByText('Bad first').click();
  await page.getByText('By device').click();
  await until(async () => /no response/.test(await page.locator('.vrow[aria-rowindex="3"]').textContent()), 'a bad one first');
  await page.fill('.filter', 'temperature-1');
  await page.getByRole('button', { name: 'Value' }).click();
  assert.equal(await page.getAttribute('.c-value[role="columnheader"]', 'aria-sort'), 'ascending');
  await page.locator('.vtable').focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await until(() => page.url().includes('#/channel/'), 'the row was opened');
  await page.context().close();
});

test('values change as they come, without moving anything', { skip }, async () => {
  const page = await browser.open('#/live?q=boiler-house/device-01/flow-1');
  await settled(page);
  const value = () => page.textContent('.vbody .vrow .c-value');
  const first = await value();
  await until(async () => await value() !== first, 'the value changes');
  const shift = await page.evaluate(() => new Promise((done) => {
    let sum = 0;
    new PerformanceObserver((list) => { for (const entry of list.getEntries()) if (!entry.hadRecentInput) sum += entry.value; }).observe({ type: 'layout-shift', buffered: true });
    setTimeout(() => done(sum), 300);
  }));
  assert.ok(shift < 0.02, `layout shift ${shift}`);
  await page.context().close();
});

test('keys lead to the pages, ? tells them', { skip }, async () => {
  const page = await browser.open('#/overview');
  await settled(page);
  for (const [key, name] of [['l', 'live'], ['a', 'alarms'], ['d', 'devices'], ['h', 'history'], ['o', 'overview']]) {
    await page.keyboard.press('g');
    await page.keyboard.press(key);
    await until(() => page.url().endsWith(`#/${name}`), `g ${key} leads to ${name}`);
  }
  await page.keyboard.press('?');
  assert.match(await page.textContent('dialog'), /g l/);
  await page.keyboard.press('Escape');
  await until(async () => await page.locator('dialog').count() === 0, 'the dialog is gone');
  await page.context().close();
});

test('a write asks first, goes through and says what became of it', { skip }, async () => {
  const page = await browser.open(`#/channel/${channel}`);
  await settled(page);
  await page.fill('#new-value', '5000');
  await page.getByRole('button', { name: 'Write' }).click();
  await until(async () => /must be 0 to 3000/.test(await page.textContent('.commands')), 'out of range');
  await page.fill('#new-value', '1250');
  await page.getByRole('button', { name: 'Write' }).click();
  assert.match(await page.textContent('dialog'), /becomes 1250/);
  await page.getByRole('button', { name: 'Cancel' }).click();
  assert.equal(mock.writes.length, 0);
  await page.getByRole('button', { name: 'Write' }).click();
  await page.locator('dialog').getByRole('button', { name: 'Write' }).click();
  await until(async () => /written and read back = 1250/.test(await page.textContent('.outcomes')), 'the result');
  assert.deepEqual(mock.writes, [{ user: 'local', channel, value: 1250 }]);
  await until(async () => await page.textContent('.big-value b') === '1250', 'the new value');
  await page.context().close();
});

test('a trend shows the store and goes on live; a drag zooms', { skip }, async () => {
  const page = await browser.open(`#/history?c=${trend}&span=10min`);
  await settled(page);
  const inked = () => page.evaluate(() => {
    const canvas = document.querySelector('.chart canvas');
    return new Set(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data).size;
  });
  await until(async () => await inked() > 20, 'something is drawn');
  assert.match(await page.textContent('table.plain tbody'), /points of 1 s/);
  const box = await page.locator('.chart').boundingBox();
  await page.mouse.move(box.x + 300, box.y + 100);
  await until(async () => /At \d{4}-/.test(await page.textContent('table.plain caption')), 'the cursor tells its time');
  await page.mouse.down();
  await page.mouse.move(box.x + 500, box.y + 100, { steps: 3 });
  await page.mouse.up();
  await until(() => /from=\d+&to=\d+/.test(page.url()), 'the zoom is in the address');
  await page.goBack();
  assert.match(page.url(), /span=10min/);
  await page.context().close();
});

test('a lost connection greys everything at once, ages run on, and it comes back', { skip }, async () => {
  const page = await browser.open('#/live', { ignore: /WebSocket|ERR_/ });
  await settled(page);
  mock.refuse = true;
  mock.dropClients();
  await page.waitForSelector('html[data-connection="lost"]', { timeout: 1000 });
  assert.match(await page.textContent('.line'), /Connection lost/);
  assert.match(await page.evaluate(() => getComputedStyle(document.querySelector('main')).filter), /grayscale/);
  const age = () => page.evaluate(() => parseFloat(document.querySelector('.vbody .c-age').textContent));
  const before = await age();
  await until(async () => await age() > before + 1, 'ages run on');
  assert.deepEqual(await browser.axe(page), []);
  mock.refuse = false;
  await live(page);
  await page.context().close();
});

test('a station that falls silent is taken for lost', { skip }, async () => {
  const page = await browser.open('#/overview', { ignore: /WebSocket|ERR_/ });
  await settled(page);
  mock.silent = mock.refuse = true;
  await page.waitForSelector('html[data-connection="lost"]', { timeout: 10_000 });
  mock.silent = mock.refuse = false;
  await live(page);
  await page.context().close();
});

test('a site of the stream is written to only if the station sends commands to it', { skip }, async () => {
  const stream = await startMock({ files, modules, channels: 40, site: 'north:' });
  try {
    const page = await browser.open(`#/channel/north:${channel}`, { base: address(stream) });
    await settled(page);
    const commands = (allowed) => stream.tell({ kind: 'stream', connected: true, reason: '', commands: allowed });
    stream.tell({ kind: 'site', site: 'north', connected: true, heard_ms: Date.now() });
    commands(false);
    await until(async () => /sends no commands to this site/.test(await page.textContent('.commands')), 'the reason');
    assert.equal(await page.locator('#new-value').count(), 0);
    assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
    commands(true);
    await page.waitForSelector('#new-value');
    await page.context().close();
  } finally {
    stream.close();
  }
});

test('a login is needed where there are users; a viewer may look only', { skip }, async () => {
  const options = { base: address(guarded), ignore: /401|WebSocket/ };
  const page = await browser.open(`#/channel/${channel}`, options);
  await page.waitForSelector('#user');
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  await logIn(page, 'vera', 'wrong');
  await until(async () => /wrong/.test(await page.textContent('.trouble')), 'wrong password');
  await logIn(page, 'vera', 'secret secret');
  await settled(page);
  assert.equal(await page.locator('#new-value').count(), 0);
  assert.match(await page.textContent('.commands'), /needs the role operator/);
  await page.getByRole('button', { name: 'Log out' }).click();
  await page.waitForSelector('#user');
  await logIn(page, 'anna', 'secret secret');
  await settled(page);
  assert.equal(await page.locator('#new-value').count(), 1);
  await page.context().close();
});

test('a link with a token opens a wall screen and hides its token', { skip }, async () => {
  const page = await browser.open('#/overview?kiosk&token=wall-token', { base: address(guarded), ignore: /401|WebSocket/ });
  await settled(page);
  assert.doesNotMatch(page.url(), /token/);
  assert.equal(await page.locator('nav').isVisible(), false);
  assert.deepEqual(await clipped(page), []);
  await page.context().close();
});

test('a channel can stand in another page', { skip }, async () => {
  const page = await browser.open(`embed#/channel/${trend}`, { width: 480, height: 420 });
  await settled(page);
  assert.equal(await page.locator('header').first().isVisible(), false);
  assert.equal(await page.locator('.chart').isVisible(), true);
  assert.deepEqual([...await clipped(page), ...await browser.axe(page)], []);
  await page.context().close();
});

test('no error was told to the console', { skip }, () => assert.deepEqual(browser.faults, []));
