// The tree of a YAML text with the position of each key and value. It is built from the tokens of the parser, so that a text with
// faults has a tree too. The station's loader decides what is valid. Pure.

import type { CST } from 'yaml';
import { Parser } from 'yaml-parser';
import { resolveFlowScalar } from 'yaml-scalar';

export type Path = readonly (string | number)[];

export interface Child {
  key: string | number;  // of a map; index in a sequence
  start: number;  // of the key; of the dash of a sequence
  colon: number;  // position behind the colon or the dash
  end: number;  // of the value, without a comment behind it
  node: Node | undefined;  // undefined: no value
}

export interface Node {
  kind: 'map' | 'list' | 'scalar';
  flow: boolean;  // in braces, brackets or quotes
  start: number;
  end: number;
  value: string;  // of a scalar, without quotes
  children: Child[];
}

const sizeOf = (tokens: readonly CST.SourceToken[] = []): number => tokens.reduce((sum, { source }) => sum + source.length, 0);
const find = (tokens: readonly CST.SourceToken[] | undefined, type: string): CST.SourceToken | undefined => tokens?.find((each) => each.type === type);

function scalar(token: CST.FlowScalar): Node {
  const start = token.offset, end = start + token.source.length;
  const value = token.type === 'alias' ? token.source : resolveFlowScalar(token, false, () => undefined).value;
  return { kind: 'scalar', flow: token.type.endsWith('quoted-scalar'), start, end, value, children: [] };
}

function childrenOf(items: readonly CST.CollectionItem[], list: boolean, flow: boolean): Child[] {
  const children: Child[] = [];
  for (const item of items) {
    const mark = list ? find(item.start, 'seq-item-ind') : find(item.sep as CST.SourceToken[] | undefined, 'map-value-ind');
    const token = list ? item.value ?? item.key : item.key;
    const node = nodeOf(list ? token : item.value);
    if (!token && !mark) continue;  // a comment, or the place behind the last comma
    const key = list ? undefined : nodeOf(item.key);
    const start = list && !flow ? mark!.offset : key?.start ?? node?.start ?? mark!.offset;
    const colon = mark ? mark.offset + mark.source.length : key?.end ?? start;
    children.push({ key: list ? children.length : key?.value ?? '', start, colon, end: node?.end ?? colon, node });
  }
  return children;
}

function collection(token: CST.BlockMap | CST.BlockSequence | CST.FlowCollection): Node {
  const flow = token.type === 'flow-collection';
  const list = token.type === 'block-seq' || (flow && token.start.source === '[');
  const children = childrenOf(token.items, list, flow);
  const close = flow ? token.end.find(({ type }) => type === 'flow-map-end' || type === 'flow-seq-end') : undefined;
  const start = flow ? token.start.offset : children[0]?.start ?? token.offset;
  return { kind: list ? 'list' : 'map', flow, start, end: close ? close.offset + 1 : children.at(-1)?.end ?? start + 1, value: '', children };
}

function nodeOf(token: CST.Token | null | undefined): Node | undefined {
  switch (token?.type) {
    case 'alias': case 'scalar': case 'single-quoted-scalar': case 'double-quoted-scalar': return scalar(token);
    case 'block-map': case 'block-seq': case 'flow-collection': return collection(token);
    case 'block-scalar': {
      const end = token.offset + sizeOf(token.props as CST.SourceToken[]) + token.source.trimEnd().length;
      return { kind: 'scalar', flow: false, start: token.offset, end, value: token.source, children: [] };
    }
    default: return undefined;
  }
}

function parse(text: string): Node | undefined {
  for (const token of new Parser().parse(text))
    if (token.type === 'document') return nodeOf(token.value);
  return undefined;
}

let last: { text: string; root: Node | undefined } = { text: '', root: undefined };

// Undefined if the text has no content. The last tree is kept: 10 000 channels take half a second.
export function parseTree(text: string): Node | undefined {
  if (text !== last.text) last = { text, root: parse(text) };
  return last.root;
}

export const childOf = (node: Node | undefined, key: string | number): Child | undefined => node?.children.find((each) => each.key === key);

export function nodeAt(root: Node | undefined, path: Path): Node | undefined {
  return path.reduce<Node | undefined>((node, key) => childOf(node, key)?.node, root);
}

export const valueAt = (root: Node | undefined, path: Path): string | undefined => {
  const node = nodeAt(root, path);
  return node?.kind === 'scalar' ? node.value : undefined;
};

// Returns the path of the deepest key or item that contains the position. A line belongs to a key also before its first character.
export function pathAt(text: string, root: Node | undefined, offset: number): (string | number)[] {
  const path: (string | number)[] = [];
  const beginOf = (child: Child): number => {
    const line = text.lastIndexOf('\n', child.start - 1) + 1;
    return text.slice(line, child.start).trim() ? child.start : line;
  };
  for (let node = root; node;) {
    if (node.flow && (offset <= node.start || offset >= node.end)) break;
    const child: Child | undefined = node.children.findLast((each) => (node!.flow ? each.start : beginOf(each)) <= offset);
    if (!child || (node.flow && offset > child.end)) break;
    path.push(child.key);
    node = child.node;
  }
  return path;
}

export const lineOf = (text: string, offset: number): number => text.slice(0, offset).split('\n').length;
