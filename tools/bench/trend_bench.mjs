// Compares the page's own trend with uPlot: bytes of the bundle, compressed, and the time that chromium needs to draw 8 curves of 1 000
// points with bands, limits and gaps. The order of the two alternates; the printed ratio is uPlot to ours.
//
//   npm pack uplot@1.6.32 && tar xzf uplot-1.6.32.tgz
//   node tools/bench/trend_bench.mjs --modules build/station-page-tests/node_modules --page build/station-page/node_modules --uplot package

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { createServer } from 'node:http';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { startBrowser } from '../../tests/tools/station/page/browser.mjs';

const option = (name) => resolve(process.argv[process.argv.indexOf(`--${name}`) + 1]);
const modules = option('modules'), uplot = option('uplot');
const source = join(dirname(fileURLToPath(import.meta.url)), '../station/page/src');
const rounds = 40, warm = 5;

const { buildSync, transformSync } = createRequire(join(option('page'), 'x'))('esbuild');
const own = buildSync({
  stdin: { contents: `export { Chart } from './chart';`, resolveDir: source, loader: 'ts' }, bundle: true, minify: true, format: 'iife', globalName: 'trend',
  write: false, target: ['chrome123'], nodePaths: [option('page')], logLevel: 'warning' }).outputFiles[0].text;
// The bundle above includes the texts of all pages. For the size, only the trend's own modules count.
const alone = ['chart.ts', 'ticks.ts'].map((name) => readFileSync(join(source, name), 'utf8')).join('\n').replace(/^import .*$/gm, '').replace(/^export \{.*$/gm, '');
const ownBytes = gzipSync(transformSync(alone, { loader: 'ts', minify: true }).code, { level: 9 }).length;
const uplotScript = readFileSync(join(uplot, 'dist/uPlot.iife.min.js'), 'utf8'), uplotStyle = readFileSync(join(uplot, 'dist/uPlot.min.css'), 'utf8');
const uplotBytes = gzipSync(uplotScript, { level: 9 }).length + gzipSync(uplotStyle, { level: 9 }).length;

const html = `<!doctype html><style>${readFileSync(join(source, '../app.css'), 'utf8')}${uplotStyle}.chart{position:relative}canvas{position:absolute}</style>
<body><div id="own" style="width:1200px"></div><div id="uplot"></div>`;
const server = createServer((_, response) => response.end(html)).listen(0, '127.0.0.1');
await new Promise((done) => server.once('listening', done));
const browser = await startBrowser(modules, `http://127.0.0.1:${server.address().port}`);
const page = await browser.open('', { ignore: /./ });
await page.addScriptTag({ content: own });
await page.addScriptTag({ content: uplotScript });
const times = await page.evaluate(async ({ rounds, warm }) => {
  const points = 1000, curves = 8, from = Date.now() - 3_600_000, step = 3600;
  const t = Array.from({ length: points }, (_, n) => from + n * step);
  const lines = Array.from({ length: curves }, (_, k) => {
    const average = t.map((_, n) => (n % 211 > 204 ? null : 50 + 40 * Math.sin(n / 40 + k)));
    const moved = (by) => average.map((value) => (value === null ? null : value + by));
    return { label: `c${k}`, unit: k % 2 ? 'bar' : 'C', stepped: false, t, average, min: moved(-4), max: moved(5),
      bad: t.filter((_, n) => n % 211 === 205).map((at) => ({ from_ms: at, to_ms: at + 6 * step })) };
  });
  const limits = { low: 15, high: 85 };
  const chart = new trend.Chart({ label: 'x', height: 380, limits });
  document.getElementById('own').append(chart.element);
  chart.set(lines, from, from + 3_600_000);
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const flush = (root) => root.querySelectorAll('canvas').forEach((canvas) => canvas.getContext('2d').getImageData(0, 0, 1, 1));
  const drawOwn = () => { chart.set(lines, from, from + 3_600_000); flush(chart.element); };
  // uPlot has a series for each of minimum, maximum and average; a band fills between two.
  const data = [t.map((at) => at / 1000), ...lines.flatMap((line) => [line.min, line.max, line.average])];
  const colours = ['#0b5aa6', '#a8480f', '#1b7a53', '#84309a', '#5d6a00', '#a3184f', '#00717d', '#4b4b4b'];
  const plot = new uPlot({
    width: 1200, height: 380, scales: { C: {}, bar: {} },
    axes: [{}, { scale: 'C' }, { scale: 'bar', side: 1 }],
    series: [{}, ...lines.flatMap((line, k) => [
      { scale: line.unit, width: 0, points: { show: false } }, { scale: line.unit, width: 0, points: { show: false } },
      { scale: line.unit, stroke: colours[k], width: 1.6, points: { show: false } }])],
    bands: lines.map((_, k) => ({ series: [2 + 3 * k, 1 + 3 * k], fill: `${colours[k]}38` })),
    hooks: { draw: [(u) => {
      for (const value of Object.values(limits)) u.ctx.fillRect(u.bbox.left, u.valToPos(value, 'C', true), u.bbox.width, 1);
      lines.forEach((line, k) => line.bad.forEach((span) => {
        u.ctx.fillStyle = colours[k];
        const left = u.valToPos(span.from_ms / 1000, 'x', true);
        u.ctx.fillRect(left, u.bbox.top + u.bbox.height - 5 * (8 - k), u.valToPos(span.to_ms / 1000, 'x', true) - left, 4);
      }));
    }] },
  }, data, document.getElementById('uplot'));
  await new Promise((done) => requestAnimationFrame(done));
  const drawPlot = async () => { plot.setData(data); await Promise.resolve(); flush(plot.root); };
  const own = [], other = [];
  for (let round = 0; round < rounds + warm; round++)
    for (const [draw, list] of round % 2 ? [[drawOwn, own], [drawPlot, other]] : [[drawPlot, other], [drawOwn, own]]) {
      const begin = performance.now();
      await draw();
      if (round >= warm) list.push(performance.now() - begin);
    }
  const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];
  return { own: median(own), other: median(other) };
}, { rounds, warm });
console.log(`bytes compressed   ours ${ownBytes}   uPlot ${uplotBytes}   ratio ${(uplotBytes / ownBytes).toFixed(2)}`);
console.log(`draw, median       ours ${times.own.toFixed(1)} ms   uPlot ${times.other.toFixed(1)} ms   ratio ${(times.other / times.own).toFixed(2)}`);
await browser.close();
server.close();
