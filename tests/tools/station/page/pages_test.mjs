// Tests user actions on the pages for alarms, devices, programming, the plan and the audit, in
// chromium with a mock station.
//
//   node pages_test.mjs PAGE_FILES NODE_MODULES

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { chromiumPath, clipped, says, settled, startBrowser, until } from './browser.mjs';
import { startMock } from './mock_station.mjs';

const [files, modules] = process.argv.slice(2);
const pages = ['#/alarms/history', '#/devices/press-shop/device-03', '#/programming/press-shop/device-01', '#/plan/water-works', '#/audit/users', '#/plan/no-such-bus', '#/devices/no/such'];
const skip = chromiumPath() ? false : 'chromium is not installed: tools/install.sh test';
let mock, guarded, browser;

before(async () => {
  if (skip) return;
  mock = await startMock({ files, modules, channels: 400 });
  guarded = await startMock({ files, modules, login: true, channels: 80 });
  browser = await startBrowser(modules, `http://127.0.0.1:${mock.port}`);
});
after(async () => {
  await browser?.close();
  mock?.close();
  guarded?.close();
});

const go = async (page, hash) => {
  await page.evaluate((to) => { location.hash = to; }, hash);
  await settled(page);
};
const open = async (hash, options) => {
  const page = await browser.open(hash, options);
  await settled(page);
  return page;
};
const row = (page, text) => page.locator('.vbody .vrow:not([hidden])', { hasText: text });
const saved = async (page) => {
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'CSV' }).click()]);
  return { name: file.suggestedFilename(), text: readFileSync(await file.path(), 'utf8') };
};

for (const [name, options] of [['on a phone', { width: 390, height: 800 }], ['in Chinese and dark at 1000', { width: 1000, dark: true, language: 'zh-CN' }]])
  test(`pages of one thing, ${name}: nothing clipped, no violation`, { skip }, async () => {
    const page = await browser.open('#/overview', { ...options, ignore: /404/ });
    const faults = [];
    for (const hash of pages) {
      await go(page, hash);
      faults.push(...[...await clipped(page), ...await browser.axe(page)].map((each) => `${hash}: ${each}`));
    }
    await page.context().close();
    assert.deepEqual(faults, []);
  });

test('the overview names a bridge whose clock differs', { skip }, async () => {
  const [bus, other] = mock.plant.buses;
  bus.clock_ahead_ms = -12_000;
  other.clock_ahead_ms = 3;
  const page = await open('#/overview');
  await says(page, '.card.bus', /The clock of this station is 12 s behind the clock of bridge north/);
  assert.equal(await page.locator('.card.bus', { hasText: 'behind the clock' }).count(), 1);
  await says(page, '.card.bus', /Clock offset\s*\+3/);
  delete bus.clock_ahead_ms;
  delete other.clock_ahead_ms;
  await page.context().close();
});

test('the overview names bridges that claim a bus of another bridge', { skip }, async () => {
  const [bus] = mock.plant.buses;
  const claim = (bridge, serving) => ({ ...mock.plant.bridges[0], bridge, host: `host-${bridge}`, buses: [{ bus: bus.bus, since_ms: 1, serving }] });
  mock.plant.bridges.push(claim('east', true), claim('west', false));
  const page = await open('#/overview');
  await says(page, '.card.bus', /Contested: east \(host-east\) also claims to serve/);
  await says(page, '.card.bus', /west \(host-west\) has a bus of this name and does not serve it/);
  assert.equal(await page.locator('.card.bus', { hasText: 'east' }).count(), 1);
  mock.plant.bridges.splice(-2);
  await page.context().close();
});

test('alarms that want somebody come first and are counted in the head and in the tab', { skip }, async () => {
  const page = await open('#/alarms');
  assert.match(await page.title(), /^\(2\) Alarms/);
  assert.equal(await page.textContent('nav .count'), '2');
  const first = page.locator('.vrow[aria-rowindex="2"]'), second = page.locator('.vrow[aria-rowindex="3"]');
  assert.match(await first.textContent(), /critical.*unacknowledged.*high-high/s);
  assert.match(await second.textContent(), /medium.*returned, unacknowledged/s);
  assert.match(await second.textContent(), /7×/);
  assert.match(await page.locator('.s-shelved').textContent(), /until .*anna · sensor is changed on Monday/s);
  assert.match(await page.locator('.s-maintenance').textContent(), /maintenance/);
  await page.keyboard.press('/');
  await page.keyboard.type('pressure-1');
  await until(async () => await page.locator('.vbody .vrow:visible').count() === 1, 'the filter');
  await page.context().close();
});

test('an alarm is acknowledged by keys, with a note', { skip }, async () => {
  const page = await open('#/alarms');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('a');
  assert.match(await page.textContent('dialog'), /pressure-1 low/);
  await page.keyboard.type('sensor is loose');
  await page.keyboard.press('Enter');
  await says(page, '.messages', /Acknowledged: 1/);
  await until(async () => await page.title() === '(1) Alarms · Fieldcast', 'one alarm less');
  assert.equal(mock.plant.alarms.find((alarm) => alarm.channel === 'pressure-1').note, 'sensor is loose');
  await page.context().close();
});

test('a note has at most 256 bytes, also in Chinese', { skip }, async () => {
  const page = await open('#/alarms');
  await page.getByRole('checkbox', { name: /temperature-1/ }).check();
  await page.keyboard.press('s');
  const note = page.locator('dialog input[name="note"]');
  await note.fill('报'.repeat(86));
  assert.match(await note.evaluate((field) => field.validationMessage), /At most 256 bytes/);
  await page.locator('dialog button[type="submit"]').click();
  assert.equal(await page.locator('dialog').count(), 1, 'the note is kept and can be shortened');
  await note.fill('报'.repeat(85) + '.');
  assert.equal(await note.evaluate((field) => field.validationMessage), '');
  await page.context().close();
});

test('the link of a message leads to its alarm, and messages that failed are listed', { skip }, async () => {
  const page = await open('#/alarms?alarm=press-shop%2Fdevice-01%2Fpressure-1%2Flow');
  assert.equal(await page.inputValue('input.filter'), 'press-shop/device-01/pressure-1');
  mock.plant.messages = { waiting: 1, sent: 0, failed: 3, lost: 2, targets: [{ name: 'crew', kind: 'mail', sent_ms: null, error: 'no route' }],
    rules: [{ name: 'night', to: ['crew'], patterns: ['press-shop/*/*'], priority: 'high', hours: ['mon-fri 18:00-06:00', 'sat-sun'], delay_ms: 30000, repeat_ms: 900000, repeats: 10, cleared: true,
      escalate: [{ after_ms: 1800000, to: ['chief'] }], digest: 10, digest_within_ms: 300000 }],
    messages: [{ id: 'a', target: 'crew', recipient: 'ann@plant.example', subject: 'ALARM <b>x</b>', state: 'waiting', made_ms: Date.now(), done_ms: null, attempts: 3, error: 'no route' }] };
  await page.click('button:has-text("Messages")');
  await page.waitForSelector('dialog td');
  const text = await page.textContent('dialog');
  for (const part of ['Waiting: 1, lost: 2', '▲ crew', 'ann@plant.example', 'ALARM <b>x</b>', 'waiting (3×) no route', 'night → crew: press-shop/*/* · priority high or higher · mon-fri 18:00-06:00, sat-sun · after 30 s · again every 15 min, at most 10 times · after 30 min also chief',
    'An administrator changes the rules']) assert.ok(text.includes(part), `${part}: ${text}`);
  assert.equal(await page.locator('dialog button:has-text("Send a test")').count(), 0, 'an operator sends none');
  assert.deepEqual(await browser.axe(page), []);
  await page.keyboard.press('Enter');
  await until(async () => await page.locator('dialog').count() === 0, 'the dialog is closed');
  await page.context().close();
});

test('alarms are shelved with an end, and taken back', { skip }, async () => {
  const page = await open('#/alarms');
  await page.getByRole('checkbox', { name: /temperature-1/ }).check();
  await page.getByRole('checkbox', { name: /temperature-2/ }).check();
  await page.keyboard.press('s');
  assert.match(await page.textContent('dialog'), /Shelve \(2\)/);
  await page.selectOption('dialog select', '240');
  await page.locator('dialog button[type="submit"]').click();
  await says(page, '.messages', /Shelved for 4 h: 2/);
  const end = mock.plant.alarms.find((alarm) => alarm.channel === 'temperature-1').shelved_until_ms;
  assert.ok(Math.abs(end - Date.now() - 4 * 3_600_000) < 60_000);
  await until(async () => await page.title() === 'Alarms · Fieldcast', 'no alarm wants anybody');
  await page.getByRole('button', { name: /^Shelved/ }).click();
  await page.getByRole('checkbox', { name: /temperature-1/ }).check();
  await page.keyboard.press('u');
  await says(page, '.messages', /No longer shelved: 1/);
  await until(async () => await page.title() === '(1) Alarms · Fieldcast', 'it wants somebody again');
  await page.context().close();
});

test('what the station does not do is said with its reason', { skip }, async () => {
  const page = await open('#/alarms');
  mock.failActions = { state: 'failed', cause: 'OFFLINE', reason: 'no bridge has this bus' };
  await page.getByRole('checkbox', { name: /temperature-1/ }).check();
  await page.keyboard.press('a');
  await page.locator('dialog button[type="submit"]').click();
  await says(page, '.message.bad', /failed\. no bridge has this bus/);
  mock.failActions = undefined;
  await page.context().close();
});

// Regression: it was acknowledged, and nobody had seen it.
test('an alarm that is raised again while the dialog is open is not acknowledged', { skip }, async () => {
  const page = await open('#/alarms');
  const alarm = mock.plant.alarms.find((each) => each.channel === 'temperature-1');
  await page.getByRole('checkbox', { name: /temperature-1/ }).check();
  await page.keyboard.press('a');
  await says(page, 'dialog', /temperature-1/);
  const before = { ...alarm };
  Object.assign(alarm, { raised_ns: '1764360000123456790', value: 99.5 });
  mock.tell({ kind: 'alarm', ...alarm });
  await says(page, '.vbody', /99\.5/);
  await page.locator('dialog button[type="submit"]').click();
  await says(page, '.message.bad', /the alarm was raised again since then/);
  assert.equal(alarm.state, before.state);
  mock.tell({ kind: 'alarm', ...Object.assign(alarm, before) });
  await page.context().close();
});

test('the history of alarms is a table and a CSV', { skip }, async () => {
  const page = await open('#/alarms/history?span=1h');
  await says(page, '.vbody', /sensor is loose/);
  const { name, text } = await saved(page);
  assert.equal(name, 'alarms.csv');
  assert.match(text, /at,event,bus,device,channel,limit,value,who,note,until/);
  assert.match(text, /,acknowledged,boiler-house,device-01,pressure-1,low,,local,sensor is loose,/);
  await page.fill('.filter', 'shelved');
  await says(page, '.tools [role="status"]', /^[12] entries/);
  await page.fill('input[name="from"]', '2020-01-01T00:00:01');
  await page.getByRole('button', { name: 'Show' }).click();
  await until(() => /from=157\d+/.test(page.url()), 'the range is in the address');
  await page.context().close();
});

test('a device tells its state, the reason and what was learned; maintenance goes on and off', { skip }, async () => {
  const page = await open('#/devices');
  assert.match(await page.locator('.vrow[aria-rowindex="2"]').textContent(), /degraded.*boiler-house\/device-03.*refuses 2 addresses/s);
  assert.match(await row(page, 'press-shop/device-01').textContent(), /programmed by otto/);
  await row(page, 'boiler-house/device-01').click();
  await says(page, '.device', /in maintenance/);
  await page.keyboard.press('m');
  await says(page, '.messages', /maintenance has ended/);
  await page.keyboard.press('m');
  await page.selectOption('dialog select', '60');
  await page.locator('dialog button[type="submit"]').click();
  await says(page, '.messages', /in maintenance for 1 h/);
  await until(() => mock.plant.alarms.every((alarm) => alarm.suppressed), 'its alarms are suppressed');
  await go(page, '#/devices/press-shop/device-03');
  await says(page, '.device', /holding:107.*holding:105\.\.107.*no response 36/s);
  await page.context().close();
});

test('programming says who, what rests, and gives the command', { skip }, async () => {
  const page = await open('#/programming');
  assert.match(await page.locator('.vrow[aria-rowindex="2"]').textContent(), /programming.*press-shop\/device-01.*otto@10\.0\.0\.7.*48\.2 kB.*190\.3 kB/s);
  await row(page, 'utilities/device-02').click();
  await says(page, '.device', /whole bus utilities: 3 devices/);
  assert.equal(await page.textContent('.command'), 'fieldcast-port --server plc-south:4950 --device device-02 --link /tmp/plc');
  await page.fill('input[name="number"]', 'P 7');
  await page.fill('input[name="user"]', 'anna');
  await page.getByText('By TLS').click();
  assert.equal(await page.textContent('.command'), "fieldcast-port --server plc-south:4950 --tls --user anna --password-file anna.password --device 'P 7' --link /tmp/plc");
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.getByRole('button', { name: 'Copy' }).click();
  await says(page, '.messages', /in the clipboard/);
  assert.match(await page.evaluate(() => navigator.clipboard.readText()), /--device 'P 7'/);
  await page.reload();
  await settled(page);
  assert.match(await page.textContent('.command'), /'P 7'/);
  await page.context().close();
});

test('an operator ends a programming session, with a warning and a note', { skip }, async () => {
  const page = await open('#/programming/press-shop/device-01');
  await page.getByRole('button', { name: 'End the session' }).click();
  await says(page, 'dialog', /otto@10\.0\.0\.7 loses the connection at once.*can leave the PLC stopped/);
  await page.fill('dialog input[name="note"]', 'the night shift starts');
  await page.locator('dialog button[type="submit"]').click();
  await says(page, '.messages', /session of press-shop\/device-01 was ended/);
  await until(() => mock.plant.sessions[0].state === 'closed', 'the session is closed');
  assert.equal(mock.plant.audit[0].what, 'end programming session: the night shift starts');
  await until(async () => (await page.getByRole('button', { name: 'End the session' }).count()) === 0, 'nothing is left to end');
  await page.context().close();
});

test('the plan shows each read; hovering and arrows tell its channels', { skip }, async () => {
  const page = await open('#/plan/press-shop');
  await says(page, '.plan-loads', /Free on the wire\s*54 %/);
  assert.equal(await page.locator('.plan-row').count(), 6);
  const marks = await page.locator('.plan-row').nth(1).locator('.plan-marks').getAttribute('d');
  assert.equal(marks.split('M').length - 1, 8);
  const details = () => page.textContent('.plan-details');
  assert.match(await details(), /device-01 coil 0\.\.7.*1 of 4.*running-1/s);
  const track = page.locator('.plan-row').nth(1).locator('.plan-track');
  const box = await track.boundingBox();
  await page.mouse.move(box.x + box.width * (17 + 94) / 752, box.y + 20);
  await says(page, '.plan-details', /holding 100\.\.113.*2 of 8.*temperature-1 temperature-2 pressure-1/s);
  await page.keyboard.press('ArrowRight');
  await says(page, '.plan-details', /3 of 8.*Channels in this read: 2/s);
  await page.keyboard.press('ArrowDown');
  await says(page, '.plan-details', /device-02 coil/);
  await page.keyboard.press('+');
  await until(async () => (await track.boundingBox()).width > 1.9 * box.width, 'zoomed');
  mock.changePlan('press-shop', 0.7);
  await says(page, '.plan-loads', /Free on the wire\s*30 %/);
  await page.context().close();
});

test('the audit is filtered and saved; users are listed', { skip }, async () => {
  const page = await open('#/audit');
  await says(page, '.vbody', /refused: wrong password/);
  await says(page, '.vbody', /write 7/);
  await page.fill('.filter', 'program');
  const { text } = await saved(page);
  assert.match(text, /,program,press-shop\/device-01,48211,190332,done/);
  assert.doesNotMatch(text, /mallory/);
  await go(page, '#/audit/users');
  await says(page, 'table', /vera.*viewer.*look/s);
  await says(page, 'main', /fieldcast user add/);
  await page.context().close();
});

test('the audit shows what the store commits while it is open', { skip }, async () => {
  const page = await open('#/audit');
  await says(page, '.vbody', /write 7/);
  const entry = { at_ms: Date.now() - 5000, who: 'zoe', what: 'write 8', target: 'press-shop/device-01/c-1', bytes_to_device: 0, bytes_from_device: 0, result: 'done' };
  mock.plant.audit.unshift(entry);
  await says(page, '.vbody', /zoe/);
  mock.plant.audit.splice(mock.plant.audit.indexOf(entry), 1);
  await page.context().close();
});

test('a viewer sees alarms and cannot act on them, and has no audit', { skip }, async () => {
  const page = await browser.open('#/alarms', { base: `http://127.0.0.1:${guarded.port}`, ignore: /401|403|WebSocket/ });
  await page.fill('#user', 'vera');
  await page.fill('#password', 'secret secret');
  await page.press('#password', 'Enter');
  await settled(page);
  // the selection of a section, not the action
  assert.equal(await page.getByRole('button', { name: /^Acknowledge/ }).count(), 1);
  assert.equal(await page.locator('.acts').count(), 0);
  await page.keyboard.press('a');
  assert.equal(await page.locator('dialog').count(), 0);
  await go(page, '#/audit');
  assert.match(await page.textContent('main'), /needs the role operator/);
  await page.context().close();
});

test('no error was told to the console', { skip }, () => assert.deepEqual(browser.faults, []));
