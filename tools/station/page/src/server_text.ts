// Messages of station and bridge in the language of the user. Pure except for the language.

import { language } from './i18n';
import { messages } from './texts/server';

const escaped = (text: string): string => text.replace(/[\\^$.*+?()[\]{}|]/g, '\\$&');
let patterns: { pattern: RegExp; zh: string }[] | undefined;

// A message without a text is returned unchanged.
export function serverText(text: string): string {
  if (language !== 'zh') return text;
  patterns ??= messages.map(([en, zh]) => ({ pattern: new RegExp(`^${en.split('{}').map(escaped).join('(.+?)')}$`, 's'), zh }));
  for (const { pattern, zh } of patterns) {
    const parts = pattern.exec(text)?.slice(1);
    if (!parts) continue;
    let next = 0;
    return zh.replace(/\{(\d?)\}/g, (_, index: string) => parts[index ? Number(index) : next++] ?? '');
  }
  return text;
}
