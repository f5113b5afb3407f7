// Bundles the page and writes it as C++: the gzip'ed bytes of each file, and the table page_files().
//
//   node build.mjs MODULES OUTPUT.cpp [FOLDER]
//
// MODULES: the node_modules of `npm ci`. FOLDER: also receives the files, for tests without the program. OUTPUT.cpp.d
// lists every source for the build. A module that is imported by import() becomes a script of its own, loaded when it is needed.

import { createHash } from 'node:crypto';
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { partsOfPackages } from './packages.mjs';

const here = dirname(fileURLToPath(import.meta.url));
const [modules, output, folder] = process.argv.slice(2).map((path) => resolve(path));
const largest_kb = 120;
const packageOf = createRequire(join(modules, 'x'));

// The indentation of a source is in its templates too, where a browser reads it as one space.
const unindented = {
  name: 'unindented',
  setup: ({ onLoad }) => onLoad({ filter: /page.src.*[.]ts$/ }, ({ path }) => ({ contents: readFileSync(path, 'utf8').replace(/\n +/g, '\n'), loader: 'ts' })),
};

async function bundle() {
  const { build } = packageOf('esbuild');
  const result = await build({
    entryPoints: [join(here, 'src/main.ts')],
    entryNames: 'app',
    chunkNames: '[name]-[hash]',
    splitting: true,
    plugins: [unindented],
    alias: partsOfPackages(modules),
    outdir: join(here, 'out'),
    bundle: true,
    minify: true,
    format: 'esm',
    target: ['chrome123', 'firefox120', 'safari17.5'],
    nodePaths: [modules],
    legalComments: 'eof',
    write: false,
    metafile: true,
    logLevel: 'warning',
  });
  const { inputs, outputs } = result.metafile;
  const app = Object.keys(outputs).find((path) => basename(path) === 'app.js');
  return {
    made: result.outputFiles.map(({ path, contents }) => ({ name: basename(path), bytes: Buffer.from(contents) })),
    early: outputs[app].imports.filter(({ kind }) => kind === 'import-statement').map(({ path }) => basename(path)),
    inputs: Object.keys(inputs).map((path) => resolve(path)),
  };
}

const { made, early, inputs } = await bundle();
const own = (name) => readFileSync(join(here, name));
const html = 'text/html; charset=utf-8';
const typeOf = (name) => (name.endsWith('.js') ? 'text/javascript; charset=utf-8' : 'text/css; charset=utf-8');
// The scripts that app.js imports load at the same time as app.js.
const preload = early.map((name) => `    <link rel="modulepreload" href="/${name}">\n`).join('');
// Zopfli writes gzip that is 4 % smaller than that of zlib.
const { gzipAsync } = packageOf('@gfx/zopfli');
const files = await Promise.all([
  ['/', html, Buffer.from(own('index.html').toString().replace(/(?= *<script)/, preload))],
  ...made.map(({ name, bytes }) => [`/${name}`, typeOf(name), bytes]),
  ['/icon.svg', 'image/svg+xml', own('icon.svg')],
  ['/manifest', 'application/manifest+json', own('manifest.json')],
].map(async ([path, type, bytes]) => ({
  path, type, bytes, gzip: await gzipAsync(bytes, { numiterations: 5 }),
  etag: createHash('sha256').update(bytes).digest('hex').slice(0, 16),
})));

const total = files.reduce((sum, file) => sum + file.gzip.length, 0);
if (total > largest_kb * 1000) {
  console.error(`the page is ${total} bytes compressed; its limit is ${largest_kb} kB`);
  process.exit(1);
}

const row = (file, index) => `    {"${file.path}", "${file.type}", bytes(kFile${index}), "\\"${file.etag}\\""},`;
const array = (file, index) => {
  const numbers = [];
  for (let at = 0; at < file.gzip.length; at += 24) numbers.push('    ' + [...file.gzip.subarray(at, at + 24)].join(',') + ',');
  return `constexpr unsigned char kFile${index}[] = {\n${numbers.join('\n')}\n};`;
};
writeFileSync(output, `// Made by tools/station/page/build.mjs: ${total} bytes in all.
#include "tools/station/web/embedded_file.hpp"

namespace fieldcast::web {
namespace {

${files.map(array).join('\n\n')}

std::string_view bytes(std::span<const unsigned char> file) {
  return {reinterpret_cast<const char*>(file.data()), file.size()};
}

const EmbeddedFile kFiles[] = {
${files.map(row).join('\n')}
};

}  // namespace

std::span<const EmbeddedFile> page_files() { return kFiles; }

}  // namespace fieldcast::web
`);
writeFileSync(`${output}.d`, `${output}: ${inputs.map((path) => path.replaceAll(' ', '\\ ')).join(' ')}\n`);

if (folder) {
  mkdirSync(folder, { recursive: true });
  for (const old of readdirSync(folder)) rmSync(join(folder, old));
  for (const file of files) writeFileSync(join(folder, file.path === '/' ? 'index.html' : file.path.slice(1)), file.bytes);
}
console.log(`page: ${(total / 1000).toFixed(1)} kB compressed`);
for (const { path, gzip } of files) console.log(`  ${path} ${(gzip.length / 1000).toFixed(1)} kB`);
