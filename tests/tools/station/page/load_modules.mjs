// Loads modules of the page in node, without a browser.

import { mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

// The page's modules ask for these when they are loaded.
globalThis.document = { createTreeWalker: () => ({}) };
globalThis.MessageChannel = class { port1 = {}; port2 = {}; };
globalThis.localStorage = { getItem: (key) => (key === 'fieldcast.language' ? 'en' : null), setItem: () => {} };

// Bundles the modules together, so that they share state as in the page. Returns them by their name without a folder.
export async function loadModules(folder, modules, names) {
  const { partsOfPackages } = await import(join(folder, 'packages.mjs'));
  const { buildSync } = createRequire(join(modules, 'x'))('esbuild');
  const made = mkdtempSync(join(tmpdir(), 'fieldcast-page-'));
  buildSync({
    stdin: { contents: names.map((path) => `export * as ${path.split('/').pop()} from './${path}';`).join('\n'), resolveDir: join(folder, 'src'), loader: 'ts' },
    bundle: true, format: 'esm', outfile: join(made, 'page.mjs'), nodePaths: [modules], alias: partsOfPackages(modules), logLevel: 'warning',
  });
  const loaded = await import(join(made, 'page.mjs'));
  rmSync(made, { recursive: true });
  return loaded;
}
