// The page #/configuration/BRIDGE: text and forms of a draft, its faults and plan, deployment; #/configuration/BRIDGE/versions.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { ApiError } from '../api';
import type { Change, Context, Page } from '../context';
import { save } from '../csv';
import { addTexts, t, word } from '../i18n';
import { html } from '../markup';
import { link } from '../router';
import { ask, badge, empty, errorText } from '../view';
import { AddDevice } from './add_device';
import * as api from './api';
import type { Checked, Configuration, Watch } from './api';
import { complete } from './completion';
import { askConflict, askDeploy } from './deploy';
import { Draft, ordered, protectedLines } from './draft';
import type { ProtectedLines } from './draft';
import { Editor } from './editor';
import type { LineMark } from './editor';
import { formFields, keyOf } from './form';
import type { Form } from './form';
import { countChanges } from './line_diff';
import type { ImportedDevice } from './new_device';
import { freeName, nameOf, namesAt, objectOf, outline } from './outline';
import { planView } from './plan_view';
import { schemaAt } from './schema';
import type { Schema } from './schema';
import { texts } from './texts';
import { Versions } from './versions';
import { addItem, removeAt, setAt, setScalar } from './yaml_edit';
import { nodeAt, parseTree, pathAt } from './yaml_tree';
import type { Node, Path } from './yaml_tree';

addTexts(texts);

const parseAfter_ms = 120, checkAfter_ms = 400, watchEvery_ms = 2000;

// Drafts are kept while the user looks at other pages, not beyond a reload.
const drafts = new Map<string, Draft>();
addEventListener('beforeunload', (event) => {
  if ([...drafts.values()].some(({ changed }) => changed)) event.preventDefault();
});

export class ConfigurationPage implements Page {
  private readonly bridge: string;
  private readonly editor: Editor;
  private readonly versions: Versions | undefined;
  private schema: Schema = {};
  private draft: Draft | undefined;
  private tree: Node | undefined;
  private lines: ProtectedLines = { kept: new Map(), lost: [] };
  private checked: Checked | undefined;
  private checking: AbortController | undefined;
  private chosen: Path = [];
  private adding: AddDevice | undefined;
  private watch: Watch | undefined;
  private watchedAt = 0;
  private badBefore = 0;
  private fault = '';
  private parseTimer = 0;
  private checkTimer = 0;
  private closed = false;

  constructor(private readonly context: Context, readonly element: HTMLElement) {
    this.bridge = context.route.parts[0] ?? [...context.plant.bridges.keys()].sort()[0] ?? '';
    this.editor = new Editor({
      input: (text) => this.change(text, performance.now()),
      moved: (offset) => this.follow(offset),
      undo: () => this.step('undo'),
      redo: () => this.step('redo'),
      complete: (text, offset) => complete(text, offset, this.schema),
    }, t('configuration.text'));
    if (context.route.parts[1] === 'versions')
      this.versions = new Versions({ bridge: this.bridge, now: () => context.now(), draw: () => this.draw(), say: context.say, returned: () => void this.load(true) });
    void this.load();
  }

  close(): void {
    this.closed = true;
    this.checking?.abort();
    clearTimeout(this.parseTimer);
    clearTimeout(this.checkTimer);
  }

  paint(change: Change): void {
    if (!this.draft && !this.fault && !this.bridge && change.topics.has('bridges') && this.context.plant.bridges.size)
      return this.context.go(link('configuration', [[...this.context.plant.bridges.keys()].sort()[0]!]));
    if (!change.second) return;
    this.adding?.tick();
    if (this.watch?.state === 'watching' && performance.now() - this.watchedAt > watchEvery_ms) void this.readWatch();
    if (this.watch ?? this.adding) this.draw();
  }

  // `fresh`: the configuration in force was changed by this page; the draft is replaced.
  private async load(fresh = false): Promise<void> {
    if (!this.bridge) return this.draw();
    try {
      const [schema, read] = await Promise.all([api.readSchema(), api.read(this.bridge)]);
      this.schema = schema as Schema;
      this.adopt(read, fresh);
    } catch (error) {
      this.fault = errorText(error);
    }
    this.draw();
  }

  private adopt(read: Configuration, fresh: boolean): void {
    const kept = drafts.get(this.bridge);
    if (!kept || !kept.changed || fresh) drafts.set(this.bridge, this.draft = new Draft(read));
    else this.draft = kept;
    this.watch = read.watch ?? undefined;
    this.editor.text = this.draft.text;
    this.parse();
    this.checkSoon(0);
  }

  private change(text: string, typed_ms?: number): void {
    if (!this.draft) return;
    this.draft.set(text, typed_ms);
    clearTimeout(this.parseTimer);
    if (typed_ms === undefined) this.parse();
    else this.parseTimer = window.setTimeout(() => this.parse(), parseAfter_ms);
    this.checkSoon(checkAfter_ms);
  }

  private step(way: 'undo' | 'redo'): void {
    if (!this.draft) return;
    this.draft[way]();
    this.editor.text = this.draft.text;
    this.parse();
    this.checkSoon(checkAfter_ms);
  }

  private parse(): void {
    const { draft } = this;
    if (!draft || this.closed) return;
    this.tree = parseTree(draft.text);
    this.lines = protectedLines(draft.base.text, draft.base.protected, draft.text);
    while (this.chosen.length && !nodeAt(this.tree, this.chosen)) this.chosen = this.chosen.slice(0, -2);
    this.mark();
    this.draw();
  }

  private checkSoon(after_ms: number): void {
    clearTimeout(this.checkTimer);
    this.checking?.abort();
    this.checking = new AbortController();
    const { signal } = this.checking;
    this.checkTimer = window.setTimeout(() => void this.check(signal), after_ms);
  }

  private async check(signal: AbortSignal): Promise<void> {
    const { draft } = this;
    if (!draft) return;
    try {
      const checked = await api.check(this.bridge, draft.text, signal);
      if (signal.aborted) return;
      this.checked = { ...checked, faults: ordered(checked.faults, this.fileName) };
      this.checking = undefined;
      this.fault = '';
    } catch (error) {
      if (signal.aborted) return;
      this.checking = undefined;
      this.checked = undefined;
      this.fault = errorText(error);
    }
    this.mark();
    this.draw();
  }

  // The name that faults have for the text itself.
  private get fileName(): string { return this.draft?.base.path.split('/').pop() ?? ''; }
  private ofText(file: string): boolean { return file === '' || file.split('/').pop() === this.fileName; }

  private mark(): void {
    const faults = (this.checked?.faults ?? []).filter(({ file }) => this.ofText(file)).map<LineMark>(({ line, column, message, hint }) =>
      ({ line, column, kind: 'fault', text: [message, hint].filter(Boolean).join(' ') }));
    this.editor.mark([...faults, ...[...this.lines.kept].map<LineMark>(([line, why]) =>
      ({ line, column: 0, kind: 'protected', text: t('configuration.protected-line', { why }) }))]);
  }

  private follow(offset: number): void {
    if (!this.draft || this.adding) return;
    const object = objectOf(pathAt(this.draft.text, this.tree, offset));
    if (keyOf(object) === keyOf(this.chosen)) return;
    this.chosen = object;
    this.draw();
  }

  private choose(path: Path): void {
    this.chosen = path;
    const node = nodeAt(this.tree, path);
    if (node) this.editor.select(node.start, node.start, false);
    this.draw();
  }

  // Changes the text by a form; a change that cannot be made leaves the text alone.
  private edit(make: (text: string) => string): void {
    try {
      this.change(make(this.draft!.text));
      this.editor.text = this.draft!.text;
      this.mark();
    } catch (error) {
      this.context.say(t('configuration.cannot', { why: (error as Error).message }), true);
      this.draw();
    }
  }

  private add(path: Path, items: readonly ImportedDevice[]): void {
    const list = nodeAt(this.tree, path), taken = namesAt(this.tree, path) ?? [];
    if (list?.flow && list.children.length && items.some(({ text }) => text.includes('\n'))) return this.context.say(t('configuration.braces'), true);
    this.adding = undefined;
    this.edit((text) => items.reduce((sum, { text: item }) => addItem(sum, path, item), text));
    this.choose([...path, taken.length]);
    this.context.say(t('configuration.added', { name: items.map(({ name }) => name).join(', ') }));
  }

  private addObject(path: Path, name: string, more: string): void {
    const taken = namesAt(this.tree, path) ?? [];
    this.edit((text) => addItem(text, path, `{ name: ${freeName(name, taken)}, ${more} }`));
    this.choose([...path, taken.length]);
  }

  private async remove(): Promise<void> {
    const name = nameOf(this.tree, this.chosen), path = this.chosen;
    if (!await ask({ title: t('configuration.remove', { name }), body: t('configuration.remove-ask', { name }), confirm: t('configuration.remove', { name }), danger: true })) return;
    this.chosen = path.slice(0, -2);
    this.edit((text) => removeAt(text, path));
  }

  private async discard(): Promise<void> {
    const { draft } = this;
    if (!draft) return;
    const changes = countChanges(draft.base.text, draft.text);
    if (!await ask({ title: t('configuration.discard'), body: t('configuration.discard-ask', changes), confirm: t('configuration.discard'), danger: true })) return;
    this.edit(() => draft.base.text);
  }

  private async deploy(): Promise<void> {
    const { draft, checked } = this;
    if (!draft || !checked) return;
    const why = await askDeploy(draft, checked);
    if (why === undefined) return;
    try {
      this.badBefore = this.badChannels();
      this.watch = { ...await api.deploy(this.bridge, draft.base.version, draft.text, why), state: 'watching' };
      this.watchedAt = performance.now();
      draft.base = { ...draft.base, text: draft.text, version: this.watch.version };
      this.context.say(t('configuration.deployed', { version: this.watch.version }));
      draft.base = await api.read(this.bridge);
    } catch (error) {
      const theirs = error instanceof ApiError && error.status === 409 ? error.answer as Partial<Configuration> : undefined;
      if (theirs?.text !== undefined && theirs.version !== undefined) await this.resolveConflict(draft, { text: theirs.text, version: theirs.version });
      else this.context.say(errorText(error), true);
    }
    this.parse();
  }

  private async resolveConflict(draft: Draft, theirs: Pick<Configuration, 'version' | 'text'>): Promise<void> {
    const text = await askConflict(draft, theirs);
    if (text === undefined) return;
    draft.base = await api.read(this.bridge);
    this.edit(() => text);
  }

  private async readWatch(): Promise<void> {
    this.watchedAt = performance.now();
    const { draft } = this;
    try {
      const read = await api.read(this.bridge);
      if (read.watch) this.watch = read.watch;
      else if (this.watch) this.watch = { ...this.watch, state: read.version === this.watch.version ? 'kept' : 'rolled-back' };
      if (draft && read.version !== draft.base.version) {
        draft.base = read;
        this.parse();
      }
    } catch {
      // The next second tries again; the line below the head shows a lost connection.
    }
    this.draw();
  }

  private async finish(action: () => Promise<unknown>): Promise<void> {
    try {
      await action();
    } catch (error) {
      this.context.say(errorText(error), true);
    }
    await this.readWatch();
  }

  private badChannels(): number { return this.context.plant.count().get('')?.bad ?? 0; }

  private draw(): void {
    if (this.closed) return;
    const { context, draft, versions } = this;
    const bridges = [...new Set([...context.plant.bridges.keys(), ...(this.bridge ? [this.bridge] : [])])].sort();
    const tab = (label: string, part: readonly string[], shown: boolean): TemplateResult =>
      html`<a href=${link('configuration', [this.bridge, ...part])} aria-current=${shown ? 'page' : nothing}>${label}</a>`;
    const change = (event: Event): void => context.go(link('configuration', [(event.target as HTMLSelectElement).value]));
    render(html`<div class="tabs"><h1>${t('configuration.title')}</h1>
        <label>${t('configuration.bridge')} <select @change=${change}>${bridges.map((name) => html`<option value=${name} ?selected=${name === this.bridge}>${name}</option>`)}</select></label>
        <nav aria-label=${t('configuration.title')}>${tab(t('configuration.edit'), [], !versions)} ${tab(t('configuration.versions'), ['versions'], !!versions)}</nav></div>
      ${!context.mayEngineer() ? empty(t('configuration.role')) : !draft ? empty(this.fault || t(this.bridge ? 'loading' : 'configuration.none')) : html`${this.watchPanel()}
        ${versions ? versions.view(draft.base.version) : this.editPart(draft)}`}`, this.element);
  }

  private watchPanel(): TemplateResult {
    const { watch } = this;
    if (!watch) return html`${nothing}`;
    const left_s = Math.max(0, Math.ceil((watch.until_ms - this.context.now()) / 1000)), { version } = watch;
    if (watch.state !== 'watching') return html`<section class="card watch" role="status">${t('configuration.ended', { version, state: word('version', watch.state) })}</section>`;
    const bad = this.badChannels();
    return html`<section class="card watch" role="status" aria-live="off"><p>${t('configuration.watch', { version, s: left_s })}
        <b class=${bad > this.badBefore ? 'bad' : ''}>${t('configuration.bad-now', { n: bad, before: this.badBefore })}</b></p>
      <button type="button" class="primary" @click=${() => void this.finish(() => api.confirm(this.bridge, version))}>${t('configuration.keep')}</button>
      <button type="button" class="danger" @click=${() => void this.finish(() => api.rollBack(this.bridge, version, t('configuration.roll-back-why')))}>${t('configuration.roll-back')}</button></section>`;
  }

  private editPart(draft: Draft): TemplateResult {
    const { checked } = this, faults = checked?.faults.length ?? 0;
    const may = draft.changed && !!checked && !this.checking && !faults && !this.lines.lost.length && this.watch?.state !== 'watching';
    return html`<div class="tools">
        <button type="button" ?disabled=${!nodeAt(this.tree, ['buses'])?.children.length} @click=${() => this.startAdding()}>${t('configuration.add-device')}</button>
        <button type="button" class="plain" ?disabled=${!draft.mayUndo} @click=${() => this.step('undo')}>${t('configuration.undo')}</button>
        <button type="button" class="plain" ?disabled=${!draft.mayRedo} @click=${() => this.step('redo')}>${t('configuration.redo')}</button>
        <button type="button" class="plain" ?disabled=${!draft.changed} @click=${() => void this.discard()}>${t('configuration.discard')}</button>
        <button type="button" class="plain" @click=${() => save(this.fileName || 'bridge.yaml', draft.text, 'application/yaml')}>${t('configuration.download')}</button>
        <span class="space"></span>
        <span class="muted">${draft.changed ? t('configuration.changed', countChanges(draft.base.text, draft.text)) : t('configuration.unchanged', { version: draft.base.version })}</span>
        <button type="button" class="primary" ?disabled=${!may} @click=${() => void this.deploy()}>${t('configuration.deploy')}</button></div>
      <div class="edit-pair">${this.editor.element}
        <section class="card side" data-scroll tabindex="0" role="region" aria-label=${t('configuration.object')}>${this.adding?.view() ?? this.formPart(draft)}</section></div>
      ${this.faultPart()}
      <section><h2>${t('configuration.plan')}</h2>${planView(checked)}</section>
      ${draft.base.files.length ? html`<section><h2>${t('configuration.files')}</h2>${draft.base.files.map(({ name, text }) =>
        html`<details><summary>${name}</summary><pre class="file" data-scroll tabindex="0" role="region" aria-label=${name}>${text}</pre></details>`)}</section>` : nothing}`;
  }

  private startAdding(): void {
    const bus = this.chosen[0] === 'buses' ? Number(this.chosen[1]) : 0;
    this.adding = new AddDevice({
      bridge: this.bridge, tree: () => this.tree, draw: () => this.draw(), add: (path, items) => this.add(path, items),
      cancel: () => {
        this.adding = undefined;
        this.draw();
      },
    }, bus);
    this.draw();
    this.element.querySelector<HTMLElement>('.add-device select')?.focus();
  }

  private faultPart(): TemplateResult {
    const { checked, lines } = this, faults = checked?.faults ?? [];
    const told = this.fault || (this.checking || !checked ? t('configuration.checking') :
      faults.length === 0 ? t('configuration.no-faults') : faults.length === 1 ? t('configuration.fault') : t('configuration.faults', { n: faults.length }));
    return html`<section class="faults"><p role="status">${badge(this.fault || faults.length ? 'bad' : this.checking ? 'unknown' : 'good', told)}</p>
      ${lines.lost.length ? html`<p class="bad">▲ ${lines.lost.map(({ line, why }) => t('configuration.protected', { line, why })).join(' ')}
        <button type="button" @click=${() => this.step('undo')}>${t('configuration.undo')}</button></p>` : nothing}
      ${faults.length ? html`<ul>${faults.slice(0, 100).map(({ file, line, column, message, hint }) => {
        const place = `${file}:${line}:${column}`, told = html`<code>${place}</code> ${message} <span class="muted">${hint}</span>`;
        return html`<li>${this.ofText(file) ? html`<button type="button" class="plain" @click=${() => this.editor.selectPlace(line, column)}>${told}</button>` : told}</li>`;
      })}</ul>` : nothing}</section>`;
  }

  private formPart(draft: Draft): TemplateResult {
    const { chosen } = this, level = chosen.length / 2, name = nameOf(this.tree, chosen);
    const form: Form = {
      root: this.schema, schema: schemaAt(this.schema, chosen), text: draft.text, tree: this.tree, path: chosen, faults: this.faultsByKey(draft.text), kept: this.lines.kept,
      set: (path, value, field) => this.edit((text) => (value === '' ? removeAt(text, path) :
        field.kind === 'yaml' ? setAt(text, path, value) : setScalar(text, path, value, field.bare))),
      show: (child) => this.editor.select(child.start, child.end, true),
    };
    return html`${outline(this.tree, chosen, (path) => this.choose(path))}
      <h2>${level ? name : t('configuration.whole')}</h2>
      ${formFields(form)}
      <div class="buttons">${level === 0 ? html`<button type="button" @click=${() => this.addObject(['buses'], 'bus', 'port: { serial: /dev/ttyUSB0 }, protocol: modbus-rtu, devices: []')}>${t('configuration.add-bus')}</button>` : nothing}
        ${level === 2 && !nodeAt(this.tree, [...chosen, 'channels', 0]) && nodeAt(this.tree, [...chosen, 'channels'])?.kind === 'scalar' ? nothing : level >= 2 ? html`
          <button type="button" @click=${() => this.addObject([...chosen.slice(0, 4), 'channels'], 'channel', 'at: "holding:0", type: uint16')}>${t('configuration.add-channel')}</button>` : nothing}
        ${level ? html`<button type="button" class="danger" @click=${() => void this.remove()}>${t('configuration.remove', { name })}</button>` : nothing}</div>`;
  }

  private faultsByKey(text: string): Map<string, string> {
    const lines = text.split('\n'), found = new Map<string, string>();
    for (const { file, line, column, message, hint } of this.checked?.faults ?? []) {
      if (!this.ofText(file)) continue;
      const offset = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0) + Math.max(0, column - 1);
      found.set(keyOf(pathAt(text, this.tree, offset)), [message, hint].filter(Boolean).join(' '));
    }
    return found;
  }
}
