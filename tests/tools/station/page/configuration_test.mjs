// Tests the parts of the page Configuration without a browser.
//
//   node configuration_test.mjs PAGE_FOLDER NODE_MODULES

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import test from 'node:test';
import { loadModules } from './load_modules.mjs';
import { firstText } from './mock_configuration.mjs';

const [folder, modules] = process.argv.slice(2).map((path) => resolve(path));
const { yaml_tree, yaml_edit, line_diff, schema, completion, draft, new_device, outline, plan_rows, tar } = await loadModules(folder, modules,
  ['yaml_tree', 'yaml_edit', 'line_diff', 'schema', 'completion', 'draft', 'new_device', 'outline', 'plan_rows', 'tar'].map((name) => `configuration/${name}`));
const config = join(folder, '../../../config');
const keys = JSON.parse(readFileSync(join(config, 'fieldcast.schema.json'), 'utf8'));
const valueAt = (text, ...path) => yaml_tree.valueAt(yaml_tree.parseTree(text), path);
const changed = (before, after) => line_diff.diffLines(before, after).filter(({ kind }) => kind !== 'same').map(({ kind, text }) => `${kind === 'added' ? '+' : '-'}${text}`);

test('the tree has the values of a configuration, in blocks and in braces', () => {
  assert.equal(valueAt(firstText, 'bridge'), 'north');
  assert.equal(valueAt(firstText, 'buses', 0, 'port', 'serial'), '/dev/ttyUSB0');
  assert.equal(valueAt(firstText, 'buses', 0, 'devices', 1, 'channels', 0, 'at'), 'holding:100');
  assert.equal(valueAt(firstText, 'buses', 1, 'devices', 0, 'template'), 'carlo-gavazzi-em112');
  assert.equal(valueAt('a: "x\\ty"\nb: \'it\'\'s\'\n', 'a'), 'x\ty');
  assert.equal(yaml_tree.parseTree(''), undefined);
});

test('the position of each value in every shipped configuration is that of its text', () => {
  for (const name of ['minimal', 'complete', 'demo']) {
    const text = readFileSync(join(config, 'examples', `${name}.yaml`), 'utf8');
    let scalars = 0;
    const visit = (node) => {
      if (!node) return;
      if (node.kind === 'scalar' && !node.flow && ++scalars) assert.equal(text.slice(node.start, node.end), node.value);
      for (const child of node.children) {
        if (typeof child.key === 'string') assert.ok(text.slice(child.start).startsWith(child.key), child.key);
        visit(child.node);
      }
    };
    visit(yaml_tree.parseTree(text));
    assert.ok(scalars > 5, name);
  }
});

test('a text with faults has a tree, and no text makes the parser fail', () => {
  for (let end = 0; end <= firstText.length; end += 7) yaml_tree.parseTree(firstText.slice(0, end));
  assert.equal(valueAt('a: [1, {b: 2\nc: 3\n', 'a', 0), '1');
  yaml_tree.parseTree(`${'['.repeat(500)}${'{a: '.repeat(500)}`);
  yaml_tree.parseTree('\t- }]\n: :\n*x &y');
});

test('a position belongs to the object around it', () => {
  const at = (part) => outline.objectOf(yaml_tree.pathAt(firstText, yaml_tree.parseTree(firstText), firstText.indexOf(part) + 2));
  assert.deepEqual(at('The plant'), []);
  assert.deepEqual(at('baud: 115200'), ['buses', 0]);
  assert.deepEqual(at('carlo-gavazzi-em24'), ['buses', 0, 'devices', 0]);
  assert.deepEqual(at('address: 2'), ['buses', 0, 'devices', 1]);
  assert.deepEqual(at('°C'), ['buses', 0, 'devices', 1, 'channels', 0]);
  assert.deepEqual(at('baud: 9600'), ['buses', 1]);
});

test('a change of a value touches only its line, and keeps comments and quotes', () => {
  const set = (path, value, bare) => yaml_edit.setScalar(firstText, path, value, bare);
  assert.deepEqual(changed(firstText, set(['buses', 0, 'devices', 0, 'address'], '9', true)), [
    '-      - { name: device-01, address: 1, template: carlo-gavazzi-em24 }  # in cabinet 3',
    '+      - { name: device-01, address: 9, template: carlo-gavazzi-em24 }  # in cabinet 3']);
  assert.deepEqual(changed(firstText, set(['buses', 0, 'devices', 1, 'channels', 0, 'at'], 'holding:7', true)), [
    '-          - { name: temperature-1, at: "holding:100", type: int16, unit: °C }',
    '+          - { name: temperature-1, at: "holding:7", type: int16, unit: °C }']);
});

test('a new key is the last of its map, in the way the map is written', () => {
  const add = (path, value, bare = false) => changed(firstText, yaml_edit.setScalar(firstText, path, value, bare)).filter((line) => line[0] === '+');
  assert.deepEqual(add(['buses', 0, 'devices', 1, 'timeout'], '300ms'), ['+        timeout: 300ms']);
  assert.deepEqual(add(['dds', 'partition'], 'plant'), ['+dds: { domain: 0, interfaces: [127.0.0.1], partition: plant }  # this machine only']);
  assert.deepEqual(add(['store', 'path'], 'store.db'), ['+store: { path: store.db }']);
  assert.deepEqual(add(['buses', 0, 'devices', 1, 'channels', 0, 'limits', 'high'], '80', true),
    ['+          - { name: temperature-1, at: "holding:100", type: int16, unit: °C, limits: { high: 80 } }']);
  assert.equal(yaml_edit.setScalar('log:\n', ['log', 'level'], 'debug', true), 'log: { level: debug }\n');
  assert.equal(yaml_edit.setScalar('', ['log', 'level'], 'debug', true), 'log: { level: debug }\n');
});

test('what could be read as something else is written in quotes', () => {
  for (const [value, bare, text] of [['500ms', false, '500ms'], ['5', true, '5'], ['5', false, '"5"'], ['004712', false, '"004712"'], ['true', false, '"true"'], ['true', true, 'true'],
    ['holding:1', false, '"holding:1"'], ['a # b', false, '"a # b"'], ['', false, '""'], ['x, y', false, '"x, y"'], ['/dev/ttyUSB0', false, '/dev/ttyUSB0'], ['°C', false, '°C'],
    ['- x', false, '"- x"'], ['a"b\n', false, '"a\\"b\\n"'], ['{', false, '"{"'], ['null', false, '"null"'], ['1/min', false, '1/min'], ['%', false, '"%"']])
    assert.equal(yaml_edit.scalarText(value, bare), text, value);
});

test('a list gets an item, and gives one back', () => {
  const path = ['buses', 1, 'devices'], item = new_device.deviceText('meter', '5', 'carlo-gavazzi-em24');
  const more = yaml_edit.addItem(firstText, path, item);
  assert.deepEqual(changed(firstText, more), ['+      - { name: meter, address: 5, template: carlo-gavazzi-em24 }']);
  assert.equal(yaml_edit.removeAt(more, [...path, 1]), firstText);
  assert.equal(yaml_edit.addItem('a: []\n', ['a'], 'x'), 'a: [x]\n');
  assert.equal(yaml_edit.addItem('b:\n  - 1  # one\n  # end\nc: 2\n', ['b'], 'x: 1\ny: 2'), 'b:\n  - 1  # one\n  - x: 1\n    y: 2\n  # end\nc: 2\n');
  const none = yaml_edit.removeAt(firstText, [...path, 0]);
  assert.equal(yaml_tree.nodeAt(yaml_tree.parseTree(none), path).children.length, 0);
  assert.equal(valueAt(yaml_edit.addItem(none, path, item), ...path, 0, 'name'), 'meter');
});

test('a key is removed with its line or from its braces', () => {
  assert.deepEqual(changed(firstText, yaml_edit.removeAt(firstText, ['buses', 0, 'devices', 1, 'address'])), ['-        address: 2']);
  assert.ok(yaml_edit.removeAt(firstText, ['dds', 'domain']).includes('dds: { interfaces: [127.0.0.1] }  # this'));
  assert.ok(yaml_edit.removeAt(firstText, ['buses', 0, 'defaults', 'refresh']).includes('defaults: {}'));
  assert.ok(yaml_edit.removeAt(firstText, ['buses', 0, 'devices', 1, 'name']).includes('      - address: 2'));
  assert.equal(yaml_edit.removeAt(firstText, ['no', 'such']), firstText);
});

test('edits of every value of the demo keep the tree', () => {
  const text = readFileSync(join(config, 'examples/demo.yaml'), 'utf8');
  const paths = [];
  const visit = (node, path) => {
    if (node?.kind === 'scalar') paths.push(path);
    node?.children.forEach((child) => visit(child.node, [...path, child.key]));
  };
  visit(yaml_tree.parseTree(text), []);
  for (const path of paths.filter((_, index) => index % 9 === 0)) {
    const edited = yaml_edit.setScalar(text, path, 'a: b', false);
    assert.equal(valueAt(edited, ...path), 'a: b', path.join('/'));
    assert.equal(changed(text, edited).length, 2);
    const removed = yaml_edit.removeAt(text, path);
    if (typeof path.at(-1) === 'string') assert.equal(valueAt(removed, ...path), undefined, path.join('/'));
  }
});

test('differences are found, the merge of two changes too', () => {
  assert.deepEqual(changed('a\nb\nc', 'a\nx\nc\ny'), ['-b', '+x', '+y']);
  assert.deepEqual(changed('', 'a'), ['-', '+a']);
  assert.deepEqual(line_diff.countChanges('a\nb', 'a\nb'), { added: 0, removed: 0 });
  const rows = (letters) => [...letters].join('\n');
  const merge = (...texts) => line_diff.merge(...texts.map(rows));
  assert.equal(merge('abcde', 'Abcde', 'abcdEf'), rows('AbcdEf'));
  assert.equal(merge('abc', 'aXc', 'aYc'), undefined);
  assert.equal(merge('abc', 'aXc', 'aXc'), rows('aXc'));
  assert.equal(merge('abc', 'abc', 'ac'), rows('ac'));
  const lines = (n, change) => Array.from({ length: n }, (_, at) => (at % 100 === change ? `x${at}` : `line ${at}`)).join('\n');
  const diff = line_diff.diffLines(lines(3000, -1), lines(3000, 50));
  assert.equal(diff.filter(({ kind }) => kind === 'added').length, 30);
  assert.deepEqual(line_diff.changedLines(diff).filter((line) => line === undefined).length, 29);
});

test('random texts: the difference rebuilds both', () => {
  let seed = 7;
  const random = (n) => (seed = (seed * 1103515245 + 12345) % 2147483648) % n;
  for (let round = 0; round < 200; round++) {
    const make = () => Array.from({ length: random(30) }, () => String(random(6))).join('\n');
    const before = make(), after = make(), lines = line_diff.diffLines(before, after);
    assert.equal(lines.filter(({ kind }) => kind !== 'added').map(({ text }) => text).join('\n'), before);
    assert.equal(lines.filter(({ kind }) => kind !== 'removed').map(({ text }) => text).join('\n'), after);
  }
});

test('forms are made from the schema: a new key appears by itself', () => {
  const fields = (root, ...path) => schema.fieldsOf(root, schema.schemaAt(root, path));
  const bus = fields(keys, 'buses', 0), device = fields(keys, 'buses', 0, 'devices', 0), channel = fields(keys, 'buses', 0, 'devices', 0, 'channels', 0);
  const kind = (list, name) => list.find(({ key }) => key === name).kind;
  assert.equal(kind(bus, 'planner'), 'choice');
  assert.equal(kind(bus, 'port'), 'map');
  assert.equal(kind(bus, 'in-flight'), 'number');
  assert.ok(!bus.some(({ key }) => key === 'devices'));
  assert.ok(bus.find(({ key }) => key === 'protocol').choices.includes('modbus-rtu'));
  assert.equal(device.find(({ key }) => key === 'address').required, true);
  assert.equal(kind(device, 'options'), 'yaml');
  assert.equal(kind(channel, 'limits'), 'map');
  assert.equal(kind(channel, 'refresh'), 'text');
  assert.equal(kind(fields(keys, 'buses', 0, 'port'), 'rs485'), 'switch');
  for (const field of [...bus, ...device, ...channel]) assert.ok(field.description.length > 0 || field.kind === 'map', field.key);
  const more = structuredClone(keys);
  more.$defs.channel.properties.digits = { type: 'integer', minimum: 0, maximum: 9, description: 'Digits.' };
  assert.deepEqual(fields(more, 'buses', 0, 'devices', 0, 'channels', 0).find(({ key }) => key === 'digits').kind, 'number');
  assert.equal(kind(channel, 'calculate'), 'text');
  assert.deepEqual(schema.alternativesOf(schema.schemaAt(keys, ['buses', 0, 'devices', 0, 'channels', 0])), ['at', 'calculate']);
});

test('known templates are proposed, other names stay possible', () => {
  const root = schema.withTemplates(keys, ['carlo-gavazzi-em24']);
  const field = schema.fieldsOf(root, schema.schemaAt(root, ['buses', 0, 'devices', 0])).find(({ key }) => key === 'template');
  assert.deepEqual([field.kind, field.choices], ['text', ['carlo-gavazzi-em24']]);
  assert.deepEqual(schema.valuesAt(root, ['buses', 0, 'devices', 0, 'template']).map(({ text }) => text), ['carlo-gavazzi-em24']);
});

test('the cursor has proposals: free keys of its map, or the values of its key', () => {
  const at = (text) => completion.complete(text.replace('|', ''), text.indexOf('|'), keys);
  const names = (text) => at(text)?.proposals.map((each) => each.text);
  assert.deepEqual(names('bridge: x\nlo|\n'), ['log']);
  assert.ok(names('buses:\n  - name: a\n    p|\n').includes('planner'));
  assert.ok(!names('buses:\n  - name: a\n    |\n').includes('name'));
  assert.deepEqual(names('buses:\n  - name: a\n    planner: cy|\n'), ['cyclic']);
  assert.ok(names('buses:\n  - { name: a, port: { se| } }\n').includes('serial'));
  assert.ok(names('buses:\n  - name: a\n    devices:\n      - name: b\n        channels:\n          - { name: c, acc|').includes('access'));
  assert.equal(at('a: 1  # lo|'), undefined);
  assert.equal(at('bridge: x\nlo|\n').behind, ': ');
  assert.equal(at('bridge: x\nlo|: 3\n').behind, '');
});

test('protected lines are found again in the draft, or reported as changed', () => {
  const marks = [{ line: 3, why: 'no' }];
  const moved = draft.protectedLines(firstText, marks, `# new\n${firstText}`);
  assert.deepEqual([...moved.kept], [[4, 'no']]);
  assert.deepEqual(draft.protectedLines(firstText, marks, firstText.replace('domain: 0', 'domain: 1')).lost, marks);
});

test('typed characters are one step of undo, a form is one of its own', () => {
  const made = new draft.Draft({ text: 'a' });
  made.set('ab', 1000);
  made.set('abc', 1100);
  made.set('x');
  made.undo();
  assert.equal(made.text, 'abc');
  made.undo();
  assert.equal(made.text, 'a');
  assert.equal(made.changed, false);
  made.redo();
  assert.equal(made.text, 'abc');
});

test('imported texts give devices: of a configuration, or of a list of channels', () => {
  const found = new_device.importedDevices(firstText, 'x', '1', 'modbus-rtu');
  assert.deepEqual(found.map(({ name }) => name), ['device-01', 'device-02', 'device-01']);
  assert.equal(valueAt(yaml_edit.addItem(firstText, ['buses', 1, 'devices'], found[1].text), 'buses', 1, 'devices', 1, 'channels', 0, 'unit'), '°C');
  const list = new_device.importedDevices('channels:\n  - { name: flow, at: "holding:0" }\n  - { name: level, at: "holding:1" }\n', 'tank', '4', 'modbus-rtu');
  const text = yaml_edit.addItem(firstText, ['buses', 0, 'devices'], list[0].text);
  assert.equal(valueAt(text, 'buses', 0, 'devices', 2, 'channels', 1, 'name'), 'level');
  assert.equal(valueAt(text, 'buses', 0, 'devices', 2, 'address'), '4');
  assert.deepEqual(new_device.importedDevices('nothing: here\n', 'x', '1', ''), []);
});

test('imported devices keep the protocol of their bus on a bus of another protocol', () => {
  const found = new_device.importedDevices(firstText.replace('{ name: device-01, address: 1, template: carlo-gavazzi-em112', '{ name: a, address: 1, protocol: dtc'), 'x', '1', 'modbus-tcp');
  const text = found.reduce((sum, device) => yaml_edit.addItem(sum, ['buses', 1, 'devices'], device.text), firstText);
  assert.deepEqual([1, 2, 3].map((index) => valueAt(text, 'buses', 1, 'devices', index, 'protocol')), ['modbus-rtu', 'modbus-rtu', 'dtc']);
  assert.equal(valueAt(text, 'buses', 1, 'devices', 2, 'channels', 0, 'unit'), '°C');
});

test('templates are found by maker and model, those of the protocol first', () => {
  const list = [{ name: 'a-1', maker: 'Acme', model: 'Meter 1', protocol: 'modbus-tcp' }, { name: 'b-2', maker: 'Bmax', model: 'Meter 2', protocol: 'modbus-rtu, modbus-tcp' }];
  assert.deepEqual(new_device.matching(list, 'meter', 'modbus-rtu').map(({ name }) => name), ['b-2', 'a-1']);
  assert.deepEqual(new_device.matching(list, 'acme 1', '').map(({ name }) => name), ['a-1']);
  const tree = yaml_tree.parseTree(firstText);
  assert.equal(outline.freeAddress(tree, ['buses', 0]), '3');
  assert.equal(outline.freeName('a', ['a', 'a-2']), 'a-3');
});

test('plans of draft and today are joined by bus, the worst first', () => {
  const plan = (bus, load, feasible = true) => ({ bus, load, feasible, worst: [{ channel: 'x', refresh_ms: 1000, gap_ms: 1 }, { channel: 'y', refresh_ms: 10, gap_ms: 5 }], infeasible: [], remedies: [] });
  const rows = plan_rows.planRows({ draft: [plan('a', 0.2), plan('b', 0.3), plan('c', 1.2, false)], today: [plan('a', 0.2), plan('b', 0.2), plan('d', 0.1)] });
  assert.deepEqual(rows.map(({ bus }) => bus), ['c', 'b', 'd', 'a']);
  assert.equal(plan_rows.worstOf(plan('a', 0)).channel, 'y');
});

test('a file with CR LF is edited without CR and written back with it', () => {
  const made = new draft.Draft({ text: 'a: 1\r\nb: 2\r\n' });
  assert.equal(made.changed, false);
  made.set('a: 1\nb: 3\n');
  assert.equal(made.written, 'a: 1\r\nb: 3\r\n');
});

test('tar reads the archive of all versions', () => {
  const files = [{ name: 'north/north.yaml', text: firstText, at_ms: 1.7e12 }, { name: 'north/versions/1.yaml', text: '', at_ms: 1.6e12 }, { name: 'north/温度.csv', text: 'x'.repeat(512), at_ms: 0 }];
  const archive = Buffer.concat(tar.tarOf(files));
  const run = (...options) => execFileSync('tar', [...options, '--quoting-style=literal'], { input: archive, encoding: 'utf8', env: { ...process.env, TZ: 'UTC', LC_ALL: 'C.UTF-8' } });
  assert.deepEqual(run('-t').trim().split('\n'), files.map(({ name }) => name));
  assert.match(run('-tv'), /2023-11-14 22:13 north\/north\.yaml/);
  for (const { name, text } of files) assert.equal(run('-xO', name), text);
});
