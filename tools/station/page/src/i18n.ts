// Texts of the page in English and Chinese: key: [English, Chinese]. Each page has its own; the compiler checks that a key exists, and a
// test that both languages are there.

import type { texts as configuration } from './configuration/texts';  // of a script that loads later
import type { PageKey } from './pages';
import { printable } from './printable';
import { texts as causes } from './texts/causes';
import { texts as common } from './texts/common';

export const languages = { en: 'English', zh: '中文' } as const;
export type Language = keyof typeof languages;
export type Texts = Record<string, readonly [en: string, zh: string]>;
export type Key = keyof typeof common | keyof typeof causes | keyof typeof configuration | PageKey;

const table: Texts = { ...common, ...causes };
export const addTexts = (texts: Texts): void => void Object.assign(table, texts);
const textOf = (key: string): string | undefined => table[key]?.[language === 'en' ? 0 : 1];

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
  const text = textOf(key) ?? key;
  return values ? text.replace(/\{(\w+)\}/g, (whole, name: string) => printable(String(values[name] ?? whole))) : text;
}

// Returns a word of the station (a state, a cause) in the user's language, or unchanged if it has no text.
export function word(kind: string, value: string): string {
  return textOf(`${kind}.${value}`) ?? printable(value);
}
