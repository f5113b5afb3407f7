// Alarm actions of the user: shows a dialog, sends the request to the station, and reports the outcome.

import type { TemplateResult } from 'lit-html';
import { request } from './api';
import type { Context } from './context';
import { t, word } from './i18n';
import { html } from './markup';
import { serverText } from './server_text';
import type { Alarm } from './types';
import { ask, errorText, limitBytes } from './view';

// Outcome of one request, or of one request for each alarm.
interface Accepted {
  request_id?: string | number;
  request_ids?: (string | number)[];
}

const mostNamed = 5;
const mostNoteBytes = 256;
const shelveFor_min = [15, 30, 60, 240, 480, 1440];
const maintenanceFor_min = [30, 60, 120, 240, 480, 1440];
const mostAtOnce = 200;  // alarms in one request

export const limitText = (alarm: { limit: string }): string => word('limit', alarm.limit);

async function perform(context: Context, path: string, bodies: readonly unknown[], done: string): Promise<void> {
  try {
    const ids = (await Promise.all(bodies.map((body) => request<Accepted>(path, body)))).flatMap(({ request_id, request_ids }) =>
      request_ids ?? (request_id === undefined ? [] : [request_id]));
    const results = await Promise.all(ids.map((id) => context.live.resultOf(id)));
    const failed = results.filter((result) => result.state !== 'done' && result.state !== 'verified');
    for (const reason of new Set(failed.map((result) => serverText(result.reason) || word('cause', result.cause))))
      context.say(t('alarms.failed', { what: done, reason }), true);
    if (!failed.length) context.say(done);
  } catch (error) {
    context.say(t('alarms.failed', { what: done, reason: errorText(error) }), true);
  }
}

const named = (alarms: readonly Alarm[]): TemplateResult => html`<ul class="named">
  ${alarms.slice(0, mostNamed).map((alarm) => html`<li>${alarm.bus}/${alarm.device}/${alarm.channel} <b>${limitText(alarm)}</b></li>`)}
  ${alarms.length > mostNamed ? html`<li class="muted">${t('alarms.and-more', { n: alarms.length - mostNamed })}</li>` : ''}</ul>`;

const noteField = (): TemplateResult => html`<label class="field">${t('alarms.note')}
  <input name="note" maxlength=${mostNoteBytes} @input=${limitBytes(mostNoteBytes)} autocomplete="off" autofocus></label>`;

export const lengthText = (minutes: number): string =>
  minutes < 60 ? t('alarms.minutes', { n: minutes }) : minutes < 1440 ? t('alarms.hours', { n: minutes / 60 }) : t('alarms.days', { n: minutes / 1440 });

const lengthField = (lengths: readonly number[], chosen: number): TemplateResult => html`<label class="field">${t('alarms.for')}
  <select name="minutes">${lengths.map((minutes) => html`<option value=${minutes} ?selected=${minutes === chosen}>${lengthText(minutes)}</option>`)}</select></label>`;

// Returns a body for each request, with at most mostAtOnce alarms.
function bodiesOf(alarms: readonly Alarm[], more: Record<string, unknown> = {}): unknown[] {
  const keys = alarms.map(({ bus, device, channel, limit, raised_ns }) => ({ bus, device, channel, limit, raised_ns }));
  const bodies: unknown[] = [];
  for (let from = 0; from < keys.length; from += mostAtOnce) bodies.push({ alarms: keys.slice(from, from + mostAtOnce), ...more });
  return bodies;
}

export async function acknowledge(context: Context, alarms: readonly Alarm[]): Promise<void> {
  const form = await ask({
    title: t('alarms.acknowledge-title', { n: alarms.length }), confirm: t('alarms.acknowledge'), body: html`${named(alarms)}${noteField()}` });
  if (form) await perform(context, '/api/alarms/acknowledge', bodiesOf(alarms, { note: form.get('note') }), t('alarms.acknowledged', { n: alarms.length }));
}

export async function shelve(context: Context, alarms: readonly Alarm[]): Promise<void> {
  const form = await ask({
    title: t('alarms.shelve-title', { n: alarms.length }), confirm: t('alarms.shelve'),
    body: html`${named(alarms)}<p class="muted">${t('alarms.shelve-hint')}</p>${lengthField(shelveFor_min, 60)}${noteField()}` });
  if (!form) return;
  const minutes = Number(form.get('minutes'));
  await perform(context, '/api/alarms/shelve', bodiesOf(alarms, { minutes, note: form.get('note') }),
    t('alarms.shelved', { n: alarms.length, time: lengthText(minutes) }));
}

export async function unshelve(context: Context, alarms: readonly Alarm[]): Promise<void> {
  await perform(context, '/api/alarms/unshelve', bodiesOf(alarms), t('alarms.unshelved', { n: alarms.length }));
}

// Starts maintenance of a device, which suppresses its alarms until it ends.
export async function startMaintenance(context: Context, bus: string, device: string): Promise<void> {
  const form = await ask({
    title: t('alarms.maintenance-title', { device: `${bus}/${device}` }), confirm: t('alarms.maintenance-start'),
    body: html`<p class="muted">${t('alarms.maintenance-hint')}</p>${lengthField(maintenanceFor_min, 120)}${noteField()}` });
  if (!form) return;
  const minutes = Number(form.get('minutes'));
  await perform(context, '/api/alarms/maintenance', [{ bus, device, minutes, note: form.get('note') }],
    t('alarms.maintenance-started', { device: `${bus}/${device}`, time: lengthText(minutes) }));
}

// Takes the device back from the engineer who programs it.
export async function endSession(context: Context, bus: string, device: string, who: string): Promise<void> {
  const form = await ask({
    title: t('programming.end-title', { device: `${bus}/${device}` }), confirm: t('programming.end'),
    body: html`<p>${t('programming.end-warning', { who })}</p>${noteField()}` });
  if (!form) return;
  await perform(context, '/api/sessions/end', [{ bus, device, note: form.get('note') }], t('programming.ended', { device: `${bus}/${device}` }));
}

export async function endMaintenance(context: Context, bus: string, device: string): Promise<void> {
  await perform(context, '/api/alarms/maintenance', [{ bus, device, minutes: 0, note: '' }], t('alarms.maintenance-ended', { device: `${bus}/${device}` }));
}

