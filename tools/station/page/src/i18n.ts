// Texts of the page in English and Chinese. Each page has a file in texts/ with a table for each language. The compiler checks that
// both have the same keys; a test checks that all keys are used.

import { printable } from './printable';
import * as alarms from './texts/alarms';
import * as audit from './texts/audit';
import * as causes from './texts/causes';
import * as channel from './texts/channel';
import * as common from './texts/common';
import * as devices from './texts/devices';
import * as history from './texts/history';
import * as live from './texts/live';
import * as login from './texts/login';
import * as overview from './texts/overview';
import * as plan from './texts/plan';
import * as programming from './texts/programming';

const modules = [common, causes, overview, live, channel, alarms, devices, programming, history, plan, audit, login] as const;
export const languages = { en: 'English', zh: '中文' } as const;
export type Language = keyof typeof languages;
export type Key = keyof typeof common.en | keyof typeof causes.en | keyof typeof overview.en | keyof typeof live.en | keyof typeof channel.en | keyof typeof alarms.en |
  keyof typeof devices.en | keyof typeof programming.en | keyof typeof history.en | keyof typeof plan.en | keyof typeof audit.en |
  keyof typeof login.en;

const tables: Record<Language, Record<string, string>> = {
  en: Object.assign({}, ...modules.map((each) => each.en)) as Record<string, string>,
  zh: Object.assign({}, ...modules.map((each) => each.zh)) as Record<string, string>,
};

function chosen(): Language {
  const kept = localStorage.getItem('fieldcast.language');
  if (kept === 'en' || kept === 'zh') return kept;
  return navigator.language.toLowerCase().startsWith('zh') ? 'zh' : 'en';
}

export let language: Language = chosen();

export function setLanguage(next: Language): void {
  language = next;
  localStorage.setItem('fieldcast.language', next);
}

// Returns the text of a key; {name} is replaced by a value.
export function t(key: Key, values?: Record<string, string | number>): string {
  const text = tables[language][key] ?? key;
  return values ? text.replace(/\{(\w+)\}/g, (whole, name: string) => printable(String(values[name] ?? whole))) : text;
}

// Returns a word of the station (a state, a cause) in the user's language, or unchanged if it has no text.
export function word(kind: string, value: string): string {
  return tables[language][`${kind}.${value}`] ?? printable(value);
}
