// The configuration of a mock station: /api/configuration with the schema and the device templates of
// the tree. Its loader knows a few faults only, its plan counts devices.

import { createHash } from 'node:crypto';
import { readdirSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const config = join(dirname(fileURLToPath(import.meta.url)), '../../../../config');
const watchFor_ms = 30_000;
export const versionOf = (text) => createHash('sha256').update(text).digest('hex').slice(0, 16);

export const firstText = `# The plant of the north.
bridge: north
dds: { domain: 0, interfaces: [127.0.0.1] }  # this machine only
buses:
  # A fast line
  - name: boiler-house
    port: { serial: /dev/ttyUSB0, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { refresh: 500ms }
    devices:
      - { name: device-01, address: 1, template: carlo-gavazzi-em24 }  # in cabinet 3
      - name: device-02
        address: 2
        channels:
          - { name: temperature-1, at: "holding:100", type: int16, unit: °C }
  - name: press-shop
    port: { serial: /dev/ttyUSB1, baud: 9600 }
    protocol: modbus-rtu
    devices:
      - { name: device-01, address: 1, template: carlo-gavazzi-em112 }
`;

function templates() {
  const folder = join(config, 'devices');
  return readdirSync(folder).filter((name) => name.endsWith('.yaml')).map((file) => {
    const text = readFileSync(join(folder, file), 'utf8');
    const device = /^# Device: +(.*)$/m.exec(text)?.[1] ?? file, protocol = /^protocols: \[(.*)\]/m.exec(text)?.[1] ?? '';
    const [maker, ...model] = device.split(/[,(;]/)[0].split(' ');
    return { name: file.replace('.yaml', ''), maker, model: model.join(' '), protocol, text };
  });
}

const rules = [
  [/\brefresh: (\d+)(?=[\s,}]|$)/, (found) => [`refresh '${found[1]}' has no unit`, `did you mean ${found[1]}ms?`]],
  [/\bbaud: 115000\b/, () => ['baud 115000 is no rate of serial ports', 'allowed: 300, 600, ...']],
  [/\bcolour:/, () => ["key 'colour' is unknown", 'allowed: name, port, protocol']],
  [/\bdevices: \[\s*\]/, () => ['devices is empty', 'a bus has 1 to 247 devices']],
];

function faultsOf(text) {
  return text.split('\n').flatMap((line, index) => rules.flatMap(([pattern, tell]) => {
    const found = pattern.exec(line);
    if (!found) return [];
    const [message, hint] = tell(found);
    return [{ file: 'north.yaml', line: index + 1, column: found.index + 1, message, hint }];
  }));
}

// A device is a quarter of a bus with 9600 baud, and a twentieth otherwise.
function planOf(text) {
  return text.split(/^ {2}- name: /m).slice(1).map((part) => {
    const devices = part.match(/address:/g)?.length ?? 0, slow = part.includes('baud: 9600');
    const load = devices * (slow ? 0.45 : 0.05), bus = part.split('\n')[0].trim(), feasible = load <= 1;
    return {
      bus, load, feasible, worst: [{ channel: `${bus}/device-01/energy`, refresh_ms: 1000, gap_ms: feasible ? 940 : 1000 * load }],
      infeasible: feasible ? [] : [`${bus}/device-01/energy`], remedies: feasible ? [] : ['Refresh less often, run the line at 115200 baud or more, or split the bus.'] };
  });
}

export class MockConfiguration {
  constructor() {
    this.text = firstText;
    this.versions = [{ version: versionOf(firstText), who: 'erna', why: 'commissioning', at_ms: Date.now() - 8.64e7, state: 'confirmed by erna', text: firstText }];
    this.watch = null;
    this.protected = [{ line: 3, why: 'listen addresses are changed on the machine' }];
    this.schema = JSON.parse(readFileSync(join(config, 'fieldcast.schema.json'), 'utf8'));
    this.templates = templates();
    this.probed = [];
  }

  get version() { return versionOf(this.text); }

  put(text, who, why) {
    const base = this.version;
    this.text = text;
    this.versions = this.versions.filter(({ version }) => version !== this.version);
    this.versions.push({ version: this.version, who, why, at_ms: Date.now(), state: 'watching', text });
    this.watch = { version: this.version, base, until_ms: Date.now() + watchFor_ms, state: 'watching' };
    return [200, { version: this.version, until_ms: this.watch.until_ms }];
  }

  end(state) {
    this.versions.at(-1).state = state;
    this.watch = null;
  }

  // Returns [status, body], or undefined if there is no such resource.
  get(url) {
    const bridge = url.searchParams.get('bridge');
    switch (url.pathname) {
      case '/api/configuration': return [200, { bridge, path: '/etc/fieldcast/north.yaml', version: this.version, text: this.text, files: [{ name: 'press-3.csv', text: 'name,at,type\nflow,40001,int16\n' }], protected: this.protected, watch: this.watch }];
      case '/api/configuration/schema': return [200, this.schema];
      case '/api/configuration/templates': return [200, this.templates];
      case '/api/configuration/versions': return [200, this.versions.map(({ text: _, ...each }) => each).reverse()];
      case '/api/configuration/version': return [200, { text: this.versions.find(({ version }) => version === url.searchParams.get('version')).text }];
      default: return undefined;
    }
  }

  post(path, body, user) {
    switch (path) {
      case '/api/configuration/check': return [200, { faults: faultsOf(body.text), draft: planOf(body.text), today: planOf(this.text) }];
      case '/api/configuration/deploy':
        if (body.base !== this.version) return [409, { error: 'the configuration was changed by somebody else', hint: 'Merge both changes.', version: this.version, text: this.text }];
        return this.put(body.text, user, body.why);
      case '/api/configuration/confirm': this.end(`confirmed by ${user}`); return [200, {}];
      case '/api/configuration/rollback': {
        const { text } = this.versions.find(({ version }) => version === body.version);
        if (!this.watch) return this.put(text, user, body.why);
        if (body.version !== this.watch.base) return [409, { error: `the version ${this.watch.version} is still watched`, hint: '' }];
        this.end(`rolled back by ${user}: ${body.why}`);
        this.text = text;
        return [200, { version: this.version, until_ms: null }];
      }
      case '/api/configuration/import': return [200, this.imported ?? {
        text: 'channels:\n  - { name: flow, at: "holding:0", type: int16 }\n  - { name: level, at: "holding:1", type: int16 }\n',
        moved: [{ from: 'row 2: flow, 40001', to: 'flow at holding:0', change: '' }, { from: 'row 3: level, 40002', to: 'level at holding:1', change: 'counted from 0' }],
        refusals: [{ where: 'row 4: alarm', why: 'type enum16 is unknown' }], recognised: ['a list with the columns name, at'], notes: [] }];
      case '/api/configuration/scan':
        if (body.bus !== 'press-shop' || !/^(modbus-rtu|dtc)$/.test(body.protocol) || body.last !== '20') return [400, { error: `no scan of ${JSON.stringify(body)}`, hint: '' }];
        return [200, body.first === '1' ? { found: [], next: 17, error: '' } :
          { found: [{ address: '18', protocol: body.protocol, response: 'holding:0 = 4', responded: true, took_ms: 9, identity: 'Siemens AG, SENTRON PAC3200, 2.1', templates: ['siemens-pac3200'] },
            { address: '20', protocol: body.protocol, response: 'holding:0 = 17', responded: true, took_ms: 12.4, identity: '', templates: [] }], next: null, error: body.first === '17' ? '' : 'not asked' }];
      case '/api/configuration/probe':
        this.probed.push(body);
        return [200, { values: [{ channel: 'voltage-l1', value: 231.4, unit: 'V', quality: 'GOOD', error: '' }, { channel: 'current-l1', value: null, unit: 'A', quality: 'BAD_NO_ANSWER', error: 'no response within 500 ms' }] }];
      default: return undefined;
    }
  }
}
