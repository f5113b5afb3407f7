// The faults of a draft: a list that leads to their places, and the fault of each key for the form.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { t } from '../i18n';
import { html } from '../markup';
import { badge } from '../view';
import type { Fault, Protected } from './api';
import { keyOf } from './form';
import { pathAt } from './yaml_tree';
import type { Node } from './yaml_tree';

const mostFaults = 100;

export const sentenceOf = ({ message, hint }: Fault): string => [message, hint].filter(Boolean).join('; ');

export function faultsByKey(faults: readonly Fault[], text: string, tree: Node | undefined): Map<string, string> {
  const found = new Map<string, string>();
  if (!faults.length) return found;
  const lines = text.split('\n');
  for (const fault of faults.slice(0, mostFaults)) {
    const begin = lines.slice(0, fault.line - 1).reduce((sum, each) => sum + each.length + 1, 0);
    found.set(keyOf(pathAt(text, tree, begin + Math.max(0, fault.column - 1))), sentenceOf(fault));
  }
  return found;
}

export interface Faults {
  failure: string;  // of the request
  checking: boolean;
  faults: readonly Fault[];
  lost: readonly Protected[];  // protected lines that the draft has changed
  inText(fault: Fault): boolean;
  show(fault: Fault): void;
  undo(): void;
}

export function faultList({ failure, checking, faults, lost, inText, show, undo }: Faults): TemplateResult {
  const summary = failure || (checking ? t('configuration.checking') :
    faults.length === 0 ? t('configuration.no-faults') : faults.length === 1 ? t('configuration.fault') : t('configuration.faults', { n: faults.length }));
  return html`<section class="faults"><p role="status">${badge(failure || faults.length ? 'bad' : checking ? 'unknown' : 'good', summary)}</p>
    ${lost.length ? html`<p class="bad">▲ ${lost.map(({ line, why }) => t('configuration.protected', { line, why })).join(' ')}
      <button type="button" @click=${undo}>${t('configuration.undo')}</button></p>` : nothing}
    ${faults.length ? html`<ul>${faults.slice(0, mostFaults).map((fault) => {
      const text = html`<code>${`${fault.file}:${fault.line}:${fault.column}`}</code> ${fault.message} <span class="muted">${fault.hint}</span>`;
      return html`<li>${inText(fault) ? html`<button type="button" class="plain" @click=${() => show(fault)}>${text}</button>` : text}</li>`;
    })}</ul>` : nothing}</section>`;
}
