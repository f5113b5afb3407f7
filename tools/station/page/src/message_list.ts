// The messages about alarms that the station has sent or could not send, in a dialog; for operators.

import { render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { request } from './api';
import { fullTime } from './format';
import { t, word } from './i18n';
import { html } from './markup';
import { errorText } from './view';

interface Target { name: string; kind: string; sent_ms: number | null; error: string }
interface Message { id: string; target: string; recipient: string; subject: string; state: string; made_ms: number | null; attempts: number; error: string }
interface Messages { waiting: number; lost: number; targets: Target[]; messages: Message[] }

const mostShown = 20;

const targetRow = (target: Target): TemplateResult => html`<li class=${target.error ? 'bad' : ''}>
  <b>${target.error ? '▲' : '✓'} ${target.name}</b> ${target.error || (target.sent_ms ? fullTime(target.sent_ms) : t('alarms.message-none-sent'))}</li>`;

const messageRow = (message: Message): TemplateResult => html`<tr class=${message.error ? 'bad' : ''}><td>${message.made_ms ? fullTime(message.made_ms) : ''}</td>
  <td>${message.recipient || message.target}</td><td>${message.subject}</td>
  <td>${word('message', message.state)}${message.attempts > 1 ? ` (${message.attempts}×)` : ''} ${message.error}</td></tr>`;

const listOf = ({ waiting, lost, targets, messages }: Messages): TemplateResult => (targets.length ? html`
  <p>${t('alarms.message-counts', { waiting, lost })}</p>
  <ul class="named">${targets.map(targetRow)}</ul>
  <div class="sent-messages"><table><tbody>${messages.slice(0, mostShown).map(messageRow)}</tbody></table></div>` : html`<p>${t('alarms.message-nobody')}</p>`);

export async function showMessages(): Promise<void> {
  const dialog = document.createElement('dialog');
  dialog.setAttribute('aria-labelledby', 'dialog-title');
  document.body.append(dialog);
  dialog.addEventListener('close', () => dialog.remove());
  const draw = (body: TemplateResult | string): void => void render(html`<form method="dialog"><h2 id="dialog-title">${t('alarms.messages')}</h2>
    <div class="dialog-body">${body}</div><div class="dialog-buttons"><button type="submit" class="primary">${t('close')}</button></div></form>`, dialog);
  draw(t('loading'));
  dialog.showModal();
  await request<Messages>('/api/notifications').then((answer) => draw(listOf(answer)), (error: unknown) => draw(errorText(error)));
}
