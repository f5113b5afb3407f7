// Tests dashboards in chromium with a mock station: every widget, the editor by pointer and keyboard, roles, a lost connection.
//
//   node dashboards_test.mjs PAGE_FILES NODE_MODULES

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { chromiumPath, clipped, startBrowser, until } from './browser.mjs';
import { startMock } from './mock_station.mjs';

const [files, modules] = process.argv.slice(2);
const skip = chromiumPath() ? false : 'chromium is not installed: tools/install.sh test';
let mock, guarded, browser;

before(async () => {
  if (skip) return;
  mock = await startMock({ files, modules, channels: 400, role: 'engineer' });
  guarded = await startMock({ files, modules, channels: 80, login: true });
  browser = await startBrowser(modules, `http://127.0.0.1:${mock.port}`);
});
after(async () => {
  await browser?.close();
  mock?.close();
  guarded?.close();
});

const shown = async (page, selector = '.board .w-value') => {
  await page.waitForSelector('html[data-connection="open"]');
  await page.waitForSelector(selector);
};
const edit = async (page) => {
  await shown(page);
  await page.getByRole('button', { name: 'Edit', exact: true }).click();
  await page.waitForSelector('.editor .handle');
};
const saved = (name) => JSON.parse(mock.dashboards.saved.get(name).text);
const copyOf = (name, as) => {
  const text = JSON.stringify({ ...saved(name), name: as });
  mock.dashboards.saved.set(as, { ...mock.dashboards.saved.get(name), name: as, version: 1, text });
};
const save = async (page, name, version) => {
  await page.getByRole('button', { name: 'Save', exact: true }).click();
  await until(() => mock.dashboards.saved.get(name)?.version === version, `version ${version} of ${name}`);
};

for (const [name, options] of [['wide and light', {}], ['on a phone in the dark', { width: 390, height: 800, dark: true }], ['in Chinese at 1024', { width: 1024, language: 'zh-CN' }]])
  test(`dashboards, ${name}: nothing clipped, no violation, no error`, { skip }, async () => {
    const page = await browser.open('#/dashboards', options);
    const faults = [];
    for (const [hash, selector] of [['#/dashboards', 'table.plain'], ['#/dashboard/pumps', '.mimic image'], ['#/dashboard/pumps?pump=02', '.chart canvas'], ['#/dashboard/none-such?kiosk', '.empty'], ['#/dashboard/pumps?edit', '.editor .handle']]) {
      await page.evaluate((to) => { location.hash = to; }, hash);
      await shown(page, selector);
      await until(() => page.underWay === 0, 'responses of the station');
      faults.push(...(await clipped(page)).map((each) => `${hash}: ${each}`), ...(options.language ? [] : await browser.axe(page)).map((each) => `${hash}: ${each}`));
      if (options.language) assert.match(await page.textContent('main'), /[\u4e00-\u9fff]/);
      else assert.doesNotMatch(await page.textContent('main'), /[\u4e00-\u9fff]/);
    }
    await page.context().close();
    assert.deepEqual([...faults, ...browser.faults.filter((each) => !each.includes('none-such'))], []);
    browser.faults.length = 0;
  });

test('one dashboard shows the pump that was chosen', { skip }, async () => {
  const page = await browser.open('#/dashboard/pumps?pump=02');
  await shown(page);
  assert.match(await page.textContent('h1'), /Pump 02/);
  assert.equal(await page.locator('a[href="#/channel/boiler-house/device-02/flow-1"]').first().textContent(), 'Flow');
  await page.getByRole('combobox', { name: 'Pump', exact: true }).selectOption('03');
  await until(() => page.url().endsWith('#/dashboard/pumps?pump=03'), 'the address has the parameter');
  assert.equal(await page.getByRole('link', { name: /Boiler house/ }).getAttribute('href'), '#/dashboard/pumps?pump=03');
  await shown(page, 'a[href="#/channel/boiler-house/device-03/flow-1"]');
  assert.equal(await page.locator('.k-table a[title="boiler-house/device-03/energy-1"]').textContent(), 'energy-1');
  await page.context().close();
});

test('each widget shows quality and age, and none looks current after the connection was lost', { skip }, async () => {
  const page = await browser.open('#/dashboard/pumps', { ignore: /WebSocket|ERR_/ });
  await shown(page);
  const flow = mock.plant.byPath.get('boiler-house/device-01/flow-1');
  const state = page.locator('.k-number .w-state');
  assert.match(await state.textContent(), /good/);
  assert.equal(await page.locator('.k-number.stale').count(), 0);
  assert.ok(await page.locator('.widget.stale').count() > 0, 'the channel without a response');
  flow.quality = 3;
  await until(async () => /bad frame/.test(await state.textContent()), 'the quality is shown');
  assert.equal(await page.locator('.k-number.stale').count(), 1);
  flow.quality = 0;
  await until(async () => await page.locator('.k-number.stale').count() === 0, 'the value is current again');
  mock.refuse = true;
  mock.dropClients();
  await page.waitForSelector('html[data-connection="lost"]');
  const styles = await page.locator('.k-number .w-value').evaluate((each) => [getComputedStyle(each).fontStyle, getComputedStyle(each.closest('main')).filter]);
  assert.deepEqual(styles, ['italic', 'grayscale(1)']);
  await until(async () => /\d s/.test(await state.textContent()) && await page.locator('.k-number.stale').count() === 1, 'the age grows without a connection');
  mock.refuse = false;
  await page.context().close();
});

test('a command asks first, and its outcome is shown', { skip }, async () => {
  const page = await browser.open('#/dashboard/pumps');
  await shown(page);
  const before = mock.writes.length;
  await page.getByRole('button', { name: 'Stop' }).click();
  await page.getByRole('button', { name: 'Cancel' }).click();
  assert.equal(mock.writes.length, before);
  await page.getByRole('button', { name: 'Stop' }).click();
  assert.match(await page.textContent('dialog'), /boiler-house\/device-01\/running-1[\s\S]*true becomes false/);
  await page.locator('dialog .danger').click();
  await until(async () => /written and read back/.test(await page.textContent('.k-button .w-outcome')), 'the outcome');
  assert.deepEqual(mock.writes.at(-1), { user: 'local', channel: 'boiler-house/device-01/running-1', value: false });
  await page.fill('.k-setpoint input', '9000');
  await page.press('.k-setpoint input', 'Enter');
  await until(async () => /must be 0 to 3000/.test(await page.textContent('.k-setpoint .w-outcome')), 'the range');
  await page.fill('.k-setpoint input', '1500');
  await page.press('.k-setpoint input', 'Enter');
  await page.locator('dialog .danger').click();
  await until(() => mock.writes.at(-1).value === 1500, 'the set-point is written');
  await page.context().close();
});

test('the keyboard moves, resizes and removes widgets, and the text follows', { skip }, async () => {
  copyOf('wall', 'keys');
  const page = await browser.open('#/dashboard/keys');
  await edit(page);
  await page.locator('.handle').focus();
  for (const key of ['ArrowRight', 'ArrowRight', 'ArrowDown', 'Shift+ArrowRight', 'Shift+ArrowUp']) await page.keyboard.press(key);
  assert.match(await page.locator('.handle').getAttribute('aria-label'), /column 3, row 2, 5 × 2/);
  assert.deepEqual(JSON.parse(await page.inputValue('textarea')).widgets[0].at, [2, 1, 5, 2]);
  await save(page, 'keys', 2);
  assert.deepEqual(saved('keys').widgets[0].at, [2, 1, 5, 2]);
  await shown(page);
  await edit(page);
  await page.locator('.handle').focus();
  await page.keyboard.press('Delete');
  assert.equal(await page.locator('.handle').count(), 0);
  await page.getByRole('button', { name: 'Undo' }).click();
  assert.equal(await page.locator('.handle').count(), 1);
  await page.context().close();
});

test('the handle keeps the focus while its widget passes others and grows', { skip }, async () => {
  copyOf('pumps', 'focus');
  const page = await browser.open('#/dashboard/focus');
  await edit(page);
  await page.locator('.handle[aria-label^="Number"]').focus();
  for (const key of ['ArrowDown', 'ArrowDown', 'ArrowDown', 'ArrowDown', 'Shift+ArrowDown', 'Shift+ArrowDown']) await page.keyboard.press(key);
  assert.match(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), /^Number Flow: column 1, row 6, 3 × 4/);
  assert.equal(await page.locator('.k-number').count(), 1);
  await page.context().close();
});

test('a value is placed on a picture by a click', { skip }, async () => {
  copyOf('pumps', 'place');
  const page = await browser.open('#/dashboard/place', { height: 1400 });
  await edit(page);
  await page.locator('.handle[aria-label^="Picture"]').focus();
  await page.getByRole('button', { name: 'Place', exact: true }).first().click();
  const box = await page.locator('.mimic image').boundingBox();
  await page.mouse.click(box.x + box.width * 0.75, box.y + box.height * 0.25);
  await save(page, 'place', 2);
  const [first, second] = saved('place').widgets.at(-1).values;
  assert.ok(Math.abs(first.x - 75) < 1 && Math.abs(first.y - 25) < 1, JSON.stringify(first));
  assert.deepEqual([second.x, second.y], [60, 40]);
  await page.context().close();
});

test('the pointer drags a widget, and pushes another one away', { skip }, async () => {
  copyOf('pumps', 'drag');
  const page = await browser.open('#/dashboard/drag', { height: 1000 });
  await edit(page);
  const box = await page.locator('.handle[aria-label^="Number"]').boundingBox();
  await page.mouse.move(box.x + 30, box.y + 30);
  await page.mouse.down();
  await page.mouse.move(box.x + 30 + box.width, box.y + 32, { steps: 6 });
  await page.mouse.up();
  await save(page, 'drag', 2);
  const at = (kind) => saved('drag').widgets.find((widget) => widget.kind === kind).at;
  assert.deepEqual(at('number'), [3, 1, 3, 2]);
  assert.deepEqual(at('gauge'), [3, 3, 3, 4]);
  await page.context().close();
});

test('widgets are added, and changed by form and by text', { skip }, async () => {
  copyOf('wall', 'form');
  const page = await browser.open('#/dashboard/form');
  await edit(page);
  await page.getByLabel('Add a widget').selectOption('gauge');
  await page.getByLabel('Channel *').fill('boiler-house/device-02/pres');
  await until(async () => await page.locator('#channel-names option').count() > 0, 'channels are proposed');
  assert.match(await page.locator('#channel-names option').first().getAttribute('value'), /device-02\/pres/);
  await page.getByLabel('Channel *').fill('boiler-house/device-02/pressure-1');
  await page.getByLabel('Maximum *').fill('60');
  await page.getByLabel('Title', { exact: true }).fill('New gauge');
  await page.keyboard.press('Tab');
  await until(async () => /New gauge/.test(await page.textContent('.board')), 'the widget has its title');
  const text = JSON.parse(await page.inputValue('textarea'));
  assert.deepEqual(text.widgets[1], { kind: 'gauge', at: [4, 0, 3, 4], channel: 'boiler-house/device-02/pressure-1', min: 0, max: 60, title: 'New gauge' });
  text.widgets[1].title = 'By text';
  await page.fill('textarea', JSON.stringify(text));
  await until(async () => /By text/.test(await page.textContent('.board')), 'the text is applied');
  mock.dashboards.faults = [{ place: 'widgets[1].max', what: "'x' is not allowed", allowed: 'a number' }];
  await page.fill('textarea', JSON.stringify({ ...text, title: 'Broken' }));
  await until(async () => /widgets\[1\]\.max: 'x' is not allowed/.test(await page.textContent('.faults')), 'the fault is shown with its place');
  assert.ok(await page.getByRole('button', { name: 'Save', exact: true }).isDisabled());
  mock.dashboards.faults = [];
  await page.fill('textarea', JSON.stringify({ ...text, title: 'Whole' }));
  await until(async () => !await page.getByRole('button', { name: 'Save', exact: true }).isDisabled(), 'the fault is corrected');
  await save(page, 'form', 2);
  assert.equal(saved('form').title, 'Whole');
  await page.context().close();
});

test('a change made while a save is in flight is not saved, and stays', { skip }, async () => {
  copyOf('wall', 'three');
  const page = await browser.open('#/dashboard/three');
  await edit(page);
  let answer;
  const held = new Promise((resolve) => { answer = resolve; });
  await page.route('**/api/dashboards/save', async (route) => {
    await held;
    await route.continue();
  });
  await page.locator('.handle').focus();
  await page.keyboard.press('ArrowRight');
  await Promise.all([page.waitForRequest('**/api/dashboards/save'), page.getByRole('button', { name: 'Save', exact: true }).click()]);
  await page.locator('.handle').focus();
  await page.keyboard.press('ArrowRight');
  answer();
  await until(async () => /Version 2 is saved/.test(await page.textContent('body')), 'the first change is saved');
  assert.match(await page.locator('.handle').getAttribute('aria-label'), /column 3/);
  assert.equal(await page.getByRole('button', { name: 'Discard changes' }).count(), 1);
  await save(page, 'three', 3);
  assert.equal(saved('three').widgets[0].at[0], 2);
  await page.context().close();
});

test('the second of two engineers sees the conflict and keeps the draft', { skip }, async () => {
  copyOf('wall', 'two');
  const page = await browser.open('#/dashboard/two', { ignore: /409/ });
  await edit(page);
  mock.dashboards.saved.get('two').version = 5;
  await page.locator('.handle').focus();
  await page.keyboard.press('ArrowRight');
  await page.getByRole('button', { name: 'Save', exact: true }).click();
  await until(async () => /erik has saved version 5/.test(await page.textContent('.faults')), 'the conflict');
  assert.equal(await page.locator('.handle').count(), 1);
  await page.evaluate(() => { location.hash = '#/overview'; });
  await page.waitForSelector('.page.overview');
  await page.evaluate(() => { location.hash = '#/dashboard/two'; });
  await page.waitForSelector('.editor .handle');
  assert.match(await page.locator('.handle').getAttribute('aria-label'), /column 2/);
  await page.getByRole('button', { name: 'Discard changes' }).click();
  await shown(page, '.page.dashboard > .board');
  await page.context().close();
});

test('an engineer makes and deletes dashboards and uploads pictures', { skip }, async () => {
  const page = await browser.open('#/dashboards', { ignore: /404/ });
  await shown(page, 'table.plain');
  await page.locator('form').first().getByRole('textbox').fill('fresh');
  await page.getByRole('button', { name: 'New dashboard' }).click();
  await page.waitForSelector('.editor');
  await page.getByLabel('Add a widget').selectOption('text');
  await page.waitForSelector('.handle');
  await save(page, 'fresh', 1);
  await page.evaluate(() => { location.hash = '#/dashboards'; });
  await page.getByRole('button', { name: 'Delete fresh' }).click();
  await page.locator('dialog .danger').click();
  await until(() => !mock.dashboards.saved.has('fresh'), 'the dashboard is deleted');
  await page.setInputFiles('input[type="file"]', { name: 'Boiler House.svg', mimeType: 'image/svg+xml', buffer: Buffer.from('<svg viewBox="0 0 1 1"/>') });
  await page.getByRole('button', { name: 'Upload' }).click();
  await until(async () => /Not copied from the SVG: script/.test(await page.textContent('.messages')), 'what was removed is reported');
  assert.ok(mock.dashboards.pictures.has('boiler-house'));
  await page.context().close();
});

test('viewers look; they can neither edit nor command', { skip }, async () => {
  const page = await browser.open('#/dashboard/pumps?edit', { base: `http://127.0.0.1:${guarded.port}`, ignore: /401|403/ });
  await page.fill('#user', 'vera');
  await page.fill('#password', 'secret secret');
  await page.press('#password', 'Enter');
  await page.evaluate(() => { location.hash = '#/dashboard/pumps?edit'; });
  await shown(page);
  assert.equal(await page.locator('.editor').count(), 0);
  assert.equal(await page.getByRole('button', { name: 'Edit', exact: true }).count(), 0);
  assert.ok(await page.getByRole('button', { name: 'Stop' }).isDisabled());
  assert.equal(await page.locator('.k-setpoint form').count(), 0);
  await page.evaluate(() => { location.hash = '#/dashboards'; });
  await shown(page, 'table.plain');
  assert.equal(await page.locator('form').count(), 0);
  assert.equal(await page.evaluate(async () => (await fetch('/api/dashboards/save', { method: 'POST', body: '{}' })).status), 403);
  await page.context().close();
});

test('script in titles, texts and units is shown as text', { skip }, async () => {
  const script = '<img src=x onerror="document.title=1">';
  mock.plant.byPath.get('boiler-house/device-01/flow-2').kind.unit = script;
  mock.dashboards.saved.set('hostile', { ...mock.dashboards.saved.get('wall'), name: 'hostile', text: JSON.stringify({ name: 'hostile', title: script, widgets: [
    { kind: 'text', at: [0, 0, 6, 1], text: script }, { kind: 'number', at: [0, 1, 6, 3], title: script, channel: 'boiler-house/device-01/flow-2' },
    { kind: 'lamp', at: [6, 1, 6, 3], channel: 'boiler-house/device-01/running-1', states: [{ value: true, text: script }, { value: false, text: script }] },
    { kind: 'constructor', at: [0, 4, 2, 2] }, { kind: 'table', at: [2, 4, 2, 2] }] }) });
  const page = await browser.open('#/dashboard/hostile');
  await shown(page);
  assert.equal(await page.locator('main img').count(), 0);
  assert.ok((await page.textContent('h1')).includes(script));
  assert.ok((await page.textContent('.k-lamp')).includes(script));
  assert.equal(await page.locator('.incomplete').count(), 2, 'an unknown kind and a table without a pattern harm nobody');
  await page.context().close();
  assert.deepEqual(browser.faults, []);
});

test('a wall screen shows dashboards in turn', { skip }, async () => {
  const page = await browser.open('#/dashboard/pumps?pump=01&kiosk=dashboard/pumps;pump=01,dashboard/pumps;pump=02&every=3');
  await shown(page);
  assert.equal(await page.getByRole('button', { name: 'Edit', exact: true }).count(), 0);
  await until(() => /pump=02/.test(page.url().split('kiosk')[0]), 'the second pump');
  await shown(page, 'a[href="#/channel/boiler-house/device-02/flow-1"]');
  await page.context().close();
});
