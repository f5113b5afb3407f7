// Proposals of keys and values at the cursor. Pure.

import { keysAt, valuesAt } from './schema';
import type { Proposal, Schema } from './schema';
import { nodeAt, parseTree } from './yaml_tree';
import type { Node, Path } from './yaml_tree';

export interface Completion {
  from: number;  // the word that a proposal replaces
  to: number;
  behind: string;  // is written behind a proposal
  proposals: Proposal[];
}

const mark = 'fieldcast-cursor';
const mostProposals = 40;

// Path of the key or scalar with the text `mark`.
function pathOfMark(node: Node | undefined, path: Path = []): Path | undefined {
  if (!node) return undefined;
  if (node.kind === 'scalar') return node.value === mark ? path : undefined;
  for (const child of node.children) {
    if (child.key === mark) return path;
    const found = pathOfMark(child.node, [...path, child.key]);
    if (found) return found;
  }
  return undefined;
}

export function complete(text: string, offset: number, schema: Schema): Completion | undefined {
  const from = offset - /[\w.-]*$/.exec(text.slice(text.lastIndexOf('\n', offset - 1) + 1, offset))![0].length;
  const to = offset + /^[\w.-]*/.exec(text.slice(offset))![0].length;
  const before = text.slice(text.lastIndexOf('\n', from - 1) + 1, from);
  if (/(^|\s)#/.test(before)) return undefined;
  const typed = text.slice(from, offset).toLowerCase();
  const value = /:[ \t]+$|\[[^\]{]*$/.test(before);
  const hasColon = /^[ \t]*:/.test(text.slice(to));
  const root = parseTree(text.slice(0, from) + mark + (value || hasColon ? '' : ': 0') + text.slice(to));
  const path = pathOfMark(root);
  if (!path) return undefined;
  const taken = new Set(nodeAt(root, path)?.children.map(({ key }) => String(key)));
  const all = value ? valuesAt(schema, path) : keysAt(schema, path, taken);
  const proposals = all.filter(({ text: each }) => each.toLowerCase().includes(typed))
    .sort((a, b) => Number(b.text.toLowerCase().startsWith(typed)) - Number(a.text.toLowerCase().startsWith(typed))).slice(0, mostProposals);
  return proposals.length ? { from, to, behind: value || hasColon ? '' : ': ', proposals } : undefined;
}
