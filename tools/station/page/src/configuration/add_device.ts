// The panel that adds a device: bus, then a template, a file or a scan; first values; into the draft.

import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { bytes } from '../format';
import { t } from '../i18n';
import { html } from '../markup';
import { serverText } from '../server_text';
import { badge, errorText } from '../view';
import * as api from './api';
import type { FirstValue, Found, Imported, Template } from './api';
import { deviceText, importedDevices, matching, protocolsOf, speaks } from './new_device';
import type { ImportedDevice } from './new_device';
import { freeAddress, freeName, namesAt } from './outline';
import { valueAt } from './yaml_tree';
import type { Node, Path } from './yaml_tree';

export interface Host {
  bridge: string;
  tree(): Node | undefined;
  draw(): void;
  add(path: Path, items: readonly ImportedDevice[]): void;  // into the list of devices at a path
  textWith(path: Path, items: readonly ImportedDevice[]): string;  // the draft with them
  cancel(): void;
}

type Source = 'template' | 'file' | 'scan';
const sources: readonly Source[] = ['template', 'file', 'scan'];
const mostTemplates = 30, mostRows = 200;
const largestFile = 3_000_000;

export class AddDevice {
  private source: Source = 'template';
  private templates: readonly Template[] | undefined;
  private search = '';
  private template = '';
  private name = '';
  private address = '';
  private imported: Imported | undefined;
  private fileName = '';
  private found: Found[] | undefined;
  private range = '1-32';  // addresses of the scan
  private wanted = '';  // protocol that was chosen for the scan
  private picked: Found | undefined;  // of `found`
  private values: readonly FirstValue[] | undefined;
  private running = '';  // text of the request in flight
  private scanning = false;
  private fault = '';

  constructor(private readonly host: Host, private bus: number) {
    void this.run('', async () => { this.templates = await api.readTemplates(); });
  }

  private get busPath(): Path { return ['buses', this.bus]; }
  private get busName(): string { return namesAt(this.host.tree(), ['buses'])?.[this.bus] ?? ''; }
  private get ownProtocol(): string { return valueAt(this.host.tree(), [...this.busPath, 'protocol']) ?? ''; }
  private get protocol(): string { return this.picked?.protocol ?? this.ownProtocol; }

  // Runs one request at a time; shows its fault.
  private async run(text: string, action: () => Promise<void>): Promise<void> {
    this.running = text;
    this.fault = '';
    this.host.draw();
    try {
      await action();
    } catch (error) {
      this.fault = errorText(error);
    }
    this.running = '';
    this.scanning = false;
    this.host.draw();
  }

  private propose(name: string): void {
    const tree = this.host.tree();
    this.name = freeName(name, namesAt(tree, [...this.busPath, 'devices']) ?? []);
    this.address = this.picked?.address ?? freeAddress(tree, this.busPath);
    this.values = undefined;
  }

  private chooseTemplate(template: string): void {
    this.template = template;
    this.propose(template);
    this.host.draw();
  }

  private items(): ImportedDevice[] {
    if (this.source === 'file') return this.imported ? importedDevices(this.imported.text, this.name, this.address, this.ownProtocol) : [];
    const protocol = this.protocol === this.ownProtocol ? '' : this.protocol;
    return this.template && this.name && this.address ? [{ name: this.name, text: deviceText(this.name, this.address, this.template, protocol) }] : [];
  }

  private readonly submit = (event: Event): void => {
    event.preventDefault();
    const items = this.items();
    if (items.length) this.host.add([...this.busPath, 'devices'], items);
  };

  private probe(): void {
    const [item] = this.items();
    if (item) void this.run(t('configuration.probing'), async () => {
      this.values = await api.probe(this.host.bridge, this.busName, item.name, this.host.textWith([...this.busPath, 'devices'], [item]));
    });
  }

  private async readFile(file: File | undefined): Promise<void> {
    if (!file) return;
    if (file.size > largestFile) {
      this.fault = t('configuration.too-large', { size: bytes(largestFile) });
      return this.host.draw();
    }
    await this.run(t('configuration.importing', { name: file.name }), async () => {
      const content = new Uint8Array(await file.arrayBuffer());
      let binary = '';
      for (let at = 0; at < content.length; at += 8192) binary += String.fromCharCode(...content.subarray(at, at + 8192));
      this.imported = await api.importFile(file.name, btoa(binary));
      this.fileName = file.name;
      this.propose(file.name.replace(/\.\w+$/, '').replace(/[^\w.-]+/g, '-').slice(0, 64) || 'device');
    });
  }

  view(): TemplateResult {
    const buses = namesAt(this.host.tree(), ['buses']) ?? [];
    const choose = (event: Event): void => {
      this.bus = Number((event.target as HTMLSelectElement).value);
      this.found = this.values = undefined;
      this.scanning = false;
      this.picked = undefined;
      if (this.template) this.propose(this.template);
      this.host.draw();
    };
    const items = this.items();
    return html`<form class="add-device" @submit=${this.submit}>
      <h2>${t('configuration.add-device')}</h2>
      <label>${t('configuration.choose-bus')} <select autofocus @change=${choose}>${buses.map((name, index) =>
        html`<option value=${index} ?selected=${index === this.bus}>${name}</option>`)}</select></label>
      <div class="choice-row" role="group" aria-label=${t('configuration.source')}>${sources.map((source) => html`
        <button type="button" class="choice" aria-pressed=${source === this.source} @click=${() => {
          this.source = source;
          this.scanning = false;
          this.fault = '';
          this.host.draw();
        }}>${t(`configuration.by-${source}`)}</button>`)}</div>
      ${this.source === 'template' ? this.templateList() : this.source === 'file' ? this.filePart() : this.scanPart()}
      <p role="status" class="muted">${this.running}</p>
      ${this.fault ? html`<p role="alert" class="bad">▲ ${this.fault}</p>` : nothing}
      ${this.source !== 'file' ? this.identity() : nothing}
      ${this.values ? this.firstValues(this.values) : nothing}
      <div class="buttons"><button type="button" class="plain" @click=${() => {
          this.scanning = false;
          this.host.cancel();
        }}>${t('cancel')}</button>
        <button type="button" ?disabled=${items.length !== 1 || !!this.running} @click=${() => this.probe()}>${t('configuration.probe')}</button>
        <button type="submit" class="primary" ?disabled=${!items.length}>${t('configuration.add')}</button></div></form>`;
  }

  private templateList(): TemplateResult {
    const all = this.templates ?? [], found = matching(all, this.search, this.protocol), chosen = all.find(({ name }) => name === this.template);
    const type = (event: Event): void => {
      this.search = (event.target as HTMLInputElement).value;
      this.host.draw();
    };
    return html`<label class="wide">${t('configuration.search')} <input type="search" .value=${this.search} @input=${type}></label>
      <p class="muted">${this.templates ? t('configuration.templates-shown', { n: Math.min(mostTemplates, found.length), all: all.length }) : t('loading')}</p>
      <ul class="picks" data-scroll aria-label=${t('configuration.templates')}>${found.slice(0, mostTemplates).map((each) => html`<li>
        <button type="button" aria-pressed=${each.name === this.template} @click=${() => this.chooseTemplate(each.name)}><b>${each.maker} ${each.model}</b>
          <span class="muted">${each.name}</span>
          ${speaks(each, this.protocol) ? nothing : html`<span class="warn">${t('configuration.other-protocol', { protocol: each.protocol })}</span>`}</button></li>`)}</ul>
      ${chosen?.text ? html`<details><summary>${t('configuration.template-text')}</summary><pre class="file" data-scroll tabindex="0" role="region"
        aria-label=${t('configuration.template-text')}>${chosen.text}</pre></details>` : nothing}
      ${this.templates && !found.length ? html`<p>${t('configuration.no-template')}</p>` : nothing}`;
  }

  private filePart(): TemplateResult {
    const drop = (event: DragEvent): void => {
      event.preventDefault();
      void this.readFile(event.dataTransfer?.files[0]);
    };
    const { imported } = this;
    const table = (name: string, head: readonly string[], rows: readonly (readonly string[])[]): TemplateResult => html`
      <h3>${name} (${rows.length})</h3><div class="scroll" data-scroll tabindex="0" role="region" aria-label=${name}><table class="plain">
        <thead><tr>${head.map((each) => html`<th scope="col">${each}</th>`)}</tr></thead>
        <tbody>${rows.slice(0, mostRows).map((row) => html`<tr>${row.map((each) => html`<td>${each}</td>`)}</tr>`)}</tbody></table></div>
      ${rows.length > mostRows ? html`<p class="muted">${t('configuration.and-more', { n: rows.length - mostRows })}</p>` : nothing}`;
    return html`<div class="drop" @dragover=${(event: Event) => event.preventDefault()} @drop=${drop}><p>${t('configuration.drop')}</p>
        <input type="file" aria-label=${t('configuration.choose-file')} @change=${(event: Event) => void this.readFile((event.target as HTMLInputElement).files?.[0])}></div>
      ${imported ? html`<p><b>${this.fileName}</b>: ${this.items().length ? t('configuration.devices-found', { n: this.items().length }) : t('configuration.nothing-found')}</p>
        ${[...imported.recognised, ...imported.notes].map((note) => html`<p class="muted">${note}</p>`)}
        ${imported.refusals.length ? table(t('configuration.refused'), [t('configuration.from'), t('configuration.why')], imported.refusals.map(({ where, why }) => [where, why])) : nothing}
        ${imported.moved.length ? table(t('configuration.moved'), [t('configuration.from'), t('configuration.to'), t('configuration.change')], imported.moved.map(({ from, to, change }) => [from, to, change])) : nothing}` : nothing}`;
  }

  // Part by part, until the last address, a fault, or the end of `scanning`.
  private scan(protocol: string): void {
    const [first = 0, last = first] = this.range.split('-').map(Number);
    const found: Found[] = this.found = [];
    this.scanning = true;
    void this.run('', async () => {
      for (let next: number | null = first; next !== null && this.scanning;) {
        this.running = t('configuration.scanning', { next, last });
        this.host.draw();
        const part = await api.scan(this.host.bridge, this.busName, protocol, next, last);
        if (this.found !== found) return;  // another bus was chosen
        found.push(...part.found);
        if (part.error) throw new Error(part.error);
        next = part.next;
      }
    });
  }

  // Fills the form with a found device, and the list of templates with those of its maker.
  private pick(found: Found, template = this.template): void {
    const [maker = ''] = (found.identity ?? '').split(/[\s,]+/);
    this.source = 'template';
    this.picked = found;
    this.template = template;
    if (maker && matching(this.templates ?? [], maker, this.protocol).length) this.search = maker;
    this.propose(template || `address-${found.address}`);
    this.host.draw();
  }

  private scanPart(): TemplateResult {
    const protocols = protocolsOf(this.host.tree(), this.busPath), protocol = protocols.includes(this.wanted) ? this.wanted : protocols[0] ?? '';
    const choose = (event: Event): void => {
      this.wanted = (event.target as HTMLSelectElement).value;
      this.host.draw();
    };
    const device = (each: Found): TemplateResult => html`<li>
      <button type="button" @click=${() => this.pick(each)}><b>${each.address}</b> ${each.identity || each.response}
        <span class="muted">${each.identity ? `${each.response} · ` : ''}${Math.round(each.took_ms)} ms</span></button>
      ${each.templates.map((name) => html`<button type="button" class="proposal" @click=${() => this.pick(each, name)}>${t('configuration.use', { name })}</button>`)}</li>`;
    return html`<div class="pair">${protocols.length > 1 ? html`<label>${t('configuration.protocol')} <select @change=${choose}>
        ${protocols.map((each) => html`<option ?selected=${each === protocol}>${each}</option>`)}</select></label>` : nothing}
      <label>${t('configuration.scan-range')} <input .value=${this.range} @change=${(event: Event) => { this.range = (event.target as HTMLInputElement).value; }}></label>
      <button type="button" ?disabled=${!!this.running && !this.scanning} @click=${() => { if (this.scanning) this.scanning = false; else this.scan(protocol); }}>${
        t(this.scanning ? 'configuration.scan-stop' : 'configuration.scan')}</button></div>
      ${protocols.length > 1 ? nothing : html`<p class="muted">${t('configuration.one-protocol', { protocol })}</p>`}
      ${this.found ? html`<ul class="picks" data-scroll aria-label=${t('configuration.scan-found')}>${this.found.map(device)}</ul>
        ${this.found.length || this.scanning ? nothing : html`<p>${t('configuration.scan-none')}</p>`}` : nothing}`;
  }

  private identity(): TemplateResult {
    const type = (take: (value: string) => void) => (event: Event): void => {
      take((event.target as HTMLInputElement).value.trim());
      this.values = undefined;
      this.host.draw();
    };
    return html`<div class="pair"><label>${t('configuration.name')} <input required maxlength="64" pattern="[\\w.\\-]{1,64}" .value=${this.name} @input=${type((value) => { this.name = value; })}></label>
      <label>${t('configuration.address')} <input required maxlength="64" .value=${this.address} @input=${type((value) => { this.address = value; })}></label></div>`;
  }

  private firstValues(values: readonly FirstValue[]): TemplateResult {
    return html`<h3>${t('configuration.first-values')}</h3>
      <div class="scroll" data-scroll tabindex="0" role="region" aria-label=${t('configuration.first-values')}><table class="plain">
        <thead><tr><th scope="col">${t('configuration.channel')}</th><th scope="col" class="number">${t('configuration.value')}</th><th scope="col">${t('configuration.state')}</th></tr></thead>
        <tbody>${values.map(({ channel, value, unit, quality, error }) => {
          const good = quality.toLowerCase() === 'good';
          return html`<tr><td>${channel}</td><td class="number">${value === null ? '–' : `${String(value)} ${unit}`}</td>
            <td>${badge(good ? 'good' : 'bad', serverText(error) || (good ? t('quality.good') : quality))}</td></tr>`;
        })}</tbody></table></div>`;
  }
}
