// Wall screens that show pages in turn: ?kiosk=overview,dashboard/pumps;pump=1,dashboard/pumps;pump=2&every=20. Pure.

import { link } from './router';
import type { Route } from './router';

interface Turn {
  name: string;
  parts: string[];
  parameters: Record<string, string>;
}

function turnOf(entry: string): Turn {
  const [path = '', ...pairs] = entry.split(';');
  const [name = '', ...parts] = path.split('/').filter(Boolean);
  return { name, parts, parameters: Object.fromEntries(pairs.map((pair) => [pair.split('=', 1)[0] ?? '', pair.slice(pair.indexOf('=') + 1)])) };
}

const isAt = ({ name, parts, parameters }: Turn, route: Route): boolean =>
  name === route.name && parts.join('/') === route.parts.join('/') &&
  Object.entries(parameters).every(([key, value]) => route.query.get(key) === value);

// Returns the address of the page after the shown one; undefined if fewer than two pages take turns.
export function nextTurn(route: Route, exists: (name: string) => boolean): string | undefined {
  const turns = (route.query.get('kiosk') ?? '').split(',').map(turnOf).filter(({ name }) => exists(name));
  if (turns.length < 2) return undefined;
  const { name, parts, parameters } = turns[(turns.findIndex((turn) => isAt(turn, route)) + 1) % turns.length]!;
  const kept: Record<string, string> = {};
  for (const key of ['kiosk', 'every']) if (route.query.has(key)) kept[key] = route.query.get(key)!;
  return link(name, parts, { ...parameters, ...kept });
}
