// The watch after a deployment: its end, the bad channels of the bridge, confirmation and return.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import type { Context } from '../context';
import { t, word } from '../i18n';
import { html } from '../markup';
import { errorText } from '../view';
import * as api from './api';
import type { Configuration, Watch } from './api';

const readEvery_ms = 2000;
const watchFor_ms = 30_000;  // while the bridge reloads, the end is not known

export class Watching {
  private watch: Watch | undefined;
  private ended = '';  // version and how its watch ended
  private badBefore: number | undefined;  // before a deployment of this page
  private readAt = 0;
  private unsure = false;  // whether the bridge watches a deployment: it has not responded

  // `adopt` is called with each configuration that was read.
  constructor(private readonly context: Context, private readonly bridge: string, private readonly adopt: (read: Configuration) => void,
    private readonly drawn: () => void) {}

  get running(): boolean { return this.watch !== undefined; }

  // Bad channels of this bridge.
  badChannels(): number {
    const { plant } = this.context;
    return [...plant.count()].reduce((sum, [bus, { bad }]) => sum + (plant.buses.get(bus)?.bridge === this.bridge ? bad : 0), 0);
  }

  // Without `watch`, the next configuration that is read has it.
  begin(watch: Watch | undefined, badBefore: number): void {
    this.watch = watch;
    this.unsure = !watch;
    this.badBefore = badBefore;
    this.ended = '';
    this.readAt = performance.now();
  }

  // A configuration was read. Without a watch, the last one has ended; the list of versions has how.
  update({ watch }: Configuration): void {
    const before = this.watch;
    this.watch = watch ?? undefined;
    this.unsure = false;
    if (before && !watch) void this.end(before.version);
  }

  private async end(version: string): Promise<void> {
    const rows = await api.versions(this.bridge).catch(() => []);
    this.ended = t('configuration.ended', { version, state: word('version', rows.find((each) => each.version === version)?.state ?? 'ended') });
    this.drawn();
  }

  // The version before the watched one.
  private async rollBack(): Promise<void> {
    const { version, base } = this.watch!, rows = base ? [] : await api.versions(this.bridge);
    const former = base ?? rows[rows.findIndex((row) => row.version === version) + 1]?.version;
    if (former) await api.rollBack(this.bridge, former, t('configuration.roll-back-why'));
  }

  tick(): void {
    if ((this.running || this.unsure) && performance.now() - this.readAt > readEvery_ms) void this.read();
  }

  private async read(): Promise<void> {
    this.readAt = performance.now();
    // A failed request is repeated; the line below the head shows a lost connection.
    await api.read(this.bridge).then(this.adopt, () => undefined);
  }

  private async finish(action: () => Promise<unknown>): Promise<void> {
    await action().catch((error: unknown) => this.context.say(errorText(error), true));
    await this.read();
  }

  view(): TemplateResult {
    const { watch, badBefore } = this;
    if (!watch) return this.ended ? html`<section class="card watch" role="status">${this.ended}</section>` : html`${nothing}`;
    const left_s = Math.max(0, Math.ceil(((watch.until_ms ?? this.context.now() + watchFor_ms) - this.context.now()) / 1000)), { version } = watch;
    const bad = this.badChannels();
    return html`<section class="card watch" role="status" aria-live="off" tabindex="-1"><p>${t('configuration.watch', { version, s: left_s })}
        <b class=${bad > (badBefore ?? bad) ? 'bad' : ''}>${badBefore === undefined ? t('line.bad', { n: bad }) : t('configuration.bad-now', { n: bad, before: badBefore })}</b></p>
      <button type="button" class="primary" @click=${() => void this.finish(() => api.confirm(this.bridge, version))}>${t('configuration.keep')}</button>
      <button type="button" class="danger" @click=${() => void this.finish(() => this.rollBack())}>${t('configuration.roll-back')}</button></section>`;
  }
}
