// Changes one value of a YAML text and leaves every other character alone: comments, order and layout. Pure.

import { childOf, nodeAt, parseTree } from './yaml_tree';
import type { Child, Node, Path } from './yaml_tree';

const plain = /^[\p{L}\p{N}_./°³²%µ-](?:[\p{L}\p{N} _.+/°³²·%µ-]*[\p{L}\p{N}_.+/°³²·%µ-])?$/u;
const ambiguous = /^(?:true|false|null|yes|no|on|off|y|n|[-%].*|[-+.]?\d[\d_.eExXoO+-]*|0[xX][\da-fA-F]+|[-+]?\.(?:inf|nan))$/i;

// Returns the text of a scalar: `bare` if it is a number, true or false.
export const scalarText = (value: string, bare = false): string =>
  plain.test(value) && (bare || !ambiguous.test(value)) ? value : JSON.stringify(value);

const splice = (text: string, from: number, to: number, by: string): string => text.slice(0, from) + by + text.slice(to);
const lineBegin = (text: string, at: number): number => text.lastIndexOf('\n', at - 1) + 1;
const lineEnd = (text: string, at: number): number => {
  const end = text.indexOf('\n', at);
  return end < 0 ? text.length : end;
};
const columnOf = (text: string, at: number): number => at - lineBegin(text, at);
const indented = (lines: string, column: number): string => lines.replaceAll('\n', `\n${' '.repeat(column)}`);

// Adds text behind the last child: a line of its own in a block, behind a comma in braces or brackets.
function append(text: string, node: Node, written: string): string {
  const last = node.children.at(-1);
  if (node.flow) {
    if (last) return splice(text, last.end, last.end, `, ${written}`);
    const space = node.kind === 'map' ? ' ' : '';
    return splice(text, node.start + 1, node.end - 1, `${space}${written}${space}`);
  }
  const column = columnOf(text, node.children[0]!.start), at = lineEnd(text, last!.end);
  return splice(text, at, at, `\n${' '.repeat(column)}${indented(written, column)}`);
}

function replaceValue(text: string, child: Child, written: string): string {
  if (!child.node) return splice(text, child.colon, child.colon, ` ${written}`);
  return splice(text, child.node.start, child.node.end, written);
}

// Sets the value at a path. `written` is YAML text in one line. Missing maps on the way are created in braces.
export function setAt(text: string, path: Path, written: string): string {
  const root = parseTree(text);
  for (let depth = path.length - 1; depth >= 0; depth--) {
    const parent = depth === 0 ? root : nodeAt(root, path.slice(0, depth));
    const holder = depth === 0 ? undefined : childOf(nodeAt(root, path.slice(0, depth - 1)), path[depth - 1]!);
    const rest = path.slice(depth + 1).reduceRight<string>((inner, key) => `{ ${String(key)}: ${inner} }`, written);
    if (parent && parent.kind !== 'scalar') {
      const child = childOf(parent, path[depth]!);
      if (child) return replaceValue(text, child, rest);
      return append(text, parent, parent.kind === 'map' ? `${String(path[depth])}: ${rest}` : parent.flow ? rest : `- ${rest}`);
    }
    if (holder && !parent) return replaceValue(text, holder, `{ ${String(path[depth])}: ${rest} }`);
    if (parent) throw new Error(`${path.slice(0, depth).join('/')} has no keys`);
  }
  return text + (text && !text.endsWith('\n') ? '\n' : '') + path.slice(1).reduceRight<string>((inner, key) => `{ ${String(key)}: ${inner} }`, written).replace(/^/, `${String(path[0])}: `) + '\n';
}

// Sets a scalar; a value in quotes keeps its kind of quotes.
export function setScalar(text: string, path: Path, value: string, bare: boolean): string {
  const node = nodeAt(parseTree(text), path);
  const quote = node?.flow ? text[node.start] : '';
  return setAt(text, path, quote === '"' ? JSON.stringify(value) : quote === "'" ? `'${value.replaceAll("'", "''")}'` : scalarText(value, bare));
}

// Adds an item to the list at a path; `written` may have several lines.
export function addItem(text: string, path: Path, written: string): string {
  const list = nodeAt(parseTree(text), path);
  if (list?.kind === 'list' && (list.flow || list.children.length)) return append(text, list, list.flow ? written : `- ${indented(written, 2)}`);
  return setAt(text, path, `[ ${written} ]`);
}

// Removes a key or an item with its comment behind it. What was the only one leaves an empty map or list.
export function removeAt(text: string, path: Path): string {
  const parent = nodeAt(parseTree(text), path.slice(0, -1));
  const index = parent?.children.findIndex(({ key }) => key === path.at(-1)) ?? -1;
  if (!parent || index < 0) return text;
  const child = parent.children[index]!, before = parent.children[index - 1], after = parent.children[index + 1];
  if (parent.children.length === 1) return splice(text, parent.start, parent.end, parent.kind === 'map' ? '{}' : '[]');
  if (parent.flow) return before ? splice(text, before.end, child.end, '') : splice(text, child.start, after!.start, '');
  const begin = lineBegin(text, child.start);
  if (text.slice(begin, child.start).trim()) return splice(text, child.start, after!.start, '');  // behind the dash of an item
  return splice(text, begin, Math.min(text.length, lineEnd(text, child.end) + 1), '');
}
