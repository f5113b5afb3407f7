// Parts of npm packages that the page imports by a name of its own. The package yaml exports only all of itself (30 kB
// compressed); its lexer and parser alone are 8 kB.

import { join } from 'node:path';

export const partsOfPackages = (modules) => ({
  'yaml-parser': join(modules, 'yaml/browser/dist/parse/parser.js'),
  'yaml-scalar': join(modules, 'yaml/browser/dist/compose/resolve-flow-scalar.js'),
});
