// Starts Debian's chromium for the tests, and has the checks that all pages share.
//
// THROTTLE=8 in the environment makes the scripts of the page eight times slower: a check that does
// not wait for the page fails.

import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';

const programs = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
const throttle = Number(process.env.THROTTLE ?? 1), patience_ms = 30_000;
export const chromiumPath = () => programs.find((path) => existsSync(path));

// Returns {open(path, options), close()}. `modules`: the node_modules of the tests.
export async function startBrowser(modules, address) {
  const { chromium } = createRequire(join(resolve(modules), 'x'))('playwright-core');
  const axeSource = readFileSync(join(resolve(modules), 'axe-core/axe.min.js'), 'utf8');
  const browser = await chromium.launch({ executablePath: chromiumPath(), args: ['--no-sandbox', '--disable-gpu'] });
  const faults = [];

  // Opens a page without cookies or settings of others. Keeps all errors of the console.
  async function open(hash, { width = 1280, height = 760, dark = false, language = 'en', base = address, ignore = /$^/ } = {}) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme: dark ? 'dark' : 'light', locale: language });
    const page = await context.newPage();
    page.setDefaultTimeout(patience_ms);
    if (throttle > 1) await (await context.newCDPSession(page)).send('Emulation.setCPUThrottlingRate', { rate: throttle });
    page.underWay = 0;
    page.on('request', () => page.underWay++);
    for (const end of ['requestfinished', 'requestfailed']) page.on(end, () => page.underWay--);
    page.on('console', (message) => {
      const told = `${message.text()} ${message.location().url}`;
      if (['error', 'warning'].includes(message.type()) && !ignore.test(told)) faults.push(`${page.url()}: ${told}`);
    });
    page.on('pageerror', (error) => faults.push(`${hash}: ${error.stack}`));
    await page.goto(`${base}/${hash}`);
    return page;
  }

  // Checks the rules of WCAG 2 A and AA and of good practice.
  async function axe(page) {
    await page.evaluate(`if (!window.axe) { ${axeSource} }`);
    const { violations } = await page.evaluate(() => window.axe.run(document, {
      runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'], resultTypes: ['violations'] }));
    return violations.map(({ id, nodes }) => `${id}: ${nodes.slice(0, 3).map((node) => `${node.html.slice(0, 160)} ${node.any[0]?.message ?? ''}`).join(' | ')}`);
  }

  return { open, axe, faults, inspect: () => browser.newBrowserCDPSession(), close: () => browser.close() };
}

// Finds truncated text, except in elements with data-scroll or a title.
export const clipped = (page) => page.evaluate(() => {
  const found = [];
  if (document.documentElement.scrollWidth > innerWidth) found.push('the page is wider than the window');
  for (const element of document.body.querySelectorAll('*')) {
    if (element.closest('svg, .unseen, .skip, option, datalist, canvas') || !element.checkVisibility() || element.closest('[hidden], [title]:not([title=""])')) continue;
    const style = getComputedStyle(element);
    const scrolls = element.hasAttribute('data-scroll') || element.matches('main');
    if (element.scrollWidth > element.clientWidth + 1 && element.clientWidth > 0 && style.overflowX !== 'visible' && !(scrolls && style.overflowX !== 'hidden'))
      found.push(`${element.tagName}.${element.className}: ${element.textContent.trim().slice(0, 60)} (${element.scrollWidth} > ${element.clientWidth})`);
    if (element.matches('main') && element.scrollWidth > element.clientWidth + 1) found.push(`main is wider than its window`);
  }
  return found;
});

// Waits until a page is shown and its requests have responses.
export const settled = async (page) => {
  await page.waitForSelector('html[data-connection="open"]');
  await page.waitForFunction(() => document.querySelector('main .page')?.textContent.trim() !== '');
  await until(() => page.underWay === 0, 'answers of the station');
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
};

export const says = (page, selector, pattern, what = String(pattern)) =>
  until(async () => pattern.test((await page.locator(selector).allTextContents()).join(' ')), what);

// Waits in this process, without polling the page by sleeping.
export async function until(condition, what, within_ms = patience_ms) {
  const end = Date.now() + within_ms;
  for (;;) {
    const result = await Promise.resolve().then(condition).catch((fault) => {
      if (!/context was destroyed/.test(fault.message)) throw fault;  // the page navigates
    });
    if (result) return result;
    assert.ok(Date.now() < end, `not within ${within_ms} ms: ${what}`);
    await new Promise((done) => setTimeout(done, 25));
  }
}
