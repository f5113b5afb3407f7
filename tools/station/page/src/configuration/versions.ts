// The deployed versions of a configuration: who, why, what changed, download, return.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { csvText, csvTime, save } from '../csv';
import { time } from '../format';
import { t, word } from '../i18n';
import { html } from '../markup';
import { empty, errorText } from '../view';
import * as api from './api';
import type { Configuration, Version } from './api';
import { askReturn } from './deploy';
import { diffView } from './diff_view';
import { tarOf } from './tar';

const columns = ['configuration.version', 'configuration.when', 'configuration.who', 'configuration.why', 'configuration.state'] as const;

const failed = /^(rolled back|not deployed|not in force)\b/;  // no later version replaced it

export interface VersionsHost {
  bridge: string;
  now(): number;
  draw(): void;
  say(text: string, bad?: boolean): void;
  returned(): void;  // a former version was deployed
}

export class Versions {
  private list: readonly Version[] | undefined;
  private fault = '';
  private shown: { version: string; before: string; after: string } | undefined;

  constructor(private readonly host: VersionsHost) {
    void this.load();
  }

  private async load(): Promise<void> {
    try {
      this.list = await api.versions(this.host.bridge);
    } catch (error) {
      this.fault = errorText(error);
    }
    this.host.draw();
  }

  private async run(action: () => Promise<void>): Promise<void> {
    try {
      await action();
    } catch (error) {
      this.host.say(errorText(error), true);
    }
    this.host.draw();
  }

  private readonly show = (version: string): Promise<void> => this.run(async () => {
    const list = this.list ?? [], before = list.slice(list.findIndex((each) => each.version === version) + 1).find(({ state }) => !failed.test(state));
    const text = (of: string): Promise<string> => api.versionText(this.host.bridge, of);
    this.shown = { version, before: before ? await text(before.version) : '', after: await text(version) };
  });

  private readonly download = (version: string): Promise<void> => this.run(async () =>
    save(`${this.host.bridge}-${version}.yaml`, await api.versionText(this.host.bridge, version), 'application/yaml'));

  // An archive of what is in force, every kept version, and who deployed it and why.
  private readonly downloadAll = ({ bridge, path, text, files, version }: Configuration): Promise<void> => this.run(async () => {
    const list = this.list!, at_ms = list.find((each) => each.version === version)?.at_ms ?? this.host.now();
    const former = [];
    for (const each of list) former.push({ name: `${bridge}/versions/${each.version}.yaml`, text: await api.versionText(bridge, each.version), at_ms: each.at_ms });
    const rows = list.map((each) => [each.version, csvTime(each.at_ms), each.who, each.why, each.state]);
    save(`${bridge}.tar`, tarOf([
      { name: `${bridge}/${path.split('/').pop()}`, text, at_ms }, ...files.map((file) => ({ name: `${bridge}/${file.name}`, text: file.text, at_ms })), ...former,
      { name: `${bridge}/versions.csv`, text: csvText(['version', 'time', 'who', 'why', 'state'], rows), at_ms: this.host.now() }]), 'application/x-tar');
  });

  private readonly goBack = (version: string): Promise<void> => this.run(async () => {
    const why = await askReturn(version);
    if (why === undefined) return;
    await api.rollBack(this.host.bridge, version, why);
    this.host.returned();
    await this.load();
  });

  view(configuration: Configuration): TemplateResult {
    const current = configuration.version;
    if (!this.list) return empty(this.fault || t('loading'));
    if (!this.list.length) return empty(t('configuration.no-versions'));
    const { shown } = this;
    return html`<div class="tools"><button type="button" @click=${() => void this.downloadAll(configuration)}>${t('configuration.download-all')}</button></div>
      <div class="scroll" data-scroll tabindex="0" role="region" aria-label=${t('configuration.versions')}><table class="plain versions">
      <thead><tr>${columns.map((name) => html`<th scope="col">${t(name)}</th>`)}<td></td></tr></thead>
      <tbody>${this.list.map(({ version, at_ms, who, why, state }) => html`<tr>
        <th scope="row">${version}</th><td>${time(at_ms, this.host.now())}</td><td>${who}</td><td>${why}</td>
        <td>${version === current ? html`<b>${word('version', 'current')}</b> ` : nothing}${word('version', state)}</td>
        <td class="buttons"><button type="button" aria-label=${t('configuration.show-of', { version })} @click=${() => void this.show(version)}>${t('configuration.show')}</button>
          <button type="button" aria-label=${t('configuration.download-of', { version })} @click=${() => void this.download(version)}>${t('configuration.download')}</button>
          <button type="button" aria-label=${t('configuration.return-of', { version })} ?disabled=${version === current} @click=${() => void this.goBack(version)}>${t('configuration.return')}</button></td></tr>`)}</tbody></table></div>
      ${shown ? html`<section class="card"><h2>${t('configuration.show-of', { version: shown.version })}</h2>
        ${shown.before ? diffView(shown.before, shown.after, t('configuration.show-of', { version: shown.version })) : html`<p class="muted">${t('configuration.first')}</p>`}</section>` : nothing}`;
  }
}
