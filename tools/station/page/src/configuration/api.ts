// The requests and messages of /api/configuration. Times are Unix ms.

import { query, request } from '../api';

export interface Protected {
  line: number;
  why: string;
}

export interface Watch {
  version: string;
  base?: string;  // the version that returns at a rollback; an older bridge does not name it
  until_ms: number | null;
  state: string;  // reloading, watching
}

export interface Configuration {
  bridge: string;
  path: string;
  version: string;
  text: string;
  files: { name: string; text: string }[];
  protected: Protected[];
  watch: Watch | null;
}

export interface Template {
  name: string;
  maker: string;
  model: string;
  protocol: string;
  text: string;
}

export interface Fault {
  file: string;
  line: number;
  column: number;
  message: string;
  hint: string;
}

export interface BusPlan {
  bus: string;
  load: number;
  feasible: boolean;
  worst: { channel: string; refresh_ms: number; gap_ms: number }[];
  infeasible: string[];
  remedies: string[];
}

export interface Checked {
  faults: Fault[];
  draft: BusPlan[];
  today: BusPlan[];
}

export interface Version {
  version: string;
  who: string;
  why: string;
  at_ms: number;
  state: string;  // found, watching, or how the watch ended
}

export interface Imported {
  text: string;
  moved: { from: string; to: string; change: string }[];
  refusals: { where: string; why: string }[];
  recognised: string[];
  notes: string[];
}

export interface Found {
  address: string;
  protocol: string;
  response: string;
  took_ms: number;
  identity?: string;  // what the device reports of itself; an older bridge does not read it
  templates: string[];  // that match its identity
}

export interface FirstValue {
  channel: string;
  value: unknown;
  unit: string;
  quality: string;
  error: string;
}

const root = '/api/configuration';

export const read = (bridge: string): Promise<Configuration> => request(query(root, { bridge }));
export const readSchema = (): Promise<object> => request(`${root}/schema`);
export const readTemplates = (): Promise<Template[]> => request(`${root}/templates`);
export const check = (bridge: string, text: string, signal?: AbortSignal): Promise<Checked> => request(`${root}/check`, { bridge, text }, signal);
export const deploy = (bridge: string, base: string, text: string, why: string): Promise<Omit<Watch, 'state'>> =>
  request(`${root}/deploy`, { bridge, base, text, why });
export const confirm = (bridge: string, version: string): Promise<unknown> => request(`${root}/confirm`, { bridge, version });
export const rollBack = (bridge: string, version: string, why: string): Promise<unknown> => request(`${root}/rollback`, { bridge, version, why });
// Newest first.
export const versions = (bridge: string): Promise<Version[]> => request(query(`${root}/versions`, { bridge }));
export const versionText = async (bridge: string, version: string): Promise<string> =>
  (await request<{ text: string }>(query(`${root}/version`, { bridge, version }))).text;
export const importFile = (name: string, content_base64: string): Promise<Imported> => request(`${root}/import`, { name, content_base64 });
export const scan = (bridge: string, bus: string, protocol: string, first: number, last: number): Promise<{ found: Found[]; next: number | null; error: string }> =>
  request(`${root}/scan`, { bridge, bus, protocol, first: String(first), last: String(last) });
export const probe = async (bridge: string, bus: string, device: string, text: string): Promise<FirstValue[]> =>
  (await request<{ values: FirstValue[] }>(`${root}/probe`, { bridge, bus, device, text })).values;
