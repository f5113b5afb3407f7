// The YAML text of a new device, and devices in an imported text. Pure.

import type { Template } from './api';
import { scalarText, setScalar } from './yaml_edit';
import { childOf, nodeAt, parseTree, valueAt } from './yaml_tree';
import type { Node, Path } from './yaml_tree';

// `protocol`: empty if it is that of the bus.
export const deviceText = (name: string, address: string, template: string, protocol = ''): string =>
  `{ name: ${scalarText(name)}, address: ${scalarText(address, /^(?:0|[1-9]\d{0,8})$/.test(address))}, ${
    protocol && `protocol: ${scalarText(protocol)}, `}template: ${scalarText(template)} }`;

// Protocols of a bus: its own, and those of its devices.
export const protocolsOf = (tree: Node | undefined, bus: Path): string[] =>
  [...new Set([bus, ...(nodeAt(tree, [...bus, 'devices'])?.children ?? []).map(({ key }) => [...bus, 'devices', key])]
    .map((path) => valueAt(tree, [...path, 'protocol']) ?? '').filter(Boolean))];

// The text of a node with its first column at 0.
function cut(text: string, node: Node): string {
  const column = node.start - (text.lastIndexOf('\n', node.start - 1) + 1);
  return text.slice(node.start, node.end).replaceAll(`\n${' '.repeat(column)}`, '\n');
}

export interface ImportedDevice {
  name: string;
  text: string;  // an item of `devices`
}

// Devices of an imported configuration, or the one that an imported list of channels or a template describes.
// `protocol` is that of their new bus; a device of a bus with a different protocol keeps that.
export function importedDevices(text: string, name: string, address: string, protocol: string): ImportedDevice[] {
  const tree = parseTree(text), found: ImportedDevice[] = [];
  const add = (path: Path, former = protocol): void => {
    for (const { key, node } of nodeAt(tree, path)?.children ?? []) {
      const own = valueAt(tree, [...path, key, 'protocol']) ?? former;
      if (node) found.push({ name: valueAt(tree, [...path, key, 'name']) ?? '', text: own === protocol ? cut(text, node) : setScalar(cut(text, node), ['protocol'], own, false) });
    }
  };
  for (const { key } of nodeAt(tree, ['buses'])?.children ?? []) add(['buses', key, 'devices'], valueAt(tree, ['buses', key, 'protocol']));
  add(['devices']);
  const channels = childOf(tree, 'channels');
  if (!found.length && channels?.node?.children.length)
    found.push({ name, text: `name: ${scalarText(name)}\naddress: ${scalarText(address, true)}\nchannels:\n  ${cut(text, channels.node).replaceAll('\n', '\n  ')}` });
  return found;
}

// Templates whose maker, model or name contains each word; those of the bus's protocol first.
export function matching(templates: readonly Template[], search: string, protocol: string): Template[] {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const fits = (template: Template): boolean => {
    const all = `${template.maker} ${template.model} ${template.name}`.toLowerCase();
    return words.every((word) => all.includes(word));
  };
  return templates.filter(fits).sort((a, b) => Number(speaks(b, protocol)) - Number(speaks(a, protocol)) || a.maker.localeCompare(b.maker) || a.model.localeCompare(b.model));
}

export const speaks = (template: Template, protocol: string): boolean =>
  !protocol || !template.protocol || template.protocol.split(/[\s,]+/).includes(protocol);
