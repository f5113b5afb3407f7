// Chooses the object of the form: the bridge, a bus, a device, or a channel. Pure parts first.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { t } from '../i18n';
import { html } from '../markup';
import { nodeAt, valueAt } from './yaml_tree';
import type { Node, Path } from './yaml_tree';

export const levels = ['buses', 'devices', 'channels'] as const;

// The object that contains a path: [], a bus, a device, or a channel.
export function objectOf(path: Path): Path {
  let length = 0;
  while (path[length] === levels[length / 2] && typeof path[length + 1] === 'number') length += 2;
  return path.slice(0, length);
}

// Names of the objects in the list at a path; undefined if there is no list.
export const namesAt = (tree: Node | undefined, path: Path): string[] | undefined => {
  const list = nodeAt(tree, path);
  return list?.kind === 'list' ? list.children.map(({ key }) => valueAt(tree, [...path, key, 'name']) ?? `#${Number(key) + 1}`) : undefined;
};

export const nameOf = (tree: Node | undefined, path: Path): string => valueAt(tree, [...path, 'name']) ?? '';

// Returns `wanted`, with a number behind it if the name is taken.
export function freeName(wanted: string, taken: readonly string[]): string {
  if (!taken.includes(wanted)) return wanted;
  for (let n = 2; ; n++) if (!taken.includes(`${wanted}-${n}`)) return `${wanted}-${n}`;
}

// The next address on a bus: behind the largest number.
export function freeAddress(tree: Node | undefined, bus: Path): string {
  const list = nodeAt(tree, [...bus, 'devices']);
  const numbers = (list?.children ?? []).map(({ key }) => Number(valueAt(tree, [...bus, 'devices', key, 'address']))).filter(Number.isInteger);
  return String(Math.max(0, ...numbers) + 1);
}

const labels = ['configuration.bus', 'configuration.device', 'configuration.channel'] as const;

export function outline(tree: Node | undefined, chosen: Path, choose: (path: Path) => void): TemplateResult {
  return html`<div class="outline" role="group" aria-label=${t('configuration.object')}>${levels.map((level, depth) => {
    const parent = chosen.slice(0, 2 * depth), path = [...parent, level];
    const names = parent.length === 2 * depth ? namesAt(tree, path) : undefined;
    if (!names) return nothing;
    const at = chosen[2 * depth + 1];
    const change = (event: Event): void => {
      const { value } = event.target as HTMLSelectElement;
      choose(value === '' ? parent : [...path, Number(value)]);
    };
    return html`<label>${t(labels[depth]!)} <select @change=${change}>
      <option value="" ?selected=${at === undefined}>${t('configuration.all')}</option>
      ${names.map((name, index) => html`<option value=${index} ?selected=${index === at}>${name}</option>`)}</select></label>`;
  })}</div>`;
}
