// What the station's page costs in chromium with 10 000 channels at 1 Hz, as ratios to its goals (at 1 or below: reached): the live table,
// and a dashboard of 60 widgets (only with the invented station).
//
//   node tools/bench/page_bench.mjs --modules build/station-page-tests/node_modules --files build/station-page/files
//       [--url http://127.0.0.1:8090] [--channels 10000] [--seconds 8]
//
// Without --url an invented station in a process of its own sends the values: then "acquired to painted" is the page's part of the way and
// the socket's. With --url it is the whole way of a real station. Headless chromium draws by software: on two cores everything shares them.
// A painting is taken for done when the message that follows its animation frame arrives; the display's own time is not in it.

import { spawn } from 'node:child_process';
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { startBrowser, until } from '../../tests/tools/station/page/browser.mjs';

const option = (name, otherwise) => {
  const at = process.argv.indexOf(`--${name}`);
  return at < 0 ? otherwise : process.argv[at + 1];
};
const modules = option('modules'), files = option('files');
const seconds = Number(option('seconds', 8)), channels = option('channels', '10000');
const goals = { fps: 58, share: 0.35, dashboard: 0.2, p50_ms: 50, p99_ms: 100, paint_ms: 500, data_ms: 1000, page_kb: 120 };

async function startMock() {
  const program = join(dirname(fileURLToPath(import.meta.url)), '../../tests/tools/station/page/mock_station.mjs');
  const child = spawn(process.execPath, [program, '--files', files, '--modules', modules, '--port', '0', '--channels', channels], { stdio: ['ignore', 'pipe', 'inherit'] });
  const address = await new Promise((done) => child.stdout.once('data', (text) => done(String(text).trim().replace(/\/$/, ''))));
  return { address, stop: () => child.kill() };
}

// How far it is, on standard error where that is a terminal: seconds of the whole are known but for the starts of the page.
const progress = (() => {
  const starts = 5, start_s = 1, whole_s = starts * start_s + 2 * seconds;
  let timer, done_s = 0;
  return {
    begin(what, lasts_s) {
      if (!process.stderr.isTTY) return;
      const began = performance.now();
      timer = setInterval(() => {
        const at_s = Math.min(whole_s, done_s + Math.min(lasts_s, (performance.now() - began) / 1000));
        const text = `${what}: ${(100 * at_s / whole_s).toFixed(0)} %, ${(whole_s - at_s).toFixed(0)}s left`;
        process.stderr.write(`\r\x1b[K${text.slice(0, (process.stderr.columns || 80) - 1)}`);
      }, 250);
    },
    end(lasts_s) {
      done_s += lasts_s;
      if (!process.stderr.isTTY) return;
      clearInterval(timer);
      process.stderr.write('\r\x1b[K');
    },
    starts, start_s,
  };
})();

const quantile = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? NaN;
const row = (name, value, unit, ratio) => console.log(`${name.padEnd(34)}${value.padStart(9)} ${unit.padEnd(6)}${ratio === undefined ? '' : `  ${ratio.toFixed(2)} of the goal`}`);

// First paint and first value of a cold start.
async function starts(browser, times) {
  const found = [];
  for (let n = 0; n < times; n++) {
    const page = await browser.open('#/live');
    await page.waitForFunction(() => /\d/.test(document.querySelector('.vbody .c-value')?.textContent ?? ''), undefined, { polling: 'raf' });
    found.push(await page.evaluate(() => ({
      paint: performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN, data: performance.now() })));
    await page.context().close();
  }
  const middle = (key) => found.map((each) => each[key]).sort((a, b) => a - b)[Math.floor(times / 2)];
  return { paint: middle('paint'), data: middle('data') };
}

// Frames, main thread and ages for some seconds, with or without scrolling.
async function run(page, scrolling) {
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable');
  const metrics = async () => Object.fromEntries((await session.send('Performance.getMetrics')).metrics.map((each) => [each.name, each.value]));
  const before = await metrics();
  const figures = await page.evaluate(({ scrolling, ms }) => new Promise((done) => {
    const table = document.querySelector('.vtable'), meter = window.fieldcastMeter;
    meter.now = Date.now;  // station and browser share a clock here
    let frames = 0, longest = 0, longTasks = 0, last = performance.now();
    const begin = last, counted = meter.count;
    const observer = new PerformanceObserver((list) => { longTasks += list.getEntries().length; });
    observer.observe({ type: 'longtask' });
    const turn = (now) => {
      frames++;
      longest = Math.max(longest, now - last);
      last = now;
      if (scrolling) table.scrollTop += 37;
      if (now - begin < ms) return requestAnimationFrame(turn);
      observer.disconnect();
      const fresh = Math.min(meter.count - counted, meter.ages_ms.length);
      const ages = [];
      for (let k = 0; k < fresh; k++) ages.push(meter.ages_ms[(meter.count - 1 - k) % meter.ages_ms.length]);
      done({ fps: (frames * 1000) / (now - begin), longest, longTasks, ages });
    };
    requestAnimationFrame(turn);
  }), { scrolling, ms: seconds * 1000 });
  const after = await metrics();
  await session.detach();
  return { ...figures, ages: figures.ages.sort((a, b) => a - b), share: (after.TaskDuration - before.TaskDuration) / (after.Timestamp - before.Timestamp), heap: after.JSHeapUsedSize };
}

// Share of a core that all processes of the browser take while a dashboard is shown.
async function dashboard(browser) {
  const page = await browser.open('#/dashboard/sixty');
  await page.waitForFunction(() => document.querySelectorAll('.board .widget').length === 60);
  await new Promise((done) => setTimeout(done, 2000));  // the requests for stored trends have ended
  const session = await browser.inspect();
  const used = async () => (await session.send('SystemInfo.getProcessInfo')).processInfo.reduce((sum, each) => sum + each.cpuTime, 0);
  const begin = performance.now(), before = await used();
  await new Promise((done) => setTimeout(done, seconds * 1000));
  const share = ((await used()) - before) / ((performance.now() - begin) / 1000);
  await page.context().close();
  return share;
}

const mock = option('url') ? undefined : await startMock();
const address = (option('url') ?? mock.address).replace(/\/$/, '');
const browser = await startBrowser(modules, address);
try {
  if (files) {
    const size = readdirSync(files).filter((name) => name !== 'embed').reduce((sum, name) => sum + gzipSync(readFileSync(join(files, name)), { level: 9 }).length, 0) / 1000;
    row('page, compressed', size.toFixed(1), 'kB', size / goals.page_kb);
  }
  progress.begin('opening the page', progress.starts * progress.start_s);
  const { paint, data } = await starts(browser, progress.starts);
  progress.end(progress.starts * progress.start_s);
  row('first paint (of 5)', paint.toFixed(0), 'ms', paint / goals.paint_ms);
  row('first data (of 5)', data.toFixed(0), 'ms', data / goals.data_ms);
  const page = await browser.open('#/live');
  await page.waitForSelector('html[data-connection="open"]');
  await until(async () => /[1-9]/.test(await page.textContent('.line .fixed')), 'values flow');
  row('values a second, as the page counts', (await page.textContent('.line .fixed')).replace(/\D/g, ''), '');
  for (const scrolling of [false, true]) {
    const name = scrolling ? 'scrolling' : 'standing';
    progress.begin(name, seconds);
    const figures = await run(page, scrolling);
    progress.end(seconds);
    row(`${name}: frames a second`, figures.fps.toFixed(1), '', goals.fps / figures.fps);
    row(`${name}: longest frame`, figures.longest.toFixed(0), 'ms');
    row(`${name}: tasks over 50 ms`, String(figures.longTasks), '');
    row(`${name}: main thread`, (100 * figures.share).toFixed(1), '%', figures.share / goals.share);
    if (scrolling) {
      row('heap', (figures.heap / 1e6).toFixed(1), 'MB');
      continue;
    }
    row(`acquired to painted, p50 (n=${figures.ages.length})`, quantile(figures.ages, 0.5).toFixed(0), 'ms', quantile(figures.ages, 0.5) / goals.p50_ms);
    row('acquired to painted, p99', quantile(figures.ages, 0.99).toFixed(0), 'ms', quantile(figures.ages, 0.99) / goals.p99_ms);
  }
  await page.context().close();
  if (mock) {
    const share = await dashboard(browser);
    row('dashboard of 60 widgets: browser', (100 * share).toFixed(1), '%', share / goals.dashboard);
  }
} finally {
  await browser.close();
  mock?.stop();
}
