// Decodes payloads of Sparkplug B with the package sparkplug-payload of Eclipse Tahu: one hexadecimal
// text each line of the input, one JSON each line of the output.
//
// usage: node decode.mjs MODULES < LINES
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';

const require = createRequire(resolve(process.argv[2], 'x.js'));
const payloads = require('sparkplug-payload').get('spBv1.0');
// Integers of 64 bits are objects.
const converted = (value) => {
  if (Array.isArray(value)) return value.map(converted);
  if (value && typeof value === 'object') {
    if ('unsigned' in value && 'low' in value) return Number(value.toString());
    return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, converted(item)]));
  }
  return value;
};
for (const line of readFileSync(0, 'utf8').split('\n').filter(Boolean)) {
  console.log(JSON.stringify(converted(payloads.decodePayload(Buffer.from(line, 'hex')))));
}
