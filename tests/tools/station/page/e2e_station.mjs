// Checks a real station in chromium; e2e_station.py starts it with its bridge and plant.
//
//   node e2e_station.mjs ADDRESS NODE_MODULES STATION_PID [SCREENSHOTS]

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { clipped, startBrowser, until } from './browser.mjs';

const [address, modules, stationPid, screenshots] = process.argv.slice(2);
const password = 'secret secret';
const device = 'press-shop/press-1';
const pages = ['#/overview', '#/live', `#/channel/${device}/pressure`, '#/alarms', '#/devices', '#/programming', `#/history?c=${device}/pressure&c=press-shop/press-2/pressure&span=1min`,
  '#/plan/press-shop', '#/audit', '#/dashboards', '#/dashboard/press?press=1', `#/reports?channel=${device}`];
let browser, page;

const settled = async () => {
  await page.waitForSelector('html[data-connection="open"]');
  await page.waitForFunction(() => document.querySelector('main .page')?.textContent.trim() !== '');
  await until(() => page.underWay === 0, 'answers of the station');
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
};
const go = async (hash) => {
  await page.evaluate((to) => { location.hash = to; }, hash);
  await settled();
};
const logIn = async (user) => {
  await page.waitForSelector('#user');
  await page.fill('#user', user);
  await page.fill('#password', password);
  await page.press('#password', 'Enter');
  await settled();
};
const says = (selector, pattern, what, within_ms) =>
  until(async () => pattern.test(await page.locator(selector).first().textContent().catch(() => '')), what, within_ms);
const post = (path, body) => page.evaluate(async ([to, what]) => {
  const response = await fetch(to, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(what) });
  return { status: response.status, body: await response.json() };
}, [path, body]);
const dashboard = JSON.stringify({ name: 'press', title: 'Press ${press}', parameters: [{ name: 'press', default: '1', values: ['1', '2'] }], widgets: [
  { kind: 'number', at: [0, 0, 4, 3], title: 'Pressure', channel: 'press-shop/press-${press}/pressure' },
  { kind: 'trend', at: [4, 0, 8, 6], title: 'Pressures', channels: ['press-shop/press-1/pressure', 'press-shop/press-2/pressure'], span: '1min' },
  { kind: 'button', at: [0, 3, 4, 3], title: 'Press', channel: 'press-shop/press-${press}/running', value: false, text: 'Stop', verify: true },
  { kind: 'picture', at: [0, 6, 12, 6], title: 'Hall', picture: 'hall', values: [{ channel: 'press-shop/press-${press}/pressure', x: 40, y: 50, size: 10 }] }] });
const hall = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 300 100" onload="document.title=1"><script>alert(1)</script><rect width="300" height="100" fill="#dde3e8"/></svg>';
const write = async (channel, value) => {
  await go(`#/channel/${device}/${channel}`);
  if (await page.locator('select#new-value').count()) await page.selectOption('#new-value', String(value));
  else await page.fill('#new-value', String(value));
  await page.getByRole('button', { name: 'Write' }).click();
  await page.locator('dialog').getByRole('button', { name: 'Write' }).click();
};

before(async () => {
  browser = await startBrowser(modules, address);
  page = await browser.open('#/overview', { ignore: /40[0139]|WebSocket|ERR_|api\/plan/ });
});
after(() => browser?.close());

test('without a login nothing is shown, a wrong password is refused', async () => {
  await page.waitForSelector('#user');
  await page.fill('#user', 'anna');
  await page.fill('#password', 'wrong');
  await page.press('#password', 'Enter');
  await says('.trouble', /wrong/, 'refused');
  assert.equal((await page.request.get(`${address}/api/catalogue`)).status(), 401);
});

test('a viewer sees values and may not write', async () => {
  await logIn('vera');
  await go(`#/channel/${device}/setpoint`);
  await says('.commands', /needs the role operator/, 'no write');
  const refused = await page.evaluate(async (channel) => {
    const answer = await fetch('/api/commands', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ channel, value: 1, verify: true }) });
    await answer.text();
    return answer.status;
  }, `${device}/setpoint`);
  assert.equal(refused, 403);
  for (const [path, body] of [['dashboards/check', { text: dashboard }], ['dashboards/save', { text: dashboard, base: 0 }], ['dashboards/delete', { name: 'press', base: 0 }],
    ['pictures/save', { name: 'hall', data: btoa('<svg viewBox="0 0 1 1"/>') }], ['pictures/delete', { name: 'hall' }]])
    assert.equal((await post(`/api/${path}`, body)).status, 403, path);
  await page.getByRole('button', { name: 'Log out' }).click();
});

test('an engineer makes a dashboard with a picture', async () => {
  await logIn('erik');
  const picture = await post('/api/pictures/save', { name: 'hall', data: Buffer.from(hall).toString('base64') });
  assert.deepEqual([picture.status, picture.body.removed], [200, ['onload', 'script']]);
  assert.equal((await post('/api/dashboards/save', { text: dashboard, base: 0 })).body.version, 1);
  const conflict = await post('/api/dashboards/save', { text: dashboard, base: 0 });
  assert.deepEqual([conflict.status, conflict.body.error], [409, 'erik has saved version 1 of this dashboard']);
  assert.equal((await post('/api/dashboards/save', { text: dashboard.replace('[0,6,12,6]', '[0,6,13,6]'), base: 1 })).status, 400);
  await go('#/dashboards');
  await page.getByRole('link', { name: 'Press …' }).click();
  await page.getByRole('button', { name: 'Edit', exact: true }).click();
  await page.locator('.handle[aria-label^="Number"]').focus();
  await page.keyboard.press('Shift+ArrowUp');
  await page.getByRole('button', { name: 'Save', exact: true }).click();
  await says('.messages', /Version 2 is saved/, 'the second version');
  await page.getByRole('button', { name: 'Log out' }).click();
});

test('an operator uses it', async () => {
  await logIn('anna');
  await go('#/dashboard/press?press=1');
  await says('.k-number .w-value', /\d/, 'a value');
  const value = () => page.locator('.k-number .w-value').textContent();
  const first = await value();
  await until(async () => await value() !== first, 'the pressure moves');
  assert.equal(await page.getByRole('button', { name: 'Edit', exact: true }).count(), 0);
  await page.waitForFunction(() => document.querySelector('.mimic image')?.getBoundingClientRect().width > 0);
  await page.getByRole('button', { name: 'Stop' }).click();
  await page.locator('dialog').getByRole('button', { name: 'Write' }).click();
  await says('.k-button .w-outcome', /written and read back = false/, 'the outcome of the command');
  await page.getByRole('button', { name: 'Log out' }).click();
});

test('the overview shows the bus, planned beside measured', async () => {
  await logIn('anna');
  await go('#/overview');
  await says('.bus[aria-label="press-shop"]', /press-shop.*running/s, 'the bus runs');
  await says('.bus[aria-label="press-shop"] .planned .bar-number', /^[1-9]\d* %$/, 'a planned load');
  await says('.bus[aria-label="press-shop"] .measured .bar-number', /^[1-9]\d* %$/, 'a measured load');
});

test('live values move', async () => {
  await go('#/live?q=press-1/');
  await says('.tools .number', /^5 of 24$/, 'five channels of the press');
  const value = () => page.locator('.vrow', { hasText: `${device}/pressure` }).locator('.c-value').textContent();
  const first = await value();
  await until(async () => await value() !== first, 'the pressure moves');
});

test('a write goes through, is read back, and stands in the audit with its name', async () => {
  await write('setpoint', 1200);
  await says('.outcomes', /written and read back = 1200/, 'the result');
  await says('.big-value b', /^1200$/, 'the value');
  await write('running', true);
  await says('.outcomes', /written and read back = true/, 'the result');
  await go('#/audit');
  await says('main', /anna.*setpoint/s, 'the audit names who wrote');
});

test('a value beyond its limit raises an alarm, which is acknowledged', async () => {
  await write('setpoint', 1800);
  await says('.outcomes', /written and read back = 1800/, 'the result');
  await says('nav .count', /^1$/, 'one alarm asks for somebody');
  await go('#/alarms');
  await says('main', /setpoint/, 'the alarm is listed');
  await page.getByRole('checkbox', { name: /setpoint/ }).check();
  await page.getByRole('button', { name: /^Acknowledge( \(\d+\))? a$/ }).click();
  await page.locator('dialog').locator('input, textarea').first().fill('looked at it');
  await page.locator('dialog button[type="submit"]').click();
  await says('main', /Acknowledged: 1|looked at it/, 'acknowledged');
  await until(async () => await page.locator('nav .count').count() === 0, 'no alarm asks for anybody');
});

test('history shows what the station recorded', async () => {
  await go(`#/history?c=${device}/pressure&span=1min`);
  await says('table.plain tbody', /samples|points/, 'the store answers');
});

test('a report of the store is a table and a spreadsheet, and the document of the page is there', async () => {
  await go(`#/reports?channel=${device}/*`);
  await says('main tbody', /press-1\/pressure/, 'a row');
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('link', { name: 'XLSX' }).click()]);
  assert.equal(file.suggestedFilename(), 'report.xlsx');
  assert.match(readFileSync(await file.path()).toString('latin1'), /^PK/);
  const [shown] = await Promise.all([page.context().waitForEvent('page'), page.getByRole('link', { name: 'Docs' }).click()]);
  await until(async () => /# The station in the browser/.test(await shown.textContent('body')), 'the document');
  await shown.close();
});

test('every page: nothing clipped, no violation', async () => {
  const faults = [];
  for (const hash of pages) {
    await go(hash);
    faults.push(...[...await clipped(page), ...await browser.axe(page)].map((each) => `${hash}: ${each}`));
  }
  assert.deepEqual(faults, []);
});

test('pictures for the README', { skip: !screenshots }, async () => {
  for (const [name, hash, dark, width] of [['overview', pages[0]], ['live', pages[1], true], ['channel', `${pages[2]}?span=1min`], ['alarms', pages[3], true], ['history', pages[6]], ['plan', pages[7]],
    ['phone', pages[1], true, 390]]) {
    await page.setViewportSize({ width: width ?? 1120, height: width ? 720 : ({ channel: 660, live: 440, overview: 540 })[name] ?? 640 });
    await page.emulateMedia({ colorScheme: dark ? 'dark' : 'light' });
    await go(hash);
    // fills the trend; the tests' notices have expired
    await page.waitForTimeout(name === 'channel' ? 20_000 : 7000);
    await page.screenshot({ path: `${screenshots}/station-${name}.png` });
  }
});

test('a station that stops answering greys the page at once', async () => {
  await go('#/live');
  process.kill(Number(stationPid), 'SIGSTOP');
  try {
    await page.waitForSelector('html[data-connection="lost"]', { timeout: 9000 });
  } finally {
    process.kill(Number(stationPid), 'SIGCONT');
  }
  await settled();
});

test('no error was told to the console', () => assert.deepEqual(browser.faults, []));
