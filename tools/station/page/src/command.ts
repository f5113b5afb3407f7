// Writes of the user: the confirmation, and the outcome as a text.

import type { Context } from './context';
import { duration } from './format';
import { t, word } from './i18n';
import { html } from './markup';
import { serverText } from './server_text';
import type { Result } from './types';
import { ask, errorText } from './view';

export interface Outcome {
  text: string;
  bad: boolean;
}

// Shows the channel and both values; resolves with true if the user confirms.
export async function confirmWrite(path: string, from: string, to: string, what = ''): Promise<boolean> {
  const form = await ask({
    title: what || t('channel.confirm-title'), confirm: t('channel.write'), danger: true,
    body: html`<p><b>${path}</b></p><p class="from-to">${t('channel.from-to', { from, to })}</p>`,
  });
  return form !== undefined;
}

export async function outcomeOf(command: Promise<Result>): Promise<Outcome> {
  const started = performance.now();
  try {
    const result = await command;
    const bad = !['done', 'verified'].includes(result.state);
    const reason = bad ? [result.cause === 'NONE' ? '' : word('cause', result.cause), serverText(result.reason)].filter(Boolean).join(': ') : '';
    const value = result.value === null || result.value === undefined ? '' : Array.isArray(result.value) ? result.value.join(' ') : String(result.value);
    return { bad, text: [word('result', result.state), reason, value && `= ${value}`, `(${duration(Math.round(performance.now() - started))})`].filter(Boolean).join(' ') };
  } catch (error) {
    return { bad: true, text: errorText(error) };
  }
}

export type WrittenValue = string | number | boolean | bigint;
export const writeOutcome = (context: Context, path: string, value: WrittenValue, verify: boolean): Promise<Outcome> =>
  outcomeOf(context.live.write(path, value, verify));
