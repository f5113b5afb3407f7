// Ten tasks of operators and engineers in chromium with a mock station: counts the clicks and the seconds of each, and prints the table
// of tools/station/page/README.md. Each row begins on the Overview. A choice in a list counts as two clicks, typing as none. The
// seconds are those of the page and the browser, since a script neither reads nor thinks.
//
//   node tasks_test.mjs PAGE_FILES NODE_MODULES

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { chromiumPath, says, settled, startBrowser, until } from './browser.mjs';
import { firstText } from './mock_configuration.mjs';
import { startMock } from './mock_station.mjs';

const [files, modules] = process.argv.slice(2);
const skip = chromiumPath() ? false : 'chromium is not installed: tools/install.sh test';
const done = [];
let mock, browser, clicks;

before(async () => {
  if (skip) return;
  mock = await startMock({ files, modules, channels: 400, role: 'engineer' });
  browser = await startBrowser(modules, `http://127.0.0.1:${mock.port}`);
});
after(async () => {
  await browser?.close();
  mock?.close();
  if (!done.length) return;
  console.log('| task | clicks | seconds |\n| --- | --- | --- |');
  for (const { task, clicks: counted, seconds } of done) console.log(`| ${task} | ${counted} | ${seconds.toFixed(1)} |`);
});

const click = async (locator) => {
  clicks++;
  await locator.click();
};
const choose = async (locator, option) => {
  clicks += 2;
  await locator.selectOption(option);
};
const nav = (page, name) => click(page.locator('nav').getByRole('link', { name }));
const button = (page, name) => page.getByRole('button', { name, exact: true });
const bad = 'boiler-house/device-01/temperature-1';

async function deploy(page, why) {
  await until(() => button(page, 'Deploy …').isEnabled(), 'the draft may be deployed');
  await click(button(page, 'Deploy …'));
  await page.keyboard.type(why);
  await click(page.locator('dialog').getByRole('button', { name: 'Deploy' }));
  await says(page, '.watch', /is watched/);
}

// most: the largest number of clicks.
const tasks = [
  { task: 'acknowledge an alarm with a note', most: 4, run: async (page) => {
    await nav(page, /Alarms/);
    await click(page.locator('.vrow[aria-rowindex="2"]'));
    await page.keyboard.press('a');
    await page.keyboard.type('looked at it');
    await page.keyboard.press('Enter');
    await says(page, '.messages', /Acknowledged: 1/);
    assert.ok(mock.plant.alarms.some((alarm) => alarm.note === 'looked at it'));
  } },
  { task: 'who changed this set-point?', most: 3, run: async (page) => {
    await nav(page, 'Audit');
    await click(page.locator('.filter'));
    await page.keyboard.type('speed-setpoint-1');
    await says(page, '.audit-table .vbody', /anna from 10\.0\.0\.5.*write 7.*speed-setpoint-1.*written and read back/s);
  } },
  { task: 'find the cause of a bad channel', most: 3, run: async (page) => {
    await nav(page, 'Live');
    await click(page.getByLabel('Only bad'));
    await click(page.locator('.vbody .vrow:not([hidden])', { hasText: bad }).locator('.c-value'));
    await says(page, '.fault', /Since.*exchanges failed.*Power of the device/s);
  } },
  { task: 'make a dashboard with six values', most: 24, run: async (page) => {
    await nav(page, 'Dashboards');
    await click(page.locator('form').first().getByRole('textbox'));
    await page.keyboard.type('six');
    await click(page.getByRole('button', { name: 'New dashboard' }));
    for (let n = 1; n <= 6; n++) {
      await choose(page.getByLabel('Add a widget'), 'number');
      await click(page.getByLabel('Channel *'));
      await page.keyboard.type(`boiler-house/device-01/${n < 4 ? 'flow' : 'pressure'}-${1 + n % 3}`);
      await page.keyboard.press('Tab');
    }
    await until(() => button(page, 'Save').isEnabled(), 'the dashboard has no fault');
    await click(button(page, 'Save'));
    await until(() => mock.dashboards.saved.has('six'), 'the dashboard is saved');
    assert.equal(JSON.parse(mock.dashboards.saved.get('six').text).widgets.length, 6);
  } },
  { task: 'export eight channels', most: 4, run: async (page) => {
    await nav(page, 'History');
    for (let n = 0; n < 8; n++) {
      if (n === 0) await click(page.locator('#add-channel'));
      else await page.keyboard.press('/');
      await page.keyboard.type(`boiler-house/device-01/${n < 4 ? 'flow' : 'pressure'}-${1 + n % 4}`);
      await page.keyboard.press('Enter');
      await until(() => new URL(page.url().replace('#/', '')).searchParams.getAll('c').length === n + 1, `${n + 1} channels`);
      await settled(page);
    }
    const [file] = await Promise.all([page.waitForEvent('download'), click(page.getByRole('link', { name: 'Save as CSV' }))]);
    assert.equal(file.suggestedFilename().split('+').length, 8);
  } },
  { task: 'change a limit and deploy', most: 6, run: async (page) => {
    mock.configuration.text = firstText.replace('unit: °C }', 'unit: °C, limits: { high: 80 } }');
    await nav(page, 'Configuration');
    await says(page, '.faults [role="status"]', /No faults/);
    await click(page.locator('.yaml textarea'));
    await page.locator('.yaml textarea').evaluate((area) => {
      const at = area.value.indexOf('high: 80') + 6;
      area.setSelectionRange(at, at + 2);
    });
    await page.keyboard.type('85');
    await deploy(page, 'summer');
    await click(button(page, 'Confirm'));
    await says(page, '.watch', /confirmed by/);
    assert.match(mock.configuration.text, /high: 85/);
  } },
  { task: 'return to the version before', most: 4, run: async (page) => {
    await nav(page, 'Configuration');
    await click(page.getByRole('link', { name: 'Versions' }).or(button(page, 'Versions')));
    await click(page.getByRole('button', { name: /^Return to version/ }).last());
    await page.keyboard.type('as before');
    await page.keyboard.press('Enter');
    await until(() => mock.configuration.text === firstText, 'the former text is in force');
  } },
  { task: 'see the advice for an overloaded bus', most: 1, run: async (page) => {
    mock.planLoad = 2.5;
    await click(page.locator('.card.bus', { hasText: 'utilities' }).getByRole('link', { name: 'Read plan' }));
    await says(page, '.plan-advice', /2\.50 times as much.*Refresh less often.*needs the most/s);
    mock.planLoad = 0.46;
  } },
  { task: 'compare a channel with yesterday', most: 5, run: async (page) => {
    await nav(page, 'Live');
    await click(page.locator('.filter'));
    await page.keyboard.type('device-01/flow-2');
    await click(page.locator('.vbody .vrow:not([hidden])').first().locator('.c-value'));
    await click(page.getByRole('link', { name: 'Open in History' }));
    await click(button(page, '7 d'));  // yesterday and today in one trend
    await until(() => /span=7d/.test(page.url()), 'the last seven days');
    await settled(page);
    await says(page, 'tbody', /flow-2.*points of/s);
  } },
];

for (const { task, most, run } of tasks)
  test(task, { skip }, async () => {
    const page = await browser.open('#/overview', { ignore: /404.*api\/dashboard\?/ });  // a new dashboard does not exist yet
    await settled(page);
    clicks = 0;
    const begun = Date.now();
    await run(page);
    const seconds = (Date.now() - begun) / 1000;
    done.push({ task, clicks, seconds });
    assert.ok(clicks <= most, `${clicks} clicks`);
    await page.context().close();
  });

test('no error was told to the console', { skip }, () => assert.deepEqual(browser.faults, []));
