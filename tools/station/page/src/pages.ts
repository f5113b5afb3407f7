// The pages, one row each. A page is at #/NAME; its title is its text NAME.title, unless it makes one. A page with a key is in the
// head, and g with that key opens it. Another page belongs to the page of the head that `under` names.

import type { MakePage } from './context';
import { addTexts } from './i18n';
import type { Texts } from './i18n';
import * as alarms from './pages/alarms';
import * as audit from './pages/audit';
import * as channel from './pages/channel';
import * as configuration from './pages/configuration';
import * as dashboard from './pages/dashboard';
import * as dashboards from './pages/dashboards';
import * as devices from './pages/devices';
import * as history from './pages/history';
import * as live from './pages/live';
import * as login from './pages/login';
import * as overview from './pages/overview';
import * as plan from './pages/plan';
import * as programming from './pages/programming';
import * as reports from './pages/reports';

interface Row {
  name: string;
  module: { page: MakePage; texts: Texts };
  key?: string;
  under?: string;
  engineer?: boolean;  // only engineers have it in the head
  doc?: string;  // its document in docs/, otherwise station.md
}

const rows = [
  { name: 'overview', module: overview, key: 'o' },
  { name: 'live', module: live, key: 'l' },
  { name: 'dashboards', module: dashboards, key: 'b', doc: 'dashboards.md' },
  { name: 'alarms', module: alarms, key: 'a', doc: 'alarms.md' },
  { name: 'devices', module: devices, key: 'd', doc: 'troubleshooting.md' },
  { name: 'programming', module: programming, key: 'p', doc: 'programming.md' },
  { name: 'history', module: history, key: 'h', doc: 'store.md' },
  { name: 'reports', module: reports, key: 'r' },
  { name: 'audit', module: audit, key: 'u' },
  { name: 'configuration', module: configuration, key: 'c', engineer: true },
  { name: 'channel', module: channel, under: 'live', doc: 'qualities.md' },
  { name: 'dashboard', module: dashboard, under: 'dashboards', doc: 'dashboards.md' },
  { name: 'plan', module: plan, under: 'overview', doc: 'troubleshooting.md' },
  { name: 'login', module: login },
] as const satisfies readonly Row[];

type KeyOf<Table> = Table extends unknown ? keyof Table : never;
export type PageKey = KeyOf<(typeof rows)[number]['module']['texts']>;

export const pages: readonly Row[] = rows;
for (const { module } of pages) addTexts(module.texts);

export const pageOf = (name: string): Row | undefined => pages.find((each) => each.name === name);
