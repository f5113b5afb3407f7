// The text of a dashboard and its parts. The station checks every text with the same table of kinds, so nothing is checked here.
// Pure.

import table from '../../../dashboard/dashboard_format.json';
import type { Cells } from './grid';

export interface PropertyRow {
  name?: string;  // an item of a list has none
  type: string;
  required?: boolean;
  min?: number;
  max?: number;
  choices?: readonly string[];
  of?: PropertyRow | readonly PropertyRow[];  // the item of a list, or the members of an object
}

export interface Kind {
  size: readonly number[];  // usual width and height in cells
  properties: readonly PropertyRow[];
}

export interface Widget {
  kind: string;
  at: Cells;
  title?: string;
  [property: string]: unknown;
}

export interface Parameter {
  name: string;
  title?: string;
  default: string;
  values?: string[];
}

export interface Dashboard {
  name: string;
  title: string;
  parameters?: Parameter[];
  grid?: { columns?: number; row_px?: number };
  widgets: Widget[];
}

export type Values = Readonly<Record<string, string>>;  // of parameters

export const kinds: Readonly<Record<string, Kind>> = table.kinds as unknown as Record<string, Kind>;
export const parameterRow = table.document.find((row) => row.name === 'parameters') as PropertyRow;

export const columnsOf = (dashboard: Dashboard): number => dashboard.grid?.columns ?? 12;
export const rowOf = (dashboard: Dashboard): number => dashboard.grid?.row_px ?? 40;

const word = /^[^/*$?&#{}]{1,64}$/;

// Takes the values of the address; an unknown or impossible value is replaced by the default.
export function valuesOf(dashboard: Dashboard, query: URLSearchParams): Values {
  const values: Record<string, string> = {};
  for (const parameter of dashboard.parameters ?? []) {
    const given = query.get(parameter.name) ?? '';
    const fits = parameter.values?.length ? parameter.values.includes(given) : word.test(given);
    values[parameter.name] = fits ? given : parameter.default;
  }
  return values;
}

// Replaces ${name} in every text of a widget.
export function filled<T>(value: T, values: Values): T {
  if (typeof value === 'string') return value.replace(/\$\{([a-z0-9-]+)\}/g, (whole, name: string) => values[name] ?? whole) as T;
  if (Array.isArray(value)) return value.map((item) => filled(item as unknown, values)) as T;
  if (value === null || typeof value !== 'object') return value;
  return Object.fromEntries(Object.entries(value).map(([name, item]) => [name, filled(item as unknown, values)])) as T;
}

// One widget or parameter in each line, so that a difference of two versions is readable.
export function printed(dashboard: Dashboard): string {
  const list = (items: readonly unknown[]): string => (items.length ? `[\n${items.map((item) => `    ${JSON.stringify(item)}`).join(',\n')}\n  ]` : '[]');
  const members = Object.entries(dashboard).filter(([, value]) => value !== undefined)
    .map(([name, value]) => `  ${JSON.stringify(name)}: ${Array.isArray(value) ? list(value) : JSON.stringify(value)}`);
  return `{\n${members.join(',\n')}\n}\n`;
}

export const emptyDashboard = (name: string, title: string): Dashboard => ({ name, title, grid: { columns: 12, row_px: 40 }, widgets: [] });

export const isName = (text: string): boolean => /^[a-z0-9][a-z0-9-]{0,63}$/.test(text);
