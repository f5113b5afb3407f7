// Checks the page of a station that receives forged statuses, in chromium; forged_status.py starts the station and the forger.
//
//   node forged_status.mjs ADDRESS NODE_MODULES BROWSER_MJS BUS TEXTS_AS_JSON

import assert from 'node:assert/strict';

const [address, modules, browserModule, bus, textsJson] = process.argv.slice(2);
const { startBrowser, until } = await import(browserModule);
const texts = JSON.parse(textsJson);
const browser = await startBrowser(modules, address);
try {
  for (const hash of ['#/overview', '#/devices', '#/live', '#/programming', `#/plan/${bus}`]) {
    const page = await browser.open(hash, { ignore: /api\/plan/ });
    await page.waitForSelector('html[data-connection="open"]');
    await until(async () => (await page.locator('main .page').textContent()).trim() !== '', `${hash} shows nothing`);
    if (hash === '#/devices')
      for (const text of texts)
        await until(async () => (await page.locator('main').textContent()).includes(text), `the device ${JSON.stringify(text)}`);
    const found = await page.evaluate(() => ({
      run: window.forged, scripts: document.querySelectorAll('main script, main img, main iframe').length,
      text: document.body.innerText, html: document.body.outerHTML }));
    assert.equal(found.run, undefined, `${hash}: a text of the network was run`);
    assert.equal(found.scripts, 0, `${hash}: a text of the network became an element`);
    assert.doesNotMatch(found.html, /[\u202a-\u202e\u2066-\u2069]/, `${hash}: a mark that turns the writing direction`);
    assert.doesNotMatch(found.text, /● stopped/i, `${hash}: the state of the bus`);
    await page.context().close();
  }
  assert.deepEqual(browser.faults, []);
} finally {
  await browser.close();
}
