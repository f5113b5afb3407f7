// Encodes a payload of Sparkplug B with the package sparkplug-payload of Eclipse Tahu: JSON on the input, the bytes on the output.
//
// usage: node encode.mjs MODULES < JSON
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';

const require = createRequire(resolve(process.argv[2], 'x.js'));
process.stdout.write(require('sparkplug-payload').get('spBv1.0').encodePayload(JSON.parse(readFileSync(0, 'utf8'))));
