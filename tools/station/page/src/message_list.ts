// The rules by which the station notifies of alarms, and the messages that it has sent or could not send, in a dialog; for operators. An
// engineer sends test messages. The rules are in the file of the station, which the page does not change.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { request } from './api';
import { duration, fullTime } from './format';
import { t, word } from './i18n';
import { html } from './markup';
import { errorText } from './view';

interface Target { name: string; kind: string; sent_ms: number | null; error: string }
interface Message { id: string; target: string; recipient: string; subject: string; state: string; made_ms: number | null; attempts: number; error: string }
interface Rule {
  name: string;
  to: string[];
  patterns: string[];
  priority: string;  // the least
  hours: string[];  // empty: always
  delay_ms: number;
  repeat_ms: number;  // 0: never
  repeats: number;
  cleared: boolean;
  escalate: { after_ms: number; to: string[] }[];
  digest: number;
  digest_within_ms: number;
}
interface Messages { waiting: number; lost: number; targets: Target[]; rules: Rule[]; messages: Message[] }

const mostShown = 20;
const resultAfter_ms = 1500;  // a test message was probably sent

const ruleRow = (rule: Rule): TemplateResult => html`<li><b>${rule.name}</b> → ${rule.to.join(', ')}: ${[
  rule.patterns.filter((pattern) => pattern !== '*/*/*').join(', '),
  rule.priority === 'low' ? '' : t('notify.priority', { priority: word('priority', rule.priority) }),
  rule.hours.join(', '),
  rule.delay_ms ? t('notify.delay', { time: duration(rule.delay_ms) }) : '',
  rule.repeat_ms ? t('notify.repeat', { time: duration(rule.repeat_ms), n: rule.repeats }) : '',
  ...rule.escalate.map(({ after_ms, to }) => t('notify.escalate', { time: duration(after_ms), to: to.join(', ') })),
  rule.cleared ? t('notify.cleared') : '',
  t('notify.digest', { n: rule.digest, time: duration(rule.digest_within_ms) }),
].filter(Boolean).join(' · ')}</li>`;

const messageRow = (message: Message): TemplateResult => html`<tr class=${message.error ? 'bad' : ''}><td>${message.made_ms ? fullTime(message.made_ms) : ''}</td>
  <td>${message.recipient || message.target}</td><td>${message.subject}</td>
  <td>${word('message', message.state)}${message.attempts > 1 ? ` (${message.attempts}×)` : ''} ${message.error}</td></tr>`;

export async function showMessages(mayTest: boolean): Promise<void> {
  const dialog = document.createElement('dialog');
  dialog.setAttribute('aria-labelledby', 'dialog-title');
  document.body.append(dialog);
  dialog.addEventListener('close', () => dialog.remove());
  const draw = (body: TemplateResult | string): void => void render(html`<form method="dialog"><h2 id="dialog-title">${t('alarms.messages')}</h2>
    <div class="dialog-body">${body}</div><div class="dialog-buttons"><button type="submit" class="primary">${t('close')}</button></div></form>`, dialog);
  const load = async (): Promise<void> => draw(await request<Messages>('/api/notifications').then(listOf, errorText));
  const test = async (target: string): Promise<void> => {
    try {
      await request('/api/notifications/test', { target });
      setTimeout(() => { if (dialog.isConnected) void load(); }, resultAfter_ms);
      await load();
    } catch (error) {
      draw(errorText(error));
    }
  };
  const targetRow = ({ name, sent_ms, error }: Target): TemplateResult => html`<li class=${error ? 'bad' : ''}>
    <b>${error ? '▲' : '✓'} ${name}</b> ${error || (sent_ms ? fullTime(sent_ms) : t('alarms.message-none-sent'))}
    ${mayTest ? html`<button type="button" class="plain" @click=${() => void test(name)}>${t('notify.test', { name })}</button>` : nothing}</li>`;
  const listOf = ({ waiting, lost, targets, rules, messages }: Messages): TemplateResult => (targets.length ? html`
    <p>${t('alarms.message-counts', { waiting, lost })}</p>
    <ul class="named">${targets.map(targetRow)}</ul>
    <div class="sent-messages"><table><tbody>${messages.slice(0, mostShown).map(messageRow)}</tbody></table></div>
    <h3>${t('notify.rules')}</h3><ul class="named">${rules.map(ruleRow)}</ul><p class="muted">${t('notify.file')}</p>` : html`<p>${t('alarms.message-nobody')}</p>`);
  draw(t('loading'));
  dialog.showModal();
  await load();
}
