// Elements shared by several pages: quality by shape, colour and text, bars of load, states, a confirmation dialog.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { percent } from './format';
import { t, word } from './i18n';
import { html } from './markup';
import { serverText } from './server_text';
import { isBad, notYetRead, qualities } from './types';

export type Tone = 'good' | 'warning' | 'bad' | 'unknown';
const shapes: Record<Tone, string> = { good: '●', warning: '◆', bad: '▲', unknown: '○' };

export const toneOfQuality = (quality: number): Tone =>
  quality === 0 ? 'good' : quality === notYetRead ? 'unknown' : isBad(quality) ? 'bad' : 'warning';
export const qualityText = (quality: number): string => word('quality', qualities[quality] ?? 'not-yet-read');

const tones: Record<string, Tone> = {
  running: 'good', opening: 'warning', leased: 'warning', closed: 'bad', stopped: 'unknown',
  online: 'good', degraded: 'warning', offline: 'bad', unknown: 'unknown',
};
export const toneOfState = (state: string): Tone => tones[state] ?? 'unknown';
export const shape = (tone: Tone): string => shapes[tone];

export const badge = (tone: Tone, text: string): TemplateResult =>
  html`<span class="badge ${tone}"><span class="shape" aria-hidden="true">${shapes[tone]}</span>${text}</span>`;
export const stateBadge = (state: string): TemplateResult => badge(toneOfState(state), word('state', state));

// A bar from 0 to 100 %; a higher value fills and marks it.
export function bar(name: string, label: string, share: number, hint = ''): TemplateResult {
  const width = Math.max(0, Math.min(1, share || 0)) * 100;
  const tone = share > 1 ? 'bad' : share > 0.85 ? 'warning' : '';
  return html`<div class="bar ${name} ${tone}" title=${hint}>
    <span class="bar-label">${label}</span>
    <svg class="bar-track" viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true">
      <rect class="bar-back" width="100" height="4"></rect><rect class="bar-fill" width=${width.toFixed(1)} height="4"></rect>
    </svg>
    <span class="bar-number">${Number.isFinite(share) ? percent(share) : '–'}</span>
  </div>`;
}

export const fact = (name: string, value: unknown, wide = false): TemplateResult =>
  html`<div class=${wide ? 'fact wide' : 'fact'}><dt>${name}</dt><dd>${value}</dd></div>`;

export interface Question {
  title: string;
  body: unknown;  // a template
  confirm: string;
  danger?: boolean;
}

// Shows a modal dialog; resolves with the form's data, or undefined if it was cancelled.
export function ask(question: Question): Promise<FormData | undefined> {
  const dialog = document.createElement('dialog');
  dialog.setAttribute('aria-labelledby', 'dialog-title');
  document.body.append(dialog);
  return new Promise((resolve) => {
    let answer: FormData | undefined;
    const submit = (event: Event): void => {
      event.preventDefault();
      answer = new FormData(event.target as HTMLFormElement);
      dialog.close();
    };
    render(html`<form method="dialog" @submit=${submit}>
      <h2 id="dialog-title">${question.title}</h2>
      <div class="dialog-body">${question.body}</div>
      <div class="dialog-buttons">
        <button type="button" class="plain" @click=${() => dialog.close()}>${t('cancel')}</button>
        <button type="submit" class=${question.danger ? 'danger' : 'primary'}>${question.confirm}</button>
      </div>
    </form>`, dialog);
    dialog.addEventListener('close', () => {
      dialog.remove();
      resolve(answer);
    });
    dialog.showModal();
  });
}

// For @input of a text field: the station limits bytes of UTF-8, `maxlength` limits UTF-16 units.
export const limitBytes = (most: number) => (event: Event): void => {
  const field = event.target as HTMLInputElement;
  const isTooLong = new TextEncoder().encode(field.value).length > most;
  field.setCustomValidity(isTooLong ? t('too-long', { most }) : '');
};

export const empty = (text: string, hint = ''): TemplateResult =>
  html`<div class="empty"><p>${text}</p>${hint ? html`<p class="muted">${hint}</p>` : nothing}</div>`;

export function errorText(error: unknown): string {
  const told = error as { message?: string; hint?: string; status?: number };
  const message = told.message === 'unreachable' || told.message === 'lost' ? t('error.lost') : told.message === 'no-result' ? t('error.no-result') : serverText(told.message ?? String(error));
  return told.hint ? `${message} ${serverText(told.hint)}` : message;
}

export function makeElement(className: string): HTMLElement {
  const element = document.createElement('div');
  element.className = `page ${className}`;
  return element;
}
